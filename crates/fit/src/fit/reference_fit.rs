//! A fit as its formula: one element, in double precision, one step after the other, and no shortcut.
//!
//! 1. [`stiffness`]: the stiffness of the finite element by quadrature, `R = Σ_q v_q B_qᵀ D B_q`.
//! 2. [`gradients`]: spring s measures the change `g_s·u`, so that constants k have the stiffness `K = Σ_s k_s g_s g_sᵀ`,
//!    [`network`].
//! 3. [`seen`]: a weight is what a norm sees of a matrix, `W A W`.
//! 4. [`constants`]: `min_k ‖W (R − Σ_s k_s g_s g_sᵀ) W‖` in the Frobenius norm, by the normal equations.
//!
//! [`fit_cells`](super::fit_cells) comes to these constants by faster routes: normal equations from node positions alone, deformations in
//! place of displacements, cells side by side in the lanes of vectors, more digits for needles. `springfit check` compares both for every
//! element, and so do the tests for every weight. Start to read here.
//!
//! Natsupakpong and Çavuşoğlu, Graphical Models 72 (2010), (13) and (17). Theory: pages *Stiffness and the reduced space* and *Least squares*
//! of the book.

use super::visit::cell_fault;
use super::weight::Weight;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::material::{Hooke, strains, voigt};
use crate::springs::Springs;
use crate::stiffness::Geometry;
use nalgebra::{DMatrix, DVector};
use springfit_numerics::dense::{eigen, singular};

/// An eigenvalue is rounding if it is below this share of the largest. Rigid motions have a stiffness of some 1e-16,
/// and the softest motion of a cell that is not degenerate has more than this.
const ROUNDING: f64 = 1e-12;

/// The stiffness of the element with nodes at `x`, `[nodes × dimension]`, m: `R = Σ_q v_q B_qᵀ D B_q`, N/m. Row `voigt(k, l)` of B has the
/// strain `∂u_k/∂x_l + ∂u_l/∂x_k` (`∂u_k/∂x_k` on the diagonal) that a displacement of node a causes, `∂N_a/∂x_l` in the column of its
/// direction k. v_q is the weight of the point multiplied by the Jacobian determinant.
///
/// Functions that belong to no node have columns behind those of the nodes, from which they are taken out: `R_uu − R_ua R_aa⁻¹ R_au`.
///
/// # Errors
/// The element is tangled.
pub fn stiffness(element: &Element, x: &[f64], hooke: &Hooke) -> Result<DMatrix<f64>> {
    let geometry = geometry(element, x)?;
    let (d, modes) = (element.dimension(), element.modes());
    let n = element.nodes() + modes;
    let (law, lambda) = hooke.entries(d);
    let law = DMatrix::from_row_slice(strains(d), strains(d), &law);
    let mut r = DMatrix::zeros(n * d, n * d);
    for (q, (gradients, volume, volumetric)) in geometry.each_point().enumerate() {
        let gradients = [gradients, &geometry.modes[q * modes * d..(q + 1) * modes * d]].concat();
        let mut b = DMatrix::zeros(strains(d), n * d);
        let mut divergence = DVector::zeros(n * d);
        for a in 0..n {
            for k in 0..d {
                (0..d).for_each(|l| b[(voigt(d, k, l), a * d + k)] = gradients[a * d + l]);
                divergence[a * d + k] = gradients[a * d + k];
            }
        }
        r += *volume * b.transpose() * &law * b;
        // Elements may have a rule of their own for the term λ (div u)².
        r += (volumetric - volume) * lambda * &divergence * divergence.transpose();
    }
    if modes == 0 {
        return Ok(r);
    }
    let (kept, beside) = (x.len(), modes * d);
    let own = singular(r.view((kept, kept), (beside, beside)).into_owned());
    let own = own.ok_or_else(|| Error::new("the stiffness of the modes is not finite"))?.pseudo_inverse(f64::EPSILON);
    let across = r.view((0, kept), (kept, beside)).into_owned();
    let r = r.view((0, 0), (kept, kept)) - &across * own * across.transpose();
    Ok(r)
}

/// The columns g_s, `[nodes·dimension × springs]`: of a length `(x_j − x_i)/|x_j − x_i|` at node j and its opposite at node i, of other
/// measures their gradient in the positions of the nodes.
///
/// # Errors
/// The element is tangled, or the springs are those of another element.
pub fn gradients(element: &Element, springs: &Springs, x: &[f64]) -> Result<DMatrix<f64>> {
    springs.check(element)?;
    let mut rows = Vec::new();
    springs.gradients(x, &geometry(element, x)?, &mut rows);
    Ok(DMatrix::from_column_slice(x.len(), springs.len(), &rows))
}

/// The stiffness of springs with the constants `k`: `K = Σ_s k_s g_s g_sᵀ`, N/m, with the columns g_s of `g`.
pub fn network(g: &DMatrix<f64>, k: &[f64]) -> DMatrix<f64> {
    let scaled = DMatrix::from_fn(g.nrows(), g.ncols(), |i, s| k[s] * g[(i, s)]);
    scaled * g.transpose()
}

/// What a weight sees of a matrix A of the element with the stiffness `r` and nodes at `x`, `[nodes × dimension]`: `W A W`, or with
/// [`Weight::OffDiagonal`] A without the blocks of a node and itself.
pub fn seen(
    weight: Weight,
    r: &DMatrix<f64>,
    x: &[f64],
    dimension: usize,
) -> impl Fn(&DMatrix<f64>) -> DMatrix<f64> + use<> {
    let (d, size) = (dimension, r.nrows());
    let w = match weight {
        Weight::None | Weight::OffDiagonal => DMatrix::identity(size, size),
        Weight::Modal(higher) => {
            // Constant strain is among the linear motions `u = A x + t`; R and K vanish on the rigid ones.
            let linear = DMatrix::from_fn(size, d * (d + 1), |row, column| {
                let (a, k) = (row / d, column % d);
                let place = x.get(a * d + column / d).filter(|_| column < d * d).copied().unwrap_or(1.0);
                if row % d == k { place } else { 0.0 }
            });
            let basis = linear.qr().q();
            let strain = &basis * basis.transpose();
            &strain + higher.value() * (DMatrix::identity(size, size) - &strain)
        }
        Weight::Relative => power(r, -0.5),
    };
    move |a| match weight {
        Weight::OffDiagonal => DMatrix::from_fn(size, size, |i, j| if i / d == j / d { 0.0 } else { a[(i, j)] }),
        Weight::None | Weight::Modal(_) | Weight::Relative => &w * a * &w,
    }
}

/// The spring constants k of `min_k ‖W (R − Σ_s k_s g_s g_sᵀ) W‖`. The columns of V are the entries of `W g_s g_sᵀ W`, divided by their
/// norm; the normal equations are `Vᵀ V k = Vᵀ r` with the entries r of `W R W`. Of many optima the smallest is taken.
///
/// # Errors
/// The element is tangled.
///
/// ```
/// use springfit::element::{Element, SHIPPED};
/// use springfit::fit::{Fit, Objective, Weight, fit_element, reference_fit};
/// use springfit::material::{Hooke, Material};
/// use springfit::springs::Springs;
///
/// for file in SHIPPED.iter().take(3) {
///     let element = Element::shipped(file)?;
///     let springs = Springs::select(&element, None)?;
///     let x: Vec<f64> = element.positions.iter().map(|x| 1e-3 * x).collect();
///     let moduli = Material::for_body(element.dimension(), 1e4, 0.3, None, None)?.moduli();
///     let formula = reference_fit::constants(&element, &springs, &x, &Hooke::Isotropic(moduli), Weight::None)?;
///     let fast = fit_element(&element, &springs, &x, moduli, &Fit::new(Objective::Frobenius(Weight::None)))?;
///     let largest = fast.iter().fold(0.0, |largest: f64, k| largest.max(k.abs()));
///     assert!(formula.iter().zip(&fast).all(|(a, b)| (a - b).abs() < 1e-10 * largest));
/// }
/// # Ok::<(), springfit::error::Error>(())
/// ```
pub fn constants(element: &Element, springs: &Springs, x: &[f64], hooke: &Hooke, weight: Weight) -> Result<Vec<f64>> {
    let r = stiffness(element, x, hooke)?;
    let g = gradients(element, springs, x)?;
    let seen = seen(weight, &r, x, element.dimension());
    let columns: Vec<DVector<f64>> = g.column_iter().map(|g| vector(&seen(&(g * g.transpose())))).collect();
    // Columns of unit length keep small springs above the bound below which a motion counts as rounding.
    let norms: Vec<f64> = columns.iter().map(DVector::norm).collect();
    let v = DMatrix::from_fn(r.len(), springs.len(), |entry, s| columns[s][entry] / norms[s]);
    let k = power(&v.tr_mul(&v), -1.0) * v.tr_mul(&vector(&seen(&r)));
    Ok(k.iter().zip(&norms).map(|(k, norm)| k / norm).collect())
}

/// The entries of a matrix, one column below the other.
fn vector(a: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_column_slice(a.as_slice())
}

/// A power of a symmetric matrix on the motions that it does not vanish on.
fn power(a: &DMatrix<f64>, exponent: f64) -> DMatrix<f64> {
    let eigen = eigen(a.clone());
    let least = ROUNDING * eigen.eigenvalues.amax();
    let powers = eigen.eigenvalues.map(|value| if value > least { value.powf(exponent) } else { 0.0 });
    &eigen.eigenvectors * DMatrix::from_diagonal(&powers) * eigen.eigenvectors.transpose()
}

/// The gradients of the shape functions, and the volumes of the quadrature points.
fn geometry(element: &Element, x: &[f64]) -> Result<Geometry> {
    let size = element.nodes() * element.dimension();
    if x.len() != size {
        return Err(Error::expected("x", format!("{size} coordinates of {} nodes", element.nodes()), x.len()));
    }
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, x).map_err(|fault| cell_fault(element, 0, fault))?;
    Ok(geometry)
}
