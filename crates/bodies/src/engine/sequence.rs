//! Springs whose order in a sweep is sought.

/// Springs whose order is sought.
#[derive(Debug, Clone, Copy)]
pub struct Sequence<'a, S> {
    /// Their points; those on lengths come first.
    pub springs: &'a [S],
    /// The number of those on lengths.
    pub lengths: usize,
    /// The points at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The number of coordinates of a point.
    pub dimension: usize,
    /// Whether each point is held, `[points]`.
    pub held: &'a [bool],
}
