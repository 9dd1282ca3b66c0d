//! OFF, text.

use super::faces::{Faces, TRIANGULATE};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::lines::Lines;
use crate::mesh::reader::quoted;
use crate::mesh::source::MeshSource;

/// Reads an OFF file; colours, normals and texture coordinates are passed over.
///
/// # Errors
/// The file is binary, has faces of more than four corners that are not flat, or is damaged or cut short.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut lines = Lines::new(bytes);
    let mut first = next(&mut lines, "the word OFF")?;
    let name = first.first().copied().unwrap_or_default();
    let is_known =
        [&b"OFF"[..], b"COFF", b"NOFF", b"CNOFF", b"STOFF", b"STCOFF", b"STNOFF", b"STCNOFF"].contains(&name);
    if !is_known {
        return Err(lines.expected("OFF, COFF, NOFF or STOFF", &quoted(name)));
    }
    if first.get(1).is_some_and(|word| word.eq_ignore_ascii_case(b"BINARY")) {
        return Err(lines.expected("text", "BINARY").of_kind(ErrorKind::Unsupported));
    }
    // The counts may be on the first line.
    first.remove(0);
    let counts = if first.is_empty() { next(&mut lines, "numbers of points and faces")? } else { first };
    let count = |index: usize, what: &str| lines.whole(counts.get(index).copied().unwrap_or_default(), what);
    let (point_count, face_count) = (count(0, "the number of points")?, count(1, "the number of faces")?);
    let mut points = Vec::new();
    let mut faces = Faces::new();
    for i in 0..point_count {
        let words = next(&mut lines, &format!("{point_count} points, found {i}"))?;
        let at = |k: usize| lines.real(words.get(k).copied().unwrap_or_default(), "a coordinate");
        points.push([at(0)?, at(1)?, at(2)?]);
    }
    for i in 0..face_count {
        let mut words = next(&mut lines, &format!("{face_count} faces, found {i}"))?;
        let corners = lines.whole(words.first().copied().unwrap_or_default(), "a number of corners")?;
        // The corners of a face may be on several lines.
        while (words.len() as u64) <= corners {
            words.extend(next(&mut lines, &format!("{corners} corners of a face, found {}", words.len() - 1))?);
        }
        let mut nodes = Vec::new();
        // Colours may follow the corners.
        for k in 1..=corners {
            let word = words.get(k as usize).copied().unwrap_or_default();
            let node = lines.whole(word, "the index of a point")?;
            let known = usize::try_from(node).ok().filter(|&node| node < points.len());
            nodes.push(
                known.ok_or_else(|| lines.expected(&format!("an index below {point_count}"), &node.to_string()))?,
            );
        }
        if !faces.push(&nodes, &points) {
            return Err(lines.expected(TRIANGULATE, &format!("{corners} corners")).of_kind(ErrorKind::Unsupported));
        }
    }
    let mut source = faces.into_source(points, 0);
    lines.beyond("faces").into_iter().for_each(|sentence| source.annotations.remark(sentence));
    Ok(source)
}

fn next<'a>(lines: &mut Lines<'a>, expected: &str) -> Result<Vec<&'a [u8]>> {
    let early = || Error::new(format!("the file ends too early: expected {expected}")).of_kind(ErrorKind::Syntax);
    lines.next_words().ok_or_else(early)
}
