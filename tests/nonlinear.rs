//! Large deformation: forces and tangents of elements, Newton's method on both models.

use crate::shapes::bodies::grid;
use crate::shapes::statics::{assert_derivatives, support_at};
use crate::shapes::{Random, distorted, elements, geometry, loaded};
use nalgebra::Matrix3;
use springfit_bodies::model::{Action, Body, Elastic, LengthSpring, Network, Support, finite_elements, nodal_forces};
use springfit_bodies::solve::{Ending, Newton, System};
use springfit_element::element::SpringKind;
use springfit_element::material::{Energy, Material, Plane, SHIPPED, State};
use springfit_element::springs::Springs;
use springfit_element::stiffness::ElementResponse;
use springfit_fit::fit::{CellFits, Fit, Higher, Objective, Weight, fit_cells};
use springfit_mesh::mesh::{Mesh, Selection};

fn cube(name: &str, cells: usize) -> Mesh {
    let d = loaded(name).dimension();
    grid(name, &vec![1.0; d], &vec![cells; d])
}

fn of(response: ElementResponse) -> (f64, Vec<f64>) {
    (response.energy, response.force.as_slice().to_vec())
}

/// Central differences of step 1e-6 of the sizes here err by 1e-9 of the tangent.
#[test]
fn element_forces_and_tangents_are_those_of_differences() {
    for element in elements().iter().filter(|e| e.nodes() <= 8) {
        let d = element.dimension();
        let mut random = Random(9);
        let rest = distorted(element, &mut random);
        let geometry = geometry(element, &rest);
        let planes = if d == 2 { vec![Some(Plane::Stress), Some(Plane::Strain)] } else { vec![None] };
        for plane in planes {
            let material = Material::for_body(d, 1.0, 0.3, plane, None).unwrap();
            for (name, _) in SHIPPED.iter().filter(|(name, _)| d == 3 || *name == "neo-hookean" || *name == "ogden") {
                let energy = Energy::load(name, material).unwrap();
                let x: Vec<f64> = rest.iter().map(|x| x * 1.1 + 0.08 * random.next()).collect();
                let at = |x: &[f64]| geometry.respond(&energy, material.state(), x).unwrap();
                let tangent = at(&x).tangent;
                let near = 1e-7 * tangent.norm();
                let name = format!("{} {name} {plane:?}", element.name);
                assert_derivatives(&name, &x, (1e-6, [near; 2]), |x| of(at(x)), |i, j| tangent[(i, j)]);
            }
        }
    }
}

/// Cells of surfaces and curves in space: forces and tangents against differences, the same energy wherever the cell is turned, and that of the plane.
#[test]
fn membranes_and_rods_in_space_have_the_forces_of_their_energy() {
    let mut tested = 0;
    for element in elements().iter().filter(|element| element.dimension() < 3 && element.nodes() <= 8) {
        let d = element.dimension();
        let mut random = Random(4);
        let local = distorted(element, &mut random);
        let geometry = geometry(element, &local);
        let material = Material::for_body(d, 1.0, 0.3, None, None).unwrap();
        for space in d + 1..=3 {
            for name in ["neo-hookean", "corotational", "mooney-rivlin", "st-venant-kirchhoff"] {
                let energy = Energy::load(name, material).unwrap();
                let at = |x: &[f64]| geometry.respond(&energy, material.state(), x).unwrap();
                let raised = |x: &[f64], turn: &Matrix3<f64>| -> Vec<f64> {
                    let place = |x: &[f64]| turn * nalgebra::Vector3::new(x[0], x.get(1).copied().unwrap_or(0.0), 0.0);
                    x.chunks_exact(d).flat_map(|x| place(x).as_slice()[..space].to_vec()).collect()
                };
                let (s, c) = 0.7f64.sin_cos();
                let turn = match space {
                    2 => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
                    _ => *nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 0.7).matrix(),
                };
                let pulled: Vec<f64> = local.iter().map(|x| 1.15 * x + 0.05 * random.next()).collect();
                let flat = at(&pulled);
                let turned = at(&raised(&pulled, &turn));
                assert!((flat.energy - turned.energy).abs() < 1e-13, "{} {name}: {}", element.name, flat.energy);
                assert!(geometry.bend(&raised(&local, &turn)) < 1e-12, "{}", element.name);
                // Out of its plane as well.
                let x: Vec<f64> = raised(&pulled, &turn).iter().map(|x| x + 0.03 * random.next()).collect();
                let now = at(&x);
                let size = now.tangent.norm();
                let mut forces = vec![0.0; x.len()];
                assert!(geometry.forces(&energy, material.state(), &x, f64::NEG_INFINITY, &mut forces));
                for i in 0..x.len() {
                    assert!((forces[i] - now.force[i]).abs() < 1e-12 * size, "{} {name}", element.name);
                }
                let name = format!("{} {name} in {space}", element.name);
                assert_derivatives(&name, &x, (1e-6, [1e-7 * size; 2]), |x| of(at(x)), |i, j| now.tangent[(i, j)]);
                tested += 1;
            }
        }
    }
    assert!(tested >= 24, "{tested}");
}

/// At rest the tangent is the linear stiffness, in every state.
#[test]
fn the_tangent_at_rest_is_the_linear_stiffness() {
    for element in elements().iter().filter(|e| e.nodes() <= 10) {
        let d = element.dimension();
        let x = distorted(element, &mut Random(2));
        let geometry = geometry(element, &x);
        for material in crate::shapes::materials(d).into_iter().filter(|_| d > 1) {
            for name in ["neo-hookean", "corotational", "mooney-rivlin"] {
                let energy = Energy::load(name, material).unwrap();
                let now = geometry.respond(&energy, material.state(), &x).unwrap();
                let linear = geometry.stiffness(material.moduli());
                // Plane stress finds its stretch to 1e-14.
                assert!((now.tangent - &linear).norm() < 1e-9 * linear.norm(), "{} {name}", element.name);
                assert!(now.force.iter().all(|f| f.abs() < 1e-9 * linear.norm()));
            }
        }
    }
}

/// A cube under a homogeneous deformation: the forces on a face are P n times its area, in stretch and in shear.
#[test]
fn a_deformed_cube_carries_the_stress_of_its_energy() {
    let mesh = cube("hex8", 1);
    let material = Material::new(1.0, 0.3, State::Solid).unwrap();
    let face = Selection::Group("xmax".into()).points(&mesh).unwrap();
    for (name, _) in SHIPPED {
        let energy = Energy::load(name, material).unwrap();
        for f in [
            Matrix3::new(1.4, 0.0, 0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 0.9),
            Matrix3::new(1.2, 0.0, 0.0, 0.0, 1.2, 0.0, 0.0, 0.0, 0.8),
            Matrix3::new(1.0, 0.6, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        ] {
            let x: Vec<f64> = mesh
                .points
                .chunks_exact(3)
                .flat_map(|x| (f * nalgebra::Vector3::from_column_slice(x)).as_slice().to_vec())
                .collect();
            let response = Body::new(&mesh, &(energy.clone(), State::Solid).into()).respond(&x).unwrap();
            let (_, stress, _) = energy.respond(&f);
            for k in 0..3 {
                let total: f64 = face.iter().map(|p| response.force[3 * p + k]).sum();
                assert!((total - stress[(k, 0)]).abs() < 1e-10, "{name}");
            }
        }
    }
}

fn pulled(mesh: &Mesh, traction: f64) -> (Support, Vec<f64>) {
    let d = mesh.dimension;
    let support = support_at(mesh, &Selection::Group("xmin".into()).points(mesh).unwrap());
    let mut pull = vec![0.0; d];
    pull[0] = traction;
    let forces = nodal_forces(mesh, &Selection::Group("xmax".into()), &Action::traction(&pull), 1.0).unwrap();
    (support, forces)
}

/// Near the solution each residual is at most a multiple of the square of the one before, for every energy; a small load
/// gives the linear displacements, the difference growing with the square of the load.
#[test]
fn newtons_method_converges_quadratically() {
    for name in ["hex8", "tet4", "quad4"] {
        let mesh = cube(name, 2);
        let material = Material::for_body(mesh.dimension, 1.0, 0.3, None, None).unwrap();
        for (law, _) in SHIPPED.iter().filter(|(law, _)| *law != "st-venant-kirchhoff") {
            let energy = Energy::load(law, material).unwrap();
            let laws = (energy.clone(), material.state()).into();
            let body = Body::new(&mesh, &laws);
            let (support, forces) = pulled(&mesh, 0.2);
            let found = Newton::default().solve(&body, &mesh.points, &support, &forces).unwrap();
            assert_eq!((found.ending, found.load), (Ending::Converged, 1.0), "{name} {law}");
            let history = found.residuals.last().unwrap();
            println!("{name} {law}: {history:?}");
            let fast = history.windows(2).filter(|r| r[0] < 1e-2 && r[0] > 1e-7);
            let constants: Vec<f64> = fast.map(|r| r[1] / (r[0] * r[0])).collect();
            assert!(!constants.is_empty() && constants.iter().all(|c| *c < 100.0), "{name} {law}: {history:?}");
            let place: Vec<f64> = mesh.points.iter().zip(&found.displacement).map(|(x, u)| x + u).collect();
            assert_eq!(body.inverted(&place), 0);
            if *law == "fibre" {
                continue;
            }
            let linear = {
                let system = System::new(&finite_elements(&mesh, material.moduli()), &support).unwrap();
                system.solve(&system.factorize().unwrap().unwrap(), &forces).0
            };
            let difference = |load: f64| {
                let small: Vec<f64> = forces.iter().map(|f| f * load).collect();
                let found = Newton::default().solve(&body, &mesh.points, &support, &small).unwrap();
                let errors = found.displacement.iter().zip(&linear).map(|(u, v)| (u - load * v).abs());
                errors.fold(0.0, f64::max)
            };
            let (one, half) = (difference(1e-3), difference(5e-4));
            assert!(one < 1e-5 && (3.8..4.2).contains(&(one / half)), "{name} {law}: {one} {half}");
        }
    }
}

/// Prescribed displacements, in steps, to twice the length.
#[test]
fn supports_that_move_are_followed() {
    let mesh = cube("hex8", 2);
    let material = Material::new(1.0, 0.3, State::Solid).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let laws = (energy.clone(), State::Solid).into();
    let body = Body::new(&mesh, &laws);
    let mut support = Support::free(&mesh);
    // Rollers on three faces: the deformation is homogeneous.
    for (face, axis) in [("xmin", 0), ("ymin", 1), ("zmin", 2)] {
        support.fix(&Selection::Group(face.into()).points(&mesh).unwrap(), &[axis], 3);
    }
    for p in Selection::Group("xmax".into()).points(&mesh).unwrap() {
        support.prescribed[3 * p] = Some(1.0);
    }
    let newton = Newton { steps: 4, ..Newton::default() };
    let found = newton.solve(&body, &mesh.points, &support, &vec![0.0; mesh.points.len()]).unwrap();
    assert_eq!(found.ending, Ending::Converged);
    // The stretch across that leaves no stress: μ (z − 1/z) + λ ln(2 z²)/z = 0
    let (lambda, mu) = (0.3 / (1.3 * 0.4), 0.5 / 1.3);
    let pull = |z: f64| mu * (z - 1.0 / z) + lambda * (2.0 * z * z).ln() / z;
    let (mut low, mut high) = (0.5, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if pull(middle) > 0.0 { high = middle } else { low = middle }
    }
    for (x, u) in mesh.points.chunks_exact(3).zip(found.displacement.chunks_exact(3)) {
        for (k, stretch) in [2.0, low, low].into_iter().enumerate() {
            assert!((u[k] - (stretch - 1.0) * x[k]).abs() < 1e-9, "{x:?} {u:?}");
        }
    }
}

fn truss(height: f64) -> (Network, Vec<f64>, Support) {
    let points = vec![-1.0, 0.0, 1.0, 0.0, 0.0, height];
    let rest = (1.0 + height * height).sqrt();
    let lengths = [[0, 2], [1, 2]].map(|points| LengthSpring { points, constant: 1.0, rest }).into();
    let mut support = Support { prescribed: vec![None; 6] };
    for dof in [0, 1, 2, 3] {
        support.prescribed[dof] = Some(0.0);
    }
    (Network { dimension: 2, lengths, others: Vec::new() }, points, support)
}

/// Two springs in a shallow roof under a load on the ridge: on the way down the load is `2k (L − ℓ)(h + v)/ℓ`; past its
/// maximum the roof snaps through, where the tangent is not positive definite on the way.
#[test]
fn a_shallow_truss_snaps_through() {
    let (network, points, support) = truss(0.3);
    let load = |v: f64| {
        let length = (1.0f64 + (0.3 + v) * (0.3 + v)).sqrt();
        2.0 * (1.09f64.sqrt() - length) * (0.3 + v) / length
    };
    let most = (0..3000).map(|i| load(-1e-4 * i as f64)).fold(0.0, f64::max);
    for share in [0.5, 0.95, 1.5] {
        let mut forces = vec![0.0; 6];
        forces[5] = -share * most;
        let found = Newton::default().solve(&network, &points, &support, &forces).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{share}: {found:?}");
        let v = found.displacement[5];
        assert!((load(v) + forces[5]).abs() < 1e-9 * most.max(1.0), "{share}: {v} {}", load(v));
        assert_eq!(v < -0.3, share > 1.0, "{share}: {v}");
    }
}

/// What cannot be carried is a status with the load that was.
#[test]
fn a_load_beyond_reach_is_told() {
    let (network, points, support) = truss(0.3);
    let mut forces = vec![0.0; 6];
    forces[5] = -0.01;
    let newton = Newton { iterations: 1, ..Newton::default() };
    let found = newton.solve(&network, &points, &support, &forces).unwrap();
    assert_eq!(found.ending, Ending::Stalled);
    assert!(found.load < 1.0 && !found.residuals.is_empty());
}

/// A network with springs on volumes, pulled by half: in equilibrium, and softer or stiffer than its linear model by no more
/// than its geometry makes of it.
#[test]
fn networks_are_solved_at_large_deformation() {
    let mesh = cube("hex8", 3);
    let block = &mesh.blocks[0];
    let every: Vec<String> = block.element.springs.iter().map(|g| g.name.clone()).collect();
    let springs = Springs::select(&block.element, Some(&every)).unwrap();
    let material = Material::new(1.0, 0.3, State::Solid).unwrap();
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::Modal(Higher::DEFAULT))) };
    let fits: CellFits =
        fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, material.moduli(), &fit, &mut |_| {})
            .unwrap();
    let network = Network::assemble(&mesh, &[fits]);
    assert!(network.others.iter().any(|s| s.kind == SpringKind::Volume));
    let (support, forces) = pulled(&mesh, 0.3);
    let found = Newton { steps: 2, ..Newton::default() }.solve(&network, &mesh.points, &support, &forces).unwrap();
    assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
    let x: Vec<f64> = mesh.points.iter().zip(&found.displacement).map(|(x, u)| x + u).collect();
    let force = network.respond(&x).unwrap().force;
    let left = force.iter().zip(&forces).enumerate().filter(|(i, _)| !support.is_fixed(*i));
    assert!(left.map(|(_, (g, f))| (g - f).abs()).fold(0.0, f64::max) < 1e-9);
    let largest = found.displacement.iter().fold(0.0f64, |a, u| a.max(*u));
    assert!((0.2..0.6).contains(&largest), "{largest}");
}
