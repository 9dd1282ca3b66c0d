//! Spring constants fitted to the displacements of the whole body.

#[doc(inline)]
pub use springfit_identify::whole::{
    BodyRegions, Determination, Displacements, LeastSquares, ModuliSharing, NodalLoad, Object, Stretched, Target,
    Unknowns, Validation, Wanted, Weighing, WholeFit, WholeSettings, fit_whole, made_loads, random_loads,
};
