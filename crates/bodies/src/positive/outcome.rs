//! The difference between a network without negative springs and the exact network.

/// What was changed to remove negative springs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Route {
    /// Nothing: there are none.
    #[default]
    Unchanged,
    /// The constants of the springs between points of one cell.
    Springs,
    /// These constants, and springs across the sides of the cells.
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

/// The difference between the network and the exact one. Errors of energies are relative to the exact ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct PositiveOutcome {
    /// What was changed.
    pub route: Route,
    /// The number of springs of the exact network with a negative constant.
    pub negative: usize,
    /// The number of springs of the exact network that were removed.
    pub dropped: usize,
    /// The number of springs across the sides of cells.
    pub across: usize,
    /// The least and the largest tension of a spring on content, relative to the mean.
    pub tensions: [f64; 2],
    /// The largest error of the energy of an affine displacement.
    pub affine: f64,
    /// The number of lowest modes of the exact network, without supports, whose energies were to be kept.
    pub modes: usize,
    /// The least and the largest error of their energies.
    pub mode_errors: [f64; 2],
    /// The largest force on a point at rest, relative to the largest force of a spring.
    pub rest_force: f64,
    /// The iterations of the solver.
    pub iterations: u32,
}
