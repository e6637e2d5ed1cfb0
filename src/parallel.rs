//! Parallel work whose outcome does not depend on who finishes first.

use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(0)`, `work(1)`, … `work(count − 1)` in parallel, results in order; or the error of the smallest number that fails.
///
/// Numbers beyond a failed one are no longer started, so that an expensive model stops soon; those before it are, so
/// that the error is the same for any number of threads.
///
/// # Errors
///
/// The error of the smallest number that fails.
///
/// # Examples
///
/// ```
/// use pcc::parallel::try_map;
/// assert_eq!(try_map(3, |i| Ok::<_, ()>(i * i)), Ok(vec![0, 1, 4]));
/// assert_eq!(try_map(100, |i| if i % 7 == 6 { Err(i) } else { Ok(i) }), Err(6));
/// ```
pub fn try_map<T: Send, E: Send>(count: usize, work: impl Fn(usize) -> Result<T, E> + Sync) -> Result<Vec<T>, E> {
    let first_failed = AtomicUsize::new(usize::MAX);
    let results: Vec<Option<Result<T, E>>> = (0..count)
        .into_par_iter()
        .map(|i| {
            if i > first_failed.load(Ordering::Relaxed) {
                return None;
            }
            let result = work(i);
            if result.is_err() {
                first_failed.fetch_min(i, Ordering::Relaxed);
            }
            Some(result)
        })
        .collect();
    // Everything before the first error was run; collecting stops there.
    results.into_iter().flatten().collect()
}
