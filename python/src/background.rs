//! Long work beside the interpreter.
//!
//! The library works on threads of its own without the interpreter's lock. Meanwhile the thread that asked for the work
//! serves it: it calls functions of the user's for it, so that they run where they were handed over; it looks for
//! Ctrl-C, which Python shows to its main thread alone; and it shows how far the work is.

use pcc::Observer;
use pyo3::prelude::*;
use rayon::ThreadPool;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How often it is looked for Ctrl-C, and how often progress is shown.
const LOOK: Duration = Duration::from_millis(50);
const SHOW: Duration = Duration::from_millis(250);

/// A call that the serving thread makes.
type Call = Box<dyn FnOnce(Python<'_>) + Send>;

/// How the library's threads reach the thread that serves them.
#[derive(Clone)]
pub struct Service {
    calls: Sender<Call>,
    state: Arc<State>,
}

/// What both sides see.
#[derive(Default)]
struct State {
    is_stopped: AtomicBool,
    /// What ends the work in place of its result: `KeyboardInterrupt`, or what else is no `Exception`.
    reason: Mutex<Option<PyErr>>,
    stage: Mutex<String>,
    total: AtomicU64,
    done: AtomicU64,
    remarks: Mutex<Vec<String>>,
}

impl State {
    fn stop(&self, reason: PyErr) {
        self.is_stopped.store(true, Ordering::SeqCst);
        self.reason.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
    }
}

impl Service {
    /// Has the serving thread do something with the interpreter; `None` if the work is to stop.
    pub fn call<T: Send + 'static>(&self, work: impl FnOnce(Python<'_>) -> T + Send + 'static) -> Option<T> {
        if self.interrupted() {
            return None;
        }
        let (answer, answers) = mpsc::channel();
        let state = self.state.clone();
        let call: Call = Box::new(move |py| {
            if !state.is_stopped.load(Ordering::SeqCst) {
                let _ = answer.send(work(py));
            }
        });
        self.calls.send(call).ok()?;
        answers.recv().ok()
    }

    /// Ends the work, for this reason.
    pub fn stop(&self, reason: PyErr) {
        self.state.stop(reason);
    }

    /// A line for the log.
    pub fn note(&self, text: String) {
        self.state.remarks.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    }
}

impl Observer for Service {
    fn begin(&self, stage: &str, total: u64) {
        stage.clone_into(&mut self.state.stage.lock().unwrap_or_else(PoisonError::into_inner));
        self.state.done.store(0, Ordering::SeqCst);
        self.state.total.store(total, Ordering::SeqCst);
    }

    fn advance(&self, steps: u64) {
        self.state.done.fetch_add(steps, Ordering::SeqCst);
    }

    fn finish(&self) {}

    fn remark(&self, text: &str) {
        self.note(text.to_owned());
    }

    fn interrupted(&self) -> bool {
        self.state.is_stopped.load(Ordering::SeqCst)
    }
}

/// Does `work` on this pool, and serves it until it ends. `progress` is an object with the methods `show(stage,
/// done, total)`, `remark(text)` and `close()`.
///
/// # Errors
///
/// What the user's Ctrl-C raises.
pub fn in_background<T: Send>(
    py: Python<'_>,
    pool: Arc<ThreadPool>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Service) -> T + Send,
) -> PyResult<T> {
    let state = Arc::new(State::default());
    let (calls, called) = mpsc::channel();
    let service = Service { calls, state: state.clone() };
    let progress = progress.map(|progress| progress.clone().unbind());
    let (seen, shown_by) = (&state, progress.as_ref());
    let result = py.detach(move || {
        thread::scope(|scope| {
            let worker = scope.spawn(move || pool.install(|| work(&service)));
            serve(&called, seen, shown_by);
            worker.join()
        })
    });
    if let Some(progress) = &progress {
        show(py, &state, progress)?;
        progress.call_method0(py, "close")?;
    }
    if let Some(reason) = state.reason.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(reason);
    }
    Ok(result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// Serves the work until it has let go of its end of the channel.
fn serve(called: &Receiver<Call>, state: &State, progress: Option<&Py<PyAny>>) {
    let (mut looked, mut shown) = (Instant::now(), Instant::now());
    loop {
        match called.recv_timeout(LOOK) {
            Ok(call) => Python::attach(call),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        if looked.elapsed() < LOOK {
            continue;
        }
        looked = Instant::now();
        Python::attach(|py| {
            let looking = py.check_signals().and_then(|()| match progress {
                Some(progress) if shown.elapsed() >= SHOW => {
                    shown = Instant::now();
                    show(py, state, progress)
                }
                _ => Ok(()),
            });
            if let Err(reason) = looking {
                state.stop(reason);
            }
        });
    }
}

fn show(py: Python<'_>, state: &State, progress: &Py<PyAny>) -> PyResult<()> {
    let remarks = std::mem::take(&mut *state.remarks.lock().unwrap_or_else(PoisonError::into_inner));
    for remark in remarks {
        progress.call_method1(py, "remark", (remark,))?;
    }
    let stage = state.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if !stage.is_empty() {
        let numbers = (stage, state.done.load(Ordering::SeqCst), state.total.load(Ordering::SeqCst));
        progress.call_method1(py, "show", numbers)?;
    }
    Ok(())
}
