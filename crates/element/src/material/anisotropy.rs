//! Anisotropic linear elasticity of a solid in axes of the material, and what a plane or a rod of it is.

use super::State;
use super::hooke::{Stiffness, voigt};
use crate::error::{Error, ErrorKind, Result};
use crate::range::{contains, positive};
use nalgebra::{Matrix6, SMatrix};

/// The stiffness of a solid, `σ = C ε` in Voigt's order xx, yy, zz, yz, xz, xy, with shear strains 2 ε.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    stiffness: Matrix6<f64>,
}

/// A ratio of Young's moduli beyond the square of this has no accurate compliance.
const LARGEST_RATIO: f64 = 1e6;
/// Two axes whose angle has a smaller sine are not independent. A third axis, their cross product, would have lost six
/// digits or more.
const INDEPENDENT: f64 = 1e-6;

impl Anisotropy {
    /// Three planes of symmetry: Young's moduli E1, E2, E3, Poisson's ratios ν12, ν23, ν13 with `ν_ij = −ε_j/ε_i` under tension along
    /// i, and shear moduli G12, G23, G13; Pa.
    ///
    /// # Errors
    /// A modulus is not positive, or the stiffness is not positive definite.
    pub fn orthotropic(young: [f64; 3], poisson: [f64; 3], shear: [f64; 3]) -> Result<Anisotropy> {
        for (key, moduli) in [("young", young), ("shear", shear)] {
            moduli.into_iter().try_for_each(|modulus| positive(key, modulus, "Pa").map(|_| ()))?;
        }
        // The comparison is negated so that a ratio that is not a number is refused as well.
        if let Some(found) = poisson.iter().find(|ratio| !(ratio.abs() <= LARGEST_RATIO)) {
            return Err(Error::expected("poisson", format!("ratios of at most {LARGEST_RATIO} in size"), found));
        }
        let mut compliance = Matrix6::zeros();
        (0..3).for_each(|i| compliance[(i, i)] = 1.0 / young[i]);
        for ((i, j), nu) in [(0, 1), (1, 2), (0, 2)].into_iter().zip(poisson) {
            compliance[(i, j)] = -nu / young[i];
            // `ν_ji/E_j = ν_ij/E_i`: the compliance is symmetric, and the other ratio follows.
            compliance[(j, i)] = compliance[(i, j)];
        }
        // G12 is that of xy, G23 of yz and G13 of xz.
        for (k, g) in [(5, shear[0]), (3, shear[1]), (4, shear[2])] {
            compliance[(k, k)] = 1.0 / g;
        }
        let indefinite = || {
            let eigenvalue = compliance.symmetric_eigenvalues().min();
            let expected = "ratios of a positive definite compliance: ν12² < E1/E2 and so on";
            let found = format!("its eigenvalue {eigenvalue:.6e} 1/Pa");
            Error::expected("poisson", expected, found).of_kind(ErrorKind::Infeasible)
        };
        // A factor exists where the compliance is positive definite, which is asked for anyway.
        let stiffness = compliance.cholesky().ok_or_else(indefinite)?.inverse();
        Anisotropy::of_stiffness(stiffness)
    }

    /// One axis of symmetry, the first: Young's modulus `along` it and `across`, the ratio `nu_along` of the strain across to the
    /// strain along under tension along, `nu_across` in the plane across, and the shear modulus along; Pa.
    ///
    /// # Errors
    /// Those of [`Anisotropy::orthotropic`].
    pub fn transversely_isotropic(
        [along, across]: [f64; 2],
        [nu_along, nu_across]: [f64; 2],
        shear: f64,
    ) -> Result<Anisotropy> {
        if !(nu_across > -1.0 && nu_across < 1.0) {
            return Err(Error::expected("poisson", "a ratio across above -1 and below 1", nu_across));
        }
        // The plane across is isotropic, so that its shear modulus follows from its two moduli.
        let in_plane = across / (2.0 * (1.0 + nu_across));
        Anisotropy::orthotropic([along, across, across], [nu_along, nu_across, nu_along], [shear, in_plane, shear])
    }

    /// A crystal of cubic symmetry: C11, C12 and C44, Pa.
    ///
    /// # Errors
    /// The stiffness is not positive definite.
    pub fn cubic(c11: f64, c12: f64, c44: f64) -> Result<Anisotropy> {
        Anisotropy::of_stiffness(Matrix6::from_fn(|i, j| match (i < 3, j < 3, i == j) {
            (true, true, true) => c11,
            (true, true, false) => c12,
            (false, false, true) => c44,
            _ => 0.0,
        }))
    }

    /// Any stiffness, Pa.
    ///
    /// # Errors
    /// Those of [`Stiffness::new`].
    pub fn of_stiffness(stiffness: Matrix6<f64>) -> Result<Anisotropy> {
        let size = stiffness.amax();
        if !contains(size) {
            let expected = "numbers whose largest is from 1e-30 to 1e30 Pa";
            return Err(Error::expected("stiffness", expected, format!("{size:?}")));
        }
        Stiffness::new(3, stiffness.transpose().as_slice())?;
        // What differs across the diagonal is rounding of another program, as has been proved above.
        Ok(Anisotropy { stiffness: (stiffness + stiffness.transpose()) / 2.0 })
    }

    /// The stiffness in Voigt's order, Pa.
    pub fn stiffness(&self) -> &Matrix6<f64> {
        &self.stiffness
    }

    /// Turns the material so that its first axis is along the first vector and its second in the plane of both.
    ///
    /// # Errors
    /// The vectors are not finite or not independent; the key is `axes`.
    pub fn turned(&self, [first, second]: [[f64; 3]; 2]) -> Result<Anisotropy> {
        let q = frame(first, second)?;
        let index = |k: usize, l: usize| voigt(3, k, l);
        let mut turned = Matrix6::zeros();
        let pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
        for (i, j) in pairs {
            for (k, l) in pairs {
                let mut sum = 0.0;
                for a in 0..3 {
                    for b in 0..3 {
                        for c in 0..3 {
                            for d in 0..3 {
                                let entry = self.stiffness[(index(a, b), index(c, d))];
                                sum += q[(i, a)] * q[(j, b)] * q[(k, c)] * q[(l, d)] * entry;
                            }
                        }
                    }
                }
                turned[(index(i, j), index(k, l))] = sum;
            }
        }
        Ok(Anisotropy { stiffness: turned })
    }

    /// D of a body in this state: of a plane without stress or strain across it, of a rod without stress across it, each times its
    /// thickness or cross-section.
    ///
    /// # Errors
    /// D is not positive definite.
    pub fn in_state(&self, state: State) -> Result<Stiffness> {
        let c = &self.stiffness;
        let singular = || Error::expected("stiffness", "one with an inverse", "a singular one");
        let t = state.thickness();
        // Strains across are zero in plane strain, which keeps entries of the stiffness; stresses across are zero in plane stress, which
        // keeps entries of the compliance.
        match state {
            State::Solid => Stiffness::new(3, c.transpose().as_slice()),
            State::PlaneStrain { .. } => {
                let plane = [0, 1, 5];
                let entries: Vec<f64> = (0..9).map(|e| t * c[(plane[e / 3], plane[e % 3])]).collect();
                Stiffness::new(2, &entries)
            }
            State::PlaneStress { .. } => {
                let s = c.try_inverse().ok_or_else(singular)?;
                let plane = [0, 1, 5];
                let s = SMatrix::<f64, 3, 3>::from_fn(|i, j| s[(plane[i], plane[j])]);
                let d = s.try_inverse().ok_or_else(singular)? * t;
                Stiffness::new(2, ((d + d.transpose()) / 2.0).as_slice())
            }
            State::Rod { .. } => {
                let s = c.try_inverse().ok_or_else(singular)?;
                Stiffness::new(1, &[t / s[(0, 0)]])
            }
        }
    }
}

/// Orthonormal axes as columns.
fn frame(first: [f64; 3], second: [f64; 3]) -> Result<nalgebra::Matrix3<f64>> {
    // Scaled first, so that no square overflows.
    let unit = |v: [f64; 3]| {
        let v = nalgebra::Vector3::from(v);
        let v = v / v.amax();
        v / v.norm()
    };
    let (a, b) = (unit(first), unit(second));
    let across = b - a * a.dot(&b);
    // The comparison is negated so that a vector of zeros, which has no direction, is refused.
    if !(across.norm() > INDEPENDENT) {
        let found = format!("{first:?} and {second:?}");
        return Err(Error::expected("axes", "two independent vectors of finite length", found));
    }
    let across = across.normalize();
    Ok(nalgebra::Matrix3::from_columns(&[a, across, a.cross(&across)]))
}
