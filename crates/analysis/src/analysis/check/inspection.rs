//! All properties of an element file.

use super::property::{Mark, Property};
use super::{integrals, shape, space, springs};
use crate::element::Element;
use crate::error::Error;
use std::sync::Arc;

/// The properties of one file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Inspection {
    /// The path of the file, or the name of a shipped element.
    pub file: String,
    /// The title of the element.
    pub title: String,
    /// The properties.
    pub properties: Vec<Property>,
}

impl Inspection {
    /// Whether no property fails.
    pub fn passes(&self) -> bool {
        self.properties.iter().all(|p| p.mark != Mark::Fails)
    }
}

/// Checks the result of `Element::load` on a file: the properties of the element, or the error.
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
    properties.extend(integrals::properties(&element));
    Inspection { file: file.into(), title: element.title.clone(), properties }
}
