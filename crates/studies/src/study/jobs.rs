//! Works that do not depend on each other, several at a time.

use crate::error::{Error, Result};
use rayon::{ThreadPool, ThreadPoolBuilder};
use springfit_scenes::STACK;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Jobs at most; more than processors are of no use.
const MOST_JOBS: usize = 1024;

/// Checks how many works are done at a time, which an option of the command line says.
///
/// # Errors
/// None, or more than are of use.
pub fn check_jobs(jobs: usize) -> Result<()> {
    match (1..=MOST_JOBS).contains(&jobs) {
        true => Ok(()),
        false => Err(Error::expected("--jobs", format!("a number from 1 to {MOST_JOBS}"), jobs)),
    }
}

/// Does the work of each of these places, `jobs` at a time, and passes each result to `each` as soon as it is ready.
///
/// The processors are shared out among the jobs. What comes of a work does not depend on their number.
///
/// # Errors
/// That of `each`, after which no work begins; or no thread can be started.
pub fn each_of<R: Send>(
    places: &[usize],
    jobs: usize,
    work: impl Fn(usize) -> R + Sync,
    mut each: impl FnMut(usize, R) -> Result<()>,
) -> Result<()> {
    let jobs = jobs.clamp(1, places.len().max(1));
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let pool = || ThreadPoolBuilder::new().num_threads((processors / jobs).max(1)).stack_size(STACK).build();
    let started = |e| Error::new(format!("no thread can be started: {e}"));
    // A pool for each job: in one pool a thread that waits within a work may begin another.
    let pools: Vec<ThreadPool> = (0..jobs).map(|_| pool().map_err(started)).collect::<Result<_>>()?;
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let (sender, results) = channel();
        for pool in &pools {
            let (sender, next, work) = (sender.clone(), &next, &work);
            let all = move || {
                while let Some(&place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let result = pool.install(|| work(place));
                    if sender.send((place, result)).is_err() {
                        break;
                    }
                }
            };
            scope.spawn(all);
        }
        // The list of results ends when the last sender is gone; this one sends nothing.
        drop(sender);
        // With an error the channel closes, and the jobs end after their work.
        results.into_iter().try_for_each(|(place, result)| each(place, result))
    })
}

/// Does one work so that a fault of ours in it leaves others as they are.
///
/// # Errors
/// That of the work, or that it failed.
pub fn apart<T>(what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let outcome = catch_unwind(AssertUnwindSafe(work));
    let failed = || Err(Error::new(format!("the program has failed in this {what}, which is a fault of its own")));
    outcome.unwrap_or_else(|_| failed())
}
