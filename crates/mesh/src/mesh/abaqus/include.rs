//! What an input file includes.

use crate::mesh::include::Inclusion;

/// The keywords whose data lines may be in another file.
const WITH_DATA: [&str; 4] = ["NODE", "ELEMENT", "NSET", "ELSET"];

/// `*INCLUDE, INPUT=file` stands for the lines of the file; of other keywords with INPUT the data lines are in the file.
pub(in crate::mesh) fn inclusion(lines: &[&[u8]]) -> Option<Inclusion> {
    let first = lines.first()?.trim_ascii();
    if !first.starts_with(b"*") || first.starts_with(b"**") {
        return None;
    }
    // A keyword line goes on while it ends in a comma.
    let goes_on = |line: &&&[u8]| line.trim_ascii().ends_with(b",");
    let count = 1 + lines.iter().take_while(goes_on).count().min(lines.len() - 1);
    let text = String::from_utf8_lossy(&lines[..count].concat()).into_owned();
    let mut parts = text.trim_start_matches('*').split(',');
    let keyword = parts.next()?.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
    let mut pairs = parts.filter_map(|part| part.split_once('='));
    let (_, value) = pairs.find(|(key, _)| key.trim().eq_ignore_ascii_case("INPUT"))?;
    let name = value.trim().trim_matches(['"', '\'']).to_string();
    match keyword.as_str() {
        "INCLUDE" => Some(Inclusion::Instead(name, count)),
        other if WITH_DATA.contains(&other) => Some(Inclusion::After(name, count)),
        _ => None,
    }
}
