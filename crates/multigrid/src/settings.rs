//! How a hierarchy is built and used.

use std::ops::ControlFlow;

/// How a hierarchy is built and used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Nodes are strongly coupled above this share, `‖A_ij‖ > threshold √(‖A_ii‖ ‖A_jj‖)`; halved from level to level.
    pub threshold: f64,
    /// Degree of the smoothing polynomial, before and after the correction by the next level.
    pub degree: usize,
    /// The polynomial damps eigenvalues of `D⁻¹ A` down to the largest over this.
    pub ratio: f64,
    /// Unknowns of the last level, which is factorised densely, at most.
    pub dense: usize,
}

impl Default for Settings {
    fn default() -> Settings {
        // With Vaněk's threshold of 0.08 the weak springs of a network are left out,
        // and its next level has two to three times as many points as that of a body.
        // Aggregates are whole neighbourhoods, so that the next level is about three times coarser along each axis. The
        // smoothest error that it cannot represent then turns by π/3 per node along one axis. For the Laplacian of
        // seven points the eigenvalue of `D⁻¹ A` is `(1 − cos π/3)/3 = 1/6` there, a twelfth of the largest, 2. The
        // polynomial of degree 2 leaves at most `1/T₂(13/11) = 0.56` of the errors on that interval, before and again
        // after the correction. A degree more would cost two more products with the matrix in each cycle. The factor of
        // 900 unknowns takes `900³/3 = 2.4e8` operations once, and each solution with it reads 6.5 MB.
        Settings { threshold: 0.05, degree: 2, ratio: 12.0, dense: 900 }
    }
}

/// The size of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelSize {
    /// Its nodes.
    pub nodes: usize,
    /// Unknowns of each node.
    pub width: usize,
    /// Blocks of its matrix.
    pub blocks: usize,
}

/// What has been done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A level of the hierarchy is built.
    Level(LevelSize),
    /// An iteration is done.
    Iteration {
        /// Counted from 1.
        number: usize,
        /// The residual is a share of that at the start, in the norm of the inverse preconditioner.
        residual: f64,
    },
}

/// Hears of each level and iteration, and ends the work where it breaks.
pub type Watch<'a> = dyn FnMut(Event) -> ControlFlow<()> + 'a;

/// Hears nothing and ends nothing.
pub fn unwatched(_: Event) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
