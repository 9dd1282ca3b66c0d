//! The springs of exact networks, one cell per lane of the machine's registers.

use super::energy::Coefficients;
use super::volume::Shares;
use crate::element::Element;
use crate::fit::packing::Packing;
use crate::fit::precision::differences;
use crate::scalar::{DoubleDouble, Packed, PackedWork, Real, dot, widest};
use crate::springs::Springs;
use crate::stiffness::{Fault, Geometry, gather};
use nalgebra::Matrix3;

/// A product of gradients below this share of that of their lengths is rounding.
const ROUNDING: f64 = 1e-13;

/// The cells of one block and where their numbers go.
pub struct ExactBatch<'a> {
    pub element: &'a Element,
    pub springs: &'a Springs,
    /// `[points × space]`, m.
    pub points: &'a [f64],
    /// `[cells × nodes]`.
    pub connectivity: &'a [usize],
    pub coefficients: &'a Coefficients,
    pub shares: Shares,
    /// `[cells × springs]`.
    pub constants: &'a mut [f64],
    /// `[cells × parameters]`: of each content spring `k L₀`, or `a` and `b` of its law.
    pub parameters: &'a mut [f64],
}

impl ExactBatch<'_> {
    /// # Errors
    /// The first cell that has no stiffness, from 0.
    pub fn run(self) -> Result<(), (usize, Fault)> {
        widest(self)
    }

    /// The number of a content spring in the order of [`ContentSpring`].
    fn content(&self, shares: [f64; 2], content: f64, volume: f64, volumetric: f64) -> ContentSpring {
        let Coefficients { tension, slope, lambda, law, law_lambda, .. } = self.coefficients;
        let pull = shares[0] * tension * volume;
        let slope = shares[0] * slope * volume + shares[1] * lambda * volumetric;
        let constant = slope / (content * content);
        match law {
            None => ContentSpring { constant, parameters: [(slope + pull) / content, 0.0], count: 1 },
            Some(_) => {
                let b = shares[1] * law_lambda * volumetric;
                ContentSpring { constant, parameters: [pull / content, b / content], count: 2 }
            }
        }
    }
}

/// What is stored of a spring on content.
struct ContentSpring {
    constant: f64,
    parameters: [f64; 2],
    count: usize,
}

impl PackedWork for ExactBatch<'_> {
    type Output = Result<(), (usize, Fault)>;

    fn run<T: Packed>(mut self, zero: T) -> Self::Output {
        let (n, m) = (self.element.nodes(), self.springs.len());
        let cells = self.connectivity.len() / n;
        let p = self.parameters.len() / cells.max(1);
        let table = &self.element.tabulation;
        let mut packing = Packing::new(&zero, self.element, self.points);
        let mut geometry = Geometry::like(&zero, table);
        let mut pairs = vec![zero.clone(); self.springs.pairs.len()];
        let mut own = vec![zero.clone(); n];
        let (mut plain, mut plain_own) = (Geometry::new(table), vec![0.0; n]);
        let mut x = vec![0.0; packing.x.len()];
        let mut cell = 0;
        while cell < cells {
            let count = T::COUNT.min(cells - cell);
            let nodes = &self.connectivity[cell * n..(cell + count) * n];
            if packing.gather(nodes) && geometry.update(table, &packing.x) {
                stiffen(&geometry, self.coefficients.lengths, &mut pairs, &mut own);
                for lane in 0..count {
                    let at = cell + lane;
                    for (k, pair) in self.constants[at * m..].iter_mut().zip(&pairs) {
                        *k = pair.as_slice()[lane];
                    }
                    let volume = |q: usize| geometry.volumes[q].as_slice()[lane];
                    let volumetric = |q: usize| geometry.volumetric.get(q).map_or(volume(q), |v| v.as_slice()[lane]);
                    self.contents(at, p, volume, volumetric);
                    if !self.springs.areas.is_empty() {
                        self.areas(at, &packing.lane(lane), volume);
                    }
                }
            } else {
                // One by one: what is wrong with a cell, or how many digits it takes, or nothing but the range of numbers.
                for at in cell..cell + count {
                    let nodes = &self.connectivity[at * n..(at + 1) * n];
                    packing.place(nodes, &mut x).map_err(|fault| (at, fault))?;
                    plain.set(table, &x).map_err(|fault| (at, fault))?;
                    if Geometry::quality(table, &x) <= T::delicate()
                        && let Some(precise) = self.precise(nodes, &x)
                    {
                        plain = precise;
                    }
                    let edges = &mut self.constants[at * m..][..pairs.len()];
                    stiffen(&plain, self.coefficients.lengths, edges, &mut plain_own);
                    let volume = |q: usize| plain.volumes[q];
                    let volumetric = |q: usize| plain.volumetric.get(q).map_or(volume(q), |v| *v);
                    self.contents(at, p, volume, volumetric);
                    self.areas(at, &x, volume);
                }
            }
            cell += count;
        }
        match self.constants.iter().position(|k| !k.is_finite()) {
            Some(place) => Err((place / m, Fault::Unmeasured)),
            None => Ok(()),
        }
    }
}

impl ExactBatch<'_> {
    /// The geometry of a needle or a sliver, worked out in twice the digits and rounded; `x` are the positions in its own plane or line.
    fn precise(&self, nodes: &[usize], x: &[f64]) -> Option<Geometry> {
        let (table, d) = (&self.element.tabulation, self.element.dimension());
        let mut given = x.to_vec();
        if self.element.space() == d {
            // As they are, for their differences are exact in more digits.
            gather(self.points, d, nodes, &mut given);
        }
        let any = DoubleDouble::from(0.0);
        let mut geometry = Geometry::like(&any, table);
        let rounded = |values: &[DoubleDouble]| values.iter().map(Real::rounded).collect();
        geometry.update(table, &differences(&any, d, &given)).then(|| Geometry {
            dimension: geometry.dimension,
            nodes: geometry.nodes,
            gradients: rounded(&geometry.gradients),
            volumes: rounded(&geometry.volumes),
            volumetric: rounded(&geometry.volumetric),
        })
    }

    /// Writes the springs on content of one cell; `volume(q)` and `volumetric(q)` are those of the two terms at a point.
    #[inline(always)]
    fn contents(&mut self, cell: usize, p: usize, volume: impl Fn(usize) -> f64, volumetric: impl Fn(usize) -> f64) {
        let m = self.springs.len();
        let first = self.springs.pairs.len() + self.springs.areas.len();
        let (mut place, mut next) = (cell * m + first, cell * p);
        let mut store = |batch: &mut Self, spring: ContentSpring| {
            batch.constants[place] = spring.constant;
            batch.parameters[next..next + spring.count].copy_from_slice(&spring.parameters[..spring.count]);
            (place, next) = (place + 1, next + spring.count);
        };
        for &q in &self.springs.points {
            let content = if volume(q) == 0.0 { volumetric(q) } else { volume(q) };
            store(self, self.content(self.shares.points, content, volume(q), volumetric(q)));
        }
        if self.springs.content.is_some() {
            let points = 0..self.element.tabulation.points();
            let [content, whole] = points.fold([0.0; 2], |[v, w], q| [v + volume(q), w + volumetric(q)]);
            store(self, self.content(self.shares.cell, content, content, whole));
        }
    }
}

impl ExactBatch<'_> {
    /// Writes the springs on areas of one cell with its nodes at `x`. With `N = [n₁ n₂ n₃]`, the cofactor matrix of the Jacobian J,
    /// `cof F = N J₀ᵀ/det J₀`, so that `|cof F|² = Σ_kl M_kl n_k·n_l`, `M = J₀ᵀ J₀/det² J₀`, which is a sum of squares of `|n_k|` and
    /// `|n_k + n_l|`.
    fn areas(&mut self, cell: usize, x: &[f64], volume: impl Fn(usize) -> f64) {
        let (m, table) = (self.springs.len(), &self.element.tabulation);
        let size = table.nodes * table.dimension;
        let first = cell * m + self.springs.pairs.len();
        let all = self.constants[first..first + self.springs.areas.len()].chunks_exact_mut(AREAS);
        for (q, constants) in all.enumerate() {
            let j = Matrix3::from_fn(|k, l| {
                let nodes = x.chunks_exact(3).zip(table.gradients[q * size..(q + 1) * size].chunks_exact(3));
                nodes.map(|(x, dn)| x[k] * dn[l]).sum::<f64>()
            });
            let metric = j.transpose() * j * (self.coefficients.areas * volume(q) / j.determinant().powi(2));
            let pairs = [(0, 1), (0, 2), (1, 2)];
            let least = ROUNDING * metric.amax();
            let mixed = pairs.map(|pair| if metric[pair].abs() > least { metric[pair] } else { 0.0 });
            for k in 0..3 {
                let others = pairs.iter().zip(mixed).filter(|((a, b), _)| *a == k || *b == k);
                constants[k] = metric[(k, k)] - others.map(|(_, mixed)| mixed).sum::<f64>();
                if constants[k].abs() <= least {
                    constants[k] = 0.0;
                }
            }
            constants[3..].copy_from_slice(&mixed);
        }
    }
}

/// Springs on areas at each quadrature point: of three columns of the cofactor matrix and of three sums of two.
const AREAS: usize = 6;

/// The springs between all pairs of nodes, see [`stiffen`].
pub fn edges<T: Real>(geometry: &Geometry<T>, mu: f64) -> Vec<T> {
    let mut pairs = vec![geometry.volumes[0].zero(); geometry.nodes * (geometry.nodes - 1) / 2];
    let mut own = vec![geometry.volumes[0].zero(); geometry.nodes];
    stiffen(geometry, mu, &mut pairs, &mut own);
    pairs
}

/// `k_ab = −μ Σ_q w_q ∇N_a·∇N_b` of all pairs; what is rounding is zero. `own` has room for the same of each node with itself.
fn stiffen<T: Real>(geometry: &Geometry<T>, mu: f64, pairs: &mut [T], own: &mut [T]) {
    // A copy for each of the common sizes, in which the loops unroll: for few nodes they are all overhead.
    macro_rules! of_size {
        ($d:literal, $n:expr) => {
            geometry.volumes[0].vectorize(
                #[inline(always)]
                || stiffen_in::<T, $d>($n, geometry, mu, pairs, own),
            )
        };
    }
    match (geometry.dimension, geometry.nodes) {
        (2, 3) if T::UNROLLED => of_size!(2, 3),
        (2, 4) if T::UNROLLED => of_size!(2, 4),
        (3, 4) if T::UNROLLED => of_size!(3, 4),
        (3, 8) if T::UNROLLED => of_size!(3, 8),
        (1, n) => of_size!(1, n),
        (2, n) => of_size!(2, n),
        (_, n) => of_size!(3, n),
    }
}

#[inline(always)]
fn stiffen_in<T: Real, const D: usize>(n: usize, geometry: &Geometry<T>, mu: f64, pairs: &mut [T], own: &mut [T]) {
    let zero = geometry.volumes[0].zero();
    let pairs = &mut pairs[..n * (n - 1) / 2];
    pairs.fill(zero.clone());
    let own = &mut own[..n];
    own.fill(zero.clone());
    for (gradients, volume) in geometry.gradients.chunks_exact(n * D).zip(&geometry.volumes) {
        let gradients = &gradients.as_chunks::<D>().0[..n];
        let factor = volume.clone().scaled(&-mu);
        let mut s = 0;
        for a in 0..n {
            own[a] = own[a].clone().plus_product(&factor, &dot(&gradients[a], &gradients[a]));
            for b in a + 1..n {
                pairs[s] = pairs[s].clone().plus_product(&factor, &dot(&gradients[a], &gradients[b]));
                s += 1;
            }
        }
    }
    // Gradients at right angles: their product against that of their lengths, by squares.
    let mut s = 0;
    for a in 0..n {
        for b in a + 1..n {
            let least = (own[a].clone() * &own[b]).scaled(&(ROUNDING * ROUNDING));
            pairs[s] = (pairs[s].clone().squared() - &least).choose(&pairs[s], &zero);
            s += 1;
        }
    }
}
