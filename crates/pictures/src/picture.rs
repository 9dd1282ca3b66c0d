//! The conversion of a figure.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};
use std::sync::Arc;

/// The units of a figure that make an inch.
const PIXELS_AN_INCH: f32 = 96.0;
/// What journals ask of pictures in colour.
const DOTS_AN_INCH: f32 = 300.0;

/// The format of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A page for LaTeX, whose texts can be selected.
    Pdf,
    /// An image with 300 pixels an inch.
    Png,
}

impl Format {
    /// The bytes of the picture of a figure.
    ///
    /// # Errors
    /// The figure is not SVG, or cannot be converted.
    pub fn bytes(self, svg: &[u8]) -> Result<Vec<u8>, String> {
        let failed = |what: &str, e: String| format!("the figure cannot be {what}: {e}");
        let tree = Tree::from_data(svg, &options()).map_err(|e| failed("read as SVG", e.to_string()))?;
        match self {
            Format::Pdf => {
                let page = svg2pdf::PageOptions { dpi: PIXELS_AN_INCH };
                let pdf = svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page);
                pdf.map_err(|e| failed("written as PDF", e.to_string()))
            }
            Format::Png => {
                let scale = DOTS_AN_INCH / PIXELS_AN_INCH;
                let size = tree.size().to_int_size().scale_by(scale);
                let size = size.ok_or_else(|| failed("drawn", "it has no size".into()))?;
                let pixels = Pixmap::new(size.width(), size.height());
                let mut pixels = pixels.ok_or_else(|| failed("drawn", "it is too large".into()))?;
                resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
                pixels.encode_png().map_err(|e| failed("written as PNG", e.to_string()))
            }
        }
    }
}

/// One font, so that a figure is the same on every machine.
fn options() -> Options<'static> {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Options { fontdb: Arc::new(fonts), ..Options::default() }
}
