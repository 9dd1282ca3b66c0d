//! What an energy must be at rest: free of stress, and as stiff as the linear material.

use super::energy::Energy;
use super::response::Tangent;
use crate::error::{Error, Result};
use nalgebra::{Matrix3, Matrix6};

/// The largest stress at rest, relative to the stiffness. Terms of the energy cancel at rest up to rounding, unless a
/// constant of the file is not what the others ask for.
const STRESS: f64 = 1e-10;
/// The largest relative difference of a modulus at rest from that of the material, which files give with a few digits.
const MODULI: f64 = 1e-3;
/// Principal stretches that all differ, to compare energies of exchanged ones.
const STRETCHES: [f64; 3] = [0.9, 1.05, 1.2];
/// The pairs ij of Kelvin's notation.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

impl Energy {
    /// Proves the energy at rest.
    ///
    /// # Errors
    /// It has stress, a motion without stiffness, other moduli than `young` and `poisson`, or directions without fibres.
    pub(super) fn check_rest(&self) -> Result<()> {
        let (_, stress, tangent) = self.respond(&Matrix3::identity());
        let size = tangent.norm();
        if !(size > 0.0 && size.is_finite()) {
            return Err(Error::at("energy", "has no finite, positive stiffness at rest"));
        }
        if stress.norm() > STRESS * size {
            return Err(Error::expected("energy", "no stress at rest", format!("{:.3e} Pa", stress.norm())));
        }
        let c = kelvin(&tangent);
        let least = c.symmetric_eigenvalues().min();
        if !(least > 0.0) {
            let found = format!("one that has {least:.3e} Pa");
            return Err(Error::expected("energy", "a positive stiffness at rest in every strain", found));
        }
        // Fibres add what the moduli of the file do not have: neither isotropy nor these moduli can be asked for.
        if self.has_fibres() {
            return Ok(());
        }
        self.check_directions(size)?;
        let moduli = self.moduli();
        let [bulk, shear] = isotropic(&c);
        let is_near = |found: f64, asked: f64| (found / asked - 1.0).abs() <= MODULI;
        if !is_near(bulk, moduli.lambda + 2.0 / 3.0 * moduli.mu) || !is_near(shear, moduli.mu) {
            let (young, poisson) = engineering(bulk, shear);
            let expected = format!("the stiffness of E = {:e} Pa and nu = {} at rest", self.young(), self.poisson());
            return Err(Error::expected(
                "energy",
                expected,
                format!("that of E = {young:.4e} Pa and nu = {poisson:.4}"),
            ));
        }
        if (c - of(bulk, shear)).norm() > MODULI * shear {
            return Err(Error::expected("energy", ISOTROPIC, "one whose stiffness at rest depends on the direction"));
        }
        Ok(())
    }

    /// Energies of the principal stretches must not change if these are exchanged; `size` is that of the stiffness.
    fn check_directions(&self, size: f64) -> Result<()> {
        let [a, b, c] = STRETCHES;
        let of = |[l1, l2, l3]: [f64; 3]| {
            let squares = [l1 * l1, l2 * l2, l3 * l3];
            let i2 = squares[0] * squares[1] + squares[1] * squares[2] + squares[2] * squares[0];
            let variables = [squares.iter().sum(), i2, l1 * l2 * l3, 1.0, l1, l2, l3];
            let at: Vec<f64> = variables.into_iter().chain(self.constants.iter().copied()).collect();
            self.formula.expression.evaluate(&at)
        };
        let given = of([a, b, c]);
        // Terms with exchanged stretches are summed in another order, which changes some of the last digits.
        // Two exchanges of neighbours make all orders.
        if [[b, a, c], [a, c, b]].map(of).iter().any(|other| (other - given).abs() > 1e-9 * size) {
            return Err(Error::expected("energy", ISOTROPIC, "one that changes if l1, l2 and l3 are exchanged"));
        }
        Ok(())
    }

    /// `‖C − C₀‖/‖C₀‖`, how far the elasticity tensor at rest is from that of `young` and `poisson`: what fibres add.
    pub fn distance_at_rest(&self) -> f64 {
        let (.., tangent) = self.respond(&Matrix3::identity());
        let moduli = self.moduli();
        let isotropic = of(moduli.lambda + 2.0 / 3.0 * moduli.mu, moduli.mu);
        (kelvin(&tangent) - isotropic).norm() / isotropic.norm()
    }
}

const ISOTROPIC: &str = "an energy without directions, unless it has fibres";

/// The tangent without stress on symmetric strains, in Kelvin's notation.
fn kelvin(tangent: &Tangent) -> Matrix6<f64> {
    let entry = |(i, j): (usize, usize), (k, l): (usize, usize)| tangent[(3 * i + j, 3 * k + l)];
    // Kelvin's shears are √2 times those of the tensor, and the sum below has each of them twice.
    let scale = |(i, j): (usize, usize)| if i == j { 1.0 } else { 0.5 * 2f64.sqrt() };
    Matrix6::from_fn(|row, column| {
        let ((i, j), (k, l)) = (PAIRS[row], PAIRS[column]);
        let rows = if i == j { vec![(i, j)] } else { vec![(i, j), (j, i)] };
        let columns = if k == l { vec![(k, l)] } else { vec![(k, l), (l, k)] };
        let sum: f64 = rows.iter().flat_map(|a| columns.iter().map(move |b| entry(*a, *b))).sum();
        scale((i, j)) * scale((k, l)) * sum
    })
}

/// The bulk and the shear modulus of the isotropic tensor that is nearest to C.
fn isotropic(c: &Matrix6<f64>) -> [f64; 2] {
    let bulk = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|at| c[at]).sum::<f64>() / 9.0;
    // The trace is `3 K + 5 · 2 μ`: one eigenvalue of volume, five of shape.
    [bulk, (c.trace() - 3.0 * bulk) / 10.0]
}

/// `C = 3 K P_v + 2 μ P_d`, with the projections to changes of volume and to the rest.
fn of(bulk: f64, shear: f64) -> Matrix6<f64> {
    let volume = Matrix6::from_fn(|i, j| if i < 3 && j < 3 { 1.0 / 3.0 } else { 0.0 });
    3.0 * bulk * volume + 2.0 * shear * (Matrix6::identity() - volume)
}

/// Young's modulus and Poisson's ratio.
fn engineering(bulk: f64, shear: f64) -> (f64, f64) {
    let both = 3.0 * bulk + shear;
    (9.0 * bulk * shear / both, (3.0 * bulk - 2.0 * shear) / (2.0 * both))
}
