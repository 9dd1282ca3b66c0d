//! Long work: on a thread of its own, without the interpreter's lock, with progress, and ended by Ctrl-C.

use crate::ends::Ends;
use crate::error::raised;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_studies::study::Event;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Python is asked no more often.
const BETWEEN: Duration = Duration::from_millis(50);
/// The stack of a working thread, that of a program's first thread on most systems; memory is taken where it is used.
const STACK: usize = 8 << 20;

/// The process that first worked, whose threads are those of the library.
static OWNER: OnceLock<u32> = OnceLock::new();
/// The threads of a process that was forked from it, which has none of the owner's.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

thread_local! {
    /// Whether this thread calls a function of Python for a work, whose threads wait for the function.
    static CALLS: Cell<bool> = const { Cell::new(false) };
}

/// Calls a function of Python on a thread of a work. What the function asks of this module is worked out on threads of its own: those of the
/// work wait for the function, or for the interpreter's lock to call it as well.
pub fn calling<T>(call: impl FnOnce() -> T) -> T {
    let before = CALLS.replace(true);
    let called = call();
    CALLS.set(before);
    called
}

/// Runs `work` to its end without the interpreter's lock, also in a process that was forked after the library has worked. For work that is
/// short, and for files, which are not to be left half written.
pub fn apart<T: Send>(py: Python, work: impl FnOnce() -> T + Send) -> T {
    let is_called = CALLS.get();
    py.detach(|| on_own_threads(is_called, work))
}

/// Of a work that a function of Python has asked for (`is_called`), or of a process.
fn on_own_threads<T: Send>(is_called: bool, work: impl FnOnce() -> T + Send) -> T {
    if is_called {
        // One thread: those that wait are as many as there are processors. Where none can be started, the work has this one alone, which
        // may wait for itself no longer than other functions take.
        return match ThreadPoolBuilder::new().num_threads(1).stack_size(STACK).build() {
            Ok(pool) => pool.install(work),
            Err(_) => work(),
        };
    }
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

/// What the thread of a work tells.
enum Told<T> {
    Step(String, usize, usize),
    Done(thread::Result<Result<T>>),
}

/// How a work stops that nobody waits for.
struct Ended;

/// Runs `work` without the interpreter's lock. What it reports goes to `listener(stage, done, total)`, if there is one; where that or a
/// signal raises an exception, the call ends with it at once. The work itself ends at its next report, or goes on to its end where it has
/// none; it has no object of Python, and what it finds is dropped.
///
/// # Errors
/// Those of the work, as exceptions; and what Python raised.
pub fn run<T: Send + 'static>(
    py: Python,
    listener: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    watched(py, listener, &Arc::new(Ends::default()), false, work)
}

/// As [`run`], for work that reports nothing.
///
/// # Errors
/// Those of [`run`].
pub fn alone<T: Send + 'static>(py: Python, work: impl FnOnce() -> Result<T> + Send + 'static) -> PyResult<T> {
    run(py, None, |_| work())
}

/// As [`run`], for work that calls functions of Python, which raise their exceptions in `ends`. The call ends after the function that is
/// called, because a function cannot go on when the interpreter ends.
///
/// # Errors
/// Those of [`run`], or of a function.
pub fn run_functions<T: Send + 'static>(
    py: Python,
    listener: Option<Py<PyAny>>,
    ends: &Arc<Ends>,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    watched(py, listener, ends, true, work)
}

fn watched<T: Send + 'static>(
    py: Python,
    listener: Option<Py<PyAny>>,
    ends: &Arc<Ends>,
    waits: bool,
    work: impl FnOnce(&mut dyn FnMut(Event)) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let (tell, told) = mpsc::channel();
    let (own, steps, is_called) = (ends.clone(), listener.is_some().then(|| tell.clone()), CALLS.get());
    let worker = move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| on_own_threads(is_called, || work(&mut reporter(&own, steps)))));
        // Nobody waits for it after an interrupt.
        let _ = tell.send(Told::Done(outcome));
    };
    let started = thread::Builder::new().stack_size(STACK).spawn(worker);
    started.map_err(|e| raised(py, Error::io("no thread can be started", e).of_kind(ErrorKind::Limit)))?;
    let listener = listener.as_ref();
    let outcome = py.detach(move || {
        loop {
            let step = match told.recv_timeout(BETWEEN) {
                Ok(Told::Done(outcome)) => return outcome,
                Ok(Told::Step(name, done, total)) => Some((name, done, total)),
                Err(RecvTimeoutError::Timeout) => None,
                // The thread always tells how it is done.
                Err(RecvTimeoutError::Disconnected) => return Err(Box::new(Ended)),
            };
            let heard = Python::attach(|py| {
                py.check_signals()?;
                let call = step.zip(listener);
                call.map_or(Ok(()), |(step, listener)| listener.call1(py, step).map(drop))
            });
            if let Err(exception) = heard {
                ends.set("", exception);
                if !waits {
                    return Err(Box::new(Ended));
                }
            }
        }
    });
    ends.check(py)?;
    outcome.unwrap_or_else(|cause| resume_unwind(cause)).map_err(|error| raised(py, error))
}

/// What passes the steps of a work on, and stops the work that has been ended.
fn reporter<T>(ends: &Ends, steps: Option<Sender<Told<T>>>) -> impl FnMut(Event) {
    let mut last: Option<Instant> = None;
    move |event| {
        if ends.is_set() {
            // The library has no other way out of its loops; it holds nothing that this leaves half done.
            resume_unwind(Box::new(Ended));
        }
        let (Event::Stage { name, done, total }, Some(steps)) = (event, &steps) else { return };
        // The last step is always told, so that a bar comes to its end.
        if last.is_some_and(|last| last.elapsed() < BETWEEN) && done < total {
            return;
        }
        last = Some(Instant::now());
        // The call waits for it, unless it has been ended.
        let _ = steps.send(Told::Step(name.into(), done, total));
    }
}
