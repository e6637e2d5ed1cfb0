//! How the samples of a question are divided into series, chunks and shards.
//!
//! All samples of one *series* share a region and a randomisation: every point of a sweep has a series for each
//! replicate. Series are divided into chunks; chunks are numbered through all series, and a shard is a range of
//! numbers.

use super::extrapolated::Extrapolated;
use super::tally::Tally;
use std::ops::Range;

/// Samples summarised together, a multiple of [`crate::evaluation::BLOCK_POINTS`]: part of the result's definition,
/// since it fixes the order of sums.
const CHUNK: u64 = 4096;

/// More of them where there are many elements, each of which has some points of a chunk to evaluate together.
const SAMPLES_PER_ELEMENT: u64 = 64;
const LARGEST_CHUNK: u64 = 1 << 16;

/// The division of a question's samples, and what is kept of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Division {
    pub(crate) cells: u64,
    pub(crate) replicates: u64,
    pub(crate) samples_per_series: u64,
    pub(crate) chunk: u64,
    /// Components and eigenvalues whose moments are kept: none of them for sweeps, which have many series.
    pub(crate) components: usize,
    pub(crate) eigenvalues: usize,
    pub(crate) events: usize,
    /// Whether samples outside the box of the model runs are counted.
    pub(crate) counts_extrapolated: bool,
    /// Bins of each histogram.
    pub(crate) bins: Vec<usize>,
    pub(crate) is_sweep: bool,
}

impl Division {
    /// Samples of a chunk for a surrogate of so many elements.
    pub(crate) fn chunk_size(elements: usize) -> u64 {
        let by_elements = SAMPLES_PER_ELEMENT.saturating_mul(elements as u64);
        by_elements.clamp(CHUNK, LARGEST_CHUNK).next_multiple_of(CHUNK)
    }

    /// Number of chunks of the whole question.
    pub fn chunks(&self) -> u64 {
        self.series().saturating_mul(self.chunks_per_series())
    }

    /// Number of samples of the whole question.
    pub fn samples(&self) -> u64 {
        self.series().saturating_mul(self.samples_per_series)
    }

    /// The chunks of shard `shard` of `shards`, from 0: ranges that differ by one chunk at most.
    pub fn shard(&self, shard: u64, shards: u64) -> Range<u64> {
        let border = |shard: u64| (u128::from(self.chunks()) * u128::from(shard) / u128::from(shards.max(1))) as u64;
        border(shard)..border(shard.saturating_add(1).min(shards))
    }

    /// Number of samples in a range of chunks.
    pub fn samples_in(&self, chunks: &Range<u64>) -> u64 {
        let before = |chunk: u64| {
            let (series, inside) = (chunk / self.chunks_per_series(), chunk % self.chunks_per_series());
            series * self.samples_per_series + inside * self.chunk
        };
        before(chunks.end).saturating_sub(before(chunks.start))
    }

    pub(crate) fn series(&self) -> u64 {
        self.cells.saturating_mul(self.replicates)
    }

    pub(crate) fn chunks_per_series(&self) -> u64 {
        self.samples_per_series.div_ceil(self.chunk)
    }

    /// Point of the sweeps, replicate and samples of a chunk.
    pub(crate) fn locate(&self, chunk: u64) -> (usize, usize, Range<u64>) {
        let (series, inside) = (chunk / self.chunks_per_series(), chunk % self.chunks_per_series());
        let start = inside * self.chunk;
        let samples = start..self.samples_per_series.min(start.saturating_add(self.chunk));
        ((series / self.replicates) as usize, (series % self.replicates) as usize, samples)
    }

    /// Whether a tally has counts and moments of all that is kept, of so many samples as these chunks of a series have.
    pub(crate) fn fits(&self, chunks: &Range<u64>, tally: &Tally) -> bool {
        let summary = &tally.summary;
        let samples = self.samples_in(chunks);
        let of_eigenvalues =
            summary.eigenvalues.iter().flat_map(|own| [own.unstable.saturating_add(own.marginal), own.real]);
        let counts = tally.events.iter().copied().chain(of_eigenvalues).chain(summary.stable_if_shifted);
        let diverging = summary.eigenvalues.iter().map(|own| (own.divergent, own.unstable.min(own.real)));
        let diverges = (summary.divergent, summary.unstable);
        summary.components.len() == self.components
            && summary.eigenvalues.len() == self.eigenvalues
            && diverging.chain([diverges]).all(|(divergent, most)| divergent <= most)
            && tally.events.len() == self.events
            && self.fits_extrapolated(tally)
            && summary.moments().all(|moments| moments.are_of(samples))
            && counts.chain([summary.stable.saturating_add(summary.unstable)]).all(|count| count <= samples)
    }

    /// Whether what was counted outside the box of the model runs is a part of all samples.
    fn fits_extrapolated(&self, tally: &Tally) -> bool {
        let Some(Extrapolated { samples, stable, unstable }) = tally.extrapolated else {
            return !self.counts_extrapolated;
        };
        let summary = &tally.summary;
        self.counts_extrapolated
            && samples <= summary.samples()
            && stable <= summary.stable
            && unstable <= summary.unstable
            && stable.saturating_add(unstable) <= samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn division(cells: u64, replicates: u64, samples_per_series: u64) -> Division {
        let chunk = Division::chunk_size(1);
        Division {
            cells,
            replicates,
            samples_per_series,
            chunk,
            components: 0,
            eigenvalues: 0,
            events: 0,
            counts_extrapolated: false,
            bins: Vec::new(),
            is_sweep: cells > 1,
        }
    }

    #[test]
    fn every_sample_is_in_one_chunk_and_every_chunk_in_one_shard() {
        for (cells, replicates, samples) in [(1, 1, 1), (1, 1, 4096), (1, 16, 4097), (7, 1, 10_000), (3, 2, 8192)] {
            let division = division(cells, replicates, samples);
            let mut counted = vec![0; (cells * replicates) as usize];
            for chunk in 0..division.chunks() {
                let (cell, replicate, range) = division.locate(chunk);
                let series = &mut counted[cell * replicates as usize + replicate];
                assert_eq!(range.start, *series);
                *series = range.end;
            }
            assert!(counted.iter().all(|&count| count == samples));
            assert_eq!(division.samples_in(&(0..division.chunks())), division.samples());
            for shards in [1, 2, 3, 17, 1000] {
                let mut next = 0;
                for shard in 0..shards {
                    let range = division.shard(shard, shards);
                    assert_eq!(range.start, next);
                    next = range.end;
                }
                assert_eq!(next, division.chunks());
            }
        }
    }

    #[test]
    fn chunks_grow_with_the_number_of_elements() {
        assert_eq!([1, 64, 65, 200, 1 << 40].map(Division::chunk_size), [4096, 4096, 8192, 16_384, 65_536]);
    }
}
