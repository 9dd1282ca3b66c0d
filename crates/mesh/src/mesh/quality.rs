//! The quality of the cells of a mesh, and what happens to poor cells.

use super::fill::Filled;
use crate::error::{Error, Result};
use crate::named::unknown;

/// What happens to cells below the least quality.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Below {
    /// They are reported.
    #[default]
    Warn,
    /// The mesh is refused.
    Refuse,
    /// They are removed, as are cells that are flat or tangled, fold between quadrature points, repeat another cell or are folded
    /// over their neighbours.
    Skip,
}

/// The required quality of cells. The quality is the least `det J/Π ‖J_l‖` over the quadrature points, with J_l the
/// columns of the Jacobian: 1 if the reference directions stay at right angles, 0 if the cell is flat. The determinant,
/// and with it the constants, lose `−log₁₀` of the quality in digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// The least quality, from 0 to 1.
    pub least: f64,
    /// What happens to cells below it.
    pub below: Below,
}

impl Default for Gate {
    /// A least quality of 1e-4: a loss of four digits leaves twelve. Cells of lower quality are reported.
    fn default() -> Gate {
        Gate { least: 1e-4, below: Below::Warn }
    }
}

impl Gate {
    /// A gate from the values of a file or of options.
    ///
    /// # Errors
    /// The word is unknown, or the least quality is not between 0 and 1.
    pub fn named(below: Option<&str>, least: Option<f64>) -> Result<Gate> {
        let gate = Gate::default();
        let below = match below {
            None => gate.below,
            Some("warn") => Below::Warn,
            Some("refuse") => Below::Refuse,
            Some("skip") => Below::Skip,
            Some(other) => {
                return Err(
                    unknown("\"warn\", \"refuse\" or \"skip\"", ["warn", "refuse", "skip"], other).at_key("below")
                );
            }
        };
        let least = least.unwrap_or(gate.least);
        if !(0.0..=1.0).contains(&least) {
            return Err(Error::expected("least", "a quality from 0 to 1", format!("{least:?}")));
        }
        Ok(Gate { least, below })
    }
}

/// The quality of the cells of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Quality {
    /// The worst of all cells.
    pub worst: Option<Worst>,
    /// The number of cells below the least quality that were kept.
    pub poor: usize,
    /// The least quality that was required.
    pub least: f64,
    /// The curved cells that were kept and fold between their quadrature points, in words, and their number.
    pub folding: Option<(usize, String)>,
    /// The number of cells removed for poor quality, or because they are flat or tangled.
    pub skipped: usize,
    /// The number of cells removed because they have the nodes of another cell.
    pub duplicates: usize,
    /// The number of cells removed because they are folded over their neighbours.
    pub folded: usize,
    /// The cells that were reversed, in words, if they are not all.
    pub turned: Option<String>,
    /// The number of points at the position of another point; `None` if this was not tested, or if the coordinates are
    /// too coarse.
    pub coincident: Option<usize>,
    /// The number of points on an edge or a face of a cell that does not have them; `None` as for `coincident`, and for
    /// meshes that are generated or divided.
    pub hanging: Option<usize>,
    /// The number of cells that lie over others on the same side of an edge or a face that they share.
    pub overlapping: usize,
    /// The number of cells that have points or middles of cells of another piece of the mesh inside them.
    pub crossing: usize,
    /// The fill of a surface, beside it.
    pub filled: Option<Filled>,
    /// Whether most cells of a surface in space share no node with another, though they have corners at the same places or on the same edges.
    pub unwelded: bool,
    /// Parts of the mesh that share no node, see [`Mesh::pieces`](super::Mesh::pieces); `None` where they were not counted.
    pub pieces: Option<usize>,
}

/// The cell of least quality.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Worst {
    /// Its quality.
    pub quality: f64,
    /// The element, the number of the cell from 1, and its first point in m, in words.
    pub cell: String,
}
