//! Shape functions and their gradients as numbers, at the points of a quadrature rule.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::modes::Modes;
use super::quadrature::Quadrature;
use crate::symbolic::{Expr, Program};

/// The numbers by which kernels know an element: `N_a(ξ_q)`, `∂N_a/∂ξ_k(ξ_q)` and `w_q`.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulation<C = f64> {
    /// The number of nodes.
    pub nodes: usize,
    /// The number of reference coordinates.
    pub dimension: usize,
    /// The number of coordinates of a node; more than the dimension for a cell of a surface or curve.
    pub space: usize,
    /// The weights w_q, `[points]`.
    pub weights: Vec<C>,
    /// Weights of the term λ (div u)², `[points]`; empty if they are equal to `weights`. A point that serves only one
    /// of the two terms has a weight of zero in the other.
    pub volumetric: Vec<C>,
    /// The values `N_a(ξ_q)`, `[points × nodes]`.
    pub values: Vec<C>,
    /// The gradients `∂N_a/∂ξ_k(ξ_q)`, `[points × nodes × dimension]`.
    pub gradients: Vec<C>,
    /// The functions that are condensed, if the element has any.
    pub modes: Option<Box<Modes<C>>>,
}

impl Tabulation {
    /// The table at the points of `rule`, and of `volumetric` if the term λ (div u)² has a rule of its own.
    pub fn new(functions: &ShapeFunctions, rule: &Quadrature, volumetric: Option<&Quadrature>) -> Tabulation {
        let mut table = Tabulation {
            nodes: functions.values.len(),
            dimension: rule.dimension,
            space: rule.dimension,
            weights: rule.weights.clone(),
            volumetric: Vec::new(),
            values: Vec::new(),
            gradients: Vec::new(),
            modes: None,
        };
        if let Some(other) = volumetric {
            // Each rule has the weight zero at the points of the other, so that one loop over all points serves both.
            table.volumetric = vec![0.0; rule.weights.len()];
            table.volumetric.extend(&other.weights);
            table.weights.extend(vec![0.0; other.weights.len()]);
        }
        let points = rule.points.iter().chain(volumetric.iter().flat_map(|other| &other.points));
        let values: Vec<Program> = functions.values.iter().map(Program::of).collect();
        let gradients: Vec<Program> = functions.gradients.iter().flatten().map(Program::of).collect();
        for point in points.copied().collect::<Vec<f64>>().chunks_exact(rule.dimension) {
            table.values.extend(values.iter().map(|n| n.evaluate(point)));
            table.gradients.extend(gradients.iter().map(|dn| dn.evaluate(point)));
        }
        table
    }

    /// Replaces the derivatives along the reference coordinates of the cell by those along the tangents of a side:
    /// `∂N_a/∂s_k = Σ_l ∂N_a/∂ξ_l tangent_k,l`.
    pub fn along(self, tangents: &[Vec<f64>]) -> Tabulation {
        let gradients = self
            .gradients
            .chunks_exact(self.dimension)
            .flat_map(|g| tangents.iter().map(move |t| g.iter().zip(t).map(|(a, b)| a * b).sum()))
            .collect();
        Tabulation { gradients, dimension: tangents.len(), modes: None, ..self }
    }
}

impl<C> Tabulation<C> {
    /// Converts the table to another kind of number.
    pub fn map<D>(&self, convert: impl Fn(&C) -> D) -> Tabulation<D> {
        let all = |values: &[C]| values.iter().map(&convert).collect();
        Tabulation {
            nodes: self.nodes,
            dimension: self.dimension,
            space: self.space,
            weights: all(&self.weights),
            volumetric: all(&self.volumetric),
            values: all(&self.values),
            gradients: all(&self.gradients),
            modes: self.modes.as_ref().map(|modes| Box::new(modes.map(&convert))),
        }
    }

    /// The number of quadrature points.
    pub fn points(&self) -> usize {
        self.weights.len()
    }
}

impl Tabulation {
    /// The weight of point q, or, if that is zero, its weight in the term λ (div u)².
    pub fn point_weight(&self, q: usize) -> f64 {
        match (self.weights[q], self.volumetric.get(q)) {
            (0.0, Some(volumetric)) => *volumetric,
            (weight, _) => weight,
        }
    }
}

/// Shape functions and their symbolic gradients.
#[derive(Debug, Clone)]
pub struct ShapeFunctions {
    /// The shape functions `N_a`, `[nodes]`.
    pub values: Vec<Expr>,
    /// The gradients `∂N_a/∂ξ_k`, `[nodes][dimension]`.
    pub gradients: Vec<Vec<Expr>>,
}

impl ShapeFunctions {
    /// Shape functions in `dimension` coordinates, with their gradients.
    pub fn new(values: Vec<Expr>, dimension: usize) -> ShapeFunctions {
        let gradients = values.iter().map(|n| (0..dimension).map(|k| n.derivative(k)).collect()).collect();
        ShapeFunctions { values, gradients }
    }

    /// The number of numbers, variables and operations of all of them.
    pub(super) fn parts(&self) -> usize {
        self.values.iter().chain(self.gradients.iter().flatten()).map(Expr::parts).sum()
    }
}
