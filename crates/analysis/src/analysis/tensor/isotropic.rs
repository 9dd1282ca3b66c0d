//! Elasticity tensors as matrices in Kelvin's notation, whose norms are those of the tensors in any axes.

use crate::material::{Hooke, Moduli, State, strains};
use nalgebra::DMatrix;

/// The orthonormal strains `e_k e_k`, then `(e_k e_l + e_l e_k)/√2`, each `[d × d]`.
pub fn basis(d: usize) -> Vec<DMatrix<f64>> {
    let unit = |k: usize, l: usize| {
        let mut strain = DMatrix::zeros(d, d);
        let value = if k == l { 1.0 } else { f64::sqrt(0.5) };
        (strain[(k, l)], strain[(l, k)]) = (value, value);
        strain
    };
    let shears = (0..d).flat_map(|k| (k + 1..d).map(move |l| (k, l)));
    (0..d).map(|k| (k, k)).chain(shears).map(|(k, l)| unit(k, l)).collect()
}

/// `C₀`, of isotropic materials `λ I ⊗ I + 2μ`, Pa; in the plane multiplied by the thickness, for a rod by its cross-section.
pub(super) fn of_material(hooke: &Hooke, d: usize) -> DMatrix<f64> {
    let size = strains(d);
    match hooke {
        Hooke::Isotropic(Moduli { lambda, mu }) => {
            let volumetric = |i: usize, j: usize| if i < d && j < d { *lambda } else { 0.0 };
            DMatrix::from_fn(size, size, |i, j| volumetric(i, j) + if i == j { 2.0 * mu } else { 0.0 })
        }
        Hooke::Anisotropic(stiffness) => {
            // Voigt's order has yz, xz, xy, that of the basis xy, xz, yz.
            let place = |i: usize| if i < d { i } else { size - 1 - (i - d) };
            let kelvin = stiffness.kelvin();
            DMatrix::from_fn(size, size, |i, j| kelvin[(place(i), place(j))])
        }
    }
}

/// `‖C − C₀‖/‖C₀‖`.
pub(super) fn distance(stiffness: &DMatrix<f64>, asked: &DMatrix<f64>) -> f64 {
    (stiffness - asked).norm() / asked.norm()
}

/// C of a sample that is bent a little as if it were flat: `T C Tᵀ` with `T = L₀ L_b⁻¹`, where `L₀ L₀ᵀ` is the tensor of the
/// material and `L_b L_bᵀ` that of its finite elements on the bent sample, which would be the former on a flat one.
pub(super) fn flattened(stiffness: DMatrix<f64>, bent: DMatrix<f64>, flat: &DMatrix<f64>) -> DMatrix<f64> {
    let (Some(bent), Some(flat)) = (bent.cholesky(), flat.clone().cholesky()) else { return stiffness };
    let half = bent.l().solve_lower_triangular(&stiffness);
    // L_b⁻¹ C, then L_b⁻¹ C L_b⁻ᵀ, which is symmetric.
    let whole = half.and_then(|half| bent.l().solve_lower_triangular(&half.transpose()));
    whole.map_or(stiffness, |whole| flat.l() * whole * flat.l().transpose())
}

/// Young's modulus and Poisson's ratio of a body in this state, whose stiffness is in Pa, as means over all directions of tension. With
/// `S = C⁻¹` and n, m orthogonal,
///
/// ```text
/// 1/E = ⟨nn : S : nn⟩,   −ν/E = ⟨nn : S : mm⟩
/// ```
///
/// `None` if some strain meets no resistance or a slope is infinite; a rod has no Poisson's ratio.
pub fn constants(stiffness: &DMatrix<f64>, state: State) -> Option<(f64, Option<f64>)> {
    let (d, size) = (state.dimension(), stiffness.nrows());
    if !stiffness.iter().all(|c| c.is_finite()) {
        return None;
    }
    let eigenvalues = stiffness.clone().symmetric_eigenvalues();
    // A strain without resistance has no compliance, and the tensor no moduli.
    if !(eigenvalues.min() > LEAST * eigenvalues.amax()) {
        return None;
    }
    let compliance = stiffness.clone().try_inverse()?;
    // The mean over all rotations has two eigenvalues, those of changes of volume and of shape.
    let volume = compliance.view((0, 0), (d, d)).sum() / d as f64;
    let shape = if d > 1 { (compliance.trace() - volume) / (size - 1) as f64 } else { 0.0 };
    let d = d as f64;
    let young = d / (volume + (d - 1.0) * shape);
    let poisson = young * (shape - volume) / d;
    let (young, poisson) = match state {
        State::Rod { .. } => (young, None),
        State::Solid | State::PlaneStress { .. } => (young, Some(poisson)),
        // Plane strain is the plane stress of E/(1 − ν²) and ν/(1 − ν).
        State::PlaneStrain { .. } => {
            let poisson = poisson / (1.0 + poisson);
            (young * (1.0 - poisson * poisson), Some(poisson))
        }
    };
    Some((young, poisson))
}

/// The least eigenvalue, relative to the largest, that is not a rounding error.
// At this share the compliance has lost twelve digits of sixteen, and moduli are known to four.
const LEAST: f64 = 1e-12;
