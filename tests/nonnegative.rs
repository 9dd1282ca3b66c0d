//! The nearest network without negative springs to an exact one.

use crate::kit::place;
use crate::shapes::statics::support_at;
use crate::shapes::{Random, bodies};
use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Elastic, LengthSpring, Network};
use springfit_bodies::solve::System;
use springfit_element::material::Material;
use springfit_fit::fit::{ExactEnergy, ExactFit, ShearSprings, VolumeSprings, fit_exact};
use springfit_foundation::error::ErrorKind;
use springfit_identify::positive::{PositiveFit, PositiveOutcome, Route, nearest_positive};
use springfit_mesh::mesh::{Mesh, MeshSource};
use springfit_numerics::dense::least_squares;
use springfit_studies::study::{FittedKind, Scene, run};
use std::collections::HashMap;

const EXACT: ExactFit = ExactFit {
    energy: ExactEnergy::StableNeoHookean,
    shear: ShearSprings::Cells,
    volume: VolumeSprings::Points,
    large: false,
};

/// A mesh of tetrahedra made by gmsh.
fn gmsh(name: &str) -> Mesh {
    let path = place(format!("scenes/meshes/{name}.msh"));
    Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 0.01).unwrap()
}

fn grid(element: &str, cells: &[usize]) -> Mesh {
    bodies::grid(element, &vec![1.0; cells.len()], cells)
}

/// Leans along the first axis: the angles of Kuhn's tetrahedra become obtuse, all in the same way.
fn sheared(mut mesh: Mesh, shear: f64) -> Mesh {
    let d = mesh.dimension;
    mesh.points.chunks_exact_mut(d).for_each(|x| x[0] += shear * x[d - 1]);
    mesh
}

fn material(d: usize) -> Material {
    Material::for_body(d, 1e4, 0.3, None, None).unwrap()
}

fn exact(mesh: &Mesh, fit: ExactFit) -> Network {
    let block = &mesh.blocks[0];
    let material = material(mesh.dimension);
    let cells = fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {}).unwrap();
    Network::assemble(mesh, &[cells])
}

fn nearest(mesh: &Mesh, network: &Network) -> (Network, PositiveOutcome) {
    nearest_positive(mesh, network, &PositiveFit::default(), &mut |_, _| {}).unwrap()
}

fn forces(network: &Network, x: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    assert!(network.forces(x, &mut force));
    force
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0f64, |a, x| a.max(x.abs()))
}

/// The largest force of a spring at rest.
fn pull(network: &Network, mesh: &Mesh) -> f64 {
    let length =
        |s: &LengthSpring| springfit_element::springs::distance(mesh.point(s.points[0]), mesh.point(s.points[1]));
    network.lengths.iter().map(|s| s.constant.abs() * length(s)).fold(0.0, f64::max)
}

/// The compliance `fᵀ K⁻¹ f` with the points of least z held, under equal forces along `axis` on those of largest z.
fn compliance(mesh: &Mesh, network: &Network, axis: usize) -> f64 {
    let d = mesh.dimension;
    let heights = || mesh.points.iter().skip(d - 1).step_by(d);
    let [low, high] = heights().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(*z), b.max(*z)]);
    let at = |height: f64| {
        let near = move |z: &f64| (z - height).abs() < 1e-6 * (high - low);
        heights().enumerate().filter(move |(_, z)| near(z)).map(|(p, _)| p)
    };
    let support = support_at(mesh, &at(low).collect::<Vec<_>>());
    let mut load = vec![0.0; mesh.points.len()];
    at(high).for_each(|p| load[p * d + axis] = 1.0);
    let system = System::new(&network.stiffness(&mesh.points), &support).unwrap();
    let factor = system.cholesky().unwrap().expect("the network is positive definite with supports");
    let (u, residual) = system.solve(&factor, &load);
    assert!(residual < 1e-8, "{residual:e}");
    u.iter().zip(&load).map(|(u, f)| u * f).sum()
}

/// No angle of Kuhn's tetrahedra, of half squares or of bricks near cubes is obtuse.
#[test]
fn exact_networks_without_negative_springs_stay_as_they_are() {
    for (element, cells) in [("tet4", &[3, 2, 2][..]), ("tri3", &[3, 2]), ("quad4", &[3, 3]), ("hex8", &[2, 2, 2])] {
        let mesh = grid(element, cells);
        let network = exact(&mesh, EXACT);
        let (found, outcome) = nearest(&mesh, &network);
        assert_eq!(network.negative(), 0, "{element}");
        assert_eq!((outcome.route, outcome.negative, outcome.dropped), (Route::Unchanged, 0, 0), "{element}");
        assert_eq!(found.lengths, network.lengths, "{element}");
    }
}

/// On meshes of gmsh, of which 17 to 18 % of the edges have negative constants: constants above zero, no force at rest, and the
/// forces of the exact network, hence of the finite elements, under any homogeneous deformation and any law.
#[test]
fn the_nearest_network_equals_the_exact_one_under_homogeneous_deformations() {
    for name in ["cube_tet", "cylinder_tet"] {
        let mesh = gmsh(name);
        for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean] {
            let network = exact(&mesh, ExactFit { energy, ..EXACT });
            assert!(network.negative() > network.lengths.len() / 7, "{name}");
            let (found, outcome) = nearest(&mesh, &network);
            assert_eq!((outcome.route, found.negative(), outcome.modes), (Route::Springs, 0, 10), "{name}");
            assert!(found.lengths.iter().all(|s| s.constant > 0.0 && s.rest == 0.0), "{name}");
            let left = largest(&forces(&found, &mesh.points)) / pull(&found, &mesh);
            // The correction ends at 1e-14; sums of some twenty forces round to that as well.
            assert!(left < 1e-12 && outcome.rest_force < 1e-12, "{name}: {left:e} {}", outcome.rest_force);
            let mut random = Random(7);
            for _ in 0..5 {
                let f = DMatrix::from_fn(3, 3, |i, j| f64::from(u8::from(i == j)) + 0.4 * random.next());
                let place = |x: &[f64]| (&f * DVector::from_column_slice(x)).as_slice().to_vec();
                let x: Vec<f64> = mesh.points.chunks_exact(3).flat_map(place).collect();
                let (ours, theirs) = (forces(&found, &x), forces(&network, &x));
                let apart: Vec<f64> = ours.iter().zip(&theirs).map(|(a, b)| a - b).collect();
                assert!(largest(&apart) < 1e-11 * pull(&found, &mesh), "{name}: {:e}", largest(&apart));
            }
            // Homogeneous strains keep their energies to rounding.
            assert!(outcome.affine < 1e-10, "{name}: {:e}", outcome.affine);
        }
    }
}

/// Where clamping negative constants at zero leaves a force at rest, the nearest network is within 2 % under tension and shear.
#[test]
fn the_nearest_network_answers_like_the_finite_elements() {
    for name in ["cube_tet", "cylinder_tet"] {
        let mesh = gmsh(name);
        let network = exact(&mesh, EXACT);
        let (found, outcome) = nearest(&mesh, &network);
        for axis in [0, 2] {
            let error = compliance(&mesh, &found, axis) / compliance(&mesh, &network, axis) - 1.0;
            assert!(error.abs() < 0.02, "{name}: {error}");
        }
        let [low, high] = outcome.mode_errors;
        assert!(-0.01 < low && high < 0.01, "{name}: {low} {high}");
        let mut clamped = network.clone();
        clamped.lengths.retain(|s| s.constant > 0.0);
        let left = largest(&forces(&clamped, &mesh.points)) / pull(&clamped, &mesh);
        assert!(left > 0.05, "{name}: {left}");
    }
}

/// Without modes to keep, the network is the minimum of `Σ_e δk_e² ℓ_e²/V_e`: there are multipliers y of the points such that
/// `δk_e ℓ_e²/V_e = (X_j − X_i)·(y_j − y_i)` for springs above zero, and the right side is not larger for the others.
#[test]
fn the_nearest_network_satisfies_the_optimality_conditions() {
    for mesh in [gmsh("cube_tet"), gmsh("cylinder_tet"), sheared(gmsh("tissue_tri"), 0.3)] {
        let d = mesh.dimension;
        let network = exact(&mesh, EXACT);
        let fit = PositiveFit { modes: 0, ..PositiveFit::default() };
        let (found, outcome) = nearest_positive(&mesh, &network, &fit, &mut |_, _| {}).unwrap();
        assert!(outcome.route == Route::Springs && outcome.dropped > 0, "{outcome:?}");
        let volumes = edge_volumes(&mesh);
        let constants = |network: &Network| -> HashMap<[usize; 2], f64> {
            network.lengths.iter().map(|s| (s.points, s.constant)).collect()
        };
        let (before, after) = (constants(&network), constants(&found));
        let row = |[i, j]: [usize; 2]| {
            let mut row = DVector::zeros(mesh.points.len());
            for k in 0..d {
                let r = mesh.point(j)[k] - mesh.point(i)[k];
                (row[i * d + k], row[j * d + k]) = (-r, r);
            }
            row
        };
        let force = |edge: &[usize; 2]| {
            let change = after.get(edge).unwrap_or(&0.0) - before.get(edge).unwrap_or(&0.0);
            change * row(*edge).norm_squared() / 2.0 / volumes[edge]
        };
        let kept: Vec<[usize; 2]> = volumes.keys().copied().filter(|edge| after.contains_key(edge)).collect();
        let rows = DMatrix::from_fn(kept.len(), mesh.points.len(), |e, dof| row(kept[e])[dof]);
        let forces = DVector::from_iterator(kept.len(), kept.iter().map(force));
        let multipliers = least_squares(rows.clone(), &forces, 1e-10).unwrap();
        let left = (&rows * &multipliers - &forces).amax() / forces.amax();
        assert!(left < 1e-9, "{left:e}");
        for edge in volumes.keys().filter(|edge| !after.contains_key(*edge)) {
            let excess = row(*edge).dot(&multipliers) - force(edge);
            assert!(excess < 1e-9 * forces.amax(), "{edge:?}: {excess:e}");
        }
    }
}

/// The share of the contents of the cells for each edge of simplices.
fn edge_volumes(mesh: &Mesh) -> HashMap<[usize; 2], f64> {
    let (d, mut volumes) = (mesh.dimension, HashMap::new());
    for nodes in mesh.blocks[0].cells() {
        let sides = DMatrix::from_fn(d, d, |k, a| mesh.point(nodes[a + 1])[k] - mesh.point(nodes[0])[k]);
        for (a, &i) in nodes.iter().enumerate() {
            for &j in &nodes[a + 1..] {
                *volumes.entry([i.min(j), i.max(j)]).or_default() += sides.determinant().abs();
            }
        }
    }
    volumes
}

/// The same network for other units of length and modulus, whose constants scale alike.
#[test]
fn the_nearest_network_has_no_unit() {
    let mesh = gmsh("cylinder_tet");
    let (found, _) = nearest(&mesh, &exact(&mesh, EXACT));
    let mut large = mesh.clone();
    large.points.iter_mut().for_each(|x| *x = *x * 1e3 + 5.0);
    let (scaled, _) = nearest(&large, &exact(&large, EXACT));
    assert_eq!(found.lengths.len(), scaled.lengths.len());
    let size = found.lengths.iter().map(|s| s.constant).fold(0.0, f64::max);
    for (a, b) in found.lengths.iter().zip(&scaled.lengths) {
        assert!(a.points == b.points && (a.constant - b.constant / 1e3).abs() < 1e-10 * size, "{a:?} {b:?}");
    }
}

/// All obtuse angles of a sheared box of Kuhn's tetrahedra face the same way: no positive springs between points of one cell are
/// in balance. Springs across faces repair it.
#[test]
fn a_sheared_box_has_the_zero_network_alone_until_springs_go_across_faces() {
    let mesh = sheared(grid("tet4", &[3, 3, 3]), 0.5);
    let network = exact(&mesh, EXACT);
    let error = nearest_positive(&mesh, &network, &PositiveFit::default(), &mut |_, _| {}).unwrap_err();
    assert_eq!((error.kind(), error.key()), (ErrorKind::Infeasible, Some("nonnegative")));
    assert!(error.problem().contains("only the zero network") && error.problem().contains("across"), "{error}");
    let mut steps = Vec::new();
    let mut watch = |done: usize, total: usize| steps.push((done, total));
    let across = PositiveFit { across: true, modes: 10 };
    let (found, outcome) = nearest_positive(&mesh, &network, &across, &mut watch).unwrap();
    assert!(steps.len() > 5 && steps.iter().all(|(done, total)| done <= total), "{steps:?}");
    assert!(outcome.route == Route::Across && outcome.across > 0 && found.negative() == 0, "{outcome:?}");
    assert!(largest(&forces(&found, &mesh.points)) < 1e-12 * pull(&found, &mesh));
    for axis in [0, 2] {
        let error = compliance(&mesh, &found, axis) / compliance(&mesh, &network, axis) - 1.0;
        assert!(error.abs() < 0.1, "{error}");
    }
}

/// This mesh has corners that no positive springs balance while all cells push alike.
#[test]
fn tensions_of_volume_springs_change_where_springs_alone_do_not_suffice() {
    let mesh = gmsh("specimen_tet");
    for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean] {
        let network = exact(&mesh, ExactFit { energy, ..EXACT });
        let (found, outcome) = nearest(&mesh, &network);
        assert!(outcome.route == Route::Tensions && found.negative() == 0, "{outcome:?}");
        assert!(largest(&forces(&found, &mesh.points)) < 1e-12 * pull(&found, &mesh));
        let [least, most] = outcome.tensions;
        assert!(least < 0.9 && most > 1.1, "{outcome:?}");
        assert!(outcome.affine < 0.01 && outcome.mode_errors.iter().all(|e| e.abs() < 0.02), "{outcome:?}");
        assert!(found.stiffness(&mesh.points).iter().all(|e| e.val.is_finite()));
    }
}

/// Each fault of the mesh, of the network or of both is an error, and no network is returned.
#[test]
fn wrong_networks_are_refused() {
    let mesh = sheared(grid("tet4", &[2, 2, 2]), 0.5);
    let network = exact(&mesh, EXACT);
    let refused = |change: &dyn Fn(&mut Network)| {
        let mut network = network.clone();
        change(&mut network);
        nearest_positive(&mesh, &network, &PositiveFit::default(), &mut |_, _| {}).unwrap_err()
    };
    assert_eq!(refused(&|n| n.dimension = 2).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths[0].points[1] = 1000).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths[0].rest = 0.1).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths[0].constant = f64::NAN).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths[0].constant = f64::INFINITY).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths.reverse()).key(), Some("network"));
    assert_eq!(refused(&|n| n.lengths.iter_mut().for_each(|s| s.constant = -1.0)).key(), Some("nonnegative"));
    assert_eq!(refused(&|n| n.others[0].constant = -1.0).kind(), ErrorKind::Unsupported);
    assert_eq!(refused(&|n| n.others[0].points[0] = 1000).key(), Some("network"));
    // Without the springs on content the others pull at rest and nothing pushes.
    assert_eq!(refused(&|n| n.others.clear()).kind(), ErrorKind::Infeasible);
    let bricks = sheared(grid("hex8", &[2, 2, 2]), 1.5);
    let across = PositiveFit { across: true, ..PositiveFit::default() };
    let error = nearest_positive(&bricks, &exact(&bricks, EXACT), &across, &mut |_, _| {}).unwrap_err();
    assert_eq!((error.kind(), error.key()), (ErrorKind::Unsupported, Some("across")), "{error}");
}

fn scene(fit: &str) -> springfit_foundation::error::Result<Scene> {
    let text = format!(
        "[mesh]\nfile = \"cylinder_tet.msh\"\nscale = 0.01\n[material]\nyoung = 1e4\npoisson = 0.3\n[[fit]]\n\
         objective = \"exact\"\n{fit}\n[[fix]]\ngroup = \"fixed\"\n[[load]]\ngroup = \"load\"\ntraction = [1000, 0, 1000]\n"
    );
    Scene::parse(&text, &place("scenes/meshes/scene.toml"))
}

/// A scene has the network, its notes and a stable answer.
#[test]
fn scenes_ask_for_networks_without_negative_springs() {
    let outcome = run(&scene("nonnegative = true").unwrap(), &mut |_| {}).unwrap();
    let fit = &outcome.fits[0];
    assert_eq!((fit.network.negative(), fit.status(), fit.fit.name.as_str()), (0, "stable", "exact k>=0"));
    let FittedKind::Exact(exact) = &fit.kind else { panic!("an exact fit") };
    let positive = exact.positive.unwrap();
    assert!(positive.route == Route::Springs && positive.negative > 50, "{positive:?}");
    assert!(exact.notes().iter().any(|note| note.contains("nearest")), "{:?}", exact.notes());
    let error = scene("across = true").unwrap_err();
    assert_eq!(error.key(), Some("fit[0].across"), "{error}");
}

/// As a material the nearest network is that of the body, with volume springs on patches as well: what reaches beyond a sample counts.
#[test]
fn the_nearest_network_is_the_material() {
    for volume in ["points", "cells", "patches"] {
        let text = format!(
            "[mesh]\nfile = \"scenes/meshes/cube_tet.msh\"\nscale = 0.01\n[material]\nyoung = 1e4\npoisson = 0.45\n[[fit]]\n\
             objective = \"exact\"\nvolume = \"{volume}\"\nnonnegative = true\n"
        );
        let scene = Scene::parse(&text, &place("scene.toml")).unwrap();
        let found = run(&scene, &mut |_| {}).unwrap().fits.remove(0).as_material;
        println!("{volume}: {:.4} off, E = {:?}", found.distance, found.young);
        // Samples have parts of the tensions that balance: a per cent or so is left of a network that is exact as a whole.
        assert!(found.distance < 0.05 && (found.young.unwrap() / 1e4 - 1.0).abs() < 0.1, "{volume}: {found:?}");
    }
}

/// A sheet in a coordinate plane has equations without coefficients: those of the direction across it.
#[test]
fn a_sheet_in_a_coordinate_plane_has_a_nearest_network() {
    let folder = tempfile::TempDir::new().unwrap();
    let place = |i: usize, j: usize| {
        let shift = |seed: usize| 0.2 * ((seed * 37 % 11) as f64 / 11.0 - 0.5);
        [i as f64 + shift(i + 5 * j), j as f64 + shift(2 * i + 7 * j + 3)]
    };
    let points: String = (0..25).map(|p| place(p % 5, p / 5)).map(|[x, z]| format!("v {x} 0 {z}\n")).collect();
    let quad = |c: usize| (c % 4 + 5 * (c / 4) + 1, c % 4 + 5 * (c / 4) + 2);
    let cells: String =
        (0..16).map(quad).map(|(a, b)| format!("f {a} {b} {}\nf {a} {} {}\n", b + 5, b + 5, a + 5)).collect();
    std::fs::write(folder.path().join("sheet.obj"), points + &cells).unwrap();
    let text = "[mesh]\nfile = \"sheet.obj\"\n[material]\nyoung = 1e4\npoisson = 0.3\nthickness = 0.01\n[[fit]]\nobjective = \"exact\"\n\
                nonnegative = true\n";
    let scene = Scene::parse(text, &folder.path().join("scene.toml")).unwrap();
    let found = run(&scene, &mut |_| {}).unwrap().fits.remove(0);
    assert!(found.network.lengths.iter().all(|spring| spring.constant >= 0.0 && spring.constant.is_finite()));
    assert!(found.network.lengths.iter().any(|spring| spring.constant > 0.0));
}
