//! What every element file must give, at random distorted shapes.

use crate::shapes::statics::product;
use crate::shapes::{Random, distorted, elements, geometry, materials, rigid_motions};
use nalgebra::DVector;
use springfit_bodies::model::{Support, finite_elements};
use springfit_bodies::solve::System;
use springfit_element::element::Element;
use springfit_element::springs::Springs;
use springfit_element::stiffness::{Fault, Geometry};
use springfit_mesh::mesh::{BoxMesh, Mesh, Selection};
use springfit_numerics::dense::eigenvalues;
use std::sync::Arc;

/// Central differences of step 1e-5 err by about 1e-10 for functions of size one.
#[test]
fn gradients_are_those_of_differences() {
    for element in elements() {
        let d = element.dimension();
        let mut random = Random(1);
        for _ in 0..20 {
            let at: Vec<f64> = (0..d).map(|_| 0.3 * (1.0 + random.next()) / d as f64).collect();
            let sum: f64 = element.functions.values.iter().map(|n| n.evaluate(&at)).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{}", element.name);
            for (n, gradient) in element.functions.values.iter().zip(&element.functions.gradients) {
                for k in 0..d {
                    let moved = |h: f64| {
                        let mut at = at.clone();
                        at[k] += h;
                        n.evaluate(&at)
                    };
                    let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                    assert!((gradient[k].evaluate(&at) - difference).abs() < 1e-8, "{}", element.name);
                }
            }
        }
    }
}

/// R is symmetric, vanishes on rigid motions, and is positive on all others (rank 2n − 3, 3n − 6). Rounding of a few hundred
/// products is below 1e-12 of ‖R‖.
#[test]
fn stiffness_is_symmetric_and_of_full_rank() {
    for element in elements() {
        let (d, n) = (element.dimension(), element.nodes());
        let mut random = Random(2);
        for _ in 0..20 {
            let x = distorted(&element, &mut random);
            let geometry = geometry(&element, &x);
            for material in materials(d) {
                let moduli = material.moduli();
                let r = geometry.stiffness(moduli);
                let size = r.norm();
                assert!((&r - r.transpose()).norm() == 0.0);
                for u in rigid_motions(&x, d) {
                    assert!((&r * DVector::from_vec(u)).norm() < 1e-12 * size, "{}", element.name);
                }
                let eigenvalues = eigenvalues(r.clone());
                let positive = eigenvalues.iter().filter(|e| **e > 1e-9 * size).count();
                assert_eq!(positive, n * d - d * (d + 1) / 2, "{} nu {}", element.name, material.poisson());
                assert!(eigenvalues.min() > -1e-12 * size);
            }
        }
    }
}

#[test]
fn springs_feel_no_rigid_motion() {
    for element in elements() {
        let names: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
        let springs = Springs::select(&element, Some(&names)).unwrap();
        let mut random = Random(3);
        let x = distorted(&element, &mut random);
        let mut g = Vec::new();
        springs.gradients(&x, &geometry(&element, &x), &mut g);
        for g in g.chunks_exact(x.len()) {
            for u in rigid_motions(&x, element.dimension()) {
                let c: f64 = g.iter().zip(&u).map(|(g, u)| g * u).sum();
                assert!(c.abs() < 1e-13, "{}: {c}", element.name);
            }
        }
    }
}

/// `∫ ∇N dV` is the gradient of the content: differences of step 1e-5 of a polynomial of size ten.
#[test]
fn content_gradient_is_that_of_differences() {
    for element in elements() {
        let x = distorted(&element, &mut Random(4));
        let gradient = geometry(&element, &x).content_gradient();
        for i in 0..x.len() {
            let moved = |h: f64| {
                let mut x = x.clone();
                x[i] += h;
                geometry(&element, &x).content()
            };
            assert!(((moved(1e-5) - moved(-1e-5)) / 2e-5 - gradient[i]).abs() < 1e-8, "{}", element.name);
        }
    }
}

#[test]
fn the_reflection_turns_an_element_inside_out() {
    for element in elements() {
        let d = element.dimension();
        let x = distorted(&element, &mut Random(5));
        let order = element.reflection.clone().unwrap();
        let turned: Vec<f64> = order.iter().flat_map(|&a| x[a * d..(a + 1) * d].to_vec()).collect();
        let mut room = Geometry::new(&element.tabulation);
        assert_eq!(room.set(&element.tabulation, &turned), Err(Fault::Reversed), "{}", element.name);
    }
}

/// A box of cells with straight edges whose inner corners are moved; none for an element whose cells fill no box.
fn patch(element: Element, random: &mut Random) -> Option<Mesh> {
    let d = element.dimension();
    let corners = ["tri3", "quad4", "tet4", "hex8", "wedge6", "pyramid5"].map(|name| Element::load(name).unwrap());
    let linear = Arc::new(corners.into_iter().find(|e| e.cell == element.cell)?);
    let spec = BoxMesh { element: Arc::new(element), size: vec![1.0; d], cells: vec![3; d], origin: vec![0.0; d] };
    let mut mesh = spec.build().ok()?;
    let mut coarse = BoxMesh { element: linear.clone(), ..spec }.build().unwrap();
    for p in 0..coarse.point_count() {
        if coarse.point(p).iter().all(|x| *x > 1e-9 && *x < 1.0 - 1e-9) {
            (0..d).for_each(|k| coarse.points[p * d + k] += 0.04 * random.next());
        }
    }
    let element = mesh.blocks[0].element.clone();
    for (fine, corners) in mesh.blocks[0].cells().zip(coarse.blocks[0].cells()) {
        for (&p, at) in fine.iter().zip(element.positions.chunks_exact(d)) {
            // At the apex the functions of a pyramid have only a limit.
            let at: Vec<f64> = at.iter().map(|x| x * (1.0 - 1e-15)).collect();
            let weights: Vec<f64> = linear.functions.values.iter().map(|n| n.evaluate(&at)).collect();
            for k in 0..d {
                let place = weights.iter().zip(corners).map(|(n, &c)| n * coarse.point(c)[k]);
                mesh.points[p * d + k] = place.sum();
            }
        }
    }
    Some(mesh)
}

/// A linear displacement prescribed on the boundary of a distorted patch is the solution inside, and its stress is the
/// uniform one of the material. The condition of the patch costs three of sixteen digits.
#[test]
fn distorted_patches_carry_uniform_strain() {
    for element in elements() {
        let d = element.dimension();
        let mut random = Random(6);
        let Some(mesh) = patch(element, &mut random) else { continue };
        for material in materials(d) {
            let strain: Vec<f64> = (0..d * d).map(|_| 0.01 * random.next()).collect();
            let linear = |x: &[f64], k: usize| (0..d).map(|l| strain[k * d + l] * x[l]).sum::<f64>();
            let mut support = Support::free(&mesh);
            let mut exact = vec![0.0; mesh.points.len()];
            let mut inside = 0;
            for p in 0..mesh.point_count() {
                let x = mesh.point(p);
                let boundary = x.iter().any(|x| x.abs() < 1e-9 || (x - 1.0).abs() < 1e-9);
                inside += usize::from(!boundary);
                for k in 0..d {
                    exact[p * d + k] = linear(x, k);
                    if boundary {
                        support.prescribed[p * d + k] = Some(exact[p * d + k]);
                    }
                }
            }
            assert!(inside > 0);
            let entries = finite_elements(&mesh, material.moduli());
            let system = System::new(&entries, &support).unwrap();
            let (u, _) = system.solve(&system.factorize().unwrap().unwrap(), &vec![0.0; exact.len()]);
            let worst = u.iter().zip(&exact).map(|(u, e)| (u - e).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12, "{}: {worst}", mesh.blocks[0].element.name);

            // σ = λ tr(ε) I + 2μ ε: the nodal forces on the face xmax add up to its first column times the area 1.
            let (forces, moduli) = (product(&entries, &u), material.moduli());
            let face = Selection::Group("xmax".into()).points(&mesh).unwrap();
            let interior = |p: &usize| mesh.point(*p)[1..].iter().all(|x| *x > 1e-9 && *x < 1.0 - 1e-9);
            let symmetric = |i: usize, j: usize| (strain[i * d + j] + strain[j * d + i]) / 2.0;
            let trace: f64 = (0..d).map(|k| symmetric(k, k)).sum();
            for k in 0..d {
                let stress = 2.0 * moduli.mu * symmetric(k, 0) + if k == 0 { moduli.lambda * trace } else { 0.0 };
                // A point inside a face of a 3 × 3 grid carries 1/3 of the edge, 1/9 of the face, if cells are alike.
                let share: f64 = face.iter().filter(|p| interior(p)).map(|p| forces[p * d + k]).sum();
                let total = face.iter().map(|p| forces[p * d + k]).sum::<f64>();
                assert!(share.is_finite() && total.is_finite());
                let expected = stress * interior_share(&mesh, &face);
                assert!((share - expected).abs() < 1e-7, "{}: {share} {expected}", mesh.blocks[0].element.name);
            }
        }
    }
}

/// `∫ Σ N_a dA` over the points inside the face xmax.
fn interior_share(mesh: &Mesh, face: &[usize]) -> f64 {
    let d = mesh.dimension;
    let mut unit = vec![0.0; d];
    unit[0] = 1.0;
    let traction = springfit_bodies::model::Action::traction(&unit);
    let f = springfit_bodies::model::nodal_forces(mesh, &Selection::Group("xmax".into()), &traction, 1.0).unwrap();
    let area: f64 = f.iter().sum();
    assert!((area - 1.0).abs() < 1e-12, "the face has the area {area}");
    let interior = |p: &&usize| mesh.point(**p)[1..].iter().all(|x| *x > 1e-9 && *x < 1.0 - 1e-9);
    face.iter().filter(interior).map(|p| f[p * d]).sum()
}
