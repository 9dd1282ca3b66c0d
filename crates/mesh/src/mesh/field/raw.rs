//! Numbers at places as a file holds them.

/// To what the numbers of a file belong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holder {
    /// The points of a grid, or the rows of a table.
    Points,
    /// The cells of a grid.
    Cells,
}

/// What a file holds: places in the unit of the file, and `components` numbers at each.
pub(super) struct Raw {
    pub holder: Holder,
    pub places: Vec<[f64; 3]>,
    pub components: usize,
    pub values: Vec<f64>,
    /// Where each row of a table begins in its text; empty for grids.
    pub starts: Vec<usize>,
}
