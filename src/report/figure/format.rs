//! The formats of figures.

use crate::error::{Error, Result};
#[cfg(feature = "pictures")]
use resvg::usvg;
use std::path::Path;

/// The format of a figure's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Text, for browsers and drawing programs.
    Svg,
    /// For LaTeX; its texts are texts.
    Pdf,
    /// Of 300 pixels an inch.
    Png,
}

impl PictureFormat {
    /// The format that the ending of a file says.
    ///
    /// # Errors
    /// It is no format of figures, or one that this program was built without.
    pub fn of(path: &Path) -> Result<PictureFormat> {
        let ending = path.extension().map_or(String::new(), |ending| ending.to_string_lossy().to_lowercase());
        let format = match ending.as_str() {
            "svg" => PictureFormat::Svg,
            "pdf" => PictureFormat::Pdf,
            "png" => PictureFormat::Png,
            _ => return Err(Error::expected("--output", "a file ending in .svg, .pdf or .png", path.display())),
        };
        if format != PictureFormat::Svg && !cfg!(feature = "pictures") {
            let stem = path.with_extension("svg");
            let tool = match format {
                PictureFormat::Png => "rsvg-convert --dpi-x 300 --dpi-y 300",
                PictureFormat::Svg | PictureFormat::Pdf => "rsvg-convert -f pdf",
            };
            let (svg, path) = (stem.display(), path.display());
            return Err(Error::at(
                "--output",
                format!(
                    "{path}: this program was built without PDF and PNG; build it with `cargo install --path . --features pictures`, \
                     or write {svg} and run `{tool} {svg} -o {path}` or `inkscape {svg} -o {path}`"
                ),
            ));
        }
        Ok(format)
    }

    /// The bytes of the file of a figure.
    ///
    /// # Errors
    /// The figure cannot be converted.
    pub fn bytes(self, svg: String) -> Result<Vec<u8>> {
        match self {
            PictureFormat::Svg => Ok(svg.into_bytes()),
            PictureFormat::Pdf | PictureFormat::Png => self.converted(&svg),
        }
    }

    #[cfg(feature = "pictures")]
    fn converted(self, svg: &str) -> Result<Vec<u8>> {
        let failed = |what: &str, e: String| Error::new(format!("the figure cannot be {what}: {e}"));
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        let options = usvg::Options { fontdb: std::sync::Arc::new(fonts), ..usvg::Options::default() };
        let tree = usvg::Tree::from_str(svg, &options).map_err(|e| failed("read", e.to_string()))?;
        if self == PictureFormat::Pdf {
            let page = svg2pdf::PageOptions { dpi: PIXELS_AN_INCH };
            return svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page)
                .map_err(|e| failed("written as PDF", e.to_string()));
        }
        let scale = DOTS_AN_INCH / PIXELS_AN_INCH;
        let size = tree.size().to_int_size().scale_by(scale).ok_or_else(|| failed("drawn", "it has no size".into()))?;
        let pixels = resvg::tiny_skia::Pixmap::new(size.width(), size.height());
        let mut pixels = pixels.ok_or_else(|| failed("drawn", "it is too large".into()))?;
        resvg::render(&tree, resvg::tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().map_err(|e| failed("written as PNG", e.to_string()))
    }

    /// [`PictureFormat::of`] gives no such format.
    #[cfg(not(feature = "pictures"))]
    fn converted(self, _: &str) -> Result<Vec<u8>> {
        Err(Error::new("this program was built without PDF and PNG; the feature \"pictures\" has both"))
    }
}

/// Of the units of a figure.
#[cfg(feature = "pictures")]
const PIXELS_AN_INCH: f32 = 96.0;
/// What journals ask of pictures in colour.
#[cfg(feature = "pictures")]
const DOTS_AN_INCH: f32 = 300.0;
