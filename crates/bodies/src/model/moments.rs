//! The mass of a body, its centre and its second moments.
//!
//! Theory: page *Whole-object fits* of the book.

use super::integration::each_cell_points;
use crate::element::Integrand;
use crate::material::CellMap;
use crate::mesh::Mesh;

/// `M = ∫ ρ dV`, `c = ∫ ρ x dV/M` and `S = ∫ ρ (x − c)(x − c)ᵀ dV`, or the same sums over masses at points. S has the inertia
/// about every axis.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Moments {
    /// M, kg.
    pub mass: f64,
    /// c, `[dimension]`, m.
    pub centre: Vec<f64>,
    /// S, `[dimension × dimension]`, kg m².
    pub second: Vec<f64>,
}

impl Moments {
    /// Computes the moments of a body; `density` is in kg/m³ and `thickness` in m, of all cells or of each.
    pub fn of_body(mesh: &Mesh, density: CellMap<f64>, thickness: CellMap<f64>) -> Moments {
        let d = mesh.dimension;
        let mut parts: Vec<(f64, Vec<f64>)> = Vec::new();
        each_cell_points(
            mesh,
            Integrand::Mass,
            |_| true,
            |cell| {
                let (block, index) = (cell.index.block, cell.index.cell);
                let scale = density.at(block, index) * thickness.at(block, index);
                for (values, v) in cell.each() {
                    let at = |k: usize| cell.nodes.iter().zip(values).map(|(&p, n)| n * mesh.points[p * d + k]).sum();
                    parts.push((scale * v, (0..d).map(at).collect()));
                }
            },
        );
        Moments::sum(d, || parts.iter().map(|(m, x)| (*m, &x[..])))
    }

    /// Computes the moments of masses, kg, at points, `[points × dimension]`, m.
    pub fn of_masses(points: &[f64], dimension: usize, masses: &[f64]) -> Moments {
        Moments::sum(dimension, || masses.iter().copied().zip(points.chunks_exact(dimension)))
    }

    fn sum<'a, I: Iterator<Item = (f64, &'a [f64])>>(d: usize, parts: impl Fn() -> I) -> Moments {
        let mass: f64 = parts().map(|(m, _)| m).sum();
        let centre: Vec<f64> = (0..d).map(|k| parts().map(|(m, x)| m * x[k]).sum::<f64>() / mass).collect();
        // In a second pass, about the centre: differences of large sums lose the digits of a body far from the origin.
        let away = |x: &[f64], k: usize| x[k] - centre[k];
        let product = |kl: usize| parts().map(|(m, x)| m * away(x, kl / d) * away(x, kl % d)).sum();
        let second = (0..d * d).map(product).collect();
        Moments { mass, centre, second }
    }
}
