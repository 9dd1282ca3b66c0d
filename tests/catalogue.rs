//! The shipped elements in meshes that Gmsh, meshio and VTK wrote: node orders, contents, and surfaces and curves in space.

use crate::kit::{mesh, place};
use springfit_bodies::model::{Network, finite_elements, masses};
use springfit_element::element::{Quadrature, SHIPPED, Tabulation};
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_element::stiffness::each_cell;
use springfit_fit::fit::{Balance, Fit, MotionWeight, Objective, Weight, element_errors, fit_cells};

/// File, number of cells, and content by Gmsh's own Jacobians.
fn references() -> Vec<(String, usize, f64)> {
    let text = std::fs::read_to_string(place("tests/meshes/volumes.txt")).unwrap();
    let line = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        (words[0].to_string(), words[2].parse().unwrap(), words[3].parse().unwrap())
    };
    text.lines().filter(|l| !l.starts_with('#')).map(line).collect()
}

/// The build of the program finds the numbers of cell types without a parser of TOML.
#[test]
fn cell_types_of_shipped_elements_are_those_of_their_files() {
    for file in SHIPPED {
        let table: toml::Table = file.text.parse().unwrap();
        let number = |format: &str| table.get("formats").and_then(|f| f.get(format)?.get("type")?.as_integer());
        assert_eq!((file.gmsh, file.vtk), (number("gmsh"), number("vtk")), "{}", file.name);
    }
}

/// Curved cells with their nodes in the wrong order have another content or none. Files of text have 12 digits. Curves and
/// surfaces are laid flat cell by cell, which shortens those that are bent.
#[test]
fn meshes_of_other_programs_have_the_contents_that_gmsh_finds() {
    let mut seen = Vec::new();
    for (file, cells, expected) in references() {
        let mesh = mesh(&file);
        let element = &mesh.blocks[0].element;
        seen.push(element.name.clone());
        assert_eq!((mesh.blocks.len(), mesh.cell_count()), (1, cells), "{file}");
        let rule = Quadrature::of_degree(element.cell, 12);
        let mut table = Tabulation::new(&element.functions, &rule, None);
        table.space = element.space();
        let mut content = 0.0;
        each_cell(&table, &mesh.points, &mesh.blocks[0].connectivity, |_, _, g| content += g.content()).unwrap();
        let tolerance = if file.starts_with("curve3") { 0.02 } else { 1e-11 };
        assert!((content / expected - 1.0).abs() < tolerance, "{file}: {content} {expected}");
        let mirrored = if file == "wedge6.vtu" { cells } else { 0 };
        assert_eq!(mesh.reversed, mirrored, "{file}");
    }
    // All but those of the first meshes, which have other tests.
    let others = ["hex8", "quad4", "tet4"];
    for element in SHIPPED.iter().filter(|s| !others.contains(&s.name)) {
        assert!(seen.iter().any(|name| name == element.name), "no mesh of {}", element.name);
    }
}

/// A straight rod is its spring: `k = EA/L`, with no error; the rods of a chain add up.
#[test]
fn a_rod_is_one_spring() {
    let mesh = mesh("curve2.msh");
    let element = &mesh.blocks[0].element;
    let material = Material::for_body(1, 2e9, 0.3, None, None).unwrap().with_area(3e-4).unwrap();
    let springs = Springs::select(element, None).unwrap();
    for objective in [Objective::Frobenius(Weight::None), Objective::Spectral(MotionWeight::None)] {
        let (points, cells) = (&mesh.points, &mesh.blocks[0].connectivity);
        let fits =
            fit_cells(element, &springs, points, cells, material.moduli(), &Fit::new(objective), &mut |_| {}).unwrap();
        for (k, nodes) in fits.constants.iter().zip(cells.chunks_exact(2)) {
            let length = springfit_element::springs::distance(mesh.point(nodes[0]), mesh.point(nodes[1]));
            // The spectral optimum is known to a millionth of R where it is zero.
            assert!((k * length / 6e5 - 1.0).abs() < 2e-6, "{k} {length}");
        }
        assert!(element_errors(element, points, cells, material.moduli(), &fits).unwrap().spectral[0] < 2e-6);
    }
    let total: f64 = masses(&mesh, 1000.0, material.thickness()).iter().sum();
    assert!((total / (1000.0 * 3e-4 * 4.14076535996315) - 1.0).abs() < 1e-12);
}

/// A triangle in space has the constants of the same triangle in the plane, with and without its area spring, and the
/// assembled models store the energy that a homogeneous deformation of space gives each triangle.
#[test]
fn surfaces_are_membranes() {
    let mesh = mesh("sphere3.msh");
    assert_eq!((mesh.dimension, mesh.cell_dimension()), (3, 2));
    let element = &mesh.blocks[0].element;
    let plane = springfit_element::element::Element::load("tri3").unwrap();
    let material = Material::for_body(2, 1e4, 1.0 / 3.0, None, Some(1e-3)).unwrap();
    let every = ["edge".to_string(), "bulk".to_string()];
    for names in [&every[..1], &every[..]] {
        let springs = Springs::select(element, Some(names)).unwrap();
        let cells = &mesh.blocks[0].connectivity;
        for objective in [Objective::Frobenius(Weight::None), Objective::Divergence(Balance::DEFAULT)] {
            let fit = Fit::new(objective);
            let fits = fit_cells(element, &springs, &mesh.points, cells, material.moduli(), &fit, &mut |_| {}).unwrap();
            for (nodes, k) in cells.chunks_exact(3).zip(fits.constants.chunks_exact(springs.len())) {
                let side = |i: usize, j: usize| {
                    springfit_element::springs::distance(mesh.point(nodes[i]), mesh.point(nodes[j]))
                };
                let (a, b, c) = (side(0, 1), side(0, 2), side(1, 2));
                let x = (a * a + b * b - c * c) / (2.0 * a);
                let flat = [0.0, 0.0, a, 0.0, x, (b * b - x * x).sqrt()];
                let springs = Springs::select(&plane, Some(names)).unwrap();
                let expected =
                    springfit_fit::fit::fit_element(&plane, &springs, &flat, material.moduli(), &fit).unwrap();
                for (s, (k, e)) in k.iter().zip(&expected).enumerate() {
                    // The area spring has another unit.
                    let size = expected[0].abs() * if s < 3 { 1.0 } else { 1.0 / (a * a) };
                    assert!((k - e).abs() < 1e-7 * size, "{objective:?}: {k} {e}");
                }
            }
            // Under u = A x the strain of each triangle is that of A in its plane, and each edge stretches by nᵀAn.
            let stretch = [0.01, 0.002, -0.003, 0.001, -0.02, 0.005, 0.004, 0.003, 0.015];
            let map =
                |v: &[f64]| -> Vec<f64> { (0..3).map(|k| (0..3).map(|l| stretch[3 * k + l] * v[l]).sum()).collect() };
            let u: Vec<f64> = mesh.points.chunks_exact(3).flat_map(map).collect();
            let energy = |entries: &springfit_bodies::model::Entries| -> f64 {
                let twice = |e: &faer::sparse::Triplet<usize, usize, f64>| if e.row == e.col { 1.0 } else { 2.0 };
                entries.iter().map(|e| twice(e) * e.val * u[e.row] * u[e.col]).sum()
            };
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let moduli = material.moduli();
            let (mut body, mut lattice) = (0.0, 0.0);
            for (nodes, k) in cells.chunks_exact(3).zip(fits.constants.chunks_exact(springs.len())) {
                let edge = |i: usize, j: usize| -> Vec<f64> {
                    mesh.point(nodes[i]).iter().zip(mesh.point(nodes[j])).map(|(a, b)| b - a).collect()
                };
                let (p, q) = (edge(0, 1), edge(0, 2));
                let base = dot(&p, &p).sqrt();
                let e1: Vec<f64> = p.iter().map(|p| p / base).collect();
                let across: Vec<f64> = q.iter().zip(&e1).map(|(q, e)| q - dot(&e1, &edge(0, 2)) * e).collect();
                let height = dot(&across, &across).sqrt();
                let e2: Vec<f64> = across.iter().map(|a| a / height).collect();
                let strain = |a: &[f64], b: &[f64]| (dot(a, &map(b)) + dot(b, &map(a))) / 2.0;
                let (xx, yy, xy) = (strain(&e1, &e1), strain(&e2, &e2), strain(&e1, &e2));
                let area = base * height / 2.0;
                let squares = xx * xx + yy * yy + 2.0 * xy * xy;
                body += area * (moduli.lambda * (xx + yy).powi(2) + 2.0 * moduli.mu * squares);
                for (&[i, j], k) in springs.pairs().iter().zip(k) {
                    let n = edge(i, j);
                    lattice += k * dot(&n, &map(&n)).powi(2) / dot(&n, &n);
                }
                if springs.content().is_some() {
                    lattice += k[3] * (area * (xx + yy)).powi(2);
                }
            }
            let network = Network::assemble(&mesh, std::slice::from_ref(&fits));
            let (k, r) = (energy(&network.stiffness(&mesh.points)), energy(&finite_elements(&mesh, moduli)));
            assert!((r / body - 1.0).abs() < 1e-12 && (k / lattice - 1.0).abs() < 1e-12, "{k} {lattice} {r} {body}");
        }
    }
}
