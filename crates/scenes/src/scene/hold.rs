//! What a scene holds.

use super::part::Part;

/// A part of the body that is held at rest.
#[derive(Debug, Clone)]
pub struct Hold {
    /// The part.
    pub part: Part,
    /// The directions in which it is held; all if absent.
    pub axes: Option<Vec<usize>>,
    /// Whether edges of a sheet whose ends are held, and joints of rods that are held, keep their direction.
    pub clamp: bool,
}
