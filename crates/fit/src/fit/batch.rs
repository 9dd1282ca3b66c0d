//! Fits of many cells, one cell per SIMD lane.
//!
//! Theory: page *Least squares* of the book.

use super::constrained::{MANY, solve_nonnegative, solve_vectorized};
use super::delicate::DelicateCells;
use super::least_squares::Closed;
use super::method::{Certificate, LEAST_MEASURED_PIVOT, Method, Verdict};
use super::normal::{Normal, Rank};
use super::packed_hooke::PackedHooke;
use super::packing::{Packing, fill};
use super::reduction::Source;
use super::rows::Rows;
use super::settings::Fit;
use super::vectorized_normal::VectorizedNormal;
use super::weight::ClosedWeight;
use crate::element::Element;
use crate::material::{BlockValues, Hooke};
use crate::scalar::{Packed, PackedWork, distance, widest};
use crate::springs::Springs;
use crate::stiffness::{Fault, Geometry, gather};

/// The cells of one block, and the memory for their constants.
pub struct Batch<'a> {
    pub element: &'a Element,
    pub springs: &'a Springs,
    /// The positions of all points, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The nodes of the cells, `[cells × nodes]`.
    pub connectivity: &'a [usize],
    /// Those of each cell.
    pub hooke: BlockValues<'a, Hooke>,
    pub fit: Fit,
    /// The constants, `[cells × springs]`.
    pub constants: &'a mut [f64],
}

/// If two nodes are nearer than this, relative to the cell, the gradients of springs on functions have less than ten
/// digits in `f64`.
const NEAR: f64 = 1e-6;

/// If the sine of an angle that a spring measures is below this, its gradient has lost a digit or more.
const STRAIGHT: f64 = 0.1;

/// What is reported of the cells besides their constants.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tally {
    /// The number of cells whose normal equations were singular.
    pub deficient: usize,
    /// The number of cells whose iteration did not converge.
    pub unreached: usize,
    /// One certificate per cell if the objective has certificates, otherwise empty.
    pub certificates: Vec<Certificate>,
}

impl Tally {
    fn add(&mut self, verdict: Verdict) {
        self.deficient += usize::from(verdict.rank == Rank::Deficient);
        self.unreached += usize::from(!verdict.reached || verdict.rank == Rank::Unsolved);
        self.certificates.extend(verdict.certificate);
    }
}

impl Batch<'_> {
    /// Fits every cell.
    ///
    /// # Errors
    /// A cell has no stiffness. The error gives the first such cell, counted from 0.
    pub fn run(self) -> Result<Tally, (usize, Fault)> {
        widest(self)
    }
}

impl PackedWork for Batch<'_> {
    type Output = Result<Tally, (usize, Fault)>;

    fn run<T: Packed>(self, zero: T) -> Self::Output {
        let (n, m) = (self.element.nodes(), self.springs.len());
        let mut workspace = Workspace::new(zero, &self);
        let mut tally = Tally::default();
        let cells = self.connectivity.len() / n;
        let (mut cell, mut alone) = (0, 0);
        while cell < cells {
            let count = if cell < alone { 1 } else { T::COUNT.min(cells - cell) };
            let nodes = &self.connectivity[cell * n..(cell + count) * n];
            let constants = &mut self.constants[cell * m..(cell + count) * m];
            if workspace.fit(cell, nodes, constants, &mut tally) {
                cell += count;
            } else if count > 1 {
                // One of the cells has no regular equations. Each is solved alone in all lanes, so that its digits do
                // not depend on the others.
                alone = cell + count;
            } else {
                tally.add(workspace.fit_alone(cell, nodes, constants, false).map_err(|fault| (cell, fault))?);
                cell += 1;
            }
        }
        Ok(tally)
    }
}

/// The working memory for as many cells as there are lanes.
struct Workspace<'a, T: Packed> {
    element: &'a Element,
    springs: &'a Springs,
    hooke: PackedHooke<'a, T>,
    fit: Fit,
    /// For objectives with a closed form.
    closed: Option<Closed<T>>,
    /// For objectives that need the reduced element.
    method: Option<Method<T>>,
    packing: Packing<'a, T>,
    /// Gradients of the springs on functions, `[functions × nodes·dimension]`.
    measured: Vec<T>,
    geometry: Geometry<T>,
}

impl<'a, T: Packed> Workspace<'a, T> {
    fn new(zero: T, batch: &Batch<'a>) -> Workspace<'a, T> {
        let Batch { element, springs, points, ref hooke, fit, .. } = *batch;
        Workspace {
            element,
            springs,
            hooke: PackedHooke::new(&zero, element.dimension(), hooke.clone()),
            fit,
            closed: Closed::of(springs, &fit),
            method: Method::like(&zero, springs, &fit),
            packing: Packing::new(&zero, element, points),
            measured: vec![zero.clone(); springs.functions().len() * element.nodes() * element.dimension()],
            geometry: Geometry::like(&zero, &element.tabulation),
        }
    }

    /// Writes the constants of the given cells, at most one per lane; the first has the number `first`. Returns false, with
    /// nothing written, if the Jacobian of a cell is not safely positive or its equations are not regular.
    fn fit(&mut self, first: usize, nodes: &[usize], constants: &mut [f64], tally: &mut Tally) -> bool {
        self.hooke.set(first, nodes.len() / self.element.nodes());
        // Blocks of springs on functions have neither route: each cell is solved alone, through the rows of its springs.
        if (self.closed.is_none() && self.method.is_none()) || !self.packing.gather(nodes) {
            return false;
        }
        let Some(mut method) = self.method.take() else { return self.fit_closed(constants, tally) };
        let regular = self.geometry.update(&self.element.tabulation, &self.packing.x)
            && self.measure(nodes.len() / self.element.nodes());
        if regular {
            let source = Source::Element(&self.geometry, &self.hooke.lanes);
            method.solve(self.springs, &self.packing.x, source, &self.measured);
            let n = self.element.nodes();
            for (lane, constants) in constants.chunks_exact_mut(self.springs.len()).enumerate() {
                let quality = || Geometry::quality(&self.element.tabulation, &self.packing.lane(lane));
                let mut verdict = method.finish(|value| value.as_slice()[lane], quality, constants);
                if verdict.delicate || self.are_near(&self.packing.lane(lane)) {
                    let nodes = &nodes[lane * n..(lane + 1) * n];
                    // A cell that cannot be fitted alone keeps the constants of the lanes, which are then reported as
                    // not reached.
                    let unreached = Verdict { reached: false, ..verdict };
                    verdict = self.fit_alone(first + lane, nodes, constants, true).unwrap_or(unreached);
                }
                tally.add(verdict);
            }
        }
        self.method = Some(method);
        regular
    }

    /// [`Workspace::fit`] for objectives with a closed form.
    fn fit_closed(&mut self, constants: &mut [f64], tally: &mut Tally) -> bool {
        let Workspace { element, springs, fit, .. } = *self;
        let (Some(closed), hooke) = (&mut self.closed, &self.hooke.lanes) else { return false };
        if !closed.solve(&element.tabulation, springs, &self.packing.x, &mut self.geometry, hooke) {
            return false;
        }
        let m = springs.len();
        write(closed, springs, constants);
        // The objective is convex: an optimum without bounds that is within the bounds is the optimum with them.
        if !fit.nonnegative || constants.iter().all(|k| *k >= 0.0) {
            return true;
        }
        // A constant that is not a number counts as below its bound, so that its cell is solved again.
        let is_bounded = |lane: &usize| constants[lane * m..][..m].iter().any(|k| !(*k >= 0.0));
        let lanes: Vec<usize> = (0..constants.len() / m).filter(is_bounded).collect();
        if closed.bound(springs, &self.packing.x, &self.geometry, hooke, &lanes) {
            write(closed, springs, constants);
            return true;
        }
        let Some(equations) = closed.equations(springs, &self.packing.x, &self.geometry, hooke) else {
            // Each constant has an equation of its own, whose optimum under the bound is zero.
            // One that is not a number stays, so that its cell is refused.
            constants.iter_mut().filter(|k| **k < 0.0).for_each(|k| *k = 0.0);
            return true;
        };
        let has_many = equations.size() >= MANY;
        let mut vectorized = if has_many { VectorizedNormal::of_lanes(equations, &lanes) } else { Vec::new() };
        for (i, &lane) in lanes.iter().enumerate() {
            let constants = &mut constants[lane * m..][..m];
            let (k, rank) = match vectorized.get_mut(i) {
                // The constants without bounds tell where to begin, unless springs of a group share an unknown: those
                // are in another order.
                Some(equations) => solve_vectorized(equations, (equations.size() == m).then_some(&*constants)),
                None => {
                    let all = |values: &[T]| values.iter().map(|value| value.as_slice()[lane]).collect();
                    solve_nonnegative(&Normal::new(all(&equations.gram), all(&equations.rhs)))
                }
            };
            fit.spread(springs, constants, &k);
            // The other lanes have passed the elimination, so that their equations are regular: only these are counted.
            tally.add(Verdict { certificate: None, rank, reached: true, delicate: false });
        }
        true
    }

    /// Fits a single cell; in double-double numbers if its equations or its shape are delicate.
    fn fit_alone(
        &mut self,
        cell: usize,
        nodes: &[usize],
        constants: &mut [f64],
        is_delicate: bool,
    ) -> Result<Verdict, Fault> {
        let hooke = &self.hooke.of_cell(cell);
        // The lanes have failed or are delicate, so that the cell is placed anew and by itself, which also tells its fault.
        let mut x = vec![0.0; self.packing.x.len()];
        self.packing.place(nodes, &mut x)?;
        let mut geometry = Geometry::new(&self.element.tabulation);
        geometry.set(&self.element.tabulation, &x)?;
        let mut measured = vec![0.0; self.measured.len()];
        if !self.springs.function_gradients(&x, &mut measured) {
            return Err(Fault::Unmeasured);
        }
        let are_near = self.are_near(&x);
        let Workspace { element, springs, fit, .. } = self;
        let quality = Geometry::quality(&element.tabulation, &x);
        if is_delicate || quality <= T::delicate() || are_near {
            let delicate = DelicateCells { element, springs, hooke, fit };
            let d = element.dimension();
            let mut given = x.clone();
            if element.space() == d {
                // Absolute positions, because their differences are exact in numbers of more digits.
                gather(self.packing.points, d, nodes, &mut given);
            }
            if let Some(verdict) = delicate.constants(&given, (&x, &geometry), constants) {
                return Ok(verdict);
            }
        }
        if let Some(mut method) = Method::like(&0.0, self.springs, &self.fit) {
            method.solve(self.springs, &x, Source::Element(&geometry, &hooke.of_kind(&0.0)), &measured);
            return Ok(method.finish(|value| *value, || quality, constants));
        }
        let normal = match &self.closed {
            Some(closed) => closed.equations_alone(self.springs, &x, &geometry, hooke),
            None => {
                let rows = Rows::of_gradients(self.springs, &x, &geometry, measured);
                rows.normal(ClosedWeight::OffDiagonal, &x, &geometry.entries(hooke))
            }
        };
        let normal = normal.by_unknowns(self.springs, self.fit.tied);
        // The elimination overwrites the equations, which are solved below another way where they are regular.
        let mut eliminated = normal.clone();
        // A small pivot has lost digits of gradients that have lost some before: the cell is fitted again in more
        // digits.
        if self.closed.is_none()
            && !is_delicate
            && !(eliminated.solve_regular() && eliminated.least_pivot() >= LEAST_MEASURED_PIVOT)
        {
            return self.fit_alone(cell, nodes, constants, true);
        }
        let (k, rank) = if self.fit.nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        self.fit.spread(self.springs, constants, &k);
        Ok(Verdict { certificate: None, rank, reached: true, delicate: false })
    }

    /// Whether springs measure functions of nodes at `x`, `[nodes × dimension]`, two of which nearly coincide, or angles near 0 or π.
    fn are_near(&self, x: &[f64]) -> bool {
        !self.measured.is_empty()
            && (nearness(x, self.element.dimension()) < NEAR || self.springs.least_sine(x) < STRAIGHT)
    }

    /// The gradients of the springs on functions in the first `cells` lanes; the other lanes repeat the first. False if
    /// a gradient is zero or not finite.
    fn measure(&mut self, cells: usize) -> bool {
        if self.measured.is_empty() {
            return true;
        }
        let mut regular = true;
        let mut rows = vec![0.0; self.measured.len()];
        for lane in 0..cells {
            let x = self.packing.lane(lane);
            rows.fill(0.0);
            regular &= self.springs.function_gradients(&x, &mut rows);
            fill(&mut self.measured, lane, &rows);
        }
        regular
    }
}

/// Writes the constants of each lane, `[cells × springs]`.
#[inline(always)]
fn write<T: Packed>(closed: &Closed<T>, springs: &Springs, constants: &mut [f64]) {
    let m = springs.len();
    for s in 0..m {
        let k = closed.constant(springs, s).as_slice();
        for (cell, k) in (0..constants.len() / m).zip(k) {
            constants[cell * m + s] = *k;
        }
    }
}

/// The least distance of two nodes relative to the largest; `x` is `[nodes × dimension]`.
fn nearness(x: &[f64], dimension: usize) -> f64 {
    let nodes = || x.chunks_exact(dimension).enumerate();
    let pairs = nodes().flat_map(|(i, a)| nodes().skip(i + 1).map(move |(_, b)| distance(a, b)));
    let (least, largest) = pairs.fold((f64::MAX, 0.0f64), |(least, largest), d| (least.min(d), largest.max(d)));
    least / largest
}
