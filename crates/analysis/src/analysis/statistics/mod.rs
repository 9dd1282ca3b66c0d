//! Statistics of repeated and of paired figures.

mod bootstrap;
mod histogram;
mod normal;
mod paired;
mod quantile;

pub use bootstrap::{Interval, median_interval, ratio_interval};
pub use histogram::Histogram;
pub use normal::beyond;
pub use paired::{Paired, Verdict, adjust, mean_ranks, signed_rank};
pub use quantile::{Quantiles, median, quantile};
