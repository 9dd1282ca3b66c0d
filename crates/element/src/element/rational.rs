//! Quadrature and shape functions in exact rational numbers, for closed forms.

use super::cell::Cell;
use super::{Element, Tabulation};
use crate::symbolic::Polynomial;
use num_rational::BigRational;
use num_traits::{One, Zero};

fn ratio(above: i64, below: i64) -> BigRational {
    BigRational::new(above.into(), below.into())
}

/// The points and weights of a rule in one coordinate.
type Line = Vec<(BigRational, BigRational)>;
/// The points and weights of a rule on a cell.
type Rule = Vec<(Vec<BigRational>, BigRational)>;

impl Element {
    /// The element's tabulation at rational points that integrate its stiffness exactly on a cell with constant
    /// Jacobian. It gives the same matrix as the element's own rule if that is exact there. `None` if a node or a value
    /// is not rational.
    pub fn rational_tabulation(&self) -> Option<Tabulation<BigRational>> {
        let d = self.dimension();
        let exponent = |n, k| Polynomial::expand(n, d).map_or(3, |p| p.degree_in(k) as usize);
        let total = self.functions.values.iter().map(|n| Polynomial::expand(n, d).map_or(3, |p| p.degree() as usize));
        let along = |k: usize| self.functions.values.iter().map(|n| exponent(n, k)).max().unwrap_or(1);
        let degrees: Vec<usize> = (0..d).map(|k| 2 * along(k)).collect();
        let rule = rule(self.cell, &degrees, 2 * total.max().unwrap_or(1))?;
        let mut table = Tabulation {
            nodes: self.nodes(),
            dimension: d,
            space: d,
            weights: Vec::new(),
            volumetric: Vec::new(),
            values: Vec::new(),
            gradients: Vec::new(),
            modes: None,
        };
        for (point, weight) in rule {
            table.weights.push(weight);
            for n in &self.functions.values {
                table.values.push(n.value(&point)?);
            }
            for dn in self.functions.gradients.iter().flatten() {
                table.gradients.push(dn.value(&point)?);
            }
        }
        Some(table)
    }
}

/// A rule that is exact for polynomials of these degrees along the coordinates of a box, or of the degree `total` on a
/// simplex.
fn rule(cell: Cell, degrees: &[usize], total: usize) -> Option<Rule> {
    let d = degrees.len();
    let corner = |from: &[Line]| -> Rule { products(from).into_iter().map(|(s, w)| collapse(s, w)).collect() };
    // The Jacobian of the collapsed coordinates adds to the degree.
    let collapsed = |d: usize| -> Vec<Line> { (0..d).map(|k| line(total + d - 1 - k, true)).collect() };
    match cell {
        Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron => {
            Some(products(&degrees.iter().map(|n| line(*n, false)).collect::<Vec<_>>()))
        }
        Cell::Triangle | Cell::Tetrahedron => Some(corner(&collapsed(d))),
        Cell::Wedge => {
            let upright = line(degrees[2], false);
            let raise = |(at, w): (Vec<BigRational>, BigRational)| {
                let points = upright.iter().map(move |(z, v)| ([&at[..], std::slice::from_ref(z)].concat(), &w * v));
                points.collect::<Vec<_>>()
            };
            Some(corner(&collapsed(2)).into_iter().flat_map(raise).collect())
        }
        // In the coordinates ξ = (1 − ζ) u, η = (1 − ζ) v the shape functions of the pyramid are polynomials.
        Cell::Pyramid => {
            let lines = [line(degrees[0], false), line(degrees[1], false), line(degrees[2] + 2, true)];
            let squeeze = |(s, w): (Vec<BigRational>, BigRational)| {
                let left = BigRational::one() - &s[2];
                (vec![&s[0] * &left, &s[1] * &left, s[2].clone()], w * &left * &left)
            };
            Some(products(&lines).into_iter().map(squeeze).collect())
        }
        Cell::Pentagon => None,
    }
}

/// The collapsed coordinates `x₀ = s₀, x₁ = s₁ (1 − s₀), …`.
fn collapse(s: Vec<BigRational>, mut weight: BigRational) -> (Vec<BigRational>, BigRational) {
    let mut left = BigRational::one();
    let mut x = Vec::new();
    for (k, t) in s.iter().enumerate() {
        x.push(t * &left);
        if k > 0 {
            weight *= &left;
        }
        left *= BigRational::one() - t;
    }
    (x, weight)
}

/// Equally spaced inner points of [−1, 1], or of [0, 1], with weights that integrate powers up to `degree` exactly.
fn line(degree: usize, unit: bool) -> Line {
    // Gauss's points are irrational. As many equidistant points as the degree has coefficients have rational weights,
    // whose growth and signs do no harm without rounding.
    let n = degree as i64 + 1;
    let points: Vec<BigRational> =
        (0..n).map(|i| ratio(if unit { 2 * i + 1 } else { 2 * i + 1 - n }, if unit { 2 * n } else { n })).collect();
    let moment = |k: i64| match (unit, k % 2) {
        (true, _) => ratio(1, k + 1),
        (false, 0) => ratio(2, k + 1),
        (false, _) => BigRational::zero(),
    };
    // The Lagrange polynomial of each point, integrated term by term.
    let weight = |i: usize| {
        let mut polynomial = vec![BigRational::one()];
        for (j, x) in points.iter().enumerate().filter(|(j, _)| *j != i) {
            let below = &points[i] - &points[j];
            let mut next = vec![BigRational::zero(); polynomial.len() + 1];
            for (k, c) in polynomial.iter().enumerate() {
                next[k + 1] += c / &below;
                next[k] -= c * x / &below;
            }
            polynomial = next;
        }
        polynomial.iter().enumerate().map(|(k, c)| c * moment(k as i64)).sum()
    };
    (0..points.len()).map(|i| (points[i].clone(), weight(i))).collect()
}

/// All combinations of the points of the lines.
fn products(lines: &[Line]) -> Rule {
    let mut all: Rule = vec![(Vec::new(), BigRational::one())];
    for line in lines {
        let extend = |(at, w): &(Vec<BigRational>, BigRational)| {
            line.iter().map(|(x, v)| ([&at[..], std::slice::from_ref(x)].concat(), w * v)).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(extend).collect();
    }
    all
}
