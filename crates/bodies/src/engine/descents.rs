//! VBD: sweeps over the points, linearised at rest (Chen, Liu, Yang and Yuksel 2024).
//!
//! Theory: page *Networks in engines* of the book.

use super::history::History;
use super::lanes::{Block, LANES, Lanes, add};
use super::order::point_order;
use super::setting::{Engine, Setting};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Network, SpringGradients};
use nalgebra::DMatrix;

/// The points with their springs, in the order of a sweep.
///
/// A sweep solves `(K + M/h²) d = r`, one point after the other: the step of point i is `H_i⁻¹ (r − (K + M/h²) d)_i` with the block H_i on
/// the diagonal. Points move from their prediction y to `y − d` with `r = K y`.
#[derive(Debug)]
pub(super) struct Descents {
    points: Vec<Point>,
    /// k g of the springs, and their measures: `[springs]` rows of degrees of freedom.
    springs: Vec<Row>,
    /// `m/h²`, `[dofs]`; zero where points are held.
    inertia: Vec<f64>,
    dimension: usize,
    relaxation: f64,
    iterations: usize,
}

#[derive(Debug)]
struct Row {
    dofs: Vec<usize>,
    gradient: Vec<f64>,
    constant: f64,
}

/// A free point.
#[derive(Debug)]
struct Point {
    first: usize,
    /// H⁻¹, `[d × d]`.
    inverse: Vec<f64>,
    /// Each spring of the point, and where its degrees of freedom begin among those of the spring.
    springs: Vec<(usize, usize)>,
    /// The index of its first spring among those of all points.
    place: usize,
}

/// The state of the sweeps.
struct State {
    d: Block,
    /// `g·d` of each spring.
    measures: Block,
}

/// The solver of Newton leaves points where they are whose block has no larger determinant.
// The bound is the `abs(determinant(h)) > 1e-8` of `particle_vbd_kernels.py`, whatever the units are.
const LEAST: f64 = 1e-8;

impl Descents {
    /// The springs of a network with the inverse masses `inverse`, `[dofs]`, 1/kg, zero where points are held.
    ///
    /// # Errors
    /// Newton does not move a point: kind `Unsupported`.
    pub fn new(network: &Network, (at, inverse): (&[f64], &[f64]), setting: &Setting) -> Result<Descents> {
        let d = network.dimension;
        let (gradients, _) = SpringGradients::at(network, at);
        let constants = network.springs().map(|(_, constant)| constant);
        let springs: Vec<Row> = gradients
            .each()
            .zip(constants)
            .map(|((dofs, g), constant)| {
                // Held degrees of freedom do not move.
                let gradient = dofs.iter().zip(g).map(|(&dof, g)| if inverse[dof] > 0.0 { *g } else { 0.0 }).collect();
                Row { dofs: dofs.to_vec(), gradient, constant }
            })
            .collect();
        let sets: Vec<&[usize]> = network.springs().map(|(points, _)| points).collect();
        let square = setting.substep().powi(2);
        let inertia: Vec<f64> = inverse.iter().map(|w| if *w > 0.0 { 1.0 / (w * square) } else { 0.0 }).collect();
        let mut of_point: Vec<Vec<(usize, usize)>> = vec![Vec::new(); at.len() / d.max(1)];
        for (s, points) in sets.iter().enumerate() {
            points.iter().enumerate().for_each(|(a, &p)| of_point[p].push((s, a * d)));
        }
        let (mut points, mut place) = (Vec::new(), 0);
        for p in point_order(setting.order, &sets, of_point.len()) {
            let own = std::mem::take(&mut of_point[p]);
            let first = p * d;
            // A point that is held in all directions has no block, and no step.
            if inverse[first..first + d].iter().all(|w| *w == 0.0) {
                continue;
            }
            let mut block = DMatrix::<f64>::zeros(d, d);
            for &(s, start) in &own {
                let g = &springs[s].gradient[start..start + d];
                for (a, b) in (0..d).flat_map(|a| (0..d).map(move |b| (a, b))) {
                    block[(a, b)] += springs[s].constant * g[a] * g[b];
                }
            }
            for a in 0..d {
                // A held direction has no stiffness either; any number above zero keeps the block regular, and its step
                // is zero.
                block[(a, a)] += if inertia[first + a] > 0.0 { inertia[first + a] } else { 1.0 };
            }
            if setting.engine == Engine::NewtonVbd && !(block.determinant().abs() > LEAST) {
                let expected = format!(
                    "points whose block of the stiffness has a determinant above {LEAST:e} (N/m)³, which Newton moves"
                );
                let found = format!("{:.1e} at point {p}", block.determinant());
                let advice = "; a stiffer or denser body, or shorter substeps, have such points";
                return Err(Error::expected("engine", expected, found)
                    .followed_by(advice)
                    .of_kind(ErrorKind::Unsupported));
            }
            // It is positive definite: springs pull back, and inertia is above zero.
            let Some(inverse) = block.try_inverse() else { continue };
            let count = own.len();
            points.push(Point { first, inverse: inverse.as_slice().to_vec(), springs: own, place });
            place += count;
        }
        let (relaxation, iterations) = (setting.relaxation, setting.iterations);
        Ok(Descents { points, springs, inertia, dimension: d, relaxation, iterations })
    }

    fn places(&self) -> usize {
        self.points.last().map_or(0, |point| point.place + point.springs.len())
    }

    fn at_rest(&self, size: usize) -> State {
        State { d: vec![[0.0; LANES]; size], measures: vec![[0.0; LANES]; self.springs.len()] }
    }

    /// `g·v` of each spring.
    fn measures(&self, v: &Block) -> Block {
        let measure = |row: &Row| {
            let mut sum = [0.0; LANES];
            row.dofs.iter().zip(&row.gradient).for_each(|(&dof, g)| add(&mut sum, &v[dof], *g));
            sum
        };
        self.springs.iter().map(measure).collect()
    }

    /// `Σ_s k_s e_s g_s`.
    fn pull(&self, measures: &Block, size: usize) -> Block {
        let mut forces = vec![[0.0; LANES]; size];
        for (row, measure) in self.springs.iter().zip(measures) {
            row.dofs.iter().zip(&row.gradient).for_each(|(&dof, g)| add(&mut forces[dof], measure, row.constant * g));
        }
        forces
    }

    /// A sweep; `visit` is called with each point, its whole step (before relaxation), and the step that it makes, and the measures before it.
    fn sweep(
        &self,
        State { d, measures }: &mut State,
        wanted: impl Fn(&Point, usize) -> Lanes,
        is_reversed: bool,
        mut visit: impl FnMut(&Point, &[Lanes], &[Lanes], &Block),
    ) {
        let n = self.dimension;
        let (mut residual, mut whole) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for at in 0..self.points.len() {
            // The transpose of a sweep goes over the points in the opposite order.
            let point = &self.points[if is_reversed { self.points.len() - 1 - at } else { at }];
            for a in 0..n {
                let dof = point.first + a;
                residual[a] = wanted(point, a);
                add(&mut residual[a], &d[dof], -self.inertia[dof]);
            }
            for &(s, start) in &point.springs {
                let row = &self.springs[s];
                for a in 0..n {
                    add(&mut residual[a], &measures[s], -row.constant * row.gradient[start + a]);
                }
            }
            for a in 0..n {
                whole[a] = [0.0; LANES];
                for b in 0..n {
                    add(&mut whole[a], &residual[b], point.inverse[a + b * n]);
                }
            }
            let step = whole.map(|step| step.map(|s| self.relaxation * s));
            visit(point, &whole[..n], &step[..n], measures);
            for a in 0..n {
                add(&mut d[point.first + a], &step[a], 1.0);
            }
            for &(s, start) in &point.springs {
                for a in 0..n {
                    // Measures are kept up to date, so that the next point sees this one where it is, without a sum
                    // over the springs.
                    add(&mut measures[s], &step[a], self.springs[s].gradient[start + a]);
                }
            }
        }
    }

    /// The result of the sweeps for the right-hand side r.
    fn solve(&self, r: &Block, is_reversed: bool) -> Block {
        let mut state = self.at_rest(r.len());
        for _ in 0..self.iterations {
            self.sweep(&mut state, |point, a| r[point.first + a], is_reversed, |_, _, _, _| ());
        }
        state.d
    }

    /// `M d/h²`.
    fn inert(&self, d: &Block) -> Block {
        d.iter().zip(&self.inertia).map(|(d, m)| d.map(|d| m * d)).collect()
    }

    /// `K_N y`.
    pub fn apply(&self, y: &Block) -> Block {
        let r = self.pull(&self.measures(y), y.len());
        self.inert(&self.solve(&r, false))
    }

    /// `K_Nᵀ z`: the sweeps in the opposite order.
    pub fn apply_transposed(&self, z: &Block) -> Block {
        let q = self.solve(&self.inert(z), true);
        self.pull(&self.measures(&q), z.len())
    }

    /// What the changes of `K_N y` depend on: `g·y` of each spring, and in each sweep the measure of each spring at each of its points when
    /// that has been moved as a whole.
    pub fn trace(&self, y: &Block) -> History {
        let start = self.measures(y);
        let r = self.pull(&start, y.len());
        let mut state = self.at_rest(y.len());
        let sweep = |_| {
            let mut reached = vec![[0.0; LANES]; self.places()];
            self.sweep(
                &mut state,
                |point, a| r[point.first + a],
                false,
                |point, whole, _, measures| {
                    for (at, &(s, start)) in point.springs.iter().enumerate() {
                        let own = &mut reached[point.place + at];
                        *own = measures[s];
                        whole.iter().enumerate().for_each(|(a, w)| add(own, w, self.springs[s].gradient[start + a]));
                    }
                },
            );
            reached
        };
        History { sweeps: (0..self.iterations).map(sweep).collect(), start, size: y.len() }
    }

    /// The change of `K_N y` where the logarithms of the constants change by `changes`, `[springs]`.
    pub fn change(&self, history: &History, changes: &[f64]) -> Block {
        let mut state = self.at_rest(history.size);
        for reached in &history.sweeps {
            let wanted = |point: &Point, a: usize| {
                let mut sum = [0.0; LANES];
                for (at, &(s, start)) in point.springs.iter().enumerate() {
                    let row = &self.springs[s];
                    let factor = changes[s] * row.constant * row.gradient[start + a];
                    add(&mut sum, &history.start[s], factor);
                    add(&mut sum, &reached[point.place + at], -factor);
                }
                sum
            };
            self.sweep(&mut state, wanted, false, |_, _, _, _| ());
        }
        self.inert(&state.d)
    }

    /// `zᵀ ∂(K_N y)/∂ ln k` of each spring, summed over the loads.
    pub fn sensitivities(&self, history: &History, z: &Block) -> Vec<f64> {
        let c = self.inert(z);
        let mut state = self.at_rest(z.len());
        let mut sums = vec![0.0; self.springs.len()];
        // The adjoint passes through the sweeps from the last to the first.
        for reached in history.sweeps.iter().rev() {
            self.sweep(
                &mut state,
                |point, a| c[point.first + a],
                true,
                |point, _, step, _| {
                    for (at, &(s, start)) in point.springs.iter().enumerate() {
                        let own = &reached[point.place + at];
                        for (a, step) in step.iter().enumerate() {
                            let g = self.springs[s].gradient[start + a];
                            for lane in 0..LANES {
                                sums[s] += g * step[lane] * (history.start[s][lane] - own[lane]);
                            }
                        }
                    }
                },
            );
        }
        sums.iter().zip(&self.springs).map(|(sum, row)| row.constant * sum).collect()
    }
}
