//! Natural vibrations: against closed forms, and against dense eigenvalues of the same matrices.

use crate::kit::shipped;
use crate::messages::reads;
use crate::shapes::bodies::grid;
use crate::shapes::loaded;
use crate::shapes::statics::support_at;
use nalgebra::DMatrix;
use springfit_bodies::model::{ConsistentMasses, LengthSpring, Network, Support, finite_elements, masses};
use springfit_bodies::solve::{Factor, Modes, System, eigenvalues, lowest_modes};
use springfit_element::element::SHIPPED;
use springfit_element::material::Material;
use springfit_mesh::mesh::{BoxMesh, Mesh, Selection};
use springfit_numerics::dense::ratios;
use std::f64::consts::PI;

/// A model held somewhere.
struct Model {
    system: System,
    factor: Factor,
    masses: Vec<f64>,
    dimension: usize,
}

impl Model {
    fn new(entries: &springfit_bodies::model::Entries, support: &Support, masses: Vec<f64>, dimension: usize) -> Model {
        let system = System::new(entries, support).unwrap();
        let factor = system.factorize().unwrap().unwrap();
        Model { system, factor, masses, dimension }
    }

    /// Springs along x between neighbours of a row of points, in the plane; infinite masses are held.
    fn chain(constants: &[f64], masses: &[f64]) -> Model {
        let spring = |(i, &constant): (usize, &f64)| LengthSpring { points: [i, i + 1], constant, rest: 1.0 };
        let lengths = constants.iter().enumerate().filter(|(_, k)| **k != 0.0).map(spring).collect();
        let network = Network { dimension: 2, lengths, others: Vec::new() };
        let points: Vec<f64> = (0..masses.len()).flat_map(|i| [i as f64, 0.0]).collect();
        let held = |m: &f64| [(*m == f64::INFINITY).then_some(0.0), Some(0.0)];
        let support = Support { prescribed: masses.iter().flat_map(held).collect() };
        Model::new(&network.stiffness(&points), &support, masses.to_vec(), 2)
    }

    /// Finite elements of 1 kg/m³ and 1 Pa, held where x = 0.
    fn body(mesh: &Mesh, poisson: f64) -> Model {
        let material = Material::for_body(3, 1.0, poisson, None, None).unwrap();
        let held: Vec<usize> = (0..mesh.point_count()).filter(|&p| mesh.point(p)[0] == 0.0).collect();
        let support = support_at(mesh, &held);
        Model::new(&finite_elements(mesh, material.moduli()), &support, masses(mesh, 1.0, 1.0), 3)
    }

    fn modes(&self, count: usize) -> Modes {
        lowest_modes(&self.system, &self.factor, &self.masses, self.dimension, count).unwrap()
    }

    fn error(&self, count: usize) -> String {
        lowest_modes(&self.system, &self.factor, &self.masses, self.dimension, count).unwrap_err().to_string()
    }

    /// On the free degrees of freedom.
    fn mass(&self) -> Vec<f64> {
        self.system.free().iter().map(|dof| self.masses[dof / self.dimension]).collect()
    }

    /// All squares, from `M^(−½) K M^(−½)` as a dense matrix, ascending.
    fn dense_squares(&self) -> Vec<f64> {
        let (n, mass) = (self.system.size(), self.mass());
        let mut matrix = DMatrix::zeros(n, n);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0 / mass[j].sqrt();
            let column = self.system.apply(&unit);
            (0..n).for_each(|i| matrix[(i, j)] = column[i] / mass[i].sqrt());
        }
        let mut squares: Vec<f64> = eigenvalues(matrix).iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        squares
    }

    /// Shapes are M-orthonormal, zero where held, and solve the equation.
    fn check(&self, modes: &Modes, residual: f64) {
        let mass = self.mass();
        let free = |shape: &[f64]| self.system.free().iter().map(|&dof| shape[dof]).collect::<Vec<f64>>();
        let shapes: Vec<Vec<f64>> = modes.shapes.iter().map(|shape| free(shape)).collect();
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate() {
                let product: f64 = (0..a.len()).map(|k| a[k] * mass[k] * b[k]).sum();
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-10, "{i} {j}: {product}");
            }
            let force = self.system.apply(a);
            let left: f64 = (0..a.len()).map(|k| (force[k] - modes.squares[i] * mass[k] * a[k]).powi(2)).sum();
            let size: f64 = force.iter().map(|f| f * f).sum();
            assert!((left / size).sqrt() < residual, "mode {i}: {:e}", (left / size).sqrt());
            let whole = &modes.shapes[i];
            assert_eq!(whole.len(), self.masses.len() * self.dimension);
            let nonzero = whole.iter().filter(|x| **x != 0.0).count();
            assert!(nonzero <= a.iter().filter(|x| **x != 0.0).count(), "a held point moves");
        }
    }
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} instead of {expected}");
}

/// n masses m between walls: `ω_j = 2 √(k/m) sin(jπ / (2(n + 1)))`, Lagrange's loaded string.
#[test]
fn a_chain_between_walls_has_lagranges_frequencies() {
    let (k, m) = (300.0, 0.02);
    for n in [1, 2, 3, 8, 60, 150] {
        let mut row = vec![m; n + 2];
        (row[0], row[n + 1]) = (f64::INFINITY, f64::INFINITY);
        let chain = Model::chain(&vec![k; n + 1], &row);
        for count in (1..=n.min(20)).chain([n / 2, n]) {
            let modes = chain.modes(count);
            assert_eq!((modes.squares.len(), modes.shapes.len()), (count, count));
            chain.check(&modes, 1e-8);
            for (j, (frequency, square)) in modes.frequencies().iter().zip(&modes.squares).enumerate() {
                let omega = 2.0 * (k / m).sqrt() * ((j + 1) as f64 * PI / (2.0 * (n + 1) as f64)).sin();
                assert_near(*square, omega * omega, 1e-10);
                assert_near(*frequency, omega / (2.0 * PI), 1e-10);
            }
        }
    }
}

/// Wall, spring a, mass m, spring b, mass p: `m p ω⁴ − ((a + b) p + b m) ω² + a b = 0`.
#[test]
fn two_masses_swing_as_their_quadratic_says() {
    let (a, b, m, p) = (5.0f64, 0.3, 2.0, 0.01);
    let model = Model::chain(&[a, b], &[f64::INFINITY, m, p]);
    let half = ((a + b) * p + b * m) / (2.0 * m * p);
    let root = (half * half - a * b / (m * p)).sqrt();
    let modes = model.modes(2);
    assert_near(modes.squares[0], half - root, 1e-12);
    assert_near(modes.squares[1], half + root, 1e-12);
    model.check(&modes, 1e-10);
}

/// Twelve chains alike side by side: each of Lagrange's frequencies comes twelve times.
#[test]
fn every_copy_of_a_frequency_is_found() {
    let (copies, n) = (12, 40);
    let (mut constants, mut row) = (Vec::new(), Vec::new());
    for _ in 0..copies {
        constants.extend(vec![1.0; n + 1]);
        constants.push(0.0);
        row.push(f64::INFINITY);
        row.extend(vec![1.0; n]);
        row.push(f64::INFINITY);
    }
    constants.pop();
    let model = Model::chain(&constants, &row);
    for count in (1..=20).chain([30, 100]) {
        let modes = model.modes(count);
        model.check(&modes, 1e-8);
        for (i, square) in modes.squares.iter().enumerate() {
            let j = (i / copies + 1) as f64;
            assert_near(*square, (2.0 * (j * PI / (2.0 * (n + 1) as f64)).sin()).powi(2), 1e-9);
        }
    }
}

/// A square section bends to either side alike.
#[test]
fn square_bars_have_pairs_of_bending_modes() {
    for (size, cells) in [([3.0, 1.0, 1.0], [6, 2, 2]), ([1.0, 1.0, 1.0], [4, 4, 4]), ([1.0, 1.0, 1.0], [1, 1, 1])] {
        let model = Model::body(&grid("hex8", &size, &cells), 0.3);
        let dense = model.dense_squares();
        for count in (1..=20).filter(|count| *count <= model.system.size()) {
            let modes = model.modes(count);
            assert_eq!(modes, model.modes(count), "the same input gives the same bits");
            model.check(&modes, 1e-8);
            modes.squares.iter().zip(&dense).for_each(|(found, dense)| assert_near(*found, *dense, 1e-9));
            // A single cell twists before it bends.
            if count > 1 && cells[0] > 1 {
                assert_near(modes.squares[1], modes.squares[0], 1e-8);
            }
        }
    }
}

/// Without Poisson's effect the body swings lengthwise as its axis does: N elements of lumped mass have
/// `ω = (2N/L) √(E/ρ) sin(π/4N)`, half of Lagrange's chain of 2N − 1 masses; that is `1 − (π/4N)²/6` of the rod's
/// `f = √(E/ρ) / 4L`.
#[test]
fn a_bar_swings_lengthwise_as_a_rod() {
    let (length, cells) = (2.0, 8);
    let model = Model::body(&grid("hex8", &[length, 0.8, 0.8], &[cells, 3, 3]), 0.0);
    let modes = model.modes(10);
    let along = |shape: &Vec<f64>| shape.chunks(3).zip(&model.masses).map(|(u, m)| m * u[0] * u[0]).sum::<f64>();
    let mode = modes.shapes.iter().position(|shape| along(shape) > 0.999).unwrap();
    let angle = PI / (4 * cells) as f64;
    assert_near(modes.squares[mode].sqrt(), 2.0 * cells as f64 / length * angle.sin(), 1e-10);
    assert_near(modes.frequencies()[mode], 0.25 / length * (1.0 - angle * angle / 6.0), 1e-5);
    model.check(&modes, 1e-8);
}

/// With the consistent matrix the same bar has `ω² = 6 (E/ρh²) (1 − cos kh)/(2 + cos kh)` with `kL = π/2`: above the rod's, as
/// that of lumped masses is below.
#[test]
fn a_bar_with_the_consistent_matrix_swings_as_linear_elements_do() {
    let (length, cells) = (2.0, 8);
    let mesh = grid("hex8", &[length, 0.8, 0.8], &[cells, 3, 3]);
    let model = Model::body(&mesh, 0.0);
    let matrix = ConsistentMasses::of_mesh(&mesh, 1.0, 1.0).unwrap();
    let modes = lowest_modes(&model.system, &model.factor, &matrix, 3, 10).unwrap();
    let along = |shape: &Vec<f64>| {
        matrix.product(shape, 3).unwrap().iter().zip(shape).step_by(3).map(|(f, u)| f * u).sum::<f64>()
    };
    let mode = modes.shapes.iter().position(|shape| along(shape) > 0.999).unwrap();
    let h = length / cells as f64;
    let cosine = (PI / 2.0 * h / length).cos();
    assert_near(modes.squares[mode], 6.0 / (h * h) * (1.0 - cosine) / (2.0 + cosine), 1e-9);
    let rod = (PI / 2.0 / length).powi(2);
    // The errors k²h²/24 of both cancel halfway (Goudreau and Taylor 1973): k⁴h⁴/240 is left.
    let half = matrix.blended(&model.masses, 0.5).unwrap();
    let halfway = lowest_modes(&model.system, &model.factor, &half, 3, 10).unwrap();
    assert!(halfway.squares.iter().any(|square| (square / rod - 1.0).abs() < 1e-5), "{:?} {rod}", halfway.squares);
    assert!(
        modes.squares[mode] > rod && model.modes(10).squares.iter().any(|square| (0.99 * rod..rod).contains(square))
    );
}

/// `K φ = ω² M φ` with matrices between the consistent one and lumped masses, against dense matrices that are added up here; on all
/// elements, whose boxes are bent.
#[test]
fn modes_with_a_mass_matrix_are_those_of_dense_matrices() {
    let mut bodies = 0;
    for file in SHIPPED {
        let element = loaded(file.name);
        let (name, d) = (element.name.to_string(), element.dimension());
        let (size, cells) = (vec![1.0; d], vec![if element.nodes() > 10 { 1 } else { 2 }; d]);
        let Ok(mut mesh) = (BoxMesh { element, size, cells, origin: vec![0.0; d] }).build() else { continue };
        if d < 2 {
            continue;
        }
        bodies += 1;
        for x in mesh.points.chunks_exact_mut(d) {
            x[0] *= 1.0 + 0.2 * x[1];
            x[1] += 0.1 * x[0] * x[0];
        }
        let material = Material::for_body(d, 1.0, 0.3, None, None).unwrap();
        let held: Vec<usize> = (0..mesh.point_count()).filter(|&p| mesh.point(p)[0] == 0.0).collect();
        let support = support_at(&mesh, &held);
        let lumped = springfit_bodies::model::lumped_masses(&mesh, 2.0, 1.0, springfit_bodies::model::Lumping::Hrz);
        let model = Model::new(&finite_elements(&mesh, material.moduli()), &support, lumped.clone(), d);
        let consistent = ConsistentMasses::of_mesh(&mesh, 2.0, 1.0).unwrap();
        assert_near(consistent.total(), lumped.iter().sum(), 1e-12);
        for share in [0.0, 0.3, 1.0] {
            let matrix = consistent.blended(&lumped, share).unwrap();
            let (free, n) = (model.system.free(), model.system.size());
            let mut dense = DMatrix::zeros(n, n);
            for (a, b, value) in matrix.entries() {
                for k in 0..d {
                    let place = |p: usize| free.binary_search(&(p * d + k)).ok();
                    if let (Some(i), Some(j)) = (place(a), place(b)) {
                        dense[(i, j)] += value;
                    }
                }
            }
            let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
            let stiffness = DMatrix::from_vec(n, n, (0..n).flat_map(|j| model.system.apply(&unit(j))).collect());
            let squares = ratios(&stiffness, dense).unwrap();
            let count = 8.min(n);
            let modes = lowest_modes(&model.system, &model.factor, &matrix, d, count).unwrap();
            modes.squares.iter().zip(&squares).for_each(|(found, dense)| assert_near(*found, *dense, 1e-9));
            for (i, a) in modes.shapes.iter().enumerate() {
                let force = matrix.product(a, d).unwrap();
                for (j, b) in modes.shapes.iter().enumerate() {
                    let product: f64 = force.iter().zip(b).map(|(f, u)| f * u).sum();
                    assert!(
                        (product - f64::from(u8::from(i == j))).abs() < 1e-8,
                        "{name}, {share}, {i}, {j}: {product}"
                    );
                }
            }
            if share == 1.0 {
                modes.squares.iter().zip(&model.modes(count).squares).for_each(|(a, b)| assert_near(*a, *b, 1e-9));
            }
        }
    }
    assert!(bodies >= 10, "{bodies}");
}

#[test]
fn faults_of_a_mass_matrix_are_named() {
    let mesh = grid("hex8", &[1.0; 3], &[1; 3]);
    let matrix = ConsistentMasses::of_mesh(&mesh, 1.0, 1.0).unwrap();
    let of = |found: springfit_foundation::error::Result<ConsistentMasses>| found.unwrap_err().to_string();
    reads(&of(matrix.blended(&[1.0; 8], 1.5)), "share: … from 0 to 1, found 1.5").unwrap();
    reads(&of(matrix.blended(&[1.0; 7], 0.5)), "masses: … 8, one for each point, found 7").unwrap();
    reads(&of(matrix.blended(&[f64::NAN; 8], 0.5)), "masses: … point 0, found NaN").unwrap();
    reads(&of(matrix.clone().scaled(-1.0)), "factor: … found -1").unwrap();
    reads(&matrix.product(&[0.0; 5], 3).unwrap_err().to_string(), "vector: … 24 numbers, found 5").unwrap();
    reads(&of(ConsistentMasses::of_mesh(&mesh, -1.0, 1.0)), "masses: … in cell 1 of block 1").unwrap();
    let none = ConsistentMasses::of_mesh(&mesh, 0.0, 1.0).unwrap();
    let model = Model::body(&mesh, 0.3);
    let error = lowest_modes(&model.system, &model.factor, &none, 3, 1).unwrap_err();
    reads(&error.to_string(), "masses: … a mass above zero at point … found 0").unwrap();
}

/// The condition of a slender bar is 1e10; its pairs stand, and the beam's first frequency
/// `ω = 1.8751² √(EI/ρA) / L²`, `I/A = b²/12` (Timoshenko), up to the trilinear element's parasitic shear: with ν = 0 that adds
/// `½ (length/height)²` of its own to a layer's bending stiffness, here half of the quarter that two layers bend by.
#[test]
fn slender_bars_pass() {
    let model = Model::body(&grid("hex8", &[100.0, 1.0, 1.0], &[200, 2, 2]), 0.0);
    let modes = model.modes(8);
    for pair in modes.squares.chunks(2) {
        assert_near(pair[1], pair[0], 1e-6);
    }
    let omega = 1.875_104_068_7f64.powi(2) * (1.0f64 / 12.0).sqrt() / 1e4;
    assert_near(modes.squares[0].sqrt(), omega * (9.0f64 / 8.0).sqrt(), 2e-4);
    model.check(&modes, 1e-5);
}

#[test]
fn modes_of_a_mesh_are_those_of_dense_matrices() {
    for (name, held) in [("cube_tet", "fixed"), ("cube_hex", "zmin")] {
        let scene = shipped(name);
        let mesh = scene.build_mesh().unwrap();
        let material = scene.material(3).unwrap();
        let support = support_at(&mesh, &Selection::Group(held.into()).points(&mesh).unwrap());
        let entries = finite_elements(&mesh, material.moduli());
        let model = Model::new(&entries, &support, masses(&mesh, 1000.0, 1.0), 3);
        let modes = model.modes(10);
        model.check(&modes, 1e-8);
        modes.squares.iter().zip(&model.dense_squares()).for_each(|(found, dense)| assert_near(*found, *dense, 1e-9));
    }
}

#[test]
fn faults_are_named() {
    let row = [f64::INFINITY, 1.0, 1.0];
    let model = Model::chain(&[1.0, 1.0], &row);
    reads(&model.error(3), "modes: … at most 2, … found 3").unwrap();
    assert_eq!(model.modes(0), Modes { squares: Vec::new(), shapes: Vec::new() });
    let massless = Model { masses: vec![0.0, 1.0, 0.0], ..Model::chain(&[1.0, 1.0], &row) };
    reads(&massless.error(1), "masses: … point 2, found 0").unwrap();
    let negative = Model { masses: vec![0.0, -2.5, 1.0], ..Model::chain(&[1.0, 1.0], &row) };
    reads(&negative.error(1), "masses: … point 1, found -2.5").unwrap();
    let few = Model { masses: vec![1.0, 1.0], ..Model::chain(&[1.0, 1.0], &row) };
    reads(&few.error(1), "masses: … at least 3 points, found 2").unwrap();
    let flat = Model { dimension: 0, ..Model::chain(&[1.0, 1.0], &row) };
    reads(&flat.error(1), "dimension: … 1, 2 or 3, found 0").unwrap();
    let indefinite = Model::chain(&[1.0, -0.2], &row);
    reads(&indefinite.error(1), "stiffness: … found motions that meet no resistance").unwrap();
}
