//! Runs at the least and the largest value of discrete inputs.
//!
//! A rare value may be at no point of the design, whatever its size. Between values that were run an expansion is as
//! good as anywhere; beyond them it knows nothing, and all that happens there is on one side or the other. So the ends
//! are run once, with the other inputs at their medians.

use crate::fitting::design::Samples;
use pcc_evaluate::probability::inputs::InputSpace;

/// Standardized values closer than this are the same.
const SAME: f64 = 1e-9;

/// Standardized points at the ends of discrete inputs at which no point of `tried` is.
pub(super) fn end_levels(inputs: &InputSpace, tried: &Samples) -> Vec<Vec<f64>> {
    let medians = inputs.middle();
    let mut points = Vec::new();
    for (number, input) in inputs.inputs().iter().enumerate().filter(|(_, input)| input.marginal.is_discrete()) {
        for end in input.marginal.support().map(|end| input.marginal.standardized(end)) {
            let is_there = |point: &[f64]| (point[number] - end).abs() <= SAME * (1.0 + end.abs());
            if !tried.points().any(is_there) {
                let mut point = medians.clone();
                point[number] = end;
                points.push(point);
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    #[test]
    fn ends_that_no_point_has_are_run_once_with_the_others_at_their_medians() {
        let study = "format = 1\nname = \"x\"\n[model]\nkind = \"matrices\"\nA = [[\"x + y\"]]\n[inputs]\n\
                     x = { distribution = \"discrete\", values = [1.0, 2.0, 9.0] }\n\
                     y = { distribution = \"normal\", mean = 5.0, std = 1.0 }\n";
        let study = Study::from_toml(study).unwrap();
        let [least, middle, largest] = [1.0, 2.0, 9.0].map(|x| study.inputs.inputs()[0].marginal.standardized(x));
        let tried = |points: &[f64]| Samples::new(2, points.to_vec());
        assert_eq!(end_levels(&study.inputs, &tried(&[middle, 0.3])), [[least, 0.0], [largest, 0.0]]);
        assert_eq!(end_levels(&study.inputs, &tried(&[least, 0.3, middle, 1.0])), [[largest, 0.0]]);
        assert!(end_levels(&study.inputs, &tried(&[least, 0.3, largest, 1.0])).is_empty());
    }
}
