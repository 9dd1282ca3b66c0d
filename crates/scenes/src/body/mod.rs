//! The body of a scene under its loads: load cases, gauges, and the finite element solutions.

mod case;
mod cases;
mod coarse_sheet;
mod factored;
mod finer_body;
mod finer_large;
mod finer_linear;
mod finer_mesh;
mod gauge;
mod iterated;
mod large;
mod linear;
mod linear_answers;
mod load_notes;
mod part_notes;
mod quadratic_reference;
mod solution;

pub use case::Case;
pub use cases::{applied_cases, held, load_cases};
pub use coarse_sheet::judge_sheet;
pub use finer_body::{Answers, FinerBody};
pub use finer_linear::FinerAnswer;
pub use gauge::Gauged;
pub use large::LargeBody;
pub use linear::LinearBody;
pub use load_notes::load_notes;
pub use quadratic_reference::{MOST_POINTS, UNNOTICED, judge_by_quadratic_elements, quadratic_answers};
pub use solution::{seconds_of_body, seconds_of_network};
