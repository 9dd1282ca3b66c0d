//! Energies whose stresses are asked for many deformations at once: expressions, and functions of the program that uses the library.
//!
//! Theory: page *Sampled fits* of the book.

use super::large::{free_axes, without_stress};
use crate::error::{Error, Result};
use crate::material::{Energy, Material, State};
use nalgebra::Matrix3;
use std::fmt::Debug;
use std::sync::Arc;

/// The stress of a hyperelastic material as a function.
pub trait StressFunction: Debug + Send + Sync {
    /// Writes the first Piola–Kirchhoff stress `P = ∂W/∂F`, Pa, of each deformation gradient F, both row by row; NaN where it is undefined.
    /// F is that of a solid, also of plane bodies.
    ///
    /// # Errors
    /// The function has failed.
    fn stresses(&self, f: &[[f64; 9]], stresses: &mut [[f64; 9]]) -> Result<()>;
}

/// A hyperelastic material whose forces are sampled.
pub trait Hyperelastic: Debug + Sync {
    /// Young's modulus at rest, Pa; the scale of what counts as a small force.
    fn young(&self) -> f64;

    /// Poisson's ratio at rest; the contraction of shapes that are stretched.
    fn poisson(&self) -> f64;

    /// Replaces each F by the stress in this state; NaN where it is undefined. In the plane F has the stretch through the thickness that
    /// the state implies, and on entry any.
    ///
    /// # Errors
    /// A function has failed, or has a stress that is not finite.
    fn stresses(&self, state: State, f: &mut [Matrix3<f64>]) -> Result<()>;
}

impl Hyperelastic for Energy {
    fn young(&self) -> f64 {
        Energy::young(self)
    }

    fn poisson(&self) -> f64 {
        Energy::poisson(self)
    }

    fn stresses(&self, state: State, f: &mut [Matrix3<f64>]) -> Result<()> {
        let free = free_axes(state);
        for f in f {
            *f = match free {
                [] => self.stress(f),
                _ => without_stress(self, *f, free).map_or(Matrix3::repeat(f64::NAN), |(_, stress, _)| stress),
            };
        }
        Ok(())
    }
}

/// The largest stress at rest, as a share of Young's modulus. A function that differentiates an energy by differences
/// leaves some eight digits.
const AT_REST: f64 = 1e-8;
/// The largest number of steps of the search for the free stretches. Newton's steps double the digits, so that a search
/// that takes as many does not end.
const STEPS: usize = 60;
/// The step of a difference in a stretch. Its square, the error of the slope, and the rounding over it are both below
/// 1e-7, which only slows the last steps.
const STEP: f64 = 1e-4;
/// A change of the free stretches after which the next would be below rounding: the slope is known to the square of [`STEP`].
const LAST: f64 = 1e-8;

/// A material whose stress is a function of the program that uses the library.
#[derive(Debug, Clone)]
pub struct EnergyFunction {
    name: String,
    material: Material,
    function: Arc<dyn StressFunction>,
}

impl PartialEq for EnergyFunction {
    fn eq(&self, other: &EnergyFunction) -> bool {
        Arc::ptr_eq(&self.function, &other.function) && (&self.name, self.material) == (&other.name, other.material)
    }
}

impl EnergyFunction {
    /// The function under a name, of a material with these moduli at rest. It is asked for the stress at rest.
    ///
    /// # Errors
    /// The function fails, or there is a stress at rest.
    pub fn new(name: &str, material: Material, function: Arc<dyn StressFunction>) -> Result<EnergyFunction> {
        let own = EnergyFunction { name: name.into(), material, function };
        let mut at_rest = [Matrix3::identity()];
        // The function is asked once before any work: an error in it is told at once.
        own.ask(&mut at_rest)?;
        let stress = at_rest[0].norm();
        if stress > AT_REST * material.young() {
            return Err(Error::expected("energy", "no stress at rest", format!("{stress:.3e} Pa")));
        }
        Ok(own)
    }

    /// The name in reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn ask(&self, f: &mut [Matrix3<f64>]) -> Result<()> {
        let asked: Vec<[f64; 9]> = f.iter().map(|f| std::array::from_fn(|i| f[(i / 3, i % 3)])).collect();
        // An entry that the function leaves unwritten is refused as not finite.
        let mut stresses = vec![[f64::NAN; 9]; asked.len()];
        self.function.stresses(&asked, &mut stresses)?;
        for ((f, p), asked) in f.iter_mut().zip(&stresses).zip(&asked) {
            if !p.iter().all(|entry| entry.is_finite()) {
                let rows: Vec<String> = asked.chunks(3).map(|row| format!("{row:.4?}")).collect();
                let found = format!("others at F = [{}]", rows.join(", "));
                return Err(Error::expected("energy", "finite stresses at the sampled shapes", found));
            }
            *f = Matrix3::from_row_slice(p);
        }
        Ok(())
    }

    /// Sets the free stretches, all equal, to those that leave no stress along them, by Newton steps whose slopes are differences.
    fn relax(&self, f: &mut [Matrix3<f64>], free: &[usize]) -> Result<()> {
        // On entry the stretch along free axes is any; the search begins at rest.
        f.iter_mut().for_each(|f| free.iter().for_each(|&k| f[(k, k)] = 1.0));
        let stretched = |f: &Matrix3<f64>, share: f64| {
            let mut f = *f;
            free.iter().for_each(|&k| f[(k, k)] *= 1.0 + share);
            f
        };
        // The free stretches are equal, so that one number, the work of all of them, is brought to zero.
        let pull = |p: &Matrix3<f64>| free.iter().map(|&k| p[(k, k)]).sum::<f64>();
        let mut moving: Vec<usize> = (0..f.len()).collect();
        for _ in 0..STEPS {
            // The value and both sides of all shapes are asked for at once: a call of the function may cost more than its arithmetic.
            let shares = [0.0, -STEP, STEP];
            let mut asked: Vec<_> = moving.iter().flat_map(|&q| shares.map(|share| stretched(&f[q], share))).collect();
            self.ask(&mut asked)?;
            let mut left = Vec::new();
            for (&q, p) in moving.iter().zip(asked.as_chunks::<3>().0) {
                let stretch = f[q][(free[0], free[0])];
                let slope = (pull(&p[2]) - pull(&p[1])) / (2.0 * STEP * stretch);
                let change = -pull(&p[0]) / slope;
                // The comparison is negated, so that NaN is refused too: a falling pull would send the stretch away
                // from its root.
                if !(slope > 0.0) {
                    let expected = "an energy that resists a stretch through the thickness";
                    return Err(Error::expected("energy", expected, format!("a slope of {slope:.3e} Pa")));
                }
                // A stretch stays above zero, where the energy has a value.
                free.iter().for_each(|&k| f[q][(k, k)] = (stretch + change).max(0.1 * stretch));
                if change.abs() > LAST {
                    left.push(q);
                }
            }
            moving = left;
            if moving.is_empty() {
                return Ok(());
            }
        }
        Err(Error::expected(
            "energy",
            "a stretch without stress through the thickness",
            format!("none in {STEPS} steps"),
        ))
    }
}

impl Hyperelastic for EnergyFunction {
    fn young(&self) -> f64 {
        self.material.young()
    }

    fn poisson(&self) -> f64 {
        self.material.poisson()
    }

    fn stresses(&self, state: State, f: &mut [Matrix3<f64>]) -> Result<()> {
        let free = free_axes(state);
        // Solids and plane strain have no free stretch, and F is complete as it is.
        if !free.is_empty() {
            self.relax(f, free)?;
        }
        self.ask(f)
    }
}
