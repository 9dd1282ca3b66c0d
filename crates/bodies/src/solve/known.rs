//! The equations of one model that were solved so far.

use super::equations::Equations;
use crate::error::Result;
use crate::memory;
use crate::model::Support;
use std::sync::{Mutex, MutexGuard};

/// Bytes that are to be left when equations are kept for further questions under the same support. The next equations
/// may be as large as those that are kept, and other results need room beside them.
const ROOM: u64 = 4_000_000_000;

/// The equations of a model under each support that was asked for, as long as memory allows.
#[derive(Debug, Default)]
pub struct KnownEquations(Mutex<Vec<(Support, Equations)>>);

impl KnownEquations {
    /// The equations under a support, which `solve` finds where they are not known.
    ///
    /// # Errors
    /// `solve` fails; its error is passed on.
    pub fn under(&self, support: &Support, solve: impl FnOnce() -> Result<Equations>) -> Result<Equations> {
        if let Some((_, equations)) = self.kept().iter().find(|(own, _)| own == support) {
            // A copy shares the factor.
            return Ok(equations.clone());
        }
        if memory::available().is_some_and(|left| left < ROOM) {
            // All go, not the oldest alone: one factor is most of the memory, and what is asked for next is not known.
            self.kept().clear();
        }
        // Not under the lock: a solution takes long, and at worst two threads find the same one.
        let found = solve()?;
        self.kept().push((support.clone(), found.clone()));
        Ok(found)
    }

    /// Keeps equations that are solved already.
    pub fn keep(&self, solved: impl Iterator<Item = (Support, Equations)>) {
        self.kept().extend(solved);
    }

    fn kept(&self) -> MutexGuard<'_, Vec<(Support, Equations)>> {
        self.0.lock().expect("nothing panics while it holds the equations")
    }
}
