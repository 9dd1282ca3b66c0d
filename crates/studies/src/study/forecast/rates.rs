//! Counts and rates of the work of a scene, measured once.

/// Sparse factors reach this share of the rate of a dense factor; a solution reads [`SOLUTIONS`] entries of a factor in a second. Both are
/// measured on bodies of 10 000 to 100 000 unknowns.
pub const SPARSE: f64 = 0.8;
pub const SOLUTIONS: f64 = 1e9;
/// A machine that is slow makes so many operations in a second: fewer take no time on any, and its rate need not be
/// measured for them.
pub const SLOWEST_RATE: f64 = 1e8;
/// Seconds for each unknown of a body solved by iterations: to assemble a model, build its levels and prove that it is stable, and for
/// each load, side by side with others. Measured on a million and on sixty thousand unknowns.
pub const COMPARED: f64 = 4e-5;
pub const ITERATED: f64 = 2e-6;
/// Seconds and bytes for each entry of the stiffnesses of all cells, while they are assembled.
pub const ASSEMBLY: f64 = 6e-8;
pub const BYTES: f64 = 70.0;
