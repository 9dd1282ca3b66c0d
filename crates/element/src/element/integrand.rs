//! Tables of shape functions for loads and masses. The degree of the integrand determines their quadrature, whatever
//! the rule of the stiffness is.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::cell::Cell;
use super::quadrature::Quadrature;
use super::{Element, Side, SideTable, Tabulation};
use crate::symbolic::Polynomial;

/// What is integrated over a cell or over its sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrand {
    /// `N_a b`, with b a polynomial of this degree in the position x.
    Load(usize),
    /// `N_a N_b`.
    Mass,
}

/// For functions that are not polynomials: an integral is accepted if a rule of higher degree changes it by at most
/// this share of the content of the cell. It is a few hundred rounding errors.
const SETTLED: f64 = 1e-13;
/// The difference of the degrees of these two rules. A rule that is not enough differs from one with so many more
/// degrees, whereas the next rule may share its error.
const FURTHER: usize = 6;
/// The largest order that is tried, by dimension: the rule of more degrees has 32 points per direction in the plane,
/// the most of any rule, and 15 in space.
const MOST_ORDER: [usize; 3] = [28, 28, 11];

/// The degree of the Jacobian determinant of functions of degree p: in each coordinate of boxes and pyramids, in all together of others.
fn jacobian_degree(cell: Cell, p: usize) -> usize {
    let d = cell.dimension();
    match cell {
        Cell::Interval => p - 1,
        Cell::Quadrilateral | Cell::Hexahedron | Cell::Pyramid => d * p - 1,
        Cell::Triangle | Cell::Tetrahedron | Cell::Wedge | Cell::Pentagon => d * (p - 1),
    }
}

impl Element {
    /// The shape functions at the points of a rule that integrates the integrand and its Jacobian.
    ///
    /// The integral is exact over every isoparametric cell if the shape functions are polynomials in the reference
    /// coordinates (for a pyramid, in the collapsed coordinates), and accurate to rounding if they are smooth. With m
    /// the degree of the load and p the order of the element, the degree of the rule is
    ///
    /// - on boxes and pyramids, in each coordinate: `p + m p + d p − 1` for loads, `2 p + d p − 1` for masses;
    /// - on other cells, in all coordinates together: `p + m p + d (p − 1)` for loads, `2 p + d (p − 1)` for masses.
    ///
    /// The term m p is the degree of the load in the reference coordinates, and d p − 1 or d (p − 1) is that of the
    /// Jacobian determinant.
    pub fn integration_table(&self, integrand: Integrand) -> Tabulation {
        let degree = self.degree_of(self.cell, integrand);
        Tabulation::new(&self.functions, &Quadrature::of_degree(self.cell, degree), None)
    }

    /// Tables as those of [`Element::integration_table`], for integrals along each side, in the order of
    /// [`Element::sides`]. Each holds the nodes of its side only.
    pub fn side_integration_tables(&self, integrand: Integrand) -> Vec<Tabulation> {
        let sides = self.cell.sides().iter().zip(self.sides());
        let table = |(side, known): (&Side, &SideTable)| {
            let degree = self.degree_of(side.cell, integrand).max(2 * self.degree());
            self.side_tabulation(side, &known.nodes, degree)
        };
        sides.map(table).collect()
    }

    fn degree_of(&self, region: Cell, integrand: Integrand) -> usize {
        let p = self.order();
        let factor = match integrand {
            Integrand::Load(m) => p.saturating_mul(m),
            Integrand::Mass => p,
        };
        // The degree of a load comes from a file; a sum beyond all rules is cut by the rule.
        p.saturating_add(factor).saturating_add(jacobian_degree(region, p))
    }

    /// The degree of det J along each direction of a box that is mapped to the cell.
    pub(super) fn jacobian_degree(&self) -> usize {
        jacobian_degree(self.cell, self.order())
    }

    /// The degree of the shape functions: in each coordinate on a box, in all together otherwise. For functions that
    /// are not polynomials, half the least degree whose rule integrates `∫ N_a dV` and `∫ N_a² dV` to rounding.
    fn order(&self) -> usize {
        *self.order.get_or_init(|| self.polynomial_order().unwrap_or_else(|| self.settled_order()).max(1))
    }

    fn polynomial_order(&self) -> Option<usize> {
        let d = self.dimension();
        let order = |n| {
            let polynomial = Polynomial::expand(n, d)?;
            let along = (0..d).map(|k| polynomial.degree_in(k)).max().unwrap_or(0);
            Some(if self.cell.is_box() { along } else { polynomial.degree() } as usize)
        };
        let orders: Option<Vec<usize>> = self.functions.values.iter().map(order).collect();
        orders?.into_iter().max()
    }

    fn settled_order(&self) -> usize {
        let most = MOST_ORDER[self.dimension() - 1];
        let changed = |order: &usize| {
            let (now, further) = (self.moments(2 * order), self.moments(2 * order + FURTHER));
            let change = now.iter().zip(&further).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The comparison is negated so that moments that are not numbers count as changed.
            !(change <= SETTLED * self.cell.content())
        };
        (1..most).find(|order| !changed(order)).unwrap_or(most)
    }

    /// `∫ N_a dV` and `∫ N_a² dV` over the reference cell, by the rule of this degree.
    fn moments(&self, degree: usize) -> Vec<f64> {
        let table = Tabulation::new(&self.functions, &Quadrature::of_degree(self.cell, degree), None);
        let mut moments = vec![0.0; 2 * table.nodes];
        for (values, w) in table.values.chunks_exact(table.nodes).zip(&table.weights) {
            for (moments, n) in moments.chunks_exact_mut(2).zip(values) {
                moments[0] += w * n;
                moments[1] += w * n * n;
            }
        }
        moments
    }
}
