//! Moduli of a body from measurements, with intervals.

#[doc(inline)]
pub use springfit_identify::calibration::{
    Asked, Estimate, FieldEstimate, Laws, LoadCase, Observation, Prior, Quantity, Unknown, Unknowns, estimate,
    estimate_field,
};
