//! Interrupts: the program ends, and removes what it has begun to write. Work that has a result so far does with it what it can.

use crate::terminal::tell;
use springfit_studies::study::Controls;
use std::process::exit;
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};

/// What work does when it is interrupted.
pub enum Answer {
    /// It comes to its end early, which this says.
    EndsEarly(&'static str),
    /// The program ends.
    Ends,
}

type Ask = Box<dyn Fn() -> Answer + Send + Sync>;

static WORK: OnceLock<Ask> = OnceLock::new();

/// Answers interrupts from now on. A program that was started with interrupts ignored, in the background of a script, ignores them.
pub fn answer() {
    // Without a handler an interrupt ends the program at once, and the next run removes what it has begun.
    let _ = ctrlc::try_set_handler(|| match WORK.get().map_or(Answer::Ends, |ask| ask()) {
        Answer::EndsEarly(words) => tell(&format!("{words}; interrupt again to end at once")),
        Answer::Ends => {
            springfit_foundation::file::abandon();
            exit(130);
        }
    });
}

/// The first interrupt ends whole-object fits at their best points, the second the program.
pub fn end_early(controls: &Arc<Controls>) {
    let controls = controls.clone();
    interrupted(move || match controls.cancelled.swap(true, Ordering::Relaxed) {
        false => Answer::EndsEarly("ending the whole-object fits at their best points"),
        true => Answer::Ends,
    });
}

/// Asks the work of this program at each interrupt.
pub fn interrupted(ask: impl Fn() -> Answer + Send + Sync + 'static) {
    // A program has one command.
    let _ = WORK.set(Box::new(ask));
}
