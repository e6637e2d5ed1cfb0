//! What surrogate and model say of stability at the same points.

use crate::mechanics::spectrum::Spectrum;
use pcc_evaluate::components::{Block, Verdict};
use pcc_evaluate::probability::statistics::DiscordantCounts;
use pcc_evaluate::surrogate::RareSide;

/// Verdicts of surrogate and model on the same points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Verdicts {
    /// Points by what the surrogate says, stable, marginal or unstable, and in each by what the model says.
    counts: [[u64; 3]; 3],
    /// Points at which the model failed, by what the surrogate says: disagreement, whatever it is.
    failed: [u64; 3],
    /// Unstable points whose eigenvalue with the largest excess is real, by the surrogate and by the model.
    divergent: [u64; 2],
}

/// What the model says of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judged {
    /// The largest excess.
    pub excess: f64,
    /// Where that is zero, what it cannot be told from.
    pub error: f64,
    /// Whether it is unstable and the eigenvalue is real.
    pub is_divergent: bool,
}

impl Judged {
    pub fn of(spectrum: &Spectrum) -> Self {
        let top = spectrum.top();
        Self {
            excess: top.excess,
            error: spectrum.marginal_error().unwrap_or(0.0),
            is_divergent: top.verdict() == Verdict::Divergence,
        }
    }
}

/// Stable, marginal or unstable, in the order of [`Verdicts`].
fn class(excess: f64) -> usize {
    match Verdict::of(excess, 0.0) {
        Verdict::Stable => 0,
        Verdict::Marginal => 1,
        Verdict::Flutter | Verdict::Divergence => 2,
    }
}

impl Verdicts {
    /// Counts a point, given the largest excess by the surrogate and by the model, and what the model's is told from
    /// zero by: where the model cannot tell, a smaller excess of the surrogate is no disagreement.
    fn add(&mut self, surrogate: f64, model: f64, rounding: f64) {
        let is_rounding = model == 0.0 && surrogate.abs() <= rounding;
        let (said, truth) = (class(surrogate), class(model));
        self.counts[if is_rounding { truth } else { said }][truth] += 1;
    }

    /// Counts a point by what each says, and nothing forgiven: what bounds are made of.
    pub(super) fn add_strictly(&mut self, surrogate: f64, model: f64) {
        self.counts[class(surrogate)][class(model)] += 1;
    }

    /// Counts the points of a block.
    pub(super) fn classify(&mut self, model: impl Iterator<Item = Judged>, block: &Block) {
        for (i, model) in model.enumerate() {
            let top = block.top(i);
            self.add(top.excess, model.excess, model.error);
            let is_rounding = model.excess == 0.0 && top.excess.abs() <= model.error;
            self.divergent[0] += u64::from(top.verdict() == Verdict::Divergence && !is_rounding);
            self.divergent[1] += u64::from(model.is_divergent);
        }
    }

    /// Counts points at which the model failed, with the surrogate there.
    pub(super) fn count_failures(&mut self, block: &Block) {
        block.excess.iter().for_each(|&excess| self.count_failure(excess));
    }

    /// Counts a point at which the model failed, with the excess by the surrogate.
    pub(super) fn count_failure(&mut self, excess: f64) {
        self.failed[class(excess)] += 1;
    }

    /// Adds the points of others.
    pub(super) fn merge(&mut self, others: &Self) {
        self.counts.iter_mut().flatten().zip(others.counts.iter().flatten()).for_each(|(own, added)| *own += added);
        self.failed.iter_mut().zip(others.failed).for_each(|(own, added)| *own += added);
        self.divergent.iter_mut().zip(others.divergent).for_each(|(own, added)| *own += added);
    }

    /// Number of points.
    pub(super) fn points(&self) -> u64 {
        self.counts.iter().flatten().sum::<u64>() + self.failed()
    }

    /// Points that the model puts on this side.
    pub(super) fn of_side(&self, side: RareSide) -> u64 {
        match side {
            RareSide::Stable => self.model(0),
            RareSide::NotStable => self.model(1) + self.model(2),
        }
    }

    /// Points at which the model failed.
    pub fn failed(&self) -> u64 {
        self.failed.iter().sum()
    }

    pub(super) fn surrogate(&self, class: usize) -> u64 {
        self.counts[class].iter().sum()
    }

    pub(super) fn model(&self, class: usize) -> u64 {
        self.counts.iter().map(|row| row[class]).sum()
    }

    /// Points with a verdict, by the model and by the surrogate.
    pub(super) fn of(&self, verdict: Verdict) -> [u64; 2] {
        let [surrogate, model] = self.divergent;
        match verdict {
            Verdict::Stable => [self.model(0), self.surrogate(0)],
            Verdict::Marginal => [self.model(1), self.surrogate(1)],
            Verdict::Flutter => [self.model(2) - model, self.surrogate(2) - surrogate],
            Verdict::Divergence => [model, surrogate],
        }
    }

    /// Points that the surrogate puts into a class and the model does not, and the other way round.
    fn discordant(&self, class: usize) -> DiscordantCounts {
        let both = self.counts[class][class];
        DiscordantCounts {
            samples: self.points(),
            falsely_claimed: self.surrogate(class) - both,
            falsely_denied: self.model(class) - both,
            claimed_unknown: self.failed[class],
            denied_unknown: self.failed() - self.failed[class],
        }
    }

    /// Of stable points.
    pub fn of_stable(&self) -> DiscordantCounts {
        self.discordant(0)
    }

    /// Of marginal points.
    pub fn of_marginal(&self) -> DiscordantCounts {
        self.discordant(1)
    }

    /// Of unstable points.
    pub fn of_unstable(&self) -> DiscordantCounts {
        self.discordant(2)
    }

    /// Whether either of the two calls some point marginal.
    pub fn has_marginal(&self) -> bool {
        self.surrogate(1) + self.model(1) > 0
    }
}
