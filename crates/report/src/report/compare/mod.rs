//! A comparison as data, tables, figures and a page.

mod figures;
mod files;
mod pairs;
mod parquet;
mod summary;
mod tables;
mod values;

pub(super) use figures::{Drawn, comparison_chart, thinned};
pub(super) use files::read_cases;
pub use files::{CASES, COMPARE_FILES, comparison_values, write_comparison};
pub use summary::{Summary, summarized};
pub use tables::{compare_tables, compare_text};
