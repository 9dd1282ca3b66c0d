//! The body of a scene under its loads: load cases, gauges, and the finite element solutions.

mod answer;
mod case;
mod cases;
mod coarse_sheet;
mod factored;
mod fine;
mod fine_laws;
mod finer;
mod gauge;
mod iterated;
mod large;
mod linear;
mod load_notes;
mod part_notes;
mod reference;
mod solution;
mod truth;

pub use case::Case;
pub use cases::{applied_cases, held, load_cases};
pub use coarse_sheet::judge_sheet;
pub use fine::{Answers, FineBody};
pub use finer::FinerAnswer;
pub use gauge::Gauged;
pub use large::LargeBody;
pub use linear::LinearBody;
pub use load_notes::load_notes;
pub use solution::{seconds_of_body, seconds_of_network};
pub use truth::{judge_by_truth, quadratic_answers};
