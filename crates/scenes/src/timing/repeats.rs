//! Repeated measurements of several works that take turns.

use crate::analysis::statistics::median;
use crate::clock::Clock;
use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A work is repeated until its passes have taken this processor time together, s.
const TOGETHER: f64 = 0.02;
/// A work is repeated this often at least: two passes that were interrupted do not move the median of five.
const LEAST: usize = 5;
/// A work is repeated this often at most.
const MOST: usize = 400;
/// A pass that takes longer, s, is the only one: a spread of some per cent is not worth minutes.
const PATIENCE: f64 = 2.0;

/// A work that is timed: each call is a pass, and returns the processor time of what counts in it, s.
pub type TimedWork<'a> = Box<dyn FnMut() -> Result<f64> + 'a>;

/// Repeated measurements of a processor time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Times {
    /// The least time of all passes, s.
    pub least: f64,
    /// The median of the times, s.
    pub median: f64,
    /// The work was repeated this often.
    pub passes: usize,
    /// Each pass took this time, s; files have no such list.
    #[serde(skip)]
    pub seconds: Vec<f64>,
}

impl Times {
    /// Those of passes that took these processor times, s.
    pub fn of(seconds: Vec<f64>) -> Times {
        let least = seconds.iter().copied().fold(f64::INFINITY, f64::min);
        Times { least, median: median(&seconds), passes: seconds.len(), seconds }
    }

    /// The times of a part of the work, such as one of several cells.
    pub fn scaled(&self, factor: f64) -> Times {
        Times::of(self.seconds.iter().map(|seconds| factor * seconds).collect())
    }
}

/// Whether passes of these times are enough, which have taken `spent` s together with what does not count in them.
fn is_enough(seconds: &[f64], spent: f64) -> bool {
    let longest = seconds.iter().copied().fold(0.0, f64::max);
    let count = seconds.len();
    // Passes shorter than 50 µs do not reach the time together: their number ends them.
    longest > PATIENCE || count >= MOST || count >= LEAST && spent >= TOGETHER
}

/// Times the works in turns, so that what the machine does meanwhile meets all of them alike. The first pass of each warms caches and
/// memory, and counts only where it takes so long that there is no other.
///
/// # Errors
/// That of a work.
pub fn interleaved(works: &mut [TimedWork]) -> Result<Vec<Times>> {
    let first = works.iter_mut().map(|work| work()).collect::<Result<Vec<f64>>>()?;
    interleaved_after(&first, works)
}

/// Times works that take turns, whose first passes took these times.
///
/// # Errors
/// That of a work.
pub fn interleaved_after(first: &[f64], works: &mut [TimedWork]) -> Result<Vec<Times>> {
    let of_first = |first: &f64| if *first > PATIENCE { vec![*first] } else { Vec::new() };
    let mut all: Vec<Vec<f64>> = first.iter().map(of_first).collect();
    // A pass may return the time of one of its many steps: how long it took, the clock says.
    let mut spent = vec![0.0; works.len()];
    for round in 0.. {
        let mut is_done = true;
        for turn in 0..works.len() {
            // Another work begins each round, so that none always follows the same one.
            let place = (turn + round) % works.len();
            if !is_enough(&all[place], spent[place]) {
                let clock = Clock::start();
                all[place].push(works[place]()?);
                spent[place] += clock.seconds();
                is_done = false;
            }
        }
        if is_done {
            break;
        }
    }
    Ok(all.into_iter().map(Times::of).collect())
}

/// Does a work on one thread, whose clock then counts all of it.
///
/// # Errors
/// That of the work; or no thread can be started.
pub fn on_one_thread<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).stack_size(STACK).build();
    pool.map_err(|e| Error::new(format!("no thread can be started: {e}")))?.install(work)
}

/// Threads that work have a stack of this many bytes, as a program's main thread has: trees of expressions are walked by recursion.
pub const STACK: usize = 8 << 20;
