//! Whether the Jacobian determinant of a curved cell is positive everywhere, and not only at quadrature points.
//!
//! On the unit box, from which each reference cell is a map, det J is a polynomial of the degree that rules of integration count with.
//! In the Bernstein basis it is bounded by its coefficients, and those at the corners of the box are values of it. Where the bounds
//! do not decide, the box is divided (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013).

use super::cell::{Cell, same_place};
use super::quadrature::Quadrature;
use super::{Element, Tabulation};
use nalgebra::DMatrix;
use springfit_numerics::dense::singular;
use std::f64::consts::PI;

/// A determinant below zero by this share of the largest coefficient is negative; less is rounding.
// The inverse of Bernstein's matrix amplifies rounding by its norm in each direction: with degree 8 in space, `230³ ·
// 1.1e-16` is 1.3e-9 at worst.
const ROUNDING: f64 = 1e-9;
/// Boxes of a cell that are looked at, at most. A determinant that touches zero along a surface is never decided.
// A division into halves along each direction is made six times with so many in the plane, 4⁶, and four times in space, 8⁴. Bounds
// are nearer by the square of the size: by a factor of 4 000 in the plane, and of 250 in space.
const MOST_BOXES: usize = 4000;
/// Degrees per direction beyond which bounds are lost in rounding.
// The norm of the inverse is 3 700 at degree 12 and 28 500 at degree 15. Its cube times 1.1e-16 is 5e-6 and 3e-3 then,
// beside which no sign near zero is certain.
const MOST_DEGREE: usize = 16;
/// A node counts as where the straight cell has it, up to this share of the size of the cell.
// A cell that counts as curved although it is straight costs its bounds, and no wrong verdict. One that is bent by less than this
// has a determinant of the straight cell to as many digits.
const STRAIGHT: f64 = 1e-9;

/// The bounds of the Jacobian determinant in the cells of an element.
pub struct JacobianBounds {
    dimension: usize,
    /// Points of interpolation along each direction: the degree of det J and one.
    count: usize,
    /// The gradients of the shape functions at the points of interpolation.
    table: Tabulation,
    /// From values at the points along a direction to Bernstein coefficients, `[count × count]`.
    coefficients: DMatrix<f64>,
    /// The nodes of a straight cell by those of its corners, `[nodes × corners]`.
    straight: DMatrix<f64>,
    /// The node at each corner, `[corners]`.
    corners: Vec<usize>,
}

impl JacobianBounds {
    /// The bounds of an element; `None` if its nodes are its corners alone, so that it is not curved, if it is no body of its own dimension, or if det
    /// J is no polynomial on the box.
    pub fn of(element: &Element) -> Option<JacobianBounds> {
        let d = element.dimension();
        if element.has_corners_alone() || element.space() != d || d < 2 {
            return None;
        }
        let count = element.jacobian_degree() + 1;
        if count > MOST_DEGREE {
            return None;
        }
        let along: Vec<f64> =
            // Chebyshev's points keep the inverse from Bernstein's basis well conditioned.
            (0..count).map(|i| 0.5 - 0.5 * ((2 * i + 1) as f64 * PI / (2 * count) as f64).cos()).collect();
        let places = (0..count.pow(d as u32))
            .map(|point| (0..d).map(|k| along[point / count.pow(k as u32) % count]).collect::<Vec<f64>>());
        let points: Option<Vec<Vec<f64>>> = places.map(|t| on_cell(element.cell, &t)).collect();
        let bernstein = DMatrix::from_fn(count, count, |i, j| basis(count - 1, j, along[i]));
        let (straight, corners) = straight(element)?;
        let bounds = JacobianBounds {
            dimension: d,
            count,
            table: table(element, points?.concat()),
            coefficients: bernstein.try_inverse()?,
            straight,
            corners,
        };
        bounds.is_exact(element).then_some(bounds)
    }

    /// Whether a cell with nodes at x, `[nodes × dimension]`, is curved, and its Jacobian determinant is negative somewhere.
    pub fn folds(&self, x: &[f64]) -> bool {
        // Differences keep the digits of a cell that is far from the origin.
        let d = self.dimension;
        let near: Vec<f64> = x.iter().enumerate().map(|(i, value)| value - x[i % d]).collect();
        self.is_curved(&near) && self.is_negative(self.bernstein(&near))
    }

    /// Whether a node is elsewhere than in the straight cell with the same corners.
    fn is_curved(&self, x: &[f64]) -> bool {
        let d = self.dimension;
        let size = (0..d).map(|k| extent(x.iter().skip(k).step_by(d))).fold(0.0, f64::max);
        (0..self.table.nodes).any(|a| {
            (0..d).any(|k| {
                let own: f64 =
                    self.corners.iter().enumerate().map(|(c, node)| self.straight[(a, c)] * x[node * d + k]).sum();
                // The comparison is negated so that a coordinate that is NaN counts as curved, and is not passed over
                // as straight.
                !((own - x[a * d + k]).abs() <= STRAIGHT * size)
            })
        })
    }

    /// The coefficients of det J, `[count^dimension]`, the first direction fastest.
    fn bernstein(&self, x: &[f64]) -> Vec<f64> {
        let mut values = determinants(&self.table, x);
        for k in 0..self.dimension {
            let before = values.clone();
            each_line(self.count, self.dimension, k, |place| {
                for i in 0..self.count {
                    values[place(i)] = (0..self.count).map(|j| self.coefficients[(i, j)] * before[place(j)]).sum();
                }
            });
        }
        values
    }

    /// Whether the polynomial with these coefficients is shown to be negative somewhere on the box.
    fn is_negative(&self, coefficients: Vec<f64>) -> bool {
        let zero = -ROUNDING * coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        let (n, d) = (self.count, self.dimension);
        let corner = |corner: usize| (0..d).map(|k| (corner >> k & 1) * (n - 1) * n.pow(k as u32)).sum::<usize>();
        let corners: Vec<usize> = (0..1 << d).map(corner).collect();
        let mut boxes = vec![coefficients];
        // What is undecided then counts as positive: a cell is called folded only where that is shown.
        for _ in 0..MOST_BOXES {
            let Some(coefficients) = boxes.pop() else { return false };
            if corners.iter().any(|&corner| coefficients[corner] < zero) {
                return true;
            }
            // The polynomial is a mean of its coefficients with weights above zero, and not below the least of them.
            if coefficients.iter().all(|c| *c >= zero) {
                continue;
            }
            let mut parts = vec![coefficients];
            for k in 0..d {
                parts = parts.into_iter().flat_map(|part| halves(part, n, d, k)).collect();
            }
            boxes.extend(parts);
        }
        false
    }

    /// Whether the coefficients give det J of a bent cell at other points: whether it is a polynomial of the degree.
    fn is_exact(&self, element: &Element) -> bool {
        let (d, n) = (self.dimension, self.count);
        let bent: Vec<f64> =
            element.positions.iter().enumerate().map(|(i, x)| x + 0.1 * (1.0 + 7.0 * i as f64).sin()).collect();
        let coefficients = self.bernstein(&bent);
        let largest = coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        // Places without a pattern, so that a function that is no polynomial of the degree cannot agree at all of them
        // by symmetry.
        // The three starts leave 0.13 to 0.97 between them, and the step 0.31 is no multiple of their differences, so
        // that no place has two equal coordinates.
        [0.13, 0.48, 0.91].iter().all(|start| {
            let t: Vec<f64> = (0..d).map(|k| (start + 0.31 * k as f64) % 0.97).collect();
            let value: f64 = coefficients
                .iter()
                .enumerate()
                .map(|(i, c)| c * (0..d).map(|k| basis(n - 1, i / n.pow(k as u32) % n, t[k])).product::<f64>())
                .sum();
            // A cell without a map from the box has no determinant there. NaN fails every comparison, so that the
            // bounds are refused.
            let own = on_cell(element.cell, &t).map_or(f64::NAN, |at| determinants(&table(element, at), &bent)[0]);
            (value - own).abs() <= 1e-8 * largest
        })
    }
}

/// Where the point t of the unit box is in the cell; edges and faces of the box fall together in a corner or an apex. `None` of a pentagon.
fn on_cell(cell: Cell, t: &[f64]) -> Option<Vec<f64>> {
    let both = |t: f64| 2.0 * t - 1.0;
    Some(match (cell, t) {
        (Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron, t) => t.iter().map(|t| both(*t)).collect(),
        (Cell::Triangle, &[a, b]) => vec![a, b * (1.0 - a)],
        (Cell::Tetrahedron, &[a, b, c]) => vec![a, b * (1.0 - a), c * (1.0 - a) * (1.0 - b)],
        (Cell::Wedge, &[a, b, c]) => vec![a, b * (1.0 - a), both(c)],
        (Cell::Pyramid, &[a, b, c]) => vec![both(a) * (1.0 - c), both(b) * (1.0 - c), c],
        (Cell::Pentagon | Cell::Triangle | Cell::Tetrahedron | Cell::Wedge | Cell::Pyramid, _) => return None,
    })
}

fn table(element: &Element, points: Vec<f64>) -> Tabulation {
    let d = element.dimension();
    let weights = vec![1.0; points.len() / d];
    Tabulation::new(&element.functions, &Quadrature { dimension: d, points, weights }, None)
}

/// `det Σ_a x_a ⊗ ∇N_a` at each point of the table.
fn determinants(table: &Tabulation, x: &[f64]) -> Vec<f64> {
    let d = table.dimension;
    let at = |gradients: &[f64]| {
        let mut j = [[0.0; 3]; 3];
        for (x, g) in x.chunks_exact(d).zip(gradients.chunks_exact(d)) {
            for (row, x) in j.iter_mut().zip(x) {
                row.iter_mut().zip(g).for_each(|(j, g)| *j += x * g);
            }
        }
        match d {
            2 => j[0][0] * j[1][1] - j[0][1] * j[1][0],
            _ => (0..3)
                .map(|k| j[0][k] * (j[1][(k + 1) % 3] * j[2][(k + 2) % 3] - j[1][(k + 2) % 3] * j[2][(k + 1) % 3]))
                .sum(),
        }
    };
    table.gradients.chunks_exact(table.nodes * d).map(at).collect()
}

/// The Bernstein polynomial `C(n, j) tʲ (1 − t)ⁿ⁻ʲ`.
fn basis(n: usize, j: usize, t: f64) -> f64 {
    let choices = (0..j).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64);
    choices * t.powi(j as i32) * (1.0 - t).powi((n - j) as i32)
}

/// Calls `visit` with the places of each line of coefficients along direction k.
fn each_line(n: usize, d: usize, k: usize, mut visit: impl FnMut(&dyn Fn(usize) -> usize)) {
    let step = n.pow(k as u32);
    for start in (0..n.pow(d as u32)).filter(|start| (start / step).is_multiple_of(n)) {
        visit(&|i| start + i * step);
    }
}

/// The coefficients on both halves of the box along direction k: de Casteljau's rule.
fn halves(coefficients: Vec<f64>, n: usize, d: usize, k: usize) -> [Vec<f64>; 2] {
    let (mut low, mut high) = (coefficients.clone(), coefficients);
    each_line(n, d, k, |place| {
        // Means never exceed what they are means of, so that a division amplifies no rounding, however often a box is
        // divided.
        for round in 1..n {
            for i in 0..n - round {
                high[place(i)] = 0.5 * (high[place(i)] + high[place(i + 1)]);
            }
            // The first entries of the rounds are the coefficients of the lower half, the last round is the upper one.
            low[place(round)] = high[place(0)];
        }
    });
    [low, high]
}

/// The nodes of a straight cell by its corners: the map is of the terms that a straight cell has, as near as those are to its corners. And the nodes
/// at the corners; `None` where a corner has none.
fn straight(element: &Element) -> Option<(DMatrix<f64>, Vec<usize>)> {
    let d = element.dimension();
    let places: Vec<&[f64]> = element.positions.chunks_exact(d).collect();
    let terms = |at: &[f64]| -> Vec<f64> {
        let product = |powers: &&[i32]| at.iter().zip(*powers).map(|(x, power)| x.powi(*power)).product::<f64>();
        std::iter::once(1.0)
            .chain(at.iter().copied())
            .chain(element.cell.straight_terms().iter().map(product))
            .collect()
    };
    let matrix = |places: &[&[f64]]| {
        let rows: Vec<Vec<f64>> = places.iter().map(|at| terms(at)).collect();
        DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
    };
    let corners = element.cell.corners();
    let node = |corner: &&[f64]| places.iter().position(|at| same_place(corner, at));
    let nodes: Option<Vec<usize>> = corners.iter().map(node).collect();
    // Singular values below this are zeros: terms that the corners cannot tell apart.
    let inverse = singular(matrix(corners))?.pseudo_inverse(1e-12);
    Some((matrix(&places) * inverse, nodes?))
}

fn extent<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (least, largest) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, largest), x| (least.min(*x), largest.max(*x)));
    largest - least
}
