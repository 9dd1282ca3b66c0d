//! Quadrature rules on reference cells.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::cell::Cell;
use gauss_quad::GaussLegendre;
use std::num::NonZeroUsize;

/// A quadrature rule `∫ f ≈ Σ_q w_q f(ξ_q)` over a reference cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// The number of coordinates of a point.
    pub dimension: usize,
    /// The points ξ_q, `[points × dimension]`.
    pub points: Vec<f64>,
    /// The weights w_q, `[points]`.
    pub weights: Vec<f64>,
}

/// The largest number of points per direction. In three dimensions these are 32 768 points.
// Rules then reach the degree 63. Products of shape functions of a cube of 8³ nodes, the largest element, have 14 along a direction.
pub const MOST_POINTS: usize = 32;

impl Quadrature {
    /// A rule that is exact for polynomials up to `degree` on the cell, or up to the degree that 32 points per direction reach.
    ///
    /// On boxes it is a product of Gauss–Legendre rules. On simplices it is the centroid (degree 1), the rule of d + 1
    /// points of degree 2 (Hammer and Stroud 1956), or the conical product rule (Stroud 1971). The rules of the other
    /// cells are composed of these.
    pub fn of_degree(cell: Cell, degree: usize) -> Quadrature {
        match cell {
            Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron => {
                // n points are exact to the degree 2 n − 1.
                Quadrature::gauss_legendre(cell.dimension(), degree / 2 + 1)
            }
            Cell::Triangle | Cell::Tetrahedron => match degree {
                0 | 1 => Quadrature::centroid(cell),
                2 => Quadrature::hammer_stroud(cell),
                _ => Quadrature::conical(cell.dimension(), degree),
            },
            Cell::Pentagon => Quadrature::fan(cell, degree),
            Cell::Wedge => Quadrature::of_degree(Cell::Triangle, degree).times_interval(degree),
            Cell::Pyramid => Quadrature::pyramid(degree),
        }
    }

    /// The rule of the triangle on each triangle between the origin and two neighbouring corners.
    fn fan(cell: Cell, degree: usize) -> Quadrature {
        let local = Quadrature::of_degree(Cell::Triangle, degree);
        let mut rule = Quadrature { dimension: 2, points: Vec::new(), weights: Vec::new() };
        let corners = cell.corners();
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            for (s, w) in local.points.chunks_exact(2).zip(&local.weights) {
                rule.points.extend((0..2).map(|k| s[0] * a[k] + s[1] * b[k]));
                // The triangle of the reference has the area ½, and the determinant is twice that of this one.
                rule.weights.push(w * (a[0] * b[1] - a[1] * b[0]));
            }
        }
        rule
    }

    /// The points of a plane rule at each Gauss–Legendre point of the third coordinate.
    fn times_interval(self, degree: usize) -> Quadrature {
        let line = Quadrature::gauss_legendre(1, degree / 2 + 1);
        let mut rule = Quadrature { dimension: self.dimension + 1, points: Vec::new(), weights: Vec::new() };
        for (z, wz) in line.points.iter().zip(&line.weights) {
            for (at, w) in self.points.chunks_exact(self.dimension).zip(&self.weights) {
                rule.points.extend(at.iter().chain([z]));
                rule.weights.push(w * wz);
            }
        }
        rule
    }

    /// The rule of the square in each plane of constant ζ, scaled by 1 − ζ. The area of the section adds two to the
    /// degree along ζ.
    fn pyramid(degree: usize) -> Quadrature {
        let square = Quadrature::gauss_legendre(2, degree / 2 + 1);
        // The area of the section falls with the square of the height, which adds two to the degree along it.
        let line = Quadrature::gauss_legendre(1, (degree + 2) / 2 + 1);
        let mut rule = Quadrature { dimension: 3, points: Vec::new(), weights: Vec::new() };
        for (s, ws) in line.points.iter().zip(&line.weights) {
            let (z, scale) = ((1.0 + s) / 2.0, (1.0 - s) / 2.0);
            for (at, w) in square.points.chunks_exact(2).zip(&square.weights) {
                // The section at height z is the square scaled by `1 − z`.
                rule.points.extend([scale * at[0], scale * at[1], z]);
                rule.weights.push(w * ws / 2.0 * scale * scale);
            }
        }
        rule
    }

    /// The integrals of the coordinates, `Σ_q w_q ξ_q`, `[dimension]`.
    pub fn moments(&self) -> Vec<f64> {
        let of = |k: usize| {
            let along = self.points.iter().skip(k).step_by(self.dimension);
            along.zip(&self.weights).map(|(x, w)| w * x).sum()
        };
        (0..self.dimension).map(of).collect()
    }

    /// The product rule with `points` Gauss–Legendre points per direction on [−1, 1]^dimension.
    pub fn gauss_legendre(dimension: usize, points: usize) -> Quadrature {
        let line: Vec<(f64, f64)> = GaussLegendre::new(one_to_most(points)).iter().map(|(x, w)| (*x, *w)).collect();
        product(&vec![line; dimension], |s| s.to_vec())
    }

    fn centroid(cell: Cell) -> Quadrature {
        let d = cell.dimension();
        Quadrature { dimension: d, points: vec![1.0 / (d + 1) as f64; d], weights: vec![cell.content()] }
    }

    /// Points with the barycentric coordinates (a, b, …, b), b = (d + 2 − √(d + 2))/((d + 1)(d + 2)), and equal
    /// weights.
    fn hammer_stroud(cell: Cell) -> Quadrature {
        let d = cell.dimension();
        let e = (d + 2) as f64;
        let b = (e - e.sqrt()) / ((d + 1) as f64 * e);
        let a = 1.0 - d as f64 * b;
        let points = (0..=d).flat_map(|corner| (0..d).map(move |i| if i + 1 == corner { a } else { b })).collect();
        Quadrature { dimension: d, points, weights: vec![cell.content() / (d + 1) as f64; d + 1] }
    }

    /// Gauss–Legendre points in collapsed coordinates: the cube is compressed towards one corner of the simplex. The
    /// Jacobian `(1 − s)^(d−1−k)` of each coordinate adds to the degree that the rule along this coordinate must
    /// integrate.
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

/// All combinations of the points of the lines, the first coordinate fastest, mapped by `place`.
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
