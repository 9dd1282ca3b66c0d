//! What fits and models cost, as reports tell it.

use super::repeats::Times;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a fit costs: processor time of one thread, s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitTimes {
    /// The constants of all cells take this time.
    pub constants: Times,
    /// The constants of each cell that is fitted take this time; cells that take those of a congruent one do not count.
    pub element: Times,
    /// The sum of the springs of the cells into the network takes this time.
    pub assembly: Times,
    /// The errors of the elements' matrices take this time; it is null where the springs belong to no element.
    pub errors: Option<Times>,
    /// The moduli of the network as a material take this time.
    pub moduli: Times,
}

/// What a model costs that is there: processor time of one thread, s.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ModelTimes {
    /// The displacements under the first load take this time: assembly of the equations, factor or levels, and solution; at large
    /// deformation all steps of Newton's method. It is null without a load, and where the network is not stable.
    pub solve: Option<Times>,
    /// A step of symplectic Euler, half as long as the longest one that is stable, takes this time.
    pub explicit_step: Option<Times>,
    /// A linearised step of implicit Euler of 1/60 s takes this time: forces, matrix, factor and solution. The matrix of linear finite
    /// elements, which do not turn, is factorised before the first step.
    pub implicit_step: Option<Times>,
    /// A second of motion takes this time: in explicit steps half as long as the longest one that is stable, and of a network whose constants
    /// are for an engine in steps of that engine at these settings, which this program makes on the processor. It is null where the scene gives no
    /// density, and where the network is not stable.
    pub simulated_second: Option<Times>,
    /// The longest explicit step that is stable is this long, s. It is null where the scene gives no density: steps are then timed with that
    /// of water.
    pub longest_step: Option<f64>,
}
