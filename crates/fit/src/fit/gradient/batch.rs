//! The derivatives of many cells, one cell per SIMD lane.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::closed::{EdgeSlopes, LeastSquaresCell};
use super::exact::add_exact;
use super::inputs::{CellFunction, CellNumbers, GradientFit, Inputs};
use super::slopes::Slopes;
use crate::fit::exact::ExactKernel;
use crate::fit::least_squares::Closed;
use crate::fit::packing::packed;
use crate::material::{Hooke, Moduli};
use crate::scalar::{Dual, Packed, PackedWork, Real, at_most_four, of_dimension, vectorized};
use crate::stiffness::Geometry;

/// What is computed of each cell.
#[derive(Clone, Copy)]
pub enum Product<'a> {
    /// Derivatives of constants and rest contents along one or two changes.
    Along(&'a [&'a Inputs]),
    /// Slopes in nodes and moduli, and their derivative along a change.
    Gradient(&'a CellNumbers, Option<&'a Inputs>),
}

/// The memory for the results, `[cells × their number]`.
pub struct Columns<'a> {
    pub first: &'a mut [f64],
    pub second: &'a mut [f64],
}

/// The cells of one chunk, the first of which has the number `start`.
pub struct Batch<'a, 'f> {
    pub function: &'a CellFunction<'f>,
    pub product: Product<'a>,
    pub start: usize,
    /// `[cells × nodes]`.
    pub nodes: &'a [usize],
    pub into: Columns<'a>,
}

impl Batch<'_, '_> {
    /// Computes every cell.
    ///
    /// # Errors
    /// A cell has no derivatives. The error is its number, counted from 0.
    pub fn run(self) -> Result<(), usize> {
        at_most_four(self)
    }

    fn cells(&self) -> usize {
        self.nodes.len() / self.function.element.nodes()
    }
}

impl PackedWork for Batch<'_, '_> {
    type Output = Result<(), usize>;

    fn run<T: Packed>(mut self, zero: T) -> Result<(), usize> {
        let cells = self.cells();
        let wide = (0..cells).step_by(T::COUNT).map(|first| (first, T::COUNT.min(cells - first))).collect::<Vec<_>>();
        let refused = match self.product {
            Product::Along([_]) => self.values::<T, Dual<1, T>>(&zero, &wide),
            Product::Along(_) => self.values::<T, Dual<1, Dual<1, T>>>(&zero, &wide),
            Product::Gradient(_, None) => self.slopes::<T, T>(&zero, &wide),
            Product::Gradient(..) => self.slopes::<T, Dual<1, T>>(&zero, &wide),
        };
        if refused.is_empty() {
            return Ok(());
        }
        // Needles and slivers one by one, in numbers whose bound is rounding alone.
        let alone: Vec<(usize, usize)> =
            refused.into_iter().flat_map(|(first, count)| (first..first + count).map(|cell| (cell, 1))).collect();
        let refused = match self.product {
            Product::Along([_]) => self.values::<f64, Dual<1>>(&0.0, &alone),
            Product::Along(_) => self.values::<f64, Dual<1, Dual<1>>>(&0.0, &alone),
            Product::Gradient(_, None) => self.slopes::<f64, f64>(&0.0, &alone),
            Product::Gradient(..) => self.slopes::<f64, Dual<1>>(&0.0, &alone),
        };
        refused.first().map_or(Ok(()), |(cell, _)| Err(self.start + cell))
    }
}

/// A number with derivatives along some changes, whose coefficients are of the kind T.
trait Seeded<T>: Real {
    /// The number with this value and these derivatives, one for each change.
    fn seeded(value: T, along: [T; 2]) -> Self;

    /// The coefficient of the product of all changes.
    fn last(&self) -> &T;
}

impl<T: Packed> Seeded<T> for T {
    #[inline(always)]
    fn seeded(value: T, _along: [T; 2]) -> T {
        value
    }

    #[inline(always)]
    fn last(&self) -> &T {
        self
    }
}

impl<T: Packed> Seeded<T> for Dual<1, T> {
    #[inline(always)]
    fn seeded(value: T, [along, _]: [T; 2]) -> Dual<1, T> {
        Dual { value, slopes: [along] }
    }

    #[inline(always)]
    fn last(&self) -> &T {
        &self.slopes[0]
    }
}

impl<T: Packed> Seeded<T> for Dual<1, Dual<1, T>> {
    #[inline(always)]
    fn seeded(value: T, [along, other]: [T; 2]) -> Dual<1, Dual<1, T>> {
        let none = value.zero();
        // The two changes are in two levels, so that the product of both has the mixed derivative and no second one of either.
        Dual { value: Dual { value, slopes: [along] }, slopes: [Dual { value: other, slopes: [none] }] }
    }

    #[inline(always)]
    fn last(&self) -> &T {
        &self.slopes[0].slopes[0]
    }
}

/// The nodes and moduli of the cells in the lanes.
struct Seeds<N> {
    /// Relative to the first node, `[nodes × dimension]`.
    x: Vec<N>,
    moduli: Moduli<N>,
}

impl<'a> Batch<'a, '_> {
    fn changes(&self) -> [Option<&'a Inputs>; 2] {
        match self.product {
            Product::Along(changes) => [changes.first().copied(), changes.get(1).copied()],
            Product::Gradient(_, change) => [change, None],
        }
    }

    /// Lanes without a cell repeat the first.
    fn gather<T: Packed, N: Seeded<T>>(&self, zero: &T, (first, count): (usize, usize), seeds: &mut Seeds<N>) {
        let CellFunction { element, points, moduli, .. } = self.function;
        let (n, d) = (element.nodes(), element.dimension());
        let changes = self.changes();
        let cell = |lane: usize| first + if lane < count { lane } else { 0 };
        // The numbers of the cells are looked up once, without memory of their own: no register has more lanes than this.
        let mut lanes = [const { 0usize }; 64];
        (0..T::COUNT).for_each(|lane| lanes[lane] = cell(lane));
        let lanes = &lanes[..T::COUNT];
        for i in 0..n * d {
            let (a, k) = (i / d, i % d);
            // Changes are relative to that of the first node, as positions are: constants do not depend on where a cell is.
            let relative = |all: &[f64]| {
                packed(zero, T::COUNT, |lane| {
                    let nodes = &self.nodes[lanes[lane] * n..];
                    all[nodes[a] * d + k] - all[nodes[0] * d + k]
                })
            };
            let along = changes.map(|change| change.map_or(zero.clone(), |change| relative(&change.points)));
            seeds.x[i] = N::seeded(relative(points), along);
        }
        let seed = |i: usize, of: &dyn Fn(&Moduli) -> f64| {
            let change = |change: &Inputs, lane: usize| change.moduli[(self.start + lanes[lane]) * 2 + i];
            let along = changes.map(|inputs| {
                inputs.map_or(zero.clone(), |inputs| packed(zero, T::COUNT, |lane| change(inputs, lane)))
            });
            N::seeded(packed(zero, T::COUNT, |lane| of(moduli.at(self.start + lanes[lane]))), along)
        };
        seeds.moduli = Moduli { lambda: seed(0, &|m| m.lambda), mu: seed(1, &|m| m.mu) };
    }

    fn seeds<N: Real>(&self, zero: &N) -> Seeds<N> {
        let CellFunction { element, .. } = self.function;
        let x = vec![zero.clone(); element.nodes() * element.dimension()];
        Seeds { x, moduli: Moduli { lambda: zero.clone(), mu: zero.clone() } }
    }

    /// What solves for the constants of a fit in closed form; none of exact networks, and where there is no closed form.
    fn closed<N: Real>(&self) -> Option<Closed<N>> {
        match &self.function.fit {
            GradientFit::Closed(fit) => Closed::of(self.function.springs, fit),
            GradientFit::Exact(_) => None,
        }
    }

    /// Derivatives of constants and rest contents; returns the groups that have none in these numbers.
    fn values<T: Packed, N: Seeded<T>>(&mut self, zero: &T, groups: &[(usize, usize)]) -> Vec<(usize, usize)> {
        let CellFunction { element, springs, fit, .. } = self.function;
        let any = N::seeded(zero.clone(), [zero.clone(), zero.clone()]);
        let (table, [m, r]) = (&element.tabulation, self.function.counts());
        let mut seeds = self.seeds(&any);
        let mut geometry = Geometry::like(&any, table);
        let (mut constants, mut rests) = (vec![any.clone(); m], vec![any.clone(); r]);
        let mut own = vec![any.clone(); element.nodes()];
        let mut closed = self.closed::<N>();
        let mut refused = Vec::new();
        for &(first, count) in groups {
            self.gather(zero, (first, count), &mut seeds);
            let is_found = match (fit, &mut closed) {
                (GradientFit::Closed(_), Some(closed)) => {
                    let hooke = Hooke::Isotropic(seeds.moduli.clone());
                    let is_found = closed.solve(table, springs, &seeds.x, &mut geometry, &hooke);
                    if is_found {
                        (0..m).for_each(|s| constants[s] = closed.constant(springs, s).clone());
                        rests.iter_mut().for_each(|rest| *rest = geometry.content());
                    }
                    is_found
                }
                (GradientFit::Closed(_), None) => false,
                (GradientFit::Exact(fit), _) => {
                    let kernel = ExactKernel::of(fit, springs);
                    let room = [&mut constants[..], &mut rests, &mut own];
                    kernel.solve_plain(table, &seeds.x, &seeds.moduli, &mut geometry, room)
                }
            };
            let is_sound = is_found
                && write(count, first, &constants, m, self.into.first)
                && write(count, first, &rests, r, self.into.second);
            if !is_sound {
                refused.push((first, count));
            }
        }
        refused
    }

    /// Slopes in nodes and moduli; returns the groups that have none in these numbers.
    fn slopes<T: Packed, N: Seeded<T>>(&mut self, zero: &T, groups: &[(usize, usize)]) -> Vec<(usize, usize)> {
        let CellFunction { element, springs, fit, .. } = self.function;
        let Product::Gradient(given, _) = self.product else { return groups.to_vec() };
        let any = N::seeded(zero.clone(), [zero.clone(), zero.clone()]);
        let (table, [m, r]) = (&element.tabulation, self.function.counts());
        let n = table.nodes;
        let mut seeds = self.seeds(&any);
        let mut geometry = Geometry::like(&any, table);
        let mut slopes = Slopes::like(&any, &geometry);
        let mut room = EdgeSlopes::like(&any, springs);
        let (mut weights, mut rests, mut k) = (vec![any.clone(); m], vec![any.clone(); r], vec![any.clone(); m]);
        let mut closed = self.closed::<N>();
        let mut refused = Vec::new();
        for &(first, count) in groups {
            self.gather(zero, (first, count), &mut seeds);
            for (into, all, width) in [(&mut weights, &given.constants, m), (&mut rests, &given.rests, r)] {
                for (i, number) in into.iter_mut().enumerate() {
                    let cell = |lane: usize| self.start + first + if lane < count { lane } else { 0 };
                    let value = packed(zero, T::COUNT, |lane| all[cell(lane) * width + i]);
                    // Weights do not change along the change of the inputs.
                    *number = N::seeded(value, [zero.clone(), zero.clone()]);
                }
            }
            let is_found = match (fit, &mut closed) {
                (GradientFit::Closed(_), Some(closed)) => {
                    let hooke = Hooke::Isotropic(seeds.moduli.clone());
                    let is_found = closed.solve(table, springs, &seeds.x, &mut geometry, &hooke);
                    if is_found {
                        (0..m).for_each(|s| k[s] = closed.constant(springs, s).clone());
                        closed.solve_again(springs, &mut weights);
                        let weight = closed.weight();
                        let (p, k) = (&weights[..], &k[..]);
                        let (x, moduli) = (&seeds.x[..], &seeds.moduli);
                        let cell = LeastSquaresCell { weight, springs, x, geometry: &geometry, moduli, k, p };
                        vectorized!(any, {
                            slopes.clear(&any);
                            // A spring on the content of the cell rests at the content.
                            if let Some(rest) = rests.first() {
                                slopes.add_content(rest);
                            }
                            of_dimension!(table.dimension, |D| {
                                cell.add_slopes::<D>(n, &mut room, &mut slopes);
                                slopes.through_geometry::<D>(n, &geometry);
                            });
                        });
                    }
                    is_found
                }
                (GradientFit::Closed(_), None) => false,
                (GradientFit::Exact(fit), _) => {
                    let kernel = ExactKernel::of(fit, springs);
                    vectorized!(
                        any,
                        of_dimension!(table.dimension, |D| geometry.update_in::<D>(n, table, &seeds.x) && {
                            slopes.clear(&any);
                            add_exact::<N, D>(n, &kernel, &seeds.moduli, &geometry, &weights, &rests, &mut slopes);
                            slopes.through_geometry::<D>(n, &geometry);
                            true
                        })
                    )
                }
            };
            let is_sound = is_found
                && write(count, first, &slopes.x, slopes.x.len(), self.into.first)
                && write(count, first, &slopes.moduli, 2, self.into.second);
            if !is_sound {
                // What was written for these cells is overwritten when they are done again one by one.
                refused.push((first, count));
            }
        }
        refused
    }
}

/// Writes the numbers of the lanes, `[cells × width]`; false if one is not finite.
fn write<T: Packed, N: Seeded<T>>(count: usize, first: usize, numbers: &[N], width: usize, into: &mut [f64]) -> bool {
    let mut is_finite = true;
    for (i, number) in numbers.iter().enumerate() {
        for (lane, value) in number.last().as_slice()[..count].iter().enumerate() {
            is_finite &= value.is_finite();
            into[(first + lane) * width + i] = *value;
        }
    }
    is_finite
}
