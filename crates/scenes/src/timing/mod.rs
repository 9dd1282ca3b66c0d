//! What fits and models cost: the processor time of one thread, repeated and interleaved.

mod costs;
mod model;
mod repeats;
mod run;

pub use costs::{FitTimes, ModelTimes};
pub use model::{Costed, Statics, model_times};
pub use repeats::{STACK, TimedWork, Times, interleaved_after, on_one_thread};
pub use run::time_fits;
