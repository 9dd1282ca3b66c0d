//! Rods that bend: springs on joints are the beam of Euler and Bernoulli, in any frame.

use crate::kit::prints;
use crate::shapes::Random;
use crate::shapes::statics::support_at;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use springfit_bodies::model::{
    Action, BendingSprings, Body, Component, Elastic, Network, bending_springs, displaced, exact_network,
    finite_elements, lumped_masses, nodal_forces,
};
use springfit_bodies::solve::{Ending, Newton, System, lowest_modes};
use springfit_element::element::{Element, SpringKind};
use springfit_element::material::{Energy, Material, State};
use springfit_foundation::symbolic::Scope;
use springfit_mesh::mesh::{CellBlock, Mesh, Selection};
use springfit_studies::study::{Scene, run};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// A round rod: E in Pa, ν, and the cross-section in m².
const YOUNG: f64 = 1e7;
const POISSON: f64 = 0.3;
const AREA: f64 = 1e-4;

fn material() -> Material {
    Material::new(YOUNG, POISSON, State::Rod { area: AREA }).unwrap()
}

/// `E A`, `E I` and `G J` of the rod: `I = A²/(4 π)`, `J = 2 I`.
fn stiffness() -> [f64; 3] {
    let bend = YOUNG * AREA * AREA / (4.0 * PI);
    [YOUNG * AREA, bend, bend / (1.0 + POISSON)]
}

/// Rods between these points, with joints.
fn frame(points: &[[f64; 3]], rods: &[[usize; 2]]) -> Mesh {
    let element = Arc::new(Element::load("bar2").unwrap().in_space(3));
    let blocks = vec![CellBlock { element, connectivity: rods.concat() }];
    let mesh = Mesh::of_cells(3, points.concat(), blocks);
    let gyration = AREA / (4.0 * PI);
    mesh.with_joints(vec![gyration; rods.len()], vec![gyration / (1.0 + POISSON); rods.len()]).unwrap()
}

fn line(points: &[[f64; 3]]) -> Mesh {
    let rods: Vec<[usize; 2]> = (1..points.len()).map(|p| [p - 1, p]).collect();
    frame(points, &rods)
}

/// The exact network of bars with these springs on joints.
fn network(mesh: &Mesh, springs: BendingSprings) -> Network {
    let fit = springfit_fit::fit::ExactFit::default();
    let bars = exact_network(mesh, &material().into(), &fit, &vec![false; mesh.point_count()]).unwrap();
    bars.joined(springs.of(mesh, &material().moduli().into()))
}

/// The equations of a network whose first node is clamped.
fn clamped(network: &Network, mesh: &Mesh) -> System {
    let support = support_at(mesh, &mesh.with_directors_of(&[0]));
    System::new(&network.stiffness(&mesh.points), &support).unwrap()
}

/// The displacements of the nodes under forces (N) and moments (N·m) at nodes, with these nodes held and clamped.
fn solved(mesh: &Mesh, clamped: &[usize], loads: &[(usize, [f64; 3], [f64; 3])]) -> Vec<f64> {
    let support = support_at(mesh, &mesh.with_directors_of(clamped));
    let mut load = vec![0.0; mesh.points.len()];
    for (node, force, moment) in loads {
        (0..3).for_each(|k| load[3 * node + k] += force[k]);
        let couple = mesh.couples(&[*node], *moment).unwrap();
        load.iter_mut().zip(couple).for_each(|(all, own)| *all += own);
    }
    let system = System::new(&finite_elements(mesh, material().moduli()), &support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let (mut u, _) = system.solve(&factor, &load);
    u.truncate(3 * mesh.node_count());
    u
}

/// The displacements of the nodes under a force per volume, N/m³, with these nodes clamped.
fn sagged(mesh: &Mesh, clamped: &[usize], body: [&str; 3]) -> Vec<f64> {
    let support = support_at(mesh, &mesh.with_directors_of(clamped));
    let scope = Scope::of_place(3);
    let body = body.map(|text| Component::Varying(scope.expression(text).unwrap())).to_vec();
    let load = nodal_forces(mesh, &Selection::Everything, &Action::Body(body), AREA).unwrap();
    let system = System::new(&finite_elements(mesh, material().moduli()), &support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let (mut u, _) = system.solve(&factor, &load);
    u.truncate(3 * mesh.node_count());
    u
}

/// Joints move under loads along rods as those of a beam, with one rod for each member: closed forms of cantilevers, of a beam that is clamped at both ends, and
/// random frames whose members are divided or not.
#[test]
fn loads_along_rods_move_joints_as_those_of_a_beam() {
    let [_, bend, _] = stiffness();
    let q = 1e-3 / AREA;
    let one = line(&[[0.0, 0.0, 0.0], [0.8, 0.0, 0.0]]);
    let length = 0.8f64;
    let unit = 1e-3 * length.powi(4) / bend;
    let tip = |body: &str| sagged(&one, &[0], ["0", "0", body])[5];
    let even = tip(&format!("{q}"));
    assert!((even / (unit / 8.0) - 1.0).abs() < 1e-10, "{even} {unit}");
    let rising = tip(&format!("{q}*x/0.8"));
    assert!((rising / (11.0 * unit / 120.0) - 1.0).abs() < 1e-10, "{rising} {unit}");
    let two = line(&[[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.8, 0.0, 0.0]]);
    let middle = sagged(&two, &[0, 2], ["0", &format!("{q}"), "0"])[4];
    assert!((middle / (unit / 384.0) - 1.0).abs() < 1e-10, "{middle} {unit}");

    let mut random = Random(7);
    for _ in 0..5 {
        let nodes: Vec<[f64; 3]> = (0..6).map(|p| [p as f64 * 0.3, random.next(), random.next()]).collect();
        let rods = [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [0, 2], [1, 4], [3, 5]];
        let parts = 3;
        let (mut finer, mut pieces) = (nodes.clone(), Vec::new());
        for [a, b] in rods {
            let mut last = a;
            for part in 1..parts {
                let share = part as f64 / parts as f64;
                finer.push(std::array::from_fn(|k| nodes[a][k] + share * (nodes[b][k] - nodes[a][k])));
                pieces.push([last, finer.len() - 1]);
                last = finer.len() - 1;
            }
            pieces.push([last, b]);
        }
        let body = ["2*x", "1 - y", "-3 + z*0.5"];
        let coarse = sagged(&frame(&nodes, &rods), &[0], body);
        let fine = sagged(&frame(&finer, &pieces), &[0], body);
        agree(&coarse, &fine[..18], 1e-7, "divided");
    }
}

/// The same by direct stiffness: six degrees of freedom of each node, and the matrix of twelve of each beam.
fn direct(mesh: &Mesh, clamped: &[usize], loads: &[(usize, [f64; 3], [f64; 3])]) -> Vec<f64> {
    let n = mesh.node_count();
    let [stretch, bend, twist] = stiffness();
    let mut k = DMatrix::<f64>::zeros(6 * n, 6 * n);
    let mut f = DVector::<f64>::zeros(6 * n);
    for nodes in mesh.blocks[0].cells() {
        let [a, b] = [0, 1].map(|end| Vector3::from_column_slice(mesh.point(nodes[end])));
        let length = (b - a).norm();
        let t = (b - a) / length;
        let cross = Matrix3::new(0.0, -t.z, t.y, t.z, 0.0, -t.x, -t.y, t.x, 0.0);
        let (along, across) = (t * t.transpose(), Matrix3::identity() - t * t.transpose());
        // The turn of each end from the line of the beam: θ − t × (u_b − u_a)/l, across the beam.
        let row = |end: usize| {
            let mut turn = DMatrix::<f64>::zeros(3, 12);
            turn.view_mut((0, 6 * end + 3), (3, 3)).copy_from(&across);
            turn.view_mut((0, 0), (3, 3)).copy_from(&(cross / length));
            turn.view_mut((0, 6), (3, 3)).copy_from(&(-cross / length));
            turn
        };
        let difference = |first: usize, part: &Matrix3<f64>| {
            let mut row = DMatrix::<f64>::zeros(3, 12);
            row.view_mut((0, first), (3, 3)).copy_from(&(-part));
            row.view_mut((0, first + 6), (3, 3)).copy_from(part);
            row
        };
        let [first, second] = [row(0), row(1)];
        let mixed = first.transpose() * &second;
        let own =
            (first.transpose() * &first + second.transpose() * &second) * 4.0 + (&mixed + mixed.transpose()) * 2.0;
        let (pulled, twisted) = (difference(0, &along), difference(3, &along));
        let beam = own * (bend / length)
            + pulled.transpose() * &pulled * (stretch / length)
            + twisted.transpose() * &twisted * (twist / length);
        for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
            k[(6 * nodes[i / 6] + i % 6, 6 * nodes[j / 6] + j % 6)] += beam[(i, j)];
        }
    }
    for (node, force, moment) in loads {
        (0..3).for_each(|c| f[6 * node + c] += force[c]);
        (0..3).for_each(|c| f[6 * node + 3 + c] += moment[c]);
    }
    for dof in clamped.iter().flat_map(|p| 6 * p..6 * p + 6) {
        k.row_mut(dof).fill(0.0);
        k.column_mut(dof).fill(0.0);
        (k[(dof, dof)], f[dof]) = (1.0, 0.0);
    }
    let u = k.lu().solve(&f).unwrap();
    (0..n).flat_map(|p| [u[6 * p], u[6 * p + 1], u[6 * p + 2]]).collect()
}

fn agree(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let size = expected.iter().fold(0.0, |a: f64, u| a.max(u.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance * size, "{what}: {a} {b} of {size}");
    }
}

/// One rod is a beam: a force bends it by `P L³/(3 E I)`, a moment by `M L²/(2 E I)`, and a torque moves nothing of it. A portal of three rods moves by 5/84.
#[test]
fn one_rod_is_a_beam() {
    let [stretch, bend, _] = stiffness();
    let (length, force) = (0.7, 1e-3);
    let mesh = line(&[[0.0; 3], [length, 0.0, 0.0]]);
    let u = solved(&mesh, &[0], &[(1, [0.0, force, 0.0], [0.0; 3])]);
    agree(&u[3..], &[0.0, force * length.powi(3) / (3.0 * bend), 0.0], 1e-10, "force");
    let u = solved(&mesh, &[0], &[(1, [0.0; 3], [force, force, 0.0])]);
    agree(&u[3..], &[0.0, 0.0, -force * length.powi(2) / (2.0 * bend)], 1e-10, "moment");
    let h = 0.5;
    let portal = line(&[[0.0; 3], [0.0, 0.0, h], [h, 0.0, h], [h, 0.0, 0.0]]);
    let u = solved(&portal, &[0, 3], &[(1, [force / 2.0, 0.0, 0.0], [0.0; 3]), (2, [force / 2.0, 0.0, 0.0], [0.0; 3])]);
    // The stretch of the posts adds what the radius of gyration is beside the height.
    let flexible = 5.0 / 84.0 * force * h.powi(3) / bend;
    assert!((u[3] / flexible - 1.0).abs() < 20.0 * bend / (stretch * h * h), "{} {flexible}", u[3]);
}

/// Frames of rods in all directions, with joints of up to eight rods, move as the method of direct stiffness says, under forces and moments.
#[test]
fn frames_are_those_of_direct_stiffness() {
    let mut random = Random(11);
    for trial in 0..20 {
        let n = 3 + trial % 7;
        let points: Vec<[f64; 3]> = (0..n).map(|_| std::array::from_fn(|_| random.next())).collect();
        let mut rods: Vec<[usize; 2]> = (1..n).map(|p| [p - 1, p]).collect();
        for a in 0..n {
            rods.extend((a + 2..n).filter(|_| random.next() > 0.0).map(|b| [a, b]));
        }
        let mesh = frame(&points, &rods);
        let load = |_| (n - 1, [0; 3].map(|_| 1e-3 * random.next()), [0; 3].map(|_| 1e-3 * random.next()));
        let loads: Vec<(usize, [f64; 3], [f64; 3])> = (0..1).map(load).collect();
        agree(&solved(&mesh, &[0], &loads), &direct(&mesh, &[0], &loads), 1e-8, &format!("frame {trial}"));
    }
    // A joint of six rods at right angles, as in a lattice.
    let far = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let points: Vec<[f64; 3]> = std::iter::once([0.0; 3]).chain(far).collect();
    let mesh = frame(&points, &(1..7).map(|p| [0, p]).collect::<Vec<_>>());
    let loads = [(3, [1e-3, 2e-3, -1e-3], [1e-3, 0.0, 2e-3])];
    agree(&solved(&mesh, &[1, 2], &loads), &direct(&mesh, &[1, 2], &loads), 1e-10, "cross");
}

/// No motion of the whole has a force, at any rotation, and the exact network with joints is the finite element model.
#[test]
fn the_network_is_the_finite_elements() {
    let mut random = Random(5);
    let points: Vec<[f64; 3]> = (0..5).map(|p| [p as f64, random.next(), random.next()]).collect();
    let mesh = line(&points);
    let network = network(&mesh, BendingSprings::Directors);
    assert!(network.others.iter().all(|spring| spring.constant > 0.0));
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let at = |p: usize| Vector3::from_column_slice(mesh.point(p));
    let x: Vec<f64> = (0..mesh.point_count()).flat_map(|p| <[f64; 3]>::from(turn * at(p))).collect();
    let forces = |x: &[f64]| {
        let mut force = vec![0.0; x.len()];
        assert!(network.forces(x, &mut force));
        force.iter().fold(0.0, |a: f64, f| a.max(f.abs()))
    };
    let u: Vec<f64> = mesh.points.iter().map(|_| 1e-2 * random.next()).collect();
    assert!(forces(&x) < 1e-11 * forces(&displaced(&mesh.points, &u)));
}

/// A straight rod of n parts that is bent to a closed circle has the energy `(2π)² E I/(2 L)` and no forces but at its ends, to rounding.
#[test]
fn a_rod_closes_to_a_circle() {
    let (n, length) = (16, 1.0);
    let h = length / n as f64;
    let mesh = line(&(0..=n).map(|i| [h * i as f64, 0.0, 0.0]).collect::<Vec<_>>());
    let network = bending_springs(&mesh, &material().moduli().into());
    let step = 2.0 * PI / n as f64;
    let turned = |angle: f64| Rotation3::from_axis_angle(&Vector3::y_axis(), -angle);
    let corner = |i: usize| -> Vector3<f64> { (0..i).map(|j| turned(step * j as f64) * Vector3::x() * h).sum() };
    let mut x: Vec<f64> = (0..=n).flat_map(|i| <[f64; 3]>::from(corner(i))).collect();
    for p in mesh.node_count()..mesh.point_count() {
        let joint = (p - mesh.node_count()) / 2;
        let arm = Vector3::from_column_slice(mesh.point(p)) - Vector3::from_column_slice(mesh.point(joint));
        // Joints halve the angles of the polygon, and those of the ends are turned as far.
        x.extend(<[f64; 3]>::from(corner(joint) + turned(step * (joint as f64 - 0.5)) * arm));
    }
    let expected = 0.5 * stiffness()[1] * (2.0 * PI).powi(2) / length;
    let energy = network.energy(&x).unwrap();
    assert!((energy / expected - 1.0).abs() < 1e-12, "{energy} {expected}");
    let mut force = vec![0.0; x.len()];
    assert!(network.forces(&x, &mut force));
    let size = force.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
    let is_end = |p: usize| [0, n].contains(&if p > n { (p - n - 1) / 2 } else { p });
    for (p, f) in force.chunks_exact(3).enumerate().filter(|(p, _)| !is_end(*p)) {
        assert!(f.iter().all(|f| f.abs() < 1e-10 * size), "{p}: {f:?} of {size}");
    }
}

/// A cantilever under a force at its end bends as the elastica does, `w = 0.810609 L` at `P L²/(E I) = 10` for a rod that does not stretch; second order.
#[test]
fn a_cantilever_bends_as_the_elastica() {
    let errors: Vec<f64> = [8, 16]
        .into_iter()
        .map(|n| {
            let mesh = line(&(0..=n).map(|i| [i as f64 / n as f64, 0.0, 0.0]).collect::<Vec<_>>());
            let laws = (Energy::load("stable-neo-hookean", material()).unwrap(), material().state()).into();
            let body = Body::new(&mesh, &laws);
            let support = support_at(&mesh, &mesh.with_directors_of(&[0]));
            let mut force = vec![0.0; mesh.points.len()];
            force[3 * n + 2] = 10.0 * stiffness()[1];
            let newton = Newton { steps: 40, ..Newton::default() };
            let found = newton.solve(&body, &mesh.points, &support, &force[..]).unwrap();
            assert_eq!(found.ending, Ending::Converged);
            100.0 * (found.displacement[3 * n + 2] / 0.810609 - 1.0)
        })
        .collect();
    assert!(errors[1].abs() < 0.4 && errors[0].abs() < 1.0, "{errors:?}");
}

/// A clamped rod vibrates as the beam does, `β² = 3.5160, 22.034` in both planes, and in torsion with `(π/2) √(G/ρ)/L`: round rods have the inertia of `J = 2 I`.
#[test]
fn rods_vibrate_as_beams() {
    let (n, length, density) = (32, 1.0, 1e3);
    let mesh = line(&(0..=n).map(|i| [length * i as f64 / n as f64, 0.0, 0.0]).collect::<Vec<_>>());
    let support = support_at(&mesh, &mesh.with_directors_of(&[0]));
    let masses = lumped_masses(&mesh, density, AREA, Default::default());
    let total: f64 = masses.iter().sum();
    assert!((total / (density * AREA * length) - 1.0).abs() < 1e-12, "{total}");
    let system = System::new(&finite_elements(&mesh, material().moduli()), &support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let modes = lowest_modes(&system, &factor, &masses[..], 3, 16).unwrap();
    let found: Vec<f64> = modes.squares.iter().map(|square| square.sqrt()).collect();
    let unit = (stiffness()[1] / (density * AREA)).sqrt() / length.powi(2);
    for (mode, beta) in [3.5160, 3.5160, 22.034, 22.034, 61.697, 61.697].into_iter().enumerate() {
        // The rotary inertia lowers the frequencies of a slender rod, and so do lumped masses.
        let error = found[mode] / (beta * unit) - 1.0;
        assert!((-0.02..1e-6).contains(&error), "{mode}: {error}");
    }
    let torsion = PI / 2.0 * (YOUNG / (2.0 * (1.0 + POISSON)) / density).sqrt() / length;
    assert!(found.iter().any(|found| (found / torsion - 1.0).abs() < 2e-3), "{torsion} among {found:?}");
}

/// The scene of a cantilever of 8 rods along x, in a folder with its deck, with these lines in the material and this rest.
fn scene(folder: &Path, material: &str, rest: &str) -> springfit_foundation::error::Result<Scene> {
    let mut deck = "*NODE\n".to_string();
    (0..9).for_each(|i| deck += &format!("{}, {}, 0, 0\n", i + 1, 0.125 * i as f64));
    deck += "*ELEMENT, TYPE=B31, ELSET=ALL\n";
    (1..9).for_each(|i| deck += &format!("{i}, {i}, {}\n", i + 1));
    deck += "*NSET, NSET=MIDDLE\n5\n*NSET, NSET=TIP\n9\n";
    std::fs::write(folder.join("rod.inp"), deck).unwrap();
    let young = if material.contains("young") { "" } else { "young = 1e7\n" };
    let head = format!("[mesh]\nfile = \"rod.inp\"\nspace = 3\n[material]\n{young}poisson = 0.3\narea = 1e-4");
    let fit = "[[fit]]\nname = \"rod\"\nobjective = \"exact\"";
    Scene::parse(&format!("{head}\n{material}\n{fit}\n{rest}"), &folder.join("rod.toml"))
}

/// The displacements of the network under the first load.
fn answer(material: &str, rest: &str) -> springfit_foundation::error::Result<Vec<f64>> {
    let folder = TempDir::new().unwrap();
    let outcome = run(&scene(folder.path(), material, rest)?, &mut |_| {})?;
    Ok(outcome.fits[0].loads[0].displacement.as_deref().cloned().unwrap())
}

const CLAMPED: &str = "[[fix]]\nwhere = \"x < 0.01\"\nclamp = true\n";

/// Scenes have forces and moments at points of rods, stiffnesses in place of the section, and displacements that turn joints.
#[test]
fn scenes_have_rods_that_bend() {
    let [_, bend, twist] = stiffness();
    let tip = |u: &[f64]| [u[24], u[25], u[26]];
    let force = format!("{CLAMPED}[[load]]\ngroup = \"MIDDLE\"\nforce = [0, 0, 1e-3]\n");
    let u = answer("bending = \"rod\"", &force).unwrap();
    // The end goes on as the middle is inclined: P a² (3 L − a)/(6 E I) with a = L/2.
    agree(&tip(&u), &[0.0, 0.0, 1e-3 * 0.25 * 2.5 / (6.0 * bend)], 1e-9, "force");
    let stiff = format!("bending = \"rod\"\nflexural = {:e}", 4.0 * bend);
    let stiff = answer(&stiff, &force).unwrap();
    agree(&tip(&stiff), &tip(&u).map(|u| u / 4.0), 1e-9, "flexural");
    let moment = format!("{CLAMPED}[[load]]\ngroup = \"TIP\"\nmoment = [0, -1e-3, 0]\n");
    let u = answer("bending = \"rod\"", &moment).unwrap();
    agree(&tip(&u), &[0.0, 0.0, 1e-3 / (2.0 * bend)], 1e-9, "moment");
    // A moment along the rod twists its end by M L/(G J), which its directors show.
    let torque = format!("{CLAMPED}[[load]]\ngroup = \"TIP\"\nmoment = [1e-3, 0, 0]\n");
    for (given, twist) in [("", twist), ("\ntorsional = 0.5", 0.5)] {
        let u = answer(&format!("bending = \"rod\"{given}"), &torque).unwrap();
        let last = u.len() / 3 - 1;
        let size = u[3 * last..].iter().map(|u| u * u).sum::<f64>().sqrt();
        // The directors are as far from the joint as a rod is long.
        assert!((size / (0.125 * 1e-3 / twist) - 1.0).abs() < 1e-8, "{size}");
    }
    // The nodes of a rod that twists stay where they are: errors are then those of the directors too, and not of rounding errors.
    let folder = TempDir::new().unwrap();
    let outcome = run(&scene(folder.path(), "bending = \"rod\"", &torque).unwrap(), &mut |_| {}).unwrap();
    assert!(outcome.fits[0].loads[0].error.unwrap().max < 1e-6);
    assert!(!outcome.of_loads.iter().any(|note| note.contains("held points")), "{:?}", outcome.of_loads);
    // Its own weight, as gravity and as a force that its lines share.
    let weight = 1000.0 * 1e-4 * 1e-3;
    let gravity = format!("{CLAMPED}[[load]]\ngravity = [0, 0, -1e-3]\n");
    let shared = format!("{CLAMPED}[[load]]\ngroup = \"ALL\"\nforce = [0, 0, {:e}]\n", -weight);
    for load in [gravity, shared] {
        let u = answer("density = 1000\nbending = \"rod\"", &load).unwrap();
        agree(&tip(&u), &[0.0, 0.0, -weight / (8.0 * bend)], 1e-9, "weight");
    }
    // A joint that is clamped takes no part of a moment.
    let on_foot = format!("{CLAMPED}[[load]]\nname = \"m\"\nwhere = \"x < 0.2\"\nmoment = [0, -1e-3, 0]\n");
    let outcome = run(&scene(folder.path(), "bending = \"rod\"", &on_foot).unwrap(), &mut |_| {}).unwrap();
    let told = outcome.of_loads.iter().any(|note| note.starts_with("50 % of the moment of m acts on joints"));
    assert!(told, "{:?}", outcome.of_loads);
    // The end is turned by 0.01 about y and kept where it is: a beam with both ends clamped and one turned.
    let turned = format!(
        "{CLAMPED}[[load]]\ngroup = \"TIP\"\ndisplacement = [\"0.01*z\", 0, \"-0.01*(x - 1)\"]\nclamp = true\n"
    );
    let u = answer("bending = \"rod\"", &turned).unwrap();
    // w = −θ x² (x − L)/L² of a slope −θ at the end, 0.125 θ L in the middle.
    agree(&u[12..15], &[0.0, 0.0, 0.125 * 0.01], 1e-9, "turned");
}

/// At large deformation a rod whose end is turned by a right angle and let go along its line is an arc of a circle.
#[test]
fn a_joint_that_is_turned_bends_the_rod_to_an_arc() {
    // The end of an arc of the length 1 and the angle π/2 is at (2/π, 2/π).
    let radius = 2.0 / PI;
    let rest = format!(
        "{CLAMPED}[newton]\nsteps = 20\n[[load]]\ngroup = \"TIP\"\ndisplacement = [\"{radius} - 1 - (x - 1) - z\", 0, \"{radius} + (x - 1) - z\"]\nclamp = true\n"
    );
    let u = answer("bending = \"rod\"\nlaw = \"stable-neo-hookean\"", &rest).unwrap();
    let middle = [0.5 + u[12], u[14]];
    let expected = [radius * (PI / 4.0).sin(), radius * (1.0 - (PI / 4.0).cos())];
    middle.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 2e-3, "{middle:?} {expected:?}"));
}

/// What is wrong with rods that bend is one error each, with the key.
#[test]
fn wrong_rods_are_refused() {
    let force = format!("{CLAMPED}[[load]]\ngroup = \"TIP\"\nforce = [0, 0, 1e-3]\n");
    let moment = format!("{CLAMPED}[[load]]\ngroup = \"TIP\"\nmoment = [0, 1e-3, 0]\n");
    let open = "[[fix]]\nwhere = \"x < 0.01 || x > 0.99\"\n[[load]]\ngroup = \"MIDDLE\"\nforce = [0, 0, 1e-3]\n";
    let lone = "[[fix]]\ngroup = \"ALL\"\n[[load]]\ngroup = \"TIP\"\nforce = [0, 0, 1e-3]\nclamp = true\n";
    let loose = moment.replace("clamp = true\n", "");
    let law = "bending = \"rod\"\nlaw = \"stable-neo-hookean\"";
    let cases = [
        ("bending = \"plate\"", force.as_str(), "bending: expected a surface in space of triangles of three nodes"),
        ("bending = \"rod\"\nflexural = 0", &force, "flexural"),
        ("bending = \"rod\"\nflexural = 1e-9", &force, "rounding"),
        ("torsional = 1.0", &force, "torsional: expected bending = \"rod\" beside it, found none"),
        ("", &loose, "moment: expected bending"),
        (law, &moment, "moment: expected small deformation"),
        // A straight rod on two hinges spins about its own line.
        ("bending = \"rod\"", open, "1 rigid motion left"),
        ("bending = \"rod\"", lone, "clamp: expected \"displacement\" beside it"),
        ("", &force, "clamp"),
    ];
    for (material, rest, expected) in cases {
        let error = answer(material, rest).unwrap_err().to_string();
        assert!(error.contains(expected), "{material}: {error}");
    }
    let hinges =
        format!("{}[[fit]]\nobjective = \"offdiag\"\nbending = \"hinges\"\n", force.replace("clamp = true\n", ""));
    let error = answer("", &hinges).unwrap_err().to_string();
    assert!(error.contains("fit[1].bending: expected a sheet"), "{error}");
}

/// Hinges of rods are springs on single angles, which programs hold: of second order, and refused where rods meet at a corner.
#[test]
fn rods_in_line_have_hinges() {
    let force = 1e-4;
    let errors: Vec<f64> = [4, 8, 16]
        .into_iter()
        .map(|n| {
            let mesh = line(&(0..=n).map(|i| [i as f64 / n as f64, 0.0, 0.0]).collect::<Vec<_>>());
            BendingSprings::Hinges.check(&mesh).unwrap();
            let system = clamped(&network(&mesh, BendingSprings::Hinges), &mesh);
            let mut load = vec![0.0; mesh.points.len()];
            load[3 * n + 2] = force;
            let (u, _) = system.solve(&system.cholesky().unwrap().unwrap(), &load);
            // A torque twists the end by M L/(G J), as both of its directors show: nothing of it is in the levers.
            let torque = mesh.couples(&[n], [force, 0.0, 0.0]).unwrap();
            let (twisted, _) = system.solve(&system.cholesky().unwrap().unwrap(), &torque);
            for director in [3 * n + 1, 3 * n + 2] {
                let turned = twisted[3 * director..3 * director + 3].iter().map(|u| u * u).sum::<f64>().sqrt();
                let reach = (0..3).map(|k| (mesh.point(director)[k] - mesh.point(n)[k]).powi(2)).sum::<f64>().sqrt();
                assert!((turned / (reach * force / stiffness()[2]) - 1.0).abs() < 1e-9, "{n}: {turned}");
            }
            100.0 * (u[3 * n + 2] / (force / (3.0 * stiffness()[1])) - 1.0)
        })
        .collect();
    // The sum of P (L − x)² l/(E I) over the joints, that of the clamp by half, is `1 + 1/(2 n²)` of the beam.
    for (error, n) in errors.iter().zip([4.0, 8.0, 16.0f64]) {
        assert!((error - 50.0 / n.powi(2)).abs() < 1e-6, "{n}: {errors:?}");
    }
    let corner = line(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    let error = BendingSprings::Hinges.check(&corner).unwrap_err().to_string();
    assert!(error.contains("bending: expected \"directors\"") && error.contains("[1.0, 0.0, 0.0] m"), "{error}");
    // Programs that hold hinges hold these, with directors as points.
    let folder = TempDir::new().unwrap();
    let rest = format!("bending = \"hinges\"\n{CLAMPED}[[load]]\ngroup = \"TIP\"\nforce = [0, 0, 1e-3]\n");
    let scene = scene(folder.path(), "density = 1000\nbending = \"rod\"", &rest).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let network = &outcome.fits[0].network;
    assert_eq!(network.others.iter().filter(|spring| spring.kind == SpringKind::Hinge).count(), 6 * 8);
}

/// Sections of beams give a draft of the scene the area and the material of the deck, and profiles without a formula the material alone.
#[test]
fn drafts_take_the_sections_of_beams() {
    let folder = TempDir::new().unwrap();
    for (section, area) in [
        ("*BEAM SECTION, ELSET=ALL, MATERIAL=STEEL, SECTION=CIRC\n0.01\n0, 1, 0", "0.000314"),
        ("*BEAM SECTION, ELSET=ALL, MATERIAL=STEEL, SECTION=RECT\n0.01, 0.02\n0, 1, 0", "0.0002"),
        ("*BEAM SECTION, ELSET=ALL, MATERIAL=STEEL, SECTION=PIPE\n0.01, 0.01\n0, 1, 0", "0.000314"),
        ("*BEAM SECTION, ELSET=ALL, MATERIAL=STEEL, SECTION=BOX\n0.02, 0.02, 0.005, 0.005, 0.005, 0.005", "0.0003"),
        ("*BEAM GENERAL SECTION, ELSET=ALL, MATERIAL=STEEL\n0.0005, 1e-8, 0, 1e-8, 2e-8", "0.0005"),
        (
            "*BEAM SECTION, ELSET=ALL, MATERIAL=STEEL, SECTION=I\n0.1, 0.1, 0.1, 0.1, 0.01, 0.01, 0.01",
            "m^2, the cross-section\n",
        ),
    ] {
        let deck = format!(
            "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0.5\n*ELEMENT, TYPE=B31, ELSET=ALL\n1, 1, 2\n2, 2, 3\n*MATERIAL, NAME=STEEL\n*ELASTIC\n2e11, 0.3\n*DENSITY\n7850\n{section}\n"
        );
        std::fs::write(folder.path().join("beam.inp"), deck).unwrap();
        prints(folder.path(), &["new", "beam.inp", "-o", "beam.toml"]);
        let draft = std::fs::read_to_string(folder.path().join("beam.toml")).unwrap();
        std::fs::remove_file(folder.path().join("beam.toml")).unwrap();
        assert!(draft.contains(area) && draft.contains("7850"), "{section}: {draft}");
    }
}

/// A quarter of a circle under a force across its plane bends and twists: `P R³ ((π/4)/(E I) + (3 π/4 − 2)/(G J))`; beams and hinges are of second order.
#[test]
fn arcs_bend_and_twist() {
    let (radius, force): (f64, f64) = (0.5, 1e-3);
    let [_, bend, twist] = stiffness();
    let expected = force * radius.powi(3) * (PI / 4.0 / bend + (0.75 * PI - 2.0) / twist);
    for springs in [BendingSprings::Directors, BendingSprings::Hinges] {
        let errors = [8, 16, 32].map(|n| {
            let at = |i: usize| PI / 2.0 * i as f64 / n as f64;
            let mesh = line(&(0..=n).map(|i| [radius * at(i).cos(), radius * at(i).sin(), 0.0]).collect::<Vec<_>>());
            let system = clamped(&network(&mesh, springs), &mesh);
            let mut load = vec![0.0; mesh.points.len()];
            load[3 * n + 2] = force;
            let (u, _) = system.solve(&system.cholesky().unwrap().unwrap(), &load);
            u[3 * n + 2] / expected - 1.0
        });
        for pair in errors.windows(2) {
            assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "{springs:?}: {errors:?}");
        }
        assert!(errors[2].abs() < 2e-3, "{springs:?}: {errors:?}");
    }
}

/// Steel is so stiff along a rod that its forces are rounded at a share of what acts across it that is above the tolerance: steps that reach the rounding have converged.
#[test]
fn implicit_steps_end_at_the_rounding_of_stiff_rods() {
    let folder = TempDir::new().unwrap();
    for integrator in ["implicit-euler", "bdf2", "newmark"] {
        let material = "young = 2e11\ndensity = 7850\nbending = \"rod\"\nlaw = \"stable-neo-hookean\"";
        let rest = format!(
            "{CLAMPED}[motion]\nduration = 0.02\nstep = 1e-3\nintegrator = \"{integrator}\"\ngravity = [0, 0, -9.81]\n"
        );
        let outcome = run(&scene(folder.path(), material, &rest).unwrap(), &mut |_| {}).unwrap();
        let unsolved: Vec<usize> = outcome.motion.unwrap().models.iter().map(|model| model.unsolved).collect();
        assert_eq!(unsolved, [0, 0], "{integrator}");
    }
}
