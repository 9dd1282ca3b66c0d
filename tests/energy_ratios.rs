//! The least and largest energy of a network over that of the body, beside dense generalized eigenvalues.

use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Entries, Support, finite_elements};
use springfit_bodies::solve::{Standing, System};
use springfit_mesh::mesh::Mesh;
use springfit_numerics::dense::{eigenvalues, ratios};
use springfit_report::report::{self, Report, Table};
use springfit_studies::study::{Outcome, Scene, run};
use std::path::Path;

const BODY: &str = r#"
[material]
young = "1 MPa"
poisson = 0.3
density = 1000
[[fix]]
group = "zmin"
[[load]]
group = "zmax"
traction = [0, 0, 1000]
"#;

/// Hexahedra of a box, with the least ratio near one; flat ones, whose network releases energy; tetrahedra; and flat ones without negative
/// springs, whose ends are a thousandfold apart.
const BOXES: [(&str, &str, Standing); 4] = [
    ("element = \"hex8\", size = [1, 1, 1], cells = [4, 4, 5]", "objective = \"offdiag\"", Standing::Stable),
    ("element = \"hex8\", size = [1, 1, 0.1], cells = [4, 4, 4]", "objective = \"frobenius\"", Standing::Indefinite),
    ("element = \"tet4\", size = [1, 1, 1], cells = [3, 3, 4]", "objective = \"modal\"", Standing::Stable),
    (
        "element = \"hex8\", size = [1, 1, 0.02], cells = [4, 4, 4]",
        "objective = \"frobenius\"\nnonnegative = true",
        Standing::Stable,
    ),
];

fn solved(shape: &str, fit: &str, more: &str) -> Outcome {
    let text = format!("[mesh]\nbox = {{ {shape} }}\n[[fit]]\n{fit}\n{BODY}{more}");
    let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
    run(&scene, &mut |_| ()).unwrap_or_else(|e| panic!("{shape}: {e}"))
}

fn bottom(mesh: &Mesh) -> Support {
    let mut support = Support::free(mesh);
    let held: Vec<usize> = (0..mesh.point_count()).filter(|&p| mesh.point(p)[2] == 0.0).collect();
    support.fix(&held, &[0, 1, 2], 3);
    support
}

fn dense(entries: &Entries, support: &Support) -> DMatrix<f64> {
    let system = System::new(entries, support).unwrap();
    let n = system.size();
    let column = |j: usize| system.apply(&(0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<_>>());
    DMatrix::from_vec(n, n, (0..n).flat_map(column).collect())
}

/// The search ends with a residual of 2e-3, which bounds the error; the ratio with levels settles to 1e-3 in a step, and its largest is
/// less accurate.
#[test]
fn the_ratios_are_the_ends_of_the_dense_spectrum() {
    for (shape, fit, standing) in BOXES {
        for (method, [low, high]) in [("cholesky", [2e-3; 2]), ("multigrid", [0.02, 0.03])] {
            let outcome = solved(shape, fit, &format!("[solver]\nmethod = \"{method}\"\n"));
            let (mesh, support) = (&outcome.mesh, bottom(&outcome.mesh));
            let body = dense(&finite_elements(mesh, outcome.material.moduli()), &support);
            let k = dense(&outcome.fits[0].network.stiffness(&mesh.points), &support);
            let known = ratios(&k, body.clone()).expect("the body is held");
            let expected = [known[0], known[known.len() - 1]];
            let stability = outcome.fits[0].stability.as_ref().unwrap();
            let found = stability.energy_ratio;
            let what = format!("{shape}, {fit}, {method}: {found:?}, dense {expected:?}");
            assert!((found[0] / expected[0] - 1.0).abs() <= low, "{what}");
            assert!((found[1] / expected[1] - 1.0).abs() <= high, "{what}");
            assert!(stability.standing == standing && stability.is_found, "{what}: {:?}", stability.standing);
            // The softest motion has this ratio.
            let x = DVector::from_column_slice(&stability.softest);
            let quotient = x.dot(&(k * &x)) / x.dot(&(body * &x));
            assert!((quotient / found[0] - 1.0).abs() < 1e-9, "{what}: {quotient}");
        }
    }
}

/// Springs along the edges of squares that shear freely: positive constants release no energy, whatever rounding the search ends at.
#[test]
fn a_mechanism_without_negative_springs_releases_no_energy() {
    for cells in [40, 80] {
        let text = format!(
            "[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [{cells}, {cells}] }}\n[material]\nyoung = \"1 MPa\"\npoisson = 0.49\n\
             plane = \"strain\"\nthickness = 0.01\n[[fit]]\nobjective = \"frobenius\"\nsprings = [\"edge\"]\n[[fix]]\ngroup = \"ymin\"\n[[load]]\n\
             group = \"ymax\"\ntraction = [1000, 0]\n[solver]\nmethod = \"multigrid\"\n"
        );
        let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
        let outcome = run(&scene, &mut |_| ()).unwrap();
        let stability = outcome.fits[0].stability.as_ref().unwrap();
        assert_eq!((outcome.fits[0].network.negative(), stability.standing), (0, Standing::Singular), "{stability:?}");
    }
}

/// `√(−λ)` of the least eigenvalue of `M^(−½) K M^(−½)`; that of the modes is found to 1e-6.
#[test]
fn the_growth_of_an_indefinite_network_is_that_of_its_least_eigenvalue() {
    let (shape, fit, _) = BOXES[1];
    let motion = "[motion]\nduration = 1e-5\nstep = 1e-6\nlinear = true\ngravity = [0, 0, -1]\n";
    let outcome = solved(shape, fit, motion);
    let motion = outcome.motion.as_ref().unwrap();
    let support = bottom(&outcome.mesh);
    let k = dense(&outcome.fits[0].network.stiffness(&outcome.mesh.points), &support);
    let free: Vec<usize> = (0..outcome.mesh.points.len()).filter(|&dof| !support.is_fixed(dof)).collect();
    let root: Vec<f64> = free.iter().map(|dof| motion.masses[dof / 3].sqrt()).collect();
    let scaled = DMatrix::from_fn(root.len(), root.len(), |i, j| k[(i, j)] / (root[i] * root[j]));
    let expected = (-eigenvalues(scaled).min()).sqrt();
    let model = motion.models.iter().find(|model| model.fit == Some(0)).unwrap();
    let found = model.growth.unwrap();
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} and {expected}");
    // Its motion is told not to be trusted before anything else, and in its row; that of the finite elements is.
    let name = &outcome.fits[0].fit.name;
    let summary = report::summary(&outcome);
    assert!(summary.starts_with(&format!("NOT TRUSTED: the motion of {name} (is not stable at rest)\n")), "{summary}");
    let report = Report::of(&outcome);
    let trusted: Vec<bool> = report.motion.iter().map(|model| model.is_trusted()).collect();
    assert_eq!(trusted, [true, false]);
    let table = Table::all(&report).into_iter().find(|table| table.name == "motion").unwrap();
    let ended: Vec<&str> = table.rows.iter().map(|row| row[1].text.as_str()).collect();
    assert!(ended[0] == "complete" && ended[1].ends_with(", not trusted"), "{ended:?}");
    assert!(report.motion[0].largest_displacement.is_some_and(|most| most > 0.0 && most < 1e-9));
}

/// Iterations end where a motion is known that releases energy: the note says so, and what finds the equilibrium.
#[test]
fn missing_displacements_have_their_reason() {
    let (_, fit, _) = BOXES[1];
    let shape = "element = \"hex8\", size = [1, 1, 0.1], cells = [8, 8, 8]";
    let outcome = solved(shape, fit, "[solver]\nmethod = \"multigrid\"\n");
    let load = &outcome.fits[0].loads[0];
    assert!(load.displacement.is_none());
    let reason = load.unsolved.as_ref().unwrap();
    assert!(reason.contains("a motion that releases energy") && reason.contains("method = \"cholesky\""), "{reason}");
    let notes = springfit_report::report::notes(&outcome).join("\n");
    assert!(notes.contains(&format!("no displacements are given ({reason})")), "{notes}");
}
