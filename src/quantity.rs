//! Physical quantities, and the units that texts may state them in.

#[doc(inline)]
pub use springfit_foundation::quantity::Quantity;
