//! Marks of the points of a chart.

use super::palette::COLORS;
use plotters::element::{PathElement, Rectangle};
use plotters::style::{Color, RGBColor};

/// Units of the drawing in a pixel: the drawing library places all at whole units.
pub const FINE: i32 = 8;
/// Units of lines.
pub const THICK: u32 = 2 * FINE as u32 - FINE as u32 / 4;
pub const THIN: u32 = FINE as u32;
/// Units from the middle of a mark to its edge.
pub const MARK: i32 = 7 * FINE / 2;

/// What a point is shown as.
#[derive(Clone, Copy)]
pub enum Mark {
    Disc,
    Ring,
    Triangle,
    Cross,
    Square,
    Diamond,
    Plus,
    /// An open square.
    Pane,
    Open,
}

/// The mark of a series: eight series differ without their colours, and those of the same colour differ as well.
pub fn mark(i: usize, is_below: bool) -> Mark {
    let marks =
        [Mark::Disc, Mark::Triangle, Mark::Cross, Mark::Ring, Mark::Square, Mark::Diamond, Mark::Plus, Mark::Pane];
    if is_below { Mark::Open } else { marks[(i + i / COLORS.len()) % marks.len()] }
}

/// A square around the origin.
pub fn square(color: RGBColor) -> Rectangle<(i32, i32)> {
    Rectangle::new([(-MARK, -MARK), (MARK, MARK)], color.filled())
}

/// The outline of a square around the origin.
pub fn pane(color: RGBColor) -> PathElement<(i32, i32)> {
    let corners = [(-MARK, -MARK), (MARK, -MARK), (MARK, MARK), (-MARK, MARK), (-MARK, -MARK)];
    PathElement::new(corners.to_vec(), color.stroke_width(THICK))
}

/// The outline of a square on its corner, around the origin.
pub fn diamond(color: RGBColor) -> PathElement<(i32, i32)> {
    let side = MARK + FINE;
    PathElement::new(vec![(0, -side), (side, 0), (0, side), (-side, 0), (0, -side)], color.stroke_width(THICK))
}

/// Two strokes across the origin, in one path.
pub fn plus(color: RGBColor) -> PathElement<(i32, i32)> {
    let side = MARK + FINE;
    PathElement::new(vec![(-side, 0), (side, 0), (0, 0), (0, -side), (0, side)], color.stroke_width(THICK))
}

/// The outline of a triangle that points down, around the origin. A marker would be filled.
pub fn open(color: RGBColor) -> PathElement<(i32, i32)> {
    let side = MARK + FINE;
    PathElement::new(
        vec![(-side, -side / 2), (side, -side / 2), (0, side), (-side, -side / 2)],
        color.stroke_width(THIN),
    )
}
