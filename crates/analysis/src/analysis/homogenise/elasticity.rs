//! What an elasticity tensor says: moduli, and how far it is from isotropic.

use crate::analysis::tensor::{basis, constants};
use crate::material::State;
use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Entries that differ by less than this share of the largest are equal: a tensor is cubic if it is by this much.
/// Points of networks come from files with six digits or more.
const CUBIC: f64 = 1e-6;
/// A strain whose stiffness is below this share of the largest meets no resistance.
// A stiffness is the affine one less what points release as they give way. Where both are equal, rounding leaves some 1e-15 of
// them, and more where soft motions amplify it; a share that is far above would hide strains that are soft and resist.
const NOTHING: f64 = 1e-9;

/// An elasticity tensor and what it says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Elasticity {
    /// The tensor is in Kelvin's notation, `σ = C ε`, Pa; a plane network without a thickness is 1 m thick. Rows are those of the
    /// stresses xx, yy, (zz,) √2 xy, (√2 xz, √2 yz).
    pub stiffness: Vec<Vec<f64>>,
    /// The harmonic mean of Young's modulus over all directions of tension is in Pa; it is null if some strain meets no resistance.
    pub young: Option<f64>,
    /// The mean of Poisson's ratio over all directions is null as `young` is, and for a rod.
    pub poisson: Option<f64>,
    /// Young's modulus along each axis is in Pa, `[dimension]`; it is null as `young` is.
    pub young_along: Option<Vec<f64>>,
    /// Zener's ratio `2 C_shear/(C_11 − C_12)` of a tensor with the symmetry of a cube, or of a square, along the axes; it is null of others. It
    /// is 1 where the material is isotropic.
    pub zener: Option<f64>,
    /// The nearest isotropic tensor has the distance `‖C − C_iso‖/‖C‖`: 0 is isotropic.
    pub anisotropy: f64,
    /// Strains that meet no resistance, or release energy, are counted, by the eigenvalues of the tensor.
    pub soft_strains: usize,
}

impl Elasticity {
    /// The number of the soft strains that release energy.
    pub fn releasing_strains(&self) -> usize {
        let eigenvalues = self.matrix().symmetric_eigenvalues();
        let floor = NOTHING * eigenvalues.amax();
        eigenvalues.iter().filter(|value| **value < -floor).count()
    }

    /// What a tensor in Kelvin's notation says of a body in this state; its unit is Pa.
    pub fn of(c: &DMatrix<f64>, state: State) -> Elasticity {
        let d = state.dimension();
        // Solutions have rounding errors, so that the tensor is symmetric to rounding alone. The eigenvalues need a symmetric matrix.
        let symmetric = (c + c.transpose()) * 0.5;
        let eigenvalues = symmetric.clone().symmetric_eigenvalues();
        let floor = NOTHING * eigenvalues.amax();
        // The comparison is negated so that an eigenvalue that is not a number counts as soft.
        let soft_strains = eigenvalues.iter().filter(|value| !(**value > floor)).count();
        let found = constants(&symmetric, state).filter(|_| soft_strains == 0);
        let along = || -> Option<Vec<f64>> {
            let compliance = symmetric.clone().try_inverse()?;
            // Plane strain keeps the modulus of the plane, E/(1 − ν²), along its axes.
            Some((0..d).map(|k| 1.0 / compliance[(k, k)]).collect())
        };
        Elasticity {
            stiffness: symmetric.row_iter().map(|row| row.iter().copied().collect()).collect(),
            young: found.map(|(young, _)| young),
            poisson: found.and_then(|(_, poisson)| poisson),
            young_along: found.and_then(|_| along()),
            zener: zener(&symmetric, d),
            anisotropy: if symmetric.norm() > 0.0 {
                (&symmetric - isotropic(&symmetric, d)).norm() / symmetric.norm()
            } else {
                0.0
            },
            soft_strains,
        }
    }

    /// The tensor as a matrix.
    pub fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.stiffness.len(), self.stiffness.len(), |i, j| self.stiffness[i][j])
    }
}

/// The nearest isotropic tensor, `κ V + 2 μ D`, with the projections V on changes of volume and D on those of shape.
fn isotropic(c: &DMatrix<f64>, d: usize) -> DMatrix<f64> {
    let size = c.nrows();
    let volume = DMatrix::from_fn(size, size, |i, j| if i < d && j < d { 1.0 / d as f64 } else { 0.0 });
    let shape = DMatrix::identity(size, size) - &volume;
    let part = |projection: &DMatrix<f64>, count: usize| match count {
        // A rod has one strain, and no change of shape.
        0 => projection * 0.0,
        _ => projection * (projection.component_mul(c).sum() / count as f64),
    };
    part(&volume, 1) + part(&shape, size - 1)
}

/// Zener's ratio of a tensor with the symmetry of a cube, of a square in the plane.
fn zener(c: &DMatrix<f64>, d: usize) -> Option<f64> {
    // A line has no shear to compare with its stretch.
    if d < 2 {
        return None;
    }
    let (mean, size) = (isotropic(c, d), c.nrows());
    // Kelvin's shear entries are 2 C_44.
    let average = |pairs: &[(usize, usize)]| pairs.iter().map(|&at| c[at]).sum::<f64>() / pairs.len() as f64;
    let along = average(&(0..d).map(|k| (k, k)).collect::<Vec<_>>());
    let across: Vec<(usize, usize)> =
        (0..d).flat_map(|k| (0..d).map(move |l| (k, l))).filter(|(k, l)| k != l).collect();
    let across = average(&across);
    let shear = average(&(d..size).map(|s| (s, s)).collect::<Vec<_>>());
    let cubic = DMatrix::from_fn(size, size, |i, j| match (i == j, i < d, j < d) {
        (true, true, _) => along,
        (false, true, true) => across,
        (true, false, _) => shear,
        _ => 0.0,
    });
    let is_cubic = (c - &cubic).amax() <= CUBIC * c.amax();
    let below = along - across;
    // Where both are equal a strain meets no resistance, and the ratio has no value.
    (is_cubic && below.abs() > NOTHING * mean.amax()).then_some(shear / below)
}

/// The strains of Kelvin's notation by name: xx, yy, zz, √2 xy, √2 xz, √2 yz.
pub fn strain_names(d: usize) -> Vec<String> {
    let axes = ["x", "y", "z"];
    let name = |strain: &DMatrix<f64>| {
        let at: Vec<(usize, usize)> =
            (0..d).flat_map(|k| (k..d).map(move |l| (k, l))).filter(|at| strain[*at] != 0.0).collect();
        at.iter().map(|(k, l)| format!("{}{}", axes[*k], axes[*l])).collect::<String>()
    };
    basis(d).iter().map(name).collect()
}
