//! Pieces of an unstructured grid, and the mesh that they form.

use super::cells::{shape, without_raster};
use crate::error::{Error, Result};
use crate::mesh::grouping::Gather;
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::source::{Format, MeshSource, SourceBlock};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The largest number of different values of an array that names groups.
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
}

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
pub(in crate::mesh) fn mesh(pieces: Vec<Piece>) -> Result<MeshSource> {
    let arrays = grouping_arrays(&pieces);
    let places: HashMap<&str, usize> = arrays.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let mut points = Vec::new();
    let mut cells: Gather<Key> = Gather::new();
    let mut nodes = Vec::new();
    for piece in pieces {
        check_lengths(&piece)?;
        let mut columns = BTreeMap::new();
        for labels in &piece.labels {
            if let Some(&place) = places.get(labels.name.as_str()) {
                columns.entry(place).or_insert(&labels.values);
            }
        }
        let mut key: Key = (0, 0, Vec::new());
        let mut start = 0;
        for (i, (&cell_type, &end)) in piece.types.iter().zip(&piece.ends).enumerate() {
            let Some((_, node_count)) = shape(cell_type) else {
                return Err(Error::new(format!(
                    "cell {i}: VTK cell type {cell_type} has no fixed shape or is unknown"
                )));
            };
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
                nodes.push(points.len() + place);
            }
            key.0 = without_raster(cell_type, &mut nodes);
            key.1 = nodes.len();
            key.2.clear();
            key.2.extend(columns.iter().map(|(&place, values)| (place, values[i])));
            cells.list(&key).extend_from_slice(&nodes);
            start = end;
        }
        points.extend_from_slice(&piece.points);
    }
    let blocks = cells.into_lists().filter_map(|((cell_type, nodes_per_cell, values), connectivity)| {
        let (dimension, _) = shape(cell_type)?;
        let groups = values.into_iter().map(|(place, value)| format!("{}={value}", arrays[place])).collect();
        Some(SourceBlock { dimension, cell_type: cell_type.into(), nodes_per_cell, connectivity, groups })
    });
    let numbers = (0..points.len() as u64).collect();
    let origin = NumberOrigin::VtkPlace;
    Ok(MeshSource { format: Format::Vtk, origin, blocks: blocks.collect(), points, numbers })
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
fn grouping_arrays(pieces: &[Piece]) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut values: HashMap<&str, HashSet<i128>> = HashMap::new();
    for labels in pieces.iter().flat_map(|piece| &piece.labels) {
        let of_name = values.entry(&labels.name).or_insert_with(|| {
            names.push(&labels.name);
            HashSet::new()
        });
        for &value in &labels.values {
            if of_name.len() > MOST_GROUPS {
                break;
            }
            of_name.insert(value);
        }
    }
    names.into_iter().filter(|name| values[name].len() <= MOST_GROUPS).map(str::to_string).collect()
}
