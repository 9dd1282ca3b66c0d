//! Rigid motions: what an elastic body without supports meets no resistance in.

use crate::block::{Block, zero};

/// The displacements of each node in the three rigid motions of the plane, with the held ones zero; `points` is `[nodes × 2]`.
pub fn plane_motions(points: &[f64], is_held: &[bool]) -> Vec<Block<2, 3>> {
    motions::<2, 3>(points, is_held, |block, x| {
        (block[0][2], block[1][2]) = (-x[1], x[0]);
    })
}

/// The displacements of each node in the six rigid motions of space, with the held ones zero; `points` is `[nodes × 3]`.
pub fn space_motions(points: &[f64], is_held: &[bool]) -> Vec<Block<3, 6>> {
    motions::<3, 6>(points, is_held, |block, x| {
        (block[1][3], block[2][3]) = (-x[2], x[1]);
        (block[2][4], block[0][4]) = (-x[0], x[2]);
        (block[0][5], block[1][5]) = (-x[1], x[0]);
    })
}

/// Translations, then what `rotate` adds for the position in the unit of the body's size, from its centre.
fn motions<const D: usize, const M: usize>(
    points: &[f64],
    is_held: &[bool],
    rotate: impl Fn(&mut Block<D, M>, [f64; D]),
) -> Vec<Block<D, M>> {
    let points = points.as_chunks::<D>().0;
    let mut centre = [0.0; D];
    for x in points {
        (0..D).for_each(|k| centre[k] += x[k] / points.len() as f64);
    }
    // Rotations about the centre in units of the body's size are as large as translations. About a distant origin they would be
    // translations but for a few digits.
    let distance = |x: &[f64; D]| (0..D).map(|k| (x[k] - centre[k]).abs()).fold(0.0, f64::max);
    // A body of one point has the size zero, by which nothing may be divided.
    let size = points.iter().map(distance).fold(f64::MIN_POSITIVE, f64::max);
    let node = |(x, held): (&[f64; D], &[bool; D])| {
        let mut block = zero::<D, M>();
        (0..D).for_each(|k| block[k][k] = 1.0);
        rotate(&mut block, std::array::from_fn(|k| (x[k] - centre[k]) / size));
        (0..D).filter(|k| held[*k]).for_each(|k| block[k] = [0.0; M]);
        block
    };
    points.iter().zip(is_held.as_chunks::<D>().0).map(node).collect()
}
