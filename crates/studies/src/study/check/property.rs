//! A property of an element file.

/// The result of one property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Holds,
    Fails,
    /// It cannot be told, or is for the reader to judge.
    Noted,
}

/// One property of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Property {
    pub name: &'static str,
    pub mark: Mark,
    /// The figure found, or what is wrong.
    pub finding: String,
    /// The figure as a number, where there is one.
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
