//! The check of an evaluator against the values that a surrogate file expects of it.

use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::evaluate_points;
use crate::surrogate::Surrogate;

/// The largest difference between what this evaluator finds at the self-test's points and what the file expects,
/// relative to max(1, |expected|); infinite if one is not a number.
pub fn self_test_difference(surrogate: &Surrogate) -> f64 {
    let expected = &surrogate.self_test;
    let points: Vec<Vec<f64>> = expected.points.iter().map(|point| surrogate.inputs.standardized(point)).collect();
    let references: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    let found = evaluate_points(surrogate, &Plan::new(surrogate), &references);
    let difference = |found: f64, expected: f64| (found - expected).abs() / expected.abs().max(1.0);
    // A NaN is as wrong as can be; `max` alone would drop it.
    let worse =
        |largest: f64, difference: f64| if difference.is_nan() { f64::INFINITY } else { largest.max(difference) };
    let mut largest = 0f64;
    for (i, components) in expected.components.iter().enumerate() {
        for (id, &value) in components.iter().enumerate() {
            largest = worse(largest, difference(found.components[id][i], value));
        }
        largest = worse(largest, difference(found.max_re[i], expected.max_re[i]));
    }
    largest
}
