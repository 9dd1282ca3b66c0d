//! The nearest network without negative springs to an exact network.

#[doc(inline)]
pub use springfit_identify::positive::{PositiveFit, PositiveOutcome, Route, nearest_positive};
