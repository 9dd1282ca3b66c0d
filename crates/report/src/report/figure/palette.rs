//! Colours of figures, told apart by all eyes and in grey.

use plotters::style::RGBColor;

/// Okabe and Ito (2008): told apart by all eyes; in an order whose neighbours differ in grey.
pub const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(120, 120, 120),
];
/// What others are compared with has this colour.
pub const REFERENCE: RGBColor = RGBColor(175, 175, 175);
/// The dashes of lines, pixels; none of a solid line.
pub const DASHES: [&[i32]; 6] = [&[], &[8, 3], &[3, 3], &[12, 3, 3, 3], &[1, 2], &[3, 7]];
/// Brewer's YlGnBu without its darkest step, on which edges would not be seen; each is darker in grey than the one before.
const RAMP: [[f64; 3]; 5] =
    [[255.0, 255.0, 217.0], [199.0, 233.0, 180.0], [127.0, 205.0, 187.0], [65.0, 182.0, 196.0], [34.0, 130.0, 184.0]];

/// The colour of a share from 0 to 1.
pub fn ramp(share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let (i, t) = ((place as usize).min(RAMP.len() - 2), place - (place as usize).min(RAMP.len() - 2) as f64);
    let channel = |k: usize| (RAMP[i][k] + t * (RAMP[i + 1][k] - RAMP[i][k])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2))
}

/// A colour as text, `share` of the way to white.
pub fn faded(RGBColor(r, g, b): RGBColor, share: f64) -> String {
    let channel = |c: u8| (f64::from(c) + share.clamp(0.0, 1.0) * (255.0 - f64::from(c))).round() as u8;
    format!("#{:02x}{:02x}{:02x}", channel(r), channel(g), channel(b))
}
