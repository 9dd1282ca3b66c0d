//! Relaxing bodies in homogeneous states.

use nalgebra::Matrix3;
use springfit_bodies::dynamics::Memory;
use springfit_bodies::model::{MaterialPoints, displaced};
use springfit_element::material::{Material, MaterialMap, State};
use springfit_fit::fit::ShearSprings;
use springfit_mesh::mesh::Mesh;

/// μ and K of the bodies, Pa: E = 10 kPa, ν = 0.3.
pub const MU: f64 = 1e4 / 2.6;
pub const BULK: f64 = 1e4 / 1.2;

pub type Tensor = Matrix3<f64>;

pub fn material(dimension: usize) -> MaterialMap {
    let state = if dimension == 3 { State::Solid } else { State::PlaneStrain { thickness: 0.5 } };
    Material::new(1e4, 0.3, state).unwrap().into()
}

pub fn points(mesh: &Mesh, shear: ShearSprings) -> MaterialPoints {
    MaterialPoints::of(mesh, &material(mesh.dimension), shear).unwrap()
}

/// The gradient of a simple shear.
pub fn shear(gamma: f64) -> Tensor {
    let mut f = Tensor::identity();
    f[(0, 1)] = gamma;
    f
}

/// The displacements of the affine motion `x = F X`.
pub fn affine(mesh: &Mesh, f: &Tensor) -> Vec<f64> {
    let d = mesh.dimension;
    let of = |x: &[f64], k: usize| (0..d).map(|l| f[(k, l)] * x[l]).sum::<f64>() - x[k];
    mesh.points.chunks_exact(d).flat_map(|x| (0..d).map(move |k| of(x, k))).collect()
}

/// `σ J = Σ_a f_a ⊗ x_a/V₀` of the present forces of a homogeneous state of a solid: the virtual work of x ↦ (1 + ε) x.
pub fn stress(memory: &mut Memory, mesh: &Mesh, f: &Tensor, volume: f64) -> Tensor {
    memory.prepare(0.0);
    let u = affine(mesh, f);
    let mut force = vec![0.0; u.len()];
    memory.add(&u, &mut force, None).unwrap();
    let x = displaced(&mesh.points, &u);
    Tensor::from_fn(|i, j| force.chunks_exact(3).zip(x.chunks_exact(3)).map(|(f, x)| f[i] * x[j]).sum::<f64>() / volume)
}
