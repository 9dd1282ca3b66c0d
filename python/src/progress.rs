//! Long work: without the interpreter's lock, with progress, and ended by Ctrl-C.

use crate::error::raised;
use pyo3::prelude::*;
use springfit::error::Result;
use springfit::study::Event;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

/// Python is asked no more often.
const BETWEEN: Duration = Duration::from_millis(50);

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
    let outcome = py.detach(|| {
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
