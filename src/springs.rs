//! What springs measure, their forces, and laws of force.

#[doc(inline)]
pub use springfit_element::springs::{
    AskedForces, Force, ForceFunction, FunctionSpring, Patch, SpringResponse, Springs,
};

/// The force of a spring as an expression of its measure c and its strain `s = (c − c₀)/c₀`, with parameters.
///
/// ```
/// use springfit::springs::Law;
///
/// let law = Law::parse("k*c*s + a*s^3")?;
/// assert_eq!(law.parameters, ["k", "a"]);
/// assert_eq!(law.force(1.5, 1.0, &[2.0, 8.0]), 2.5); // 2·1.5·0.5 + 8·0.125
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_element::springs::Law;

/// The number that a spring measures of the positions of its points.
///
/// ```
/// use springfit::springs::Measure;
///
/// let positions = [0.0, 0.0, 3.0, 4.0]; // m
/// assert_eq!(Measure::Length.value(&positions, 2), 5.0);
/// assert_eq!(Measure::Length.gradient(&positions, 2), [-0.6, -0.8, 0.6, 0.8]);
/// ```
#[doc(inline)]
pub use springfit_element::springs::Measure;
