//! Energy and momentum of a motion, and the balance of energy.
//!
//! Theory: page *Dynamics* of the book.

use super::pass::PIECE;
use crate::scalar::Sum;
use rayon::prelude::*;

/// Energy and momentum at one time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Account {
    /// The time, s.
    pub time: f64,
    /// The kinetic energy `½ vᵀ M v`, J.
    pub kinetic: f64,
    /// The elastic energy beyond that at rest, `U(x) − U(X)`, J; NaN if the model has none.
    pub elastic: f64,
    /// The momentum `Σ m v`, `[dimension]`, kg m/s.
    pub momentum: Vec<f64>,
    /// The angular momentum `Σ m (x × v)` about the origin, kg m²/s: about z in the plane, about x, y, z in space.
    pub angular_momentum: Vec<f64>,
    /// The balance of energy, if [`Options::account`](super::Options::account) is set.
    pub balance: Option<EnergyBalance>,
}

impl Account {
    /// The sum of kinetic and elastic energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic
    }
}

/// The balance of energy over the steps so far, by the trapezoidal rule.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EnergyBalance {
    /// The work of loads, gravity and moved supports, J.
    pub work: f64,
    /// The energy that damping forces and relaxing stress have dissipated, J.
    pub dissipated: f64,
    /// The energy that the method has gained or lost, `E − E(0) − work + dissipated`, relative to the largest of these
    /// energies so far, each without the kinetic energy of the held degrees of freedom.
    pub drift: f64,
}

/// The running sums, over all steps and degrees of freedom. The motion of held ones is prescribed: their kinetic energy, which is large
/// where a prescribed displacement jumps, is no part of the sums.
#[derive(Debug, Clone)]
pub(super) struct Ledger {
    pub work: Sum,
    pub dissipated: Sum,
    /// The energy at the start, J.
    pub start: f64,
    /// The largest energy so far, J.
    pub largest: f64,
    /// The kinetic energy of the held degrees of freedom at the start, J.
    pub held: f64,
    /// The forces whose work counts, at the last time: loads on free degrees of freedom, and the forces that move held
    /// ones.
    acting: Vec<f64>,
    /// `C v` at the last time.
    viscous: Vec<f64>,
}

/// The number of degrees of freedom whose work is added before it goes to the running sums, which are compensated.
const BLOCK: usize = 32;

/// The forces of a state, `[points · dimension]`, N.
pub(super) struct Forces<'a> {
    pub external: &'a [f64],
    pub elastic: &'a [f64],
    pub viscous: &'a [f64],
}

impl Ledger {
    /// Opens the ledger of a motion that starts with the energy `start`, J, and whose held degrees of freedom start with the kinetic energy
    /// `still`, J.
    pub fn new(start: f64, forces: &Forces, held: &[bool], still: f64) -> Ledger {
        Ledger {
            work: Sum::default(),
            dissipated: Sum::default(),
            start,
            largest: start.abs(),
            held: still,
            acting: (0..held.len()).map(|dof| acting(forces, held, dof)).collect(),
            viscous: forces.viscous.to_vec(),
        }
    }

    /// Adds a step with the displacement `way`, at whose end the forces are these.
    pub fn add(&mut self, way: &[f64], forces: &Forces, held: &[bool], is_damped: bool) {
        let piece = |at: usize, acted: &mut [f64], resisted: &mut [f64]| {
            let (mut work, mut dissipated) = (Sum::default(), Sum::default());
            let blocks = acted.chunks_mut(BLOCK).zip(resisted.chunks_mut(BLOCK));
            for (first, (acted, resisted)) in (at * PIECE..).step_by(BLOCK).zip(blocks) {
                // Four sums of each block at a time, because the terms of one sum wait for each other.
                let (mut done, mut lost) = ([0.0; 4], [0.0; 4]);
                for (i, acted) in acted.iter_mut().enumerate() {
                    let now = acting(forces, held, first + i);
                    // The mean of both ends gives the work exactly where the force changes linearly along the way.
                    done[i % 4] += way[first + i] * (*acted + now) / 2.0;
                    *acted = now;
                }
                if is_damped {
                    for (i, resisted) in resisted.iter_mut().enumerate() {
                        let now = forces.viscous[first + i];
                        lost[i % 4] += way[first + i] * (*resisted + now) / 2.0;
                        *resisted = now;
                    }
                }
                work.add(done.iter().sum());
                dissipated.add(lost.iter().sum());
            }
            [work.value(), dissipated.value()]
        };
        let (acted, resisted) = (&mut self.acting, &mut self.viscous);
        // Pieces have one length on any number of threads, and their sums are added in the order of the pieces: the
        // account has the same bits everywhere.
        let sums = match way.len() {
            0..=PIECE => vec![piece(0, acted, resisted)],
            _ => {
                let pieces = (acted.par_chunks_mut(PIECE), resisted.par_chunks_mut(PIECE)).into_par_iter();
                pieces.enumerate().map(|(at, (acted, resisted))| piece(at, acted, resisted)).collect()
            }
        };
        for [work, dissipated] in sums {
            self.work.add(work);
            self.dissipated.add(dissipated);
        }
    }
}

fn acting(forces: &Forces, held: &[bool], dof: usize) -> f64 {
    // A held point is moved by what the body resists with; a load on it does no work on the body.
    if held[dof] { forces.elastic[dof] + forces.viscous[dof] } else { forces.external[dof] }
}

/// `½ vᵀ M v` of the free degrees of freedom and of the held ones, J.
pub(super) fn kinetic(mass: &[f64], held: &[bool], v: &[f64]) -> (f64, f64) {
    let piece = |mass: &[f64], held: &[bool], v: &[f64]| {
        let (mut free, mut still) = ([0.0; 4], [0.0; 4]);
        for (dof, ((m, v), held)) in mass.iter().zip(v).zip(held).enumerate() {
            let energy = m * v * v / 2.0;
            free[dof % 4] += if *held { 0.0 } else { energy };
            still[dof % 4] += if *held { energy } else { 0.0 };
        }
        (free.iter().sum::<f64>(), still.iter().sum::<f64>())
    };
    if v.len() <= PIECE {
        return piece(mass, held, v);
    }
    // Pieces of one length, added in their order, have the same sum on any number of threads.
    let pieces = (mass.par_chunks(PIECE), held.par_chunks(PIECE), v.par_chunks(PIECE)).into_par_iter();
    let sums: Vec<(f64, f64)> = pieces.map(|(mass, held, v)| piece(mass, held, v)).collect();
    sums.iter().fold((0.0, 0.0), |(free, still), sum| (free + sum.0, still + sum.1))
}

/// `Σ m v` of points with `d` coordinates; `mass` is given by degree of freedom.
pub(super) fn momentum(mass: &[f64], v: &[f64], d: usize) -> Vec<f64> {
    (0..d).map(|k| mass.chunks_exact(d).zip(v.chunks_exact(d)).map(|(m, v)| m[k] * v[k]).sum()).collect()
}

/// `Σ m (x × v)` of points with `d` coordinates.
pub(super) fn angular_momentum(mass: &[f64], x: &[f64], v: &[f64], d: usize) -> Vec<f64> {
    let planes: &[[usize; 2]] = match d {
        1 => &[],
        2 => &[[0, 1]],
        _ => &[[1, 2], [2, 0], [0, 1]],
    };
    let about = |[k, l]: &[usize; 2]| {
        let points = mass.chunks_exact(d).zip(x.chunks_exact(d)).zip(v.chunks_exact(d));
        // A point has the same mass along all axes.
        points.map(|((m, x), v)| m[0] * (x[*k] * v[*l] - x[*l] * v[*k])).sum()
    };
    planes.iter().map(about).collect()
}
