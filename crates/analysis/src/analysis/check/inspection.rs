//! All properties of an element file.

use super::property::{Mark, Property};
use super::{integrals, shape, space, springs};
use crate::element::Element;
use crate::error::Error;
use serde::Serialize;
use std::sync::Arc;

/// The properties of one file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The path of the file, or the name of a shipped element.
    pub file: String,
    /// The title of the element.
    pub title: String,
    /// Whether no property fails.
    pub passes: bool,
    /// The properties, in the order in which they are checked.
    pub properties: Vec<Property>,
}

impl Inspection {
    fn new(file: &str, title: &str, properties: Vec<Property>) -> Inspection {
        let passes = properties.iter().all(|p| p.mark != Mark::Fails);
        Inspection { file: file.into(), title: title.into(), passes, properties }
    }
}

/// Checks the result of `Element::load` on a file: the properties of the element, or the error.
pub fn inspect(file: &str, loaded: Result<Element, Error>) -> Inspection {
    let element = match loaded {
        Ok(element) => Arc::new(element),
        Err(error) => {
            let properties = vec![Property::new("loads", false, error.to_string())];
            return Inspection::new(file, "", properties);
        }
    };
    let springs: usize = element.springs.iter().map(|g| g.nodes.len().max(1)).sum();
    let beside =
        if element.modes() > 0 { format!(" and {} condensed functions", element.modes()) } else { String::new() };
    let finding = format!(
        "{} nodes{beside}, {springs} springs in {} groups, {} quadrature points",
        element.nodes(),
        element.springs.len(),
        element.tabulation.points()
    );
    let mut properties = vec![Property::new("loads", true, finding)];
    properties.extend(space::properties(&element));
    properties.extend(shape::properties(&element));
    properties.extend(springs::properties(&element));
    properties.extend(integrals::properties(&element));
    Inspection::new(file, &element.title, properties)
}
