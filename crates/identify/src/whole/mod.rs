//! Spring constants from the displacements of the whole object. The network is fitted to move like the finite elements,
//! or like a measured object, under a set of loads, and is validated under others.
//!
//! The fit is `min_θ Σ_l w_l ‖u_l − ū_l‖²_W/‖ū_l‖²_W + Σ_i w_ω (ln ω_i/ω̄_i)² + (ρ/m) ‖θ‖²` with `F(u_l; k(θ)) = f_l`.
//! The m unknowns `θ` are logarithms of factors on the constants at the start, so that constants stay positive; the
//! last term keeps them near those of the elements. Products with the Jacobian and its transpose cost one solve per
//! load with the factor of the tangent.
//!
//! Theory: page *Whole-object fits* of the book.

mod balanced;
mod blend;
mod carriers;
mod covariance;
mod descent;
mod displacements;
mod fit;
mod gauss_newton;
mod linearized;
mod loads;
mod masses;
mod moduli;
mod object;
mod path;
mod regions;
mod settings;
mod stretched;
mod student;
mod tangent;
mod target;
mod unknowns;

pub use balanced::Balanced;
pub use blend::fit_mass_share;
pub use covariance::{Determination, MOST_ESTIMATED, WEAK};
pub use displacements::{Displacements, Errors};
pub use fit::{WholeFit, fit_whole};
pub use gauss_newton::GaussNewton;
pub use linearized::{LeastSquares, Linearized};
pub use loads::{NodalLoad, PRESSURE, Pressure, made_loads, random_loads, varied_loads};
pub use masses::{MassFit, MassStage, Vibrations, fit_masses};
pub use moduli::{ModuliParts, ModuliSharing};
pub use object::{Object, raise_idle};
pub use path::{Best, Snapshot, Stage, StepCallback};
pub use regions::BodyRegions;
pub use settings::{DescentMethod, Validation, Wanted, Weighing, WholeSettings};
pub use stretched::{MakeLoads, Stretched, StretchedLoads};
pub use student::ninety_five;
pub use target::{Frequencies, Target};
pub use unknowns::Unknowns;
