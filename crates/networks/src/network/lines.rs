//! Every text of a network is one printable line.

use crate::error::{Error, ErrorKind, Result};
use crate::text::{is_expression, not_a_line, printable};
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Checks the keys and texts of a JSON file; expressions may have line ends.
///
/// # Errors
/// A text has a line end or a character that acts on a terminal. The error names the line and the key.
pub fn check_texts(json: &[u8]) -> Result<()> {
    if !may_have_others(json) {
        return Ok(());
    }
    let mut reader = serde_json::Deserializer::from_slice(json);
    serde_path_to_error::deserialize::<_, Lines>(&mut reader).map(|_| ()).map_err(|e| {
        let error = Error::at(e.path().to_string(), words(e.inner())).of_kind(ErrorKind::Invalid);
        error.on_line(e.inner().line().max(1))
    })
}

/// The message without the place, which serde puts at its end.
pub fn words(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    printable(text.strip_suffix(&place).unwrap_or(&text)).into_owned()
}

/// Whether the file has an escape or a byte with which a character that is not printable begins. Most files have none, and need no
/// second reading.
fn may_have_others(json: &[u8]) -> bool {
    json.windows(3).any(|bytes| match bytes {
        [b'\\', next, _] => !matches!(next, b'"' | b'\\' | b'/'),
        [0xc2, next, _] => *next < 0xa0,
        // U+200E to U+202E, and U+2066 to U+2069.
        [0xe2, 0x80, next] => matches!(next, 0x8e | 0x8f | 0xa8..=0xae),
        [0xe2, 0x81, next] => matches!(next, 0xa6..=0xa9),
        [first, _, _] => *first == 0x7f,
        _ => false,
    })
}

/// A value all of whose texts are printable lines.
struct Lines;

impl<'de> Deserialize<'de> for Lines {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Lines, D::Error> {
        deserializer.deserialize_any(Texts { in_expression: false })
    }
}

#[derive(Clone, Copy)]
struct Texts {
    in_expression: bool,
}

impl<'de> DeserializeSeed<'de> for Texts {
    type Value = Lines;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> std::result::Result<Lines, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Texts {
    type Value = Lines;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> std::result::Result<Lines, E> {
        not_a_line(text, self.in_expression).map_or(Ok(Lines), |problem| Err(E::custom(problem)))
    }

    fn visit_bool<E>(self, _: bool) -> std::result::Result<Lines, E> {
        Ok(Lines)
    }

    fn visit_u64<E>(self, _: u64) -> std::result::Result<Lines, E> {
        Ok(Lines)
    }

    fn visit_i64<E>(self, _: i64) -> std::result::Result<Lines, E> {
        Ok(Lines)
    }

    fn visit_f64<E>(self, _: f64) -> std::result::Result<Lines, E> {
        Ok(Lines)
    }

    fn visit_unit<E>(self) -> std::result::Result<Lines, E> {
        Ok(Lines)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<Lines, A::Error> {
        while list.next_element_seed(self)?.is_some() {}
        Ok(Lines)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> std::result::Result<Lines, A::Error> {
        while let Some(key) = table.next_key::<String>()? {
            if let Some(problem) = not_a_line(&key, false) {
                return Err(A::Error::custom(problem));
            }
            table.next_value_seed(Texts { in_expression: self.in_expression || is_expression(&key) })?;
        }
        Ok(Lines)
    }
}
