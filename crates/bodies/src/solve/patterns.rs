//! The patterns of the equations of one model while its entries change.

use super::linear::System;
use super::newton::Newton;
use crate::error::Result;
use crate::model::{Entries, Support};
use std::sync::{Arc, Mutex, MutexGuard};

/// The last equations of a model under each support, whose pattern and analysis those with other entries at the same positions reuse.
#[derive(Debug, Default)]
pub struct KnownPatterns(Mutex<Vec<(Support, Arc<System>)>>);

impl KnownPatterns {
    /// The equations with these entries of points that are at `points`, `[points × dimension]`, m.
    ///
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn renewed(
        &self,
        entries: &Entries,
        support: &Support,
        points: &[f64],
        dimension: usize,
    ) -> Result<Arc<System>> {
        // Taken out, so that nobody waits while the equations are assembled.
        let known = {
            let mut kept = self.kept();
            kept.iter().position(|(own, _)| own == support).map(|at| kept.swap_remove(at).1)
        };
        let system = Arc::new(match known {
            Some(known) => known.renewed(entries, support)?,
            None => System::new(entries, support)?.placed(points, dimension),
        });
        self.kept().push((support.clone(), system.clone()));
        Ok(system)
    }

    /// The equations whose [pattern](Newton::pattern) all steps of a model share that has this tangent at rest, where its points are at `points`,
    /// `[points × dimension]`, m.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn of_steps(
        &self,
        tangent: &Entries,
        support: &Support,
        points: &[f64],
        dimension: usize,
    ) -> Result<Arc<System>> {
        if let Some((_, known)) = self.kept().iter().find(|(own, _)| own == support) {
            return Ok(known.clone());
        }
        // Not under the lock: at worst two threads find the same pattern.
        let system = Arc::new(Newton::pattern(tangent, support)?.placed(points, dimension));
        self.kept().push((support.clone(), system.clone()));
        Ok(system)
    }

    fn kept(&self) -> MutexGuard<'_, Vec<(Support, Arc<System>)>> {
        self.0.lock().expect("nothing panics while it holds the systems")
    }
}
