//! Reads and proves the functions that are condensed.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::cell::Cell;
use super::constant::Constant;
use super::definition::{Definition, NodeEntry};
use super::modes::Modes;
use super::quadrature::Quadrature;
use super::{ShapeFunctions, Tabulation};
use crate::error::{Error, Result};
use crate::number::first_not_finite;
use crate::symbolic::Expr;
use nalgebra::DMatrix;

/// Values of functions of size one below this are zero: some thousand rounding errors.
const ROUNDING: f64 = 1e-12;
/// The degree of the rule at whose points a function is looked at along a side. Its points are many enough that a mode
/// of the usual degrees does not vanish at all of them by chance.
const ALONG: usize = 7;
/// Modes whose Gram matrix has an eigenvalue below this share of the largest are linearly dependent. A Gram matrix has
/// the squares of the singular values, of which rounding leaves 1e-16.
const DEPENDENT: f64 = 1e-10;

/// Takes the condensed functions, which come after the nodes and have no place, out of the nodes.
pub fn take(definition: &mut Definition) -> Result<Vec<NodeEntry>> {
    let first = definition.nodes.iter().position(|node| node.condense).unwrap_or(definition.nodes.len());
    let modes = definition.nodes.split_off(first);
    for (a, mode) in (first..).zip(&modes) {
        if !mode.condense {
            let expected = "condense = true, for the nodes come before the functions that are condensed";
            return Err(Error::expected(format!("nodes[{a}]"), expected, "a node"));
        }
        if !mode.at.is_empty() {
            let expected = "no place, for a function that is condensed belongs to no node of a mesh";
            return Err(Error::expected(format!("nodes[{a}].at"), expected, format!("{} coordinates", mode.at.len())));
        }
    }
    Ok(modes)
}

/// Proves the modes, and tabulates them at the points of the rules of `table`.
///
/// A mode vanishes at all nodes, so that displacements of nodes stay those of the nodes. Its gradient has the mean zero by each rule, so that
/// it answers no uniform stress: then the patch test is passed.
///
/// # Errors
/// A mode does not have these properties, or the modes are linearly dependent.
pub fn tabulate(
    definition: &Definition,
    modes: Vec<Expr>,
    functions: &ShapeFunctions,
    table: &Tabulation,
    (rule, volumetric): (&Quadrature, Option<&Quadrature>),
) -> Result<Option<Box<Modes>>> {
    if modes.is_empty() {
        return Ok(None);
    }
    let (cell, d, nodes) = (definition.cell, definition.cell.dimension(), definition.nodes.len());
    let key = |j: usize| format!("nodes[{}].shape", nodes + j);
    for (j, mode) in modes.iter().enumerate() {
        for (b, node) in definition.nodes.iter().enumerate() {
            let at: Vec<f64> = node.at.iter().map(Constant::value).collect();
            let value = mode.evaluate(&at);
            // The comparison is negated so that a mode without a value at a node is refused.
            if !(value.abs() <= ROUNDING) {
                return Err(Error::expected(key(j), format!("zero at nodes[{b}], as condensed functions are"), value));
            }
        }
    }
    let bubbles = modes.iter().map(|mode| vanishes_on_sides(cell, mode)).collect();
    let own = Tabulation::new(&ShapeFunctions::new(modes, d), rule, volumetric);
    let count = own.nodes;
    if let Some(bad) = first_not_finite(&own.gradients) {
        return Err(Error::at(key(bad / d % count), "has no finite gradient at a quadrature point"));
    }
    // Either rule must pass the patch test by itself, because each integrates a part of the energy.
    for weights in [&table.weights, &table.volumetric].into_iter().filter(|weights| !weights.is_empty()) {
        for (j, k) in (0..count).flat_map(|j| (0..d).map(move |k| (j, k))) {
            let terms = weights.iter().zip(own.gradients.chunks_exact(count * d)).map(|(w, g)| w * g[j * d + k]);
            let mean: f64 = terms.sum::<f64>() / cell.content();
            if !(mean.abs() <= ROUNDING) {
                let expected = "a function whose gradient has the mean zero by the quadrature, or the patch test fails";
                return Err(Error::expected(key(j), expected, format!("{mean} along {}", definition.coordinates[k])));
            }
        }
    }
    let mut gram = DMatrix::<f64>::zeros(count, count);
    for (q, g) in own.gradients.chunks_exact(count * d).enumerate() {
        let rows = DMatrix::from_row_slice(count, d, g);
        // Points of the volumetric rule alone count with their weight there, so that a mode that only they see is not
        // taken for none.
        gram += table.point_weight(q) * &rows * rows.transpose();
    }
    let eigenvalues = gram.symmetric_eigenvalues();
    if !(eigenvalues.min() > DEPENDENT * eigenvalues.max()) {
        let expected = "condensed functions whose gradients are linearly independent at the quadrature points";
        return Err(Error::expected("nodes", expected, "dependent ones"));
    }
    let centre = cell.centre();
    // Modes that jump have the Jacobian of the centre, where all shape functions must have gradients.
    let centre: Vec<f64> = functions.gradients.iter().flatten().map(|dn| dn.evaluate(&centre)).collect();
    if centre.iter().any(|dn| !dn.is_finite()) {
        return Err(Error::expected("nodes", "shape functions with gradients at the centre of the cell", "none"));
    }
    Ok(Some(Box::new(Modes { gradients: own.gradients, bubbles, centre })))
}

fn vanishes_on_sides(cell: Cell, mode: &Expr) -> bool {
    let d = cell.dimension();
    // The sides of a line are its ends.
    if d == 1 {
        return cell.corners().iter().all(|corner| mode.evaluate(corner).abs() <= ROUNDING);
    }
    cell.sides().iter().all(|side| {
        let (origin, tangents) = side.embedding(cell);
        Quadrature::of_degree(side.cell, ALONG).points.chunks_exact(d - 1).all(|s| {
            let along = |l: usize| origin[l] + s.iter().zip(&tangents).map(|(s, t)| s * t[l]).sum::<f64>();
            mode.evaluate(&(0..d).map(along).collect::<Vec<_>>()).abs() <= ROUNDING
        })
    })
}
