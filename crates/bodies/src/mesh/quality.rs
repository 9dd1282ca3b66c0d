//! The quality of the cells of a mesh.

use crate::error::{Error, Result};

/// What becomes of cells whose quality is below the least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Below {
    /// They are reported.
    #[default]
    Warn,
    /// The mesh is not taken.
    Refuse,
    /// They are left out, as are cells that are flat or tangled, repeat another or are folded over their neighbours.
    Skip,
}

/// The quality that is asked of cells: the least `det J / Π ‖J_l‖` over the quadrature points, J_l the columns of the Jacobian; 1
/// where the reference directions stay at right angles, 0 where the cell is flat. The determinant loses `−log₁₀` of it in digits,
/// and the constants with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    pub least: f64,
    pub below: Below,
}

impl Default for Gate {
    /// A loss of four digits leaves twelve; cells of lower quality are reported.
    fn default() -> Gate {
        Gate { least: 1e-4, below: Below::Warn }
    }
}

impl Gate {
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
                return Err(Error::expected("below", "\"warn\", \"refuse\" or \"skip\"", format!("\"{other}\"")));
            }
        };
        let least = least.unwrap_or(gate.least);
        if !(0.0..=1.0).contains(&least) {
            return Err(Error::expected("least", "a quality from 0 to 1", format!("{least:?}")));
        }
        Ok(Gate { least, below })
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quality {
    /// Of all cells.
    pub worst: Option<Worst>,
    /// Cells below the least quality that were kept, and what that was.
    pub poor: usize,
    pub least: f64,
    /// Cells left out: of poor quality, flat or tangled.
    pub skipped: usize,
    /// Cells left out because they have the nodes of another.
    pub duplicates: usize,
    /// Cells left out because they are folded over their neighbours.
    pub folded: usize,
    /// The cells that were turned, in words, where they are not all.
    pub turned: Option<String>,
    /// Points at the place of another; `None` where that was not looked for, or where coordinates are too coarse to tell.
    pub coincident: Option<usize>,
    /// Points on an edge or a face of a cell that does not have them; `None` as there, and for meshes that are generated or divided.
    pub hanging: Option<usize>,
    /// Parts of the mesh that share no node, see [`Mesh::pieces`](super::Mesh::pieces); `None` where they were not counted.
    pub pieces: Option<usize>,
}

/// The cell of least quality.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    pub quality: f64,
    /// The element, the number of the cell from 1, and its first point, m.
    pub cell: String,
}
