//! Checks that a measure does not change when a body is moved or turned.

use crate::error::{Error, Result};
use crate::symbolic::{Expr, Program};

/// The number of shapes that are moved. An expression that is not invariant changes on almost every shape.
const TRIALS: usize = 12;
/// The allowed change, relative to the terms of which the measure is a sum. Their rounding is a millionth of it.
const TOLERANCE: f64 = 1e-9;

/// Checks that `measure`, a function of the coordinates of some nodes, does not change under rigid motions: a spring
/// would resist them otherwise. It is evaluated on shapes near `positions`, `[nodes × dimension]`, before and after a
/// translation and a rotation.
///
/// # Errors
/// The measure changes; the error has no key.
pub fn expect_invariant(measure: &Expr, positions: &[f64], dimension: usize) -> Result<()> {
    let measure = Program::of(measure);
    let mut random = Sequence(0);
    let size = positions.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    for _ in 0..TRIALS {
        // Shapes from half to two and a half times the size, with nodes that are moved so far that no symmetry of the
        // element is left.
        let stretch = 1.5 + random.next();
        let x: Vec<f64> = positions.iter().map(|x| stretch * x + 0.4 * size * random.next()).collect();
        let shift: Vec<f64> = (0..dimension).map(|_| 3.0 * size * random.next()).collect();
        let shifted: Vec<f64> = x.iter().enumerate().map(|(i, x)| x + shift[i % dimension]).collect();
        let turned = turned(&x, dimension, &mut random);
        for (moved, how) in [(shifted, "shifted"), (turned, "turned")] {
            let (before, after) = (measure.evaluate(&x), measure.evaluate(&moved));
            let terms = before.abs() + weight(&measure, &x) + weight(&measure, &moved);
            if before.is_finite() && !((after - before).abs() <= TOLERANCE * terms) {
                let expected = "a measure that stays the same where the body is shifted or turned";
                let found = format!("{before:?} and, {how}, {after:?}");
                return Err(Error::new(format!("expected {expected}, found {found}")));
            }
        }
    }
    Ok(())
}

/// `Σ |∂c/∂x_i| |x_i|`, or zero if it is not finite.
fn weight(measure: &Program, x: &[f64]) -> f64 {
    let sum: f64 = measure.gradient(x).1.iter().zip(x).map(|(g, x)| (g * x).abs()).sum();
    if sum.is_finite() { sum } else { 0.0 }
}

/// The positions turned about the origin, by reflections at two random planes in succession.
fn turned(x: &[f64], dimension: usize, random: &mut Sequence) -> Vec<f64> {
    if dimension == 1 {
        return x.to_vec();
    }
    let mut x = x.to_vec();
    for _ in 0..2 {
        let normal: Vec<f64> = (0..dimension).map(|_| random.next()).collect();
        let square: f64 = normal.iter().map(|n| n * n).sum();
        for point in x.chunks_exact_mut(dimension) {
            let along: f64 = point.iter().zip(&normal).map(|(x, n)| x * n).sum();
            point.iter_mut().zip(&normal).for_each(|(x, n)| *x -= 2.0 * along / square * n);
        }
    }
    x
}

/// Evenly spread numbers between −1 and 1, the same in every run.
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        // Knuth's numbers of MMIX. The upper 53 bits are a double without rounding, and the lowest repeat soonest.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
