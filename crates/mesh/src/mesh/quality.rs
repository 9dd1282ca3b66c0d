//! The quality of the cells of a mesh, and what happens to poor cells.

use super::fill::Filled;
use crate::error::{Error, Result};
use crate::named::unknown;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

/// The quality of the mesh.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "QualityRecord")]
#[non_exhaustive]
pub struct Quality {
    /// The least quality of an element is from 0 for flat to 1 for right angles.
    pub worst: Option<f64>,
    /// The element and number of the cell say where the least quality is.
    pub worst_cell: Option<String>,
    /// This number of elements is below the limit; it is null if quality was not measured, as for a generated mesh.
    #[serde(rename = "poor_elements")]
    pub poor: Option<usize>,
    /// The least quality that was required.
    #[serde(skip)]
    pub least: f64,
    /// The curved cells that were kept and fold between their quadrature points, in words, and their number.
    #[serde(skip)]
    pub folding: Option<(usize, String)>,
    /// This number of elements was left out because they are poor, flat or tangled.
    #[serde(rename = "skipped_elements")]
    pub skipped: usize,
    /// This number of elements was left out because another has the same nodes.
    #[serde(rename = "duplicate_elements")]
    pub duplicates: usize,
    /// This number of elements was left out because they are folded over their neighbours.
    #[serde(rename = "folded_elements")]
    pub folded: usize,
    /// The cells that were reversed, in words, if they are not all.
    #[serde(skip)]
    pub turned: Option<String>,
    /// This number of nodes is at the place of another; it is null if coordinates are too coarse to tell.
    #[serde(rename = "coincident_nodes")]
    pub coincident: Option<usize>,
    /// This number of nodes is on edges or faces that do not have them. It is null if coordinates are too coarse to tell, or if the mesh
    /// was generated or divided.
    #[serde(rename = "hanging_nodes")]
    pub hanging: Option<usize>,
    /// The number of cells that lie over others on the same side of an edge or a face that they share.
    #[serde(skip)]
    pub overlapping: usize,
    /// The number of cells that have points or middles of cells of another piece of the mesh inside them.
    #[serde(skip)]
    pub crossing: usize,
    /// The fill of a surface, beside it.
    #[serde(skip)]
    pub filled: Option<Filled>,
    /// Whether most cells of a surface in space share no node with another, though they have corners at the same places or on the same edges.
    #[serde(skip)]
    pub unwelded: bool,
    /// The mesh has this number of parts that share no node; it is null if they were not counted.
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
