//! What bulk data include.

use crate::mesh::include::Inclusion;

/// The largest number of lines on which the name of a file stands.
// Eight lines of 72 columns hold any usual path; a quote that is never closed would else take the whole deck for a name.
const MOST_LINES: usize = 8;

/// `INCLUDE 'file'` stands for the lines of the file; a long name goes on until its quote ends.
pub(in crate::mesh) fn inclusion(lines: &[&[u8]]) -> Option<Inclusion> {
    let first = lines.first()?;
    let word = first.get(..7).filter(|word| word.eq_ignore_ascii_case(b"INCLUDE"))?;
    let after = first.get(word.len()..)?;
    if !after.first().is_some_and(|b| b.is_ascii_whitespace() || matches!(b, b'\'' | b'"' | b'=' | b',')) {
        return None;
    }
    let mut name = String::from_utf8_lossy(after).trim().trim_start_matches(['=', ',']).trim().to_string();
    let quote = name.chars().next().filter(|first| matches!(first, '\'' | '"'));
    let mut count = 1;
    if let Some(quote) = quote {
        name.remove(0);
        while !name.contains(quote) && count < lines.len().min(MOST_LINES) {
            name += String::from_utf8_lossy(lines[count]).trim();
            count += 1;
        }
        name.truncate(name.find(quote).unwrap_or(name.len()));
    } else {
        name.truncate(name.find('$').unwrap_or(name.len()));
    }
    Some(Inclusion::Instead(name.trim().to_string(), count))
}
