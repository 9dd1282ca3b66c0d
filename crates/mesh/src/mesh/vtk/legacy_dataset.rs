//! The kinds of grid in legacy files, and what only some of them have.

use super::image::Image;
use super::lattice::{AXES, Lattice};
use super::legacy_cells;
use super::piece::{Labels, Piece};
use super::polydata::{self, Cells, KINDS};
use crate::error::Result;
use crate::mesh::reader::Reader;

/// What `DATASET` names.
#[derive(Default)]
pub(super) enum Dataset {
    #[default]
    Unstructured,
    Polygons([Cells; 4]),
    /// A lattice of points that are in the file one by one.
    Structured(Option<Lattice>),
    Rectilinear(Option<Lattice>, [Vec<f64>; 3]),
    Points(Voxels),
}

/// An image.
pub(super) struct Voxels {
    lattice: Option<Lattice>,
    origin: [f64; 3],
    spacing: [f64; 3],
    of_points: Vec<Labels>,
}

impl Dataset {
    /// The names of the kinds.
    pub const NAMES: [&str; 5] =
        ["UNSTRUCTURED_GRID", "POLYDATA", "STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"];

    /// The kind with this place among the names.
    pub fn at(place: usize) -> Dataset {
        match place {
            0 => Dataset::Unstructured,
            1 => Dataset::Polygons(Default::default()),
            2 => Dataset::Structured(None),
            3 => Dataset::Rectilinear(None, Default::default()),
            _ => Dataset::Points(Voxels { lattice: None, origin: [0.0; 3], spacing: [1.0; 3], of_points: Vec::new() }),
        }
    }

    /// The sections that a file must have.
    pub fn sections(&self) -> &'static [&'static str] {
        match self {
            Dataset::Unstructured => &["POINTS", "CELLS", "CELL_TYPES"],
            Dataset::Polygons(_) => &["POINTS"],
            Dataset::Structured(_) => &["DIMENSIONS", "POINTS"],
            Dataset::Rectilinear(..) => &["DIMENSIONS", AXES[0], AXES[1], AXES[2]],
            Dataset::Points(_) => &["DIMENSIONS"],
        }
    }

    /// Whether a file may have this section besides.
    pub fn has(&self, section: &str) -> bool {
        match self {
            Dataset::Polygons(_) => KINDS.iter().any(|(_, kind)| *kind == section),
            Dataset::Points(_) => ["ORIGIN", "SPACING", "ASPECT_RATIO"].contains(&section),
            Dataset::Unstructured | Dataset::Structured(_) | Dataset::Rectilinear(..) => false,
        }
    }

    /// Whether whole numbers of points may be labels.
    pub fn is_image(&self) -> bool {
        matches!(self, Dataset::Points(_))
    }

    pub fn add_point_labels(&mut self, labels: Labels) {
        if let Dataset::Points(voxels) = self {
            voxels.of_points.push(labels);
        }
    }

    /// How many cells the arrays of cells have values for.
    pub fn cell_count(&self, piece: &Piece) -> usize {
        match self {
            Dataset::Unstructured => piece.types.len(),
            Dataset::Polygons(kinds) => kinds.iter().map(|cells| cells.ends.len()).sum(),
            _ => self.lattice().map_or(0, |lattice| lattice.cell_count()),
        }
    }

    /// How many points the arrays of points have values for.
    pub fn point_count(&self, piece: &Piece) -> usize {
        self.lattice().map_or(piece.points.len(), |lattice| lattice.point_count())
    }

    fn lattice(&self) -> Option<Lattice> {
        match self {
            Dataset::Unstructured | Dataset::Polygons(_) => None,
            Dataset::Structured(lattice) | Dataset::Rectilinear(lattice, _) => *lattice,
            Dataset::Points(voxels) => voxels.lattice,
        }
    }

    /// The piece with the cells of this kind of grid.
    ///
    /// # Errors
    /// The cells and the points do not belong together, or the labels of an image do not say what its cells are.
    pub fn finish(self, mut piece: Piece) -> Result<Piece> {
        let with_cells = |piece: Piece, cells: Piece| Piece {
            types: cells.types,
            ends: cells.ends,
            connectivity: cells.connectivity,
            ..piece
        };
        match self {
            Dataset::Unstructured => Ok(piece),
            Dataset::Polygons(kinds) => polydata::fill(&mut piece, kinds).map(|()| piece),
            Dataset::Structured(lattice) => {
                let Some(lattice) = lattice else { return Ok(piece) };
                lattice.check_points(piece.points.len())?;
                Ok(with_cells(piece, lattice.piece(|_| true, false, |_| [0.0; 3])?))
            }
            Dataset::Rectilinear(lattice, axes) => {
                let Some(lattice) = lattice else { return Ok(piece) };
                (0..3).try_for_each(|k| lattice.check_axis(k, axes[k].len()))?;
                let cells = lattice.limited()?.piece(|_| true, false, |at| std::array::from_fn(|k| axes[k][at[k]]))?;
                piece.points.clone_from(&cells.points);
                Ok(with_cells(piece, cells))
            }
            Dataset::Points(Voxels { lattice, origin, spacing, of_points }) => {
                let Some(lattice) = lattice else { return Ok(piece) };
                let steps =
                    std::array::from_fn(|k| std::array::from_fn(|axis| if axis == k { spacing[k] } else { 0.0 }));
                Image { lattice, origin, steps }.piece(piece.labels, of_points, None)
            }
        }
    }

    /// Reads a section that only some kinds of grid have.
    ///
    /// # Errors
    /// It is damaged or cut short.
    pub fn read(&mut self, section: &str, reader: &mut Reader) -> Result<()> {
        let named = |list: &[&str]| list.iter().position(|name| *name == section);
        match (self, section) {
            (Dataset::Structured(lattice) | Dataset::Rectilinear(lattice, _), "DIMENSIONS")
            | (Dataset::Points(Voxels { lattice, .. }), "DIMENSIONS") => {
                let counts = [reader.text_number()?, reader.text_number()?, reader.text_number()?];
                let found = Lattice::new(counts)
                    .map_err(|_| reader.expected("three counts of points above zero", &format!("{counts:?}")))?;
                *lattice = Some(found);
            }
            (Dataset::Polygons(kinds), _) => {
                let cells = legacy_cells::read(reader)?;
                if let Some(kind) = named(&KINDS.map(|(_, name)| name)) {
                    kinds[kind] = cells;
                }
            }
            (Dataset::Rectilinear(_, axes), _) => {
                let count = reader.text_number()?;
                let values = legacy_cells::scalar_type(reader)?.reals(reader, count)?;
                if let Some(axis) = named(&AXES) {
                    axes[axis] = values;
                }
            }
            (Dataset::Points(voxels), _) => {
                let numbers = [reader.text_number()?, reader.text_number()?, reader.text_number()?];
                match section {
                    "ORIGIN" => voxels.origin = numbers,
                    _ => voxels.spacing = numbers,
                }
            }
            (Dataset::Unstructured | Dataset::Structured(_), _) => {}
        }
        Ok(())
    }
}
