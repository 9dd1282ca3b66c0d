//! Polygonal data: vertices, lines, polygons and strips of triangles, in this order.

use super::piece::{DataArray, Labels, Piece};
use crate::error::{Error, Result};

/// The cells of one of the four kinds.
#[derive(Default)]
pub(super) struct Cells {
    /// The index in `connectivity` at which each cell ends.
    pub ends: Vec<u64>,
    pub connectivity: Vec<u64>,
}

/// The names of the kinds in XML and in legacy files.
pub(super) const KINDS: [(&str, &str); 4] =
    [("Verts", "VERTICES"), ("Lines", "LINES"), ("Polys", "POLYGONS"), ("Strips", "TRIANGLE_STRIPS")];

/// Puts the cells into a piece, whose arrays have one number for each: several vertices, the lines of a chain and the triangles of
/// a strip become cells of their own with the numbers of the whole.
///
/// # Errors
/// The end of a cell is not in the list of nodes.
pub(super) fn fill(piece: &mut Piece, kinds: [Cells; 4]) -> Result<()> {
    piece.is_surface = true;
    let mut sources = Vec::new();
    let mut source = 0;
    for (kind, cells) in kinds.into_iter().enumerate() {
        let mut start = 0;
        for &end in &cells.ends {
            let nodes = usize::try_from(end).ok().and_then(|end| cells.connectivity.get(start..end));
            let Some(nodes) = nodes else {
                let expected = format!("an end of its nodes from {start} to {}", cells.connectivity.len());
                return Err(Error::expected(format!("{} {}", KINDS[kind].0, source), expected, end));
            };
            let before = piece.types.len();
            let mut push = |cell_type: u8, nodes: &[u64]| {
                piece.connectivity.extend_from_slice(nodes);
                piece.ends.push(piece.connectivity.len() as u64);
                piece.types.push(cell_type);
            };
            match kind {
                0 => nodes.iter().for_each(|&node| push(1, &[node])),
                1 => nodes.windows(2).for_each(|line| push(3, line)),
                // The reader makes triangles and quadrangles of polygons.
                2 => push(7, nodes),
                // Every other triangle of a strip is turned round.
                _ => nodes.windows(3).enumerate().for_each(|(i, t)| match i % 2 {
                    0 => push(5, t),
                    _ => push(5, &[t[1], t[0], t[2]]),
                }),
            }
            sources.extend(std::iter::repeat_n(source, piece.types.len() - before));
            source += 1;
            start += nodes.len();
        }
        if start != cells.connectivity.len() {
            let expected = format!("{start} nodes, where the last cell ends");
            return Err(Error::expected(KINDS[kind].0, expected, cells.connectivity.len()));
        }
    }
    let short = |name: &str, found: usize| Error::expected(name, format!("a value for each of {source} cells"), found);
    for Labels { name, values } in &mut piece.labels {
        let found = values.len();
        let spread = sources.iter().map(|&cell| values.get(cell).copied()).collect::<Option<_>>();
        *values = spread.ok_or_else(|| short(name, found))?;
    }
    for DataArray { name, components, values } in &mut piece.cell_arrays {
        let each = usize::try_from(*components).unwrap_or(usize::MAX);
        let Some(values) = values else { continue };
        let found = values.len();
        let of = |cell: &usize| values.get(cell.saturating_mul(each)..).and_then(|rest| rest.get(..each));
        let spread: Option<Vec<&[f64]>> = sources.iter().map(of).collect();
        *values = spread.ok_or_else(|| short(name, found))?.concat();
    }
    Ok(())
}
