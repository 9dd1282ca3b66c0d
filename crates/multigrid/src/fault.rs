//! Why there is no hierarchy, or no solution.

use crate::settings::LevelSize;
use std::fmt;

/// A motion, on all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The largest entry is 1 in size; zero in what is held.
    pub displacement: Vec<f64>,
    /// `xᵀ A x / Σ_i |x_i|ᵀ |A_ii| |x_i|`, the energy by that which the blocks of the diagonal alone would store: not above zero up to
    /// rounding.
    pub energy: f64,
}

/// Why there is no hierarchy, or no solution.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// Some motion releases energy, or meets no resistance.
    NotPositive(Motion),
    /// The watch broke off.
    Interrupted,
    /// The last level is too large to be factorised, and its nodes do not group.
    Stagnant {
        /// The levels so far.
        levels: Vec<LevelSize>,
    },
    /// The residual does not become less.
    Stalled {
        /// `‖b − A x‖/‖b‖`, worked out from the last x.
        residual: f64,
        /// Iterations until then.
        iterations: usize,
        /// The levels of the preconditioner.
        levels: Vec<LevelSize>,
    },
    /// An array has not the size that the matrix asks for.
    Size {
        /// The array.
        what: &'static str,
        /// Its entries, as the matrix asks for.
        expected: usize,
        /// Its entries.
        found: usize,
    },
    /// An entry of the matrix or of a vector is not finite.
    NotFinite,
}

/// The levels in words: `343000 × 3, 14000 × 6, 520 × 6`.
pub fn sizes(levels: &[LevelSize]) -> String {
    let each = levels.iter().map(|level| format!("{} × {}", level.nodes, level.width));
    each.collect::<Vec<_>>().join(", ")
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NotPositive(motion) => {
                write!(f, "the matrix is not positive definite: a motion has the relative energy {:.1e}", motion.energy)
            }
            Fault::Interrupted => write!(f, "interrupted"),
            Fault::Stagnant { levels } => write!(
                f,
                "the nodes do not group any more, and the last level is too large to be factorised (levels: {}): lower the \
                 threshold, or use a direct solver",
                sizes(levels)
            ),
            Fault::Stalled { residual, iterations, levels } => write!(
                f,
                "the solution stalls at the relative residual {residual:.1e} after {iterations} iterations (levels: {}): more \
                 iterations, a larger tolerance, a higher degree of the smoother, a mesh with better cells, or a direct \
                 solver may help",
                sizes(levels)
            ),
            Fault::Size { what, expected, found } => write!(f, "expected {expected} entries of {what}, found {found}"),
            Fault::NotFinite => write!(f, "an entry is not a finite number"),
        }
    }
}

impl std::error::Error for Fault {}
