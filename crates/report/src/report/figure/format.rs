//! The formats of figures.

use super::converter::{CONVERTER, converted, converter};
use crate::error::{Error, Result};
use std::path::Path;

/// The format of a figure's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Text, for browsers and drawing programs.
    Svg,
    /// A page for LaTeX, whose texts can be selected.
    Pdf,
    /// An image with 300 pixels an inch.
    Png,
}

impl PictureFormat {
    /// The format that the ending of a file says.
    ///
    /// # Errors
    /// It is no format of figures, or one whose program is not installed.
    pub fn of(path: &Path) -> Result<PictureFormat> {
        let ending = path.extension().map_or(String::new(), |ending| ending.to_string_lossy().to_lowercase());
        let (format, other) = match ending.as_str() {
            "svg" => return Ok(PictureFormat::Svg),
            "pdf" => (PictureFormat::Pdf, "rsvg-convert -f pdf"),
            "png" => (PictureFormat::Png, "rsvg-convert --dpi-x 300 --dpi-y 300"),
            _ => return Err(Error::expected("--output", "a file ending in .svg, .pdf or .png", path.display())),
        };
        if converter().is_some() {
            return Ok(format);
        }
        let stem = path.with_extension("svg");
        let (svg, path) = (stem.display(), path.display());
        Err(Error::at(
            "--output",
            format!(
                "{path}: PDF and PNG are made by the program {CONVERTER}, which is neither beside this one nor on PATH; install it \
                 with `cargo install --path crates/pictures`, or write {svg} and run `{other} {svg} -o {path}` or \
                 `inkscape {svg} -o {path}`"
            ),
        ))
    }

    /// The bytes of the file of a figure.
    ///
    /// # Errors
    /// The figure cannot be converted.
    pub fn bytes(self, svg: String) -> Result<Vec<u8>> {
        match self {
            PictureFormat::Svg => Ok(svg.into_bytes()),
            PictureFormat::Pdf => converted(&svg, "pdf"),
            PictureFormat::Png => converted(&svg, "png"),
        }
    }
}
