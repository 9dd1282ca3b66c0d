//! Elements by name or by file.

use crate::element::Element;
use crate::error::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// The elements with these names, or in the files at these paths relative to `folder`.
///
/// # Errors
/// A file is missing or wrong, or a name is unknown; the key is `elements[i]`.
pub fn load_elements(names: &[String], folder: &Path) -> Result<Vec<Arc<Element>>> {
    let load = |(i, name): (usize, &String)| {
        load_element(name, folder).map_err(|e| e.placed(|e| Error::at(format!("elements[{i}]"), e.problem())))
    };
    names.iter().enumerate().map(load).collect()
}

/// The element with this name, or in the file at this path relative to `folder`.
pub fn load_element(name: &str, folder: &Path) -> Result<Arc<Element>> {
    let place =
        if name.ends_with(".toml") { folder.join(name).to_string_lossy().into_owned() } else { name.to_string() };
    Element::load(&place).map(Arc::new)
}
