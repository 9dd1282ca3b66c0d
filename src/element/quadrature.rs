//! Quadrature rules on reference cells.

use super::cell::Cell;
use gauss_quad::{FiniteAboveNegOneF64, GaussJacobi, GaussLegendre};
use std::num::NonZeroUsize;

/// `∫ f ≈ Σ_q w_q f(ξ_q)` over a reference cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    pub dimension: usize,
    /// `[points × dimension]`.
    pub points: Vec<f64>,
    /// `[points]`.
    pub weights: Vec<f64>,
}

/// The largest number of points per direction that a rule may have.
pub const MOST_POINTS: usize = 32;

impl Quadrature {
    /// Exact for polynomials up to `degree` on the cell: Gauss–Legendre products, and on simplices the centroid,
    /// the d + 1 point rule of degree 2 (Hammer and Stroud 1956), or the conical product (Stroud 1971).
    pub fn of_degree(cell: Cell, degree: usize) -> Quadrature {
        match (cell.is_simplex(), degree) {
            (false, _) => Quadrature::gauss_legendre(cell.dimension(), degree / 2 + 1),
            (true, 0 | 1) => Quadrature::centroid(cell),
            (true, 2) => Quadrature::hammer_stroud(cell),
            (true, _) => Quadrature::conical(cell.dimension(), degree / 2 + 1),
        }
    }

    /// The product rule with `points` Gauss–Legendre points per direction on [-1, 1]^dimension.
    pub fn gauss_legendre(dimension: usize, points: usize) -> Quadrature {
        let line: Vec<(f64, f64)> = GaussLegendre::new(one_to_most(points)).iter().map(|(x, w)| (*x, *w)).collect();
        product(&vec![line; dimension], |s| s.to_vec())
    }

    fn centroid(cell: Cell) -> Quadrature {
        let d = cell.dimension();
        Quadrature { dimension: d, points: vec![1.0 / (d + 1) as f64; d], weights: vec![cell.content()] }
    }

    /// Points at barycentric coordinates (a, b, …, b), b = (d+2 − √(d+2)) / ((d+1)(d+2)), with equal weights.
    fn hammer_stroud(cell: Cell) -> Quadrature {
        let d = cell.dimension();
        let e = (d + 2) as f64;
        let b = (e - e.sqrt()) / ((d + 1) as f64 * e);
        let a = 1.0 - d as f64 * b;
        let points = (0..=d).flat_map(|corner| (0..d).map(move |i| if i + 1 == corner { a } else { b })).collect();
        Quadrature { dimension: d, points, weights: vec![cell.content() / (d + 1) as f64; d + 1] }
    }

    /// Gauss–Jacobi points in collapsed coordinates: the simplex is the cube squeezed towards one corner.
    fn conical(dimension: usize, points: usize) -> Quadrature {
        let lines: Vec<Vec<(f64, f64)>> = (0..dimension)
            .map(|k| {
                let alpha = FiniteAboveNegOneF64::new((dimension - 1 - k) as f64).expect("it is not negative");
                let beta = FiniteAboveNegOneF64::new(0.0).expect("it is not negative");
                let rule = GaussJacobi::new(one_to_most(points), alpha, beta);
                // From weight (1-x)^α on [-1, 1] to (1-s)^α on [0, 1].
                let scale = 0.5f64.powi((dimension - k) as i32);
                rule.iter().map(|(x, w)| ((1.0 + x) / 2.0, w * scale)).collect()
            })
            .collect();
        product(&lines, |s| {
            let mut left = 1.0;
            s.iter()
                .map(|t| {
                    let x = t * left;
                    left *= 1.0 - t;
                    x
                })
                .collect()
        })
    }
}

fn one_to_most(points: usize) -> NonZeroUsize {
    NonZeroUsize::new(points.clamp(1, MOST_POINTS)).expect("it is at least one")
}

/// All combinations of the lines' points, the first coordinate fastest, mapped by `place`.
fn product(lines: &[Vec<(f64, f64)>], place: impl Fn(&[f64]) -> Vec<f64>) -> Quadrature {
    let count: usize = lines.iter().map(Vec::len).product();
    let mut rule = Quadrature { dimension: lines.len(), points: Vec::new(), weights: Vec::new() };
    for q in 0..count {
        let mut rest = q;
        let (mut at, mut weight) = (Vec::new(), 1.0);
        for line in lines {
            let (x, w) = line[rest % line.len()];
            rest /= line.len();
            at.push(x);
            weight *= w;
        }
        rule.points.extend(place(&at));
        rule.weights.push(weight);
    }
    rule
}
