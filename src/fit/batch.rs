//! Least-squares fits of many cells, one cell per lane of the machine's registers.

use super::constrained::solve_nonnegative;
use super::least_squares::normal_equations;
use super::normal::{Normal, Rank};
use super::{Fit, Weight};
use crate::element::Element;
use crate::material::Moduli;
use crate::scalar::Lanes;
use crate::springs::Springs;
use crate::stiffness::{Fault, Geometry, gather};
use pulp::{Simd, WithSimd};

/// The cells of one block and where their constants go.
pub struct Batch<'a> {
    pub element: &'a Element,
    pub springs: &'a Springs,
    /// `[points × dimension]`, m.
    pub points: &'a [f64],
    /// `[cells × nodes]`.
    pub connectivity: &'a [usize],
    pub moduli: Moduli,
    pub weight: Weight,
    pub fit: Fit,
    /// `[cells × springs]`.
    pub constants: &'a mut [f64],
}

impl Batch<'_> {
    /// Fits every cell; returns the number of cells whose normal equations were singular.
    ///
    /// # Errors
    /// The first cell that has no stiffness, from 0.
    pub fn run(self) -> Result<usize, (usize, Fault)> {
        pulp::Arch::new().dispatch(self)
    }
}

impl WithSimd for Batch<'_> {
    type Output = Result<usize, (usize, Fault)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (n, m) = (self.element.nodes(), self.springs.len());
        let mut room = Room::new(simd, &self);
        let mut deficient = 0;
        let blocks = self.connectivity.chunks(Lanes::<S>::COUNT * n);
        for (index, (nodes, constants)) in blocks.zip(self.constants.chunks_mut(Lanes::<S>::COUNT * m)).enumerate() {
            if room.fit(nodes, constants) {
                continue;
            }
            // One of them has no regular equations. Each alone in all lanes: its digits do not depend on its neighbours.
            for (cell, (nodes, constants)) in nodes.chunks(n).zip(constants.chunks_mut(m)).enumerate() {
                if !room.fit(nodes, constants) {
                    let rank = room.fit_singular(nodes, constants);
                    let rank = rank.map_err(|fault| (index * Lanes::<S>::COUNT + cell, fault))?;
                    deficient += usize::from(rank == Rank::Deficient);
                }
            }
        }
        Ok(deficient)
    }
}

/// What the cells of one register's width need.
struct Room<'a, S: Simd> {
    element: &'a Element,
    springs: &'a Springs,
    points: &'a [f64],
    moduli: Moduli,
    weight: Weight,
    fit: Fit,
    x: Vec<Lanes<S>>,
    geometry: Geometry<Lanes<S>>,
    normal: Normal<Lanes<S>>,
    tied: Normal<Lanes<S>>,
    /// The equations of a single cell whose constants are bounded.
    single: Normal,
}

impl<'a, S: Simd> Room<'a, S> {
    #[inline(always)]
    fn new(simd: S, batch: &Batch<'a>) -> Room<'a, S> {
        let zero = Lanes::splat(simd, 0.0);
        let Batch { element, springs, points, moduli, weight, fit, .. } = *batch;
        Room {
            element,
            springs,
            points,
            moduli,
            weight,
            fit,
            x: vec![zero; element.nodes() * element.dimension()],
            geometry: Geometry::of_kind(&zero, &element.tabulation),
            normal: Normal::default(),
            tied: Normal::default(),
            single: Normal::default(),
        }
    }

    /// Writes the constants of the given cells, at most one per lane. Returns false, with nothing written, if the
    /// Jacobian of one is not safely positive or its equations are not regular.
    #[inline(always)]
    fn fit(&mut self, nodes: &[usize], constants: &mut [f64]) -> bool {
        self.gather(nodes);
        if !self.geometry.update(&self.element.tabulation, &self.x) {
            return false;
        }
        normal_equations(self.weight, self.springs, &self.x, &self.geometry, &self.moduli, &mut self.normal);
        let equations = if self.fit.tied {
            self.normal.tied(&self.springs.groups, self.springs.names.len(), &mut self.tied);
            &mut self.tied
        } else {
            &mut self.normal
        };
        // The bounded optimum is found from the equations themselves, which the elimination overwrites.
        let kept = self.fit.nonnegative.then(|| equations.clone());
        if !equations.solve_regular() {
            return false;
        }
        let m = self.springs.len();
        let cells = constants.len() / m;
        for s in 0..m {
            let k = equations.rhs[if self.fit.tied { self.springs.groups[s] } else { s }].as_slice();
            for cell in 0..cells {
                constants[cell * m + s] = k[cell];
            }
        }
        if let Some(kept) = kept {
            for (lane, constants) in constants.chunks_exact_mut(m).enumerate() {
                if constants.iter().all(|k| *k >= 0.0) {
                    continue;
                }
                self.single.gram.clear();
                self.single.gram.extend(kept.gram.iter().map(|entry| entry.as_slice()[lane]));
                self.single.rhs.clear();
                self.single.rhs.extend(kept.rhs.iter().map(|entry| entry.as_slice()[lane]));
                let (k, _) = solve_nonnegative(&self.single);
                spread(&self.fit, self.springs, constants, &k);
            }
        }
        true
    }

    /// A single cell, with all care.
    fn fit_singular(&mut self, nodes: &[usize], constants: &mut [f64]) -> Result<Rank, Fault> {
        let mut x = vec![0.0; self.x.len()];
        gather(self.points, self.element.dimension(), nodes, &mut x);
        let mut geometry = Geometry::new(&self.element.tabulation);
        geometry.set(&self.element.tabulation, &x)?;
        let mut normal = Normal::default();
        normal_equations(self.weight, self.springs, &x, &geometry, &self.moduli, &mut normal);
        if self.fit.tied {
            let mut tied = Normal::default();
            normal.tied(&self.springs.groups, self.springs.names.len(), &mut tied);
            normal = tied;
        }
        let (k, rank) = if self.fit.nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        spread(&self.fit, self.springs, constants, &k);
        Ok(rank)
    }

    /// The coordinates of the cells' nodes, one cell per lane; lanes without a cell repeat the first.
    #[inline(always)]
    fn gather(&mut self, nodes: &[usize]) {
        match self.element.dimension() {
            2 => self.gather_in::<2>(nodes),
            _ => self.gather_in::<3>(nodes),
        }
    }

    #[inline(always)]
    fn gather_in<const D: usize>(&mut self, nodes: &[usize]) {
        let n = self.x.len() / D;
        let points = self.points.as_chunks::<D>().0;
        let x = &mut self.x.as_chunks_mut::<D>().0[..n];
        for lane in 0..Lanes::<S>::COUNT {
            let cell = if lane * n < nodes.len() { &nodes[lane * n..(lane + 1) * n] } else { &nodes[..n] };
            for (x, &node) in x.iter_mut().zip(cell) {
                let point = &points[node];
                for k in 0..D {
                    x[k].as_mut_slice()[lane] = point[k];
                }
            }
        }
    }
}

/// One constant per spring from the solution of the equations, which has one per group where they are tied.
fn spread(fit: &Fit, springs: &Springs, constants: &mut [f64], k: &[f64]) {
    for (s, constant) in constants.iter_mut().enumerate() {
        *constant = k[if fit.tied { springs.groups[s] } else { s }];
    }
}
