//! Long work: without the interpreter's lock, with progress, and ended by Ctrl-C.

use crate::error::raised;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use springfit::error::Result;
use springfit::study::Event;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Python is asked no more often.
const BETWEEN: Duration = Duration::from_millis(50);

/// The process that first worked, whose threads are those of the library.
static OWNER: OnceLock<u32> = OnceLock::new();
/// The threads of a process that was forked from it, which has none of the owner's.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Runs `work` without the interpreter's lock, also in a process that was forked after the library has worked.
pub fn apart<T: Send>(py: Python, work: impl FnOnce() -> T + Send) -> T {
    let own = process::id();
    py.detach(|| {
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
    })
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
    let outcome = apart(py, || {
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
    });
    match outcome {
        Ok(result) => result.map_err(|error| raised(py, error)),
        Err(cause) => match cause.downcast::<Ended>() {
            Ok(ended) => Err(ended.0),
            Err(cause) => resume_unwind(cause),
        },
    }
}
