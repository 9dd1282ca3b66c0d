//! What ends a call before its work is complete.

use crate::error::{SpringfitError, invalid};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

thread_local! {
    /// The call whose springs this thread evaluates, if it evaluates some.
    static CURRENT: RefCell<Option<Arc<Ends>>> = const { RefCell::new(None) };
}

/// The first exception that ends a call, and the key of the function that raised it; each call has its own.
#[derive(Debug, Default)]
pub struct Ends {
    is_set: AtomicBool,
    exception: Mutex<Option<(String, PyErr)>>,
}

impl Ends {
    /// Ends the call: no function is called any more, and the work ends at its next step.
    pub fn set(&self, key: &str, exception: PyErr) {
        let mut first = self.exception.lock().unwrap_or_else(PoisonError::into_inner);
        // Functions on several threads may raise at once: the first exception is kept.
        if !self.is_set.swap(true, Ordering::AcqRel) {
            *first = Some((key.into(), exception));
        }
    }

    /// Whether something has ended the call.
    pub fn is_set(&self) -> bool {
        self.is_set.load(Ordering::Acquire)
    }

    /// Raises what has ended the call, once; the exception of a user's function is the cause of a `SpringfitError`.
    ///
    /// # Errors
    /// Something has ended the call.
    pub fn check(&self, py: Python) -> PyResult<()> {
        let found = self.exception.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some((key, exception)) = found else { return Ok(()) };
        if key.is_empty()
            || exception.is_instance_of::<SpringfitError>(py)
            || !exception.is_instance_of::<PyException>(py)
        {
            return Err(exception);
        }
        let found = format!("{}: {}", exception.get_type(py).name()?, exception.value(py));
        let error = invalid(py, &key, "a function that returns", found);
        error.set_cause(py, Some(exception));
        Err(error)
    }

    /// Does `work`, whose functions end this call instead of the fit that they come from.
    pub fn during<T>(self: &Arc<Ends>, work: impl FnOnce() -> T) -> T {
        let _outer = Outer(CURRENT.replace(Some(self.clone())));
        work()
    }

    /// The call whose springs this thread evaluates, or `own` if this thread evaluates no springs.
    pub fn current(own: &Arc<Ends>) -> Arc<Ends> {
        CURRENT.with_borrow(Option::clone).unwrap_or_else(|| own.clone())
    }
}

/// The call that goes on after this one, which a function of it has made.
struct Outer(Option<Arc<Ends>>);

impl Drop for Outer {
    fn drop(&mut self) {
        CURRENT.set(self.0.take());
    }
}
