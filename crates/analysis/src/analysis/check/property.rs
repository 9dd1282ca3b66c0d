//! A property of an element file.

use serde::Serialize;

/// The result of testing one property.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Mark {
    /// The property holds.
    #[serde(rename = "ok")]
    Holds,
    /// The property does not hold: the file is wrong.
    #[serde(rename = "FAIL")]
    Fails,
    /// The property cannot be decided, or is for information.
    #[serde(rename = "-")]
    Noted,
}

/// One property of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Property {
    /// The name of the property.
    #[serde(rename = "property")]
    pub name: &'static str,
    /// The result.
    pub mark: Mark,
    /// The number that was found, or what is wrong, in words.
    pub finding: String,
    /// The number that was found, if there is one.
    pub value: Option<f64>,
}

impl Property {
    pub(super) fn new(name: &'static str, holds: bool, finding: impl Into<String>) -> Property {
        Property { name, mark: if holds { Mark::Holds } else { Mark::Fails }, finding: finding.into(), value: None }
    }

    pub(super) fn noted(name: &'static str, finding: impl Into<String>) -> Property {
        Property { name, mark: Mark::Noted, finding: finding.into(), value: None }
    }

    pub(super) fn with(self, value: f64) -> Property {
        Property { value: Some(value), ..self }
    }
}
