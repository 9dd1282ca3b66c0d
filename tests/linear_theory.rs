//! Errors that a root mean square hides, and results beyond the theory that they are computed by.

use crate::kit::outcome;
use crate::shapes::bodies::grid;
use crate::shapes::statics::dense;
use crate::shapes::{Random, elements, single};
use nalgebra::DMatrix;
use springfit_bodies::model::{Deformation, finite_elements};
use springfit_element::element::Element;
use springfit_mesh::mesh::{CellBlock, Mesh};
use springfit_report::report::{Report, notes, tables};
use springfit_studies::study::{Scene, converge};
use std::sync::Arc;

const BEAM: &str = r#"
[mesh]
box = { element = "tri3", size = [4, 0.5], cells = [16, 2] }
[material]
young = 1e5
poisson = 0.3
plane = "strain"
density = 1000
[[fit]]
objective = "exact"
[[fit]]
objective = "offdiag"
nonnegative = true
[[fix]]
group = "xmin"
"#;

/// Of a homogeneous gradient H in every cell: the largest eigenvalue of `½ (H + Hᵀ)`, and √½ of the norm of `½ (H − Hᵀ)`. A surface that
/// is turned about a line in it is not strained.
#[test]
fn strains_and_rotations_are_those_of_the_gradient() {
    for element in elements() {
        let d = element.dimension();
        let mut random = Random(4);
        let h = DMatrix::from_fn(d, d, |_, _| random.next());
        let points = element.positions.clone();
        let u: Vec<f64> = points
            .chunks_exact(d)
            .flat_map(|x| (0..d).map(|k| (0..d).map(|l| h[(k, l)] * x[l]).sum::<f64>()).collect::<Vec<_>>())
            .collect();
        let mesh = single(&element, &points);
        let found = Deformation::largest(&mesh, &u);
        let strain = ((&h + h.transpose()) / 2.0).symmetric_eigenvalues().amax();
        let rotation = ((&h - h.transpose()) / 2.0).norm() / 2f64.sqrt();
        assert!((found.strain - strain).abs() < 1e-12 && (found.rotation - rotation).abs() < 1e-12, "{found:?}");
    }
    let flat = grid("quad4", &[1.0; 2], &[2; 2]);
    let points: Vec<f64> = flat.points.chunks_exact(2).flat_map(|x| [x[0], x[1], 3.0]).collect();
    let element = Arc::new(Element::load("quad4").unwrap().in_space(3));
    let blocks = vec![CellBlock { element, connectivity: flat.blocks[0].connectivity.clone() }];
    let surface = Mesh { dimension: 3, points, blocks, ..flat };
    let u: Vec<f64> = surface.points.chunks_exact(3).flat_map(|x| [0.0, 0.0, 0.2 * x[0]]).collect();
    let found = Deformation::largest(&surface, &u);
    assert!(found.strain < 1e-12 && (found.rotation - 0.2).abs() < 1e-12, "{found:?}");
}

/// A linear answer grows with the load; a load outside the range of the theory has a note and a figure in the report.
#[test]
fn results_beyond_the_linear_theory_are_told() {
    let bent = |traction: f64| {
        outcome(&format!("{BEAM}[[load]]\nname = \"bend\"\ngroup = \"xmax\"\ntraction = [0, {traction:e}]\n"))
    };
    let unit = bent(1.0).loads[0].deformation.unwrap();
    assert!(unit.rotation > unit.strain && unit.strain > 0.0, "{unit:?}");
    for (share, expected) in [(0.099, false), (0.101, true)] {
        let outcome = bent(share / unit.rotation);
        let found = outcome.loads[0].deformation.unwrap();
        assert!((found.rotation - share).abs() < 1e-9, "{found:?}");
        let told =
            notes(&outcome).iter().any(|note| note.contains("rotations of up to 0.10 rad (bound 0.1 rad) under bend"));
        let report = Report::of(&outcome);
        let record = &report.deformations[0];
        assert_eq!((told, record.beyond_linear, record.load.as_deref()), (expected, expected, Some("bend")));
        assert_eq!(record.rotation, Some(found.rotation));
    }
    let large = BEAM.replace("plane =", "law = \"neo-hookean\"\nplane =").replace("\"exact\"", "\"spectral\"");
    let large = outcome(&format!("{large}[[load]]\nname = \"bend\"\ngroup = \"xmax\"\ntraction = [0, 100]\n"));
    assert!(large.loads[0].deformation.is_none() && Report::of(&large).deformations.is_empty());
}

/// A network that is too stiff under a traction is so under displacements of the same part, on every mesh, and so are finite elements
/// beside those of finer meshes.
#[test]
fn the_error_of_the_energy_has_one_sign_under_forces_and_displacements() {
    let text = r#"
[mesh]
box = { element = "hex8", size = [1, 1, 1], cells = [3, 3, 3] }
[material]
young = 1e4
poisson = 0.3
[[fit]]
objective = "modal"
[[fix]]
group = "xmin"
[[load]]
name = "traction"
group = "xmax"
traction = [100, 0, 0]
[[load]]
name = "displacement"
group = "xmax"
displacement = [0.01, "free", "free"]
"#;
    let found = outcome(text);
    let errors: Vec<f64> = found.fits[0].loads.iter().map(|load| load.work_error.unwrap()).collect();
    // E of the network is 12 % too large.
    assert!(errors.iter().all(|error| (-15.0..-5.0).contains(error)), "{errors:?}");
    let scene = Scene::parse(text, std::path::Path::new("scene.toml")).unwrap();
    let study = converge(&scene, Some(2), &mut |_| {}).unwrap();
    for (load, error) in study.loads.iter().zip(errors) {
        let of_body = load.of_body(&load.models[1]);
        assert!((of_body[0].unwrap() - error).abs() < 1e-6, "{}: {of_body:?} {error}", load.name);
        assert!(load.of_truth(&load.models[0])[0].unwrap() < 0.0, "{}", load.name);
    }
}

/// Under forces, body forces and given displacements: the error where the body moves most, and that of the compliance, from `f·u`, which
/// is `uᵀ K u` of each model, by dense matrices.
#[test]
fn the_errors_of_the_tip_and_of_the_energy_are_reported() {
    let loads = r#"
[[load]]
name = "pull"
group = "xmax"
traction = [100, 20]
[[load]]
name = "weight"
body = ["-10*y", "x"]
[[load]]
name = "shift"
group = "xmax"
displacement = ["free", 0.01]
"#;
    let outcome = outcome(&format!("{BEAM}{loads}"));
    let points = outcome.mesh.points.len();
    let body = dense(points, &finite_elements(&outcome.mesh, outcome.material.moduli()));
    let report = Report::of(&outcome);
    let text = tables(&outcome);
    assert!(text.contains("e_tip / e_energy %"), "{text}");
    for (fit, record) in outcome.fits.iter().zip(&report.fits) {
        let network = dense(points, &fit.network.stiffness(&outcome.mesh.points));
        for (i, (load, record)) in fit.loads.iter().zip(&record.loads).enumerate() {
            let (fem, lem) =
                (nalgebra::DVector::from_column_slice(&outcome.loads[i].fem), load.displacement.as_ref().unwrap());
            let lem = nalgebra::DVector::from_column_slice(lem);
            let ratio = lem.dot(&(&network * &lem)) / fem.dot(&(&body * &fem));
            // The softer body does more work under forces, and less under the same displacements.
            let energy = 100.0 * (if load.name == "shift" { 1.0 / ratio } else { ratio } - 1.0);
            assert!((record.work_error.unwrap() - energy).abs() < 1e-6, "{}: {record:?} {energy}", load.name);
            let size = |u: &nalgebra::DVector<f64>, p: usize| (u[2 * p].powi(2) + u[2 * p + 1].powi(2)).sqrt();
            let tip = (0..points / 2).max_by(|a, b| size(&fem, *a).total_cmp(&size(&fem, *b))).unwrap();
            let expected = 100.0 * size(&(&lem - &fem), tip) / size(&fem, tip);
            assert!((record.error.unwrap().tip - expected).abs() < 1e-9, "{record:?} {expected}");
            assert!(record.error.unwrap().tip <= record.error.unwrap().max);
            assert!(text.contains(&format!("{expected:.2} / {energy:+.2}")) || fit.fit.name == "exact", "{text}");
            assert_eq!(fit.fit.name == "exact", energy.abs() < 1e-6 && expected < 1e-6, "{energy} {expected}");
        }
    }
}

/// Springs turn, linear finite elements do not: the whole error of an exact network comes from the linear theory, and a note says so with both figures.
#[test]
fn turning_springs_beside_a_linear_body_are_told() {
    let swung = |gravity: f64, keys: &str| {
        let motion = "[motion]\nduration = 4\nstep = 0.1\nevery = 0.5\nintegrator = \"newmark\"\n";
        outcome(&format!("{BEAM}{motion}gravity = [0, {gravity}]\n{keys}"))
    };
    let turning = swung(-0.1, "");
    let motion = turning.motion.as_ref().unwrap();
    let body = motion.models[0].deformation.unwrap();
    println!("{body:?} {:?}", motion.models.iter().map(|m| (m.error(), m.linear_error)).collect::<Vec<_>>());
    assert!(body.rotation > Deformation::LINEAR, "{body:?}");
    let plain = swung(-0.1, "linear = true\n");
    let told = notes(&turning);
    assert!(told.iter().any(|note| note.contains("under the motion are beyond the linear")), "{told:?}");
    let report = Report::of(&turning);
    let record = report.deformations.last().unwrap();
    assert_eq!((record.load.as_deref(), record.rotation), (None, Some(body.rotation)));
    for ((model, other), record) in
        motion.models.iter().zip(&plain.motion.as_ref().unwrap().models).zip(&report.motion).skip(1)
    {
        let [mean, max] = model.linear_error.unwrap();
        assert_eq!(Some([mean, max]), other.error());
        assert_eq!((record.linear_e_rms_mean, record.linear_e_rms_max), (Some(mean), Some(max)));
        assert!(other.linear_error.is_none());
        assert!(told.iter().any(|note| note.contains(&format!("the fit's is {mean:.2} / {max:.2}"))), "{told:?}");
    }
    let ([_, whole], [_, own]) = (motion.models[1].error().unwrap(), motion.models[1].linear_error.unwrap());
    assert!(own < 1e-6 && whole > 1.0, "{own} {whole}");
    // Hardly turned, there is nothing to tell.
    let still = swung(-1e-4, "");
    let motion = still.motion.as_ref().unwrap();
    assert!(motion.models.iter().all(|model| model.linear_error.is_none()));
    assert!(!notes(&still).iter().any(|note| note.contains("linear")), "{:?}", notes(&still));
}
