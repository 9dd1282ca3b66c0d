//! The files of TetGen and Triangle: points (`.node`), cells (`.ele`) and marked faces (`.face`).

use super::annotations::Annotations;
use super::lines::Lines;
use super::listing::{Listing, Resolved};
use super::polytope::CellType;
use super::reader::quoted;
use super::source::MeshSource;
use crate::error::{Error, ErrorKind, Result};

/// The endings of the files of a mesh: points, cells and, if they are there, faces.
pub(super) const ENDINGS: [&str; 3] = ["node", "ele", "face"];

/// The order of VTK by places in that of TetGen: its middles are those of the edges 3-4, 1-4, 1-2, 2-3, 2-4 and 1-3, and
/// those of Triangle of the edges 2-3, 1-3 and 1-2.
const TET10: [usize; 10] = [0, 1, 2, 3, 6, 7, 9, 5, 8, 4];
const TRI6: [usize; 6] = [0, 1, 2, 5, 3, 4];

/// Reads the points and tetrahedra of TetGen, of four or ten nodes, or triangles of Triangle, of three or six. The last
/// attribute of the cells names groups `region=NUMBER`; marks of points and faces other than 0 name groups `mark=NUMBER`.
///
/// # Errors
/// A file is damaged or cut short, or names a point that is not there. The key of the error begins with the file's ending.
pub fn parse(node: &[u8], ele: &[u8], face: Option<&[u8]>) -> Result<MeshSource> {
    let length = node.len() + ele.len() + face.map_or(0, <[u8]>::len);
    let mut listing = Listing::default();
    let mut node = Table::new(".node", node)?;
    let mut annotations = Annotations::default();
    let marks = points(&mut node, &mut listing)?;
    node.lines.beyond("points of .node").into_iter().for_each(|sentence| annotations.remark(sentence));
    let mut ele = Table::new(".ele", ele)?;
    let regions = cells(&mut ele, &mut listing)?;
    ele.lines.beyond("cells of .ele").into_iter().for_each(|sentence| annotations.remark(sentence));
    let mut resolved = listing.resolve(length, ".ele: cell")?;
    // TetGen marks with zero what has no mark.
    for (place, mark) in marks.into_iter().enumerate().filter(|(_, mark)| *mark != 0) {
        let group = resolved.group(&format!("mark={mark}"));
        resolved.add_node(group, place)?;
    }
    for (cell, region) in regions.into_iter().enumerate() {
        let group = resolved.group(&format!("region={region}"));
        resolved.add_cell(group, cell)?;
    }
    if let Some(face) = face {
        let mut face = Table::new(".face", face)?;
        faces(&mut face, &mut resolved)?;
        face.lines.beyond("faces of .face").into_iter().for_each(|sentence| annotations.remark(sentence));
    }
    Ok(resolved.into_source(annotations))
}

/// A file: a line of counts, then one line for each thing.
struct Table<'a> {
    lines: Lines<'a>,
    counts: Vec<u64>,
}

impl<'a> Table<'a> {
    fn new(name: &str, bytes: &'a [u8]) -> Result<Table<'a>> {
        let mut lines = Lines::new(bytes);
        lines.enter(name);
        let Some(words) = lines.next_words() else { return Err(lines.ends()) };
        let counts: Result<Vec<u64>> = words.iter().map(|word| lines.whole(word, "a count")).collect();
        let counts = counts?;
        Ok(Table { lines, counts })
    }

    /// A count of the first line; zero for one that is not there.
    fn count(&self, index: usize) -> u64 {
        self.counts.get(index).copied().unwrap_or(0)
    }

    /// The words of each line, as many as there are things.
    fn read(&mut self, what: &str, mut each: impl FnMut(&Lines, &[&[u8]]) -> Result<()>) -> Result<()> {
        let count = self.count(0);
        for found in 0..count {
            let Some(words) = self.lines.next_words() else {
                let error = self.lines.ends();
                return Err(error.followed_by(format!(": expected {count} {what}, found {found}")));
            };
            each(&self.lines, &words)?;
        }
        Ok(())
    }
}

/// Reads the points, and returns their marks.
fn points(table: &mut Table, listing: &mut Listing) -> Result<Vec<i64>> {
    let (dimension, attributes, has_marks) = (table.count(1), table.count(2), table.count(3) != 0);
    if dimension != 2 && dimension != 3 {
        return Err(table.lines.expected("2 or 3 dimensions", &dimension.to_string()));
    }
    let mut marks = Vec::new();
    table.read("points", |lines, words| {
        let word = |index: usize| words.get(index).copied().unwrap_or_default();
        let mut point = [0.0; 3];
        for k in 0..dimension as usize {
            point[k] = lines.real(word(1 + k), "a coordinate")?;
        }
        listing.node_numbers.push(lines.whole(word(0), "the number of a point")?);
        listing.points.push(point);
        if has_marks {
            let at = usize::try_from(attributes.saturating_add(1 + dimension)).unwrap_or(usize::MAX);
            marks.push(mark(lines, word(at))?);
        }
        Ok(())
    })?;
    Ok(marks)
}

fn mark(lines: &Lines, word: &[u8]) -> Result<i64> {
    let mark = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    mark.ok_or_else(|| lines.expected("a mark", &quoted(word)))
}

/// Reads the cells, and returns their regions.
fn cells(table: &mut Table, listing: &mut Listing) -> Result<Vec<String>> {
    let (cell_type, order): (CellType, &[usize]) = match table.count(1) {
        3 => (CellType::TRI3, &[0, 1, 2]),
        4 => (CellType::TET4, &[0, 1, 2, 3]),
        6 => (CellType::TRI6, &TRI6),
        10 => (CellType::TET10, &TET10),
        other => return Err(table.lines.expected("3, 4, 6 or 10 nodes of each cell", &other.to_string())),
    };
    let attributes = table.count(2);
    let mut regions = Vec::new();
    table.read("cells", |lines, words| {
        let word = |index: usize| words.get(index).copied().unwrap_or_default();
        let number = lines.whole(word(0), "the number of a cell")?;
        let node = |place: &usize| lines.whole(word(1 + place), "the number of a point");
        let nodes: Result<Vec<u64>> = order.iter().map(node).collect();
        listing.cells.push(lines.number(), number, cell_type, nodes?);
        if attributes > 0 {
            let last = usize::try_from(attributes.saturating_add(cell_type.nodes() as u64)).unwrap_or(usize::MAX);
            let region = lines.real(word(last), "an attribute")?;
            // Attributes are real numbers. A whole one is written without a point, as regions are numbered.
            regions.push(format!("{region}"));
        }
        Ok(())
    })?;
    Ok(regions)
}

/// Adds the marked faces to the groups of their marks.
fn faces(table: &mut Table, resolved: &mut Resolved) -> Result<()> {
    // Faces without marks belong to no group.
    if table.count(1) == 0 {
        return Ok(());
    }
    table.read("faces", |lines, words| {
        let word = |index: usize| words.get(index).copied().unwrap_or_default();
        // Faces of quadratic cells have three middles after the corners, and the mark may be followed by two cells.
        let is_quadratic = resolved.list.len() > 0 && resolved.list.cell_type(0) == CellType::TET10;
        let count = if is_quadratic { 6 } else { 3 };
        let mark = mark(lines, word(1 + count))?;
        if mark == 0 {
            return Ok(());
        }
        let mut nodes = Vec::with_capacity(count);
        for index in 1..=count {
            let number = lines.whole(word(index), "the number of a point")?;
            let missing = || lines.expected("the number of a point of the .node file", &number.to_string());
            nodes.push(resolved.nodes.index(number).ok_or_else(missing)?);
        }
        let (cell_type, nodes) = match count {
            3 => (CellType::TRI3, nodes),
            _ => (CellType::TRI6, TRI6.iter().map(|&place| nodes[place]).collect()),
        };
        let group = resolved.group(&format!("mark={mark}"));
        // A point on several marked faces has the mark of one: the mark of a face is that of its points as well.
        nodes.iter().try_for_each(|&node| resolved.add_node(group, node))?;
        resolved.add_face(group, cell_type, nodes)
    })
}

/// The error for one of the files alone.
pub(super) fn alone(ending: &str) -> Error {
    let problem = format!("expected the files .node and .ele of a mesh, found one ending in .{ending} alone");
    Error::new(problem).of_kind(ErrorKind::Unsupported)
}
