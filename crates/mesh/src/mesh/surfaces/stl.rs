//! STL, text and binary.

use super::faces::Faces;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::coincident::Coincident;
use crate::mesh::lines::{Lines, words};
use crate::mesh::reader::quoted;
use crate::mesh::source::MeshSource;

/// Bytes before the facets of a binary file, and of each facet.
const HEADER: usize = 84;
// The header has 80 bytes of any text and a count of four bytes. A facet has twelve numbers of four bytes and two bytes
// of attributes.
const FACET: usize = 50;

/// Reads an STL file. Corners at exactly the same coordinates are one point; each named solid is a group.
///
/// # Errors
/// The file is damaged or cut short.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    // The length is worked out with checks: a count of text that is read as a number may be anything.
    let is_of =
        |count: u32| (count as usize).checked_mul(FACET).and_then(|n| n.checked_add(HEADER)) == Some(bytes.len());
    // Binary files may begin with the word "solid" as well; their length tells.
    match count {
        Some(count) if is_of(count) => Ok(binary(&bytes[HEADER..])),
        _ if bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) => text(bytes),
        None => Err(Error::new("the file ends inside its header").of_kind(ErrorKind::Syntax)),
        Some(count) => {
            let found = (bytes.len() - HEADER) / FACET;
            let rest = (bytes.len() - HEADER) % FACET;
            let expected = format!("the word \"solid\", or {count} facets of 50 bytes after the header");
            let found = format!("{found} facets and {rest} bytes");
            Err(Error::expected("header", expected, found).of_kind(ErrorKind::Syntax))
        }
    }
}

fn binary(facets: &[u8]) -> MeshSource {
    let mut points = Coincident::default();
    let mut faces = Faces::new();
    for facet in facets.chunks_exact(FACET) {
        // A normal, three corners, and two bytes without a meaning.
        let corner = |c: usize| {
            points.index(std::array::from_fn(|k| {
                let at = 12 + 12 * c + 4 * k;
                f64::from(f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
            }))
        };
        let corners = [0, 1, 2].map(corner);
        faces.push(&corners, &[]);
    }
    faces.into_source(points.points, 0)
}

/// Where the reader is in a text.
enum Place {
    Outside,
    Solid,
    Facet,
    Loop,
}

fn text(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut points = Coincident::default();
    let mut faces = Faces::new();
    let mut place = Place::Outside;
    let mut corners: Vec<usize> = Vec::new();
    while let Some(line) = lines.next() {
        let mut words = words(line);
        let Some(word) = words.next() else { continue };
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
        let expected = match &place {
            Place::Outside if is("solid") => {
                let name = line.trim_ascii().get(5..).unwrap_or_default();
                let name = String::from_utf8_lossy(name.trim_ascii()).into_owned();
                lines.enter("solid");
                faces.enter(if name.is_empty() { Vec::new() } else { vec![name] });
                place = Place::Solid;
                continue;
            }
            Place::Solid if is("facet") => {
                place = Place::Facet;
                corners.clear();
                continue;
            }
            Place::Solid if is("endsolid") || is("end") => {
                place = Place::Outside;
                continue;
            }
            Place::Facet if is("outer") => {
                place = Place::Loop;
                continue;
            }
            Place::Facet if is("endfacet") && corners.len() == 3 => {
                faces.push(&corners, &[]);
                place = Place::Solid;
                continue;
            }
            Place::Loop if is("vertex") => {
                let mut point = [0.0; 3];
                for x in &mut point {
                    *x = lines.real(words.next().unwrap_or_default(), "a coordinate")?;
                }
                if corners.len() == 3 {
                    return Err(lines.expected("three corners of a facet", "a fourth"));
                }
                corners.push(points.index(point));
                continue;
            }
            Place::Loop if is("endloop") && corners.len() == 3 => {
                place = Place::Facet;
                continue;
            }
            Place::Outside => "\"solid\"",
            Place::Solid => "\"facet\" or \"endsolid\"",
            Place::Facet => "\"outer loop\" or, after three corners, \"endfacet\"",
            Place::Loop => "\"vertex\" or, after three of them, \"endloop\"",
        };
        return Err(lines.expected(expected, &quoted(word)));
    }
    if !matches!(place, Place::Outside) {
        return Err(lines.ends());
    }
    Ok(faces.into_source(points.points, 0))
}
