#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod prelude;
#[cfg(feature = "cli")]
pub mod report;

pub use springfit_bodies::{dynamics, mesh, model, positive, solve, whole};
pub use springfit_foundation::{error, quantity, range, scalar, symbolic, text};
pub use springfit_kernels::{element, fit, material, springs, stiffness};
pub use springfit_studies::study;

#[cfg(feature = "cli")]
use springfit_foundation::file;
pub use springfit_foundation::file::{check_apart, check_file, check_folder, files_in, write_whole, write_with};

/// The examples of README and of the book, for `cargo test --doc`.
#[cfg(doctest)]
mod examples {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/src/reference/library.md")]
    struct Library;
}
