//! Truths about the small dense solvers, and about the numbers that they compute with.

mod constrained;
mod dual;
mod extremes;
mod groups;
mod jacobi;
mod normal;
mod regression;
mod singular;
