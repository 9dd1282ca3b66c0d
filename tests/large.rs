//! Scenes whose material has a law: both models at large deformation, and fits to sampled forces.

use crate::kit::{outcome_of, shipped};
use crate::shapes::loaded;
use springfit_bodies::solve::Newton;
use springfit_element::material::{Material, Plane};
use springfit_report::report;
use springfit_studies::study::{Outcome, STRETCHES, Scene, compare_stretches, run, stages};
use tempfile::TempDir;

/// A bar of tetrahedra in a folder of its own, with these fits.
fn bar(fits: &str, files: &[(&str, &str)]) -> (TempDir, Scene) {
    let folder = TempDir::new().unwrap();
    let text = format!(
        "[mesh]\nbox = {{ element = \"tet4\", size = [1, 1, 1], cells = [2, 2, 2] }}\n[material]\nyoung = 1\npoisson = 0.3\n\
         law = \"neo-hookean\"\n{fits}\n[[fix]]\ngroup = \"zmin\"\n[[load]]\nname = \"pull\"\ngroup = \"zmax\"\n\
         traction = [0, 0, 0.2]\n[[load]]\nname = \"push aside\"\ngroup = \"zmax\"\ntraction = [0.04, 0, 0]\n"
    );
    std::fs::write(folder.path().join("bar.toml"), text).unwrap();
    files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    let scene = Scene::load(&folder.path().join("bar.toml")).unwrap();
    (folder, scene)
}

fn errors(outcome: &Outcome, fit: &str) -> Vec<f64> {
    let fit = outcome.fits.iter().find(|f| f.fit.name.starts_with(fit)).unwrap();
    fit.loads.iter().map(|load| load.error.unwrap_or_else(|| panic!("{}: {}", fit.fit.name, load.name)).rms).collect()
}

fn mean(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e.max(1e-9).ln()).sum::<f64>() / errors.len() as f64).exp()
}

/// At stretches of 30 % springs fitted to forces beat the best springs fitted to the stiffness at rest, at loads that no fit has
/// seen: with rest lengths of their own on the whole, with a cubic law and with `k c` under every load.
#[test]
fn sampled_fits_beat_those_at_rest_on_the_cubes() {
    for (name, at_rest) in [("cube_tet_large", "divergence"), ("cube_hex_large", "modal")] {
        let outcome = outcome_of(name);
        let at_rest = ["frobenius", "offdiag", at_rest].map(|fit| errors(outcome, fit));
        let best = at_rest.iter().map(|e| mean(e)).fold(f64::INFINITY, f64::min);
        let best_of_load = |i: usize| at_rest.iter().map(|e| e[i]).fold(f64::INFINITY, f64::min);
        let [rest, cubic, exact] =
            ["free rest lengths", "cubic law", "k c and volume"].map(|fit| errors(outcome, &format!("sampled, {fit}")));
        println!("{name}: at rest {best:.2}, sampled {:.2}, {:.2}, {:.4}", mean(&rest), mean(&cubic), mean(&exact));
        assert!(mean(&rest) < 0.75 * best, "{rest:?} {at_rest:?}");
        assert!((0..3).all(|i| cubic[i] < best_of_load(i) && exact[i] < best_of_load(i)), "{cubic:?} {exact:?}");
        if name == "cube_tet_large" {
            assert!(exact.iter().all(|e| *e < 1e-5), "{exact:?}");
        }
    }
}

/// Shapes of the finite elements under a load, and of a list of deformation gradients; the report says what was seen.
#[test]
fn shapes_come_from_loads_and_lists() {
    let fit = |shapes: &str| {
        format!(
            "[[fit]]\nobjective = \"sampled\"\nforce = \"free-rest\"\nsprings = [\"edge\", \"bulk\"]\nshapes = {shapes}\n"
        )
    };
    let of_loads = fit("{ loads = [\"pull\"], perturbation = 0.05 }") + "[newton]\nsteps = 4";
    let (_folder, scene) = bar(&of_loads, &[]);
    let outcome = run(&scene, &mut |_| {}).unwrap();
    assert_eq!(outcome.fits[0].kind.sampled().unwrap().loads, ["pull"]);
    assert!(
        report::notes(&outcome)
            .iter()
            .any(|note| note.contains("under pull: its errors under them are not predictions"))
    );
    assert!(report::report(&outcome).contains("\"agreeing_starts\""));
    let pulled = errors(&outcome, "sampled")[0];

    let list = "# stretches along z\n1, 0, 0, 0, 1, 0, 0, 0, 1.1\n0.95 0 0 0 0.95 0 0 0 1.2\n0.9;0;0;0;0.9;0;0;0;1.3\n";
    let (_folder, scene) = bar(&fit("{ gradients = \"list.csv\" }"), &[("list.csv", list)]);
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let listed = errors(&outcome, "sampled")[0];
    assert!(pulled < 5.0 && listed < 10.0, "{pulled} {listed}");
}

/// What no scene names is not done: neither energy nor shape nor Newton step.
#[test]
fn a_scene_without_a_law_leaves_large_deformation_out() {
    let left_out = |name: &str| -> Vec<String> {
        stages(&shipped(name)).into_iter().filter(|(_, why)| why.is_some()).map(|(what, _)| what).collect()
    };
    let plain = left_out("cube_tet");
    assert!(plain.contains(&"hyperelastic energy, Newton's method".into()) && plain.contains(&"sampled shapes".into()));
    let outcome = outcome_of("cube_tet");
    assert!(outcome.law.is_none() && outcome.loads.iter().all(|load| load.followed.is_none()));
    assert!(outcome.fits.iter().all(|f| f.kind.sampled().is_none() && f.loads.iter().all(|l| l.followed.is_none())));
    let large = left_out("cube_tet_large");
    assert!(
        !large.contains(&"hyperelastic energy, Newton's method".into()) && !large.contains(&"sampled shapes".into())
    );
}

/// A load that a model cannot carry is not an error: the share of it that was reached is reported.
#[test]
fn a_load_that_is_not_reached_is_told() {
    let (_folder, scene) = bar("[[fit]]\nobjective = \"frobenius\"\n[newton]\niterations = 1", &[]);
    let newton = Newton { tolerance: 1e-14, ..scene.newton() };
    let scene = scene.with_newton(newton);
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let notes = report::notes(&outcome);
    let told = |start: &str| {
        notes.iter().any(|note| note.starts_with(start) && note.contains("no equilibrium was found beyond"))
    };
    assert!(told("finite elements: ") && told("frobenius: "), "{notes:?}");
    assert!(outcome.fits[0].loads.iter().all(|load| load.error.is_none() && load.displacement.is_none()));
    assert!(report::report(&outcome).contains("\"converged\": false"));
    assert!(report::tables(&outcome).contains("stalled"));
}

/// The study of one element: a triangle in plane strain is met exactly by springs that pull as their length.
#[test]
fn the_study_of_stretches_has_all_its_parts() {
    let element = loaded("tri3");
    let material = Material::for_body(2, 1.0, 0.3, Some(Plane::Strain), None).unwrap();
    let study = compare_stretches(&element, material, "neo-hookean", 0.35, &mut |_| {}).unwrap();
    let exact = study.fits.iter().find(|fit| fit.name == "sampled k c, volume").unwrap();
    assert_eq!(exact.errors.len(), STRETCHES.len());
    assert!(exact.errors.iter().chain(&exact.excess).all(|e| e.unwrap().abs() < 1e-5), "{exact:?}");
    let others = study.fits.iter().filter(|fit| fit.name != exact.name && fit.name != "exact");
    assert!(others.flat_map(|fit| &fit.errors).all(|e| e.unwrap() > 0.1));
    let text = report::stretches_tables(&study).map(|table| table.titled_text()).concat();
    assert!(text.contains("sampled cubic") && text.contains("100000") && text.contains("Force at the pulled end"));
    let folder = TempDir::new().unwrap();
    let written =
        report::write_stretches(&study, report::open_outputs(folder.path(), &report::STRETCHES_FILES, &[]).unwrap())
            .unwrap();
    assert_eq!(written.len(), 6);
    assert!(std::fs::read_to_string(folder.path().join("force.svg")).unwrap().contains("sampled free rest"));
    for (law, stretch, error) in [
        ("rubber", 0.3, "law: expected one of corotational"),
        ("neo-hookean", -1.0, "stretch: expected a stretch above 0 and at most 2, found -1"),
    ] {
        let found = compare_stretches(&element, material, law, stretch, &mut |_| {}).unwrap_err();
        assert!(found.to_string().starts_with(error), "{found}");
    }
}

/// Compression beyond what the body bears: no file has the state on the way under the name of the load, and no table its displacement.
#[test]
fn a_load_that_is_reached_in_part_is_not_shown_as_the_whole() {
    let (_folder, scene) = bar("[[fit]]\nobjective = \"exact\"\nenergy = \"stable-neo-hookean\"", &[]);
    let settings = ["newton.iterations=4", "newton.steps=2", "load[0].traction=[0, 0, -0.9]"];
    let settings = settings.map(|setting| springfit_studies::study::Setting::parse(setting).unwrap());
    let text = std::fs::read_to_string(scene.path()).unwrap();
    let scene = Scene::parse_with(&text, scene.path(), &settings).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let followed = outcome.loads[0].followed.unwrap();
    assert!(followed.load > 0.0 && followed.load < 1.0, "{followed:?}");
    let names =
        |grid: springfit_mesh::mesh::vtk::Grid| grid.point_data.into_iter().map(|array| array.name).collect::<Vec<_>>();
    let mesh = names(report::displacement_grid(&outcome));
    let network = names(report::network_grid(&report::NetworkFile::of(&outcome, &outcome.fits[0])));
    for names in [mesh, network] {
        assert!(
            names.contains(&"u fem push aside (m)".into()) && !names.contains(&"u fem pull (m)".into()),
            "{names:?}"
        );
    }
    let table = report::tables(&outcome);
    assert!(table.contains("Largest displacement of the finite elements: push aside"), "{table}");
}
