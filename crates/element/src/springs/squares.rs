//! Sums of squared distances, in which the strain of a membrane is linear.
//!
//! Theory: page *Sheets that bend* of the book.

use crate::symbolic::Jet;
use smallvec::SmallVec;

/// `c = Σ_i w_i |x_a − x_b|²`: a weighted sum of the squared distances of pairs of points. Its second derivatives are the same everywhere.
///
/// The gradients `∇N_a` of linear functions have the sum zero, so that `E = ½ (FᵀF − I) = −½ Σ_{a<b} (|x_a − x_b|² − |X_a − X_b|²) sym(∇N_a ⊗ ∇N_b)`: each
/// component of the strain of a triangle is such a sum, with weights in 1/m².
#[derive(Debug, Clone, PartialEq)]
pub struct Squares(SmallVec<[Square; 5]>);

/// The square of one distance, and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Square {
    /// Two places in the points of the spring.
    places: [u8; 2],
    weight: f64,
}

impl Squares {
    /// The squares of the distances of these places, with their weights, on `points` points; none if a place is not below their number, both places are equal, a
    /// weight is no number, or there are no squares.
    pub fn new<'a>(squares: impl IntoIterator<Item = (&'a [usize], f64)>, points: usize) -> Option<Squares> {
        let square = |(places, weight): (&[usize], f64)| {
            let places = <[usize; 2]>::try_from(places).ok()?;
            let is_in = places.iter().all(|&place| place < points.min(256));
            (is_in && places[0] != places[1] && weight.is_finite())
                .then(|| Square { places: places.map(|place| place as u8), weight })
        };
        let squares: Option<SmallVec<[Square; 5]>> = squares.into_iter().map(square).collect();
        squares.filter(|squares| !squares.is_empty()).map(Squares)
    }

    /// The places and the weight of each square.
    pub fn iter(&self) -> impl Iterator<Item = ([usize; 2], f64)> + '_ {
        self.0.iter().map(|square| (square.places.map(usize::from), square.weight))
    }

    pub(super) fn value(&self, x: &[f64], dimension: usize) -> f64 {
        let square = |[a, b]: [usize; 2]| -> f64 {
            (0..dimension).map(|k| (x[b * dimension + k] - x[a * dimension + k]).powi(2)).sum()
        };
        self.iter().map(|(places, weight)| weight * square(places)).sum()
    }

    /// `∂c/∂x_b = 2 w (x_b − x_a)`, and its opposite at a.
    pub(super) fn gradient(&self, x: &[f64], dimension: usize) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        for ([a, b], weight) in self.iter() {
            for (a, b) in (a * dimension..).zip(b * dimension..).take(dimension) {
                let slope = 2.0 * weight * (x[b] - x[a]);
                gradient[b] += slope;
                gradient[a] -= slope;
            }
        }
        gradient
    }

    pub(super) fn jet(&self, x: &[f64], dimension: usize) -> Jet {
        let n = x.len();
        let mut hessian = vec![0.0; n * n];
        for ([a, b], weight) in self.iter() {
            for (a, b) in (a * dimension..).zip(b * dimension..).take(dimension) {
                for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    hessian[row * n + column] += sign * 2.0 * weight;
                }
            }
        }
        Jet { value: self.value(x, dimension), gradient: self.gradient(x, dimension), hessian }
    }
}
