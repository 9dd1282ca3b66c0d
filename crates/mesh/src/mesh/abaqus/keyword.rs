//! The keyword lines of an input file, such as `*ELEMENT, TYPE=C3D4, ELSET=body`.

use crate::error::Result;
use crate::mesh::lines::Lines;
use crate::mesh::reader::quoted;

/// A keyword and its parameters.
pub(super) struct Keyword {
    /// In upper case, with one space between words, without the star.
    pub name: String,
    /// Names in upper case, without spaces, with values as they are.
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// The keyword of the line that `lines` has just read, continued on the next lines while it ends in a comma.
    ///
    /// # Errors
    /// The line is no text.
    pub fn of(lines: &mut Lines, line: &[u8]) -> Result<Keyword> {
        let mut text = decoded(lines, line)?;
        while text.trim_end().ends_with(',') && !lines.peek().is_none_or(|next| next.starts_with(b"*")) {
            if let Some(more) = lines.next() {
                text += &decoded(lines, more)?;
            }
        }
        let mut parts = text.trim().trim_start_matches('*').split(',');
        let name = parts.next().unwrap_or_default();
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let parameters = parts.filter(|part| !part.trim().is_empty()).map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            let key: String = key.split_whitespace().collect();
            (key.to_ascii_uppercase(), value.trim().trim_matches('"').to_string())
        });
        let parameters = parameters.collect();
        Ok(Keyword { name, parameters })
    }

    /// The value of a parameter; empty for one without a value.
    pub fn value(&self, parameter: &str) -> Option<&str> {
        self.parameters.iter().find(|(key, _)| key == parameter).map(|(_, value)| value.as_str())
    }

    pub fn has(&self, parameter: &str) -> bool {
        self.value(parameter).is_some()
    }

    /// Whether a parameter without a value is there, whole or as its first letters, of which three are enough.
    pub fn says(&self, parameter: &str) -> bool {
        self.parameters.iter().any(|(key, _)| key.len() >= 3 && parameter.starts_with(key.as_str()))
    }

    /// The value of a parameter that the keyword must have.
    ///
    /// # Errors
    /// It is missing or empty.
    pub fn required(&self, lines: &Lines, parameter: &str) -> Result<&str> {
        match self.value(parameter) {
            Some(value) if !value.is_empty() => Ok(value),
            _ => Err(lines.expected(&format!("{parameter}="), "none")),
        }
    }
}

fn decoded(lines: &Lines, line: &[u8]) -> Result<String> {
    if line.contains(&0) {
        return Err(lines.expected("text", &quoted(line)));
    }
    Ok(String::from_utf8_lossy(line).into_owned())
}

/// The fields of a data line; a comma at its end has none after it.
pub(super) fn fields(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let line = line.trim_ascii();
    let line = line.strip_suffix(b",").unwrap_or(line);
    line.split(|&b| b == b',').map(<[u8]>::trim_ascii)
}
