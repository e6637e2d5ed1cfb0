//! How much of the inputs' laws each run stands for.
//!
//! Points of a design are spread as the laws ask for; runs that somebody gives lie where they lie. So every run has a
//! *mass*: the share of random points of the laws that are nearer to it than to all others, by their distribution
//! functions u = F(x). A run amid many has little, one alone in a large region has all of it. What runs that are left
//! out miss counts by their masses: what is said of errors is said of the laws, not of the table.

use super::given::{nearest, probabilities};
use super::judged_points::judged_point;
use crate::fitting::design::Samples;
use pcc_evaluate::foundation::{Interrupted, Observer, try_map};
use pcc_evaluate::probability::inputs::InputSpace;

/// Random points of the laws: a mass of a hundredth is known to a tenth of itself.
const POINTS: usize = 10_000;

/// Points of one part of the work.
const PART: usize = 256;

/// The masses of runs at these standardized points; their sum is 1.
pub(super) fn masses(
    inputs: &InputSpace,
    seed: u64,
    runs: &Samples,
    observer: &dyn Observer,
) -> Result<Vec<f64>, Interrupted> {
    let points = probabilities(inputs, (0..POINTS).map(|i| inputs.physical(&judged_point((inputs, seed), i))));
    let runs = probabilities(inputs, runs.points().map(|point| inputs.physical(point)));
    let parts = try_map(POINTS.div_ceil(PART), |part| {
        observer.check()?;
        let own = part * PART..((part + 1) * PART).min(POINTS);
        let nearest_run = |i: usize| nearest(points.point(i), runs.points().enumerate()).map(|(run, _)| run);
        Ok(own.filter_map(nearest_run).collect::<Vec<usize>>())
    })?;
    let mut masses = vec![0.0; runs.len()];
    parts.into_iter().flatten().for_each(|run| masses[run] += 1.0 / POINTS as f64);
    Ok(masses)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::foundation::Silent;
    use pcc_evaluate::probability::inputs::{Input, Marginal, Uniform};

    #[test]
    fn a_run_alone_stands_for_all_that_is_nearest_to_it() {
        let law = Marginal::Uniform(Uniform::new(0.0, 1.0).unwrap());
        let one = InputSpace::new(vec![Input::new("a", law)]).unwrap();
        // u = 0.1 three times, and 0.7: halves meet at 0.4. Of equal runs the first has all.
        let runs = Samples::new(1, vec![-0.8, -0.8, -0.8, 0.4]);
        let masses = masses(&one, 1, &runs, &Silent).unwrap();
        assert!((masses[3] - 0.6).abs() < 0.02 && (masses.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{masses:?}");
    }
}
