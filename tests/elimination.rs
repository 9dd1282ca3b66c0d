//! The order of elimination: large meshes are dissected, small ones and those that it does not help keep approximate minimum degree, and
//! the solution is the same.

use crate::shapes::Random;
use crate::shapes::bodies::grid;
use faer::Side;
use faer::sparse::linalg::cholesky::{SymbolicCholeskyRaw, factorize_symbolic_cholesky};
use faer::sparse::{Pair, SymbolicSparseColMat};
use springfit_bodies::model::{Support, finite_elements};
use springfit_bodies::solve::{System, factor_cost};
use springfit_element::material::{Material, State};
use springfit_mesh::mesh::Mesh;

/// `Σ c²` over the columns of the factor by approximate minimum degree, for one unknown per point.
fn by_degree(mesh: &Mesh) -> f64 {
    let n = mesh.point_count();
    let mut pairs: Vec<Pair<usize, usize>> = (0..n).map(|p| Pair::new(p, p)).collect();
    for nodes in mesh.blocks.iter().flat_map(|block| block.cells()) {
        pairs
            .extend(nodes.iter().flat_map(|&a| nodes.iter().map(move |&b| Pair::new(a, b))).filter(|p| p.row != p.col));
    }
    let (pattern, _) = SymbolicSparseColMat::try_new_from_indices(n, n, &pairs).unwrap();
    let symbolic =
        factorize_symbolic_cholesky(pattern.as_ref(), Side::Lower, Default::default(), Default::default()).unwrap();
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(factor) => {
            factor.col_ptr().windows(2).map(|ends| ((ends[1] - ends[0]) as f64).powi(2)).sum()
        }
        SymbolicCholeskyRaw::Supernodal(factor) => (0..factor.n_supernodes())
            .flat_map(|s| {
                let (width, below) =
                    (factor.supernode_end()[s] - factor.supernode_begin()[s], factor.supernode(s).pattern().len());
                (1..=width).map(move |column| ((column + below) as f64).powi(2))
            })
            .sum(),
    }
}

fn mesh(element: &str, cells: &[usize]) -> Mesh {
    let size: Vec<f64> = cells.iter().map(|n| *n as f64).collect();
    let mut mesh = grid(element, &size, cells);
    let mut random = Random(1);
    mesh.points.iter_mut().for_each(|x| *x += 0.2 * random.next());
    mesh
}

/// The share of the operations that is left, at most, of jittered boxes.
#[test]
fn dissection_takes_a_part_of_the_operations_of_minimum_degree() {
    for (element, cells, share) in [
        ("hex8", vec![20; 3], 0.4),
        ("hex8", vec![28; 3], 0.36),
        ("tet4", vec![24; 3], 0.55),
        ("hex8", vec![8, 8, 60], 1.0),
        ("quad4", vec![150; 2], 0.9),
        ("tri3", vec![150; 2], 1.0),
        // Too small for it: the order of minimum degree.
        ("hex8", vec![4; 3], 1.0),
    ] {
        let mesh = mesh(element, &cells);
        let cost = factor_cost(&mesh).unwrap().operations / (mesh.dimension as f64).powi(3);
        let other = by_degree(&mesh);
        assert!(cost <= share * other, "{element} {cells:?}: {cost:e} of {other:e}, {:.3}", cost / other);
        if mesh.point_count() < 500 {
            assert_eq!(cost, other);
        }
    }
}

#[test]
fn every_order_gives_the_same_solution() {
    let material = Material::new(1e4, 0.3, State::Solid).unwrap().moduli();
    for (element, cells) in [("hex8", [12, 9, 14]), ("tet4", [9, 14, 8])] {
        let mesh = mesh(element, &cells);
        let mut support = Support::free(&mesh);
        let held: Vec<usize> = (0..mesh.point_count()).filter(|p| mesh.point(*p)[0] < 0.3).collect();
        support.fix(&held, &[0, 1, 2], 3);
        // Some points are held in one direction alone: their unknowns are not three.
        support.fix(&[mesh.point_count() - 1, mesh.point_count() - 4], &[1], 3);
        let entries = finite_elements(&mesh, material);
        let force: Vec<f64> = mesh.points.iter().map(|x| (3.0 * x).sin()).collect();
        let solve = |system: System| {
            let factor = system.cholesky().unwrap().unwrap();
            (system.solve(&factor, &force).0, system.solve_all(&factor, std::slice::from_ref(&force)).remove(0))
        };
        let (plain, once) = solve(System::new(&entries, &support).unwrap());
        let (placed, again) = solve(System::new(&entries, &support).unwrap().placed(&mesh.points, 3));
        // All points at one place, and places of other points: a bad order is no other answer.
        let (heaped, _) = solve(System::new(&entries, &support).unwrap().placed(&vec![0.0; mesh.points.len()], 3));
        let (strange, _) = solve(System::new(&entries, &support).unwrap().placed(&[f64::NAN; 6], 3));
        let size = plain.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        for other in [placed, once, again, heaped, strange] {
            let most = plain.iter().zip(&other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(most < 1e-10 * size, "{element}: {most:e} of {size:e}");
        }
    }
}
