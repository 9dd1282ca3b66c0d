//! Branches whose stress relaxes, of many material points, one cell per lane.
//!
//! The state of a point is kept in the coordinates ξ of its cell, in which the shape functions of all cells of an element are alike. With the
//! tangents `t_l = Σ_a x_a ∂N_a/∂ξ_l`, their cross products `n_1 = t_2 × t_3`, cyclically, `det = t_1·n_1` and `J = det/det₀`,
//!
//! ```text
//! H_lm = J^(2/3) n_l·n_m/det²        f_a = Σ_l (Σ_i g_i w Σ_m S_i,lm t_m − Σ_i g_i γ_i w J^(2/3) n_l/det) ∂N_a/∂ξ_l        w = μ V₀
//! ```
//!
//! where S_i is known when a step begins. In a tetrahedron t_l are edges, and `−g w S_lm` the constants of springs.
//!
//! Theory: page *Springs that forget* of the book.

use super::contents::Visit;
use super::roots::inverse_cube_root;
use super::tables::{Cells, Gradients, LANES, simplex_gradients};
use super::tangents::{dot, slopes};
use crate::model::material_points::{MaterialPoint, MaterialPoints};
use crate::scalar::Packed;
use rayon::prelude::*;

/// What a term does in an evaluation: the content has the factor γ, and the state becomes `left S + taken H`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BranchRule {
    pub content: f64,
    pub left: f64,
    pub taken: f64,
}

/// The branches of a body.
#[derive(Debug, Clone)]
pub(crate) struct Branches {
    dimension: usize,
    terms: usize,
    pieces: Vec<Piece>,
}

/// Cells that one thread takes at a time.
#[derive(Debug, Clone)]
struct Piece {
    /// The points of the rows.
    points: Vec<usize>,
    tables: Vec<Table>,
    x: Vec<[f64; 4]>,
    force: Vec<[f64; 4]>,
    /// The energy of each term in each lane, `[terms][LANES]`.
    energies: Vec<f64>,
}

/// Cells with the same shape functions. Lists have the cells side by side, `[cells / LANES][numbers of a cell][LANES]`.
#[derive(Debug, Clone)]
struct Table {
    cells: Cells,
    /// Whether t_l are the edges from the first node.
    is_simplex: bool,
    /// `g_i w` of each point and term; zero in lanes without a cell.
    weights: Vec<f64>,
    /// `1/det₀` of each point.
    inverses: Vec<f64>,
    /// S_i of each point and term: the upper triangle, and in the plane the number across.
    states: Vec<f64>,
}

/// Material points that a piece has, about: the six numbers of a term are 400 kB, about a core's second cache.
const POINTS: usize = 1 << 13;

/// Some cells: the points of each, and the gradients `[points × nodes × dimension]` that all share.
struct Draft<'a> {
    nodes: usize,
    per_cell: usize,
    gradients: Option<Vec<f64>>,
    is_simplex: bool,
    points: Vec<MaterialPoint<'a>>,
}

impl Branches {
    /// The branches of points at `rest`, `[points × dimension]`, m, with the share of each term in each region.
    pub fn new(points: &MaterialPoints, rest: &[f64], terms: usize, share: &dyn Fn(usize, usize) -> f64) -> Branches {
        let d = points.dimension;
        let mut drafts: Vec<Draft> = Vec::new();
        let mut all = points.each();
        let simplex = |nodes: usize| (nodes == d + 1).then(|| simplex_gradients(d));
        for (element, cells) in points.elements() {
            let table = &element.tabulation;
            let (nodes, per_cell) = (table.nodes, table.points());
            let is_simplex = nodes == d + 1 && per_cell == 1;
            let gradients = if is_simplex { simplex_gradients(d) } else { table.gradients.clone() };
            let mut left = *cells;
            while left > 0 {
                let count = left.min((POINTS / per_cell).max(LANES));
                let points: Vec<MaterialPoint> = all.by_ref().take(count * per_cell).collect();
                drafts.push(Draft { nodes, per_cell, gradients: Some(gradients.clone()), is_simplex, points });
                left -= count;
            }
        }
        // Domains of edges, by their numbers of nodes.
        let mut others: Vec<MaterialPoint> = all.collect();
        others.sort_by_key(|point| point.nodes.len());
        for group in others.chunk_by(|a, b| a.nodes.len() == b.nodes.len()) {
            for points in group.chunks(POINTS) {
                let nodes = points[0].nodes.len();
                let gradients = simplex(nodes);
                let is_simplex = gradients.is_some();
                drafts.push(Draft { nodes, per_cell: 1, gradients, is_simplex, points: points.to_vec() });
            }
        }
        let mut pieces: Vec<Vec<Draft>> = Vec::new();
        let mut room = 0;
        for draft in drafts {
            let count = draft.points.len();
            match pieces.last_mut() {
                Some(piece) if room >= count => piece.push(draft),
                _ => {
                    room = POINTS;
                    pieces.push(vec![draft]);
                }
            }
            room = room.saturating_sub(count);
        }
        let pieces = pieces.into_iter().map(|drafts| Piece::new(drafts, d, rest, terms, share)).collect();
        Branches { dimension: d, terms, pieces }
    }

    /// The number of numbers that are remembered.
    pub fn numbers(&self) -> usize {
        self.pieces.iter().flat_map(|piece| &piece.tables).map(|table| table.states.len()).sum()
    }

    /// Sets `S_i = H` at the positions x; false if a point is inverted.
    pub fn forget(&mut self, x: &[f64]) -> bool {
        let rules = vec![BranchRule { content: 0.0, left: 0.0, taken: 1.0 }; self.terms];
        self.pieces.iter_mut().flat_map(|piece| &mut piece.tables).for_each(|table| table.states.fill(0.0));
        self.pull(x, &rules, &mut vec![0.0; x.len()], &mut vec![0.0; self.terms])
    }

    /// Adds the forces at the positions x, N, writes the potential of each term, `Σ g_i w (½ tr(F S Fᵀ) − (3/2) γ_i J^(2/3))`, J, and advances the
    /// states; false if a point is inverted, where states are no longer known.
    pub fn pull(&mut self, x: &[f64], rules: &[BranchRule], force: &mut [f64], energies: &mut [f64]) -> bool {
        let d = self.dimension;
        let pull = |piece: &mut Piece| piece.pull(x, d, rules);
        let sound = match &mut self.pieces[..] {
            // One piece is not worth the way to other threads.
            [piece] => pull(piece),
            pieces => pieces.par_iter_mut().map(pull).reduce(|| true, |a, b| a & b),
        };
        // Each piece has forces of its own, which are added in the order of the pieces: threads do not change the sums.
        energies.fill(0.0);
        for piece in &self.pieces {
            for (energy, lanes) in energies.iter_mut().zip(piece.energies.chunks_exact(LANES)) {
                *energy += lanes.iter().sum::<f64>();
            }
            for (row, point) in piece.force.iter().zip(&piece.points) {
                force[point * d..(point + 1) * d].iter_mut().zip(row).for_each(|(f, own)| *f += own);
            }
        }
        sound
    }
}

/// The numbers of a state.
fn numbers(d: usize) -> usize {
    if d == 3 { 6 } else { d * (d + 1) / 2 + 1 }
}

impl Piece {
    fn new(drafts: Vec<Draft>, d: usize, rest: &[f64], terms: usize, share: &dyn Fn(usize, usize) -> f64) -> Piece {
        let mut points: Vec<usize> =
            drafts.iter().flat_map(|draft| &draft.points).flat_map(|point| point.nodes).copied().collect();
        points.sort_unstable();
        points.dedup();
        let row = |point: &usize| points.binary_search(point).expect("it is in the list") as u32;
        let table = |draft: Draft| -> Table {
            let Draft { nodes, per_cell, gradients, is_simplex, points: own } = draft;
            let batches = (own.len() / per_cell).div_ceil(LANES);
            let mut weights = vec![0.0; batches * LANES * per_cell * terms];
            // Lanes without a cell keep the one, so that their numbers are finite.
            let mut inverses = vec![1.0; batches * LANES * per_cell];
            let mut rows = Vec::with_capacity(own.len() / per_cell * nodes);
            let mut tables = Gradients::Own(Vec::new());
            for (i, point) in own.iter().enumerate() {
                let (cell, q) = (i / per_cell, i % per_cell);
                if q == 0 {
                    rows.extend(point.nodes.iter().map(row));
                }
                let flat: Vec<f64>;
                let table = match &gradients {
                    Some(gradients) => &gradients[q * nodes * d..(q + 1) * nodes * d],
                    None => {
                        flat = point.gradients.iter().flat_map(|g| g.iter().take(d).copied()).collect();
                        tables.push(cell, &flat);
                        &flat
                    }
                };
                let at = |place: usize, size: usize| (cell / LANES * size + place) * LANES + cell % LANES;
                inverses[at(q, per_cell)] = 1.0 / determinant(point.nodes, table, rest, d);
                for term in 0..terms {
                    weights[at(q * terms + term, per_cell * terms)] = point.weight * share(term, point.region);
                }
            }
            let states = vec![0.0; batches * LANES * per_cell * terms * numbers(d)];
            let gradients = gradients.map_or(tables, Gradients::Shared);
            let cells = Cells { nodes, dimension: d, points: per_cell, gradients, rows, first: 0 };
            Table { cells, is_simplex, weights, inverses, states }
        };
        let tables = drafts.into_iter().map(table).collect();
        let rows = vec![[0.0; 4]; points.len()];
        Piece { points, tables, x: rows.clone(), force: rows, energies: vec![0.0; terms * LANES] }
    }

    fn pull(&mut self, x: &[f64], d: usize, rules: &[BranchRule]) -> bool {
        for (row, point) in self.x.iter_mut().zip(&self.points) {
            row[..d].copy_from_slice(&x[point * d..(point + 1) * d]);
        }
        self.force.fill([0.0; 4]);
        self.energies.fill(0.0);
        let mut sound = true;
        for Table { cells, is_simplex, weights, inverses, states } in &mut self.tables {
            let (x, force, energies) = (&self.x, &mut self.force[..], &mut self.energies[..]);
            let (simplex, sound) = (*is_simplex, &mut sound);
            cells.visit(d, Pull { cells, simplex, weights, inverses, states, x, rules, force, energies, sound });
        }
        sound
    }
}

/// `det₀` at the positions of rest.
fn determinant(nodes: &[usize], gradients: &[f64], rest: &[f64], d: usize) -> f64 {
    let mut t = nalgebra::Matrix3::identity();
    for l in 0..d {
        for k in 0..d {
            t[(k, l)] = nodes.iter().zip(gradients.chunks_exact(d)).map(|(a, g)| rest[a * d + k] * g[l]).sum();
        }
    }
    t.determinant()
}

struct Pull<'a> {
    cells: &'a Cells,
    simplex: bool,
    weights: &'a [f64],
    inverses: &'a [f64],
    states: &'a mut [f64],
    x: &'a [[f64; 4]],
    rules: &'a [BranchRule],
    force: &'a mut [[f64; 4]],
    energies: &'a mut [f64],
    sound: &'a mut bool,
}

/// The place of a number of the cells from `first`, a multiple of the lanes.
#[inline(always)]
fn place(first: usize, place: usize, size: usize) -> usize {
    (first / LANES * size + place) * LANES + first % LANES
}

#[inline(always)]
fn load<T: Packed>(zero: &T, list: &[f64], at: usize) -> T {
    let mut lanes = zero.clone();
    lanes.as_mut_slice().copy_from_slice(&list[at..at + T::COUNT]);
    lanes
}

#[inline(always)]
fn store<T: Packed>(list: &mut [f64], at: usize, lanes: &T) {
    list[at..at + T::COUNT].copy_from_slice(lanes.as_slice());
}

impl Visit for Pull<'_> {
    /// A body that relaxes has no cells of fewer dimensions than its space.
    const EMBEDDED: bool = false;

    #[inline(always)]
    fn batch<T: Packed, const D: usize, const S: usize>(
        &mut self,
        zero: T,
        [x, forces]: [&mut [[T; 3]]; 2],
        first: usize,
        count: usize,
    ) {
        let Pull { cells, simplex, weights, inverses, rules, .. } = *self;
        let terms = rules.len();
        let numbers = D * (D + 1) / 2 + usize::from(D < 3);
        cells.gather(self.x, x, first, count);
        if !simplex {
            forces.fill(zero.repeated());
        }
        for q in 0..cells.points {
            let mut t: [[T; 3]; 3] = zero.repeated_rows();
            if simplex {
                for l in 0..D {
                    for k in 0..S {
                        t[l][k] = x[l + 1][k].clone() - &x[0][k];
                    }
                }
                for l in D..3 {
                    t[l][l] = zero.one();
                }
            } else {
                t = cells.tangents::<T, D, S>(zero.clone(), first, q, x);
            }
            let n = slopes::<T, D, S>(&zero, &t);
            let n = if D == 2 { [n[0].clone(), n[1].clone(), zero.repeated()] } else { n };
            let det = dot(&t[0], &n[0]);
            let j = det.clone() * &load(&zero, inverses, place(first, q, cells.points));
            // Lanes without a cell have the shape of another, whose nodes may be in another order.
            *self.sound &= j.exceeds(&zero) || (0..count).all(|lane| j.as_slice()[lane] > 0.0);
            let j = j.magnitude();
            let size = inverse_cube_root(&zero, &j) * &j;
            let inverse = zero.one() / &det;
            let content = size.clone() * &inverse;
            let scale = content.clone() * &inverse;
            // H and the squares of the tangents, whose sum with S is tr(F S Fᵀ).
            let (mut h, mut c): ([T; 6], [T; 6]) = (zero.repeated(), zero.repeated());
            // A loop that is written out would be too long for the compiler to put into the function of the machine's instructions.
            let mut at = 0;
            for l in 0..D {
                for m in l..D {
                    h[at] = dot(&n[l], &n[m]) * &scale;
                    c[at] = dot(&t[l], &t[m]);
                    if m > l {
                        c[at] = c[at].clone() + &c[at];
                    }
                    at += 1;
                }
            }
            let mut pull: [[T; 3]; 3] = zero.repeated_rows();
            let mut push = zero.clone();
            for (i, rule) in rules.iter().enumerate() {
                let weight = load(&zero, weights, place(first, q * terms + i, cells.points * terms));
                push = push.plus_product(&weight, &zero.constant(&T::exact(rule.content)));
                let mut twice = zero.clone();
                let (left, taken) = (zero.constant(&T::exact(rule.left)), zero.constant(&T::exact(rule.taken)));
                let begin = place(first, (q * terms + i) * numbers, cells.points * terms * numbers);
                let states = &mut self.states[begin..begin + (numbers - 1) * LANES + T::COUNT];
                let mut at = 0;
                for l in 0..D {
                    for m in l..D {
                        let s = load(&zero, states, at * LANES);
                        let g = weight.clone() * &s;
                        for k in 0..S {
                            pull[l][k] = pull[l][k].clone().plus_product(&g, &t[m][k]);
                            if m > l {
                                pull[m][k] = pull[m][k].clone().plus_product(&g, &t[l][k]);
                            }
                        }
                        twice = twice.plus_product(&g, &c[at]);
                        store(states, at * LANES, &(s * &left).plus_product(&taken, &h[at]));
                        at += 1;
                    }
                }
                if D < 3 {
                    // Across the plane H is J^(2/3).
                    let across = (numbers - 1) * LANES;
                    let s = load(&zero, states, across);
                    twice = twice.plus_product(&weight, &s);
                    store(states, across, &(s * &left).plus_product(&taken, &size));
                }
                let grown = (weight.clone() * &size).scaled(&T::exact(1.5 * rule.content));
                let own = twice.scaled(&T::exact(0.5)) - &grown;
                // A lane without a cell may have numbers that are none.
                let energy = load(&zero, self.energies, i * LANES) + &weight.choose(&own, &zero);
                store(self.energies, i * LANES, &energy);
            }
            let push = push * &content;
            for l in 0..D {
                for k in 0..S {
                    pull[l][k] = pull[l][k].clone().minus_product(&push, &n[l][k]);
                }
            }
            if simplex {
                for k in 0..S {
                    let mut sum = zero.clone();
                    for l in 0..D {
                        sum = sum - &pull[l][k];
                        forces[l + 1][k] = pull[l][k].clone();
                    }
                    forces[0][k] = sum;
                }
            } else {
                for (a, force) in forces.iter_mut().enumerate() {
                    for l in 0..D {
                        let dn = cells.gradient::<T, D>(&zero, first, [q, a, l]);
                        for k in 0..S {
                            force[k] = force[k].clone().plus_product(&dn, &pull[l][k]);
                        }
                    }
                }
            }
        }
        for lane in 0..count {
            let rows = &cells.rows[(first + lane) * cells.nodes..(first + lane + 1) * cells.nodes];
            for (own, row) in forces.iter().zip(rows) {
                // As one addition of four numbers.
                let [x, y, z] = [own[0].as_slice()[lane], own[1].as_slice()[lane], own[2].as_slice()[lane]];
                let at = &mut self.force[*row as usize];
                *at = [at[0] + x, at[1] + y, at[2] + z, at[3] + 0.0];
            }
        }
    }
}
