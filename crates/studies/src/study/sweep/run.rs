//! Runs studies, several at a time.

use super::studies::{Study, Sweep, of_study};
use crate::error::{Error, Result};
use crate::study::checkpoint::Controls;
use crate::study::outcome::Outcome;
use crate::study::progress::Progress;
use crate::study::run::run_with;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// The threads that work have a stack of this many bytes, as a program's main thread has: trees of expressions are walked by recursion.
const STACK: usize = 8 << 20;

impl Sweep {
    /// Runs one study.
    ///
    /// # Errors
    /// The scene is wrong with its values, or cannot be solved.
    pub fn run_study(&self, study: &Study, progress: &mut Progress) -> Result<Outcome> {
        let outcome = run_with(&self.scene(study)?, &Controls::default(), progress);
        outcome.map_err(|error| of_study(error, study))
    }

    /// A fault of ours in one study leaves the others as they are.
    fn run_apart(&self, study: &Study) -> Result<Outcome> {
        let outcome = catch_unwind(AssertUnwindSafe(|| self.run_study(study, &mut |_| ())));
        let failed = "the program has failed in this study, which is a fault of its own";
        outcome.unwrap_or_else(|_| Err(Error::new(failed)))
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
        mut each: impl FnMut(usize, R) -> Result<()>,
    ) -> Result<()> {
        let jobs = jobs.clamp(1, places.len().max(1));
        let processors = thread::available_parallelism().map_or(1, usize::from);
        let pool = || ThreadPoolBuilder::new().num_threads((processors / jobs).max(1)).stack_size(STACK).build();
        let started = |e| Error::new(format!("no thread can be started: {e}"));
        let pools: Vec<ThreadPool> = (0..jobs).map(|_| pool().map_err(started)).collect::<Result<_>>()?;
        let next = AtomicUsize::new(0);
        thread::scope(|scope| {
            let (sender, results) = channel();
            for pool in &pools {
                let (sender, next, record) = (sender.clone(), &next, &record);
                let work = move || {
                    while let Some(&place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let study = &self.studies()[place];
                        let result = pool.install(|| record(study, self.run_apart(study)));
                        if sender.send((place, result)).is_err() {
                            break;
                        }
                    }
                };
                scope.spawn(work);
            }
            drop(sender);
            // With an error the channel closes, and the jobs end after their study.
            results.into_iter().try_for_each(|(place, result)| each(place, result))
        })
    }
}
