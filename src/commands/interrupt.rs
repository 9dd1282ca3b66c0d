//! Interrupts of whole-object fits.

use crate::terminal::tell;
use springfit::study::Controls;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The first interrupt ends whole-object fits at their best point, the second the program.
pub fn end_early(controls: &Arc<Controls>) {
    let controls = controls.clone();
    // Without a handler an interrupt ends the program at once, as it does anyway.
    let _ = ctrlc::set_handler(move || {
        if controls.cancelled.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        tell("ending the whole-object fits at their best points; interrupt again to end at once");
    });
}
