//! Springs on the content of cells by their quadrature, and of single points of it: hexahedra and other cells whose content is no
//! single determinant, membranes and fibres. Cells are evaluated side by side, one per lane, in `f64` whatever the numbers of the
//! positions are.
//!
//! With the tangents `t_l = Σ_a x_a ∂N_a/∂ξ_l`, completed by the remaining axes in a cell that fills its space, the content per
//! weight is `c = t_1 · (t_2 × t_3)`, and `∂c/∂t_1 = t_2 × t_3`, and cyclically; that of a curve is `‖t_1‖`, that of a surface
//! `‖t_1 × t_2‖`. The force of a node is `Σ_l T ∂c/∂t_l ∂N_a/∂ξ_l`.

use super::laws::{Lawful, Laws, LawsRoom};
use super::tables::{Cells, Tables, merged};
use super::tangents::{content, slopes};
use crate::model::network::{MeasureSpring, Network};
use crate::scalar::{Coordinate, Packed, PackedWork, vectorized, widest};
use crate::springs::Measure;

/// A spring on the whole content of a cell, `Σ_q w_q c_q`.
#[derive(Debug)]
struct Whole {
    table: usize,
    cell: usize,
    weights: Vec<f64>,
    /// Its index among the other springs of the network.
    spring: usize,
}

/// The cells of a network that are measured by quadrature, each once per table of gradients.
#[derive(Debug, Default)]
pub struct Contents {
    tables: Vec<Cells>,
    /// Linear springs pull with `slope · c − pull` along `∇c`, `[points of all cells]`.
    slopes: Vec<f64>,
    pulls: Vec<f64>,
    wholes: Vec<Whole>,
    laws: Laws,
}

/// What is computed before the forces, in memory that is kept.
#[derive(Debug, Default)]
pub struct ContentsRoom {
    /// c of every point, and what pulls along its gradient, `[points of all cells]`.
    contents: Vec<f64>,
    tensions: Vec<f64>,
    laws: LawsRoom,
}

impl Contents {
    pub fn new(network: &Network, springs: &[usize], place: &[usize]) -> Contents {
        let mut tables = Tables::default();
        let mut found = Vec::new();
        for &s in springs {
            let spring = &network.others[s];
            let (table, point) = match &spring.measure {
                Measure::Content(element) => (&element.tabulation, None),
                Measure::PointContent(element, q) => (&element.tabulation, Some(*q as usize)),
                Measure::Span(table) => (&**table, Some(0)),
                Measure::Length
                | Measure::Patch(_)
                | Measure::Turns(_)
                | Measure::Squares(_)
                | Measure::Function(_) => continue,
            };
            let at = tables.cell(table, spring.points.iter().map(|&p| place[p] as u32).collect());
            found.push((s, table, point, at));
        }
        let (tables, homes) = merged(tables.cells);
        let mut all = Contents { tables, ..Contents::default() };
        let mut count = 0;
        for cells in &mut all.tables {
            cells.first = count;
            count += cells.rows.len() / cells.nodes * cells.points;
        }
        (all.slopes, all.pulls) = (vec![0.0; count], vec![0.0; count]);
        let mut lawful = Vec::new();
        for (s, table, point, (index, cell)) in found {
            // Tables with few cells went together.
            let [index, cell] = [homes[index][0], homes[index][1] + cell];
            let (spring, cells) = (&network.others[s], &all.tables[index]);
            let Some(q) = point else {
                let weights = match table.points() {
                    1 => vec![table.point_weight(0)],
                    _ => table.weights.clone(),
                };
                all.wholes.push(Whole { table: index, cell, weights, spring: s });
                continue;
            };
            let (at, scale) = (cells.first + cell * cells.points + q, table.point_weight(q));
            if spring.law.is_some() {
                lawful.push(Lawful { cell: at, scale, spring: s });
            } else {
                // Linear springs on one point of a cell add up to one, which is evaluated once.
                // The energy `k/2 (w c − c₀)²` pulls on c with `k w² c − k w c₀`.
                all.slopes[at] += spring.constant * scale * scale;
                all.pulls[at] += spring.constant * scale * spring.rest;
            }
        }
        // In the order of the cells, whose contents are then read one after the other.
        lawful.sort_by_key(|lawful| lawful.cell);
        all.laws = Laws::new(network, &lawful);
        all
    }

    /// Adds the forces of the rows, as (z, x, y); false if a spring has none.
    pub fn pull<N: Coordinate>(
        &self,
        space: usize,
        others: &[MeasureSpring],
        x: &[[N; 4]],
        room: &mut ContentsRoom,
        force: &mut [[N; 4]],
    ) -> bool {
        if self.tables.is_empty() {
            return true;
        }
        let ContentsRoom { contents, tensions, laws } = room;
        contents.resize(self.slopes.len(), 0.0);
        for cells in &self.tables {
            cells.visit(space, Measures { cells, x, contents });
        }
        tensions.clear();
        let terms = contents.iter().zip(&self.slopes).zip(&self.pulls);
        tensions.extend(terms.map(|((c, slope), pull)| slope * c - pull));
        let mut sound = self.laws.pull(|at| contents[at], laws, tensions);
        for Whole { table, cell, weights, spring } in &self.wholes {
            let cells = &self.tables[*table];
            let first = cells.first + cell * cells.points;
            let content: f64 = weights.iter().zip(&contents[first..]).map(|(w, c)| w * c).sum();
            let tension = others[*spring].tension(content);
            weights.iter().zip(&mut tensions[first..]).for_each(|(w, t)| *t += w * tension);
        }
        // A sum is quicker to ask; that of finite numbers may overflow, and they are asked one by one.
        sound &= tensions.iter().sum::<f64>().is_finite() || tensions.iter().all(|t| t.is_finite());
        for cells in &self.tables {
            cells.visit(space, Pulls { cells, x, tensions, force });
        }
        sound
    }
}

/// Whether a spring is measured by quadrature.
pub fn is_measured_by_quadrature(spring: &MeasureSpring) -> bool {
    match &spring.measure {
        Measure::Content(_) | Measure::PointContent(..) | Measure::Span(_) => true,
        Measure::Length | Measure::Patch(_) | Measure::Turns(_) | Measure::Squares(_) | Measure::Function(_) => false,
    }
}

/// What is done with a batch of cells.
pub(super) trait Visit {
    /// Whether cells may have fewer dimensions than their space.
    const EMBEDDED: bool = true;

    /// `room` is memory for the positions of the nodes and the forces on them, `[nodes]` each.
    fn batch<T: Packed, const D: usize, const S: usize>(
        &mut self,
        zero: T,
        room: [&mut [[T; 3]]; 2],
        first: usize,
        count: usize,
    );
}

impl Cells {
    /// Visits all cells, as many at a time as there are lanes.
    pub(super) fn visit<V: Visit>(&self, space: usize, visit: V) {
        widest(Batches { visit, cells: self, space });
    }

    /// The nodes of cell number `first + lane`; lanes beyond the last cell repeat the first.
    #[inline(always)]
    pub(super) fn gather<T: Packed, N: Coordinate>(
        &self,
        x: &[[N; 4]],
        nodes: &mut [[T; 3]],
        first: usize,
        count: usize,
    ) {
        for lane in 0..T::COUNT {
            // Lanes beyond the last cell repeat the first one of the batch, whose numbers are finite. Nothing is taken
            // from them.
            let cell = first + if lane < count { lane } else { 0 };
            let rows = &self.rows[cell * self.nodes..(cell + 1) * self.nodes];
            for (node, row) in nodes.iter_mut().zip(rows) {
                let x = &x[*row as usize];
                for k in 0..3 {
                    node[k].as_mut_slice()[lane] = x[k].wide();
                }
            }
        }
    }

    /// `∂N_a/∂ξ_l` at point q of the cells from `first`.
    #[inline(always)]
    pub(super) fn gradient<T: Packed, const D: usize>(&self, zero: &T, first: usize, [q, a, l]: [usize; 3]) -> T {
        self.gradients.at(zero, first, [(q * self.nodes + a) * D + l, self.points * self.nodes * D])
    }

    /// `t_l` at point q of the cells from `first`, completed by axes.
    #[inline(always)]
    pub(super) fn tangents<T: Packed, const D: usize, const S: usize>(
        &self,
        zero: T,
        first: usize,
        q: usize,
        x: &[[T; 3]],
    ) -> [[T; 3]; 3] {
        let mut t: [[T; 3]; 3] = zero.repeated_rows();
        for (a, x) in x.iter().enumerate() {
            for l in 0..D {
                let dn = self.gradient::<T, D>(&zero, first, [q, a, l]);
                for k in 0..S {
                    t[l][k] = t[l][k].clone().plus_product(&dn, &x[k]);
                }
            }
        }
        if D == S {
            for l in D..3 {
                // With unit vectors in place of the missing tangents the determinant in space is that of the plane or
                // the line.
                t[l][l] = zero.one();
            }
        }
        t
    }
}

struct Batches<'a, V> {
    visit: V,
    cells: &'a Cells,
    space: usize,
}

impl<V: Visit> PackedWork for Batches<'_, V> {
    type Output = ();

    fn run<T: Packed>(mut self, zero: T) {
        let mut nodes: Vec<[T; 3]> = vec![zero.repeated(); self.cells.nodes];
        let mut forces = nodes.clone();
        let (any, room) = (zero.clone(), [&mut nodes[..], &mut forces[..]]);
        vectorized!(
            zero,
            match (self.cells.dimension, self.space) {
                (1, 2) if V::EMBEDDED => self.each::<T, 1, 2>(any, room),
                (1, 3) if V::EMBEDDED => self.each::<T, 1, 3>(any, room),
                (2, 3) if V::EMBEDDED => self.each::<T, 2, 3>(any, room),
                (1, _) => self.each::<T, 1, 1>(any, room),
                (2, _) => self.each::<T, 2, 2>(any, room),
                _ => self.each::<T, 3, 3>(any, room),
            }
        );
    }
}

impl<V: Visit> Batches<'_, V> {
    #[inline(always)]
    fn each<T: Packed, const D: usize, const S: usize>(&mut self, zero: T, [nodes, forces]: [&mut [[T; 3]]; 2]) {
        let all = self.cells.rows.len() / self.cells.nodes;
        for first in (0..all).step_by(T::COUNT) {
            self.visit.batch::<T, D, S>(zero.clone(), [nodes, forces], first, T::COUNT.min(all - first));
        }
    }
}

/// Writes c of every point.
struct Measures<'a, N> {
    cells: &'a Cells,
    x: &'a [[N; 4]],
    contents: &'a mut [f64],
}

impl<N: Coordinate> Visit for Measures<'_, N> {
    #[inline(always)]
    fn batch<T: Packed, const D: usize, const S: usize>(
        &mut self,
        zero: T,
        [x, _]: [&mut [[T; 3]]; 2],
        first: usize,
        count: usize,
    ) {
        let cells = self.cells;
        cells.gather(self.x, x, first, count);
        for q in 0..cells.points {
            let c = content::<T, D, S>(&zero, &cells.tangents::<T, D, S>(zero.clone(), first, q, x));
            for lane in 0..count {
                self.contents[cells.first + (first + lane) * cells.points + q] = c.as_slice()[lane];
            }
        }
    }
}

/// Adds `T ∇c` of every point.
struct Pulls<'a, N> {
    cells: &'a Cells,
    x: &'a [[N; 4]],
    tensions: &'a [f64],
    force: &'a mut [[N; 4]],
}

impl<N: Coordinate> Visit for Pulls<'_, N> {
    #[inline(always)]
    fn batch<T: Packed, const D: usize, const S: usize>(
        &mut self,
        zero: T,
        [x, forces]: [&mut [[T; 3]]; 2],
        first: usize,
        count: usize,
    ) {
        let cells = self.cells;
        cells.gather(self.x, x, first, count);
        forces.fill(zero.repeated());
        for q in 0..cells.points {
            let mut tension = zero.clone();
            for lane in 0..count {
                tension.as_mut_slice()[lane] = self.tensions[cells.first + (first + lane) * cells.points + q];
            }
            let mut g = slopes::<T, D, S>(&zero, &cells.tangents::<T, D, S>(zero.clone(), first, q, x));
            for l in 0..D {
                for k in 0..S {
                    g[l][k] = g[l][k].clone() * &tension;
                }
            }
            for (a, force) in forces.iter_mut().enumerate() {
                for l in 0..D {
                    let dn = cells.gradient::<T, D>(&zero, first, [q, a, l]);
                    for k in 0..S {
                        force[k] = force[k].clone().plus_product(&dn, &g[l][k]);
                    }
                }
            }
        }
        for lane in 0..count {
            let rows = &cells.rows[(first + lane) * cells.nodes..(first + lane + 1) * cells.nodes];
            for (own, row) in forces.iter().zip(rows) {
                let at = &mut self.force[*row as usize];
                for k in 0..S {
                    at[(k + 1) % 3] = at[(k + 1) % 3] + N::of(own[k].as_slice()[lane]);
                }
            }
        }
    }
}
