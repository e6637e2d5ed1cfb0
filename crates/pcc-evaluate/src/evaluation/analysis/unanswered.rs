//! What of the shares rests on answers of the model, where it did not answer everywhere.

use crate::components::Verdict;
use crate::evaluation::error::EvalError;
use crate::evaluation::kernel::chunks::{CHUNK, in_chunks};
use crate::evaluation::kernel::plan::Plan;
use crate::evaluation::kernel::points::evaluate_points;
use crate::evaluation::questions::region::Region;
use crate::foundation::Observer;
use crate::probability::random::{Purpose, Stream};
use crate::probability::statistics::{Interval, Proportion};
use crate::surrogate::{Coverage, Surrogate};

/// Confidence level of the ends of bounds, which are shares of samples.
const LEVEL: f64 = 0.95;

/// Samples by what is known of them. See [`Coverage`] for what counts as unanswered.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unanswered {
    /// All of them.
    pub samples: u64,
    /// Samples whose nearest run failed.
    pub unanswered: u64,
    /// Samples that may be unanswered.
    pub unknown: u64,
    /// Of the others, those that are stable.
    pub stable: u64,
    /// Of the others, those that are unstable.
    pub unstable: u64,
    /// Share of all samples that is unanswered besides, because failures are not where others are
    /// ([`Coverage::unforeseen`]).
    pub unforeseen: f64,
}

impl Unanswered {
    /// Share of samples whose nearest run failed.
    pub fn proportion(&self) -> f64 {
        Proportion { hits: self.unanswered, samples: self.samples }.value()
    }

    /// Between what the stable share lies, whatever the model would have answered.
    pub fn stable_bounds(&self) -> Interval {
        self.bounds(self.stable)
    }

    /// The same of the unstable share.
    pub fn unstable_bounds(&self) -> Interval {
        self.bounds(self.unstable)
    }

    /// The known samples alone, less what is unforeseen, and with all that are not known; the ends as far out as so
    /// many samples leave open.
    fn bounds(&self, known: u64) -> Interval {
        let interval = |hits: u64| Proportion { hits, samples: self.samples }.interval(LEVEL);
        Interval {
            lower: (interval(known).lower - self.unforeseen).max(0.0),
            upper: (interval(known + self.unknown).upper + self.unforeseen).min(1.0),
            level: LEVEL,
        }
    }

    fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.unanswered += other.unanswered;
        self.unknown += other.unknown;
        self.stable += other.stable;
        self.unstable += other.unstable;
    }
}

/// What is known at `samples` random points of `region` under `seed`, those that
/// [`monte_carlo`](fn@crate::evaluation::monte_carlo) evaluates.
pub(crate) fn unanswered_in(
    surrogate: &Surrogate,
    coverage: &Coverage,
    region: &Region,
    (samples, seed): (u64, u64),
    observer: &dyn Observer,
) -> Result<Unanswered, EvalError> {
    let plan = Plan::new(surrogate);
    let dimension = surrogate.inputs.dimension();
    let mut found = Unanswered { unforeseen: coverage.unforeseen(), ..Unanswered::default() };
    in_chunks(
        samples,
        CHUNK,
        observer,
        || (),
        |(), range| {
            let points: Vec<Vec<f64>> = range
                .map(|index| {
                    let mut stream = Stream::new(seed, Purpose::Evaluation, index);
                    let mut point: Vec<f64> = (0..dimension).map(|_| stream.next_unit()).collect();
                    region.place(&mut point);
                    point
                })
                .collect();
            let block = evaluate_points(surrogate, &plan, &points.iter().map(Vec::as_slice).collect::<Vec<_>>());
            let mut part = Unanswered { samples: points.len() as u64, ..Unanswered::default() };
            for (point, &excess) in points.iter().zip(&block.excess) {
                part.unanswered += u64::from(coverage.is_unanswered(point));
                match Verdict::of(excess, 0.0) {
                    _ if coverage.may_be_unanswered(point) => part.unknown += 1,
                    Verdict::Stable => part.stable += 1,
                    Verdict::Marginal => {}
                    Verdict::Flutter | Verdict::Divergence => part.unstable += 1,
                }
            }
            Ok(part)
        },
        |part| found.merge(&part),
    )?;
    Ok(found)
}
