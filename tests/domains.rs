//! Exact networks with shear springs on the domains of edges: their energy, affine deformations, bodies of several
//! materials, and errors against the limit of refinement beside those of the finite elements of the same mesh.

use crate::shapes::Random;
use crate::shapes::bodies::grid;
use crate::shapes::statics::{
    assert_derivatives_along, compliance, end_load, frequencies, held_where, membrane, on_cells,
};
use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Elastic, Entries, Network, Support, edge_springs, exact_network, finite_elements};
use springfit_element::material::{CellMap, LinearMaterial, Material, MaterialMap, Moduli, Plane, State};
use springfit_fit::fit::{ExactEnergy, ExactFit, ShearSprings, VolumeSprings, fit_exact};
use springfit_foundation::error::ErrorKind;
use springfit_mesh::mesh::Mesh;
use springfit_studies::study::{Scene, SpringOwners, network_material};
use std::collections::BTreeMap;
use std::path::Path;

const EDGES: ExactFit = ExactFit {
    energy: ExactEnergy::StableNeoHookean,
    shear: ShearSprings::Edges,
    volume: VolumeSprings::Points,
    large: false,
};

const ENERGIES: [ExactEnergy; 3] =
    [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean, ExactEnergy::StableMooneyRivlin { share: 0.4 }];

/// A box of simplices whose inner points are moved at random.
fn shaken(element: &str, cells: &[usize], size: &[f64], random: &mut Random) -> Mesh {
    let d = size.len();
    let mut mesh = grid(element, size, cells);
    for x in mesh.points.chunks_exact_mut(d) {
        if x.iter().zip(size).all(|(x, size)| *x > 0.0 && *x < *size) {
            x.iter_mut().zip(size).zip(cells).for_each(|((x, size), n)| *x += 0.15 * random.next() * size / *n as f64);
        }
    }
    mesh
}

fn solid(dimension: usize, poisson: f64) -> Material {
    Material::for_body(dimension, 3.0, poisson, (dimension == 2).then_some(Plane::Strain), None).unwrap()
}

fn network(mesh: &Mesh, material: impl Into<MaterialMap>, fit: ExactFit, held: &[bool]) -> Network {
    exact_network(mesh, &material.into(), &fit, held).unwrap()
}

/// The deformation gradient of a cell.
fn gradient(mesh: &Mesh, x: &[f64], nodes: &[usize]) -> DMatrix<f64> {
    let d = mesh.dimension;
    let edges = |x: &[f64]| {
        let at = |a: usize| DVector::from_column_slice(&x[nodes[a] * d..(nodes[a] + 1) * d]);
        DMatrix::from_columns(&(1..=d).map(|a| at(a) - at(0)).collect::<Vec<_>>())
    };
    edges(x) * edges(&mesh.points).try_inverse().unwrap()
}

fn content(mesh: &Mesh, nodes: &[usize]) -> f64 {
    let d = mesh.dimension;
    let at = |a: usize| DVector::from_column_slice(mesh.point(nodes[a]));
    let edges = DMatrix::from_columns(&(1..=d).map(|a| at(a) - at(0)).collect::<Vec<_>>());
    edges.determinant() / [1.0, 2.0, 6.0][d - 1]
}

/// W of Moduli at F, with the strain across a plane zero.
fn energy(of: ExactEnergy, Moduli { lambda, mu }: Moduli, f: &DMatrix<f64>) -> f64 {
    let (d, j) = (f.nrows(), f.determinant());
    let across = 3.0 - d as f64;
    let i1 = f.norm_squared() + across;
    let cofactor = f.clone().try_inverse().unwrap().norm_squared() * j * j;
    let i2 = if d == 3 { cofactor } else { cofactor + j * j };
    match of {
        ExactEnergy::StableNeoHookean => {
            mu / 2.0 * (i1 - 3.0) - mu * (j - 1.0) + (lambda + mu) / 2.0 * (j - 1.0).powi(2)
        }
        ExactEnergy::NeoHookean => mu / 2.0 * (i1 - 3.0) - mu * j.ln() + lambda / 2.0 * j.ln().powi(2),
        ExactEnergy::StVenantKirchhoff => unreachable!("it has no springs on contents"),
        ExactEnergy::StableMooneyRivlin { share: s } => {
            mu / 2.0 * ((1.0 - s) * (i1 - 3.0) + s * (i2 - 3.0)) - mu * (1.0 + s) * (j - 1.0)
                + (lambda + mu * (1.0 - s)) / 2.0 * (j - 1.0).powi(2)
        }
    }
}

/// A share of a cell in a domain: its volume, its deformation gradient and its moduli.
type Share = (f64, DMatrix<f64>, Moduli);

/// `Σ W(F)` over the domains of edges, each with the mean F of its shares of cells, worked out from the cells alone; `of`
/// has the moduli and the region of a cell.
fn expected(mesh: &Mesh, of: ExactEnergy, x: &[f64], of_cell: impl Fn(usize) -> (Moduli, usize)) -> f64 {
    let d = mesh.dimension;
    let mut domains: BTreeMap<(usize, usize, usize), Vec<Share>> = BTreeMap::new();
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let (moduli, region) = of_cell(cell);
        let share = content(mesh, nodes) / (d * (d + 1) / 2) as f64;
        for (a, b) in (0..=d).flat_map(|a| (0..a).map(move |b| (a, b))) {
            let key = (nodes[a].min(nodes[b]), nodes[a].max(nodes[b]), region);
            domains.entry(key).or_default().push((share, gradient(mesh, x, nodes), moduli));
        }
    }
    let of_domain = |parts: &Vec<Share>| {
        let whole: f64 = parts.iter().map(|part| part.0).sum();
        let mut f = DMatrix::zeros(d, d);
        parts.iter().for_each(|(share, own, _)| f += own * (share / whole));
        parts.iter().map(|(share, _, moduli)| share * energy(of, *moduli, &f)).sum::<f64>()
    };
    domains.values().map(of_domain).sum()
}

fn at(network: &Network, x: &[f64]) -> f64 {
    Elastic::energy(network, x).unwrap()
}

/// The network has the energy of its domains at large random deformations, in one material, in two regions, and where
/// moduli vary from cell to cell.
#[test]
fn the_network_has_the_energy_of_the_domains() {
    let mut random = Random(71);
    for (element, cells, size) in [("tri3", vec![3, 3], vec![1.0, 0.7]), ("tet4", vec![2, 2, 2], vec![1.0, 0.7, 0.9])] {
        let d = size.len();
        let mesh = shaken(element, &cells, &size, &mut random);
        let x: Vec<f64> = mesh.points.iter().map(|x| 1.1 * x + 0.08 * random.next()).collect();
        let count = mesh.cell_count();
        let varying: Vec<Material> = (0..count)
            .map(|cell| {
                Material::for_body(
                    d,
                    1.0 + cell as f64 / 7.0,
                    0.2 + 0.2 * (cell % 2) as f64,
                    (d == 2).then_some(Plane::Strain),
                    None,
                )
                .unwrap()
            })
            .collect();
        let linear = varying.iter().map(|material| LinearMaterial::from(*material)).collect();
        let regions: Vec<usize> = (0..count).map(|cell| usize::from(cell >= count / 2)).collect();
        let of_regions = MaterialMap::of_regions(
            CellMap::of_blocks(vec![linear]),
            vec!["a".into(), "b".into()],
            CellMap::of_blocks(vec![regions.clone()]),
        )
        .unwrap();
        let uniform = solid(d, 0.4);
        for energy in ENERGIES {
            let fit = ExactFit { energy, large: true, ..EDGES };
            let one = network(&mesh, uniform, fit, &[]);
            let several = network(&mesh, of_regions.clone(), fit, &[]);
            let moduli = |cell: usize| (varying[cell].moduli(), regions[cell]);
            for (network, known) in [
                (one, expected(&mesh, energy, &x, |_| (uniform.moduli(), 0))),
                (several, expected(&mesh, energy, &x, moduli)),
            ] {
                let found = at(&network, &x) - at(&network, &mesh.points);
                assert!((found / known - 1.0).abs() < 1e-11, "{element} {energy:?}: {found} {known}");
            }
        }
    }
}

/// At rest no point feels a force. Under a homogeneous deformation the energy is that of the material and the points inside
/// are in equilibrium, with volume springs on domains and on patches.
#[test]
fn homogeneous_deformations_are_exact() {
    let mut random = Random(72);
    for (element, cells, size) in [("tri3", vec![4, 4], vec![1.0, 0.7]), ("tet4", vec![3, 3, 3], vec![1.0, 0.7, 0.9])] {
        let d = size.len();
        let mesh = shaken(element, &cells, &size, &mut random);
        let inside: Vec<usize> = (0..mesh.point_count())
            .filter(|p| mesh.point(*p).iter().zip(&size).all(|(x, size)| *x > 0.0 && *x < *size))
            .collect();
        let f = DMatrix::from_fn(d, d, |i, j| f64::from(u8::from(i == j)) + 0.2 * random.next());
        let x: Vec<f64> = mesh
            .points
            .chunks_exact(d)
            .flat_map(|x| (&f * DVector::from_column_slice(x)).data.as_vec().clone())
            .collect();
        let volume: f64 = size.iter().product();
        let material = solid(d, 0.45);
        for (of, volumes) in ENERGIES.iter().flat_map(|of| [(of, VolumeSprings::Points), (of, VolumeSprings::Patches)])
        {
            let network =
                network(&mesh, material, ExactFit { energy: *of, volume: volumes, large: true, ..EDGES }, &[]);
            let found = at(&network, &x) - at(&network, &mesh.points);
            let known = volume * energy(*of, material.moduli(), &f);
            // With patches, the part of λ of an energy with a slope of μ (1 − s) in the cells is the same in a homogeneous deformation.
            assert!((found / known - 1.0).abs() < 1e-10, "{element} {of:?} {volumes:?}: {found} {known}");
            let largest = |x: &[f64], points: &[usize]| {
                let mut force = vec![0.0; x.len()];
                assert!(network.forces(x, &mut force));
                points.iter().flat_map(|p| &force[p * d..(p + 1) * d]).fold(0.0f64, |most, f| most.max(f.abs()))
            };
            let every: Vec<usize> = (0..mesh.point_count()).collect();
            let size = largest(&x, &every);
            assert!(largest(&mesh.points, &every) < 1e-11 * size, "{element} {of:?} {volumes:?}");
            assert!(largest(&x, &inside) < 1e-11 * size, "{element} {of:?} {volumes:?}");
        }
    }
}

/// The forces are the differences of the energy, and the tangent those of the forces.
#[test]
fn forces_and_tangents_are_derivatives() {
    let mut random = Random(73);
    let mesh = shaken("tet4", &[2, 2, 2], &[1.0; 3], &mut random);
    let x: Vec<f64> = mesh.points.iter().map(|x| 1.05 * x + 0.05 * random.next()).collect();
    for energy in ENERGIES {
        let network = network(&mesh, solid(3, 0.4), ExactFit { energy, large: true, ..EDGES }, &[]);
        assert_derivatives_along(&format!("{energy:?}"), &network, &x, &mut random, [1e-7, 1e-6]);
    }
}

fn clamped(mesh: &Mesh) -> (Support, Vec<bool>) {
    held_where(mesh, |x| x[0] == 0.0)
}

/// Under a unit force on the side with the largest x.
fn pulled(mesh: &Mesh) -> Vec<f64> {
    let end = mesh.points.chunks_exact(mesh.dimension).fold(0.0f64, |most, x| most.max(x[0]));
    end_load(mesh, |x| x[0] == end)
}

/// Errors of the compliance relative to the truth: finite elements, patches, and patches with shear springs on edges.
fn errors(mesh: &Mesh, material: Material, truth: f64) -> [f64; 3] {
    let ((support, held), load) = (clamped(mesh), pulled(mesh));
    let of = |entries: &Entries| compliance(entries, &support, &load) / truth - 1.0;
    let cells = on_cells(mesh, material, VolumeSprings::Patches, &held);
    let edges = network(mesh, material, ExactFit { volume: VolumeSprings::Patches, ..EDGES }, &held);
    [
        of(&finite_elements(mesh, material.moduli())),
        of(&cells.stiffness(&mesh.points)),
        of(&edges.stiffness(&mesh.points)),
    ]
}

/// The cantilever 4 × 1 × 1 under a unit shear of its end, 4 cells across: 263 at ν = 0.3 and 249 at 0.4999 by twenty-node
/// hexahedra. With shear springs on edges the error is a tenth of that of the finite elements of the same mesh or less.
#[test]
fn a_cantilever_of_tetrahedra_is_right_to_two_percent() {
    for (nu, truth) in [(0.3, 263.0), (0.4999, 249.0)] {
        let mesh = shaken("tet4", &[16, 4, 4], &[4.0, 1.0, 1.0], &mut Random(74));
        let material = Material::new(1.0, nu, State::Solid).unwrap();
        let [bodies, patches, edges] = errors(&mesh, material, truth);
        println!("nu = {nu}: finite elements {bodies:.3}, patches {patches:.3}, edges {edges:.3}");
        assert!(bodies < -0.18 && patches < -0.1 && edges.abs() < 0.02, "{nu}: {bodies} {patches} {edges}");
    }
}

/// Cook's membrane in plane strain, E = 1, a unit force upwards on its end: 18.53 at ν = 0.4999. With shear springs on edges,
/// triangles err at most twice as much as quadratic triangles with as many unknowns.
#[test]
fn cooks_membrane_is_within_twice_the_error_of_quadratic_triangles() {
    let material = Material::for_body(2, 1.0, 0.4999, Some(Plane::Strain), None).unwrap();
    for n in [8, 16, 32] {
        let [bodies, patches, edges] = errors(&membrane("tri3", n), material, 18.53);
        let quadratic = membrane("tri6", n / 2);
        let (support, _) = clamped(&quadratic);
        let entries = finite_elements(&quadratic, material.moduli());
        let known = compliance(&entries, &support, &pulled(&quadratic)) / 18.53 - 1.0;
        println!("{n}: finite elements {bodies:.4}, patches {patches:.4}, edges {edges:.4}, tri6 {known:.4}");
        assert!(bodies < -0.6 && edges.abs() < 0.5 * patches.abs(), "{n}: {bodies} {patches} {edges}");
        assert!(edges.abs() < 2.0 * known.abs(), "{n}: {edges} {known}");
    }
}

/// The lowest 30 frequencies with shear springs on edges and volume springs on patches are those of quadratic hexahedra, one for
/// one: they neither add nor remove a frequency.
#[test]
fn edges_add_no_soft_motion() {
    for nu in [0.3, 0.4999] {
        let material = Material::new(1.0, nu, State::Solid).unwrap();
        let fine = grid("hex20", &[1.0; 3], &[4; 3]);
        let known = frequencies(&fine, &finite_elements(&fine, material.moduli()), &clamped(&fine).0);
        let mesh = shaken("tet4", &[8, 8, 8], &[1.0; 3], &mut Random(75));
        let (support, held) = clamped(&mesh);
        let edges = network(&mesh, material, ExactFit { volume: VolumeSprings::Patches, ..EDGES }, &held);
        let found = frequencies(&mesh, &edges.stiffness(&mesh.points), &support);
        let ratios: Vec<f64> = found.iter().zip(&known).map(|(a, b)| a / b).collect();
        println!("nu = {nu}: {ratios:.3?}");
        // An extra motion shifts all above it by one place.
        assert!(ratios.iter().all(|ratio| (0.95..1.15).contains(ratio)), "{nu}: {ratios:?}");
    }
}

/// The network as a material is the material.
#[test]
fn the_network_is_its_material() {
    let mesh = shaken("tet4", &[5, 5, 5], &[1.0; 3], &mut Random(76));
    let material = solid(3, 0.3);
    for volume in [VolumeSprings::Points, VolumeSprings::Patches] {
        let fit = ExactFit { volume, ..EDGES };
        let network = network(&mesh, material, fit, &[]);
        let found = network_material(&mesh, material, SpringOwners::Edges(fit), &network);
        assert!(found.distance < 1e-9, "{volume:?}: {}", found.distance);
    }
}

/// What has no such network is one error that says what is possible.
#[test]
fn what_edges_do_not_serve_is_refused() {
    let load = |element: &str, d: usize| grid(element, &vec![1.0; d], &vec![1; d]);
    for (element, d) in [("quad4", 2), ("hex8", 3), ("tet10", 3), ("tri6", 2)] {
        let error = edge_springs(&load(element, d), solid(d, 0.3), &EDGES).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        assert!(error.to_string().contains("linear tetrahedra") && error.to_string().contains(element), "{error}");
    }
    let mesh = load("tet4", 3);
    let error = edge_springs(&mesh, solid(3, 0.3), &ExactFit { volume: VolumeSprings::Cells, ..EDGES }).unwrap_err();
    assert!(error.to_string().contains("\"points\" or \"patches\""), "{error}");
    let block = &mesh.blocks[0];
    let error = fit_exact(&block.element, &mesh.points, &block.connectivity, solid(3, 0.3), &EDGES, &mut |_| {});
    assert_eq!(error.unwrap_err().kind(), ErrorKind::Unsupported);
    for (keys, key) in [("volume = \"cells\"", "fit[0].volume"), ("nonnegative = true", "fit[0].nonnegative")] {
        let text = format!(
            "[mesh]\nbox = {{ element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] }}\n[material]\nyoung = 1\npoisson = 0.3\n\
             [[fit]]\nobjective = \"exact\"\nshear = \"edges\"\n{keys}\n[[fix]]\ngroup = \"xmin\"\n"
        );
        let error = Scene::parse(&text, Path::new("edges.toml")).expect_err(keys);
        assert_eq!(error.key(), Some(key), "{error}");
    }
}
