//! Where the model of a surrogate did not answer.
//!
//! Runs that failed and were skipped leave holes in the design; what the surrogate says there is extrapolated. A point
//! counts as unanswered if the nearest run is one that failed, and as possibly unanswered if a ball that reaches the
//! nearest run that failed has at most [`CAUTION`] times the volume of one that reaches the nearest run that answered.

/// Ratio of volumes up to which a point that is nearer to an answer may lie where there is none.
const CAUTION: f64 = 4.0;

/// The runs of a design with failures, in standardized variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Runs that answered, at least one.
    pub answered: Vec<Vec<f64>>,
    /// Runs that failed, at least one.
    pub unanswered: Vec<Vec<f64>>,
}

impl Coverage {
    /// Whether the nearest run of a standardized point failed.
    pub fn is_unanswered(&self, point: &[f64]) -> bool {
        let [answered, unanswered] = self.distances(point);
        unanswered < answered
    }

    /// Whether a run there might fail as well, as far as the runs tell.
    pub fn may_be_unanswered(&self, point: &[f64]) -> bool {
        let [answered, unanswered] = self.distances(point);
        // Volumes grow like the power r of a radius, whose square this is.
        unanswered <= answered * CAUTION.powf(2.0 / point.len().max(1) as f64)
    }

    /// The share of the domain where runs fail that these runs do not foretell: those that failed and, left out, would
    /// not be counted as possibly unanswered, plus one standard deviation of their number.
    pub fn unforeseen(&self) -> f64 {
        let is_unforeseen = |k: usize| {
            let mut others = self.unanswered.clone();
            let left_out = others.swap_remove(k);
            !Self { answered: self.answered.clone(), unanswered: others }.may_be_unanswered(&left_out)
        };
        let count = (0..self.unanswered.len()).filter(|&k| is_unforeseen(k)).count() as f64;
        (count + count.sqrt()) / (self.answered.len() + self.unanswered.len()) as f64
    }

    /// For every input the smallest and the largest value at runs that failed.
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        let inputs = self.unanswered.first().map_or(0, Vec::len);
        let values = |j: usize| self.unanswered.iter().map(move |point| point[j]);
        (0..inputs)
            .map(|j| [values(j).fold(f64::INFINITY, f64::min), values(j).fold(f64::NEG_INFINITY, f64::max)])
            .collect()
    }

    /// Squares of the distances to the nearest run that answered, and to the nearest that failed.
    fn distances(&self, point: &[f64]) -> [f64; 2] {
        let square = |run: &Vec<f64>| run.iter().zip(point).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        [&self.answered, &self.unanswered].map(|runs| runs.iter().map(square).fold(f64::INFINITY, f64::min))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_belong_to_the_nearest_run_and_caution_reaches_farther() {
        let coverage = Coverage { answered: vec![vec![-0.5, 0.0]], unanswered: vec![vec![0.5, 0.0], vec![0.9, 0.4]] };
        assert!(coverage.is_unanswered(&[0.1, 0.0]) && !coverage.is_unanswered(&[-0.1, 0.0]));
        // In two variables balls of four times the volume have twice the radius.
        assert!(coverage.may_be_unanswered(&[-0.16, 0.0]) && !coverage.may_be_unanswered(&[-0.18, 0.0]));
        assert_eq!(coverage.ranges(), [[0.5, 0.9], [0.0, 0.4]]);
        // Each of the two foretells the other.
        assert_eq!(coverage.unforeseen(), 0.0);
        let alone = Coverage { unanswered: vec![vec![0.5, 0.0]], ..coverage };
        assert_eq!(alone.unforeseen(), 1.0);
    }
}
