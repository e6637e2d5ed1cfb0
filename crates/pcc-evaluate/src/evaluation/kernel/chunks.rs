//! Samples in fixed chunks, on all cores, merged in the order of their numbers.

use crate::evaluation::error::EvalError;
use crate::foundation::Observer;
use rayon::prelude::*;
use std::ops::Range;

/// Samples treated together where every sample costs several evaluations, a multiple of
/// [`crate::evaluation::BLOCK_POINTS`].
pub(crate) const CHUNK: u64 = 1024;

/// Chunks whose results are held in memory before they are merged.
const CHUNKS_IN_FLIGHT: u64 = 1024;

/// Calls `work` for every chunk of `chunk` samples among 0 … `samples` − 1 on the current rayon thread pool, each
/// thread with a `workspace` of its own, and `merge` with the results in the order of the chunks. The size of the
/// chunks is part of the result's definition, since it fixes the order of sums.
///
/// # Errors
///
/// [`EvalError::NoSamples`], [`EvalError::Interrupted`], or the error of the first chunk that fails.
pub(crate) fn in_chunks<W, P: Send>(
    samples: u64,
    chunk: u64,
    observer: &dyn Observer,
    workspace: impl Fn() -> W + Sync + Send,
    work: impl Fn(&mut W, Range<u64>) -> Result<P, EvalError> + Sync + Send,
    mut merge: impl FnMut(P),
) -> Result<(), EvalError> {
    if samples == 0 {
        return Err(EvalError::NoSamples);
    }
    observer.begin("samples", samples);
    let chunks = samples.div_ceil(chunk);
    let mut first = 0;
    while first < chunks {
        let end = chunks.min(first + CHUNKS_IN_FLIGHT);
        let parts: Vec<Result<P, EvalError>> = (first..end)
            .into_par_iter()
            .map_init(&workspace, |workspace, number| {
                observer.check()?;
                let range = number * chunk..samples.min((number + 1).saturating_mul(chunk));
                let count = range.end - range.start;
                let part = work(workspace, range)?;
                observer.advance(count);
                Ok(part)
            })
            .collect();
        for part in parts {
            merge(part.inspect_err(|_| observer.finish())?);
        }
        first = end;
    }
    observer.finish();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foundation::{Interrupted, Silent};

    #[test]
    fn every_sample_is_in_one_chunk_and_chunks_are_merged_in_order() {
        for samples in [1, CHUNK - 1, CHUNK, CHUNK * CHUNKS_IN_FLIGHT + 1] {
            let mut next = 0;
            let merge = |range: Range<u64>| {
                assert_eq!(range.start, next);
                next = range.end;
            };
            in_chunks(samples, CHUNK, &Silent, || (), |_, range| Ok(range), merge).unwrap();
            assert_eq!(next, samples);
        }
    }

    #[test]
    fn the_first_failing_chunk_is_reported() {
        let failing = |_: &mut (), range: Range<u64>| {
            if range.start >= 3 * CHUNK { Err(EvalError::NotFinite { point: range.start.to_string() }) } else { Ok(()) }
        };
        let error = in_chunks(100 * CHUNK, CHUNK, &Silent, || (), failing, |()| ()).unwrap_err();
        assert_eq!(error, EvalError::NotFinite { point: (3 * CHUNK).to_string() });
        assert_eq!(in_chunks(0, CHUNK, &Silent, || (), failing, |()| ()), Err(EvalError::NoSamples));
    }

    struct Stopping;

    impl Observer for Stopping {
        fn begin(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64) {}
        fn finish(&self) {}
        fn interrupted(&self) -> bool {
            true
        }
    }

    #[test]
    fn an_interruption_ends_the_work() {
        let error = in_chunks(u64::MAX, CHUNK, &Stopping, || (), |_, _| Ok(()), |()| ()).unwrap_err();
        assert_eq!(error, EvalError::Interrupted(Interrupted));
    }
}
