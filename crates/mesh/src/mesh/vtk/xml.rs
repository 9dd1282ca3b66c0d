//! XML files: `.vtu`, `.vtp`, `.vti`, `.vts` and `.vtr`.

use super::document::{ArrayTag, Content, Document, PieceTag, Section};
use super::grid_kind::{Extent, GridKind};
use super::lattice_pieces::{Part, joined};
use super::piece::{self, DataArray, Labels, Piece};
use super::polydata::{self, Cells, KINDS};
use super::storage::Stored;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::reader::{Encoding, Reader};
use crate::mesh::source::MeshSource;
use std::borrow::Cow;

/// The largest number of bytes, stored and decoded, of all binary arrays together per byte of the file. An array of
/// equal numbers may have a thousand, but few files consist of such arrays.
const MOST_GROWTH: u64 = 100;
/// The number of bytes that is allowed in any file.
// A short file of equal numbers may grow more than a hundredfold, and 16 MB harm nobody.
const ALWAYS_ALLOWED: u64 = 1 << 24;
/// The largest number of damaged arrays of a piece that are left out.
// Each is a remark. With more of them the file is damaged as a whole, and the first that is not left out is the error.
const MOST_DAMAGED: usize = 20;

/// Reads a grid, its arrays as text, in base64 or appended in base64 or raw, in either byte
/// order, uncompressed or compressed by zlib, LZ4 or XZ.
///
/// Cells of one type form one block if they agree in every array of whole numbers that has one number per cell and at
/// most 1000 different numbers; each such array gives the group `array=number`. Pixels and voxels become quadrangles
/// and hexahedra. Voxels of an image are cells if their label is not zero.
///
/// # Errors
/// The file is of another kind, damaged, cut short or compressed by another method, or has cells without a
/// fixed shape such as polygons.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    piece::mesh(pieces(bytes)?)
}

/// The pieces as they are in the file: cells are not checked, and points may not be finite.
///
/// # Errors
/// The file is of another kind, damaged, cut short or compressed by another method.
pub(in crate::mesh) fn pieces(bytes: &[u8]) -> Result<Vec<Piece>> {
    let document = Document::read(bytes)?;
    if document.pieces.is_empty() {
        return Err(Error::expected(document.kind.name(), "at least one <Piece>", "none"));
    }
    let mut arrays = Arrays { document: &document, size: 0 };
    match document.kind {
        GridKind::Image => Ok(vec![arrays.image()?]),
        GridKind::Structured | GridKind::Rectilinear => Ok(vec![arrays.lattice()?]),
        GridKind::Unstructured | GridKind::Polygonal => document.pieces.iter().map(|tag| arrays.piece(tag)).collect(),
    }
}

/// The box of the extents of pieces.
///
/// # Errors
/// They do not fill it, or it has too many points: a short file can announce many places.
fn whole(extents: &[Extent]) -> Result<Extent> {
    let whole = Extent::around(extents)?;
    if extents.len() > 1 {
        whole.lattice.limited()?;
    }
    Ok(whole)
}

/// The arrays of a file, decoded one after the other.
struct Arrays<'a> {
    document: &'a Document<'a>,
    /// The number of bytes of the binary arrays so far, stored and decoded.
    size: u64,
}

impl Arrays<'_> {
    /// The pieces of an image, put together by their places.
    fn image(&mut self) -> Result<Piece> {
        let tags = &self.document.pieces;
        let extents: Vec<Extent> = tags.iter().filter_map(|tag| tag.extent).collect();
        let whole = whole(&extents)?;
        let of_cells = self.whole_labels(&whole, &extents, Section::CellData)?;
        // Labels of points count only if those of cells do not.
        let of_points = match of_cells.is_empty() {
            true => self.whole_labels(&whole, &extents, Section::PointData)?,
            false => Vec::new(),
        };
        let active = tags.iter().find_map(|tag| tag.active[usize::from(!of_cells.is_empty())].as_deref());
        whole.image(&self.document.regular).piece(of_cells, of_points, active)
    }

    /// The arrays of labels of all pieces. Pieces share points, and no cells.
    fn whole_labels(&mut self, whole: &Extent, extents: &[Extent], section: Section) -> Result<Vec<Labels>> {
        let is_of_cells = section == Section::CellData;
        let tags = &self.document.pieces;
        let mut all: Vec<Labels> = Vec::new();
        for (n, (tag, piece)) in tags.iter().zip(extents).enumerate() {
            let found = self.all_labels(tag, section, if is_of_cells { tag.cells } else { tag.points })?;
            if extents.len() == 1 {
                return Ok(found);
            }
            Part { whole, piece, is_first: n == 0 }.put_labels(&mut all, found, is_of_cells)?;
        }
        Ok(all)
    }

    /// The pieces of a structured or rectilinear grid, put together by their places.
    fn lattice(&mut self) -> Result<Piece> {
        let tags = &self.document.pieces;
        if let [tag] = &tags[..] {
            return self.piece(tag);
        }
        let extents: Vec<Extent> = tags.iter().filter_map(|tag| tag.extent).collect();
        let whole = whole(&extents)?;
        joined(&whole, &extents, tags.iter().map(|tag| self.piece(tag)).collect::<Result<_>>()?)
    }

    fn piece(&mut self, tag: &PieceTag) -> Result<Piece> {
        let mut piece = match (self.document.kind, tag.extent) {
            (GridKind::Rectilinear, Some(extent)) => {
                let lattice = extent.lattice.limited()?;
                let axes = self.coordinates(tag, lattice.0)?;
                lattice.piece(|_| true, false, |at| std::array::from_fn(|k| axes[k][at[k]]))?
            }
            (_, Some(extent)) => {
                let points = self.points(tag)?;
                Piece { points, ..extent.lattice.piece(|_| true, false, |_| [0.0; 3])? }
            }
            _ => Piece { points: self.points(tag)?, ..Piece::default() },
        };
        if self.document.kind == GridKind::Unstructured {
            piece.types = self.whole_numbers(tag, (Section::Cells, "types"), tag.cells, "a cell type")?;
            let section = Section::Cells;
            Cells { ends: piece.ends, connectivity: piece.connectivity } = self.cells(tag, section, tag.cells)?;
        }
        for array in &tag.arrays {
            // The mesh needs none of them.
            match self.add_data(array, tag, &mut piece) {
                Ok(()) => {}
                Err(error) if error.kind() == ErrorKind::Limit || piece.remarks.len() >= MOST_DAMAGED => {
                    return Err(error);
                }
                Err(error) => piece.remarks.push(format!("an array is left out, for it is damaged: {error}")),
            }
        }
        if self.document.kind == GridKind::Polygonal {
            let mut kinds: [Cells; 4] = Default::default();
            for (kind, cells) in kinds.iter_mut().enumerate() {
                *cells = self.cells(tag, Section::Polygons(kind), tag.polygons[kind])?;
            }
            polydata::fill(&mut piece, kinds)?;
        }
        Ok(piece)
    }

    /// Adds an array of points or cells.
    fn add_data(&mut self, array: &ArrayTag, tag: &PieceTag, piece: &mut Piece) -> Result<()> {
        match array.section {
            Section::Points | Section::Cells | Section::Coordinates | Section::Polygons(_) => {}
            Section::PointData => piece.point_arrays.push(self.data_array(array, tag.points)?),
            Section::CellData if array.scalar.is_real() => piece.cell_arrays.push(self.data_array(array, tag.cells)?),
            Section::CellData => {
                let labels = self.labels(array, tag.cells)?;
                piece.cell_arrays.extend(labels.as_ref().map(Labels::as_array));
                piece.labels.extend(labels);
            }
        }
        Ok(())
    }

    fn points(&mut self, tag: &PieceTag) -> Result<Vec<[f64; 3]>> {
        let Some(array) = needed(tag, Section::Points, None, tag.points)? else { return Ok(Vec::new()) };
        // The count is what a file claims. A product beyond all numbers is more than any file has, and is refused as
        // such.
        let count = tag.points.saturating_mul(3);
        let coordinates = self.values(array, count, |reader| array.scalar.reals(reader, count))?;
        Ok(coordinates.as_chunks().0.to_vec())
    }

    /// The nodes of the cells of a section.
    fn cells(&mut self, tag: &PieceTag, section: Section, count: u64) -> Result<Cells> {
        let ends: Vec<u64> = self.whole_numbers(tag, (section, "offsets"), count, "an offset from 0")?;
        let nodes = ends.last().copied().unwrap_or(0);
        let connectivity = self.whole_numbers(tag, (section, "connectivity"), nodes, "an index from 0")?;
        Ok(Cells { ends, connectivity })
    }

    /// The coordinates along each axis, in the order of the arrays.
    fn coordinates(&mut self, tag: &PieceTag, counts: [usize; 3]) -> Result<[Vec<f64>; 3]> {
        let arrays: Vec<&ArrayTag> = tag.arrays.iter().filter(|a| a.section == Section::Coordinates).collect();
        let Ok(arrays) = <[&ArrayTag; 3]>::try_from(arrays) else {
            let found = tag.arrays.iter().filter(|array| array.section == Section::Coordinates).count();
            return Err(Error::expected("Coordinates", "an array for each of three axes", found));
        };
        let mut axes: [Vec<f64>; 3] = Default::default();
        for (k, array) in arrays.into_iter().enumerate() {
            let count = counts[k] as u64;
            axes[k] = self.values(array, count, |reader| array.scalar.reals(reader, count))?;
        }
        Ok(axes)
    }

    /// The arrays with one whole number for each place of the section.
    fn all_labels(&mut self, tag: &PieceTag, section: Section, places: u64) -> Result<Vec<Labels>> {
        let arrays = tag.arrays.iter().filter(|array| array.section == section && !array.scalar.is_real());
        let mut all = Vec::new();
        for array in arrays {
            all.extend(self.labels(array, places)?);
        }
        Ok(all)
    }

    /// The array of the cells with this name.
    fn whole_numbers<T: TryFrom<i128>>(
        &mut self,
        tag: &PieceTag,
        (section, name): (Section, &str),
        count: u64,
        expected: &str,
    ) -> Result<Vec<T>> {
        let Some(array) = needed(tag, section, Some(name), count)? else { return Ok(Vec::new()) };
        let values = self.values(array, count, |reader| array.scalar.whole_numbers(reader, count, expected))?;
        values.ok_or_else(|| {
            let found = format!("{:?}", array.scalar);
            Error::expected(array.key(), "a type of whole numbers", found).on_line(self.document.line(array))
        })
    }

    fn data_array(&mut self, array: &ArrayTag, places: u64) -> Result<DataArray> {
        let count = places.saturating_mul(array.components);
        let is_kept = array.scalar.is_real() && DataArray::is_kept(array.components);
        let values = match array.scalar.size() {
            None => None,
            Some(_) => self.values(array, count, |reader| match is_kept {
                true => array.scalar.reals(reader, count).map(Some),
                false => array.scalar.skip(reader, count).map(|()| None),
            })?,
        };
        Ok(DataArray { name: array.name.clone(), components: array.components, values })
    }

    /// The numbers of the cells, if there is one for each.
    fn labels(&mut self, array: &ArrayTag, cells: u64) -> Result<Option<Labels>> {
        if array.scalar.size().is_none() {
            return Ok(None);
        }
        let count = cells.saturating_mul(array.components);
        let values = self.values(array, count, |reader| match array.components {
            1 => array.scalar.whole_numbers(reader, count, "a whole number"),
            _ => array.scalar.skip(reader, count).map(|()| None),
        })?;
        Ok(values.map(|values| Labels { name: array.name.clone(), values }))
    }

    /// Reads an array of exactly `count` numbers.
    fn values<T>(&mut self, array: &ArrayTag, count: u64, read: impl FnOnce(&mut Reader) -> Result<T>) -> Result<T> {
        let document = self.document;
        let placed = |error: Error| {
            let error = if error.key().is_some() { error } else { error.under(array.key()) };
            error.on_line(document.line(array))
        };
        let decoded;
        let mut reader = match document.content(array).map_err(placed)? {
            Content::Text(bytes, start) => {
                let words = bytes[start..].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count();
                if words as u64 != count {
                    return Err(placed(Error::new(format!("expected {count} numbers, found {words}"))));
                }
                Reader::starting_at(bytes, start)
            }
            Content::Binary { stored, alone } => {
                decoded = self.decoded(array, count, stored, alone).map_err(placed)?;
                let mut reader = Reader::new(&decoded);
                reader.encoding = Encoding::Binary { big_endian: document.storage.big_endian };
                reader
            }
        };
        reader.enter(array.key());
        read(&mut reader).map_err(placed)
    }

    /// The bytes of a binary array.
    fn decoded<'s>(&mut self, array: &ArrayTag, count: u64, stored: Stored<'s>, alone: bool) -> Result<Cow<'s, [u8]>> {
        // An array without numbers may have no header either.
        if alone && stored.bytes.is_empty() && count == 0 {
            return Ok(Cow::Borrowed(&[]));
        }
        let data = self.document.storage.open(stored)?;
        // Only an element of its own shows where its array ends; in appended data the next one follows.
        if alone && data.stored_size != stored.bytes.len() {
            let expected = format!("{} characters of base64", data.stored_size);
            return Err(Error::new(format!("expected {expected}, found {}", stored.bytes.len())));
        }
        // Several arrays may point at the same stored bytes, so that all together are limited, before memory is taken.
        let most = ALWAYS_ALLOWED.saturating_add(MOST_GROWTH.saturating_mul(self.document.size() as u64));
        self.size = self.size.saturating_add(data.size as u64).saturating_add(data.stored_size as u64);
        if self.size > most {
            let length = self.document.size();
            let expected =
                format!("at most {most} bytes of data, stored and decoded, up to here in a file of {length}");
            return Err(Error::new(format!("expected {expected}, found {}", self.size)).of_kind(ErrorKind::Limit));
        }
        let Some(each) = array.scalar.size() else { return Err(Error::new("expected numbers, found bits or texts")) };
        if data.size as u64 != count.saturating_mul(each) {
            let expected = format!("{count} numbers of {each} bytes");
            return Err(Error::new(format!("expected {expected}, found {} bytes", data.size)));
        }
        data.decode()
    }
}

/// The first array of a section, or that with this name. It may be missing if it has no numbers.
fn needed<'a>(tag: &'a PieceTag, section: Section, name: Option<&str>, count: u64) -> Result<Option<&'a ArrayTag>> {
    let is_meant = |array: &&ArrayTag| array.section == section && name.is_none_or(|name| array.name == name);
    let found = tag.arrays.iter().find(is_meant);
    if found.is_none() && count > 0 {
        let expected = name.map_or("an array".to_string(), |name| format!("an array \"{name}\""));
        let key = match section {
            Section::Polygons(kind) => KINDS[kind].0.to_string(),
            other => format!("{other:?}"),
        };
        return Err(Error::expected(key, expected, "none"));
    }
    Ok(found)
}
