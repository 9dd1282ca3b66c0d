//! Legacy `.vtk` files, versions 1 to 5.

use super::legacy_cells;
use super::legacy_dataset::Dataset;
use super::piece::{self, DataArray, Labels, Piece};
use super::scalar_type::ScalarType;
use crate::error::{Error, Result};
use crate::mesh::reader::{Encoding, Reader, quoted};
use crate::mesh::source::MeshSource;

/// To what the arrays that follow belong.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    File,
    Points(u64),
    Cells(u64),
}

/// Reads the grid of a `.vtk`, text or binary. Cells form blocks as in [`parse_xml`](super::parse_xml).
///
/// # Errors
/// The file is of another kind, damaged or cut short, or has cells without a fixed shape such as polygons.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    piece::mesh(vec![piece(bytes)?])
}

/// The grid as it is in the file: cells are not checked, and points may not be finite.
///
/// # Errors
/// The file is of another kind, damaged or cut short. The format has no end mark: a file that is cut just before a
/// section of cell or point data is read as a file without that data.
pub(in crate::mesh) fn piece(bytes: &[u8]) -> Result<Piece> {
    let mut reader = Reader::new(bytes);
    header(&mut reader)?;
    let mut file =
        File { reader, piece: Piece::default(), dataset: Dataset::default(), seen: Vec::new(), place: Place::File };
    let mut ends_in_metadata = false;
    while !file.reader.peek().is_empty() {
        ends_in_metadata = file.reader.next_is("METADATA");
        if let Err(error) = file.read_section() {
            // The mesh is complete before the arrays of its cells and points.
            if file.place == Place::File || file.missing().is_some() || file.dataset.is_image() {
                return Err(error);
            }
            file.piece
                .remarks
                .push(format!("what follows is left out of the arrays of the file, for it is damaged there: {error}"));
            ends_in_metadata = true;
            break;
        }
    }
    if let Some(section) = file.missing() {
        return Err(Error::new(format!("the file ends before {section}")));
    }
    let has_end = ends_in_metadata || bytes.last().is_some_and(u8::is_ascii_whitespace);
    if file.reader.encoding == Encoding::Text && !has_end {
        file.piece.remarks.push("the file ends without a line end: its last number may be cut short".into());
    }
    file.dataset.finish(file.piece)
}

fn header(reader: &mut Reader) -> Result<()> {
    const MARK: &[u8] = b"# vtk DataFile Version";
    let line = reader.rest_of_line();
    if !line.get(..MARK.len()).is_some_and(|mark| mark.eq_ignore_ascii_case(MARK)) {
        return Err(reader.expected("\"# vtk DataFile Version\" and a number", &quoted(line.trim_ascii())));
    }
    reader.line();
    reader.line();
    let encoding = reader.rest_of_line().trim_ascii();
    reader.encoding = if encoding.eq_ignore_ascii_case(b"ASCII") {
        Encoding::Text
    } else if encoding.eq_ignore_ascii_case(b"BINARY") {
        // Legacy files have big-endian numbers, whatever machine writes them.
        Encoding::Binary { big_endian: true }
    } else {
        return Err(reader.expected("ASCII or BINARY", &quoted(encoding)));
    };
    reader.line();
    Ok(())
}

struct File<'a> {
    reader: Reader<'a>,
    piece: Piece,
    dataset: Dataset,
    seen: Vec<String>,
    place: Place,
}

impl File<'_> {
    /// A section that the mesh needs and that has not been read.
    fn missing(&self) -> Option<&'static str> {
        let mut needed = std::iter::once("DATASET").chain(self.dataset.sections().iter().copied());
        needed.find(|section| !self.seen.iter().any(|seen| seen == section))
    }

    fn read_section(&mut self) -> Result<()> {
        let word = self.reader.peek();
        self.reader.enter("");
        let section = String::from_utf8_lossy(word).to_ascii_uppercase();
        let of_dataset = self.dataset.sections().contains(&section.as_str()) || self.dataset.has(&section);
        if section == "DATASET" || of_dataset {
            if self.seen.contains(&section) {
                return Err(self.reader.fault(format!("{section} stands in the file a second time")));
            }
            self.seen.push(section.clone());
        }
        match section.as_str() {
            "DATASET" => self.after(&section).dataset(),
            "POINTS" if of_dataset => self.after(&section).points(),
            "CELLS" if of_dataset => {
                let cells = legacy_cells::read(&mut self.after(&section).reader)?;
                (self.piece.ends, self.piece.connectivity) = (cells.ends, cells.connectivity);
                Ok(())
            }
            "CELL_TYPES" if of_dataset => self.after(&section).cell_types(),
            _ if of_dataset => {
                self.after(&section);
                self.dataset.read(&section, &mut self.reader)
            }
            "CELL_DATA" => {
                let count = self.after(&section).reader.text_number()?;
                self.place = Place::Cells(count);
                let cells = self.dataset.cell_count(&self.piece);
                if count != cells as u64 {
                    return Err(self.reader.expected(&format!("{cells} cells"), &count.to_string()));
                }
                Ok(())
            }
            "POINT_DATA" => {
                let count = self.after(&section).reader.text_number()?;
                self.place = Place::Points(count);
                let points = self.dataset.point_count(&self.piece);
                if count != points as u64 {
                    return Err(self.reader.expected(&format!("{points} points"), &count.to_string()));
                }
                Ok(())
            }
            "METADATA" => self.after(&section).metadata(),
            "FIELD" => self.after(&section).field(),
            _ if self.place != Place::File => self.attribute(&section),
            _ => Err(self.reader.expected("a section such as POINTS", &quoted(word))),
        }
    }

    /// Skips the keyword of a section.
    fn after(&mut self, section: &str) -> &mut Self {
        self.reader.enter(section);
        self.reader.word();
        self
    }

    fn dataset(&mut self) -> Result<()> {
        let Some(place) = Dataset::NAMES.iter().position(|name| self.reader.next_is(name)) else {
            return Err(self.reader.unexpected(&Dataset::NAMES.join(", ")));
        };
        self.reader.word();
        self.dataset = Dataset::at(place);
        Ok(())
    }

    fn points(&mut self) -> Result<()> {
        let count: u64 = self.reader.text_number()?;
        let scalar = legacy_cells::scalar_type(&mut self.reader)?;
        // A file can claim any count: a product beyond all numbers is more than it has, and is refused as such.
        let coordinates = scalar.reals(&mut self.reader, count.saturating_mul(3))?;
        self.piece.points = coordinates.as_chunks().0.to_vec();
        Ok(())
    }

    fn cell_types(&mut self) -> Result<()> {
        let count: u64 = self.reader.text_number()?;
        self.reader.start_data()?;
        self.reader.announce("cell types", count);
        self.piece.types.reserve(self.reader.capacity::<i32>(count, 1));
        for _ in 0..count {
            let cell_type: u32 = self.reader.number()?;
            let cell_type =
                u8::try_from(cell_type).map_err(|_| self.reader.expected("a cell type", &cell_type.to_string()))?;
            self.piece.types.push(cell_type);
            self.reader.count_one();
        }
        Ok(())
    }

    /// Skips the metadata of an array, which a blank line ends.
    fn metadata(&mut self) -> Result<()> {
        self.reader.line();
        loop {
            let is_last = self.reader.rest().is_empty();
            // METADATA has no count, and ends at an empty line.
            if is_last || self.reader.line().trim_ascii().is_empty() {
                return Ok(());
            }
        }
    }

    /// Reads a list of arrays, each with its own name, size and type.
    fn field(&mut self) -> Result<()> {
        self.word("the name of the field")?;
        for _ in 0..self.reader.text_number::<u64>()? {
            if self.reader.next_is("METADATA") {
                self.after("METADATA").metadata()?;
            }
            let name = self.word("the name of an array")?;
            self.reader.enter(&name);
            let components: u64 = self.reader.text_number()?;
            let tuples: u64 = self.reader.text_number()?;
            self.array(name, components, tuples)?;
        }
        Ok(())
    }

    /// Reads an array of point or cell data that has a keyword of its own.
    fn attribute(&mut self, section: &str) -> Result<()> {
        let tuples = match self.place {
            Place::File => 0,
            Place::Points(count) | Place::Cells(count) => count,
        };
        let components = match section {
            "SCALARS" | "COLOR_SCALARS" | "LOOKUP_TABLE" | "TEXTURE_COORDINATES" => 0,
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => 1,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS6" => 6,
            "TENSORS" => 9,
            _ => return Err(self.reader.unexpected("an array such as SCALARS or FIELD")),
        };
        let name = self.after(section).word("the name of an array")?;
        match section {
            "SCALARS" => self.scalars(name, tuples),
            "TEXTURE_COORDINATES" => {
                let components = self.reader.text_number()?;
                self.array(name, components, tuples)
            }
            "COLOR_SCALARS" | "LOOKUP_TABLE" => {
                let count: u64 = self.reader.text_number()?;
                let colors = if section == "LOOKUP_TABLE" { 4 } else { tuples };
                let in_binary = self.reader.encoding != Encoding::Text;
                let bytes_or_reals = if in_binary { ScalarType::UInt8 } else { ScalarType::Float32 };
                self.reader.start_data()?;
                bytes_or_reals.skip(&mut self.reader, count.saturating_mul(colors))
            }
            _ => self.array(name, components, tuples),
        }
    }

    fn scalars(&mut self, name: String, tuples: u64) -> Result<()> {
        let scalar = ScalarType::read(&mut self.reader)?;
        let components =
            if self.reader.rest_of_line().trim_ascii().is_empty() { 1 } else { self.reader.text_number()? };
        if self.reader.next_is("LOOKUP_TABLE") {
            self.reader.word();
            self.word("the name of a lookup table")?;
        }
        self.values(scalar, name, components, tuples)
    }

    fn array(&mut self, name: String, components: u64, tuples: u64) -> Result<()> {
        let scalar = ScalarType::read(&mut self.reader)?;
        self.values(scalar, name, components, tuples)
    }

    /// Reads the values of an array, and keeps them if they are few per cell or point.
    fn values(&mut self, scalar: ScalarType, name: String, components: u64, tuples: u64) -> Result<()> {
        let count = components.saturating_mul(tuples);
        if scalar == ScalarType::Text {
            self.reader.line();
        } else {
            self.reader.start_data()?;
        }
        match self.place {
            Place::Points(points)
                if points == tuples && components == 1 && !scalar.is_real() && self.dataset.is_image() =>
            {
                if let Some(values) = scalar.whole_numbers(&mut self.reader, count, "a whole number")? {
                    self.dataset.add_point_labels(Labels { name, values });
                }
            }
            Place::Cells(cells) if cells == tuples && components == 1 && !scalar.is_real() => {
                if let Some(values) = scalar.whole_numbers(&mut self.reader, count, "a whole number")? {
                    let labels = Labels { name, values };
                    self.piece.cell_arrays.push(labels.as_array());
                    self.piece.labels.push(labels);
                }
            }
            Place::Points(places) | Place::Cells(places) if places == tuples => {
                let mut values = None;
                if scalar.is_real() && DataArray::is_kept(components) {
                    values = Some(scalar.reals(&mut self.reader, count)?);
                } else {
                    scalar.skip(&mut self.reader, count)?;
                }
                let array = DataArray { name, components, values };
                match self.place {
                    Place::Cells(_) => self.piece.cell_arrays.push(array),
                    Place::Points(_) | Place::File => self.piece.point_arrays.push(array),
                }
            }
            _ => scalar.skip(&mut self.reader, count)?,
        }
        Ok(())
    }

    /// The next word, in which `%20` stands for a space.
    fn word(&mut self, what: &str) -> Result<String> {
        let word = self.reader.peek();
        if word.is_empty() || word.len() == self.reader.rest().len() {
            return Err(self.reader.unexpected(what));
        }
        self.reader.word();
        let mut name = Vec::with_capacity(word.len());
        let mut rest = word;
        while let Some((&byte, after)) = rest.split_first() {
            let code = (byte == b'%').then(|| after.get(..2)).flatten();
            let code = code.and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
            name.push(code.unwrap_or(byte));
            rest = if code.is_some() { &after[2..] } else { after };
        }
        Ok(String::from_utf8_lossy(&name).into_owned())
    }
}
