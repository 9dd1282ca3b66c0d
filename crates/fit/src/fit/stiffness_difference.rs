//! The stiffness R of cells, and what their springs leave of it, `R − K`, with one cell per SIMD lane. Its norms are
//! in `element_errors.rs`.
//!
//! `K = Σ_s (k_s g_s g_sᵀ + T_s ∇∇c_s)`, T the tension at rest. For a length spring with the unit vector n and the length ℓ the blocks of its
//! two nodes are `± (k n nᵀ + T/ℓ (I − n nᵀ))`. The content of a point, of volume v, has `∂²c/∂x_ak ∂x_bl = v (g_ak g_bl − g_al g_bk)`, g the gradients of
//! the shape functions.

use super::cells::CellFits;
use super::packed_hooke::PackedHooke;
use super::packing::{Packing, fill, packed};
use crate::element::Element;
use crate::material::{BlockValues, Hooke};
use crate::scalar::{Packed, difference, dot, of_dimension, vectorized};
use crate::springs::{Force, Measure};
use crate::stiffness::{Fault, Geometry, add_stiffness};
use std::sync::Arc;

/// Memory for as many cells as there are lanes.
pub struct StiffnessDifferences<'a, T> {
    element: &'a Element,
    hooke: PackedHooke<'a, T>,
    fits: &'a CellFits,
    packing: Packing<'a, T>,
    geometry: Geometry<T>,
    /// R; the blocks on and below the diagonal of `[nodes·dimension × nodes·dimension]`, N/m.
    pub stiffness: Vec<T>,
    /// `R − K`, as R.
    pub left: Vec<T>,
    /// The nodes and measures of the springs; empty if none pulls at rest.
    measures: Vec<(Vec<usize>, Measure)>,
    /// Where the parameters of each spring begin among those of a cell.
    places: Vec<usize>,
    /// Gradients of springs that are measured cell by cell, `[springs × nodes·dimension]`.
    gradients: Vec<T>,
    single: (Geometry, Vec<f64>),
}

impl<'a, T: Packed> StiffnessDifferences<'a, T> {
    pub fn new(
        zero: &T,
        element: &'a Element,
        points: &'a [f64],
        hooke: BlockValues<'a, Hooke>,
        fits: &'a CellFits,
    ) -> StiffnessDifferences<'a, T> {
        let size = element.nodes() * element.dimension();
        let measures = match fits.force {
            Force::Linear => Vec::new(),
            _ => fits.springs.measures(&Arc::new(element.clone())),
        };
        let single = fits.springs.functions().len() + fits.springs.areas().len();
        StiffnessDifferences {
            element,
            hooke: PackedHooke::new(zero, element.dimension(), hooke),
            fits,
            packing: Packing::new(zero, element, points),
            geometry: Geometry::like(zero, &element.tabulation),
            stiffness: vec![zero.clone(); size * size],
            left: vec![zero.clone(); size * size],
            measures,
            places: fits.force.places(&fits.springs),
            gradients: vec![zero.clone(); single * size],
            single: (Geometry::new(&element.tabulation), vec![0.0; size]),
        }
    }

    /// Takes the laws of `count` cells from `first` on, as they are numbered in the laws.
    pub fn set_hooke(&mut self, first: usize, count: usize) {
        self.hooke.set(first, count);
    }

    /// Fills in these cells, at most one per lane, of which the first has this number; lanes without a cell repeat the first.
    ///
    /// # Errors
    /// A cell is reversed, tangled or flat; the error gives its place among these.
    pub fn update(&mut self, first: usize, nodes: &[usize]) -> Result<(), (usize, Fault)> {
        let table = &self.element.tabulation;
        if !(self.packing.gather(nodes) && self.geometry.update(table, &self.packing.x)) {
            self.update_singly(nodes)?;
        }
        let count = nodes.len() / self.element.nodes();
        self.measure_singly(count);
        let zero = self.stiffness[0].zero();
        vectorized!(zero, of_dimension!(self.element.dimension(), |D| self.subtract::<D>(first, count)));
        // Springs without tension at rest have no measures, and those of lengths have been taken off in all lanes.
        if self.measures.len() > self.fits.springs.pairs().len() {
            (0..count).for_each(|lane| self.bend_singly(first + lane, lane));
        }
        Ok(())
    }

    /// The geometry of one cell after the other, where one of them is not safely positive.
    fn update_singly(&mut self, nodes: &[usize]) -> Result<(), (usize, Fault)> {
        let table = &self.element.tabulation;
        let (geometry, x) = &mut self.single;
        for (lane, cell) in nodes.chunks_exact(table.nodes).enumerate() {
            let placed = self.packing.place(cell, x);
            placed.and_then(|()| geometry.set(table, x)).map_err(|fault| (lane, fault))?;
            fill(&mut self.packing.x, lane, x);
            fill(&mut self.geometry.gradients, lane, &geometry.gradients);
            fill(&mut self.geometry.volumes, lane, &geometry.volumes);
            fill(&mut self.geometry.volumetric, lane, &geometry.volumetric);
            fill(&mut self.geometry.modes, lane, &geometry.modes);
        }
        Ok(())
    }

    /// The gradients of springs on functions and areas.
    fn measure_singly(&mut self, count: usize) {
        if self.gradients.is_empty() {
            return;
        }
        let springs = &self.fits.springs;
        let size = self.packing.x.len();
        let mut rows = vec![0.0; self.gradients.len()];
        for lane in 0..count {
            let x = self.packing.lane(lane);
            rows.fill(0.0);
            let (functions, areas) = rows.split_at_mut(springs.functions().len() * size);
            springs.function_gradients(&x, functions);
            for (row, table) in areas.chunks_exact_mut(size).zip(springs.areas()) {
                row.copy_from_slice(&Measure::Span(table.clone()).gradient(&x, self.element.dimension()));
            }
            fill(&mut self.gradients, lane, &rows);
        }
    }

    /// The constant of spring s of each of these cells.
    #[inline(always)]
    fn constants(&self, first: usize, count: usize, s: usize) -> T {
        let m = self.fits.springs.len();
        packed(&self.stiffness[0].zero(), count, |lane| self.fits.constants[(first + lane) * m + s])
    }

    /// The tension of spring s with these constants at rest, where it has these measures.
    #[inline(always)]
    fn tensions(&self, first: usize, count: usize, s: usize, constants: &T, rest: &T) -> T {
        let Force::Exact { content } = &self.fits.force else { return self.tensions_singly(first, count, s, rest) };
        let from = self.places[s];
        // Lengths and areas have no rest measure, and no parameter.
        if from == self.places[s + 1] {
            return constants.clone() * rest;
        }
        if content.is_some() {
            return self.tensions_singly(first, count, s, rest);
        }
        let all = self.places[self.fits.springs.len()];
        let slack = packed(&rest.zero(), count, |lane| self.fits.parameters[(first + lane) * all + from]);
        constants.clone() * rest - &slack
    }

    /// [`StiffnessDifferences::tensions`] for any force.
    fn tensions_singly(&self, first: usize, count: usize, s: usize, rest: &T) -> T {
        packed(&rest.zero(), count, |lane| self.tension(first + lane, s, rest.as_slice()[lane]))
    }

    fn tension(&self, cell: usize, s: usize, rest: f64) -> f64 {
        let (springs, m) = (&self.fits.springs, self.fits.springs.len());
        let all = self.places[m];
        let own = &self.fits.parameters[cell * all..][self.places[s]..self.places[s + 1]];
        self.fits.force.tension(springs, s, self.fits.constants[cell * m + s], own, [rest, rest])
    }

    /// R, and what all springs leave of it but the bending of those that are measured singly.
    #[inline(always)]
    fn subtract<const D: usize>(&mut self, first: usize, count: usize) {
        let n = self.element.nodes();
        let size = n * D;
        let zero = self.stiffness[0].zero();
        for entry in self.stiffness.iter_mut() {
            *entry = zero.clone();
        }
        if self.geometry.is_condensed() {
            self.stiffness.clone_from_slice(&self.geometry.entries(&self.hooke.lanes));
        }
        for (grad, v, w) in self.geometry.each_point().filter(|_| !self.geometry.is_condensed()) {
            add_stiffness(&mut self.stiffness, grad.as_chunks::<D>().0, &self.hooke.lanes, v, w);
        }
        self.left.clone_from_slice(&self.stiffness);
        let pulls = !self.measures.is_empty();
        let springs = &self.fits.springs;
        for s in 0..springs.pairs().len() {
            let [i, j] = springs.pairs()[s];
            let (x, k) = (self.packing.x.as_chunks::<D>().0, self.constants(first, count, s));
            let d = difference(&x[j], &x[i]);
            let square = dot(&d, &d);
            let (mut along, mut across) = (k.clone() / &square, zero.clone());
            if pulls {
                let length = square.clone().sqrt();
                across = self.tensions(first, count, s, &k, &length) / &length;
                along = along - &(across.clone() / &square);
            }
            // along d dᵀ + across I
            let (low, high) = (i.min(j), i.max(j));
            for k in 0..D {
                let scaled = along.clone() * &d[k];
                for l in 0..D {
                    let mut entry = scaled.clone() * &d[l];
                    if k == l {
                        entry = entry + &across;
                    }
                    // K has the entry on the diagonal and its negative beside it, and K is
                    // taken off. Of the two blocks beside the diagonal the lower one is kept.
                    for (row, column, sign) in [(low, low, -1.0), (high, high, -1.0), (high, low, 1.0)] {
                        let place = (row * D + k) * size + column * D + l;
                        self.left[place] = self.left[place].clone() + &entry.clone().scaled(&sign);
                    }
                }
            }
        }
        let mut s = springs.pairs().len();
        for g in self.gradients.chunks_exact(size) {
            let k = self.constants(first, count, s);
            subtract_product(&mut self.left, g, &k);
            s += 1;
        }
        let mut g = vec![zero.clone(); size];
        let contents = springs.points().iter().map(|&q| q..q + 1);
        for points in contents.chain(springs.content().map(|_| 0..self.geometry.points())) {
            let alone = points.len() == 1 && s < springs.len() - usize::from(springs.content().is_some());
            let volume = |q: usize| match self.element.tabulation.weights[q] {
                // A point that serves the volumetric rule alone.
                0.0 if alone => self.geometry.volumetric.get(q).cloned().unwrap_or(zero.clone()),
                _ => self.geometry.volumes[q].clone(),
            };
            let mut content = zero.clone();
            g.iter_mut().for_each(|g| *g = zero.clone());
            for q in points.clone() {
                let v = volume(q);
                content = content + &v;
                for (sum, grad) in g.iter_mut().zip(&self.geometry.gradients[q * size..]) {
                    *sum = sum.clone().plus_product(&v, grad);
                }
            }
            let k = self.constants(first, count, s);
            subtract_product(&mut self.left, &g, &k);
            if pulls {
                let tension = self.tensions(first, count, s, &k, &content);
                for q in points {
                    let pull = tension.clone() * &volume(q);
                    subtract_turns(
                        &mut self.left,
                        self.geometry.gradients[q * size..][..size].as_chunks::<D>().0,
                        &pull,
                    );
                }
            }
            s += 1;
        }
    }

    /// Takes the bending `T ∇∇c` of springs on functions and areas of one cell off.
    fn bend_singly(&mut self, cell: usize, lane: usize) {
        let (d, size) = (self.element.dimension(), self.packing.x.len());
        let springs = &self.fits.springs;
        let single = springs.pairs().len()..springs.pairs().len() + springs.functions().len() + springs.areas().len();
        if single.is_empty() {
            return;
        }
        let x = self.packing.lane(lane);
        for s in single {
            let (nodes, measure) = &self.measures[s];
            let dofs: Vec<usize> = nodes.iter().flat_map(|&a| a * d..(a + 1) * d).collect();
            let at: Vec<f64> = dofs.iter().map(|&i| x[i]).collect();
            let pull = self.tension(cell, s, measure.value(&at, d));
            // Second derivatives are dear, and a spring without tension has no use for them.
            if pull == 0.0 {
                continue;
            }
            let hessian = measure.jet(&at, d).hessian;
            for (a, &row) in dofs.iter().enumerate() {
                for (b, &column) in dofs.iter().enumerate() {
                    self.left[row * size + column].as_mut_slice()[lane] -= pull * hessian[a * dofs.len() + b];
                }
            }
        }
    }
}

/// `a ← a − k g gᵀ`, lower triangle.
#[inline(always)]
fn subtract_product<T: Packed>(a: &mut [T], g: &[T], k: &T) {
    for (i, row) in a.chunks_exact_mut(g.len()).enumerate() {
        let scaled = k.clone() * &g[i];
        for (entry, g) in row[..i + 1].iter_mut().zip(g) {
            *entry = entry.clone().minus_product(&scaled, g);
        }
    }
}

/// `a_ab ← a_ab − p (g_a g_bᵀ − g_b g_aᵀ)` for b below a; zero on the diagonal.
#[inline(always)]
fn subtract_turns<T: Packed, const D: usize>(entries: &mut [T], g: &[[T; D]], p: &T) {
    let size = g.len() * D;
    for (a, ga) in g.iter().enumerate() {
        for (b, gb) in g[..a].iter().enumerate() {
            for k in 0..D {
                for l in 0..D {
                    // `g_ak g_bk − g_ak g_bk` is zero.
                    if k == l {
                        continue;
                    }
                    let turn = (ga[k].clone() * &gb[l]).minus_product(&ga[l], &gb[k]);
                    let place = (a * D + k) * size + b * D + l;
                    entries[place] = entries[place].clone().minus_product(p, &turn);
                }
            }
        }
    }
}
