//! What the tags of a `.vtu` say about its arrays, checked before the decoder relies on it.

use super::blocks::{Blocks, Numbers};
use super::xml_tag::{Tag, next_tag, text_after};
use crate::error::{Error, Result};
use std::borrow::Cow;
use std::ops::Range;

/// A grid has six tags inside one another; the decoder calls itself for each.
const DEEPEST_TAGS: usize = 32;
/// The decoder takes some two kilobytes for each, however short its tag.
const MOST_PIECES: usize = 4096;
/// All arrays together may take up so many times the bytes of the file, as an array of one number alone may a thousand
/// times its own, and so many bytes in any case.
const MOST_GROWTH: u64 = 100;
const ALWAYS_ALLOWED: u64 = 1 << 24;

/// Names of the data arrays of a piece.
#[derive(Default)]
pub(super) struct PieceArrays {
    pub of_points: Vec<String>,
    pub of_cells: Vec<String>,
}

/// The file in a form that the decoder reads rightly, and the arrays of its pieces.
///
/// # Errors
/// The file is of another kind, cut short, encoded in a way that is not supported, or has an array whose header does
/// not fit it.
pub(super) fn checked_arrays(bytes: &[u8]) -> Result<(Cow<'_, [u8]>, Vec<PieceArrays>)> {
    let mut file = Tags::default();
    let mut at = 0;
    while let Some(tag) = next_tag(bytes, at) {
        at = tag.end;
        file.add(&tag, bytes)?;
    }
    if !file.closed {
        let problem = if file.opened { "the file ends before </VTKFile>" } else { "expected <VTKFile>, found none" };
        return Err(Error::new(problem));
    }
    let mut fixed = Cow::Borrowed(bytes);
    // the decoder takes field data for a data set
    for range in &file.field_data {
        fixed.to_mut()[range.clone()].fill(b' ');
    }
    let most = ALWAYS_ALLOWED.saturating_add(MOST_GROWTH.saturating_mul(bytes.len() as u64));
    let mut size = 0_u64;
    for array in &file.arrays {
        let text = file.text_of(array, bytes).unwrap_or(0..0);
        if !file.compressed {
            size = size.saturating_add(file.header.size_of(&bytes[text]));
        } else {
            let blocks = Blocks::read(&bytes[text.clone()], file.header);
            let blocks = blocks.ok_or_else(|| Error::at(&array.name, "its compressed data do not fit their header"))?;
            size = size.saturating_add(blocks.size());
            if let Some(header) = blocks.with_last_size() {
                fixed.to_mut()[text.start..text.start + header.len()].copy_from_slice(header.as_bytes());
            }
        }
        if size > most {
            let expected = format!("at most {most} bytes of data up to here in a file of {}", bytes.len());
            return Err(Error::expected(&array.name, expected, size));
        }
    }
    Ok((fixed, file.pieces))
}

struct ArrayTag {
    name: String,
    /// Offset into the appended data, if the data are there.
    offset: Option<usize>,
    text: Range<usize>,
}

#[derive(Default)]
struct Tags {
    /// Of the tags that are open.
    depth: usize,
    opened: bool,
    closed: bool,
    compressed: bool,
    header: Numbers,
    inside: Option<&'static str>,
    pieces: Vec<PieceArrays>,
    arrays: Vec<ArrayTag>,
    appended: Option<Range<usize>>,
    field_data: Vec<Range<usize>>,
}

impl Tags {
    fn add(&mut self, tag: &Tag, bytes: &[u8]) -> Result<()> {
        match tag.name.first() {
            Some(b'/') => self.depth = self.depth.saturating_sub(1),
            _ => self.depth += usize::from(!tag.empty),
        }
        if self.depth > DEEPEST_TAGS {
            let name = String::from_utf8_lossy(tag.name).into_owned();
            return Err(Error::expected(name, format!("at most {DEEPEST_TAGS} tags inside one another"), self.depth));
        }
        match tag.name {
            b"VTKFile" => self.root(tag)?,
            b"/VTKFile" => self.closed = true,
            b"Piece" if self.pieces.len() == MOST_PIECES => {
                return Err(Error::new(format!("expected at most {MOST_PIECES} pieces, found more")));
            }
            b"Piece" => self.pieces.push(PieceArrays::default()),
            b"Points" => self.inside = Some("Points"),
            b"PointData" if !tag.empty => self.inside = Some("PointData"),
            b"CellData" if !tag.empty => self.inside = Some("CellData"),
            b"/Points" | b"/PointData" | b"/CellData" => self.inside = None,
            b"FieldData" => {
                self.field_data.push(tag.start..tag.end);
                self.inside = (!tag.empty).then_some("FieldData");
            }
            b"/FieldData" => {
                if let Some(range) = self.field_data.last_mut() {
                    range.end = tag.end;
                }
                self.inside = None;
            }
            b"DataArray" if self.inside != Some("FieldData") => self.array(tag, bytes)?,
            b"AppendedData" => {
                let encoding = tag.attribute("encoding").unwrap_or_default();
                if encoding != "base64" {
                    let remedy = "save the grid with its appended data encoded, in binary or in ASCII";
                    return Err(Error::expected("AppendedData", "encoding base64", format!("{encoding} ({remedy})")));
                }
                let text = text_after(bytes, tag.end);
                let mark = bytes[text.clone()].iter().position(|&b| b == b'_');
                self.appended = mark.map(|mark| text.start + mark + 1..text.end);
            }
            _ => {}
        }
        Ok(())
    }

    fn root(&mut self, tag: &Tag) -> Result<()> {
        self.opened = true;
        let kind = tag.attribute("type").unwrap_or_default();
        if kind != "UnstructuredGrid" {
            return Err(Error::expected("VTKFile", "type UnstructuredGrid", kind));
        }
        self.compressed = match tag.attribute("compressor") {
            None => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => return Err(Error::expected("VTKFile", "compressor vtkZLibDataCompressor or none", other)),
        };
        let wide = tag.attribute("header_type") == Some("UInt64");
        self.header = Numbers { wide, big_endian: tag.attribute("byte_order") == Some("BigEndian") };
        Ok(())
    }

    fn array(&mut self, tag: &Tag, bytes: &[u8]) -> Result<()> {
        let name = tag.attribute("Name").unwrap_or("DataArray").to_string();
        let components = tag.attribute("NumberOfComponents").unwrap_or("1");
        match (self.inside, self.pieces.last_mut()) {
            (Some("Points"), _) if components != "3" => {
                return Err(Error::expected("Points", "3 components", components));
            }
            (Some("PointData"), Some(piece)) => piece.of_points.push(name.clone()),
            (Some("CellData"), Some(piece)) => piece.of_cells.push(name.clone()),
            _ => {}
        }
        let text = if tag.empty { tag.end..tag.end } else { text_after(bytes, tag.end) };
        let offset = match tag.attribute("format") {
            Some("appended") => Some(tag.attribute("offset").and_then(|o| o.trim().parse().ok()).unwrap_or(usize::MAX)),
            Some("binary") => None,
            _ => return Ok(()),
        };
        self.arrays.push(ArrayTag { name, offset, text });
        Ok(())
    }

    /// Where the encoded data of an array start, and where they end at the latest.
    fn text_of(&self, array: &ArrayTag, bytes: &[u8]) -> Option<Range<usize>> {
        let range = match array.offset {
            None => array.text.clone(),
            Some(offset) => {
                let appended = self.appended.clone()?;
                appended.start.checked_add(offset).filter(|&start| start <= appended.end)?..appended.end
            }
        };
        let blank = bytes[range.clone()].iter().take_while(|b| b.is_ascii_whitespace()).count();
        Some(range.start + blank..range.end)
    }
}
