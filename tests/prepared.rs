//! A prepared network pulls as the network does: on every element, with all kinds of springs, wherever its points are.

use crate::shapes::bodies::grid;
use crate::shapes::{Random, elements, loaded, materials, single, valid};
use rayon::prelude::*;
use springfit_bodies::model::{Elastic, LengthSpring, MeasureSpring, Network, SpringLaw, exact_network, patch_springs};
use springfit_element::element::{Element, SpringKind};
use springfit_element::material::{Material, State};
use springfit_element::springs::{Law, Measure, Patch, Springs, Squares, Turns};
use springfit_fit::fit::{
    CellFits, ExactEnergy, ExactFit, Fit, Objective, ShearSprings, VolumeSprings, Weight, fit_cells, fit_exact,
};
use springfit_foundation::scalar::{Coordinate, Coordinates, CoordinatesWork, with_coordinates};
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use std::sync::Arc;

/// Rounding of a force, as a share of what its springs would pull if they measured from zero: dozens of operations, each of 1e-16.
const ROUNDING: f64 = 1e-14;

/// What rounding of each degree of freedom's force is measured by.
fn sizes(network: &Network, x: &[f64]) -> Vec<f64> {
    let (d, mut sizes) = (network.dimension, vec![0.0; x.len()]);
    for spring in &network.lengths {
        let ends = spring.points.map(|p| &x[p * d..(p + 1) * d]);
        let length = springfit_element::springs::distance(ends[0], ends[1]);
        for p in spring.points {
            sizes[p * d..(p + 1) * d]
                .iter_mut()
                .for_each(|s| *s += spring.constant.abs() * (length + spring.rest.abs()));
        }
    }
    for spring in &network.others {
        let local: Vec<f64> = spring.points.iter().flat_map(|p| &x[p * d..(p + 1) * d]).copied().collect();
        let c = spring.measure.value(&local, d);
        let [_, tension, slope] = spring.pull(c);
        let gradient = spring.measure.gradient(&local, d);
        let steepest = gradient.iter().fold(0.0f64, |size, g| size.max(g.abs()));
        let size = steepest * (tension.abs() + slope.abs() * (c.abs() + spring.rest.abs()));
        for p in &spring.points {
            sizes[p * d..(p + 1) * d].iter_mut().for_each(|s| *s += size);
        }
    }
    sizes
}

/// The same forces at these positions, or none from both.
fn check_at(network: &Network, x: &[f64], name: &str) {
    let prepared = network.prepared();
    let (mut expected, mut found) = (vec![f64::NAN; x.len()], vec![f64::NAN; x.len()]);
    let sound = network.forces(x, &mut expected);
    assert_eq!(prepared.forces(x, &mut found), sound, "{name}");
    if !sound {
        return;
    }
    for ((a, b), size) in found.iter().zip(&expected).zip(sizes(network, x)) {
        assert!((a - b).abs() <= ROUNDING * size, "{name}: {a} {b}, {:.1e}", (a - b).abs() / size);
    }
}

/// The same near rest, far from it, and inside out.
fn check(network: &Network, points: &[f64], random: &mut Random, name: &str) {
    check_at(network, points, name);
    for away in [0.01, 0.2, 1.0] {
        let x: Vec<f64> = points.iter().map(|x| 1.1 * x + away * random.next()).collect();
        check_at(network, &x, name);
    }
    let mirrored: Vec<f64> =
        points.iter().enumerate().map(|(i, x)| if i % network.dimension == 0 { -x } else { *x }).collect();
    check_at(network, &mirrored, name);
}

/// Two cells along each axis, points moved by up to a tenth of a cell; none of an element whose cells fill no box.
fn boxed(element: &Arc<Element>, random: &mut Random) -> Option<Mesh> {
    let d = element.dimension();
    let spec = BoxMesh { element: element.clone(), size: vec![1.0; d], cells: vec![2; d], origin: vec![0.0; d] };
    let mut mesh = spec.build().ok()?;
    let order = element.nodes() as f64 / element.cell.corners().len() as f64;
    mesh.points.iter_mut().for_each(|x| *x += 0.05 / order * random.next());
    Some(mesh)
}

fn exact(mesh: &Mesh, material: Material, fit: ExactFit) -> Option<CellFits> {
    let block = &mesh.blocks[0];
    fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {}).ok()
}

/// With all groups of the element: edges, diagonals, areas, volumes, what there is.
fn classical(mesh: &Mesh, material: Material) -> Network {
    let block = &mesh.blocks[0];
    let names: Vec<String> = block.element.springs.iter().map(|g| g.name.clone()).collect();
    let springs = Springs::select(&block.element, Some(&names)).unwrap();
    let fit = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
    let moduli = material.moduli();
    let fits =
        fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {}).unwrap();
    Network::assemble(mesh, &[fits])
}

const ENERGIES: [ExactEnergy; 3] =
    [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean, ExactEnergy::StableMooneyRivlin { share: 0.3 }];

#[test]
fn prepared_networks_pull_as_networks_of_every_element() {
    let mut kinds = 0;
    for element in elements().into_iter().map(Arc::new) {
        let mut random = Random(71);
        let meshes = [Some(single(&element, &valid(&element, &mut random))), boxed(&element, &mut random)];
        for mesh in meshes.iter().flatten().filter(|mesh| mesh.point_count() < 60) {
            for material in materials(element.dimension()).into_iter().filter(|m| m.poisson() >= 0.0) {
                check(&classical(mesh, material), &mesh.points, &mut random, &format!("{} classical", element.name));
                for energy in ENERGIES {
                    for volume in [VolumeSprings::Points, VolumeSprings::Cells, VolumeSprings::Patches] {
                        let fit =
                            ExactFit { energy, volume, large: volume == VolumeSprings::Points, ..ExactFit::default() };
                        let Some(cells) = exact(mesh, material, fit) else { continue };
                        let mut network = Network::assemble(mesh, &[cells]);
                        if volume == VolumeSprings::Patches {
                            let held: Vec<bool> = (0..mesh.point_count()).map(|p| p % 3 == 0).collect();
                            let Ok(patches) = patch_springs(mesh, material, &fit, &held) else { continue };
                            network.others.extend(patches);
                        }
                        kinds += 1;
                        let name = format!("{} {energy:?} {volume:?}", element.name);
                        check(&network, &mesh.points, &mut random, &name);
                    }
                }
            }
        }
    }
    assert!(kinds > 300, "{kinds}");
}

/// Triangles and lines in space have springs that no cell of theirs fills.
#[test]
fn prepared_networks_pull_as_networks_in_space() {
    let mut random = Random(72);
    for element in elements().into_iter().filter(|e| e.dimension() < 3 && e.nodes() == e.dimension() + 1) {
        let flat = valid(&element, &mut random);
        let d = element.dimension();
        let x: Vec<f64> = flat.chunks_exact(d).flat_map(|x| [x[0], *x.get(1).unwrap_or(&0.3), 0.4 * x[0]]).collect();
        let element = Arc::new(element.in_space(3));
        let mesh = single(&element, &x);
        for material in materials(d) {
            for large in [false, true] {
                let fit = ExactFit { large, ..ExactFit::default() };
                let Some(cells) = exact(&mesh, material, fit) else { continue };
                let network = Network::assemble(&mesh, &[cells]);
                check(&network, &mesh.points, &mut random, &format!("{} in space", element.name));
            }
        }
    }
}

fn cube() -> Mesh {
    let element = loaded("tet4");
    boxed(&element, &mut Random(73)).unwrap()
}

fn spring(measure: Measure, points: Vec<usize>, rest: f64) -> MeasureSpring {
    let kind = SpringKind::Measure;
    MeasureSpring { kind, points: points.into(), constant: 3.0, rest, measure, law: None }
}

/// Angles, lengths with laws, contents of the same cell in other orders, and patches of unequal shares that count a cell often.
#[test]
fn springs_of_any_kind_are_kept() {
    let mesh = cube();
    let mut random = Random(74);
    let mut network = classical(&mesh, Material::new(1e1, 0.3, State::Solid).unwrap());
    let angle = Measure::of_kind(SpringKind::Angle, 3, 3).unwrap();
    network.others.push(spring(Measure::Function(Arc::new(angle.into())), vec![3, 0, 7], 0.4));
    let law = Arc::new(Law::parse("k*s + m*s^3").unwrap());
    let law = Some(Box::new(SpringLaw::new(law, &[2.0, 5.0])));
    let lawful = MeasureSpring { law: law.clone(), ..spring(Measure::Length, vec![5, 2], 0.4) };
    network.others.push(lawful);
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let cell = |c: usize| connectivity[4 * c..4 * c + 4].to_vec();
    let turned = |c: usize| [1, 0, 3, 2].map(|a| connectivity[4 * c + a]).to_vec();
    let content = Measure::Content(element.clone());
    for (points, rest) in [(cell(1), 0.02), (cell(1), 0.03), (turned(1), 0.01), (cell(5), 0.0)] {
        network.others.push(spring(content.clone(), points.clone(), rest));
        network.others.push(MeasureSpring { law: law.clone(), ..spring(content.clone(), points, 0.05) });
    }
    for (count, share) in [(3, 0.25), (5, 0.25), (7, 0.7), (2, -0.1), (6, 0.25), (9, 0.25), (8, 0.25)] {
        let mut points: Vec<usize> = (0..count).flat_map(cell).collect();
        points.sort_unstable();
        points.dedup();
        let place = |p: &usize| points.binary_search(p).unwrap();
        let cells = (0..count).chain([0, 1]).map(|c| (cell(c).iter().map(place).collect(), share)).collect();
        let patch = Measure::Patch(Arc::new(Patch { element: element.clone(), cells }));
        network.others.push(spring(patch, points, 0.1));
    }
    // Squared distances in common with the next spring, of another pair, and of the whole list; turns of one triangle, of another, and of hinges.
    for (pairs, weights) in [
        ([[0, 1], [1, 2], [0, 2]], [1.0, -2.0, 0.5]),
        ([[0, 1], [1, 2], [0, 2]], [0.3, 0.1, 0.7]),
        ([[0, 1], [1, 2], [0, 3]], [0.3, 0.1, 0.7]),
    ] {
        let squares = Squares::new(pairs.iter().map(|pair| &pair[..]).zip(weights), 4).unwrap();
        network.others.push(spring(Measure::Squares(Box::new(squares)), vec![4, 9, 2, 17], 0.3));
    }
    for points in [vec![0, 1, 4, 20, 11, 25], vec![0, 1, 4, 20, 11, 25], vec![3, 1, 4, 20, 11, 25]] {
        let turns = Turns::of_triangle([0.4, -0.3, 1.2]);
        network.others.push(spring(Measure::Turns(Box::new(turns)), points.clone(), 0.2));
        network.others.push(spring(Measure::Turns(Box::new(Turns::of_hinge())), points[..4].to_vec(), 0.1));
    }
    check(&network, &mesh.points, &mut random, "all kinds");
    // Each kind by itself, so that one does not hide another.
    for s in 0..network.others.len() {
        let alone = Network { lengths: Vec::new(), others: vec![network.others[s].clone()], ..network };
        check(&alone, &mesh.points, &mut random, &format!("spring {s}"));
    }
    let energy = |model: &dyn Elastic| (model.energy(&mesh.points), model.respond(&mesh.points).unwrap().force);
    assert_eq!(energy(&network), energy(&network.prepared()));
}

/// Numbers of points do not matter, nor points that no spring touches.
#[test]
fn numbers_of_points_do_not_matter() {
    let mut mesh = cube();
    let mut random = Random(75);
    let count = mesh.point_count();
    // 27 points: 10 has no factor in common.
    let stride = 10;
    assert_eq!(count, 27);
    let place: Vec<usize> = (0..count).map(|p| 3 + p * stride % count).collect();
    let mut points = vec![0.7; (count + 5) * 3];
    for (p, x) in mesh.points.chunks_exact(3).enumerate() {
        points[place[p] * 3..place[p] * 3 + 3].copy_from_slice(x);
    }
    mesh.blocks[0].connectivity.iter_mut().for_each(|p| *p = place[*p]);
    mesh.points = points;
    let material = Material::new(1.0, 0.4, State::Solid).unwrap();
    let fit = ExactFit { volume: VolumeSprings::Patches, ..ExactFit::default() };
    let mut network = exact_network(&mesh, &material.into(), &fit, &[]).unwrap();
    network.lengths.extend(classical(&mesh, material).lengths);
    check(&network, &mesh.points, &mut random, "renumbered");
    let mut force = vec![1.0; mesh.points.len()];
    assert!(network.prepared().forces(&mesh.points, &mut force));
    assert!(force[..9].iter().chain(&force[(count + 3) * 3..]).all(|f| *f == 0.0));
}

/// Where a network has no force neither has it prepared.
#[test]
fn what_has_no_force_is_said() {
    let bar = |rest: f64| Network {
        dimension: 3,
        lengths: vec![LengthSpring { points: [0, 1], constant: 2.0, rest }],
        others: Vec::new(),
    };
    let met = [0.5; 6];
    assert!(!bar(1.0).prepared().forces(&met, &mut [0.0; 6]));
    assert!(bar(0.0).prepared().forces(&met, &mut [0.0; 6]));
    check_at(&bar(1.0), &met, "met");
    check_at(&bar(0.0), &met, "met without a rest length");
    let mesh = cube();
    let material = Material::new(1.0, 0.4, State::Solid).unwrap();
    for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean] {
        for volume in [VolumeSprings::Points, VolumeSprings::Patches] {
            let fit = ExactFit { energy, volume, ..ExactFit::default() };
            let network = exact_network(&mesh, &material.into(), &fit, &[]).unwrap();
            for fault in [f64::NAN, f64::INFINITY, 1e200] {
                let mut x = mesh.points.clone();
                x[4] = fault;
                let mut force = vec![0.0; x.len()];
                assert!(
                    !network.prepared().forces(&x, &mut force)
                        || force.iter().any(|f| !f.is_finite() || f.abs() > 1e100)
                );
                assert!(!network.forces(&x, &mut force) || force.iter().any(|f| !f.is_finite() || f.abs() > 1e100));
            }
            // A body inside out has no logarithm of its volume.
            let mirrored: Vec<f64> = mesh.points.iter().map(|x| -x).collect();
            let expected = energy == ExactEnergy::StableNeoHookean;
            assert_eq!(network.prepared().forces(&mirrored, &mut vec![0.0; mirrored.len()]), expected);
        }
    }
    assert!(Network { dimension: 2, ..Network::default() }.prepared().forces(&[1.0; 4], &mut [3.0; 4]));
}

struct Operations<N>([[N; 4]; 4], N);

impl<N: Coordinate> CoordinatesWork<N> for Operations<N> {
    type Output = Vec<[N; 4]>;

    fn run<C: Coordinates<N>>(self, zero: C) -> Vec<[N; 4]> {
        let Operations(given, factor) = self;
        let [a, b, c, d] = given.map(|x| zero.load(&x));
        let stored = |x: C| {
            let mut to = [N::zero(); 4];
            x.store(&mut to);
            to
        };
        let mut single = [0.0; 4];
        a.store_single(&mut single);
        let vectors = [
            a.plus(b),
            a.minus(b),
            a.times(b),
            a.scaled(factor),
            a.plus_scaled(factor, b),
            a.plus_products(b, c),
            a.turned(),
            a.difference_of_products(b, c, d),
            C::sums([a, b, c, d]),
            zero.load_single(&single),
        ];
        vectors.map(stored).into_iter().chain([[a.dot(b); 4]]).collect()
    }
}

/// With and without registers of the machine, and by hand: products may be fused, which is within a rounding of their terms.
fn check_registers<N: Coordinate>() {
    let mut random = Random(76);
    for _ in 0..50 {
        let given: [[N; 4]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| N::of(random.next())));
        let [a, b, c, d] = given.map(|x| x.map(N::wide));
        let factor = N::of(random.next());
        let f = factor.wide();
        let each = |f: &dyn Fn(usize) -> f64| -> [f64; 4] { std::array::from_fn(f) };
        let expected = [
            each(&|k| a[k] + b[k]),
            each(&|k| a[k] - b[k]),
            each(&|k| a[k] * b[k]),
            each(&|k| f * a[k]),
            each(&|k| a[k] + f * b[k]),
            each(&|k| a[k] + b[k] * c[k]),
            [a[1], a[2], a[0], a[3]],
            each(&|k| a[k] * b[k] - c[k] * d[k]),
            [a, b, c, d].map(|x| x.iter().sum()),
            each(&|k| f64::from(a[k] as f32)),
            [a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; 4],
        ];
        let rounding = 8.0 * N::epsilon().wide();
        for found in [with_coordinates(Operations(given, factor)), Operations(given, factor).run([N::zero(); 4])] {
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found.wide() - expected).abs() < rounding, "{found:?} {expected}");
            }
        }
    }
}

#[test]
fn registers_compute_what_arrays_do() {
    check_registers::<f64>();
    check_registers::<f32>();
}

/// What one evaluation leaves in memory is not seen by the next, by other threads neither.
#[test]
fn evaluations_do_not_depend_on_those_before() {
    let mesh = cube();
    let material = Material::new(1.0, 0.4, State::Solid).unwrap();
    let fit = ExactFit { volume: VolumeSprings::Patches, energy: ExactEnergy::NeoHookean, ..ExactFit::default() };
    let network = exact_network(&mesh, &material.into(), &fit, &[]).unwrap();
    let prepared = network.prepared();
    let forces = |scale: f64| {
        let x: Vec<f64> = mesh.points.iter().map(|x| x * scale).collect();
        let mut force = vec![0.0; x.len()];
        prepared.forces(&x, &mut force);
        force
    };
    let (first, forces) = (forces(1.2), &forces);
    forces(-1.0);
    assert_eq!(first, forces(1.2));
    let from_threads: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let all: Vec<_> =
            (0..8).map(|i| scope.spawn(move || (i, forces(if i % 2 == 0 { 1.2 } else { 0.9 })))).collect();
        let all = all.into_iter().map(|thread| thread.join().unwrap());
        all.filter(|(i, _)| i % 2 == 0).map(|(_, force)| force).collect()
    });
    assert!(from_threads.iter().all(|force| *force == first));
}

/// Networks of 20 000 springs and more are evaluated in parts: on rest lengths, of exact networks with patches, and on the domains of edges.
#[test]
fn parts_of_large_networks_give_the_same_bits_on_any_number_of_threads() {
    let material = Material::new(1e4, 0.4, State::Solid).unwrap();
    let mut random = Random(5);
    let boxed = |element: &str, cells: usize, random: &mut Random| {
        let mut mesh = grid(element, &[1.0; 3], &[cells; 3]);
        mesh.points.iter_mut().for_each(|x| *x += 0.1 / cells as f64 * random.next());
        mesh
    };
    let (tetrahedra, hexahedra) = (boxed("tet4", 14, &mut random), boxed("hex8", 12, &mut random));
    let with_patches = |shear: ShearSprings| {
        let fit = ExactFit { volume: VolumeSprings::Patches, shear, large: true, ..ExactFit::default() };
        exact_network(&tetrahedra, &material.into(), &fit, &[]).unwrap()
    };
    for (name, mesh, network) in [
        ("classical", &tetrahedra, classical(&tetrahedra, material)),
        ("patches", &tetrahedra, with_patches(ShearSprings::Cells)),
        ("domains of edges", &tetrahedra, with_patches(ShearSprings::Edges)),
        (
            "hexahedra",
            &hexahedra,
            Network::assemble(&hexahedra, &[exact(&hexahedra, material, ExactFit::default()).unwrap()]),
        ),
    ] {
        assert!(network.len() > 20_000, "{name}: {}", network.len());
        check(&network, &mesh.points, &mut random, name);
        let x: Vec<f64> = mesh.points.iter().map(|x| 1.05 * x + 0.01 * random.next()).collect();
        let forces = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut force = vec![0.0; x.len()];
            assert!(pool.install(|| network.prepared().forces(&x, &mut force)));
            force.iter().map(|f| f.to_bits()).collect::<Vec<_>>()
        });
        assert!(forces.iter().all(|other| *other == forces[0]), "{name}");
        // Evaluations of one network on threads that also evaluate its parts.
        let prepared = network.prepared();
        let all: Vec<Vec<u64>> = (0..8)
            .into_par_iter()
            .map(|_| {
                let mut force = vec![0.0; x.len()];
                assert!(prepared.forces(&x, &mut force));
                force.iter().map(|f| f.to_bits()).collect()
            })
            .collect();
        assert!(all.iter().all(|other| *other == forces[0]), "{name}");
    }
}
