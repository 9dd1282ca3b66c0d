//! The springs of exact networks, computed with one cell per SIMD lane.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::energy::Coefficients;
use super::volume::Shares;
use crate::element::{Element, Tabulation};
use crate::fit::packing::Packing;
use crate::fit::precision::differences;
use crate::material::BlockValues;
use crate::number::first_not_finite;
use crate::scalar::{DoubleDouble, Packed, PackedWork, Real, dot, of_dimension, vectorized, widest};
use crate::springs::Springs;
use crate::stiffness::{Fault, Geometry, gather};
use nalgebra::Matrix3;

/// A product of gradients below this share of the product of their lengths is a rounding error. Sums over the points of
/// a cell leave some hundred units of `f64`, where right angles have zero.
const ROUNDING: f64 = 1e-13;

/// The cells of one block, and the memory for their numbers.
pub struct ExactBatch<'a> {
    pub element: &'a Element,
    pub kernel: ExactKernel<'a>,
    /// The positions of all points, `[points × space]`, m.
    pub points: &'a [f64],
    /// The nodes of the cells, `[cells × nodes]`.
    pub connectivity: &'a [usize],
    /// Those of each cell.
    pub coefficients: BlockValues<'a, Coefficients>,
    /// The constants, `[cells × springs]`.
    pub constants: &'a mut [f64],
    /// The parameters, `[cells × parameters]`: for each spring on content `k L₀`, or `a` and `b` of its law.
    pub parameters: &'a mut [f64],
}

/// The springs of a cell, and what those on content receive.
#[derive(Clone, Copy)]
pub struct ExactKernel<'a> {
    pub springs: &'a Springs,
    /// Whether the springs on content have a law.
    pub has_law: bool,
    pub shares: Shares,
}

impl ExactBatch<'_> {
    /// Computes every cell.
    ///
    /// # Errors
    /// A cell has no stiffness. The error gives the first such cell, counted from 0.
    pub fn run(self) -> Result<(), (usize, Fault)> {
        widest(self)
    }
}

impl PackedWork for ExactBatch<'_> {
    type Output = Result<(), (usize, Fault)>;

    fn run<T: Packed>(mut self, zero: T) -> Self::Output {
        let (n, m) = (self.element.nodes(), self.kernel.springs.len());
        let cells = self.connectivity.len() / n;
        // An empty block has no cells to divide by.
        let p = self.parameters.len() / cells.max(1);
        let table = &self.element.tabulation;
        let mut packing = Packing::new(&zero, self.element, self.points);
        let mut geometry = Geometry::like(&zero, table);
        // The number of constants and parameters of a cell, without the springs on areas.
        let mut numbers = vec![zero.clone(); m + p];
        let mut own = vec![zero.clone(); n];
        let (mut plain, mut plain_own, mut plain_numbers) = (Geometry::new(table), vec![0.0; n], vec![0.0; m + p]);
        let mut x = vec![0.0; packing.x.len()];
        let Some(mut coefficients) = self.coefficients.values().first().map(|some| some.of_kind(&zero)) else {
            return Ok(());
        };
        let mut cell = 0;
        while cell < cells {
            let count = T::COUNT.min(cells - cell);
            let nodes = &self.connectivity[cell * n..(cell + count) * n];
            let (constants, parameters) = numbers.split_at_mut(m);
            if let BlockValues::Each(all) = self.coefficients {
                let of_lane = |lane| &all[cell + if lane < count { lane } else { 0 }];
                // Lanes without a cell have the numbers of the first one, as their nodes have: all lanes stay finite.
                (0..T::COUNT).for_each(|lane| coefficients.set_lane(lane, of_lane(lane)));
            }
            if packing.gather(nodes)
                && self.kernel.solve(table, &coefficients, &packing.x, &mut geometry, [constants, parameters, &mut own])
            {
                for lane in 0..count {
                    let at = cell + lane;
                    let stored = self.constants[at * m..][..m].iter_mut().zip(&*constants);
                    stored.for_each(|(k, lanes)| *k = lanes.as_slice()[lane]);
                    let stored = self.parameters[at * p..][..p].iter_mut().zip(&*parameters);
                    stored.for_each(|(k, lanes)| *k = lanes.as_slice()[lane]);
                    if !self.kernel.springs.areas().is_empty() {
                        self.areas(at, &packing.lane(lane), |q| geometry.volumes[q].as_slice()[lane]);
                    }
                }
            } else {
                // One by one, to find the fault of a cell, or whether it needs more digits, or whether only a number
                // has overflowed.
                for at in cell..cell + count {
                    let nodes = &self.connectivity[at * n..(at + 1) * n];
                    packing.place(nodes, &mut x).map_err(|fault| (at, fault))?;
                    plain.set(table, &x).map_err(|fault| (at, fault))?;
                    if Geometry::quality(table, &x) <= T::delicate()
                        && let Some(precise) = self.precise(nodes, &x)
                    {
                        plain = precise;
                    }
                    let (constants, parameters) = plain_numbers.split_at_mut(m);
                    let own = *self.coefficients.at(at);
                    self.kernel.constants_of(&own, &plain, constants, parameters, &mut plain_own);
                    self.constants[at * m..][..m].copy_from_slice(constants);
                    self.parameters[at * p..][..p].copy_from_slice(parameters);
                    self.areas(at, &x, |q| plain.volumes[q]);
                }
            }
            cell += count;
        }
        // All of them, without leaving the loop early, so that several are tested at once.
        if self.constants.iter().fold(true, |sound, k| sound & k.is_finite()) {
            return Ok(());
        }
        let place = first_not_finite(self.constants).unwrap_or(0);
        Err((place / m, Fault::Unmeasured))
    }
}

impl ExactBatch<'_> {
    /// The geometry of a needle or a sliver, computed in double-double numbers and rounded; `x` are the positions in
    /// its own plane or line.
    fn precise(&self, nodes: &[usize], x: &[f64]) -> Option<Geometry> {
        let (table, d) = (&self.element.tabulation, self.element.dimension());
        let mut given = x.to_vec();
        if self.element.space() == d {
            // Absolute positions, because their differences are exact in numbers of more digits.
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
            modes: rounded(&geometry.modes),
            mode_count: geometry.mode_count,
        })
    }
}

impl ExactKernel<'_> {
    /// Fills in the geometry of the cells with nodes at `x`, and their constants and parameters without the springs on
    /// areas. `own` is memory for one number per node. False if a Jacobian is not safely positive.
    pub(super) fn solve<T: Real>(
        &self,
        table: &Tabulation,
        coefficients: &Coefficients<T>,
        x: &[T],
        geometry: &mut Geometry<T>,
        [constants, parameters, own]: [&mut [T]; 3],
    ) -> bool {
        let n = table.nodes;
        vectorized!(
            x[0],
            of_dimension!(table.dimension, |D| geometry.update_in::<D>(n, table, x) && {
                self.constants_in::<T, D>(n, coefficients, geometry, constants, parameters, own);
                true
            })
        )
    }

    /// The constants and parameters of a cell with this geometry, as [`ExactKernel::solve`] computes them.
    fn constants_of<T: Real>(
        &self,
        coefficients: &Coefficients<T>,
        geometry: &Geometry<T>,
        constants: &mut [T],
        parameters: &mut [T],
        own: &mut [T],
    ) {
        let n = geometry.nodes;
        vectorized!(
            geometry.volumes[0],
            of_dimension!(geometry.dimension, |D| {
                self.constants_in::<T, D>(n, coefficients, geometry, constants, parameters, own)
            })
        );
    }

    #[inline(always)]
    fn constants_in<T: Real, const D: usize>(
        &self,
        n: usize,
        coefficients: &Coefficients<T>,
        geometry: &Geometry<T>,
        constants: &mut [T],
        parameters: &mut [T],
        own: &mut [T],
    ) {
        let (edges, rest) = constants.split_at_mut(n * (n - 1) / 2);
        stiffen_in::<T, D>(n, geometry, &coefficients.lengths, edges, own);
        self.contents(coefficients, geometry, &mut rest[self.springs.areas().len()..], parameters);
    }

    /// The constants and parameters of the springs on content: first those at the quadrature points, then that of the
    /// cell.
    #[inline(always)]
    fn contents<T: Real>(
        &self,
        coefficients: &Coefficients<T>,
        geometry: &Geometry<T>,
        constants: &mut [T],
        parameters: &mut [T],
    ) {
        let (volumes, count) = (&geometry.volumes, if self.has_law { 2 } else { 1 });
        let volumetric = if geometry.volumetric.is_empty() { volumes } else { &geometry.volumetric };
        let mut springs = constants.iter_mut().zip(parameters.chunks_exact_mut(count));
        for &q in self.springs.points() {
            if let Some((constant, parameters)) = springs.next() {
                // A point that serves the volumetric rule alone has no volume in the other rule.
                let content = volumes[q].magnitude().choose(&volumes[q], &volumetric[q]);
                let volumes = [&volumes[q], &volumetric[q]];
                content_spring(coefficients, self.shares.points, &content, volumes, constant, parameters);
            }
        }
        if let Some((constant, parameters)) = springs.next() {
            let (mut content, mut whole) = (volumes[0].clone(), volumetric[0].clone());
            for (v, w) in volumes.iter().zip(volumetric).skip(1) {
                content = content + v;
                whole = whole + w;
            }
            content_spring(coefficients, self.shares.cell, &content, [&content, &whole], constant, parameters);
        }
    }
}

/// The spring on this content, with the volumes of the two terms: its constant, and `k L₀` or `a` and `b` of its law.
#[inline(always)]
pub fn content_spring<T: Real>(
    coefficients: &Coefficients<T>,
    shares: [f64; 2],
    content: &T,
    [volume, volumetric]: [&T; 2],
    constant: &mut T,
    parameters: &mut [T],
) {
    let Coefficients { tension, slope, lambda, law_lambda, .. } = coefficients;
    let share = |of: &T, share: f64| of.clone().scaled(&share);
    let pull = volume.clone() * &share(tension, shares[0]);
    let slope = volume.clone() * &share(slope, shares[0]) + &(volumetric.clone() * &share(lambda, shares[1]));
    *constant = slope.clone() / &(content.clone() * content);
    match parameters {
        [rest] => *rest = (slope + &pull) / content,
        [a, b] => {
            *a = pull / content;
            *b = volumetric.clone() * &share(law_lambda, shares[1]) / content;
        }
        _ => {}
    }
}

impl ExactBatch<'_> {
    /// Writes the springs on areas of one cell with its nodes at `x`.
    ///
    /// With `N = [n₁ n₂ n₃]` the cofactor matrix of the Jacobian J, `cof F = N J₀ᵀ/det J₀`, so that
    /// `|cof F|² = Σ_kl M_kl n_k·n_l` with `M = J₀ᵀ J₀/det² J₀`. This is a sum of squares of `|n_k|` and `|n_k + n_l|`.
    fn areas(&mut self, cell: usize, x: &[f64], volume: impl Fn(usize) -> f64) {
        let (m, table) = (self.kernel.springs.len(), &self.element.tabulation);
        let size = table.nodes * table.dimension;
        let first = cell * m + self.kernel.springs.pairs().len();
        let all = self.constants[first..first + self.kernel.springs.areas().len()].chunks_exact_mut(AREAS);
        for (q, constants) in all.enumerate() {
            let j = Matrix3::from_fn(|k, l| {
                let nodes = x.chunks_exact(3).zip(table.gradients[q * size..(q + 1) * size].chunks_exact(3));
                nodes.map(|(x, dn)| x[k] * dn[l]).sum::<f64>()
            });
            let metric = j.transpose() * j * (self.coefficients.at(cell).areas * volume(q) / j.determinant().powi(2));
            let pairs = [(0, 1), (0, 2), (1, 2)];
            let least = ROUNDING * metric.amax();
            let mixed = pairs.map(|pair| if metric[pair].abs() > least { metric[pair] } else { 0.0 });
            for k in 0..3 {
                // By `2 n_k·n_l = |n_k + n_l|² − |n_k|² − |n_l|²` each mixed term goes to a sum and is taken off two squares.
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

/// The number of springs on areas at each quadrature point: three columns of the cofactor matrix and three sums of two
/// columns.
const AREAS: usize = 6;

/// The springs between all pairs of nodes, see [`stiffen_in`].
pub fn edges<T: Real>(geometry: &Geometry<T>, mu: f64) -> Vec<T> {
    let (zero, n) = (geometry.volumes[0].zero(), geometry.nodes);
    let (mut pairs, mut own) = (vec![zero.clone(); n * (n - 1) / 2], vec![zero; n]);
    let mu = geometry.volumes[0].constant(&mu);
    vectorized!(
        geometry.volumes[0],
        of_dimension!(geometry.dimension, |D| stiffen_in::<T, D>(n, geometry, &mu, &mut pairs, &mut own))
    );
    pairs
}

/// `k_ab = −μ Σ_q w_q ∇N_a·∇N_b` of all pairs; rounding errors are set to zero. `own` is memory for the same product of
/// each node with itself.
#[inline(always)]
fn stiffen_in<T: Real, const D: usize>(n: usize, geometry: &Geometry<T>, mu: &T, pairs: &mut [T], own: &mut [T]) {
    let zero = geometry.volumes[0].zero();
    let pairs = &mut pairs[..n * (n - 1) / 2];
    pairs.fill(zero.clone());
    let own = &mut own[..n];
    own.fill(zero.clone());
    for (gradients, volume) in geometry.gradients.chunks_exact(n * D).zip(&geometry.volumes) {
        let gradients = &gradients.as_chunks::<D>().0[..n];
        let factor = (volume.clone() * mu).negated();
        let mut s = 0;
        for a in 0..n {
            own[a] = own[a].clone().plus_product(&factor, &dot(&gradients[a], &gradients[a]));
            for b in a + 1..n {
                pairs[s] = pairs[s].clone().plus_product(&factor, &dot(&gradients[a], &gradients[b]));
                s += 1;
            }
        }
    }
    // Gradients at right angles: their product is compared with that of their lengths, by squares.
    let mut s = 0;
    for a in 0..n {
        for b in a + 1..n {
            let least = (own[a].clone() * &own[b]).scaled(&(ROUNDING * ROUNDING));
            // Only the value vanishes: dual numbers keep the derivative, which is not zero at a right angle.
            pairs[s] = (pairs[s].clone().squared() - &least).choose(&pairs[s], &pairs[s].vanished());
            s += 1;
        }
    }
}
