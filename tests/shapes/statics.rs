//! Bodies under loads, and what they do.

use super::Random;
use super::bodies::grid;
use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Elastic, Entries, Lumping, Network, Support, exact_network, lumped_masses};
use springfit_bodies::solve::{System, lowest_modes};
use springfit_element::material::Material;
use springfit_fit::fit::{ExactFit, VolumeSprings};
use springfit_mesh::mesh::Mesh;

/// The work of the load on the displacements that it causes.
pub fn compliance(entries: &Entries, support: &Support, load: &[f64]) -> f64 {
    let system = System::new(entries, support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let (u, residual) = system.solve(&factor, load);
    assert!(residual < 1e-6, "{residual:e}");
    u.iter().zip(load).map(|(u, f)| u * f).sum()
}

/// Cook's membrane of n × n squares.
pub fn membrane(element: &str, n: usize) -> Mesh {
    let mut mesh = grid(element, &[1.0; 2], &[n, n]);
    for x in mesh.points.chunks_exact_mut(2) {
        let (s, t) = (x[0], x[1]);
        (x[0], x[1]) = (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s));
    }
    mesh
}

/// The symmetric matrix of entries, of which those beside the diagonal stand for two.
pub fn dense(size: usize, entries: &Entries) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(size, size);
    for entry in entries {
        matrix[(entry.row, entry.col)] += entry.val;
        if entry.row != entry.col {
            matrix[(entry.col, entry.row)] += entry.val;
        }
    }
    matrix
}

/// This matrix times a vector.
pub fn product(entries: &Entries, u: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; u.len()];
    for entry in entries {
        f[entry.row] += entry.val * u[entry.col];
        if entry.row != entry.col {
            f[entry.col] += entry.val * u[entry.row];
        }
    }
    f
}

/// Asserts that `at`, which returns an energy and its gradient, has at `x` this gradient and this `tangent`: central differences of ± `h` are off
/// by less than `near` of the gradient and of the tangent.
pub fn assert_derivatives(
    name: &str,
    x: &[f64],
    (h, near): (f64, [f64; 2]),
    at: impl Fn(&[f64]) -> (f64, Vec<f64>),
    tangent: impl Fn(usize, usize) -> f64,
) {
    let (_, gradient) = at(x);
    for i in 0..x.len() {
        let [ahead, behind] = [h, -h].map(|by| {
            let mut x = x.to_vec();
            x[i] += by;
            at(&x)
        });
        let slope = (ahead.0 - behind.0) / (2.0 * h);
        assert!((slope - gradient[i]).abs() < near[0], "{name}: gradient {i}: {slope} {}", gradient[i]);
        for j in 0..x.len() {
            let (slope, own) = ((ahead.1[j] - behind.1[j]) / (2.0 * h), tangent(j, i));
            assert!((slope - own).abs() < near[1], "{name}: tangent {j} {i}: {slope} {own}");
        }
    }
}

/// Asserts the same of a network along a random direction, to these parts of the slope of the energy and of the largest change of the forces.
pub fn assert_derivatives_along(name: &str, network: &Network, x: &[f64], random: &mut Random, near: [f64; 2]) {
    let response = network.respond(x).unwrap();
    let direction: Vec<f64> = x.iter().map(|_| random.next()).collect();
    let h = 1e-5;
    let [after, before] = [h, -h].map(|h| {
        let moved: Vec<f64> = x.iter().zip(&direction).map(|(x, v)| x + h * v).collect();
        (network.energy(&moved).unwrap(), network.respond(&moved).unwrap().force)
    });
    let slope = (after.0 - before.0) / (2.0 * h);
    let along: f64 = response.force.iter().zip(&direction).map(|(f, v)| f * v).sum();
    assert!((slope / along - 1.0).abs() < near[0], "{name}: {slope} {along}");
    let product = product(&response.tangent, &direction);
    let size = product.iter().fold(0.0f64, |most, k| most.max(k.abs()));
    for (k, (a, b)) in product.iter().zip(after.1.iter().zip(&before.1)) {
        assert!((k - (a - b) / (2.0 * h)).abs() < near[1] * size, "{name}: {k}");
    }
}

/// Some points held in all directions.
pub fn support_at(mesh: &Mesh, points: &[usize]) -> Support {
    let mut support = Support::free(mesh);
    support.fix(points, &(0..mesh.dimension).collect::<Vec<_>>(), mesh.dimension);
    support
}

/// The points where `test` holds, held in all directions, and which these are.
pub fn held_where(mesh: &Mesh, test: impl Fn(&[f64]) -> bool) -> (Support, Vec<bool>) {
    let held: Vec<bool> = (0..mesh.point_count()).map(|p| test(mesh.point(p))).collect();
    let points: Vec<usize> = (0..held.len()).filter(|p| held[*p]).collect();
    (support_at(mesh, &points), held)
}

/// A unit force along the last axis, spread evenly over the sides of triangles or tetrahedra where `test` holds.
pub fn end_load(mesh: &Mesh, test: impl Fn(&[f64]) -> bool) -> Vec<f64> {
    let d = mesh.dimension;
    let (mut load, mut total) = (vec![0.0; mesh.points.len()], 0.0);
    for nodes in mesh.blocks[0].cells() {
        for side in mesh.blocks[0].element.sides() {
            let side: Vec<usize> = side.nodes.iter().map(|&a| nodes[a]).collect();
            if !side.iter().all(|p| test(mesh.point(*p))) {
                continue;
            }
            let at = |i: usize| DVector::from_column_slice(mesh.point(side[i]));
            let edges = DMatrix::from_columns(&(1..d).map(|i| at(i) - at(0)).collect::<Vec<_>>());
            let measure = (edges.transpose() * &edges).determinant().sqrt();
            total += measure;
            // Of a straight side of three nodes in the plane, the middle one has four sixths.
            let weights: &[f64] = if (d, side.len()) == (2, 3) { &[1.0, 1.0, 4.0] } else { &[1.0; 3] };
            let whole: f64 = weights[..side.len()].iter().sum();
            side.iter().zip(weights).for_each(|(p, w)| load[p * d + d - 1] += measure * w / whole);
        }
    }
    load.iter_mut().for_each(|f| *f /= total);
    load
}

/// The exact network whose shear springs are on cells.
pub fn on_cells(mesh: &Mesh, material: Material, volume: VolumeSprings, held: &[bool]) -> Network {
    exact_network(mesh, &material.into(), &ExactFit { volume, ..ExactFit::default() }, held).unwrap()
}

/// The lowest 30 frequencies of a body of unit density.
pub fn frequencies(mesh: &Mesh, entries: &Entries, support: &Support) -> Vec<f64> {
    let masses = lumped_masses(mesh, 1.0, 1.0, Lumping::Hrz);
    let system = System::new(entries, support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    lowest_modes(&system, &factor, &masses, 3, 30).unwrap().frequencies()
}
