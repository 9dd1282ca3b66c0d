//! The proof of an element file: every property that its use relies on, with the figure found.

mod shape;
mod space;
mod springs;

use crate::element::Element;
use crate::error::Error;
use std::sync::Arc;

/// What is to be said of one property.
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

/// The properties of one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// The file, or the name of a shipped element.
    pub file: String,
    pub title: String,
    pub properties: Vec<Property>,
}

impl Property {
    fn new(name: &'static str, holds: bool, finding: impl Into<String>) -> Property {
        Property { name, mark: if holds { Mark::Holds } else { Mark::Fails }, finding: finding.into(), value: None }
    }

    fn noted(name: &'static str, finding: impl Into<String>) -> Property {
        Property { name, mark: Mark::Noted, finding: finding.into(), value: None }
    }

    fn with(self, value: f64) -> Property {
        Property { value: Some(value), ..self }
    }
}

impl Inspection {
    pub fn passes(&self) -> bool {
        self.properties.iter().all(|p| p.mark != Mark::Fails)
    }
}

/// Checks what `Element::load` made of the file: the element, or why it is none.
pub fn inspect(file: &str, loaded: Result<Element, Error>) -> Inspection {
    let element = match loaded {
        Ok(element) => Arc::new(element),
        Err(error) => {
            let properties = vec![Property::new("loads", false, error.to_string())];
            return Inspection { file: file.into(), title: String::new(), properties };
        }
    };
    let springs: usize = element.springs.iter().map(|g| g.nodes.len().max(1)).sum();
    let finding = format!(
        "{} nodes, {springs} springs in {} groups, {} quadrature points",
        element.nodes(),
        element.springs.len(),
        element.tabulation.points()
    );
    let mut properties = vec![Property::new("loads", true, finding)];
    properties.extend(space::properties(&element));
    properties.extend(shape::properties(&element));
    properties.extend(springs::properties(&element));
    Inspection { file: file.into(), title: element.title.clone(), properties }
}
