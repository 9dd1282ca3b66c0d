//! Arguments that are elements or scenes.

use std::path::Path;

/// Whether a file is a scene: it has a `[mesh]`, where an element has nodes. A file that cannot be read counts as an element.
pub fn is_scene(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.lines().any(|line| line.trim_start().starts_with("[mesh]") || line.trim_start().starts_with("mesh."))
}
