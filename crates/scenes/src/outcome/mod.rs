//! The results of a scene.

mod dynamic_moduli;
mod fit;
mod frequencies;
mod gauge;
mod load;
mod motion;
mod scene;

pub use dynamic_moduli::{ComplexModulus, DynamicModuli, DynamicModuliOfModel, DynamicModuliOutcome};
pub use fit::{FitOutcome, MatrixErrors, standing_word};
pub use frequencies::FrequencyOutcome;
pub use gauge::{GaugeResult, Reading};
pub use load::{BodyLoad, Followed, LoadOutcome, Measured, Standard};
pub use motion::{ModelMotion, MotionEnding, MotionOutcome, Record, TimedForce, TimedPull, mean_and_largest};
pub use scene::Outcome;
