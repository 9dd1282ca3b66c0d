//! What an explicit step costs on one core, forces and symplectic Euler's update, per tetrahedron of a box of a hundred thousand:
//! the stable neo-Hookean finite elements in their usual form and in one that no loop of this file beats; the network that is
//! the same body; that with volume springs on patches; springs with rest lengths and a volume spring; and the exact network as
//! it is without preparation. All in one run, in turn, so that what else the machine does meets all alike.
//! `cargo bench --bench steps`.

mod clock;

use clock::clock;
use springfit_bodies::model::{Elastic, Network, masses, patch_springs};
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{ExactEnergy, ExactFit, Fit, Objective, VolumeSprings, Weight, fit_cells, fit_exact};
use springfit_foundation::scalar::{Coordinates, CoordinatesWork, with_coordinates};
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use std::sync::Arc;

/// Cubes along an edge of the box, each six tetrahedra.
const SIDE: usize = 26;
const STEPS: usize = 60;
const ROUNDS: usize = 9;

/// A box of edge 1 m, its points moved by up to `jitter` of a cube.
fn mesh(jitter: f64) -> Mesh {
    let element = Arc::new(Element::load("tet4").expect("it is shipped"));
    let spec = BoxMesh { element, size: vec![1.0; 3], cells: vec![SIDE; 3], origin: vec![0.0; 3] };
    let mut mesh = spec.build().expect("tetrahedra fill a box");
    let mut state = 1u64;
    for x in &mut mesh.points {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *x += jitter / SIDE as f64 * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
    }
    mesh
}

/// A tetrahedron of the usual form: `∇N` of its last three nodes, and its volume.
struct Gradients {
    nodes: [u32; 4],
    gradients: [[f64; 3]; 3],
    volume: f64,
}

/// One with its stiffness of edges, `μ V ∇N_a·∇N_b`, rows of the last three nodes; `T = slope · det − pull`.
struct Metric {
    nodes: [u32; 4],
    metric: [[f64; 3]; 3],
    slope: f64,
    pull: f64,
}

/// Linear tetrahedra of `μ/2 (|F|² − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)²`.
struct FiniteElements<Cell> {
    cells: Vec<Cell>,
    lambda: f64,
    mu: f64,
    x: Vec<[f64; 4]>,
    force: Vec<[f64; 4]>,
}

/// `∇N` of the last three nodes, rows of the inverse of the edges' matrix, and the volume.
fn gradients(mesh: &Mesh, nodes: &[usize]) -> ([[f64; 3]; 3], f64) {
    let edge = |a: usize, k: usize| mesh.point(nodes[a + 1])[k] - mesh.point(nodes[0])[k];
    let inverse = nalgebra::Matrix3::from_fn(|k, a| edge(a, k)).try_inverse().expect("no cell is flat");
    let gradients = std::array::from_fn(|a| std::array::from_fn(|k| inverse[(a, k)]));
    (gradients, 1.0 / inverse.determinant() / 6.0)
}

impl<Cell> FiniteElements<Cell> {
    fn new(
        mesh: &Mesh,
        material: Material,
        cell: impl Fn([u32; 4], [[f64; 3]; 3], f64) -> Cell,
    ) -> FiniteElements<Cell> {
        let moduli = material.moduli();
        let cells = mesh.blocks[0].connectivity.chunks_exact(4).map(|nodes| {
            let (gradients, volume) = gradients(mesh, nodes);
            cell(std::array::from_fn(|a| nodes[a] as u32), gradients, volume)
        });
        let rows = vec![[0.0; 4]; mesh.point_count()];
        FiniteElements { cells: cells.collect(), lambda: moduli.lambda, mu: moduli.mu, x: rows.clone(), force: rows }
    }

    fn pack(&mut self, x: &[f64]) {
        self.x.iter_mut().zip(x.as_chunks::<3>().0).for_each(|(row, x)| row[..3].copy_from_slice(x));
        self.force.fill([0.0; 4]);
    }

    /// Forces of the rows are (z, x, y): cross products come so.
    fn unpack(&self, force: &mut [f64]) {
        let rows = force.as_chunks_mut::<3>().0.iter_mut().zip(&self.force);
        rows.for_each(|(force, row)| *force = [row[1], row[2], row[0]]);
    }
}

struct Pull<'a, Cell>(&'a mut FiniteElements<Cell>);

/// The edges from the first node.
#[inline(always)]
fn edges<C: Coordinates>(zero: C, nodes: &[u32; 4], x: &[[f64; 4]]) -> [C; 3] {
    let first = zero.load(&x[nodes[0] as usize]);
    let mut edges = [zero; 3];
    for a in 0..3 {
        edges[a] = zero.load(&x[nodes[a + 1] as usize]).minus(first);
    }
    edges
}

#[inline(always)]
fn turned<C: Coordinates>(a: [C; 3]) -> [C; 3] {
    [a[0].turned(), a[1].turned(), a[2].turned()]
}

/// `a_2 × a_3`, `a_3 × a_1`, `a_1 × a_2` as (z, x, y).
#[inline(always)]
fn normals<C: Coordinates>(a: [C; 3], t: [C; 3]) -> [C; 3] {
    [
        a[1].difference_of_products(t[2], t[1], a[2]),
        a[2].difference_of_products(t[0], t[2], a[0]),
        a[0].difference_of_products(t[1], t[0], a[1]),
    ]
}

#[inline(always)]
fn add<C: Coordinates>(nodes: &[u32; 4], own: [C; 3], force: &mut [[f64; 4]]) {
    for a in 0..3 {
        let at = &mut force[nodes[a + 1] as usize];
        own[a].load(at).plus(own[a]).store(at);
    }
    let at = &mut force[nodes[0] as usize];
    own[0].load(at).minus(own[0].plus(own[1]).plus(own[2])).store(at);
}

/// `P = μ F + U'(J) cof F`, `f_a = V P ∇N_a`.
impl CoordinatesWork for Pull<'_, Gradients> {
    type Output = ();

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) {
        let FiniteElements { cells, lambda, mu, x, force } = self.0;
        let (slope, pull) = (*lambda + *mu, *lambda + 2.0 * *mu);
        let force = &mut force[..x.len()];
        for Gradients { nodes, gradients: g, volume } in cells.iter() {
            let e = edges(zero, nodes, x);
            let mut f = [zero; 3];
            for l in 0..3 {
                f[l] = e[2].scaled(g[2][l]).plus_scaled(g[1][l], e[1]).plus_scaled(g[0][l], e[0]);
            }
            let t = turned(f);
            let u = turned(t);
            let n = normals(f, t);
            let tension = volume * (slope * u[0].dot(n[0]) - pull);
            let stress = volume * *mu;
            let mut own = [zero; 3];
            for l in 0..3 {
                let p = u[l].scaled(stress).plus_scaled(tension, n[l]);
                for a in 0..3 {
                    own[a] = if l == 0 { p.scaled(g[a][l]) } else { own[a].plus_scaled(g[a][l], p) };
                }
            }
            add(nodes, own, force);
        }
    }
}

/// `V F ∇N_a = Σ_b M_ab e_b/μ` and `V cof F ∇N_a = (e_a+1 × e_a+2)/6`: no deformation gradient is formed.
impl CoordinatesWork for Pull<'_, Metric> {
    type Output = ();

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) {
        let FiniteElements { cells, x, force, .. } = self.0;
        let force = &mut force[..x.len()];
        for Metric { nodes, metric: m, slope, pull } in cells.iter() {
            let e = edges(zero, nodes, x);
            let t = turned(e);
            let u = turned(t);
            let n = normals(e, t);
            let tension = slope * u[0].dot(n[0]) - pull;
            let mut own = [zero; 3];
            for a in 0..3 {
                own[a] = n[a].scaled(tension);
                for b in 0..3 {
                    own[a] = own[a].plus_scaled(m[a][b], u[b]);
                }
            }
            add(nodes, own, force);
        }
    }
}

/// Writes the energy's derivative.
type Forces<'a> = Box<dyn FnMut(&[f64], &mut [f64]) + 'a>;

/// A body in motion.
struct Moving<'a> {
    name: &'static str,
    forces: Forces<'a>,
    x: Vec<f64>,
    v: Vec<f64>,
    force: Vec<f64>,
}

impl Moving<'_> {
    /// `v ← v − h f/m`, `x ← x + h v`.
    fn step(&mut self, step: f64, inverse_masses: &[f64]) {
        (self.forces)(&self.x, &mut self.force);
        let states = self.x.iter_mut().zip(&mut self.v).zip(&self.force);
        for (((x, v), f), m) in states.zip(inverse_masses) {
            *v -= step * m * f;
            *x += step * *v;
        }
    }
}

fn linear(nodes: [u32; 4], g: [[f64; 3]; 3], volume: f64) -> Gradients {
    Gradients { nodes, gradients: g, volume }
}

fn of_network<'a>(network: &'a Network) -> Forces<'a> {
    let prepared = network.prepared();
    Box::new(move |x, force| assert!(prepared.forces(x, force)))
}

fn compare(title: &str, mesh: &Mesh) {
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    let moduli = material.moduli();
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let exact = |energy: ExactEnergy, volume: VolumeSprings| {
        let fit = ExactFit { energy, volume, large: true, ..ExactFit::default() };
        let cells = fit_exact(element, &mesh.points, connectivity, material, &fit, &mut |_| {});
        let mut network = Network::assemble(mesh, &[cells.expect("every cell has a volume")]);
        if volume == VolumeSprings::Patches {
            network.others.extend(patch_springs(mesh, material, &fit, &[]).expect("the cells are tetrahedra"));
        }
        network
    };
    let groups = ["edge".to_string(), "bulk".to_string()];
    let springs = Springs::select(element, Some(&groups)).expect("tet4 has these groups");
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
    let cells = fit_cells(element, &springs, &mesh.points, connectivity, moduli, &fit, &mut |_| {});
    let classical = Network::assemble(mesh, &[cells.expect("every cell has a volume")]);
    let stable = ExactEnergy::StableNeoHookean;
    let (points, patches) = (exact(stable, VolumeSprings::Points), exact(stable, VolumeSprings::Patches));
    let lawful = exact(ExactEnergy::NeoHookean, VolumeSprings::Points);

    let mut usual = FiniteElements::new(mesh, material, linear);
    let mut clever = FiniteElements::new(mesh, material, |nodes, g, volume| Metric {
        nodes,
        metric: std::array::from_fn(|a| {
            std::array::from_fn(|b| moduli.mu * volume * (0..3).map(|k| g[a][k] * g[b][k]).sum::<f64>())
        }),
        // U'(J) V ∂J/∂x_a, with J = det/6V and the gradient of det.
        slope: (moduli.lambda + moduli.mu) / (36.0 * volume),
        pull: (moduli.lambda + 2.0 * moduli.mu) / 6.0,
    });
    let models: Vec<(&'static str, Forces)> = vec![
        (
            "finite elements, usual form",
            Box::new(|x, force| {
                usual.pack(x);
                with_coordinates(Pull(&mut usual));
                usual.unpack(force);
            }),
        ),
        (
            "finite elements, best form",
            Box::new(|x, force| {
                clever.pack(x);
                with_coordinates(Pull(&mut clever));
                clever.unpack(force);
            }),
        ),
        ("exact", of_network(&points)),
        ("patches", of_network(&patches)),
        ("classical with volume springs", of_network(&classical)),
        ("exact, law with a logarithm", of_network(&lawful)),
        ("exact, not prepared", Box::new(|x, force| assert!(points.forces(x, force)))),
    ];
    let start: Vec<f64> = mesh.points.iter().map(|x| 1.01 * x + 1e-3 * (20.0 * x).sin()).collect();
    let mut all: Vec<Moving> = models
        .into_iter()
        .map(|(name, forces)| {
            let zero = vec![0.0; start.len()];
            Moving { name, forces, x: start.clone(), v: zero.clone(), force: zero }
        })
        .collect();
    for model in &mut all {
        (model.forces)(&start, &mut model.force);
    }
    let size = all[0].force.iter().fold(0.0f64, |size, f| size.max(f.abs()));
    for other in [1, 2, 6] {
        let pairs = all[0].force.iter().zip(&all[other].force);
        let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
        assert!(error < 1e-10, "{}: forces differ by {error:e}", all[other].name);
    }
    let inverse: Vec<f64> = masses(mesh, 1000.0, 1.0).iter().flat_map(|m| [1.0 / m; 3]).collect();
    let cells = mesh.cell_count() as f64;
    let mut runs = vec![Vec::new(); all.len()];
    for _ in 0..ROUNDS {
        for (model, runs) in all.iter_mut().zip(&mut runs) {
            let steps = if model.name.ends_with("not prepared") { 2 } else { STEPS };
            let from = clock();
            (0..steps).for_each(|_| model.step(1e-4, &inverse));
            runs.push(1e9 * (clock() - from) / steps as f64 / cells);
        }
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let ratio = |a: usize, b: usize| median(runs[a].iter().zip(&runs[b]).map(|(a, b)| a / b).collect());
    println!("{title}: {} tetrahedra, {} points, {} length springs", cells, mesh.point_count(), points.lengths.len());
    let from = clock();
    drop(points.prepared());
    println!("  preparation of the exact network: {:.1} ms", 1e3 * (clock() - from));
    println!("  {:30} {:>10} {:>10} {:>10}", "", "ns/tet", "to usual", "to best");
    for (i, model) in all.iter().enumerate() {
        assert!(model.x.iter().all(|x| x.abs() < 2.0), "{} ran away", model.name);
        println!("  {:30} {:10.2} {:10.2} {:10.2}", model.name, median(runs[i].clone()), ratio(i, 0), ratio(i, 1));
    }
}

fn main() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    one.install(|| {
        // A jittered box has springs along all of its edges, an even one none across its right angles.
        compare("jittered box", &mesh(0.1));
        compare("even box", &mesh(0.0));
        compare("jittered box, points numbered at random", &shuffled(mesh(0.1)));
    });
}

/// The same mesh with other numbers of points, and its cells in another order.
fn shuffled(mut mesh: Mesh) -> Mesh {
    let mut state = 7u64;
    let mut below = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let mut place: Vec<usize> = (0..mesh.point_count()).collect();
    (1..place.len()).for_each(|i| place.swap(i, below(i + 1)));
    let old = mesh.points.clone();
    for (point, x) in place.iter().zip(old.as_chunks::<3>().0) {
        mesh.points[3 * point..3 * point + 3].copy_from_slice(x);
    }
    let cells = &mut mesh.blocks[0].connectivity;
    cells.iter_mut().for_each(|p| *p = place[*p]);
    let (cells, _) = cells.as_chunks_mut::<4>();
    (1..cells.len()).for_each(|i| cells.swap(i, below(i + 1)));
    mesh
}
