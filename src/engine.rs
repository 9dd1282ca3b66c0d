//! What a network answers in an engine that ends its iterations early.

#[doc(inline)]
pub use springfit_bodies::engine::{Engine, Frames, Precision, Setting, Sweep, Truncated, TruncatedModel, Vibration};
