//! The computations of one cell, written as code: the geometry at its quadrature points by the kernel that computes it, its
//! spring constants, and the response of its network.

mod branch;
mod content;
mod exact;
mod expression;
mod least_squares;
mod moduli;
mod network;
mod plan;
mod published;
mod solve;
mod tolerance;

pub use branch::{branch, relax};
pub use exact::exact;
pub use least_squares::{LeastSquares, least_squares};
pub use moduli::{State, moduli};
pub use network::{energy, forces};
pub use plan::Plan;
pub use published::published;
pub use tolerance::in_single;

use super::code::{Body, Constant, Index, Role, Room, Status, Value};
use crate::element::{Element, Tabulation};
use crate::scalar::Scalar;
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// An entry of a tabulation below this share of the largest is a rounding error of zero. Points of rules are known to a
/// rounding or two, and a term of zero would be a line of code that does nothing.
const ROUNDING: f64 = 4e-16;

/// A cell in a function that is being written.
pub struct Cell<'a> {
    /// The element.
    pub element: &'a Element,
    /// Its springs.
    pub springs: &'a Springs,
    /// Which loops are unrolled.
    pub plan: Plan,
    /// The function.
    pub body: Body,
    /// The positions of the nodes relative to the first, `[nodes × dimension]`.
    pub x: Vec<Value>,
    /// The array of the positions.
    positions: usize,
}

impl<'a> Cell<'a> {
    /// A new function of the positions of the nodes.
    pub fn new(element: &'a Element, springs: &'a Springs, plan: Plan) -> Cell<'a> {
        let body = Body::new();
        let (n, d) = (element.nodes(), element.dimension());
        let positions = body.array("x", n * d, Role::Input);
        let first: Vec<Value> = (0..d).map(|k| body.entry(positions, k)).collect();
        let relative = |i: usize| if i < d { body.number(0.0) } else { &body.entry(positions, i) - &first[i % d] };
        let x = (0..n * d).map(relative).collect();
        Cell { element, springs, plan, x, positions, body }
    }

    /// The number of coordinates.
    pub fn dimension(&self) -> usize {
        self.element.dimension()
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.element.nodes()
    }

    /// The vector `x_j − x_i`.
    pub fn edge(&self, i: &Index, j: &Index) -> Vec<Value> {
        let d = self.dimension();
        let coordinate = |a: &Index, k: usize| match a.number() {
            Some(a) => self.x[a * d + k].clone(),
            None => self.body.entry(self.positions, &(a * d) + k),
        };
        let between = |k| match (i.number(), j.number()) {
            (Some(_), Some(_)) | (None, None) => &coordinate(j, k) - &coordinate(i, k),
            _ => &self.body.entry(self.positions, &(j * d) + k) - &self.body.entry(self.positions, &(i * d) + k),
        };
        (0..d).map(between).collect()
    }

    /// Calls `work(s, i, j)` for every length spring s between the nodes i and j.
    pub fn each_length(&self, mut work: impl FnMut(&Index, &Index, &Index)) {
        let pairs = self.springs.pairs();
        if self.plan.springs {
            return pairs.iter().enumerate().for_each(|(s, [i, j])| work(&s.into(), &(*i).into(), &(*j).into()));
        }
        let ends = self.ends();
        self.body.each(false, 0, pairs.len(), |s| {
            work(s, &self.body.integer(ends, s * 2), &self.body.integer(ends, &(s * 2) + 1))
        });
    }

    /// The table of the nodes of the length springs.
    pub fn ends(&self) -> usize {
        let ends: Vec<usize> = self.springs.pairs().iter().flatten().copied().collect();
        self.body.array("ENDS", ends.len(), Role::Integers(ends))
    }

    /// Calls `work(q, geometry)` for every quadrature point q, with the geometry at that point alone. The function ends
    /// with [`Status::Shape`] if the Jacobian is not safely positive.
    pub fn each_point(&self, mut work: impl FnMut(&Index, &Geometry<Value>)) {
        self.body.fail_with(Status::Shape);
        self.each_table(|q, table| {
            let mut geometry = Geometry::like(&self.x[0], table);
            geometry.update(table, &self.x);
            work(q, &geometry);
        });
    }

    /// Calls `work(q, table)` for every quadrature point q, with the tabulation at that point alone.
    pub fn each_table(&self, mut work: impl FnMut(&Index, &Tabulation<Constant>)) {
        let (table, body) = (&self.element.tabulation, &self.body);
        let (size, points) = (table.nodes * table.dimension, table.points());
        let largest = table.gradients.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let gradients: Vec<f64> =
            table.gradients.iter().map(|g| if g.abs() <= ROUNDING * largest { 0.0 } else { *g }).collect();
        let at = |numbers: &[f64], name: &str, from: &Index, count: usize| -> Vec<Constant> {
            match from.number() {
                _ if count == 0 => Vec::new(),
                Some(from) => numbers[from..from + count].iter().map(|c| Constant::Number(*c)).collect(),
                None => {
                    let array = body.array(name, numbers.len(), Role::Table(numbers.to_vec()));
                    (0..count).map(|i| Constant::Value(body.entry(array, from + i))).collect()
                }
            }
        };
        body.each(self.plan.points, 0, points, |q| {
            let volumetric = if table.volumetric.is_empty() { 0 } else { 1 };
            let one = Tabulation {
                nodes: table.nodes,
                dimension: table.dimension,
                space: table.space,
                weights: at(&table.weights, "WEIGHTS", q, 1),
                volumetric: at(&table.volumetric, "VOLUMETRIC", q, volumetric),
                values: Vec::new(),
                gradients: at(&gradients, "GRADIENTS", &(q * size), size),
                modes: None,
            };
            work(q, &one);
        });
    }

    /// The volumes of a point in the terms of μ and of λ.
    pub fn volumes(&self, geometry: &Geometry<Value>) -> [Value; 2] {
        let volume = geometry.volumes[0].clone();
        [volume.clone(), geometry.volumetric.first().cloned().unwrap_or(volume)]
    }

    /// Ends the function with [`Status::Infinite`] unless the sum of these magnitudes is a number.
    pub fn guard_finite(&self, sum: &Value) {
        self.body.fail_with(Status::Infinite);
        self.body.guard(&sum.like(f64::MAX), sum);
    }
}

/// `Σ_k a_k b_k`.
pub fn dot(a: &[Value], b: &[Value]) -> Value {
    let terms = a.iter().zip(b).skip(1);
    terms.fold(&a[0] * &b[0], |sum, (a, b)| sum.plus_product(a, b))
}

/// `b − a`.
pub fn difference(a: &[Value], b: &[Value]) -> Vec<Value> {
    a.iter().zip(b).map(|(a, b)| b - a).collect()
}
