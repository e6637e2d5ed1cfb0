//! max Re λ along one input with the others at their medians, and how far it is known there.

use super::charts::{points, short};
use pcc_charts::{Axis, Chart, Color, Guide, Marks, Series, Symbol};
use pcc_evaluate::evaluation::{IntervalLevel, Plan, evaluate_points, point_intervals};
use pcc_evaluate::foundation::Silent;
use pcc_evaluate::surrogate::Surrogate;

/// Points of a curve.
const POINTS: usize = 61;

/// Where it is not known between which values of an input the model was run, this much probability is left out at
/// either end of a law with tails.
const TAIL: f64 = 0.005;

/// Level of the intervals.
const LEVEL: &str = "0.9";

/// max Re λ over input `j`, from its lower to its upper bound or between the model runs, with intervals at points if
/// the surrogate keeps what its runs left out miss.
pub(super) fn section_chart(surrogate: &Surrogate, j: usize) -> Chart {
    let input = &surrogate.inputs.inputs()[j];
    let (values, standardized) = section(surrogate, j);
    let references: Vec<&[f64]> = standardized.iter().map(Vec::as_slice).collect();
    let block = evaluate_points(surrogate, &Plan::new(surrogate), &references);
    let found = LEVEL.parse::<IntervalLevel>().ok().zip(surrogate.left_out.as_ref());
    let intervals = found.and_then(|(level, left_out)| {
        let has_ends = left_out.runs().len() >= level.least_runs();
        Some((level, point_intervals(surrogate, left_out, &block, level, &Silent).ok()?)).filter(|_| has_ends)
    });
    let marks = |y: Vec<f64>| match input.marginal.is_discrete() {
        true => Marks::Symbols(points(&values, y), Symbol::Circle),
        false => Marks::Line(points(&values, y)),
    };
    let mut series = Vec::new();
    let mut known = "no intervals: too few runs, or a surrogate that does not keep what they say".to_owned();
    if let Some((level, intervals)) = &intervals {
        known = format!("with {level} intervals by left-out runs");
        for side in [0, 1] {
            let ends = intervals.iter().map(|interval| interval.max_re[side]).collect();
            series.push(Series::new(format!("{level} interval"), Color::Gray, marks(ends)));
        }
    }
    series.push(Series::new("max Re λ", Color::Blue, marks(block.max_re.clone())));
    Chart {
        title: format!("max Re λ along {}", input.name),
        description: format!("Other inputs at their medians; {known}."),
        x: Axis::linear(input.title()),
        y: Axis::linear("max Re λ in 1/s"),
        series,
        guides: vec![Guide::Horizontal(0.0, "stability limit".to_owned())],
    }
}

/// Values of input `j`, rising, and the standardized points with the other inputs at their medians.
fn section(surrogate: &Surrogate, j: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let inputs = surrogate.inputs.inputs();
    let marginal = &inputs[j].marginal;
    let quantile = |unit: f64| marginal.physical(marginal.standardized_quantile(unit));
    let [from, to] = match surrogate.trained_interval(j) {
        Some(trained) => trained,
        None if marginal.is_divisible() => marginal.support(),
        None => [quantile(TAIL), quantile(1.0 - TAIL)],
    };
    let at = |i: usize| i as f64 / (POINTS - 1) as f64;
    let mut values: Vec<f64> = match marginal.is_discrete() {
        true => (0..POINTS).map(|i| quantile(TAIL + (1.0 - 2.0 * TAIL) * at(i))).collect(),
        false => (0..POINTS).map(|i| from + (to - from) * at(i)).collect(),
    };
    values.dedup_by(|a, b| short(*a) == short(*b));
    let mut physical: Vec<f64> = inputs.iter().map(|input| input.marginal.at_centred_probability(0.0)).collect();
    let standardized = values.iter().map(|&value| {
        physical[j] = value;
        surrogate.inputs.standardized(&physical)
    });
    let standardized = standardized.collect();
    (values, standardized)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shipped(name: &str) -> Surrogate {
        let path = format!("{}/surrogates/{name}.pcc", env!("CARGO_MANIFEST_DIR"));
        Surrogate::read(path).unwrap()
    }

    fn line<'a>(chart: &'a Chart, name: &str) -> Vec<&'a Vec<[f64; 2]>> {
        let of_name = chart.series.iter().filter(|series| series.name == name);
        of_name.map(|series| if let Marks::Line(points) = &series.marks { points } else { panic!("a line") }).collect()
    }

    #[test]
    fn intervals_enclose_the_curve_from_bound_to_bound() {
        let surrogate = shipped("clutch-r3");
        let chart = section_chart(&surrogate, 0);
        let curve = line(&chart, "max Re λ")[0];
        assert_eq!((curve.len(), curve[0][0], curve[POINTS - 1][0]), (POINTS, 0.0, 0.5));
        let ends = line(&chart, "90 % interval");
        for ((lower, upper), middle) in ends[0].iter().zip(ends[1]).zip(curve) {
            assert!(lower[1] <= middle[1] && middle[1] <= upper[1], "{lower:?} {middle:?} {upper:?}");
        }
        assert!(chart.description.contains("90 % intervals"));
    }

    #[test]
    fn without_residuals_the_curve_stands_alone_and_says_so() {
        let surrogate = Surrogate { left_out: None, ..shipped("clutch-r3") };
        let chart = section_chart(&surrogate, 0);
        assert!(line(&chart, "90 % interval").is_empty() && chart.description.contains("no intervals"));
    }

    #[test]
    fn laws_with_tails_are_drawn_between_the_runs() {
        let surrogate = shipped("clutch-normal-r8");
        let tails =
            (0..surrogate.inputs.dimension()).filter(|&j| !surrogate.inputs.inputs()[j].marginal.is_divisible());
        for j in tails {
            let curve = line(&section_chart(&surrogate, j), "max Re λ")[0].clone();
            let [from, to] = surrogate.trained_interval(j).unwrap().map(short);
            assert_eq!((curve[0][0], curve[POINTS - 1][0], curve.len()), (from, to, POINTS));
        }
    }
}
