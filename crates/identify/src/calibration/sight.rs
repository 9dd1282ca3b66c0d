//! What was measured: displacements at places of the body, and forces that hold parts of it.
//!
//! Theory: page *Calibration* of the book.

/// A number that was measured under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// The index of the load.
    pub load: usize,
    /// What was measured.
    pub quantity: Quantity,
    /// Its value, m or N.
    pub value: f64,
    /// The standard deviation of its noise; `None` if it is not known.
    pub sigma: Option<f64>,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// The displacement of a place, by its number, in one direction.
    Displacement {
        /// The place.
        place: usize,
        /// The direction.
        axis: usize,
    },
    /// The sum of the forces that hold a part, by its number, in one direction.
    Force {
        /// The part.
        part: usize,
        /// The direction.
        axis: usize,
    },
}

impl Quantity {
    /// Whether it is a force.
    pub fn is_force(self) -> bool {
        matches!(self, Quantity::Force { .. })
    }
}
