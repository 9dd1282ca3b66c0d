//! Wavefront OBJ: points, polygons and lines.

use super::faces::{Faces, TRIANGULATE};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::lines::{Lines, before_comment, words};
use crate::mesh::reader::quoted;
use crate::mesh::source::MeshSource;

/// Reads an OBJ file. Objects and groups (`o`, `g`) are groups; normals, texture coordinates, materials and free-form
/// curves are passed over.
///
/// # Errors
/// A face of more than four corners is not flat, a face names a point that is not there, or the file has no points.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut faces = Faces::new();
    let (mut object, mut groups) = (None, Vec::new());
    let mut joined: Vec<u8> = Vec::new();
    let mut nodes = Vec::new();
    while let Some(line) = lines.next() {
        // A line that ends in a backslash goes on.
        if let Some(start) = line.trim_ascii_end().strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
            continue;
        }
        let whole;
        let line = match joined.is_empty() {
            true => line,
            false => {
                joined.extend_from_slice(line);
                whole = std::mem::take(&mut joined);
                &whole[..]
            }
        };
        let line = before_comment(line);
        let mut words = words(line);
        match words.next() {
            Some(b"v") => {
                let mut point = [0.0; 3];
                for x in &mut point {
                    *x = lines.real(words.next().unwrap_or_default(), "a coordinate")?;
                }
                points.push(point);
            }
            Some(keyword @ (b"f" | b"l")) => {
                nodes.clear();
                for word in words {
                    nodes.push(place(&lines, word, points.len())?);
                }
                if keyword == b"l" {
                    if nodes.len() < 2 {
                        return Err(lines.expected("a line of two points or more", &nodes.len().to_string()));
                    }
                    nodes.windows(2).for_each(|ends| {
                        faces.push(ends, &points);
                    });
                } else if nodes.len() < 3 || !faces.push(&nodes, &points) {
                    let found = format!("{} corners", nodes.len());
                    return Err(lines.expected(TRIANGULATE, &found).of_kind(ErrorKind::Unsupported));
                }
            }
            Some(b"o") => {
                let name = line.trim_ascii().get(1..).unwrap_or_default().trim_ascii();
                object = (!name.is_empty()).then(|| String::from_utf8_lossy(name).into_owned());
                groups.clear();
                faces.enter(named(&object, &groups));
            }
            Some(b"g") => {
                groups = words
                    .filter(|name| *name != b"default")
                    .map(|name| String::from_utf8_lossy(name).into_owned())
                    .collect();
                faces.enter(named(&object, &groups));
            }
            _ => {}
        }
    }
    if points.is_empty() {
        return Err(
            Error::new("the file ends before a point: expected lines such as \"v 0 0 1\"").of_kind(ErrorKind::Syntax)
        );
    }
    Ok(faces.into_source(points, 1))
}

fn named(object: &Option<String>, groups: &[String]) -> Vec<String> {
    let mut names: Vec<String> = object.iter().chain(groups).cloned().collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The index of the point in a corner such as `3`, `3/1/2` or, from the last point on, `-1`.
fn place(lines: &Lines, word: &[u8], count: usize) -> Result<usize> {
    let number = word.split(|&b| b == b'/').next().unwrap_or_default();
    let number: Option<i64> = std::str::from_utf8(number).ok().and_then(|number| number.parse().ok());
    let place = match number {
        Some(number) if number > 0 => usize::try_from(number - 1).ok(),
        // A number below zero counts back from the last point that was read.
        Some(number) if number < 0 => {
            usize::try_from(number.unsigned_abs()).ok().and_then(|back| count.checked_sub(back))
        }
        _ => None,
    };
    let expected = || lines.expected(&format!("the number of one of {count} points before it"), &quoted(word));
    place.filter(|&place| place < count).ok_or_else(expected)
}
