//! Pieces of an unstructured grid, and the mesh that they form.

use super::cells::{plain, shape};
use super::division::Division;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::annotations::Annotations;
use crate::mesh::grouping::{Gather, Gathered};
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::source::{Format, MeshSource, SourceBlock};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The largest number of different values of an array that names groups.
// Arrays with more values number cells or hold quantities: each value would become a group with a list of its cells.
const MOST_GROUPS: usize = 1000;

/// Points and cells, as both kinds of file hold them.
#[derive(Default)]
pub(in crate::mesh) struct Piece {
    pub points: Vec<[f64; 3]>,
    pub types: Vec<u8>,
    /// The index in `connectivity` at which each cell ends.
    pub ends: Vec<u64>,
    pub connectivity: Vec<u64>,
    pub labels: Vec<Labels>,
    pub point_arrays: Vec<DataArray>,
    pub cell_arrays: Vec<DataArray>,
    /// Whether the cells are polygonal data, which are surfaces.
    pub is_surface: bool,
    /// What was left out of the file because it is damaged and not needed.
    pub remarks: Vec<String>,
}

/// The array of cells that are there for other pieces or that are hidden, by bits; it names no groups.
const GHOSTS: &str = "vtkGhostType";
/// The bits of cells that are in another piece as well, that are divided into others, and that are hidden.
const GHOSTLY: i128 = 1 | 8 | 32;

/// The largest number of different values of an array of real numbers that are labels because all are whole.
// Real numbers that are whole may be measurements in coarse steps; bodies seldom have as many materials.
const MOST_REAL_LABELS: usize = 64;

/// An array with one whole number per cell.
pub(in crate::mesh) struct Labels {
    pub name: String,
    pub values: Vec<i128>,
}

impl Labels {
    /// Converts the whole numbers to real ones.
    pub fn as_array(&self) -> DataArray {
        let values = self.values.iter().map(|value| *value as f64).collect();
        DataArray { name: self.name.clone(), components: 1, values: Some(values) }
    }
}

/// An array with the same number of components for each point or each cell.
pub(in crate::mesh) struct DataArray {
    pub name: String,
    pub components: u64,
    /// All components of the first, then of the next; `None` if they are not one to three real numbers, or one whole number of a cell.
    pub values: Option<Vec<f64>>,
}

impl DataArray {
    /// Whether this is the number of components of vectors in the plane or in space.
    pub fn is_vector(components: u64) -> bool {
        components == 2 || components == 3
    }

    /// Whether arrays of real numbers with so many components are kept.
    pub fn is_kept(components: u64) -> bool {
        (1..=3).contains(&components)
    }

    /// The vectors, if the array is one of real vectors.
    pub fn vectors(&self) -> Option<&[f64]> {
        self.values.as_deref().filter(|_| DataArray::is_vector(self.components))
    }
}

/// Cell type, nodes per cell, and index and value of each grouping array that the piece of the cell has.
type Key = (u8, usize, Vec<(usize, i128)>);

/// The mesh of all pieces, one after the other.
///
/// # Errors
/// A cell is of a type without a fixed shape, has the wrong number of nodes, or names a point that its piece lacks.
pub(in crate::mesh) fn mesh(mut all: Vec<Piece>) -> Result<MeshSource> {
    all.iter_mut().for_each(Piece::label_whole_reals);
    let is_surface = all.iter().all(|piece| piece.is_surface);
    let mut annotations = Annotations::default();
    let arrays = grouping_arrays(&all, &mut annotations);
    let places: HashMap<&str, usize> = arrays.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let mut points = Vec::new();
    let mut cells: Gather<Key> = Gather::new();
    let mut division = Division::default();
    let mut nodes = Vec::new();
    for mut piece in all {
        check_lengths(&piece)?;
        piece.remarks.drain(..).for_each(|remark| annotations.remark(remark));
        let ghosts =
            piece.labels.iter().position(|labels| labels.name == GHOSTS).map(|at| piece.labels.remove(at).values);
        let mut columns = BTreeMap::new();
        for labels in &piece.labels {
            if let Some(&place) = places.get(labels.name.as_str()) {
                columns.entry(place).or_insert(&labels.values);
            }
        }
        let mut key: Key = (0, 0, Vec::new());
        let first = points.len();
        points.extend_from_slice(&piece.points);
        let mut start = 0;
        for (i, (&cell_type, &end)) in piece.types.iter().zip(&piece.ends).enumerate() {
            let is_ghost = ghosts.as_ref().is_some_and(|ghosts| ghosts[i] & GHOSTLY != 0);
            if cell_type == EMPTY || is_ghost {
                annotations.leave_out(if is_ghost { "hidden or repeated cell" } else { "empty cell" }, 1);
                start = usize::try_from(end).unwrap_or(usize::MAX);
                continue;
            }
            let Some((_, node_count)) = shape(cell_type) else {
                let problem = format!("cell {i}: VTK cell type {cell_type} has no fixed shape or is unknown");
                return Err(Error::new(format!("{problem}; {TETRAHEDRALIZE}")));
            };
            // An end beyond the machine's numbers is beyond every list, and is told as one.
            let end = usize::try_from(end).unwrap_or(usize::MAX);
            let Some(cell) = piece.connectivity.get(start..end) else {
                let problem =
                    format!("cell {i}: expected an end of its nodes from {start} to {}", piece.connectivity.len());
                return Err(Error::new(format!("{problem}, found {end}")));
            };
            if cell.is_empty() || node_count.is_some_and(|count| count != cell.len()) {
                let count = node_count.map_or("some".to_string(), |count| count.to_string());
                let problem = format!("cell {i}: expected {count} nodes for VTK cell type {cell_type}");
                return Err(Error::new(format!("{problem}, found {}", cell.len())));
            }
            nodes.clear();
            for &node in cell {
                let place = usize::try_from(node).ok().filter(|&place| place < piece.points.len());
                let Some(place) = place else {
                    let problem = format!("cell {i}: expected point indices below {}", piece.points.len());
                    return Err(Error::new(format!("{problem}, found {node}")));
                };
                nodes.push(first + place);
            }
            key.2.clear();
            key.2.extend(columns.iter().map(|(&place, values)| (place, values[i])));
            start = end;
            let unlike =
                |expected| Error::new(format!("cell {i}: expected {expected}")).of_kind(ErrorKind::Unsupported);
            if let Some(parts) = division.parts(cell_type, &nodes, &points).map_err(unlike)? {
                for (cell_type, part) in parts {
                    (key.0, key.1) = (cell_type, part.len());
                    cells.list(&key).extend(part);
                }
                continue;
            }
            key.0 = plain(cell_type, &mut nodes, &points);
            key.1 = nodes.len();
            cells.list(&key).extend_from_slice(&nodes);
        }
    }
    division.tell(&mut annotations);
    let blocks = cells.into_lists().filter_map(|Gathered { key: (cell_type, nodes_per_cell, values), nodes, runs }| {
        let (dimension, _) = shape(cell_type)?;
        let groups = values.into_iter().map(|(place, value)| format!("{}={value}", arrays[place])).collect();
        Some(SourceBlock {
            dimension,
            cell_type: cell_type.into(),
            nodes_per_cell,
            connectivity: nodes,
            groups,
            is_marker: true,
            runs,
        })
    });
    let numbers = (0..points.len() as u64).collect();
    let space = is_surface.then_some(3);
    let origin = NumberOrigin::VtkPlace;
    Ok(MeshSource { format: Format::Vtk, origin, blocks: blocks.collect(), points, numbers, space, annotations })
}

/// The way out for cells that are not taken.
const TETRAHEDRALIZE: &str = "ParaView's filter Tetrahedralize makes tetrahedra of all cells that VTK knows";

/// The type of cells without nodes.
const EMPTY: u8 = 0;

impl Piece {
    /// Makes labels of arrays of real numbers of the cells that are all whole, and few: programs without other arrays write labels so.
    fn label_whole_reals(&mut self) {
        let cells = self.types.len();
        for array in &self.cell_arrays {
            let is_known = self.labels.iter().any(|labels| labels.name == array.name);
            let Some(values) = array.values.as_ref().filter(|values| values.len() == cells && !is_known) else {
                continue;
            };
            // Larger numbers are no labels that anyone has given, and their last digits are not exact.
            let whole = |value: &f64| (value.fract() == 0.0 && value.abs() < 1e15).then_some(*value as i128);
            let Some(values) = values.iter().map(whole).collect::<Option<Vec<i128>>>() else { continue };
            let different: HashSet<i128> = values.iter().copied().collect();
            if different.len() <= MOST_REAL_LABELS {
                self.labels.push(Labels { name: array.name.clone(), values });
            }
        }
    }
}

fn check_lengths(piece: &Piece) -> Result<()> {
    let cells = piece.types.len();
    if piece.ends.len() != cells {
        return Err(Error::expected("cells", format!("{cells} of them, one for each type"), piece.ends.len()));
    }
    let used = piece.ends.last().copied().unwrap_or(0);
    if used != piece.connectivity.len() as u64 {
        return Err(Error::expected("cells", format!("{used} nodes in all"), piece.connectivity.len()));
    }
    match piece.labels.iter().find(|labels| labels.values.len() != cells) {
        Some(labels) => Err(Error::expected(&labels.name, format!("{cells} values"), labels.values.len())),
        None => Ok(()),
    }
}

/// The names, in order of occurrence, of the arrays with few enough values.
fn grouping_arrays(pieces: &[Piece], annotations: &mut Annotations) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut values: HashMap<&str, HashSet<i128>> = HashMap::new();
    for labels in pieces.iter().flat_map(|piece| &piece.labels) {
        let of_name = values.entry(&labels.name).or_insert_with(|| {
            names.push(&labels.name);
            HashSet::new()
        });
        for &value in &labels.values {
            // One value more than is allowed shows that there are too many.
            if of_name.len() > MOST_GROUPS {
                break;
            }
            of_name.insert(value);
        }
    }
    let (few, many): (Vec<&str>, Vec<&str>) = names.into_iter().partition(|name| values[name].len() <= MOST_GROUPS);
    for name in many {
        annotations
            .remark(format!("the array \"{name}\" has more than {MOST_GROUPS} different numbers, and names no groups"));
    }
    few.into_iter().map(str::to_string).collect()
}
