//! Threads for the library's work.
//!
//! A process that was forked has the memory of its parent and none of its threads, so that it would wait for ever for
//! those of a pool. Every process gets a pool of its own. Work that calls Python has another one each time: while it
//! waits for a function of the user's, that function may ask for work itself.

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, TryLockError};

/// The pool, and the process whose threads it has.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process, for work that never waits.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut held = match POOL.try_lock() {
        Ok(held) => held,
        Err(TryLockError::Poisoned(held)) => held.into_inner(),
        // Somebody makes it this moment, or a thread that was not forked has held it since.
        Err(TryLockError::WouldBlock) => return new_pool(),
    };
    if let Some((owner, pool)) = &*held
        && *owner == process::id()
    {
        return Ok(pool.clone());
    }
    let pool = new_pool()?;
    if let Some((_, of_parent)) = held.replace((process::id(), pool.clone())) {
        // To drop it would be to wait for its threads.
        std::mem::forget(of_parent);
    }
    Ok(pool)
}

/// A pool for work that may wait.
pub fn new_pool() -> PyResult<Arc<ThreadPool>> {
    let threads = ThreadPoolBuilder::new().thread_name(|number| format!("pcc-{number}")).build();
    threads.map(Arc::new).map_err(|error| PyRuntimeError::new_err(format!("pcc cannot start its threads: {error}")))
}
