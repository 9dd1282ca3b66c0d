//! Quadrature rules on reference cells.

use super::cell::Cell;
use gauss_quad::GaussLegendre;
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
            (true, _) => Quadrature::conical(cell.dimension(), degree),
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

    /// Gauss–Legendre points in collapsed coordinates: the simplex is the cube squeezed towards one corner, and the
    /// Jacobian `(1 − s)^(d−1−k)` of each coordinate adds to the degree that its line must integrate.
    fn conical(dimension: usize, degree: usize) -> Quadrature {
        let line = |k: usize| -> Vec<(f64, f64)> {
            let squeezed = dimension - 1 - k;
            let rule = GaussLegendre::new(one_to_most((degree + squeezed) / 2 + 1));
            let place = |(x, w): &(f64, f64)| ((1.0 + x) / 2.0, w / 2.0 * ((1.0 - x) / 2.0).powi(squeezed as i32));
            rule.iter().map(place).collect()
        };
        let lines: Vec<_> = (0..dimension).map(line).collect();
        product(&lines, |s| {
            let mut left = 1.0;
            let squeeze = |t: &f64| {
                let x = t * left;
                left *= 1.0 - t;
                x
            };
            s.iter().map(squeeze).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|i| i as f64).product()
    }

    /// `∫ x^a y^b z^c` is `a! b! c! / (a+b+c+d)!` over the simplex, and a product of `2/(e+1)` (0 for odd e) over the
    /// cube. Sums of a few thousand terms of size one round to 1e-13.
    #[test]
    fn rules_integrate_every_monomial_of_their_degree() {
        for cell in [Cell::Interval, Cell::Triangle, Cell::Quadrilateral, Cell::Tetrahedron, Cell::Hexahedron] {
            let d = cell.dimension();
            for degree in 0..=20 {
                let rule = Quadrature::of_degree(cell, degree);
                assert!(rule.weights.iter().all(|w| *w > 0.0));
                for code in 0..(degree + 1).pow(d as u32) {
                    let e: Vec<usize> = (0..d).map(|k| code / (degree + 1).pow(k as u32) % (degree + 1)).collect();
                    let total: usize = e.iter().sum();
                    if total > degree {
                        continue;
                    }
                    let exact: f64 = if cell.is_simplex() {
                        e.iter().map(|e| factorial(*e)).product::<f64>() / factorial(total + d)
                    } else {
                        e.iter().map(|e| if e % 2 == 0 { 2.0 / (e + 1) as f64 } else { 0.0 }).product()
                    };
                    let monomial = |x: &[f64]| x.iter().zip(&e).map(|(x, e)| x.powi(*e as i32)).product::<f64>();
                    let sum: f64 = rule.points.chunks_exact(d).zip(&rule.weights).map(|(x, w)| w * monomial(x)).sum();
                    assert!((sum - exact).abs() < 1e-13, "{cell:?} degree {degree} exponents {e:?}: {sum} {exact}");
                }
            }
        }
    }
}
