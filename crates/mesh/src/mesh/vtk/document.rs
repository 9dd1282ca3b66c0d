//! The structure of an XML file: its pieces, their arrays and where these are stored.

use super::compression::Compression;
use super::grid_kind::{Extent, GridKind, Regular, polygon_counts};
use super::polydata::KINDS;
use super::scalar_type::ScalarType;
use super::storage::{Storage, Stored};
use super::xml_tag::{Tag, next_tag, number, quoted, shown_value, text_after};
use crate::error::{Error, Result};
use std::ops::Range;

/// The deepest nesting of tags; a grid has six.
const DEEPEST_TAGS: usize = 32;
/// The largest number of pieces, because a piece takes up more memory than its tag does.
const MOST_PIECES: usize = 4096;
/// The end tag of the appended data.
const APPENDED_END: &[u8] = b"</AppendedData";

/// A file whose tags have been read.
pub(super) struct Document<'a> {
    bytes: &'a [u8],
    pub kind: GridKind,
    /// Where the points of an image are.
    pub regular: Regular,
    pub storage: Storage,
    pub pieces: Vec<PieceTag>,
    appended: Option<Stored<'a>>,
}

pub(super) struct PieceTag {
    pub points: u64,
    pub cells: u64,
    /// The points of a lattice.
    pub extent: Option<Extent>,
    /// How many vertices, lines, polygons and strips there are.
    pub polygons: [u64; 4],
    /// The array of the points and of the cells that is marked as the one that counts.
    pub active: [Option<String>; 2],
    pub arrays: Vec<ArrayTag>,
}

/// The part of a piece to which an array belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Points,
    Cells,
    PointData,
    CellData,
    Coordinates,
    /// Vertices, lines, polygons or strips.
    Polygons(usize),
}

pub(super) struct ArrayTag {
    pub section: Section,
    pub name: String,
    pub scalar: ScalarType,
    pub components: u64,
    place: Place,
    /// The position of its tag in the file.
    start: usize,
}

enum Place {
    Text(Range<usize>),
    Base64(Range<usize>),
    /// The number of bytes after the first one of the appended data.
    Appended(usize),
}

/// The values of an array in the file.
pub(super) enum Content<'a> {
    /// The file up to the end of the text, and where the text begins.
    Text(&'a [u8], usize),
    /// `alone` if the bytes belong to this array only.
    Binary { stored: Stored<'a>, alone: bool },
}

impl ArrayTag {
    /// The key of the array in errors.
    pub fn key(&self) -> String {
        self.section.key(&self.name)
    }
}

impl<'a> Document<'a> {
    /// Reads all tags.
    ///
    /// # Errors
    /// The file is of another kind, cut short, stored in a way that is not supported, or its tags do not match.
    pub fn read(bytes: &'a [u8]) -> Result<Document<'a>> {
        let mut document = Document {
            bytes,
            kind: GridKind::default(),
            regular: Regular::default(),
            storage: Storage::default(),
            pieces: Vec::new(),
            appended: None,
        };
        let mut open: Vec<&[u8]> = Vec::new();
        let mut at = 0;
        loop {
            let Some(tag) = next_tag(bytes, at) else {
                return Err(match open.last() {
                    Some(name) => {
                        let name = shown(name);
                        Error::expected(&name, format!("</{name}>"), "the end of the file").on_line(line_of(bytes, at))
                    }
                    None => Error::expected("VTKFile", "<VTKFile>", "none"),
                });
            };
            at = tag.end;
            let placed = |error: Error| error.on_line(line_of(bytes, tag.start));
            if let Some(name) = tag.name.strip_prefix(b"/") {
                let expected = open.pop().map_or("<VTKFile>".to_string(), |name| format!("</{}>", shown(name)));
                let found = format!("</{}>", shown(name));
                if expected != found {
                    return Err(placed(Error::expected(shown(name), expected, found)));
                }
                document.continue_text(&open, at);
            } else {
                at = document.add(&open, &tag).map_err(placed)?;
                if !tag.empty {
                    open.push(tag.name);
                }
                if open.len() > DEEPEST_TAGS {
                    let expected = format!("at most {DEEPEST_TAGS} tags inside one another");
                    return Err(placed(Error::expected(shown(tag.name), expected, open.len())));
                }
            }
            if open.is_empty() {
                return Ok(document);
            }
        }
    }

    /// Adds the content of a start tag, and returns where the search for the next tag begins.
    fn add(&mut self, open: &[&[u8]], tag: &Tag) -> Result<usize> {
        match (open, tag.name) {
            ([], b"VTKFile") => self.root(tag)?,
            ([], other) => return Err(Error::expected("VTKFile", "<VTKFile>", format!("<{}>", shown(other)))),
            ([b"VTKFile"], b"AppendedData") => return self.appended_data(tag),
            ([b"VTKFile"], name) if name == self.kind.name().as_bytes() => self.regular = Regular::read(tag)?,
            ([b"VTKFile", grid], b"Piece") if *grid == self.kind.name().as_bytes() => {
                if self.pieces.len() == MOST_PIECES {
                    return Err(Error::expected("Piece", format!("at most {MOST_PIECES} pieces"), "more"));
                }
                self.pieces.push(self.piece(tag)?);
            }
            ([path @ .., section], b"DataArray") if self.is_piece(path) => {
                if let (Some(section), Some(piece)) = (Section::called(section), self.pieces.last_mut()) {
                    piece.arrays.push(array(section, tag, self.bytes)?);
                }
            }
            (path, name) if self.is_piece(path) => {
                if let Some(piece) = self.pieces.last_mut() {
                    match Section::called(name) {
                        Some(Section::PointData) => piece.active[0] = tag.attribute("Scalars"),
                        Some(Section::CellData) => piece.active[1] = tag.attribute("Scalars"),
                        _ => {}
                    }
                }
            }
            // Field data, and what other programs may add.
            _ => {}
        }
        Ok(tag.end)
    }

    /// Whether the open tags are those of a piece.
    fn is_piece(&self, open: &[&[u8]]) -> bool {
        matches!(open, [b"VTKFile", grid, b"Piece"] if *grid == self.kind.name().as_bytes())
    }

    fn piece(&self, tag: &Tag) -> Result<PieceTag> {
        let count = |name| number(tag, name).map_err(|error| error.under("Piece"));
        let extent = if self.kind.is_lattice() { Some(Extent::read(tag)?) } else { None };
        let polygons = polygon_counts(tag).map_err(|error| error.under("Piece"))?;
        let (points, cells) = match (self.kind, extent) {
            (_, Some(Extent { lattice, .. })) => (lattice.point_count() as u64, lattice.cell_count() as u64),
            (GridKind::Polygonal, _) => {
                (count("NumberOfPoints")?, polygons.iter().fold(0, |all: u64, count| all.saturating_add(*count)))
            }
            _ => (count("NumberOfPoints")?, count("NumberOfCells")?),
        };
        Ok(PieceTag { points, cells, extent, polygons, active: [None, None], arrays: Vec::new() })
    }

    fn root(&mut self, tag: &Tag) -> Result<()> {
        let one_of = |name: &str, known: [&str; 2]| match tag.attribute(name) {
            None => Ok(false),
            Some(value) if value == known[0] => Ok(false),
            Some(value) if value == known[1] => Ok(true),
            Some(other) => Err(Error::expected(format!("VTKFile.{name}"), known.join(" or "), quoted(&other))),
        };
        self.kind = GridKind::called(tag.attribute("type"))?;
        let compression = match tag.attribute("compressor") {
            None => None,
            Some(name) => Some(Compression::called(&name).ok_or_else(|| {
                let expected = "vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or none";
                Error::expected("VTKFile.compressor", expected, quoted(&name))
            })?),
        };
        let wide = one_of("header_type", ["UInt32", "UInt64"])?;
        self.storage = Storage { compression, wide, big_endian: one_of("byte_order", ["LittleEndian", "BigEndian"])? };
        Ok(())
    }

    /// The data begin after an underscore. Raw data may look like tags; they end at the last end tag.
    fn appended_data(&mut self, tag: &Tag) -> Result<usize> {
        let encoding = tag.attribute("encoding");
        let in_base64 = match encoding.as_deref() {
            Some("base64") => true,
            Some("raw") => false,
            _ => return Err(Error::expected("AppendedData.encoding", "base64 or raw", shown_value(encoding))),
        };
        let end = if in_base64 || tag.empty {
            text_after(self.bytes, tag.end).end
        } else {
            // Raw bytes may spell the end tag by chance: the last one closes the data.
            let end = self.bytes[tag.end..].windows(APPENDED_END.len()).rposition(|window| window == APPENDED_END);
            tag.end
                + end.ok_or_else(|| {
                    Error::expected("AppendedData", "</AppendedData> after the data", "the end of the file")
                })?
        };
        // The format marks the first byte of the data with an underscore.
        let data = self.bytes[tag.end..end].trim_ascii_start().strip_prefix(b"_");
        self.appended = data.map(|bytes| Stored { bytes, in_base64 });
        Ok(end)
    }

    /// An element inside an array may precede its text, which then follows the end tag of that element.
    fn continue_text(&mut self, open: &[&[u8]], at: usize) {
        let [path @ .., section, b"DataArray"] = open else { return };
        if !self.is_piece(path) || Section::called(section).is_none() {
            return;
        }
        let array = self.pieces.last_mut().and_then(|piece| piece.arrays.last_mut());
        if let Some(Place::Text(text) | Place::Base64(text)) = array.map(|array| &mut array.place)
            && self.bytes[text.clone()].trim_ascii().is_empty()
        {
            *text = text_after(self.bytes, at);
        }
    }

    /// The stored values of an array.
    ///
    /// # Errors
    /// They are not in the file.
    pub fn content(&self, array: &ArrayTag) -> Result<Content<'a>> {
        let in_base64 = true;
        match &array.place {
            Place::Text(text) => Ok(Content::Text(&self.bytes[..text.end], text.start)),
            Place::Base64(text) => {
                let stored = Stored { bytes: self.bytes[text.clone()].trim_ascii(), in_base64 };
                Ok(Content::Binary { stored, alone: true })
            }
            Place::Appended(offset) => {
                let Some(appended) = self.appended else {
                    return Err(Error::new("expected <AppendedData> with an underscore before the data, found none"));
                };
                let Some(bytes) = appended.bytes.get(*offset..) else {
                    let expected = format!("an offset of at most {}", appended.bytes.len());
                    return Err(Error::new(format!("expected {expected}, found {offset}")));
                };
                Ok(Content::Binary { stored: Stored { bytes, ..appended }, alone: false })
            }
        }
    }

    /// The number of bytes of the file.
    pub fn size(&self) -> usize {
        self.bytes.len()
    }

    /// The line of the array's tag, from 1.
    pub fn line(&self, array: &ArrayTag) -> usize {
        line_of(self.bytes, array.start)
    }
}

impl Section {
    fn called(name: &[u8]) -> Option<Section> {
        match name {
            b"Points" => Some(Section::Points),
            b"Cells" => Some(Section::Cells),
            b"PointData" => Some(Section::PointData),
            b"CellData" => Some(Section::CellData),
            b"Coordinates" => Some(Section::Coordinates),
            _ => KINDS.iter().position(|(kind, _)| kind.as_bytes() == name).map(Section::Polygons),
        }
    }

    /// The key in errors of its array of this name.
    fn key(self, name: &str) -> String {
        match self {
            Section::Points => "Points".to_string(),
            Section::Polygons(kind) => format!("{}.{name}", KINDS[kind].0),
            Section::Cells | Section::PointData | Section::CellData | Section::Coordinates => {
                format!("{self:?}.{name}")
            }
        }
    }
}

fn array(section: Section, tag: &Tag, bytes: &[u8]) -> Result<ArrayTag> {
    let name = tag.attribute("Name").unwrap_or_default();
    let scalar = tag.attribute("type");
    let scalar = ScalarType::named(scalar.as_deref().unwrap_or_default()).map_err(|_| {
        Error::expected("type", "one of Int8 to Int64, UInt8 to UInt64, Float32, Float64", shown_value(scalar))
    });
    let components = match tag.attribute("NumberOfComponents") {
        Some(_) => number(tag, "NumberOfComponents"),
        None => Ok(1),
    };
    let text = if tag.empty { tag.end..tag.end } else { text_after(bytes, tag.end) };
    let format = tag.attribute("format");
    let place = match format.as_deref().unwrap_or_default().to_ascii_lowercase().as_str() {
        "ascii" => Ok(Place::Text(text)),
        "binary" => Ok(Place::Base64(text)),
        "appended" => {
            number(tag, "offset").map(|offset| Place::Appended(usize::try_from(offset).unwrap_or(usize::MAX)))
        }
        _ => Err(Error::expected("format", "ascii, binary or appended", shown_value(format))),
    };
    let placed = |error: Error| error.under(section.key(&name));
    let (scalar, components) = (scalar.map_err(placed)?, components.map_err(placed)?);
    if section == Section::Points && components != 3 {
        return Err(Error::expected("Points", "3 components", components));
    }
    let place = place.map_err(placed)?;
    Ok(ArrayTag { section, name, scalar, components, place, start: tag.start })
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    1 + bytes[..at].iter().filter(|&&b| b == b'\n').count()
}

/// The start of a name, on one line.
fn shown(name: &[u8]) -> String {
    String::from_utf8_lossy(&name[..name.len().min(40)]).into_owned()
}
