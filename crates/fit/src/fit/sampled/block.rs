//! Shapes of a cell side by side, so that registers hold one shape per lane: residual forces, their first and their
//! second derivatives in the parameters of the springs, summed over the shapes.
//!
//! Theory: page *Sampled fits* of the book.

use super::cell::{Sample, SampledCell, Sums};
use super::sampling::Part;
use crate::error::Result;
use crate::scalar::{Packed, PackedWork, vectorized, widest};
use crate::springs::{AskedResponse, Law};

/// The number of shapes is filled up to a multiple of this, which every width of registers divides.
pub const SIDE: usize = 8;
/// The largest number of shapes of a block; its values stay in the second cache.
const SHAPES: usize = 256;
/// The largest number of values that the blocks of a cell may hold: 64 megabytes.
const MOST_HELD: usize = 1 << 23;

/// Some shapes of a cell, weighted by the roots of their weights.
struct Block {
    /// The number of shapes, a multiple of [`SIDE`].
    shapes: usize,
    /// The forces of the material, `[seen × shapes]`.
    forces: Vec<f64>,
    springs: Vec<Rows>,
    /// Pairs t ≤ s of springs whose gradients are not orthogonal, with their `∇c_s·∇c_t`, `[shapes]`.
    pairs: Vec<(usize, usize, Vec<f64>)>,
    /// `Σ_q w_q ‖f‖²`.
    size: f64,
    /// The number of shapes that have less of their deformation than was drawn.
    reduced: usize,
}

/// A spring at the shapes.
struct Rows {
    /// c, `[shapes]`.
    measures: Vec<f64>,
    /// The places of a force at which the gradient does not vanish, and `∇c` there, `[places × shapes]`.
    places: Vec<usize>,
    gradient: Vec<f64>,
}

/// The sums over shapes, and `Σ_q w_q Σ_s (∇c_s·r) ∂²T_s/∂p∂p`, `[unknowns × unknowns]`. The second derivatives of
/// `½ Σ_q w_q ‖r‖²` are `M − bends`.
pub struct Curved {
    pub sums: Sums,
    pub bends: Vec<f64>,
}

/// Some of the shapes that a fit uses, drawn once as far as memory allows.
pub struct Drawn<'a, 'c> {
    cell: &'a SampledCell<'c>,
    part: Part,
    indices: Vec<usize>,
    held: Vec<Block>,
}

impl<'a, 'c> Drawn<'a, 'c> {
    /// Draws the shapes of a part with these indices.
    ///
    /// # Errors
    /// Those of [`SampledCell::placed`] and [`SampledCell::sample`].
    pub fn new(cell: &'a SampledCell<'c>, part: Part, indices: Vec<usize>) -> Result<Drawn<'a, 'c>> {
        let (mut held, mut values) = (Vec::new(), 0);
        // The first blocks are kept and the later ones drawn each time, so that the number of a block is its place.
        for indices in indices.chunks(SHAPES) {
            if values > MOST_HELD {
                break;
            }
            let block = Block::draw(cell, part, indices)?;
            values += block.values();
            held.push(block);
        }
        Ok(Drawn { cell, part, indices, held })
    }

    /// The sums at `unknowns`; only the derivatives in the unknowns of `chosen` are computed, the others are zero. If
    /// some unknowns of a spring are chosen and others are not, those that are must vanish, and its force with them.
    ///
    /// # Errors
    /// Those of [`SampledCell::placed`] and [`SampledCell::sample`].
    pub fn sums(&self, unknowns: &[f64], chosen: &[bool]) -> Result<Curved> {
        let count = self.cell.count();
        let mut curved = Curved { sums: Sums::of(count), bends: vec![0.0; count * count] };
        for (i, indices) in self.indices.chunks(SHAPES).enumerate() {
            match self.held.get(i) {
                Some(block) => block.add(self.cell, unknowns, chosen, &mut curved),
                None => Block::draw(self.cell, self.part, indices)?.add(self.cell, unknowns, chosen, &mut curved),
            }
        }
        Ok(curved)
    }
}

impl Block {
    fn draw(cell: &SampledCell, part: Part, indices: &[usize]) -> Result<Block> {
        let (seen, springs) = (cell.seen(), cell.len());
        // Lanes are always full, for which no loop needs a rest.
        let shapes = indices.len().next_multiple_of(SIDE);
        let mut forces = vec![0.0; seen * shapes];
        let mut measures = vec![0.0; springs * shapes];
        let mut gradients = vec![0.0; springs * seen * shapes];
        let mut sample = Sample::default();
        let placed = cell.placed(part, indices)?;
        for q in 0..shapes {
            // The last shape fills the lanes that remain, with a weight of zero.
            let weight = match placed.get(q) {
                Some(placed) => {
                    cell.sample(placed, &mut sample)?;
                    sample.weight.sqrt()
                }
                None => 0.0,
            };
            let spread = |to: &mut [f64], from: &[f64], weight: f64| {
                from.iter().enumerate().for_each(|(row, value)| to[row * shapes + q] = weight * value);
            };
            spread(&mut forces, &sample.force, weight);
            spread(&mut measures, &sample.measures, 1.0);
            spread(&mut gradients, &sample.gradients, weight);
        }
        let rows = |(measures, gradient): (&[f64], &[f64])| {
            let row = |place: usize| &gradient[place * shapes..(place + 1) * shapes];
            // A spring pulls at its own nodes alone: the other rows of its gradient are zero at every shape.
            let places: Vec<usize> = (0..seen).filter(|&place| row(place).iter().any(|g| *g != 0.0)).collect();
            let gradient = places.iter().flat_map(|&place| row(place)).copied().collect();
            Rows { measures: measures.to_vec(), places, gradient }
        };
        let size = forces.iter().map(|f| f * f).sum();
        let springs: Vec<Rows> =
            measures.chunks_exact(shapes).zip(gradients.chunks_exact(seen * shapes)).map(rows).collect();
        let mut pairs = Vec::new();
        for s in 0..springs.len() {
            for t in 0..=s {
                let products = products(&springs[s], &springs[t], shapes);
                // Gradients of springs without a common node are orthogonal at all shapes, and most pairs are such.
                if products.iter().any(|product| *product != 0.0) {
                    pairs.push((s, t, products));
                }
            }
        }
        let reduced = placed.iter().filter(|placed| placed.is_reduced).count();
        Ok(Block { shapes, forces, springs, pairs, size, reduced })
    }

    /// The number of values.
    fn values(&self) -> usize {
        let of_springs: usize = self.springs.iter().map(|rows| rows.measures.len() + rows.gradient.len()).sum();
        self.forces.len() + of_springs + self.pairs.len() * self.shapes
    }

    fn add(&self, cell: &SampledCell, unknowns: &[f64], chosen: &[bool], curved: &mut Curved) {
        let laws = self.laws(cell, unknowns, chosen);
        curved.sums.size += self.size;
        curved.sums.reduced += self.reduced;
        widest(Add { block: self, cell, laws: &laws, chosen, curved });
    }

    /// What the law of each spring gives at the shapes: T, its derivatives in its parameters, and the second derivatives,
    /// `[values × shapes]`. If only some of its parameters are chosen, only the derivatives in these; the others are
    /// zero. A law is asked once for all springs that have it.
    fn laws(&self, cell: &SampledCell, unknowns: &[f64], chosen: &[bool]) -> Vec<Vec<f64>> {
        let of_spring = |s: usize| cell.of_spring(s, unknowns);
        let values = |s: usize| 1 + of_spring(s).len() + of_spring(s).len() * (of_spring(s).len() + 1) / 2;
        let mut all: Vec<Vec<f64>> = (0..self.springs.len()).map(|s| vec![0.0; values(s) * self.shapes]).collect();
        let mut asked: Vec<(&Law, Vec<AskedResponse>)> = Vec::new();
        for (s, results) in all.iter_mut().enumerate() {
            let Some(law) = cell.law(s) else { continue };
            let (own, chosen) = (of_spring(s), &chosen[cell.places(s)]);
            let whole = chosen.iter().all(|chosen| *chosen);
            let mut wanted: Vec<bool> =
                (0..values(s)).map(|i| whole || (1..=own.len()).contains(&i) && chosen[i - 1]).collect();
            // A law without chosen parameters pulls whatever these are.
            wanted[0] |= chosen.iter().all(|chosen| !chosen);
            let one =
                AskedResponse { c: &self.springs[s].measures, rest: cell.rest(s), parameters: own, wanted, results };
            // A law that is a function is called once for all its springs, because a call into Python costs more than the arithmetic.
            match asked.iter_mut().find(|(known, _)| std::ptr::eq(*known, law)) {
                Some((_, springs)) => springs.push(one),
                None => asked.push((law, vec![one])),
            }
        }
        asked.iter_mut().for_each(|(law, springs)| law.respond_all::<SIDE>(springs));
        all
    }
}

/// `∇c_s·∇c_t` at the shapes.
fn products(s: &Rows, t: &Rows, shapes: usize) -> Vec<f64> {
    let mut products = vec![0.0; shapes];
    for (place, a) in s.places.iter().zip(s.gradient.chunks_exact(shapes)) {
        if let Ok(other) = t.places.binary_search(place) {
            let b = &t.gradient[other * shapes..(other + 1) * shapes];
            products.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
        }
    }
    products
}

/// Adds the sums over the shapes of a block.
struct Add<'a, 'c> {
    block: &'a Block,
    cell: &'a SampledCell<'c>,
    laws: &'a [Vec<f64>],
    chosen: &'a [bool],
    curved: &'a mut Curved,
}

impl PackedWork for Add<'_, '_> {
    type Output = ();

    fn run<T: Packed>(self, zero: T) {
        vectorized!(zero, self.add(&zero));
    }
}

impl Add<'_, '_> {
    #[inline(always)]
    fn add<T: Packed>(self, zero: &T) {
        let Add { block, cell, laws, chosen, curved } = self;
        let (shapes, count) = (block.shapes, cell.count());
        let row = |i: usize| i * shapes..(i + 1) * shapes;
        // r = f − Σ T ∇c
        let mut lacking = block.forces.clone();
        for (rows, law) in block.springs.iter().zip(laws) {
            for (place, gradient) in rows.places.iter().zip(rows.gradient.chunks_exact(shapes)) {
                subtract_products(zero, &mut lacking[row(*place)], gradient, &law[row(0)]);
            }
        }
        curved.sums.square += sum_of_products(zero, &lacking, &lacking);
        // Jᵀ r and the bends, by ∇c·r
        let mut along = vec![0.0; shapes];
        for (s, (rows, law)) in block.springs.iter().zip(laws).enumerate() {
            along.fill(0.0);
            for (place, gradient) in rows.places.iter().zip(rows.gradient.chunks_exact(shapes)) {
                add_products(zero, &mut along, gradient, &lacking[row(*place)]);
            }
            let own = cell.places(s);
            let mut bend = 1 + own.len();
            for i in 0..own.len() {
                let (u, any) = (own.start + i, chosen[own.start + i]);
                if any {
                    curved.sums.normal.rhs[u] += sum_of_products(zero, &law[row(1 + i)], &along);
                }
                for j in 0..=i {
                    let v = own.start + j;
                    if any && chosen[v] {
                        let sum = sum_of_products(zero, &law[row(bend)], &along);
                        curved.bends[u * count + v] += sum;
                        if u != v {
                            curved.bends[v * count + u] += sum;
                        }
                    }
                    bend += 1;
                }
            }
        }
        // JᵀJ, pair by pair
        let gram = &mut curved.sums.normal.gram;
        let mut image = along;
        for (s, t, products) in &block.pairs {
            let (of_s, of_t) = (cell.places(*s), cell.places(*t));
            for (i, u) in of_s.enumerate().filter(|(_, u)| chosen[*u]) {
                multiply(zero, &mut image, products, &laws[*s][row(1 + i)]);
                for (j, v) in of_t.clone().enumerate().filter(|(_, v)| chosen[*v]) {
                    let sum = sum_of_products(zero, &image, &laws[*t][row(1 + j)]);
                    gram[u * count + v] += sum;
                    // The pair of a spring with itself fills both triangles by its own two loops.
                    if s != t {
                        gram[v * count + u] += sum;
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn load<T: Packed>(zero: &T, values: &[f64]) -> T {
    let mut lanes = zero.clone();
    lanes.as_mut_slice().copy_from_slice(values);
    lanes
}

#[inline(always)]
fn sum_of_products<T: Packed>(zero: &T, a: &[f64], b: &[f64]) -> f64 {
    // Two sums, because the terms of one wait for each other.
    let mut sums: [T; 2] = zero.repeated();
    for (i, (a, b)) in a.chunks_exact(T::COUNT).zip(b.chunks_exact(T::COUNT)).enumerate() {
        sums[i % 2] = sums[i % 2].clone().plus_product(&load(zero, a), &load(zero, b));
    }
    let [first, second] = sums;
    (first + &second).as_slice().iter().sum()
}

#[inline(always)]
fn add_products<T: Packed>(zero: &T, to: &mut [f64], a: &[f64], b: &[f64]) {
    let rows = to.chunks_exact_mut(T::COUNT).zip(a.chunks_exact(T::COUNT)).zip(b.chunks_exact(T::COUNT));
    for ((to, a), b) in rows {
        to.copy_from_slice(load(zero, to).plus_product(&load(zero, a), &load(zero, b)).as_slice());
    }
}

#[inline(always)]
fn subtract_products<T: Packed>(zero: &T, to: &mut [f64], a: &[f64], b: &[f64]) {
    let rows = to.chunks_exact_mut(T::COUNT).zip(a.chunks_exact(T::COUNT)).zip(b.chunks_exact(T::COUNT));
    for ((to, a), b) in rows {
        to.copy_from_slice(load(zero, to).minus_product(&load(zero, a), &load(zero, b)).as_slice());
    }
}

#[inline(always)]
fn multiply<T: Packed>(zero: &T, to: &mut [f64], a: &[f64], b: &[f64]) {
    let rows = to.chunks_exact_mut(T::COUNT).zip(a.chunks_exact(T::COUNT)).zip(b.chunks_exact(T::COUNT));
    for ((to, a), b) in rows {
        to.copy_from_slice((load(zero, a) * &load(zero, b)).as_slice());
    }
}
