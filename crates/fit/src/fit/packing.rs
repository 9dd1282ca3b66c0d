//! The nodes of several cells side by side, one cell per lane.

use crate::element::Element;
use crate::scalar::{Packed, of_dimension};
use crate::stiffness::{Fault, Placement};

/// Memory for the nodes of as many cells as there are lanes.
pub struct Packing<'a, T> {
    element: &'a Element,
    /// The positions of all points, `[points × space]`, m.
    pub points: &'a [f64],
    placement: Placement,
    /// The positions of the nodes relative to the first of each cell, see [`Placement`], `[nodes × dimension]`, m.
    pub x: Vec<T>,
}

impl<'a, T: Packed> Packing<'a, T> {
    pub fn new(zero: &T, element: &'a Element, points: &'a [f64]) -> Packing<'a, T> {
        let x = vec![zero.clone(); element.nodes() * element.dimension()];
        Packing { element, points, placement: Placement::new(&element.tabulation), x }
    }

    /// Fills [`Packing::x`] with these cells, at most one per lane; lanes without a cell repeat the first. False if a
    /// cell of a surface or curve has no tangents.
    pub fn gather(&mut self, nodes: &[usize]) -> bool {
        if self.element.space() > self.element.dimension() {
            return self.lay_out(nodes);
        }
        of_dimension!(self.element.dimension(), |D| self.gather_in::<D>(nodes));
        true
    }

    /// The positions of a single cell.
    ///
    /// # Errors
    /// A cell of a surface or curve has no tangents.
    pub fn place(&mut self, nodes: &[usize], x: &mut [f64]) -> Result<(), Fault> {
        self.placement.place(&self.element.tabulation, self.points, nodes, x)
    }

    /// The positions of the cell in this lane.
    pub fn lane(&self, lane: usize) -> Vec<f64> {
        self.x.iter().map(|x| x.as_slice()[lane]).collect()
    }

    /// The positions of cells of surfaces and curves, in their own planes and lines; false if a cell has no tangents.
    fn lay_out(&mut self, nodes: &[usize]) -> bool {
        let n = self.element.nodes();
        let mut x = vec![0.0; self.x.len()];
        for lane in 0..T::COUNT {
            // A lane without a cell repeats the first one, whose numbers are finite and are not read.
            let cell = if lane * n < nodes.len() { &nodes[lane * n..(lane + 1) * n] } else { &nodes[..n] };
            if self.place(cell, &mut x).is_err() {
                return false;
            }
            self.x.iter_mut().zip(&x).for_each(|(lanes, x)| lanes.as_mut_slice()[lane] = *x);
        }
        true
    }

    fn gather_in<const D: usize>(&mut self, nodes: &[usize]) {
        let n = self.x.len() / D;
        let points = self.points.as_chunks::<D>().0;
        let x = &mut self.x.as_chunks_mut::<D>().0[..n];
        for lane in 0..T::COUNT {
            let cell = if lane * n < nodes.len() { &nodes[lane * n..(lane + 1) * n] } else { &nodes[..n] };
            let first = &points[cell[0]];
            for (x, &node) in x.iter_mut().zip(cell) {
                let point = &points[node];
                for k in 0..D {
                    // Differences of nearby doubles are exact (Sterbenz 1974): a body far from the origin has the same constants.
                    x[k].as_mut_slice()[lane] = point[k] - first[k];
                }
            }
        }
    }
}

/// A number with these values in its first lanes, and with zeros in the others.
#[inline(always)]
pub fn packed<T: Packed>(zero: &T, count: usize, value: impl Fn(usize) -> f64) -> T {
    let mut lanes = zero.clone();
    lanes.as_mut_slice()[..count].iter_mut().enumerate().for_each(|(lane, number)| *number = value(lane));
    lanes
}

/// Writes the numbers of the cell in this lane. Lanes without a cell have those of the first one: zeros would end all lanes as irregular.
pub fn fill<T: Packed>(all: &mut [T], lane: usize, values: &[f64]) {
    let last = if lane == 0 { T::COUNT } else { lane + 1 };
    all.iter_mut().zip(values).for_each(|(lanes, value)| lanes.as_mut_slice()[lane..last].fill(*value));
}
