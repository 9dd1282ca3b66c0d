//! Long work: without the interpreter's lock, with progress, and ended by Ctrl-C.

use crate::error::raised;
use crate::functions::Ends;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use springfit::error::Result;
use springfit::study::Event;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Python is asked no more often.
const BETWEEN: Duration = Duration::from_millis(50);

/// The process that first worked, whose threads are those of the library.
static OWNER: OnceLock<u32> = OnceLock::new();
/// The threads of a process that was forked from it, which has none of the owner's.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Runs `work` without the interpreter's lock, also in a process that was forked after the library has worked.
pub fn apart<T: Send>(py: Python, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| on_own_threads(work))
}

fn on_own_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let own = process::id();
    if *OWNER.get_or_init(|| own) == own {
        return work();
    }
    let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = match &*forked {
        Some((process, pool)) if *process == own => pool.clone(),
        _ => {
            let pool = Arc::new(ThreadPoolBuilder::new().build().expect("a process may start threads"));
            // Those of another process are not joined: there are none.
            std::mem::forget(forked.replace((own, pool.clone())));
            pool
        }
    };
    drop(forked);
    pool.install(work)
}

/// Ends the work; what Python raised.
struct Ended(PyErr);

/// Runs `work` without the interpreter's lock. What it reports goes to `listener(stage, done, total)`, if there is one; where that or a
/// signal raises an exception, the work ends with it.
///
/// # Errors
/// Those of the work, as exceptions; and what Python raised.
pub fn run<T: Send>(
    py: Python,
    listener: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T> + Send,
) -> PyResult<T> {
    ended(py, apart(py, || listened(listener, work)))
}

/// As [`run`], for work that calls functions of Python: while it runs on another thread, this one hears signals and ends the functions by
/// them.
///
/// # Errors
/// Those of [`run`], or of a function.
pub fn run_functions<T: Send>(
    py: Python,
    listener: Option<Py<PyAny>>,
    ends: &Ends,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T> + Send,
) -> PyResult<T> {
    let outcome = py.detach(|| {
        thread::scope(|scope| {
            let (done, is_done) = mpsc::channel();
            let worker = scope.spawn(move || {
                let outcome = on_own_threads(|| listened(listener, work));
                // The other end waits for this.
                let _ = done.send(());
                outcome
            });
            while let Err(RecvTimeoutError::Timeout) = is_done.recv_timeout(BETWEEN) {
                if let Err(exception) = Python::attach(|py| py.check_signals()) {
                    ends.set("", exception);
                }
            }
            worker.join().and_then(|outcome| outcome)
        })
    });
    ends.heard(py, ended(py, outcome))
}

/// Runs `work`; what ended it if that was no error.
fn listened<T>(
    listener: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T>,
) -> thread::Result<Result<T>> {
    let mut last: Option<Instant> = None;
    let mut told = |event: Event| {
        let Event::Stage { name, done, total } = event else { return };
        if last.is_some_and(|last| last.elapsed() < BETWEEN) && done < total {
            return;
        }
        last = Some(Instant::now());
        let heard = Python::attach(|py| {
            py.check_signals()?;
            listener.as_ref().map_or(Ok(()), |listener| listener.call1(py, (name, done, total)).map(drop))
        });
        if let Err(exception) = heard {
            // The library has no other way out of its loops; it holds nothing that this leaves half done.
            resume_unwind(Box::new(Ended(exception)));
        }
    };
    catch_unwind(AssertUnwindSafe(|| work(&mut told)))
}

fn ended<T>(py: Python, outcome: thread::Result<Result<T>>) -> PyResult<T> {
    match outcome {
        Ok(result) => result.map_err(|error| raised(py, error)),
        Err(cause) => match cause.downcast::<Ended>() {
            Ok(ended) => Err(ended.0),
            Err(cause) => resume_unwind(cause),
        },
    }
}
