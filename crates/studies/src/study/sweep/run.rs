//! Runs studies, several at a time.

use super::studies::{Study, Sweep, of_study};
use crate::error::Result;
use crate::study::jobs::{apart, each_of};
use crate::study::run::run_with;
use springfit_scenes::{Controls, Outcome, Progress};

impl Sweep {
    /// Runs one study.
    ///
    /// # Errors
    /// The scene is wrong with its values, or cannot be solved.
    pub fn run_study(&self, study: &Study, progress: &mut Progress) -> Result<Outcome> {
        let outcome = run_with(&self.scene(study)?, &Controls::default(), progress);
        outcome.map_err(|error| of_study(error, study))
    }

    /// Runs the studies of these places, `jobs` at a time, and passes what `record` makes of each to `each` as it becomes ready.
    ///
    /// The processors are shared out among the jobs. The figures of a study do not depend on their number.
    ///
    /// # Errors
    /// That of `each`, after which no study begins; or no thread can be started.
    pub fn run<R: Send>(
        &self,
        places: &[usize],
        jobs: usize,
        record: impl Fn(&Study, Result<Outcome>) -> R + Sync,
        each: impl FnMut(usize, R) -> Result<()>,
    ) -> Result<()> {
        let work = |place: usize| {
            let study = &self.studies()[place];
            record(study, apart("study", || self.run_study(study, &mut |_| ())))
        };
        each_of(places, jobs, work, each)
    }
}
