//! Reasons why an element has no stiffness.

/// Why an element has no stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// The Jacobian determinant is negative at every quadrature point: the nodes are numbered in the opposite order.
    Reversed,
    /// The Jacobian determinant changes sign, or vanishes at some quadrature point.
    Tangled {
        /// The quadrature point with the least determinant.
        point: usize,
        /// The determinant there.
        determinant: f64,
        /// The largest determinant over the points.
        largest: f64,
    },
    /// The Jacobian determinant vanishes at every quadrature point: the cell has no length, area or volume.
    Flat,
    /// Two nodes of the cell are the same.
    Collapsed,
    /// The measure of a spring has no finite gradient, or its gradient is zero.
    Unmeasured,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Fault::Reversed => write!(f, "its nodes are numbered the other way round (negative Jacobian everywhere)"),
            Fault::Tangled { point, determinant, .. } if *determinant > 0.0 => write!(
                f,
                "the element is flat at quadrature point {point}: its Jacobian determinant there, {determinant:.3e}, is within \
                 the rounding of its nodes"
            ),
            Fault::Tangled { point, determinant, largest } => write!(
                f,
                "the element is tangled: its Jacobian determinant goes from {largest:.3e} down to {determinant:.3e} at \
                 quadrature point {point}"
            ),
            Fault::Flat => write!(f, "the element has no volume (its Jacobian vanishes)"),
            Fault::Collapsed => write!(f, "one of its nodes is there twice: springs between them would have no length"),
            Fault::Unmeasured => write!(f, "what one of its springs measures has no finite gradient other than zero"),
        }
    }
}
