//! What a fit minimises, stated once: `min_k ‖R − Σ_s k_s g_s g_sᵀ‖` in a weighted Frobenius norm.
//!
//! Each objective is an inner product of matrices, and so gives normal equations `M k = b` in which no `g gᵀ` is formed.

use super::frobenius;
use super::modes;
use super::normal::Normal;
use crate::error::{Error, Result};
use crate::material::Moduli;
use crate::springs::Springs;
use crate::stiffness::Geometry;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// All entries of the matrix.
    Frobenius,
    /// The blocks of different nodes only; with length springs alone, `k_s = −nᵀ R_ij n`.
    OffDiagonal,
    /// `‖Wᵀ (R − K) W‖_F`, W = [C, higher · H]: C an orthonormal basis of the constant-strain motions, H of all other
    /// deformations.
    Modal { higher: f64 },
}

impl Objective {
    pub const NAMES: [&'static str; 3] = ["frobenius", "offdiag", "modal"];
    /// The scale of the higher modes where none is given; chosen by the study in the README.
    pub const DEFAULT_HIGHER: f64 = 0.316;

    /// The objective called `name`; `higher` belongs to `modal`.
    ///
    /// # Errors
    /// The name is unknown, or `higher` is not in (0, 1] or given to another objective.
    pub fn named(name: &str, higher: Option<f64>) -> Result<Objective> {
        let objective = match name {
            "frobenius" => Objective::Frobenius,
            "offdiag" => Objective::OffDiagonal,
            "modal" => Objective::Modal { higher: higher.unwrap_or(Objective::DEFAULT_HIGHER) },
            _ => {
                let expected = format!("one of {}", Objective::NAMES.join(", "));
                return Err(Error::expected("objective", expected, format!("\"{name}\"")));
            }
        };
        match (objective, higher) {
            (Objective::Modal { higher }, _) if !(higher > 0.0 && higher <= 1.0) => {
                Err(Error::expected("higher", "a scale above 0 and at most 1", higher))
            }
            (Objective::Frobenius | Objective::OffDiagonal, Some(_)) => {
                Err(Error::at("higher", format!("belongs to the objective \"modal\", found with \"{name}\"")))
            }
            _ => Ok(objective),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Objective::Frobenius => "frobenius",
            Objective::OffDiagonal => "offdiag",
            Objective::Modal { .. } => "modal",
        }
    }

    /// Fills in `M` and `b` for the element with nodes at `x`, `[nodes × dimension]`.
    pub fn normal_equations(
        &self,
        springs: &Springs,
        x: &[f64],
        geometry: &Geometry,
        moduli: Moduli,
        normal: &mut Normal,
    ) {
        frobenius::normal_equations(springs, x, geometry, moduli, normal);
        match *self {
            Objective::Frobenius => {}
            Objective::OffDiagonal => without_diagonal_blocks(springs, x, geometry, moduli, normal),
            Objective::Modal { higher } => modal(springs, x, geometry, moduli, higher, normal),
        }
    }
}

/// Takes the share of the diagonal blocks from the plain equations:
/// `M_st −= Σ_a (g_s,a · g_t,a)²`, `b_s −= Σ_a g_s,aᵀ R_aa g_s,a`.
fn without_diagonal_blocks(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, normal: &mut Normal) {
    let (m, d) = (springs.len(), springs.dimension);
    let size = springs.nodes * d;
    let mut g = Vec::new();
    springs.gradients(x, geometry, &mut g);
    let rows: Vec<&[f64]> = g.chunks_exact(size).collect();
    let mut alone = vec![0.0; size];
    for s in 0..m {
        for a in 0..springs.nodes {
            let block = a * d..(a + 1) * d;
            let own = &rows[s][block.clone()];
            if own.iter().all(|g| *g == 0.0) {
                continue;
            }
            alone[block.clone()].copy_from_slice(own);
            normal.rhs[s] -= geometry.energy(moduli, &alone);
            alone[block.clone()].fill(0.0);
            for t in 0..m {
                let dot: f64 = own.iter().zip(&rows[t][block.clone()]).map(|(a, b)| a * b).sum();
                normal.gram[s * m + t] -= dot * dot;
            }
        }
    }
}

/// With Q = W Wᵀ = C Cᵀ + h² H Hᵀ, and y_s = Q g_s = h² g_s + (1 − h²) C Cᵀ g_s because g_s has no rigid part:
/// `M_st = (g_s · y_t)²`, `b_s = y_sᵀ R y_s`.
fn modal(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, higher: f64, normal: &mut Normal) {
    let m = springs.len();
    let size = springs.nodes * springs.dimension;
    let basis = modes::constant_strain(x, springs.dimension);
    let mut g = Vec::new();
    springs.gradients(x, geometry, &mut g);
    let h2 = higher * higher;
    let mut y = g.clone();
    for (y, g) in y.chunks_exact_mut(size).zip(g.chunks_exact(size)) {
        y.iter_mut().for_each(|y| *y *= h2);
        for c in &basis {
            let along: f64 = (1.0 - h2) * c.iter().zip(g).map(|(c, g)| c * g).sum::<f64>();
            y.iter_mut().zip(c).for_each(|(y, c)| *y += along * c);
        }
    }
    for (t, y) in y.chunks_exact(size).enumerate() {
        normal.rhs[t] = geometry.energy(moduli, y);
        for (s, g) in g.chunks_exact(size).enumerate().take(t + 1) {
            let dot: f64 = g.iter().zip(y).map(|(g, y)| g * y).sum();
            normal.gram[s * m + t] = dot * dot;
            normal.gram[t * m + s] = dot * dot;
        }
    }
}
