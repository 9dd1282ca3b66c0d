//! What the linear cells of a body that bends lack of its energy, estimated from the jumps of their strains, is what quadratic elements on smaller cells
//! have more.

use crate::shapes::Random;
use crate::shapes::bodies::grid;
use crate::shapes::statics::support_at;
use springfit_bodies::model::{Action, finite_elements, lacking_energy, nodal_forces};
use springfit_bodies::solve::System;
use springfit_element::material::{Material, MaterialMap};
use springfit_mesh::mesh::{Mesh, Selection};

/// Moves the points inside by up to this share of a cell.
fn irregular(mut mesh: Mesh, size: &[f64], cells: &[usize], share: f64) -> Mesh {
    let mut random = Random(7);
    for (i, x) in mesh.points.iter_mut().enumerate() {
        let by = random.next();
        let (size, cell) = (size[i % size.len()], size[i % size.len()] / cells[i % size.len()] as f64);
        if *x > 1e-9 && *x < size - 1e-9 {
            *x += share * cell * by;
        }
    }
    mesh
}

/// Bends a strip along x into half a ring, in the plane of its first and last axis.
fn ring(mut mesh: Mesh, length: f64, radius: f64) -> Mesh {
    let d = mesh.dimension;
    for x in mesh.points.chunks_exact_mut(d) {
        let (angle, r) = (std::f64::consts::PI * (1.0 - x[0] / length), radius + x[d - 1]);
        (x[0], x[d - 1]) = (r * angle.cos(), r * angle.sin());
    }
    mesh
}

/// The displacements under a traction on one end of a body that is held at the other, and the work of the forces.
fn solved(mesh: &Mesh, material: &Material, traction: &[f64]) -> (Vec<f64>, f64) {
    let entries = finite_elements(mesh, material.moduli());
    let support = support_at(mesh, &mesh.groups["xmin"].points);
    let end = Selection::Group("xmax".into());
    let forces = nodal_forces(mesh, &end, &Action::traction(traction), 1.0).unwrap();
    let system = System::new(&entries, &support).unwrap().placed(&mesh.points, mesh.dimension);
    let factor = system.cholesky().unwrap().unwrap();
    let u = system.solve_all(&factor, std::slice::from_ref(&forces)).remove(0);
    let work = u.iter().zip(&forces).map(|(u, f)| u * f).sum();
    (u, work)
}

#[test]
fn what_linear_cells_lack_of_the_energy_of_bending_is_estimated() {
    let strip = |element: &str, cells: [usize; 2]| grid(element, &[0.1, 0.01], &cells);
    let beam = |element: &str, cells: [usize; 3]| grid(element, &[0.1, 0.01, 0.01], &cells);
    let mut bodies = Vec::new();
    for cells in [[14, 2], [20, 2], [27, 2], [30, 3], [40, 4]] {
        bodies.push((format!("tri3 {cells:?}"), strip("tri3", cells), 0.3));
        bodies.push((format!("quad4 {cells:?}"), strip("quad4", cells), 0.3));
    }
    for cells in [[20, 2, 2], [14, 3, 2]] {
        bodies.push((format!("tet4 {cells:?}"), beam("tet4", cells), 0.2));
        bodies.push((format!("hex8 {cells:?}"), beam("hex8", cells), 0.2));
    }
    bodies.push(("wedges".into(), beam("wedge6", [20, 2, 2]), 0.3));
    for element in ["tri3", "quad4"] {
        let moved = irregular(strip(element, [30, 3]), &[0.1, 0.01], &[30, 3], 0.25);
        bodies.push((format!("irregular {element}"), moved.clone(), 0.0));
        bodies.push((format!("ring of {element}"), ring(moved, 0.1, 0.03), 0.35));
    }
    let moved = irregular(beam("tet4", [20, 2, 2]), &[0.1, 0.01, 0.01], &[20, 2, 2], 0.2);
    bodies.push(("ring of tet4".into(), ring(moved, 0.1, 0.03), 0.3));
    for (name, mesh, poisson) in bodies {
        let material = Material::for_body(mesh.dimension, 1e6, poisson, None, None).unwrap();
        let mut traction = vec![0.0; mesh.dimension];
        traction[mesh.dimension - 1] = 1.0;
        let (u, work) = solved(&mesh, &material, &traction);
        let fine = if mesh.dimension == 2 { mesh.refined().unwrap() } else { mesh.clone() };
        let (_, truth) = solved(&fine.elevated().unwrap(), &material, &traction);
        let (share, right) = (lacking_energy(&mesh, &MaterialMap::from(material), &u, false), 1.0 - work / truth);
        assert!((share - right).abs() <= 0.2 * right + 0.01, "{name}: {share:.3}, {right:.3}");
    }
}

/// Strains that are linear, or the same everywhere, have no jumps that tell of missing energy: a rigid motion, a stretch, and shear.
#[test]
fn nothing_lacks_where_strains_are_those_of_the_cells() {
    for (element, cells) in
        [("tri3", vec![4, 3]), ("quad4", vec![4, 3]), ("tet4", vec![2, 3, 2]), ("hex8", vec![2, 3, 2])]
    {
        let size = vec![1.0; cells.len()];
        let mesh = irregular(grid(element, &size, &cells), &size, &cells, 0.2);
        let d = mesh.dimension;
        let material = MaterialMap::from(Material::for_body(d, 1e6, 0.3, None, None).unwrap());
        let linear = |slopes: &[f64]| -> Vec<f64> {
            let row = |x: &[f64], k: usize| (0..d).map(|l| slopes[k * 3 + l] * x[l]).sum::<f64>();
            mesh.points.chunks_exact(d).flat_map(|x| (0..d).map(move |k| row(x, k))).collect()
        };
        let sheared = linear(&[0.01, 0.02, 0.0, -0.01, 0.003, 0.01, 0.0, 0.0, -0.02]);
        assert!(lacking_energy(&mesh, &material, &sheared, false) < 1e-20);
        // A rotation strains nothing by Green's measure, and its rest is rounding.
        let (sine, cosine) = 1_f64.sin_cos();
        let turned: Vec<f64> = linear(&[cosine - 1.0, -sine, 0.0, sine, cosine - 1.0, 0.0, 0.0, 0.0, 0.0]);
        let stretched: Vec<f64> = turned.iter().zip(&sheared).map(|(a, b)| a + b).collect();
        assert!(lacking_energy(&mesh, &material, &stretched, true) < 1e-20);
        assert_eq!(lacking_energy(&mesh, &material, &vec![0.0; mesh.points.len()], false), 0.0);
        assert!(lacking_energy(&mesh, &material, &vec![f64::NAN; mesh.points.len()], false).is_nan());
    }
}
