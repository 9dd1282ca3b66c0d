//! XPBD: sweeps over the springs, linearised at rest (Macklin, Müller and Chentanez 2016).
//!
//! Theory: page *Networks in engines* of the book.

use super::history::History;
use super::lanes::{Block, LANES, Lanes, add};
use super::sequence::Sequence;
use super::setting::{Engine, Setting, Sweep};
use crate::model::{Network, SpringGradients};

/// The springs as constraints, in the order of a sweep.
///
/// A sweep solves `(J W Jᵀ + α̃) λ = −J y` with the softness `α̃ = 1/(k h²)`, one row after the other: with the present displacements
/// `x = y + W Jᵀ λ` the step of row j is `Δ = −(g_j·x + α̃_j λ_j)/(g_j·W g_j + α̃_j)`.
#[derive(Debug)]
pub(super) struct Constraints {
    /// The index at which each constraint begins in `dofs`, `[constraints + 1]`.
    starts: Vec<usize>,
    dofs: Vec<usize>,
    /// g.
    gradients: Vec<f64>,
    /// W g.
    moves: Vec<f64>,
    /// `g·W g + α̃`, `[constraints]`; zero where no point is free.
    diagonal: Vec<f64>,
    /// α̃, `[constraints]`.
    softness: Vec<f64>,
    /// The spring that each constraint is, by its index in the network.
    springs: Vec<usize>,
    sweep: Sweep,
    /// ω, `[constraints]`.
    relaxation: Vec<f64>,
    iterations: usize,
    /// h².
    square: f64,
}

/// What a sweep adds to the residuals: changes of the softness, and what each is multiplied by.
type Source<'a> = Option<(&'a [f64], &'a Block)>;

/// Steps of the power method.
// For the springs of 1 536 hexahedra 100 steps miss 2e-3 of the eigenvalue, 200 miss 1.5e-4, and 500 miss 1e-6. The
// bound of stable sweeps is 1 % below 2.
const POWERS: usize = 200;

impl Constraints {
    /// The springs of a network with the inverse masses `inverse`, `[dofs]`, 1/kg, zero where points are held. With `is_rigid` all
    /// compliances are zero.
    pub fn new(
        network: &Network,
        (points, inverse): (&[f64], &[f64]),
        setting: &Setting,
        is_rigid: bool,
    ) -> Constraints {
        let (gradients, _) = SpringGradients::at(network, points);
        let rows: Vec<(&[usize], &[f64])> = gradients.each().collect();
        let sets: Vec<&[usize]> = network.springs().map(|(points, _)| points).collect();
        let (dimension, lengths) = (network.dimension, network.lengths.len());
        let held: Vec<bool> = inverse.chunks_exact(dimension.max(1)).map(|w| w.iter().all(|w| *w == 0.0)).collect();
        let order = Sequence { springs: &sets, lengths, points, dimension, held: &held }.order(setting.order);
        let constants: Vec<f64> = network.springs().map(|(_, constant)| constant).collect();
        let square = setting.substep().powi(2);
        let mut all = Constraints {
            starts: vec![0],
            dofs: Vec::new(),
            gradients: Vec::new(),
            moves: Vec::new(),
            diagonal: Vec::new(),
            softness: Vec::new(),
            springs: order.clone(),
            sweep: setting.sweep,
            relaxation: Vec::new(),
            iterations: setting.iterations,
            square,
        };
        for &spring in &order {
            let (dofs, g) = rows[spring];
            all.dofs.extend(dofs);
            all.gradients.extend(g);
            all.moves.extend(dofs.iter().zip(g).map(|(&dof, g)| inverse[dof] * g));
            all.starts.push(all.dofs.len());
            let softness = if is_rigid { 0.0 } else { 1.0 / (constants[spring] * square) };
            let stiff: f64 = dofs.iter().zip(g).map(|(&dof, g)| inverse[dof] * g * g).sum();
            all.diagonal.push(if stiff > 0.0 { stiff + softness } else { 0.0 });
            all.softness.push(softness);
            // Newton relaxes the corrections of contents alone.
            let is_relaxed = setting.engine != Engine::NewtonXpbd || spring >= lengths;
            all.relaxation.push(if is_relaxed { setting.relaxation } else { 1.0 });
        }
        all
    }

    fn len(&self) -> usize {
        self.springs.len()
    }

    /// `Δ` of a row, and where its degrees of freedom are.
    #[inline(always)]
    fn step(&self, row: usize, x: &[Lanes], multiplier: &Lanes, source: Source) -> (Lanes, std::ops::Range<usize>) {
        let at = self.starts[row]..self.starts[row + 1];
        let mut residual = [0.0; LANES];
        add(&mut residual, multiplier, self.softness[row]);
        for (&dof, g) in self.dofs[at.clone()].iter().zip(&self.gradients[at.clone()]) {
            add(&mut residual, &x[dof], *g);
        }
        if let Some((changes, factors)) = source {
            add(&mut residual, &factors[row], changes[row]);
        }
        // A spring between held points moves nothing, and without compliance its row is zero.
        let factor = if self.diagonal[row] > 0.0 { -1.0 / self.diagonal[row] } else { 0.0 };
        (residual.map(|r| factor * r), at)
    }

    #[inline(always)]
    fn move_by(&self, step: &Lanes, at: std::ops::Range<usize>, x: &mut [Lanes]) {
        for (&dof, w) in self.dofs[at.clone()].iter().zip(&self.moves[at]) {
            add(&mut x[dof], step, *w);
        }
    }

    /// A sweep from the displacements x and the multipliers; `visit` is called with each row, `λ + Δ`, and `ω Δ`.
    fn sweep(
        &self,
        (x, multipliers): (&mut Block, &mut Block),
        is_reversed: bool,
        source: Source,
        mut visit: impl FnMut(usize, Lanes, &Lanes),
    ) {
        let n = self.len();
        let mut steps = Vec::new();
        for at in 0..n {
            // The transpose of a sweep takes the rows in the opposite order.
            let row = if is_reversed { n - 1 - at } else { at };
            let (whole, dofs) = self.step(row, x, &multipliers[row], source);
            let step = whole.map(|w| self.relaxation[row] * w);
            let mut reached = multipliers[row];
            add(&mut reached, &whole, 1.0);
            visit(row, reached, &step);
            match self.sweep {
                Sweep::GaussSeidel => {
                    add(&mut multipliers[row], &step, 1.0);
                    self.move_by(&step, dofs, x);
                }
                Sweep::Jacobi => steps.push((row, step)),
            }
        }
        for (row, step) in steps {
            add(&mut multipliers[row], &step, 1.0);
            self.move_by(&step, self.starts[row]..self.starts[row + 1], x);
        }
    }

    /// `−Jᵀ λ/h²`.
    fn forces(&self, multipliers: &Block, size: usize) -> Block {
        let mut forces = vec![[0.0; LANES]; size];
        for (row, multiplier) in multipliers.iter().enumerate() {
            let at = self.starts[row]..self.starts[row + 1];
            for (&dof, g) in self.dofs[at.clone()].iter().zip(&self.gradients[at]) {
                add(&mut forces[dof], multiplier, -g / self.square);
            }
        }
        forces
    }

    /// The largest eigenvalue of `ω D⁻¹ A`, by the power method: sweeps that take all springs at once grow without bound from 2 on.
    pub fn growth(&self, size: usize) -> f64 {
        // Rough, and the same in each run: it has a part of every motion, also of the one that grows most.
        let mut multipliers: Block = (0..self.len()).map(|row| [(1.0 + 1.3 * row as f64).sin(); LANES]).collect();
        let mut growth = 0.0;
        for _ in 0..POWERS {
            let mut x = vec![[0.0; LANES]; size];
            for (row, multiplier) in multipliers.iter().enumerate() {
                self.move_by(multiplier, self.starts[row]..self.starts[row + 1], &mut x);
            }
            let next = |row: usize| self.step(row, &x, &multipliers[row], None).0.map(|s| -self.relaxation[row] * s);
            let next: Block = (0..self.len()).map(next).collect();
            growth = next.iter().map(|m| m[0] * m[0]).sum::<f64>().sqrt();
            if growth == 0.0 {
                break;
            }
            multipliers = next.into_iter().map(|m| m.map(|m| m / growth)).collect();
        }
        growth
    }

    /// `K_N y`, or `K_Nᵀ y` by the sweeps in the opposite order.
    pub fn apply(&self, y: &Block, is_transposed: bool) -> Block {
        let (mut x, mut multipliers) = (y.clone(), vec![[0.0; LANES]; self.len()]);
        for _ in 0..self.iterations {
            self.sweep((&mut x, &mut multipliers), is_transposed, None, |_, _, _| ());
        }
        self.forces(&multipliers, y.len())
    }

    /// What the changes of `K_N y` depend on: `s = λ + Δ` of each row in each sweep.
    pub fn trace(&self, y: &Block) -> History {
        let (mut x, mut multipliers) = (y.clone(), vec![[0.0; LANES]; self.len()]);
        let sweep = |_| {
            let mut reached = vec![[0.0; LANES]; self.len()];
            self.sweep((&mut x, &mut multipliers), false, None, |row, whole, _| reached[row] = whole);
            reached
        };
        History { start: Block::new(), sweeps: (0..self.iterations).map(sweep).collect(), size: y.len() }
    }

    /// The change of `K_N y` where the logarithms of the constants change by `changes`, `[springs]`: `Σ_k` of sweeps that begin with
    /// the residual `dα̃ s_k`.
    pub fn change(&self, history: &History, changes: &[f64]) -> Block {
        let softer: Vec<f64> =
            self.springs.iter().zip(&self.softness).map(|(&spring, soft)| -soft * changes[spring]).collect();
        let (mut x, mut multipliers) = (vec![[0.0; LANES]; history.size], vec![[0.0; LANES]; self.len()]);
        for reached in &history.sweeps {
            self.sweep((&mut x, &mut multipliers), false, Some((&softer, reached)), |_, _, _| ());
        }
        self.forces(&multipliers, history.size)
    }

    /// `zᵀ ∂(K_N y)/∂ ln k` of each spring, summed over the loads: with `p_k` the steps of the sweeps for z in the opposite order,
    /// `(α̃/h²) Σ_k p_{N+1−k} s_k`.
    pub fn sensitivities(&self, history: &History, z: &Block) -> Vec<f64> {
        let mut sums = vec![0.0; self.len()];
        let (mut x, mut multipliers) = (z.clone(), vec![[0.0; LANES]; self.len()]);
        // The first step of the transposed sweeps meets the last sweep.
        for reached in history.sweeps.iter().rev() {
            self.sweep((&mut x, &mut multipliers), true, None, |row, _, step| {
                sums[row] += step.iter().zip(&reached[row]).map(|(p, s)| p * s).sum::<f64>();
            });
        }
        let mut all = vec![0.0; self.len()];
        for (row, &spring) in self.springs.iter().enumerate() {
            all[spring] = self.softness[row] / self.square * sums[row];
        }
        all
    }
}
