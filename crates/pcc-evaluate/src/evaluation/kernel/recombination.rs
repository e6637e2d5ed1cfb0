//! Eigenvalues from components in all lanes at once.
//!
//! Single eigenvalues and pairs, whatever they are made of, take plain loops over lanes, which compile to vector
//! instructions; larger groups are polynomials whose roots are found lane by lane. The values are those of
//! [`Output::recombine`], bit by bit.

use super::lanes::{BLOCK_POINTS, Lanes};
use super::results::Results;
use crate::components::{
    Margin, Output, OutputKind, beyond_rounding, closed_pair, is_equal_frequency, is_safe_square, square_root,
};
use crate::surrogate::VerdictBasis;
use num_complex::Complex;

/// Fills in eigenvalues, max Re λ and the largest excess, given the components.
#[inline(always)]
pub(crate) fn recombine(outputs: &[Output], verdict: VerdictBasis, results: &mut Results) {
    let Results { components, growth_rates, angular_frequencies, max_re, excess, top_frequency } = results;
    let (mut first, mut some_are_closed) = (0, false);
    for output in outputs {
        let own = first..first + output.eigenvalue_count();
        let (re, im) = (&mut growth_rates[own.clone()], &mut angular_frequencies[own.clone()]);
        first = own.end;
        some_are_closed |= output.kind == OutputKind::Closed;
        let part = |k: usize| &components[output.components[k].id];
        match (output.kind, re, im) {
            (OutputKind::Eigenvalue, [re], [im]) => (*re, *im) = (*part(0), *part(1)),
            (OutputKind::Closed, [re], [im]) => (*re, *im) = (*part(0), Lanes::splat(0.0)),
            (OutputKind::Closed, [re_1, re_2], [im_1, im_2]) => {
                closed_pairs([part(0), part(1)], [re_1, re_2], [im_1, im_2]);
            }
            (OutputKind::Cluster, [re_1, re_2], [im_1, im_2]) => {
                pair([part(0), part(1)], [part(2), part(3)], [re_1, re_2], [im_1, im_2]);
            }
            (_, re, im) => lane_by_lane(output, components, re, im),
        }
    }
    if verdict.is_self_adjoint {
        settle(growth_rates, angular_frequencies, verdict);
    }
    *max_re = spectral_abscissa(growth_rates, angular_frequencies);
    *excess = match verdict.margin.is_none() {
        true => *max_re,
        false => largest_excess(growth_rates, angular_frequencies, verdict.margin),
    };
    if some_are_closed {
        *top_frequency = frequency_of_largest(growth_rates, angular_frequencies, verdict.margin, excess);
    }
    excess.0.iter_mut().for_each(|excess| *excess = beyond_rounding(*excess, verdict.tolerance));
}

/// λ² − e₁ λ + e₂ = 0.
#[inline(always)]
fn closed_pairs(symmetric: [&Lanes; 2], re: [&mut Lanes; 2], im: [&mut Lanes; 2]) {
    let ([re_1, re_2], [im_1, im_2]) = (re, im);
    for lane in 0..BLOCK_POINTS {
        let [first, second] = closed_pair(symmetric[0].0[lane], symmetric[1].0[lane]);
        (re_1.0[lane], im_1.0[lane]) = (first.re, first.im);
        (re_2.0[lane], im_2.0[lane]) = (second.re, second.im);
    }
}

/// Im λ of the first eigenvalue with the largest excess.
#[inline(always)]
fn frequency_of_largest(
    growth_rates: &[Lanes],
    angular_frequencies: &[Lanes],
    margin: Margin,
    largest: &Lanes,
) -> Lanes {
    let mut found = Lanes::splat(0.0);
    for (re, im) in growth_rates.iter().zip(angular_frequencies).rev() {
        let excess = excesses(re, im, margin);
        for lane in 0..BLOCK_POINTS {
            if excess.0[lane] == largest.0[lane] {
                found.0[lane] = im.0[lane];
            }
        }
    }
    found
}

/// Leaves of every eigenvalue what it can be.
fn settle(growth_rates: &mut [Lanes], angular_frequencies: &mut [Lanes], verdict: VerdictBasis) {
    for (re, im) in growth_rates.iter_mut().zip(angular_frequencies) {
        for lane in 0..BLOCK_POINTS {
            let settled = verdict.settled(Complex::new(re.0[lane], im.0[lane]));
            (re.0[lane], im.0[lane]) = (settled.re, settled.im);
        }
    }
}

/// The excess of one eigenvalue in every lane.
#[inline(always)]
pub(crate) fn excesses(growth_rate: &Lanes, angular_frequency: &Lanes, margin: Margin) -> Lanes {
    if margin.is_none() {
        return *growth_rate;
    }
    let mut excess = Lanes::splat(0.0);
    for lane in 0..BLOCK_POINTS {
        excess.0[lane] = margin.excess(Complex::new(growth_rate.0[lane], angular_frequency.0[lane]));
    }
    excess
}

/// The largest excess; NaN where any part of an eigenvalue is NaN or infinite.
#[inline(always)]
fn largest_excess(growth_rates: &[Lanes], angular_frequencies: &[Lanes], margin: Margin) -> Lanes {
    let mut largest = Lanes::splat(f64::NEG_INFINITY);
    for (re, im) in growth_rates.iter().zip(angular_frequencies) {
        let excess = excesses(re, im, margin);
        for lane in 0..BLOCK_POINTS {
            let (here, before) = (excess.0[lane], largest.0[lane]);
            let larger = if here > before { here } else { before };
            largest.0[lane] = if here.abs() < f64::INFINITY { larger } else { f64::NAN };
        }
    }
    largest
}

/// λ = s ± √−c_0, by frequency.
#[inline(always)]
fn pair(mean: [&Lanes; 2], constant: [&Lanes; 2], re: [&mut Lanes; 2], im: [&mut Lanes; 2]) {
    let ([re_1, re_2], [im_1, im_2]) = (re, im);
    let (mut root_re, mut root_im) = (Lanes::splat(0.0), Lanes::splat(0.0));
    square_roots(constant, &mut root_re, &mut root_im);
    for lane in 0..BLOCK_POINTS {
        let (s_re, s_im) = (mean[0].0[lane], mean[1].0[lane]);
        let (r_re, r_im) = (root_re.0[lane], root_im.0[lane]);
        let (minus, plus) = ((s_re - r_re, s_im - r_im), (s_re + r_re, s_im + r_im));
        let swapped = if is_equal_frequency(minus.1, plus.1) { minus.0 > plus.0 } else { minus.1 - plus.1 > 0.0 };
        let (first, second) = if swapped { (plus, minus) } else { (minus, plus) };
        (re_1.0[lane], im_1.0[lane]) = first;
        (re_2.0[lane], im_2.0[lane]) = second;
    }
}

/// The square roots of −c, as [`square_root`] computes them; lanes whose square would over- or underflow are done by
/// it.
#[inline(always)]
fn square_roots(c: [&Lanes; 2], root_re: &mut Lanes, root_im: &mut Lanes) {
    let mut all_safe = true;
    for lane in 0..BLOCK_POINTS {
        let (re, im) = (-c[0].0[lane], -c[1].0[lane]);
        let square = re * re + im * im;
        all_safe &= is_safe_square(square);
        let larger_part = (0.5 * (square.sqrt() + re.abs())).sqrt();
        let smaller_part = 0.5 * im / larger_part;
        let is_right = re >= 0.0;
        root_re.0[lane] = if is_right { larger_part } else { smaller_part.abs() };
        root_im.0[lane] = if is_right { smaller_part } else { larger_part.copysign(im) };
    }
    if !all_safe {
        for lane in 0..BLOCK_POINTS {
            let root = square_root(-Complex::new(c[0].0[lane], c[1].0[lane]));
            (root_re.0[lane], root_im.0[lane]) = (root.re, root.im);
        }
    }
}

/// Any output, one lane after the other.
fn lane_by_lane(output: &Output, components: &[Lanes], re: &mut [Lanes], im: &mut [Lanes]) {
    let mut values = vec![0.0; components.len()];
    let mut eigenvalues = Vec::with_capacity(re.len());
    for lane in 0..BLOCK_POINTS {
        values.iter_mut().zip(components).for_each(|(value, component)| *value = component.0[lane]);
        eigenvalues.clear();
        output.recombine(&values, &mut eigenvalues);
        for ((re, im), lambda) in re.iter_mut().zip(im.iter_mut()).zip(&eigenvalues) {
            (re.0[lane], im.0[lane]) = (lambda.re, lambda.im);
        }
    }
}

/// max Re λ; NaN where any part of an eigenvalue is NaN or infinite.
#[inline(always)]
fn spectral_abscissa(growth_rates: &[Lanes], angular_frequencies: &[Lanes]) -> Lanes {
    let mut largest = Lanes::splat(f64::NEG_INFINITY);
    for (re, im) in growth_rates.iter().zip(angular_frequencies) {
        for lane in 0..BLOCK_POINTS {
            let (re, im, before) = (re.0[lane], im.0[lane], largest.0[lane]);
            let is_finite = re.abs() < f64::INFINITY && im.abs() < f64::INFINITY;
            let larger = if re > before { re } else { before };
            largest.0[lane] = if is_finite { larger } else { f64::NAN };
            // NaN stays: no comparison with it holds, and it is what is kept then.
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{Component, spectral_abscissa as abscissa_of};

    /// A pair of modes from the mean s and the constant c_0 of z² + c_0.
    fn pair_output() -> Output {
        let component = |id| Component { id, name: String::new(), center: 0.0, scale: 1.0 };
        Output {
            kind: OutputKind::Cluster,
            modes: vec![1, 2],
            reals: Vec::new(),
            name: String::new(),
            unit: String::new(),
            components: (0..4).map(component).collect(),
        }
    }

    /// Bits, so that NaN equals NaN and 0 is not −0.
    fn bits(values: impl IntoIterator<Item = f64>) -> Vec<u64> {
        values.into_iter().map(|value| if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }).collect()
    }

    #[test]
    fn pairs_in_lanes_are_those_of_one_sample_for_all_kinds_of_numbers() {
        let parts = [0.0, -0.0, 1.0, -3.5, 1e-300, -5e-324, 1e200, -1e308, f64::INFINITY, f64::NAN, 1e-160, -2e-140];
        let cases: Vec<[f64; 4]> = parts
            .iter()
            .flat_map(|&re| parts.iter().map(move |&im| [re, im]))
            .flat_map(|[re, im]| [[-1.0, 100.0, re, im], [re, im, 4.0, 0.5]])
            .collect();
        let output = pair_output();
        // Unusual numbers beside plain ones, and among their like.
        for chunk in cases.chunks(BLOCK_POINTS - 1) {
            let mut results = Results {
                components: vec![Lanes::splat(0.25); 4],
                growth_rates: vec![Lanes::splat(0.0); 2],
                angular_frequencies: vec![Lanes::splat(0.0); 2],
                max_re: Lanes::splat(0.0),
                excess: Lanes::splat(0.0),
                top_frequency: Lanes::splat(1.0),
            };
            for (lane, case) in chunk.iter().enumerate() {
                (0..4).for_each(|id| results.components[id].0[lane] = case[id]);
            }
            recombine(std::slice::from_ref(&output), VerdictBasis::default(), &mut results);
            for (lane, case) in chunk.iter().enumerate() {
                let mut expected = Vec::new();
                output.recombine(case, &mut expected);
                let found = |lists: &[Lanes]| bits(lists.iter().map(|list| list.0[lane]));
                assert_eq!(found(&results.growth_rates), bits(expected.iter().map(|l| l.re)), "{case:?}");
                assert_eq!(found(&results.angular_frequencies), bits(expected.iter().map(|l| l.im)), "{case:?}");
                assert_eq!(bits([results.max_re.0[lane]]), bits([abscissa_of(&expected)]), "{case:?}");
            }
        }
    }

    #[test]
    fn closed_groups_in_lanes_are_those_of_one_sample() {
        let parts = [0.0, -0.0, 1.0, -3.5, 1e-300, 1e200, f64::INFINITY, f64::NAN, -1e-8];
        for (modes, reals) in [(0, 1), (1, 0), (0, 2), (1, 1), (2, 1)] {
            let count = 2 * modes + reals;
            let component = |id| Component { id, name: String::new(), center: 0.0, scale: 1.0 };
            let output = Output {
                kind: OutputKind::Closed,
                modes: (1..=modes).collect(),
                reals: (1..=reals).collect(),
                name: String::new(),
                unit: String::new(),
                components: (0..count).map(component).collect(),
            };
            let value = |lane: usize, id: usize| parts[(lane * (3 * id + 1) + id) % parts.len()];
            let mut results = Results {
                components: vec![Lanes::splat(0.25); count],
                growth_rates: vec![Lanes::splat(0.0); count],
                angular_frequencies: vec![Lanes::splat(0.0); count],
                max_re: Lanes::splat(0.0),
                excess: Lanes::splat(0.0),
                top_frequency: Lanes::splat(1.0),
            };
            for lane in 0..BLOCK_POINTS {
                (0..count).for_each(|id| results.components[id].0[lane] = value(lane, id));
            }
            recombine(std::slice::from_ref(&output), VerdictBasis::default(), &mut results);
            for lane in 0..BLOCK_POINTS {
                let case: Vec<f64> = (0..count).map(|id| value(lane, id)).collect();
                let mut expected = Vec::new();
                output.recombine(&case, &mut expected);
                let found = |lists: &[Lanes]| bits(lists.iter().map(|list| list.0[lane]));
                assert_eq!(found(&results.growth_rates), bits(expected.iter().map(|l| l.re)), "{case:?}");
                assert_eq!(found(&results.angular_frequencies), bits(expected.iter().map(|l| l.im)), "{case:?}");
                let largest = abscissa_of(&expected);
                assert_eq!(bits([results.max_re.0[lane]]), bits([largest]), "{case:?}");
                if let Some(top) = expected.iter().find(|lambda| lambda.re == largest) {
                    assert_eq!(results.top_frequency.0[lane], top.im, "{case:?}");
                }
            }
        }
    }
}
