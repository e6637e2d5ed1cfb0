//! What the law of an input looks like: its density, beside its row in a table.

use super::numbers::significant;
use pcc_charts::Sparkline;
use pcc_evaluate::probability::inputs::{Input, Marginal};

/// Pieces of the curve.
const PIECES: u32 = 60;

/// What is drawn of a law: all but a thousandth at either end.
const DRAWN: f64 = 0.998;

/// The density of an input, filled where the model was run.
pub(super) fn sparkline(input: &Input, trained: Option<[f64; 2]>) -> Sparkline {
    let curve = density(&input.marginal);
    let [from, to] = [curve.first(), curve.last()].map(|end| end.map_or(0.0, |point| point[0]));
    let words = |[lower, upper]: [f64; 2]| format!("{} to {}", significant(lower, 4), significant(upper, 4));
    let filled = match trained {
        Some(interval) => format!("filled where the model was run, {}", words(interval)),
        None => "filled, since runs fill it".to_owned(),
    };
    Sparkline {
        title: format!("density of {}", input.name),
        description: format!("from {}, {filled}", words([from, to])),
        curve,
        filled: trained.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
    }
}

/// The density of a law at the middles of equal pieces, by differences of its distribution function: any law has that.
/// It begins and ends at 0, so that jumps show.
fn density(law: &Marginal) -> Vec<[f64; 2]> {
    let [lower, upper] = [-DRAWN, DRAWN].map(|centred| law.at_centred_probability(centred));
    let width = (upper - lower) / f64::from(PIECES);
    let edge = |k: u32| lower + width * f64::from(k);
    let below = |k: u32| 0.5 * law.centred_probability(edge(k));
    let middle = |k: u32| [edge(k) + 0.5 * width, (below(k + 1) - below(k)) / width];
    let heights: Vec<[f64; 2]> = (0..PIECES).map(middle).collect();
    // Up to the ends as high as in the pieces there.
    let end = |x: f64, piece: Option<&[f64; 2]>| [x, piece.map_or(0.0, |point| point[1])];
    let (first, last) = (end(lower, heights.first()), end(upper, heights.last()));
    let mut curve = vec![[lower, 0.0], first];
    curve.extend(&heights);
    curve.extend([last, [upper, 0.0]]);
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::probability::inputs::{Parameters, Uniform};
    use std::f64::consts::TAU;

    fn law(name: &str, given: &[(&'static str, f64)]) -> Marginal {
        Marginal::named(name, &Parameters::of(given.iter().copied())).unwrap()
    }

    #[test]
    fn curves_are_the_densities() {
        let normal = density(&law("normal", &[("mean", 3.0), ("std", 2.0)]));
        let exponential = density(&law("exponential", &[("mean", 0.5)]));
        let inner = |curve: &[[f64; 2]]| curve[2..curve.len() - 2].to_vec();
        for [x, y] in inner(&normal) {
            let exact = (-0.125 * (x - 3.0).powi(2)).exp() / (2.0 * TAU.sqrt());
            assert!((y - exact).abs() < 5e-4 * 0.2, "{x}: {y} for {exact}");
        }
        for [x, y] in inner(&exponential) {
            let exact = 2.0 * (-2.0 * x).exp();
            assert!((y - exact).abs() < 6e-4 * exact, "{x}: {y} for {exact}");
        }
        let uniform = density(&Marginal::Uniform(Uniform::new(2.0, 6.0).unwrap()));
        assert!(inner(&uniform).iter().all(|[_, y]| (y - 0.25).abs() < 1e-12), "{uniform:?}");
        assert_eq!((uniform[0][1], uniform[uniform.len() - 1][1]), (0.0, 0.0));
    }
}
