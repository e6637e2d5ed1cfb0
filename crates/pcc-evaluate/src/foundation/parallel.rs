//! Parallel work whose outcome does not depend on who finishes first.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// How often waiting work is watched.
const WATCH_INTERVAL: Duration = Duration::from_millis(50);

/// `work(0)`, `work(1)`, … `work(count − 1)` in parallel, results in order; or the error of the smallest number that
/// fails.
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
/// use pcc_evaluate::foundation::try_map;
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

/// The same for work that waits for other processes instead of computing: on up to `jobs` threads of its own, however
/// many processors there are. Numbers are started in order; after a failure no further one is. Meanwhile the caller's
/// thread calls `watch` again and again.
///
/// # Errors
///
/// The error of the smallest number that fails.
///
/// # Examples
///
/// ```
/// use pcc_evaluate::foundation::try_map_waiting;
/// assert_eq!(try_map_waiting(8, 3, || (), |i| Ok::<_, ()>(i * i)), Ok(vec![0, 1, 4]));
/// ```
pub fn try_map_waiting<T: Send, E: Send>(
    jobs: usize,
    count: usize,
    watch: impl Fn(),
    work: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let (next, has_failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut results: Vec<Option<Result<T, E>>> = (0..count).map(|_| None).collect();
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..jobs.clamp(1, count.max(1)) {
            let (sender, next, has_failed, work) = (sender.clone(), &next, &has_failed, &work);
            let started = thread::Builder::new().spawn_scoped(scope, move || {
                while !has_failed.load(Ordering::SeqCst) {
                    let i = next.fetch_add(1, Ordering::SeqCst);
                    if i >= count {
                        break;
                    }
                    let result = work(i);
                    if result.is_err() {
                        has_failed.store(true, Ordering::SeqCst);
                    }
                    // The receiver lives until all senders are gone.
                    let _ = sender.send((i, result));
                }
            });
            if started.is_err() {
                // The system has no more threads; those there are do the work.
                break;
            }
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(WATCH_INTERVAL) {
                Ok((i, result)) => results[i] = Some(result),
                Err(RecvTimeoutError::Timeout) => watch(),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    });
    // Without a single thread it is done here.
    let none_started = next.load(Ordering::SeqCst) == 0;
    if none_started { (0..count).map(work).collect() } else { results.into_iter().flatten().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_work_reports_its_first_failure_whoever_ends_first() {
        for jobs in [1, 3, 8] {
            let work = |i: usize| {
                thread::sleep(Duration::from_millis(if i == 2 { 30 } else { 1 }));
                if i >= 2 { Err(i) } else { Ok(i) }
            };
            assert_eq!(try_map_waiting(jobs, 20, || (), work), Err(2), "{jobs} jobs");
        }
        assert_eq!(try_map_waiting(4, 0, || (), Err::<(), _>), Ok(Vec::new()));
    }

    #[test]
    fn waiting_work_is_watched() {
        let watched = AtomicUsize::new(0);
        let work = |_| {
            thread::sleep(4 * WATCH_INTERVAL);
            Ok::<_, ()>(())
        };
        let watch = || {
            watched.fetch_add(1, Ordering::SeqCst);
        };
        assert_eq!(try_map_waiting(1, 1, watch, work), Ok(vec![()]));
        assert!(watched.into_inner() > 0);
    }
}
