//! What a survey finds, and how parts of it are put together.

use super::division::Division;
use super::histogram::Histogram;
use super::tally::Tally;
use crate::probability::statistics::{Merge, MergeTree, Proportion, Share};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What was found in a range of chunks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Findings {
    /// The first chunk.
    first: u64,
    /// The chunk after the last.
    end: u64,
    /// One per series that the range has chunks of.
    series: Vec<Series>,
    /// One per histogram of the question, those for quantiles last.
    histograms: Vec<Histogram>,
}

/// What was found of one series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Series {
    /// Some of its chunks.
    Some(MergeTree<Tally>),
    /// All of them, combined: nothing follows that the trees would be needed for.
    All(Tally),
}

impl Series {
    /// Combines the trees if all chunks are there.
    fn settle(&mut self, division: &Division) {
        if let Self::Some(tree) = self
            && tree.first() == 0
            && tree.end() == division.chunks_per_series()
            && let Some(total) = tree.total()
        {
            *self = Self::All(total);
        }
    }

    fn total(&self) -> Option<Tally> {
        match self {
            Self::Some(tree) => tree.total(),
            Self::All(tally) => Some(tally.clone()),
        }
    }

    /// Whether this is what is known of chunks `chunks` of a series, and counts add up.
    fn fits(&self, chunks: &Range<u64>, division: &Division) -> bool {
        let all = 0..division.chunks_per_series();
        match self {
            Self::All(tally) => *chunks == all && division.fits(chunks, tally),
            Self::Some(tree) => {
                *chunks != all
                    && tree.is_consistent()
                    && (tree.first()..tree.end()) == *chunks
                    && tree.parts().all(|(chunks, tally)| division.fits(&chunks, tally))
            }
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Some(tree) => tree.parts().all(|(_, tally)| tally.is_finite()),
            Self::All(tally) => tally.is_finite(),
        }
    }
}

impl Findings {
    /// Nothing yet, from chunk `first` on.
    pub(crate) fn new(first: u64) -> Self {
        Self { first, end: first, series: Vec::new(), histograms: Vec::new() }
    }

    /// The chunks it is about.
    pub fn chunks(&self) -> Range<u64> {
        self.first..self.end
    }

    pub(crate) fn push(&mut self, tally: Tally, division: &Division) {
        let inside = self.end % division.chunks_per_series();
        if inside == 0 || self.series.is_empty() {
            self.series.push(Series::Some(MergeTree::new(inside)));
        }
        if let Some(series) = self.series.last_mut() {
            if let Series::Some(tree) = series {
                tree.push(tally);
            }
            series.settle(division);
        }
        self.end += 1;
    }

    pub(crate) fn set_histograms(&mut self, histograms: Vec<Histogram>) {
        self.histograms = histograms;
    }

    /// Adds what was found in the chunks that follow; nothing changes, and the answer is false, if `next` begins
    /// elsewhere.
    pub fn append(&mut self, next: Self, division: &Division) -> bool {
        if next.first != self.end {
            return false;
        }
        let mut series = next.series.into_iter();
        if !next.first.is_multiple_of(division.chunks_per_series())
            && let Some(own) = self.series.last_mut()
            && let Some(continued) = series.next()
        {
            if let (Series::Some(own), Series::Some(continued)) = (&mut *own, continued) {
                own.append(continued);
            }
            own.settle(division);
        }
        self.series.extend(series);
        self.end = next.end;
        if self.histograms.is_empty() {
            self.histograms = next.histograms;
        } else {
            self.histograms.iter_mut().zip(&next.histograms).for_each(|(own, added)| own.merge(added));
        }
        true
    }

    /// Whether this could have been found under such a division: series that are complete but for the first and the
    /// last, with as many components, modes, events and bins, and counts that add up to the numbers of samples. What
    /// [`crate::evaluation::Survey::run`] finds always is; what a file says need not be.
    pub fn fits(&self, division: &Division) -> bool {
        let per_series = division.chunks_per_series();
        if self.first > self.end || self.end > division.chunks() {
            return false;
        }
        let series = self.first / per_series..self.end.div_ceil(per_series);
        let count = if self.first == self.end { 0 } else { series.end - series.start };
        let tallies = series.zip(&self.series).all(|(number, series)| {
            let start = number.saturating_mul(per_series);
            let first = self.first.max(start) - start;
            let end = self.end.min(start.saturating_add(per_series)) - start;
            series.fits(&(first..end), division)
        });
        let samples = division.samples_in(&self.chunks());
        let bins = self.histograms.iter().map(|histogram| histogram.counts.len());
        self.series.len() as u64 == count
            && tallies
            && bins.eq(division.bins.iter().copied())
            && self.histograms.iter().all(|histogram| histogram.checked_samples() == Some(samples))
    }

    /// All samples together, series after series; `None` without samples.
    pub fn total(&self) -> Option<Tally> {
        total(self.series.iter().filter_map(Series::total))
    }

    /// Whether all moments are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.series.iter().all(Series::is_finite)
    }

    /// Stable samples so far.
    pub fn stable(&self) -> u64 {
        self.total().map_or(0, |tally| tally.summary.stable)
    }

    /// What is said of every point of the sweeps that is complete, of the one point without sweeps in any case.
    pub fn answer(&self, division: &Division) -> Answer {
        let is_complete = self.chunks() == (0..division.chunks());
        let replicates = division.replicates as usize;
        let cells = self.series.chunks(replicates).filter_map(|series| {
            let whole = series.iter().filter_map(|series| match series {
                Series::All(tally) => Some(tally.clone()),
                Series::Some(_) => None,
            });
            let whole: Vec<Tally> = whole.collect();
            if division.is_sweep && whole.len() < replicates {
                return None;
            }
            // Of replicates that can be compared with others, or of all there is.
            match whole.len() {
                0 | 1 => Some(Cell { total: total(series.iter().filter_map(Series::total))?, replicates: Vec::new() }),
                _ => Some(Cell { total: total(whole.iter().cloned())?, replicates: whole }),
            }
        });
        let histograms = if is_complete { self.histograms.clone() } else { Vec::new() };
        Answer { is_complete, cells: cells.collect(), histograms }
    }
}

fn total(mut tallies: impl Iterator<Item = Tally>) -> Option<Tally> {
    let mut total = tallies.next()?;
    tallies.for_each(|next| total.merge(&next));
    Some(total)
}

/// What was found, ready to be reported.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Whether all samples were evaluated.
    pub is_complete: bool,
    /// One for every point of the sweeps, the last sweep varying fastest; without sweeps one.
    pub cells: Vec<Cell>,
    /// One per histogram of the question, those for quantiles last; none if not complete.
    pub histograms: Vec<Histogram>,
}

/// The samples of one point of the sweeps.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// All samples.
    pub total: Tally,
    /// Each randomisation that is complete, if there are several.
    pub replicates: Vec<Tally>,
}

impl Cell {
    /// The share of samples that `hits` counts, with its interval at `level`.
    pub fn share(&self, level: f64, hits: impl Fn(&Tally) -> u64) -> Share {
        let proportion = |tally: &Tally| Proportion { hits: hits(tally), samples: tally.summary.samples() };
        let replicates = if self.replicates.is_empty() { std::slice::from_ref(&self.total) } else { &self.replicates };
        Share::of_replicates(&replicates.iter().map(proportion).collect::<Vec<_>>(), level)
    }
}
