//! Energy and momentum of a motion, and the balance of energy.
//!
//! Theory: page *Dynamics* of the book.

use crate::scalar::Sum;

/// Energy and momentum at one time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Account {
    /// The time, s.
    pub time: f64,
    /// The kinetic energy `½ vᵀ M v`, J.
    pub kinetic: f64,
    /// The elastic energy U(x), J; NaN if the model has none.
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
    /// The energy that damping forces have dissipated, J.
    pub dissipated: f64,
    /// The energy that the method has gained or lost, `E − E(0) − work + dissipated`, relative to the largest of these
    /// energies so far.
    pub drift: f64,
}

/// The running sums, over all steps and degrees of freedom.
#[derive(Debug)]
pub(super) struct Ledger {
    pub work: Sum,
    pub dissipated: Sum,
    /// The total energy at the start, J.
    pub start: f64,
    /// The largest energy so far, J.
    pub largest: f64,
    /// The forces whose work counts, at the last time: loads on free degrees of freedom, and the forces that move held
    /// ones.
    acting: Vec<f64>,
    /// `C v` at the last time.
    viscous: Vec<f64>,
    /// The kinetic energy of the held degrees of freedom at the last time.
    kinetic: f64,
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
    pub fn new(start: f64, forces: &Forces, held: &[bool], kinetic: f64) -> Ledger {
        let acting = (0..held.len()).map(|dof| acting(forces, held, dof)).collect();
        Ledger {
            work: Sum::default(),
            dissipated: Sum::default(),
            start,
            largest: start.abs(),
            acting,
            viscous: forces.viscous.to_vec(),
            kinetic,
        }
    }

    /// Adds a step with the displacement `way`, at whose end the forces are these and the held degrees of freedom have
    /// this kinetic energy.
    pub fn add(&mut self, way: &[f64], forces: &Forces, held: &[bool], kinetic: f64, is_damped: bool) {
        self.work.add(kinetic - self.kinetic);
        self.kinetic = kinetic;
        for first in (0..way.len()).step_by(BLOCK) {
            // Four sums of each block at a time, because the terms of one sum wait for each other.
            let (mut work, mut dissipated) = ([0.0; 4], [0.0; 4]);
            for dof in first..way.len().min(first + BLOCK) {
                let now = acting(forces, held, dof);
                work[dof % 4] += way[dof] * (self.acting[dof] + now) / 2.0;
                self.acting[dof] = now;
            }
            if is_damped {
                for dof in first..way.len().min(first + BLOCK) {
                    dissipated[dof % 4] += way[dof] * (self.viscous[dof] + forces.viscous[dof]) / 2.0;
                    self.viscous[dof] = forces.viscous[dof];
                }
            }
            self.work.add(work.iter().sum());
            self.dissipated.add(dissipated.iter().sum());
        }
    }
}

fn acting(forces: &Forces, held: &[bool], dof: usize) -> f64 {
    if held[dof] { forces.elastic[dof] + forces.viscous[dof] } else { forces.external[dof] }
}

/// `½ vᵀ M v` of all degrees of freedom and of the held ones, J.
pub(super) fn kinetic(mass: &[f64], held: &[bool], v: &[f64]) -> (f64, f64) {
    let (mut all, mut still) = ([0.0; 4], [0.0; 4]);
    for (dof, ((m, v), held)) in mass.iter().zip(v).zip(held).enumerate() {
        let energy = m * v * v / 2.0;
        all[dof % 4] += energy;
        still[dof % 4] += if *held { energy } else { 0.0 };
    }
    (all.iter().sum(), still.iter().sum())
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
        points.map(|((m, x), v)| m[0] * (x[*k] * v[*l] - x[*l] * v[*k])).sum()
    };
    planes.iter().map(about).collect()
}
