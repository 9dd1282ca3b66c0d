//! The content of a patch: a weighted sum of the contents of the cells around a node.

use super::content::Content;
use crate::element::Element;
use crate::stiffness::gather;
use crate::symbolic::Jet;
use std::sync::Arc;

/// The content `Σ_c share_c V_c` of cells of one element, in m² or m³.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The element of all cells.
    pub element: Arc<Element>,
    /// The nodes of each cell, as indices into the points of the patch, and the share of the cell.
    pub cells: Vec<(Vec<usize>, f64)>,
}

impl Patch {
    pub(super) fn value(&self, x: &[f64], dimension: usize) -> f64 {
        let mut total = 0.0;
        self.each_cell(x, dimension, |_, share, content| total += share * content.value());
        total
    }

    pub(super) fn gradient(&self, x: &[f64], dimension: usize) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        self.each_cell(x, dimension, |nodes, share, content| {
            for (&place, own) in nodes.iter().zip(content.gradient().chunks_exact(dimension)) {
                let sums = &mut gradient[place * dimension..(place + 1) * dimension];
                sums.iter_mut().zip(own).for_each(|(sum, g)| *sum += share * g);
            }
        });
        gradient
    }

    pub(super) fn jet(&self, x: &[f64], dimension: usize) -> Jet {
        let mut jet = Jet { value: 0.0, gradient: vec![0.0; x.len()], hessian: vec![0.0; x.len() * x.len()] };
        self.each_cell(x, dimension, |nodes, share, content| {
            let own = content.jet();
            jet.value += share * own.value;
            let dofs: Vec<usize> = nodes.iter().flat_map(|a| a * dimension..(a + 1) * dimension).collect();
            for (&row, (g, bends)) in dofs.iter().zip(own.gradient.iter().zip(own.hessian.chunks_exact(dofs.len()))) {
                jet.gradient[row] += share * g;
                for (&column, bend) in dofs.iter().zip(bends) {
                    jet.hessian[row * x.len() + column] += share * bend;
                }
            }
        });
        jet
    }

    fn each_cell(&self, x: &[f64], dimension: usize, mut visit: impl FnMut(&[usize], f64, Content)) {
        let mut local = vec![0.0; self.element.nodes() * dimension];
        for (nodes, share) in &self.cells {
            gather(x, dimension, nodes, &mut local);
            visit(nodes, *share, Content::of_cell(&self.element.tabulation, &local));
        }
    }
}
