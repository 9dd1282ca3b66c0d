//! Sheets that bend: springs on directors are the plate of Morley, on any mesh.

use crate::shapes::Random;
use crate::shapes::bodies::{bending, of_triangles, triangles};
use crate::shapes::statics::{assert_derivatives, product, support_at};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use springfit_bodies::model::{
    BendingSprings, Body, Elastic, Network, Support, bending_springs, displaced, exact_network, finite_elements,
    hinge_flexure, lumped_masses,
};
use springfit_bodies::solve::{Ending, Newton, System, lowest_modes};
use springfit_element::material::{CellMap, Energy, Hooke, Material, Plane};
use springfit_element::springs::{Measure, Turns};
use springfit_mesh::mesh::Mesh;
use springfit_report::report::{HeldRecord, NetworkFile, Parts};

/// Ways to divide squares into triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// All diagonals are parallel.
    Right,
    /// Diagonals alternate: points have four neighbours or eight.
    Union,
    /// As `Union`, with inner points moved by up to 0.3 of a side.
    Jitter,
}

const KINDS: [Kind; 3] = [Kind::Right, Kind::Union, Kind::Jitter];

/// A sheet `[0, size[0]] × [0, size[1]]` at z = 0 of thickness t, with directors.
fn sheet(kind: Kind, size: [f64; 2], cells: [usize; 2], t: f64) -> Mesh {
    let share = if kind == Kind::Jitter { 0.3 } else { 0.0 };
    let (points, triangles) = triangles(cells, share, |i, j| kind == Kind::Right || (i + j) % 2 == 0);
    surface(points.iter().flat_map(|x| [size[0] * x[0], size[1] * x[1], 0.0]).collect(), triangles, t)
}

/// A surface in space of these triangles, with directors.
fn surface(points: Vec<f64>, triangles: Vec<usize>, t: f64) -> Mesh {
    bending(of_triangles(points, triangles), t)
}

/// A material with the flexural stiffness 1 N·m at the thickness t.
fn of_unit_stiffness(poisson: f64, t: f64) -> Material {
    let young = 12.0 * (1.0 - poisson * poisson) / t.powi(3);
    Material::for_body(2, young, poisson, Some(Plane::Stress), Some(t)).unwrap()
}

fn at(mesh: &Mesh, p: usize) -> Vector3<f64> {
    Vector3::from_column_slice(mesh.point(p))
}

/// The displacements of a flat sheet at z = 0 whose middle surface is w with these slopes: directors stand on its normals, to first order.
fn of_plate(mesh: &Mesh, w: impl Fn(f64, f64) -> f64, slope: impl Fn(usize, f64, f64) -> [f64; 2]) -> Vec<f64> {
    let (nodes, directors) = (mesh.node_count(), mesh.directors.as_ref().unwrap());
    let mut u: Vec<f64> = (0..nodes).flat_map(|p| [0.0, 0.0, w(mesh.point(p)[0], mesh.point(p)[1])]).collect();
    for (e, ends) in directors.edges.iter().enumerate() {
        let [a, b] = ends.map(|p| at(mesh, p));
        let (length, middle) = ((b - a).norm(), (a + b) / 2.0);
        let along = (b - a) / length;
        let across = Vector3::new(along.y, -along.x, 0.0);
        let [x, y] = slope(e, middle.x, middle.y);
        // The director leans against the slope across its edge as given, and along it as the ends of the edge say.
        let of_ends = (w(b.x, b.y) - w(a.x, a.y)) / length;
        let lean = across * (across.x * x + across.y * y) + along * of_ends;
        u.extend([-length * lean.x, -length * lean.y, (w(a.x, a.y) + w(b.x, b.y)) / 2.0]);
    }
    u
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The energy of Morley's plate for deflections of the points and slopes across the edges at their middles: κ of the quadratic with these six values.
fn energy_of_morley(mesh: &Mesh, poisson: f64, w: impl Fn(usize) -> f64, across: impl Fn(usize) -> f64) -> f64 {
    let directors = mesh.directors.as_ref().unwrap();
    let mut energy = 0.0;
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let own = directors.of_cell(cell);
        let mut rows = Matrix6::zeros();
        let mut values = Vector6::zeros();
        let corners = [0, 1, 2].map(|i| at(mesh, nodes[i]));
        let origin = (corners[0] + corners[1] + corners[2]) / 3.0;
        for i in 0..3 {
            let [x, y] = [corners[i].x - origin.x, corners[i].y - origin.y];
            rows.set_row(i, &nalgebra::RowVector6::new(1.0, x, y, x * x, x * y, y * y));
            values[i] = w(nodes[i]);
            let e = own[i] - mesh.node_count();
            let [a, b] = directors.edges[e].map(|p| at(mesh, p));
            let (t, m) = ((b - a).normalize(), (a + b) / 2.0 - origin);
            let n = [t.y, -t.x];
            let slope = [0.0, n[0], n[1], 2.0 * m.x * n[0], m.y * n[0] + m.x * n[1], 2.0 * m.y * n[1]];
            rows.set_row(3 + i, &nalgebra::RowVector6::from_row_slice(&slope));
            values[3 + i] = across(e);
        }
        let c = rows.lu().solve(&values).unwrap();
        let [xx, xy, yy] = [2.0 * c[3], c[4], 2.0 * c[5]];
        let area = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm() / 2.0;
        let trace = xx + yy;
        energy += 0.5 * area * ((1.0 - poisson) * (xx * xx + yy * yy + 2.0 * xy * xy) + poisson * trace * trace);
    }
    energy
}

/// A triangle with directors at random, turned at random.
fn random_bend(random: &mut Random) -> Vec<f64> {
    let mut x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.9, 0.0];
    for (a, b) in [(1, 2), (2, 0), (0, 1)] {
        let middle: Vec<f64> = (0..3).map(|k| (x[3 * a + k] + x[3 * b + k]) / 2.0).collect();
        x.extend([middle[0], middle[1], middle[2] + 1.0]);
    }
    x.iter_mut().for_each(|x| *x += 0.3 * random.next());
    x
}

/// The measure of a bend has the gradient and the second derivatives that differences have, and no motion of the whole changes it.
#[test]
fn bends_have_their_derivatives() {
    let mut random = Random(1);
    for _ in 0..40 {
        let x = random_bend(&mut random);
        let weights = [random.next(), random.next(), random.next()];
        for (measure, points) in [(Turns::of_triangle(weights), 6), (Turns::of_hinge(), 4)] {
            has_its_derivatives(&Measure::Turns(Box::new(measure)), &of_points(&x, points), &mut random);
        }
    }
}

/// The first coordinates of a triangle with its directors, or those of a hinge on the first director.
fn of_points(x: &[f64], points: usize) -> Vec<f64> {
    if points == 6 { x.to_vec() } else { x[..9].iter().chain(&x[9..12]).copied().collect() }
}

fn has_its_derivatives(measure: &Measure, x: &[f64], random: &mut Random) {
    let jet = measure.jet(x, 3);
    assert!(jet.gradient.iter().eq(measure.gradient(x, 3).iter()));
    let at = |x: &[f64]| (measure.value(x, 3), measure.gradient(x, 3));
    assert_derivatives("plate", x, (1e-5, [1e-8, 1e-7]), at, |i, j| jet.hessian[i * x.len() + j]);
    let turn = nalgebra::Rotation3::from_euler_angles(random.next(), random.next(), random.next());
    let turned: Vec<f64> = x
        .chunks_exact(3)
        .flat_map(|p| (turn * Vector3::from_column_slice(p)).iter().copied().collect::<Vec<_>>())
        .collect();
    assert!((measure.value(&turned, 3) - measure.value(x, 3)).abs() < 1e-13);
}

/// For any deflections and slopes the energy of the springs is that of Morley's plate, which is written here by its quadratic polynomials.
#[test]
fn directors_are_the_plate_of_morley() {
    for (kind, poisson) in KINDS.into_iter().flat_map(|kind| [-0.5, 0.0, 0.3, 0.49].map(|nu| (kind, nu))) {
        let mesh = sheet(kind, [1.0, 1.3], [4, 5], 0.01);
        let material = of_unit_stiffness(poisson, 0.01);
        let network = bending_springs(&mesh, &CellMap::Uniform(Hooke::Isotropic(material.moduli())));
        // The membrane resists no deflection to first order, and nothing stretches the springs of the directors.
        let entries = finite_elements(&mesh, material.moduli());
        let mut random = Random(11);
        let heights: Vec<f64> = (0..mesh.node_count()).map(|_| random.next()).collect();
        let slopes: Vec<[f64; 2]> =
            mesh.directors.iter().flat_map(|d| &d.edges).map(|_| [random.next(), random.next()]).collect();
        let place =
            |x: f64, y: f64| (0..mesh.node_count()).find(|&p| mesh.point(p)[0] == x && mesh.point(p)[1] == y).unwrap();
        let u = of_plate(&mesh, |x, y| heights[place(x, y)], |e, _, _| slopes[e]);
        let across = |e: usize| {
            let [a, b] = mesh.directors.as_ref().unwrap().edges[e].map(|p| at(&mesh, p));
            let t = (b - a).normalize();
            t.y * slopes[e][0] - t.x * slopes[e][1]
        };
        let expected = energy_of_morley(&mesh, poisson, |p| heights[p], across);
        let found = 0.5 * dot(&product(&entries, &u), &u);
        assert!((found / expected - 1.0).abs() < 1e-10, "{kind:?} {poisson}: {found} {expected}");
        let own = 0.5 * dot(&product(&network.stiffness(&mesh.points), &u), &u);
        assert!((own / expected - 1.0).abs() < 1e-10, "{kind:?} {poisson}: {own} {expected}");
        assert!(network.others.iter().all(|spring| spring.constant > 0.0));
    }
}

/// Constant curvatures have their energy and no forces inside, on irregular meshes; with an orthotropic stiffness too.
#[test]
fn constant_curvatures_pass_the_patch_test() {
    let orthotropic = |d: [f64; 4]| Matrix3::new(d[0], d[1], 0.0, d[1], d[2], 0.0, 0.0, 0.0, d[3]);
    for kind in KINDS {
        for poisson in [0.0, 0.3, 0.49] {
            let mesh = sheet(kind, [1.0, 1.0], [8, 8], 0.01);
            let entries = finite_elements(&mesh, of_unit_stiffness(poisson, 0.01).moduli());
            let d = orthotropic([1.0, poisson, 1.0, (1.0 - poisson) / 2.0]);
            for curvature in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.4, -0.7, 0.2]] {
                let [xx, yy, xy] = curvature;
                let w = |x: f64, y: f64| 0.5 * (xx * x * x + yy * y * y) + xy * x * y;
                let u = of_plate(&mesh, w, |_, x, y| [xx * x + xy * y, yy * y + xy * x]);
                let f = product(&entries, &u);
                let kappa = Vector3::new(xx, yy, 2.0 * xy);
                let energy = 0.5 * kappa.dot(&(d * kappa));
                assert!((0.5 * dot(&f, &u) / energy - 1.0).abs() < 1e-9, "{kind:?} {poisson}: {}", 0.5 * dot(&f, &u));
                let on_rim = |x: &[f64]| x[..2].iter().any(|x| *x < 1e-9 || *x > 1.0 - 1e-9);
                let size = f.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
                for (p, f) in f.chunks_exact(3).enumerate().filter(|(p, _)| !on_rim(mesh.point(*p))) {
                    assert!(f.iter().all(|f| f.abs() < 1e-9 * size), "{kind:?} {poisson} {p}: {f:?} of {size}");
                }
            }
        }
    }
}

/// The deflection of the middle of a square plate under a pressure of 1 Pa.
fn middle(kind: Kind, n: usize, poisson: f64, is_clamped: bool) -> f64 {
    let mesh = sheet(kind, [1.0, 1.0], [n, n], 0.01);
    let entries = finite_elements(&mesh, of_unit_stiffness(poisson, 0.01).moduli());
    middle_of(&mesh, &entries, is_clamped)
}

/// The same, of springs on the turns from each director alone, which are hinges between triangles.
fn hinged_middle(kind: Kind, n: usize, poisson: f64, is_clamped: bool) -> f64 {
    let mesh = sheet(kind, [1.0, 1.0], [n, n], 0.01);
    middle_of(&mesh, &hinged(&mesh, poisson).stiffness(&mesh.points), is_clamped)
}

/// A membrane with hinges.
fn hinged(mesh: &Mesh, poisson: f64) -> Network {
    let material = of_unit_stiffness(poisson, 0.01);
    let fit = springfit_fit::fit::ExactFit::default();
    let membrane = exact_network(mesh, &material.into(), &fit, &vec![false; mesh.point_count()]).unwrap();
    membrane.joined(BendingSprings::Hinges.of(mesh, &CellMap::Uniform(Hooke::Isotropic(material.moduli()))))
}

fn middle_of(mesh: &Mesh, entries: &springfit_bodies::model::Entries, is_clamped: bool) -> f64 {
    let on_rim = |p: usize| mesh.point(p)[..2].iter().any(|x| *x < 1e-9 || *x > 1.0 - 1e-9);
    let held: Vec<usize> = (0..mesh.node_count()).filter(|&p| on_rim(p)).collect();
    let mut support = support_at(mesh, &held);
    if is_clamped {
        // A clamped edge lies on the rim, and has both its ends there.
        let of_rim: Vec<usize> =
            mesh.with_directors_of(&held).into_iter().filter(|&p| p >= mesh.node_count() && on_rim(p)).collect();
        support.fix(&of_rim, &[0, 1, 2], 3);
    }
    let mut load = vec![0.0; mesh.points.len()];
    for nodes in mesh.blocks[0].cells() {
        let [a, b, c] = [0, 1, 2].map(|i| at(mesh, nodes[i]));
        let share = (b - a).cross(&(c - a)).norm() / 6.0;
        nodes.iter().for_each(|p| load[3 * p + 2] += share);
    }
    let system = System::new(entries, &support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let (u, _) = system.solve(&factor, &load);
    let middle = |p: &usize| (mesh.point(*p)[0] - 0.5).hypot(mesh.point(*p)[1] - 0.5);
    let p = (0..mesh.node_count()).min_by(|a, b| middle(a).total_cmp(&middle(b))).unwrap();
    u[3 * p + 2]
}

/// Square plates under pressure (Timoshenko and Woinowsky-Krieger 1959, tables 8 and 35): errors fall four times where cells are halved, on
/// regular and irregular meshes, and are those of Morley's plate.
#[test]
fn square_plates_converge_on_every_mesh() {
    // Errors in percent at n = 8, 16, 32, computed with another program.
    let known: [(Kind, bool, [f64; 3]); 4] = [
        (Kind::Right, false, [5.18, 1.30, 0.33]),
        (Kind::Right, true, [33.07, 8.65, 2.19]),
        (Kind::Union, false, [5.08, 1.26, 0.31]),
        (Kind::Union, true, [31.95, 8.29, 2.10]),
    ];
    let errors = |kind, is_clamped: bool| {
        let exact = if is_clamped { 0.00126532 } else { 0.00406235 };
        [8, 16, 32].map(|n| 100.0 * (middle(kind, n, 0.3, is_clamped) / exact - 1.0))
    };
    for (kind, is_clamped, expected) in known {
        for (found, expected) in errors(kind, is_clamped).into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.006, "{kind:?} {is_clamped}: {found} {expected}");
        }
    }
    for is_clamped in [false, true] {
        let found = errors(Kind::Jitter, is_clamped);
        for pair in found.windows(2) {
            assert!((3.3..4.7).contains(&(pair[0] / pair[1])), "{is_clamped}: {found:?}");
        }
    }
}

/// A strip that is rolled to a closed circle has the energy `D b (2π)²/(2 L)` and is in equilibrium, to rounding.
#[test]
fn a_strip_rolls_to_a_circle() {
    let (n, length, width) = (16, 1.0, 0.25);
    let t = 0.01;
    let mesh = sheet(Kind::Right, [length, width], [n, 4], t);
    let material = of_unit_stiffness(0.0, t);
    let network = bending_springs(&mesh, &CellMap::Uniform(Hooke::Isotropic(material.moduli())));
    // The segments of a polygon with n corners, each as long as a cell; it is turned so that the strip begins along x.
    let (h, turn) = (length / n as f64, std::f64::consts::TAU / n as f64);
    let corner = |i: usize| -> Vector3<f64> {
        (0..i).map(|j| Vector3::new((turn * j as f64).cos(), 0.0, (turn * j as f64).sin()) * h).sum()
    };
    let normal = |angle: f64| Vector3::new(-angle.sin(), 0.0, angle.cos());
    let column = |x: f64| (x / h).round() as usize;
    let mut x: Vec<f64> = Vec::new();
    for p in 0..mesh.node_count() {
        let y = Vector3::new(0.0, mesh.point(p)[1], 0.0);
        x.extend((corner(column(mesh.point(p)[0])) + y).iter());
    }
    for [a, b] in &mesh.directors.as_ref().unwrap().edges {
        let reach = (at(&mesh, *b) - at(&mesh, *a)).norm();
        let [i, j] = [a, b].map(|p| column(mesh.point(*p)[0]));
        // Across the strip edges are corners of the polygon, and their directors halve the angle there; at the ends they are turned as far.
        let angle = if i == j { turn * (i as f64 - 0.5) } else { turn * i.min(j) as f64 };
        let [a, b] = [a, b].map(|p| Vector3::from_column_slice(&x[3 * p..3 * p + 3]));
        x.extend(((a + b) / 2.0 + reach * normal(angle)).iter());
    }
    assert!((corner(n) - corner(0)).norm() < 1e-14);
    let expected = 0.5 * width / length * std::f64::consts::TAU.powi(2);
    let energy = network.energy(&x).unwrap();
    assert!((energy / expected - 1.0).abs() < 1e-12, "{energy} {expected}");
    let mut force = vec![0.0; x.len()];
    assert!(network.forces(&x, &mut force));
    let is_end = |p: &[f64]| p[0] < 1e-9 || p[0] > length - 1e-9;
    let size = force.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
    for (p, f) in force.chunks_exact(3).enumerate().filter(|(p, _)| !is_end(mesh.point(*p))) {
        assert!(f.iter().all(|f| f.abs() < 1e-11 * size), "{p}: {f:?} of {size}");
    }
}

/// A moment M along the end of a clamped strip of the width b bends it by `M x²/(2 D b)`, on any mesh: the curvature is the same everywhere. One across the end twists it
/// alone.
#[test]
fn a_moment_on_an_edge_bends_a_strip() {
    for kind in KINDS {
        let (length, width, t) = (1.0, 0.25, 0.01);
        let mesh = sheet(kind, [length, width], [8, 2], t);
        let material = of_unit_stiffness(0.0, t);
        let on = |x: f64| -> Vec<usize> {
            (0..mesh.node_count()).filter(|&p| (mesh.point(p)[0] - x).abs() < 1e-9).collect()
        };
        let support = support_at(&mesh, &mesh.with_directors_of(&on(0.0)));
        let system = System::new(&finite_elements(&mesh, material.moduli()), &support).unwrap();
        let factor = system.cholesky().unwrap().unwrap();
        let solved = |moment: [f64; 3]| system.solve(&factor, &mesh.couples(&on(length), moment).unwrap()).0;
        let u = solved([0.0, -0.3, 0.0]);
        for p in 0..mesh.node_count() {
            let expected = 0.3 * mesh.point(p)[0].powi(2) / (2.0 * width);
            assert!((u[3 * p + 2] - expected).abs() < 1e-9 * 0.6, "{kind:?}: {} {expected}", u[3 * p + 2]);
        }
        let twisted = solved([0.3, 0.0, 0.0]);
        let most = on(length).iter().map(|p| twisted[3 * p + 2].abs()).fold(0.0, f64::max);
        assert!(most > 0.05, "{kind:?}: {most}");
        assert!(mesh.couples(&[0], [1.0; 3]).is_none());
    }
}

/// A cantilever under a force at its end bends as the elastica does, `w = 0.810609 L` at `P L²/(E I) = 10`; second order.
#[test]
fn a_cantilever_bends_as_the_elastica() {
    let t = 1e-2;
    let errors: Vec<f64> = [8, 16]
        .into_iter()
        .map(|n| {
            // Cells are as wide as they are long, so that both are halved.
            let width = 1.0 / n as f64;
            let mesh = sheet(Kind::Right, [1.0, width], [n, 1], t);
            let material = of_unit_stiffness(0.0, t);
            let energy = Energy::load("st-venant-kirchhoff", material).unwrap();
            let laws = (energy, material.state()).into();
            let body = Body::new(&mesh, &laws);
            let held: Vec<usize> = (0..mesh.node_count()).filter(|&p| mesh.point(p)[0] < 1e-9).collect();
            let support = support_at(&mesh, &mesh.with_directors_of(&held));
            let ends: Vec<usize> = (0..mesh.node_count()).filter(|&p| mesh.point(p)[0] > 1.0 - 1e-9).collect();
            let mut force = vec![0.0; mesh.points.len()];
            ends.iter().for_each(|p| force[3 * p + 2] = 10.0 * width / ends.len() as f64);
            let newton = Newton { steps: 40, ..Newton::default() };
            let found = newton.solve(&body, &mesh.points, &support, &force[..]).unwrap();
            assert_eq!(found.ending, Ending::Converged);
            let w = ends.iter().map(|p| found.displacement[3 * p + 2]).sum::<f64>() / ends.len() as f64;
            100.0 * (w / 0.810609 - 1.0)
        })
        .collect();
    assert!(errors[1].abs() < 0.4 && (3.0..5.0).contains(&(errors[0] / errors[1])), "{errors:?}");
}

/// Free square plates vibrate as Ritz's method says (15 × 15 polynomials of Legendre), within Morley's error at n = 16.
#[test]
fn free_plates_vibrate_as_ritz_says() {
    let ritz: [(f64, [f64; 4]); 3] = [
        (0.3, [13.4682, 19.5961, 24.2702, 34.8009]),
        (0.0, [15.8226, 22.3733, 22.3733, 38.6943]),
        (0.49, [11.5992, 17.2085, 24.9355, 31.0239]),
    ];
    for (poisson, expected) in ritz {
        let (t, n) = (1e-2, 16);
        let mesh = sheet(Kind::Union, [1.0, 1.0], [n, n], t);
        let material = of_unit_stiffness(poisson, t);
        // A mass of 1 kg/m², so that the square of a frequency is that of the table. Weak springs hold the plate in its plane and as a whole.
        let masses = lumped_masses(&mesh, 1.0 / t, t, Default::default());
        let mut entries = finite_elements(&mesh, material.moduli());
        let weak = 1.0;
        entries.extend((0..3 * mesh.node_count()).map(|i| faer::sparse::Triplet::new(i, i, weak * masses[i / 3])));
        let system = System::new(&entries, &Support::free(&mesh)).unwrap();
        let factor = system.cholesky().unwrap().unwrap();
        let modes = lowest_modes(&system, &factor, &masses[..], 3, 10).unwrap();
        // Six motions of the whole come first.
        for (found, expected) in modes.squares[6..].iter().map(|square| (square - weak).sqrt()).zip(expected) {
            let error = 100.0 * (found / expected - 1.0);
            assert!((-3.0..0.0).contains(&error), "{poisson}: {found} {expected}, {error} %");
        }
    }
}

/// The exact network of a sheet is its finite element model, and no motion of the whole has a force.
#[test]
fn the_network_is_the_finite_elements() {
    let mesh = sheet(Kind::Jitter, [1.0, 0.7], [5, 4], 0.02);
    let material = Material::for_body(2, 1e4, 0.3, Some(Plane::Stress), Some(0.02)).unwrap();
    let fit = springfit_fit::fit::ExactFit::default();
    let membrane = exact_network(&mesh, &material.into(), &fit, &vec![false; mesh.point_count()]).unwrap();
    let plate = bending_springs(&mesh, &CellMap::Uniform(Hooke::Isotropic(material.moduli())));
    let network: Network = membrane.joined(plate);
    let mut random = Random(3);
    let u: Vec<f64> = mesh.points.iter().map(|_| random.next()).collect();
    let [a, b] = [network.stiffness(&mesh.points), finite_elements(&mesh, material.moduli())].map(|k| product(&k, &u));
    let size = a.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * size));
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let x: Vec<f64> =
        (0..mesh.point_count()).flat_map(|p| (turn * at(&mesh, p)).iter().copied().collect::<Vec<_>>()).collect();
    let mut force = vec![0.0; x.len()];
    assert!(network.forces(&x, &mut force));
    let y = displaced(&mesh.points, &u.iter().map(|u| 1e-2 * u).collect::<Vec<_>>());
    let mut moved = vec![0.0; x.len()];
    assert!(network.forces(&y, &mut moved));
    let size = moved.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
    assert!(force.iter().all(|f| f.abs() < 1e-11 * size), "{force:?}");
}

/// Hinges err by what another program computes at n = 16, and more where cells are halved.
#[test]
fn hinges_err_however_fine_the_mesh_is() {
    for (kind, is_clamped, expected) in [
        (Kind::Right, false, -44.0),
        (Kind::Right, true, -23.0),
        (Kind::Union, false, -25.0),
        (Kind::Union, true, -4.0),
    ] {
        let exact = if is_clamped { 0.00126532 } else { 0.00406235 };
        let [coarse, fine] = [16, 32].map(|n| 100.0 * (hinged_middle(kind, n, 0.3, is_clamped) / exact - 1.0));
        assert!((coarse - expected).abs() < 0.5, "{kind:?} {is_clamped}: {coarse} {expected}");
        assert!(fine < coarse, "{kind:?} {is_clamped}: {fine} {coarse}");
    }
}

/// A lattice of equilateral triangles with hinges of the constant k has `D = √3/2 k` in both directions and Poisson's ratio −1/3 (Seung and Nelson 1988).
#[test]
fn hinges_have_a_poissons_ratio_of_their_own() {
    let (n, h) = (6, 1.0);
    let rise = 3f64.sqrt() / 2.0;
    let flat = sheet(Kind::Right, [n as f64 * h, n as f64 * h], [n, n], 0.01);
    // The squares with parallel diagonals, sheared to equilateral triangles.
    let points = (0..flat.node_count()).flat_map(|p| {
        let [x, y] = [flat.point(p)[0], flat.point(p)[1]];
        [x - y / 2.0, rise * y, 0.0]
    });
    let mesh = surface(points.collect(), flat.blocks[0].connectivity.clone(), 0.01);
    for poisson in [-0.4, 0.0, 0.3, 0.49] {
        let network = hinged(&mesh, poisson);
        let d = hinge_flexure(&mesh, &network).unwrap();
        let expected = Matrix3::new(1.0, -1.0 / 3.0, 0.0, -1.0 / 3.0, 1.0, 0.0, 0.0, 0.0, 2.0 / 3.0);
        assert!((d - expected).amax() < 1e-12, "{poisson}: {d}");
        let record = NetworkFile::bare(&mesh, &network).record().without_directors().unwrap();
        let hinges = Parts::of(&record).unwrap().hinges;
        assert!(hinges.iter().all(|hinge| (hinge.constant * rise - 1.0).abs() < 1e-12 && hinge.rest.abs() < 1e-12));
        assert_eq!(hinges.len(), 3 * n * n - 2 * n);
        assert_eq!(record.points.len(), mesh.node_count());
    }
}

/// Three leaves that meet at one edge, of irregular triangles, and one end of each leaf held.
fn leaves() -> (Mesh, Vec<usize>) {
    let mut random = Random(5);
    let (n, mut points, mut triangles) = (4, Vec::new(), Vec::new());
    (0..=n).for_each(|j| points.extend([0.0, 0.0, j as f64 * 0.1]));
    let mut ends = Vec::new();
    for leaf in 0..3 {
        let angle = std::f64::consts::TAU * leaf as f64 / 3.0 + 0.2;
        let first = points.len() / 3;
        let place = |i: usize, j: usize| if i == 0 { j } else { first + (i - 1) * (n + 1) + j };
        for (i, j) in (1..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let reach = 0.1 * (i as f64 + if i < n { 0.3 * random.next() } else { 0.0 });
            let along = 0.1 * (j as f64 + if j > 0 && j < n { 0.3 * random.next() } else { 0.0 });
            points.extend([reach * angle.cos(), reach * angle.sin(), along]);
            if i == n {
                ends.push(place(i, j));
            }
        }
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
            // One leaf runs the other way round.
            triangles.extend(if leaf == 1 { [a, c, b, a, d, c] } else { [a, b, c, a, c, d] });
        }
    }
    (surface(points, triangles, 0.01), ends)
}

/// Hinges between pairs of triangles move a sheet as those on its directors do: at joints of three leaves, at clamped edges, and where the sheet is bent far.
#[test]
fn hinges_need_no_directors() {
    let (mesh, ends) = leaves();
    let network = hinged(&mesh, 0.3);
    let clamped: Vec<usize> = ends[..5].to_vec();
    let support = support_at(&mesh, &mesh.with_directors_of(&clamped));
    let mut whole = NetworkFile::bare(&mesh, &network).record();
    whole.held = (0..mesh.point_count())
        .filter(|&p| support.is_fixed(3 * p))
        .map(|point| HeldRecord { point, displacement: vec![Some(0.0); 3] })
        .collect();
    let record = whole.without_directors().unwrap();
    // The directors of four clamped edges stay.
    assert_eq!(record.points.len(), mesh.node_count() + 4);
    let own = Parts::of(&record).unwrap().network(3);
    let points = record.points.concat();
    let mut fixed = Support { prescribed: vec![None; points.len()] };
    let held: Vec<usize> = record.held.iter().map(|held| held.point).collect();
    fixed.fix(&held, &[0, 1, 2], 3);
    for size in [1e-2, 0.2] {
        let force = |count: usize| {
            let mut force = vec![0.0; count];
            ends[5..].iter().for_each(|p| force[3 * p + 1] = size);
            force
        };
        let newton = Newton { steps: 20, ..Newton::default() };
        let [one, other] = [(&network, &mesh.points, &support), (&own, &points, &fixed)].map(|(net, x, support)| {
            let found = newton.solve(net, x, support, &force(x.len())[..]).unwrap();
            assert_eq!(found.ending, Ending::Converged, "{} of {size} N, {} points", found.load, x.len() / 3);
            found.displacement
        });
        let nodes = 3 * mesh.node_count();
        let largest = one[..nodes].iter().fold(0.0, |a: f64, u| a.max(u.abs()));
        assert!(size < 0.1 || largest > 0.05, "{largest}");
        let apart = one[..nodes].iter().zip(&other).fold(0.0, |a: f64, (u, v)| a.max((u - v).abs()));
        assert!(apart < 1e-6 * largest, "{size}: {apart} of {largest}");
    }
}

/// The longest explicit step of a sheet is about that of its membrane alone, however thin it is.
#[test]
fn directors_do_not_shorten_explicit_steps() {
    for kind in KINDS {
        for t in [0.001, 0.03, 0.06] {
            let mesh = sheet(kind, [1.0, 1.0], [8, 8], t);
            let flat = Mesh::of_cells(3, mesh.points[..3 * mesh.node_count()].to_vec(), mesh.blocks.clone());
            let material = Material::for_body(2, 1e6, 0.3, Some(Plane::Stress), Some(t)).unwrap();
            let step = |mesh: &Mesh| {
                let fit = springfit_fit::fit::ExactFit::default();
                let membrane = exact_network(mesh, &material.into(), &fit, &vec![false; mesh.point_count()]).unwrap();
                let network =
                    membrane.joined(bending_springs(mesh, &CellMap::Uniform(Hooke::Isotropic(material.moduli()))));
                let masses = lumped_masses(mesh, 1e3, t, Default::default());
                assert!((masses.iter().sum::<f64>() / (1e3 * t) - 1.0).abs() < 1e-12);
                NetworkFile::with_masses(mesh, &network, Some(&masses)).longest_step().unwrap()
            };
            let share = step(&mesh) / step(&flat);
            println!("{kind:?} {t}: {share}");
            assert!(share > 0.5, "{kind:?} {t}: {share}");
        }
    }
}

/// A thick sheet that moves in its plane has the frequencies of its membrane, with lumped and with consistent masses: directors add no mass.
#[test]
fn directors_add_no_mass() {
    let frequencies = |bending: &str| {
        let text = format!(
            "[mesh]\nbox = {{ element = \"tri3\", size = [1.0, 0.1], cells = [40, 4] }}\nspace = 3\n[material]\nyoung = 1e6\npoisson = 0\nthickness = 0.05\n\
             density = 1000\nbending = \"{bending}\"\n[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n[[fix]]\nwhere = \"x > -1\"\naxes = [\"z\"]\n\
             [output]\nfrequencies = 2\n"
        );
        let scene = springfit_studies::study::Scene::parse(&text, std::path::Path::new("scene.toml")).unwrap();
        let outcome = springfit_studies::study::run(&scene, &mut |_| {}).unwrap();
        let found = &outcome.frequencies[0];
        [found.consistent.clone().unwrap(), found.frequencies.clone().unwrap()].concat()
    };
    for (sheet, membrane) in frequencies("plate").into_iter().zip(frequencies("none")) {
        assert!((sheet / membrane - 1.0).abs() < 1e-3, "{sheet} {membrane}");
    }
}
