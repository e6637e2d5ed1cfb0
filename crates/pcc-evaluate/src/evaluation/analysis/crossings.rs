//! Every value of one input at which a system loses or regains stability, in order, with what decides there.
//!
//! A window of stability has two: of a bicycle that speeds up, the first is where weave, a mode that flutters, dies
//! down, the second where capsize, a real eigenvalue, begins to grow.

use super::critical::{BINS, bin_of, quantile_in_bins};
use super::domain::Domain;
use crate::components::{Label, Verdict};
use crate::probability::statistics::Moments;
use std::collections::BTreeMap;

/// Crossings of one sample that are told apart; what follows is not counted.
const MOST_CROSSINGS: u32 = 16;

/// What tells crossings apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CrossingKey {
    /// From 1, upwards from the smallest value that is looked at.
    pub order: u32,
    /// Whether the system is unstable above it.
    pub loses: bool,
    /// Position of the eigenvalue that decides, among the surrogate's labels.
    pub position: usize,
    /// Whether it is real.
    pub is_real: bool,
}

/// Crossings of many samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Crossings {
    found: BTreeMap<CrossingKey, Values>,
}

/// Values at which samples cross: counts per bin of places, and moments in the input's own unit.
#[derive(Debug, Clone, PartialEq)]
struct Values {
    counts: Vec<u64>,
    values: Moments,
}

/// Crossings of the same order, kind and mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossing {
    /// From 1, upwards from the smallest value that is looked at.
    pub order: u32,
    /// Whether stability is lost there, or regained.
    pub loses: bool,
    /// What decides on the unstable side.
    pub label: Label,
    /// How the system is unstable there.
    pub verdict: Verdict,
    /// Number of samples.
    pub samples: u64,
    /// Mean value of the input there, in its own unit.
    pub mean: f64,
    /// Smallest and largest.
    pub range: [f64; 2],
    values: Values,
    domain: Domain,
}

impl Crossings {
    pub(super) fn add(&mut self, crossings: &[(CrossingKey, f64)], domain: &Domain) {
        let mut sorted: Vec<&(CrossingKey, f64)> =
            crossings.iter().filter(|(key, _)| key.order <= MOST_CROSSINGS).collect();
        sorted.sort_by_key(|(key, _)| *key);
        for same in sorted.chunk_by(|a, b| a.0 == b.0) {
            let values = self
                .found
                .entry(same[0].0)
                .or_insert_with(|| Values { counts: vec![0; BINS], values: Moments::default() });
            for (_, place) in same {
                values.counts[bin_of(*place)] += 1;
            }
            let physical: Vec<f64> = same.iter().map(|(_, place)| domain.along(*place)).collect();
            values.values.merge(&Moments::of(&physical));
        }
    }

    /// All of them, in the order of crossings, of equal ones the most frequent first.
    pub(super) fn list(&self, labels: &[Label], domain: &Domain) -> Vec<Crossing> {
        let crossing = |(key, values): (&CrossingKey, &Values)| Crossing {
            order: key.order,
            loses: key.loses,
            label: match labels[key.position] {
                // A mode is one thing, whichever of its two eigenvalues decides.
                Label::Second(mode) => Label::Mode(mode),
                label => label,
            },
            verdict: if key.is_real { Verdict::Divergence } else { Verdict::Flutter },
            samples: values.values.count(),
            mean: values.values.mean(),
            range: [values.values.minimum(), values.values.maximum()],
            values: values.clone(),
            domain: domain.clone(),
        };
        let mut list: Vec<Crossing> = self.found.iter().map(crossing).collect();
        list.sort_by(|a, b| a.order.cmp(&b.order).then(b.samples.cmp(&a.samples)));
        list
    }
}

impl Crossing {
    /// The value that a share `level` of these crossings does not exceed, in the input's own unit, to 10⁻⁴ of the
    /// domain's width.
    pub fn quantile(&self, level: f64) -> f64 {
        let Values { counts, values } = &self.values;
        quantile_in_bins(counts, level * self.samples as f64, values, &self.domain).unwrap_or(self.range[1])
    }
}
