//! How far a network without negative springs is from the exact one.

/// What was changed to have no negative springs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Route {
    /// Nothing: there are none.
    #[default]
    Unchanged,
    /// The constants of the springs between points of one cell.
    Springs,
    /// These, with springs across the sides of the cells.
    Across,
    /// The constants, and the tensions of the springs on content.
    Tensions,
}

crate::named!(Route {
    "unchanged" => Unchanged,
    "springs" => Springs,
    "across" => Across,
    "tensions" => Tensions,
});

/// How far the network is from the exact one. Errors of energies are shares of the exact ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PositiveOutcome {
    pub route: Route,
    /// Springs of the exact network whose constant is below zero.
    pub negative: usize,
    /// Springs of the exact network that are no more.
    pub dropped: usize,
    /// Springs across the sides of cells.
    pub across: usize,
    /// The least and the largest tension of a spring on content, as a multiple of the mean.
    pub tensions: [f64; 2],
    /// The largest error of the energy of an affine displacement.
    pub affine: f64,
    /// How many of the lowest modes of the exact network, free of supports, were to keep their energies.
    pub modes: usize,
    /// The least and the largest error of their energies.
    pub mode_errors: [f64; 2],
    /// The largest force on a point at rest, as a share of the largest force of a spring.
    pub rest_force: f64,
    /// Of the solver.
    pub iterations: u32,
}
