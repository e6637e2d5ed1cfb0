//! Ranges of quantities, found by a few samples, so that bins can be laid before all others.

use super::quantity::Quantity;
use super::question::{Bins, Condition, Question};
use super::survey::{Survey, Surveyed};
use super::survey_error::SurveyError;
use crate::components::Summary;
use crate::evaluation::error::EvalError;
use crate::foundation::{InstructionSet, Interrupted, Silent};
use crate::probability::statistics::Moments;
use crate::surrogate::Surrogate;
use std::f64::consts::TAU;
use thiserror::Error;

/// Samples of a pilot.
const SAMPLES: u64 = 4096;

/// Bins of a histogram for people, about.
const BINS: f64 = 40.0;

/// Bins of a histogram that quantiles are read from: of twice the range of the pilot, so a quantile is found to 1/5000
/// of that range.
const FINE_BINS: u32 = 10_000;

/// The smallest width of bins, relative to the values: where a quantity does not vary.
const NARROWEST: f64 = 1e-6;

/// The smallest size of values that bins are laid for: one over their width has to be a number.
const SMALLEST: f64 = 1e-280;

/// The first samples of a question's seed and conditions, whatever else it asks: all its shards find the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilot(Summary);

/// Why there is no pilot.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PilotError {
    /// The conditions do not fit the surrogate.
    #[error(transparent)]
    Survey(#[from] SurveyError),
    /// The samples cannot be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Pilot {
    /// Evaluates the pilot.
    ///
    /// # Errors
    ///
    /// [`PilotError`].
    pub fn new(surrogate: &Surrogate, seed: u64, conditions: &[Condition]) -> Result<Self, PilotError> {
        let question = Question { conditions: conditions.to_vec(), ..Question::plain(SAMPLES, seed) };
        let survey = Survey::new(surrogate, &question, InstructionSet::best())?;
        match survey.run(0..survey.division().chunks(), &Silent)? {
            Surveyed::Complete(findings) => Ok(Self(findings.total().ok_or(EvalError::NoSamples)?.summary)),
            Surveyed::Interrupted(_) => Err(EvalError::from(Interrupted).into()),
        }
    }

    /// About 40 bins with edges that are easy to read, over the range of the pilot and a little more.
    pub fn bins(&self, quantity: Quantity, name: &str) -> Bins {
        let (lower, upper) = self.range(quantity);
        let step = readable((upper - lower) / BINS);
        let (first, last) = ((lower / step).floor() - 1.0, (upper / step).ceil() + 1.0);
        Bins { quantity: name.to_owned(), lower: first * step, upper: last * step, bins: (last - first) as u32 }
    }

    /// Bins that quantiles are read from.
    pub fn fine_bins(&self, quantity: Quantity, name: &str) -> Bins {
        let (lower, upper) = self.range(quantity);
        let margin = 0.5 * (upper - lower);
        Bins { quantity: name.to_owned(), lower: lower - margin, upper: upper + margin, bins: FINE_BINS }
    }

    fn range(&self, quantity: Quantity) -> (f64, f64) {
        let (moments, unit) = self.moments(quantity);
        let (lower, upper) = (unit * moments.minimum(), unit * moments.maximum());
        let narrowest = NARROWEST * lower.abs().max(upper.abs()).max(SMALLEST);
        if upper - lower >= narrowest { (lower, upper) } else { (lower - narrowest, upper + narrowest) }
    }

    /// Moments, and what to multiply their numbers by.
    fn moments(&self, quantity: Quantity) -> (&Moments, f64) {
        let Self(summary) = self;
        match quantity {
            Quantity::MaxRe => (&summary.max_re, 1.0),
            Quantity::GrowthRate(at) => (&summary.eigenvalues[at].growth_rate, 1.0),
            Quantity::AngularFrequency(at) => (&summary.eigenvalues[at].angular_frequency, 1.0),
            Quantity::Frequency(at) => (&summary.eigenvalues[at].angular_frequency, 1.0 / TAU),
            Quantity::DampingRatio(at) => (&summary.eigenvalues[at].damping_ratio, 1.0),
            Quantity::Component(id) => (&summary.components[id], 1.0),
            Quantity::Flutter | Quantity::Divergence | Quantity::Marginal => (&summary.max_re, 1.0),
        }
    }
}

/// The nearest number above that is 1, 2 or 5 times a power of ten. By decimal digits, which are the same on all
/// machines, where logarithms and powers are not.
fn readable(step: f64) -> f64 {
    let digits = format!("{step:e}");
    let power = digits.split_once('e').and_then(|(_, exponent)| format!("1e{exponent}").parse().ok()).unwrap_or(step);
    [1.0, 2.0, 5.0].into_iter().map(|factor| factor * power).find(|&readable| readable >= step).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::test_surrogates::{XI, polynomial};

    #[test]
    fn bins_hold_the_pilot_and_have_readable_edges() {
        // max Re λ between −1.5 and 2.5.
        let surrogate = polynomial(1, &[(&[0], 0.5), (&[1], 2.0 * XI)]);
        let pilot = Pilot::new(&surrogate, 1, &[]).unwrap();
        let bins = pilot.bins(Quantity::MaxRe, "max_re");
        assert!((bins.lower + 1.6).abs() < 1e-9 && (bins.upper - 2.6).abs() < 1e-9 && bins.bins == 42, "{bins:?}");
        let fine = pilot.fine_bins(Quantity::MaxRe, "max_re");
        assert!((fine.lower + 3.5).abs() < 0.01 && (fine.upper - 4.5).abs() < 0.01 && fine.bins == FINE_BINS);
    }

    #[test]
    fn quantities_that_do_not_vary_have_bins_around_them() {
        for value in [0.0, -3.0, 1e-200, 1e200] {
            let pilot = Pilot::new(&polynomial(1, &[(&[0], value)]), 1, &[]).unwrap();
            for bins in [pilot.bins(Quantity::MaxRe, ""), pilot.fine_bins(Quantity::MaxRe, "")] {
                assert!(bins.lower < value && value < bins.upper && bins.bins > 0, "{value}: {bins:?}");
            }
        }
    }

    #[test]
    fn steps_are_one_two_or_five_times_a_power_of_ten() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * b;
        for (step, expected) in [(0.011, 0.02), (0.3, 0.5), (7.0, 10.0), (1.0, 1.0), (4.9e-7, 5e-7)] {
            assert!(near(readable(step), expected), "{step}");
        }
    }
}
