//! Meshes are refined without loss, and limits are those of sequences that have one.

use crate::kit::{self, place, said, shipped, springfit};
use crate::messages::reads;
use crate::shapes::bodies::boxed;
use crate::shapes::{Random, elements, loaded, single};
use nalgebra::DMatrix;
use springfit_bodies::model::{Support, finite_elements};
use springfit_bodies::solve::System;
use springfit_element::element::{Cell, Element, Quadrature};
use springfit_element::material::{Material, Plane};
use springfit_mesh::mesh::{CellBlock, CellIndex, Group, Mesh, Selection};
use springfit_studies::study::{Convergence, LimitKind, Scene, converge, converge_to, limit_of, most_unknowns, rates};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

fn element(name: &str) -> Arc<Element> {
    loaded(name)
}

const SIZE: [f64; 3] = [1.0, 1.5, 0.8];

/// Two cells in each direction; a chain of three cells in the plane for one that fills no box.
fn coarse(element: &Element) -> Mesh {
    let d = element.dimension();
    if d > 1 {
        return boxed(&Arc::new(element.clone()), &SIZE[..d], &vec![2; d]).unwrap();
    }
    // The middles of cells are nodes, in the order of the element.
    let (mut points, mut connectivity) = (Vec::new(), Vec::new());
    let mut known: HashMap<i64, usize> = HashMap::new();
    for cell in 0..3 {
        for at in &element.positions {
            let x = f64::from(2 * cell) + at;
            let next = known.len();
            connectivity.push(*known.entry((64.0 * x).round() as i64).or_insert(next));
            if known.len() > next {
                points.extend([x, 0.3 * x]);
            }
        }
    }
    Mesh::of_cells(2, points, vec![CellBlock { element: Arc::new(element.clone().in_space(2)), connectivity }])
}

/// Every point moved by up to 1 % of the body.
fn moved(mut mesh: Mesh, seed: u64) -> Mesh {
    let mut random = Random(seed);
    mesh.points.iter_mut().for_each(|x| *x += 0.01 * random.next());
    mesh
}

fn sheared(mut mesh: Mesh) -> Mesh {
    let d = mesh.dimension;
    let map = DMatrix::from_fn(d, d, |i, j| if i == j { 1.0 } else { 0.1 * (1 + i + 2 * j) as f64 });
    mesh.points = mesh
        .points
        .chunks_exact(d)
        .flat_map(|x| (&map * nalgebra::DVector::from_column_slice(x)).as_slice().to_vec())
        .collect();
    mesh
}

/// Length, area or volume by a rule that is exact for the geometry of every shipped element but curved pyramids.
fn content(mesh: &Mesh) -> f64 {
    let mut total = 0.0;
    for block in &mesh.blocks {
        let element = &block.element;
        let d = element.dimension();
        let rule = Quadrature::of_degree(element.cell, 9);
        let gradients: Vec<Vec<Vec<f64>>> = rule
            .points
            .chunks_exact(d)
            .map(|at| element.functions.gradients.iter().map(|g| g.iter().map(|g| g.evaluate(at)).collect()).collect())
            .collect();
        for nodes in block.cells() {
            for (gradients, weight) in gradients.iter().zip(&rule.weights) {
                let column = |k: usize, l: usize| -> f64 {
                    nodes.iter().zip(gradients).map(|(&p, g)| mesh.point(p)[k] * g[l]).sum()
                };
                let jacobian = DMatrix::from_fn(mesh.dimension, d, column);
                total += weight * (jacobian.transpose() * jacobian).determinant().sqrt();
            }
        }
    }
    total
}

/// How many cells have each side.
fn sides(mesh: &Mesh) -> HashMap<Vec<usize>, usize> {
    let mut sides = HashMap::new();
    for block in &mesh.blocks {
        for nodes in block.cells() {
            for side in block.element.sides() {
                let mut points: Vec<usize> = side.nodes.iter().map(|&a| nodes[a]).collect();
                points.sort_unstable();
                *sides.entry(points).or_insert(0) += 1;
            }
        }
    }
    sides
}

/// Where points are, to 1e-9, sorted.
fn places(mesh: &Mesh) -> Vec<Vec<i64>> {
    let place = |x: &[f64]| x.iter().map(|x| (x * 1e9).round() as i64).collect();
    let mut places: Vec<Vec<i64>> = mesh.points.chunks_exact(mesh.dimension).map(place).collect();
    places.sort_unstable();
    places
}

fn divisible() -> impl Iterator<Item = Element> {
    elements().into_iter().filter(|element| element.cell != Cell::Pentagon)
}

#[test]
fn refinement_keeps_the_body_and_leaves_no_node_hanging() {
    for element in divisible() {
        let (d, name) = (element.dimension(), element.name.clone());
        let straight = coarse(&element);
        // Pyramids of other shapes have functions that those of their parts cannot follow; no rule is exact for curved lines.
        let coarse = if d == 1 || element.cell == Cell::Pyramid { sheared(straight) } else { moved(straight, 7) };
        let fine = coarse.refined().unwrap_or_else(|e| panic!("{name}: {e}"));
        let parts = if element.cell == Cell::Pyramid { 10 } else { 1 << d };
        assert_eq!(fine.cell_count(), parts * coarse.cell_count(), "{name}");
        // Rounding of sums of a few hundred terms.
        let (before, after) = (content(&coarse), content(&fine));
        assert!((after / before - 1.0).abs() < 1e-12, "{name}: {before} {after}");
        let (before, after) = (sides(&coarse), sides(&fine));
        assert!(after.values().all(|n| *n <= 2), "{name}");
        // Each side on the boundary has its parts there and no other is there: interior sides are shared.
        let outer = |sides: &HashMap<Vec<usize>, usize>| sides.values().filter(|n| **n == 1).count();
        assert_eq!(outer(&after), outer(&before) << (d - 1), "{name}");
        // Points that are kept keep their number and place.
        assert_eq!(fine.points[..coarse.points.len()], coarse.points[..], "{name}");
        let places = places(&fine);
        assert!(places.windows(2).all(|pair| pair[0] != pair[1]), "{name}: two points at one place");
        assert_eq!(fine.unused_points, 0);
    }
}

#[test]
fn a_box_is_refined_to_the_box_of_twice_the_cells() {
    for element in divisible().filter(|element| element.dimension() > 1) {
        let (d, name) = (element.dimension(), element.name.clone());
        let (fine, finer) =
            (coarse(&element).refined().unwrap(), coarse(&element).refined().unwrap().refined().unwrap());
        for mesh in [&fine, &finer] {
            for (k, axis) in ["x", "y", "z"].iter().enumerate().take(d) {
                for (group, at) in [(format!("{axis}min"), 0.0), (format!("{axis}max"), SIZE[k])] {
                    // Places are sums of a few products of a point's coordinates.
                    let on: Vec<usize> =
                        (0..mesh.point_count()).filter(|&p| (mesh.point(p)[k] - at).abs() < 1e-14).collect();
                    let found = &mesh.groups[&group];
                    assert_eq!(found.points, on, "{name} {group}");
                    let sides = Selection::Group(group.clone()).sides(mesh).unwrap();
                    assert_eq!(sides.len(), found.sides.len(), "{name} {group}");
                    let levels = if std::ptr::eq(mesh, &fine) { 1 } else { 2 };
                    assert_eq!(found.sides.len(), coarse(&element).groups[&group].sides.len() << (levels * (d - 1)));
                }
            }
            let body = &mesh.groups["body"];
            assert_eq!(body.points, (0..mesh.point_count()).collect::<Vec<_>>(), "{name}");
            let cells: std::collections::HashSet<CellIndex> = body.cells.iter().copied().collect();
            assert_eq!((cells.len(), body.cells.len()), (mesh.cell_count(), mesh.cell_count()), "{name}");
        }
        // The same points: the octahedra in tetrahedra may have another diagonal, but its middle is where that of the box is.
        if element.cell != Cell::Pyramid && element.cell != Cell::Tetrahedron {
            let twice = boxed(&Arc::new(element.clone()), &SIZE[..d], &vec![4; d]).unwrap();
            assert_eq!(places(&fine), places(&twice), "{name}");
        }
    }
}

#[test]
fn kinds_of_cells_stay_joined_and_bodies_that_touch_stay_apart() {
    let unit = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let mut points: Vec<f64> = unit.iter().flatten().map(|x| f64::from(*x)).collect();
    points.extend([0.5, 0.5, 1.6, 2.0, 0.5, 1.4]);
    let block = |name: &str, nodes: &[usize]| CellBlock { element: element(name), connectivity: nodes.to_vec() };
    let blocks = vec![
        block("hex8", &[0, 1, 2, 3, 4, 5, 6, 7]),
        block("pyramid5", &[4, 5, 6, 7, 8]),
        block("tet4", &[5, 9, 6, 8]),
    ];
    let mut mesh = Mesh::of_cells(3, points.clone(), blocks);
    // A curve in space, and a point.
    let edge = Group { points: vec![0, 4], edges: vec![vec![0, 4]], ..Group::default() };
    mesh.groups.insert("edge".into(), edge);
    mesh.groups.insert("tip".into(), Group { points: vec![9], ..Group::default() });
    mesh.groups.insert(
        "interface".into(),
        Group { points: vec![4, 5, 6, 7], sides: vec![vec![4, 5, 6, 7]], ..Group::default() },
    );
    let fine = mesh.refined().unwrap().refined().unwrap();
    assert_eq!(fine.blocks.len(), 3);
    assert_eq!(fine.cell_count(), 64 + 64 + (36 + 6 * 4 + 4 * 8));
    let outer = |mesh: &Mesh| sides(mesh).values().filter(|n| **n == 1).count();
    assert_eq!(outer(&fine), 16 * outer(&mesh));
    assert!((content(&fine) / content(&mesh) - 1.0).abs() < 1e-12);
    let heights: Vec<f64> = fine.groups["edge"].points.iter().map(|&p| fine.point(p)[2]).collect();
    let on_edge = |&p: &usize| fine.point(p)[0] == 0.0 && fine.point(p)[1] == 0.0;
    assert_eq!((heights.len(), fine.groups["edge"].edges.len()), (5, 4));
    assert!(fine.groups["edge"].points.iter().all(on_edge));
    assert_eq!(fine.groups["tip"].points, [9]);
    assert_eq!((fine.groups["interface"].sides.len(), fine.groups["interface"].points.len()), (16, 25));
    // A crack: the points of two bodies are at the same places.
    let twice = [&points[..24], &points[..24]].concat();
    let nodes: Vec<usize> = (0..16).collect();
    let crack = Mesh::of_cells(3, twice, vec![block("hex8", &nodes)]).refined().unwrap();
    assert_eq!(crack.point_count(), 2 * 27);
}

#[test]
fn what_cannot_be_divided_is_an_error() {
    let pentagon = element("pentagon5");
    reads(
        &single(&pentagon, &pentagon.positions).refined().unwrap_err().to_string(),
        "mesh: expected cells that can be divided …, found pentagon5",
    )
    .unwrap();
    let mut mesh = coarse(&element("tri3"));
    mesh.groups.get_mut("xmin").unwrap().sides.push(vec![0, 8]);
    reads(&mesh.refined().unwrap_err().to_string(), "mesh: expected sides of cells in group \"xmin\", found 1 sides …")
        .unwrap();
}

/// Irons' patch test: displacements that are linear in the place are solved exactly on every level.
#[test]
fn linear_displacements_are_exact_on_every_level() {
    for element in divisible().filter(|element| element.dimension() > 1 && element.nodes() <= 20) {
        let (d, name) = (element.dimension(), element.name.clone());
        // Where the rule of the element is exact for cells that are no parallelepipeds.
        let any_shape = ["tri3", "quad4", "tet4", "hex8"].contains(&name.as_str());
        let mut mesh = if any_shape { moved(coarse(&element), 3) } else { sheared(coarse(&element)) };
        let plane = (d == 2).then_some(Plane::Strain);
        let moduli = Material::for_body(d, 1e4, 0.3, plane, None).unwrap().moduli();
        for level in 0..if element.nodes() > 10 { 2 } else { 3 } {
            if level > 0 {
                mesh = mesh.refined().unwrap();
            }
            let wanted: Vec<f64> = (0..mesh.point_count())
                .flat_map(|p| (0..d).map(move |k| (p, k)))
                .map(|(p, k)| {
                    mesh.point(p).iter().enumerate().map(|(l, x)| x * (1.0 + (2 * k + l) as f64) * 1e-3).sum()
                })
                .collect();
            let mut support = Support::free(&mesh);
            for (side, _) in sides(&mesh).into_iter().filter(|(_, n)| *n == 1) {
                side.iter()
                    .flat_map(|p| p * d..(p + 1) * d)
                    .for_each(|dof| support.prescribed[dof] = Some(wanted[dof]));
            }
            let system = System::new(&finite_elements(&mesh, moduli), &support).unwrap();
            assert!(system.size() > 0 || level == 0, "{name}");
            let (found, _) = system.solve(&system.cholesky().unwrap().unwrap(), &vec![0.0; wanted.len()]);
            let worst = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Displacements of some 1e-2 by a solver that leaves rounding times the condition.
            assert!(worst < 1e-13, "{name} level {level}: {worst}");
        }
    }
}

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("scene.toml")).unwrap()
}

fn converged(text: &str, levels: usize) -> Convergence {
    converge(&scene(text), Some(levels), &mut |_| {}).unwrap()
}

const FITS: &str = "[[fit]]\nobjective = \"offdiag\"\n[[fit]]\nobjective = \"frobenius\"\n";
const SOLID: &str = "[material]\nyoung = 10e3\npoisson = 0.3\n";
const SHEET: &str = "[material]\nyoung = 10e3\npoisson = 0.3\nplane = \"strain\"\n";

/// Rollers on all faces and a force `b sin πx` along x give `u = b sin(πx)/(M π²)` and `f·u = b²/(2 M π²)`, with
/// `M = E (1 − ν)/((1 + ν)(1 − 2ν))`. The error in energy has twice the order of the error in strain, which for complete
/// polynomials of degree 1 is 1 (Strang and Fix 1973, theorem 3.7).
#[test]
fn linear_elements_converge_with_order_two_to_the_exact_work() {
    for (name, d, cells) in [("tri3", 2, 4), ("quad4", 2, 4), ("tet4", 3, 2), ("hex8", 3, 2)] {
        let list = |value: &str| vec![value; d].join(", ");
        let face = |i: usize| {
            let axis = ["x", "y", "z"][i / 2];
            format!("[[fix]]\ngroup = \"{axis}{}\"\naxes = [\"{axis}\"]\n", ["min", "max"][i % 2])
        };
        let text = format!(
            "[mesh]\nbox = {{ element = \"{name}\", size = [{}], cells = [{}] }}\n{}[[fit]]\nobjective = \"offdiag\"\n{}\
             [[load]]\nbody = [\"100*sin(3.141592653589793*x)\"{}]\n",
            list("1"),
            list(&cells.to_string()),
            if d == 2 { SHEET } else { SOLID },
            (0..2 * d).map(face).collect::<String>(),
            ", 0".repeat(d - 1)
        );
        let convergence = converged(&text, 4);
        let load = &convergence.loads[0];
        let truth = load.truth.unwrap();
        // Terms of the next order are what is left on meshes of 16 and 32 cells a side.
        let order = truth.order().unwrap();
        assert!((1.85..2.15).contains(&order), "{name}: {order}");
        let modulus = 1e4 * 0.7 / (1.3 * 0.4);
        let exact = 1e4 / (2.0 * modulus * std::f64::consts::PI.powi(2));
        let finest = load.models[0].steps[3].compliance.unwrap();
        let (error, left) = ((truth.value - exact).abs(), (finest - exact).abs());
        // Extrapolation takes away the leading term of the error.
        assert!(error < 0.2 * left && error < 2e-3 * exact, "{name}: {exact} {truth:?} {finest}");
        let sizes: Vec<f64> = convergence.levels.windows(2).map(|pair| pair[0].size / pair[1].size).collect();
        assert!(sizes.iter().all(|ratio| (ratio - 2.0).abs() < 1e-12));
        let cells: Vec<usize> = convergence.levels.windows(2).map(|pair| pair[1].cells / pair[0].cells).collect();
        assert_eq!(cells, vec![1 << d; 3], "{name}");
    }
}

/// A mesh that is no box: the body stays the polygon of the first mesh. Conforming finite elements are too stiff, so that the work
/// of given forces rises to the truth; a clamped convex polygon has no singularity that lowers the order.
#[test]
fn finite_elements_on_a_refined_disc_rise_to_the_truth_with_order_two() {
    let text = format!(
        "[mesh]\ndisc = {{ element = \"tri3\", radius = 1, rings = 2 }}\n{SHEET}[[fit]]\nobjective = \"offdiag\"\n\
         [[fix]]\ngroup = \"rim\"\n[[load]]\nbody = [100, 0]\n"
    );
    let convergence = converged(&text, 6);
    let load = &convergence.loads[0];
    let values: Vec<f64> = load.models[0].steps.iter().map(|step| step.compliance.unwrap()).collect();
    let orders: Vec<f64> = values.windows(3).map(|v| ((v[1] - v[0]) / (v[2] - v[1])).log2()).collect();
    // The corners of 150° slow the coarse levels down: orders rise from 1.2 to 1.8 on the way to 2.
    assert!(orders.windows(2).all(|pair| pair[0] < pair[1]), "{orders:?}");
    assert!((1.75..2.15).contains(&orders[3]), "{orders:?}");
    assert!((load.truth.unwrap().order().unwrap() - orders[3]).abs() < 1e-9);
    let errors = load.of_truth(&load.models[0]);
    assert!(errors.iter().all(|e| e.unwrap() < 0.0), "{errors:?}");
}

/// A bar under uniform tension: `f·u = σ² V / E` on every level, as for given displacements `u·r = E A δ² / L`.
#[test]
fn the_compliance_of_a_bar_is_known() {
    let text = |load: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [1, 2, 3], cells = [1, 1, 2] }}\n{SOLID}{FITS}\
             [[fix]]\ngroup = \"xmin\"\naxes = [\"x\"]\n[[fix]]\ngroup = \"ymin\"\naxes = [\"y\"]\n\
             [[fix]]\ngroup = \"zmin\"\naxes = [\"z\"]\n[[load]]\ngroup = \"zmax\"\n{load}\n"
        )
    };
    let wanted = [
        ("traction = [0, 0, 50]", 50.0 * 50.0 * 6.0 / 1e4),
        ("displacement = [\"free\", \"free\", 0.03]", 1e4 * 2.0 * 9e-4 / 3.0),
    ];
    for (load, wanted) in wanted {
        let convergence = converged(&text(load), 3);
        let load = &convergence.loads[0];
        let truth = load.truth.unwrap();
        assert_eq!(truth.kind, LimitKind::Constant);
        assert!((truth.value / wanted - 1.0).abs() < 1e-11, "{} {wanted}", truth.value);
        assert_eq!(load.of_truth(&load.models[0]), [Some(0.0); 3]);
        assert_eq!(load.models.len(), 3);
        for model in &load.models[1..] {
            // A network against the finite elements of its level and against the truth, which are the same here.
            let (of_body, of_truth) = (load.of_body(model), load.of_truth(model));
            for (body, truth) in of_body.iter().zip(&of_truth) {
                assert!((body.unwrap() - truth.unwrap()).abs() < 1e-6, "{of_body:?} {of_truth:?}");
            }
        }
        assert_eq!(load.mean_truth.is_some(), load.models[0].steps[0].mean_displacement.is_some());
        if let Some(mean) = load.mean_truth {
            // Tension moves the end by σ L / E, and inwards by ν σ / E times half the sides.
            let (along, across) = (50.0 * 3.0 / 1e4, 0.3 * 50.0 / 1e4);
            let wanted = f64::hypot(along, f64::hypot(0.5 * across, across));
            assert!((mean.value / wanted - 1.0).abs() < 1e-10, "{} {wanted}", mean.value);
        }
    }
}

/// Small loads deform a body with a law as the linear theory says.
#[test]
fn a_law_under_small_loads_converges_like_the_linear_body() {
    for load in ["traction = [0, 0.1]", "displacement = [0, 1e-3]"] {
        let text = |law: &str| {
            format!(
                "[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [3, 3] }}\n{SHEET}{law}{FITS}\
                 [[fix]]\ngroup = \"xmin\"\n[[load]]\ngroup = \"xmax\"\n{load}\n"
            )
        };
        let (linear, large) = (converged(&text(""), 2), converged(&text("law = \"neo-hookean\"\n"), 2));
        assert!(linear.law.is_none() && large.law.is_some());
        for (linear, large) in linear.loads[0].models.iter().zip(&large.loads[0].models).take(1) {
            for (a, b) in linear.steps.iter().zip(&large.steps) {
                // The theories differ by a share of the order of the strains, 1e-3 at most.
                let (a, b) = (a.compliance.unwrap(), b.compliance.unwrap());
                assert!((a / b - 1.0).abs() < 1e-3, "{load}: {a} {b}");
            }
        }
    }
}

#[test]
fn limits_are_those_of_the_sequence() {
    let sequence = |limit: f64, order: f64, levels: i32| -> Vec<f64> {
        (0..levels).map(|l| limit - 0.3 * 2f64.powf(-order * f64::from(l))).collect()
    };
    for order in [0.7, 1.0, 1.5, 2.0, 4.0] {
        for levels in 3..6 {
            let limit = limit_of(&sequence(2.0, order, levels)).unwrap();
            assert!((limit.value - 2.0).abs() < 1e-9, "{limit:?}");
            assert!((limit.order().unwrap() - order).abs() < 1e-6, "{limit:?}");
            assert!(levels == 3 || limit.uncertainty < 1e-8, "{limit:?}");
        }
    }
    let finest = |values: &[f64], kind: LimitKind| {
        let limit = limit_of(values).unwrap();
        assert_eq!((limit.value, limit.kind), (values[values.len() - 1], kind), "{values:?}");
    };
    finest(&[1.0, 1.5], LimitKind::TooFew);
    finest(&[1.0], LimitKind::TooFew);
    finest(&[1.0, 1.5, 1.4], LimitKind::NotMonotonic);
    finest(&[1.0, 1.1, 1.3], LimitKind::Growing);
    finest(&[1.2, 1.0, 1.5, 1.6], LimitKind::NotMonotonic);
    finest(&[2.0, 2.0, 2.0], LimitKind::Constant);
    finest(&[0.0, 0.0], LimitKind::Constant);
    let slow = limit_of(&sequence(2.0, 0.3, 4)).unwrap();
    assert!(matches!(slow.kind, LimitKind::TooSlow(order) if (order - 0.3).abs() < 1e-9), "{slow:?}");
    assert!(limit_of(&[]).is_none());
    assert_eq!(rates(&[Some(4.0), Some(-1.0), None, Some(0.0), Some(0.0)])[1..], [Some(2.0), None, None, None]);
}

#[test]
fn the_program_writes_its_table_and_plot() {
    let folder = TempDir::new().unwrap();
    let path = place("scenes/specimen_tri.toml");
    let output = springfit(folder.path(), &["converge", path.to_str().unwrap(), "--levels", "3"]);
    let (told, progress) = (String::from_utf8_lossy(&output.stdout).into_owned(), said(&output));
    assert!(output.status.success() && told.contains("tension: the truth is ") && told.contains("limit"), "{told}");
    assert!((1..=3).all(|level| progress.contains(&format!("note: level {level} of 3: "))), "{progress}");
    let out = folder.path().join("out/converge-specimen_tri");
    let table = fs::read_to_string(out.join("converge.csv")).unwrap();
    assert!(table.starts_with("load,model,level,h_m,cells,points,unknowns,compliance_J,"), "{table}");
    // Two loads, finite elements and four fits, three levels, and the heading.
    assert_eq!(table.lines().count(), 1 + 2 * 5 * 3);
    let plot = fs::read_to_string(out.join("converge.svg")).unwrap();
    // One chart for each load.
    for words in ["order 1", "order 2", "cell size h, mm"] {
        assert_eq!(plot.matches(words).count(), 2, "{words}");
    }
}

/// The body is that of the first mesh on every level, and nothing is said of the conditions.
#[test]
fn discs_keep_the_edges_of_the_coarsest_mesh() {
    let disc = "[mesh]\ndisc = { element = \"tri3\", radius = 1, rings = 2 }\n";
    let held = "[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"rim\"\n[[load]]\nbody = [1, 0]\n";
    let disc = converged(&format!("{disc}{SHEET}{held}"), 2);
    assert!(disc.notes.iter().any(|note| note.contains("straight edges")), "{:?}", disc.notes);
}

/// A reference of another body, material, support or load is refused.
#[test]
fn a_truth_of_another_problem_is_refused() {
    let bar = |length: &str, young: &str, held: &str, traction: &str, element: &str| {
        scene(&format!(
            "[mesh]\nscale = \"cm\"\nbox = {{ element = \"{element}\", size = [{length}, 1, 1], cells = [2, 1, 1] }}\n\
             [material]\nyoung = {young}\npoisson = 0.3\n[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n{held}\
             [[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = {traction}\n"
        ))
    };
    let own = bar("4", "1e4", "", "[10, 0, 0]", "hex8");
    let against = |truth: &Scene| converge_to(&own, truth, Some(2), &mut |_| {});
    let known = against(&bar("4", "1e4", "", "[10, 0, 0]", "hex20")).unwrap();
    assert!(known.notes.is_empty(), "{:?}", known.notes);
    let roller = "[[fix]]\ngroup = \"xmax\"\naxes = [\"z\"]\n";
    for (truth, words) in [
        (bar("5", "1e4", "", "[10, 0, 0]", "hex20"), "extent along x, m: 4.000000e-2"),
        (bar("4", "2e4", "", "[10, 0, 0]", "hex20"), "young, Pa: 10000.0"),
        (bar("4", "1e4", "", "[20, 0, 0]", "hex20"), "total force of (1.000000e-3"),
        (bar("4", "1e4", roller, "[10, 0, 0]", "hex20"), "points held along z"),
    ] {
        let error = against(&truth).unwrap_err().to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
}

#[test]
fn what_cannot_converge_is_refused() {
    let folder = TempDir::new().unwrap();
    let mesh = |cells: usize| {
        format!("[mesh]\nbox = {{ element = \"hex8\", size = [1, 1, 1], cells = [{cells}, {cells}, {cells}] }}\n")
    };
    let held = "[[fix]]\ngroup = \"zmin\"\n";
    let load = "[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 1]\n";
    let body = |cells: usize| format!("{}{SOLID}{FITS}{held}", mesh(cells));
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("good.toml", body(2) + load);
    write("loadless.toml", body(2));
    write("large.toml", body(8) + load);
    write("huge.toml", body(50) + load);
    let refused = |arguments: &[&str], pattern: &str| {
        let error = kit::refused(folder.path(), &[&["converge"], arguments].concat());
        let line = error.lines().next().unwrap_or_default();
        reads(line, pattern).unwrap_or_else(|e| panic!("{arguments:?}: {e}"));
        assert!(!folder.path().join("out").exists(), "{arguments:?}: something was written");
    };
    for levels in ["0", "1", "9", "99"] {
        let pattern = format!("error: --levels: expected a number from 2 to 8, found {levels}");
        refused(&["good.toml", "--levels", levels], &pattern);
    }
    for levels in ["-1", "x", "1e9"] {
        refused(&["good.toml", "--levels", levels], "error: invalid value …");
    }
    refused(&["loadless.toml"], "error: loadless.toml: load: expected at least one [[load]] …, found none");
    let pattern = format!("error: --levels: expected 2 to 3 …{}…, found 5, about …", most_unknowns(3));
    refused(&["large.toml", "--levels", "5"], &pattern);
    refused(
        &["huge.toml"],
        "error: huge.toml:1: mesh: expected at most 200000 unknowns …, found 397953 unknowns on the first level",
    );
    refused(&["huge.toml", "--levels", "3"], "error: huge.toml:1: mesh: …");
    refused(&["missing.toml"], "error: missing.toml: …");
}

/// Near the incompressible the truth is that of quadratic cells: patches on triangles and mean dilatation on quadrilaterals are nearer
/// to it on every level than the finite elements of the same mesh, which lock.
#[test]
fn networks_on_patches_and_cells_are_nearer_to_the_truth() {
    let cantilever = |element: &str, poisson: f64, fits: &str| {
        scene(&format!(
            "[mesh]\nbox = {{ element = \"{element}\", size = [4, 1], cells = [8, 2] }}\n[material]\nyoung = 1\n\
             poisson = {poisson}\nplane = \"strain\"\n{fits}[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"shear\"\n\
             group = \"xmax\"\ntraction = [0, 1e-3]\n"
        ))
    };
    for poisson in [0.49, 0.4999] {
        let truth = cantilever("quad9", poisson, FITS);
        for (element, volume) in [("tri3", "patches"), ("quad4", "cells")] {
            let fit = format!("[[fit]]\nobjective = \"exact\"\nvolume = \"{volume}\"\n");
            let study = converge_to(&cantilever(element, poisson, &fit), &truth, Some(4), &mut |_| {}).unwrap();
            let load = &study.loads[0];
            assert!(load.truth.unwrap().order().is_some() && study.reference.is_some());
            let [body, network] = [0, 1].map(|model| load.of_truth(&load.models[model]));
            for (level, (body, network)) in body.iter().zip(&network).enumerate() {
                let (body, network) = (body.unwrap(), network.unwrap());
                println!(
                    "{element} {poisson} level {}: finite elements {body:.2} %, {volume} {network:.2} %",
                    level + 1
                );
                assert!(network.abs() < 0.8 * body.abs(), "{element} {poisson}: {body} {network}");
            }
            assert!(network[3].unwrap().abs() < 2.0, "{network:?}");
            // Without a reference the truth is that of quadratic elements on the same cells.
            let own = converge(&cantilever(element, poisson, &fit), Some(4), &mut |_| {}).unwrap();
            let (found, right) = (own.loads[0].truth.unwrap(), load.truth.unwrap());
            let apart = (found.value - right.value).abs();
            println!("{element} {poisson}: truth {:e}, {:e}", found.value, right.value);
            assert!(apart <= found.uncertainty + right.uncertainty + 0.005 * right.value, "{found:?} {right:?}");
            assert!(
                own.reference.as_deref() == Some("quadratic elements") && own.notes[0].contains("linear cells lock")
            );
        }
    }
    let other = scene(
        "[mesh]\nbox = { element = \"quad9\", size = [4, 1], cells = [2, 1] }\n[material]\nyoung = 1\npoisson = 0.3\n\
         [[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [1, 0]\n",
    );
    let error = converge_to(&cantilever("tri3", 0.3, FITS), &other, None, &mut |_| {}).unwrap_err().to_string();
    assert!(error.contains("load: expected a load \"shear\" as in the scene, found pull"), "{error}");
}

/// The figures of docs/src/studies/convergence.md: tetrahedra at ν = 0.4999 against the limit of quadratic hexahedra, and classical springs on a
/// structured block, which do not converge.
#[test]
fn the_figures_of_the_page_on_exact_networks() {
    let load = |name: &str| shipped(&format!("converge/{name}"));
    let near =
        |found: Option<f64>, printed: f64| assert!((found.unwrap() - printed).abs() < 0.06, "{found:?} {printed}");
    let study = converge_to(&load("cantilever_tet"), &load("cantilever_truth"), Some(3), &mut |_| {}).unwrap();
    for (model, printed) in study.loads[0].models.iter().zip([-93.6, -93.6, -20.8, -3.8, -99.9, -90.4]) {
        println!("{}: {:?}", model.name, study.loads[0].of_truth(model));
        near(study.loads[0].of_truth(model)[2], printed);
    }
    let block = load("block_tet");
    let offdiag = block.fits()[1].clone();
    let study = converge(&block.with_fits(vec![offdiag]), Some(4), &mut |_| {}).unwrap();
    for (load, [finest, limit]) in study.loads.iter().zip([[-25.5, -25.5], [29.0, 31.2]]) {
        let model = &load.models[1];
        near(load.of_truth(model)[3], finest);
        near(Some(100.0 * (model.limit().unwrap().value / load.truth.unwrap().value - 1.0)), limit);
    }
}
