//! Cells of the same shape: what is costly to fit is fitted once for all of them.

use super::visit::each_cell;
use crate::element::Element;
use crate::error::Result;
use crate::springs::distance;
use std::collections::HashMap;

/// Lengths that differ by less than this fraction count as equal; boxes have rounding of about 1e-14.
const EQUAL: f64 = 1e-12;

/// Cells grouped by the distances of their nodes, which are equal for cells that a rigid motion or a mirror takes into each
/// other, and those have the same constants.
pub struct Congruence {
    /// One cell of each shape.
    pub representatives: Vec<usize>,
    /// The shape of each cell, as an index into `representatives`.
    pub shapes: Vec<usize>,
}

impl Congruence {
    /// # Errors
    /// A cell is reversed, tangled or flat.
    pub fn of(element: &Element, points: &[f64], connectivity: &[usize]) -> Result<Congruence> {
        let d = element.dimension();
        Congruence::by(element, points, connectivity, |x| {
            let nodes: Vec<&[f64]> = x.chunks_exact(d).collect();
            let pairs = (0..nodes.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
            pairs.map(|(a, b)| distance(nodes[a], nodes[b])).collect()
        })
    }

    /// Of cells that a translation alone takes into each other: turned ones count as others.
    ///
    /// # Errors
    /// A cell is reversed, tangled or flat.
    pub fn by_translation(element: &Element, points: &[f64], connectivity: &[usize]) -> Result<Congruence> {
        let d = element.dimension();
        Congruence::by(element, points, connectivity, |x| (d..x.len()).map(|i| x[i] - x[i % d]).collect())
    }

    /// `lengths` of the node positions are what cells of one shape have in common.
    fn by(
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        lengths: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Congruence> {
        let mut congruence = Congruence { representatives: Vec::new(), shapes: Vec::new() };
        let mut known: HashMap<Vec<i64>, usize> = HashMap::new();
        let mut unit = 0.0;
        each_cell(element, points, connectivity, 0, |cell, x, _| {
            let lengths = lengths(x);
            if unit == 0.0 {
                unit = EQUAL * lengths.iter().fold(0.0, |a, length| length.abs().max(a));
            }
            let key = lengths.iter().map(|length| (length / unit).round() as i64).collect();
            let shape = *known.entry(key).or_insert_with(|| {
                congruence.representatives.push(cell);
                congruence.representatives.len() - 1
            });
            congruence.shapes.push(shape);
        })?;
        Ok(congruence)
    }
}
