//! The convergence of finite elements and networks as the mesh of a scene is refined.

mod levels;
mod limit;
mod outcome;
mod quadratic;
mod quantities;
mod reference;
mod run;

pub use levels::most_unknowns;
pub use limit::{Limit, LimitKind, limit_of};
pub use outcome::{Convergence, Level, LoadConvergence, ModelConvergence, Step, rates};
pub use run::{EachLevel, MOST_LEVELS, converge, converge_to, converge_with, refinements};
