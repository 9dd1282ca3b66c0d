//! Coarse networks for fine bodies: where the points of one mesh lie in another, and what a network fitted to a finer body gains.

use crate::kit::{outcome, refusal};
use crate::shapes::bodies::grid;
use crate::shapes::statics::support_at;
use springfit_bodies::model::{Entries, finite_elements};
use springfit_bodies::solve::System;
use springfit_element::material::{Material, State};
use springfit_identify::whole::{Pressure, varied_loads};
use springfit_mesh::mesh::{Embedding, Mesh};
use springfit_studies::study::{Outcome, Scene, SupportPart, run};
use std::path::Path;

/// Affine fields are interpolated without error, and forces keep their sum, their moment and the work of every field of the coarse
/// mesh.
#[test]
fn points_are_found_in_the_cells_of_another_mesh() {
    let pairs = [
        ("tet4", "tet10", vec![2.0, 1.0, 1.5]),
        ("hex8", "tet4", vec![2.0, 1.0, 1.5]),
        ("wedge6", "hex20", vec![2.0, 1.0, 1.5]),
        ("tri3", "quad9", vec![2.0, 1.0]),
        ("quad8", "tri6", vec![2.0, 1.0]),
    ];
    for (coarse, fine, size) in pairs {
        let d = size.len();
        let coarse = grid(coarse, &size, &vec![2; d]);
        let fine = grid(fine, &size, &vec![5; d]);
        let embedding = Embedding::of(&fine.points, &coarse).unwrap();
        assert_eq!(embedding.outside, 0);
        let affine = |x: &[f64]| -> Vec<f64> {
            (0..d).map(|k| 0.3 + (0..d).map(|l| (1.0 + (k * d + l) as f64) * x[l]).sum::<f64>()).collect()
        };
        let at = |mesh: &Mesh| -> Vec<f64> { (0..mesh.point_count()).flat_map(|p| affine(mesh.point(p))).collect() };
        let found = embedding.interpolate(&at(&coarse));
        let worst = found.iter().zip(at(&fine)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{worst}");
        let forces: Vec<f64> = (0..fine.points.len()).map(|i| (1.7 * i as f64).sin()).collect();
        let own = embedding.restrict(&forces);
        let field: Vec<f64> = (0..coarse.points.len()).map(|i| (0.9 * i as f64).cos()).collect();
        let work = |f: &[f64], u: &[f64]| f.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        let (on_fine, on_coarse) = (work(&forces, &embedding.interpolate(&field)), work(&own, &field));
        assert!((on_fine - on_coarse).abs() < 1e-9 * on_fine.abs().max(1.0), "{on_fine} {on_coarse}");
        for k in 0..d {
            let sum = |f: &[f64]| f.iter().skip(k).step_by(d).sum::<f64>();
            assert!((sum(&forces) - sum(&own)).abs() < 1e-9);
        }
    }
    // A mesh of another body is refused.
    let (here, there) = (grid("tet4", &[1.0, 1.0, 1.0], &[2, 2, 2]), grid("tet4", &[9.0, 1.0, 1.0], &[2, 2, 2]));
    let error = Embedding::of(&there.points, &here).unwrap_err().to_string();
    assert!(error.contains("near them"), "{error}");
}

const SCENE: &str = r#"
[mesh]
box = { element = "ELEMENT", size = [4, 1, 1], cells = [4, 1, 1] }

[material]
young   = 1e5
poisson = 0.3

[reference]
refine = 2

[[fit]]
objective = "exact"

[[fit]]
name      = "coarse"
objective = "whole"
start     = "START"
KEYS

[[fix]]
group = "xmin"

[[load]]
name     = "tip"
group    = "xmax"
traction = [0, 0, 100]
"#;

/// The text of the scene.
fn scene(element: &str, start: &str, keys: &str) -> String {
    SCENE.replace("ELEMENT", element).replace("START", start).replace("KEYS", keys)
}

fn ran(element: &str, start: &str, keys: &str) -> Outcome {
    outcome(&scene(element, start, keys))
}

/// Under loads that it has not seen, a network of moduli fitted to a finer body errs less than half as much as finite elements of its
/// own mesh; it is stable under every support, because its form is that of the exact network.
#[test]
fn a_coarse_network_answers_like_a_finer_body() {
    for (element, keys) in [
        ("hex8", ""),
        ("hex8", "volume = \"cells\""),
        ("tet4", "volume = \"patches\""),
        ("tet4", "shear = \"edges\"\nvolume = \"patches\""),
        ("tet4", "shear = \"edges\""),
        ("hex8", "supports = [[\"xmin\"], [\"xmin\", \"xmax\"]]\nvalidate_supports = [[\"ymin\"]]"),
        (
            "tet4",
            "shear = \"edges\"\nvolume = \"patches\"\nsupports = [[\"xmin\"], [\"xmin\", \"xmax\"]]\nvalidate_supports = [[\"xmin\"], [\"ymin\"]]\nother_supports = [[\"xmax\"], [\"ymin\"]]",
        ),
        ("hex8", "unknowns = \"body-moduli\""),
    ] {
        let outcome = ran(element, "exact", keys);
        let whole = outcome.fits[1].kind.whole().unwrap();
        assert!(whole.stands && !whole.held_out.is_empty());
        // A support that is fitted and chooses rho as well is reported once.
        let supports: Vec<&str> = whole.held_out.iter().map(|held_out| &held_out.support[..]).collect();
        assert!((1..supports.len()).all(|i| !supports[..i].contains(&supports[i])), "{supports:?}");
        let unseen = whole.held_out.iter().filter(|held_out| held_out.part == SupportPart::Unseen);
        let unseen: Vec<&str> = unseen.map(|held_out| &held_out.support[..]).collect();
        // Of the other supports one chooses rho.
        assert_eq!(unseen, if keys.contains("other") { vec!["xmax"] } else { vec![] });
        for held_out in &whole.held_out {
            let median = |model: &str| held_out.models.iter().find(|m| m.model == model).unwrap().median.unwrap();
            let (body, fitted) = (median("finite elements"), median("fitted"));
            // Several supports at once, and one that was not fitted, leave less to gain.
            let share =
                match (keys.contains("body-moduli") || held_out.part != SupportPart::Fitted, keys.contains("supports"))
                {
                    (true, _) => 1.0,
                    (false, true) => 0.7,
                    (false, false) => 0.5,
                };
            assert!(fitted < share * body, "{element} {keys} {}: {body} {fitted}", held_out.support);
        }
        // The load of the scene has the finer body's displacements, and was not fitted.
        let rms = |fit: usize| outcome.fits[fit].loads[0].error.unwrap().rms;
        assert!(
            outcome.loads[0].measured.is_some() && rms(1) < 0.7 * rms(0),
            "{element} {keys}: {} {}",
            rms(0),
            rms(1)
        );
    }
}

/// The errors under each load, worked out again from both meshes: the median, the largest and the loads that are listed as worse than with
/// the finite elements of the mesh. Springs with the rest lengths of the mesh do not hold Poisson's ratio, so that there are some.
#[test]
fn loads_that_a_fit_has_made_worse_are_listed() {
    let material = Material::new(1e5, 0.3, State::Solid).unwrap();
    for (element, start, keys) in [
        ("tet4", "exact", "shear = \"edges\"\nvolume = \"patches\""),
        ("hex8", "offdiag", "unknowns = \"group\"\nregularization = 10"),
    ] {
        let outcome = ran(element, start, keys);
        let held_out = &outcome.fits[1].kind.whole().unwrap().held_out[0];
        let mesh = &outcome.mesh;
        let fine = mesh.refined().unwrap().refined().unwrap();
        let held = |mesh: &Mesh| support_at(mesh, &mesh.groups["xmin"].points);
        // The seed of the fit is 2010.
        let loads = varied_loads(&fine, &held(&fine), &1.0.into(), Pressure::Varying, (30, 2010 + 1000));
        let (down, up) = (Embedding::of(&fine.points, mesh).unwrap(), Embedding::of(&mesh.points, &fine).unwrap());
        let moved = |mesh: &Mesh, entries: &Entries, forces: &[f64]| {
            let system = System::new(entries, &held(mesh)).unwrap();
            system.solve(&system.cholesky().unwrap().unwrap(), forces).0
        };
        let [of_fine, of_body] = [&fine, mesh].map(|mesh| finite_elements(mesh, material.moduli()));
        let of_network = outcome.fits[1].network.stiffness(&mesh.points);
        let norm = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>().sqrt();
        let (mut fitted, mut worse) = (Vec::new(), Vec::new());
        for load in &loads {
            let wanted = up.interpolate(&moved(&fine, &of_fine, &load.forces));
            let error = |entries: &Entries| {
                let u = moved(mesh, entries, &down.restrict(&load.forces));
                let lack: Vec<f64> = u.iter().zip(&wanted).map(|(u, wanted)| u - wanted).collect();
                norm(&lack) / norm(&wanted)
            };
            let (body, own) = (error(&of_body), error(&of_network));
            fitted.push(own);
            worse.extend((own > 1.1 * body).then(|| (load.name.clone(), body, own)));
        }
        fitted.sort_by(f64::total_cmp);
        let model = held_out.models.iter().find(|m| m.model == "fitted").unwrap();
        // Both sides solve the same equations, with factors of their own.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
        assert!(close(model.median.unwrap(), 0.5 * (fitted[14] + fitted[15])), "{start}: {model:?} {fitted:?}");
        assert!(close(model.worst.unwrap(), fitted[29]), "{start}: {model:?} {fitted:?}");
        assert_eq!(held_out.worse.len(), worse.len(), "{start}: {worse:?}");
        for (found, (load, body, own)) in held_out.worse.iter().zip(&worse) {
            assert!(
                found.load == *load && close(found.finite_elements, *body) && close(found.fitted, *own),
                "{found:?}"
            );
        }
        assert_eq!(worse.is_empty(), start == "exact", "{start}: {worse:?}");
        let of = |model: &str| held_out.models.iter().find(|m| m.model == model).unwrap().median.unwrap();
        // Before any fit the exact network is the finite elements, and springs on edges leave less than half of their error.
        assert!(close(of("exact"), of("finite elements")), "{held_out:?}");
        assert!(element == "hex8" || of("exact edges patches") < 0.5 * of("exact"), "{held_out:?}");
        // The note says what share of the smoothed springs' error is left; hexahedra have none of these.
        let notes = outcome.fits[1].kind.whole().unwrap().notes().join("\n");
        let words =
            |share: f64| format!("the fit leaves {share:.2} of the median error of springs on edges with patches");
        match element {
            "hex8" => assert!(!notes.contains("springs on edges with patches"), "{notes}"),
            _ => {
                let share = of("fitted") / of("exact edges patches");
                assert!(notes.contains(&words(share)), "{share}: {notes}");
                assert_eq!(notes.contains("it gains nothing here"), share > 0.9, "{share}: {notes}");
            }
        }
    }
}

/// Frequencies after those that the masses were fitted to err at most 0.4 times as much as those of the finite elements of the mesh (0.34 here), and those that
/// were fitted at most a third. With a mass matrix, which has one unknown, they err at most a fifth and a tenth as much. Mass and centre are those of the finer body, worked out here from its size, and
/// second moments its own or those of lumped masses.
#[test]
fn masses_give_the_frequencies_of_a_finer_body() {
    let keys = "masses = 6\nvolume = \"patches\"";
    let text = scene("tet4", "exact", keys).replace("poisson = 0.3", "poisson = 0.3\ndensity = 1000");
    let text = text.replace("cells = [4, 1, 1]", "cells = [8, 2, 2]");
    let outcome = outcome(&text);
    let found = outcome.fits[1].kind.whole().unwrap().masses.as_ref().unwrap();
    assert!(found.supports.len() == 1);
    for support in &found.supports {
        let error = |model: &str| support.models.iter().find(|m| m.model == model).unwrap();
        let (body, own) = (error("finite elements"), error("fitted masses"));
        println!("{}: {:?}", support.support, support.models);
        assert!(own.next < 0.4 * body.next && own.first < body.first / 3.0, "{}: {own:?} {body:?}", support.support);
        let matrix = error("mass matrix");
        assert!(matrix.next < body.next / 5.0 && matrix.first < body.first / 10.0, "{matrix:?} {body:?}");
    }
    assert!(found.share > 0.0 && found.share < 1.0, "{}", found.share);
    let masses = outcome.fits[1].masses().unwrap();
    assert!(masses.iter().all(|m| *m > 0.0));
    let points = &outcome.mesh.points;
    let sum = |of: &dyn Fn(&[f64]) -> f64| points.chunks_exact(3).zip(masses).map(|(x, m)| m * of(x)).sum::<f64>();
    // A block of 4 × 1 × 1 m with 1000 kg/m³ has 4000 kg, and second moments m L²/12 about its centre.
    let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-6 * 4000.0, "{found} {exact}");
    near(sum(&|_| 1.0), 4000.0);
    let lumped = outcome.masses.as_ref().unwrap();
    let second = |masses: &[f64], k: usize, l: usize| {
        let of = |x: &[f64]| (x[k] - [2.0, 0.5, 0.5][k]) * (x[l] - [2.0, 0.5, 0.5][l]);
        points.chunks_exact(3).zip(masses).map(|(x, m)| m * of(x)).sum::<f64>()
    };
    for (k, side) in [4.0, 1.0, 1.0].into_iter().enumerate() {
        near(sum(&|x| x[k] - side / 2.0), 0.0);
        for l in 0..=k {
            // m L²/12 about the middle of a block, or what lumped masses have.
            let exact = if k == l { 4000.0 * side * side / 12.0 } else { 0.0 };
            near(second(masses, k, l), if found.second_error < 1e-6 { exact } else { second(lumped, k, l) });
        }
    }
    // The files of the network have them.
    let file = springfit_report::report::NetworkFile::of(&outcome, &outcome.fits[1]);
    assert_eq!(file.masses().unwrap(), masses);
    assert_eq!(
        springfit_report::report::NetworkFile::of(&outcome, &outcome.fits[0]).masses(),
        outcome.masses.as_deref()
    );
}

/// A material without density, and more frequencies than there are, are refused.
#[test]
fn masses_that_cannot_be_fitted_are_named() {
    let text = |keys: &str, density: &str| {
        let material = format!("poisson = 0.3\n{density}");
        scene("hex8", "exact", keys).replace("poisson = 0.3", &material)
    };
    let outcome = outcome(&text("masses = 2", "density = 1000"));
    let found = outcome.fits[1].kind.whole().unwrap().masses.as_ref().unwrap();
    assert!((found.masses.iter().sum::<f64>() - 4000.0).abs() < 1e-6);
    let error = refusal(&text("masses = 2", ""));
    assert!(error.contains("masses") && error.contains("density"), "{error}");
    let error = refusal(&text("masses = 100", "density = 1000"));
    assert!(error.contains("masses") && error.contains("free degrees of freedom"), "{error}");
}

/// A support that holds all points leaves nothing to fit.
#[test]
fn supports_that_hold_all_points_are_refused() {
    let text = scene("hex8", "exact", "supports = [[\"xmin\"], [\"xmin\", \"xmax\"]]");
    let (before, rest) = text.split_once("cells = [").unwrap();
    let (_, after) = rest.split_once(',').unwrap();
    let error = refusal(&format!("{before}cells = [1,{after}"));
    assert!(error.contains("fit[1].supports[1]: expected groups that leave points free to move"), "{error}");
}

/// A finer mesh whose content is another is of another body; a small difference is a note.
#[test]
fn finer_meshes_of_other_bodies_are_refused() {
    let of = |size: &str, cells: &str| {
        let other = format!("mesh = {{ box = {{ element = \"quad4\", size = {size}, cells = {cells} }} }}");
        let text = format!(
            "[mesh]\nbox = {{ element = \"quad4\", size = [4, 1], cells = [8, 2] }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
             plane = \"strain\"\n[reference]\n{other}\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\n\
             traction = [1, 0]\n[[fit]]\nobjective = \"exact\"\n"
        );
        let mut notes = Vec::new();
        let found = run(&Scene::parse(&text, Path::new("scene.toml")).unwrap(), &mut |event| {
            if let springfit_studies::study::Event::Note(words) = event {
                notes.push(words.to_string());
            }
        });
        found.map(|_| notes.join("\n"))
    };
    for size in ["[4, 1.5]", "[4, 0.5]"] {
        let error = of(size, "[16, 4]").unwrap_err().to_string();
        assert!(error.contains("reference.mesh: expected a mesh of the same body, of 4.0000e0 m²"), "{error}");
    }
    assert_eq!(of("[4, 1]", "[16, 4]").unwrap(), "");
    assert!(of("[4, 1.1]", "[16, 4]").unwrap().contains("has 4.0000e0 m² +10.0 %"));
    assert!(of("[4, 1]", "[4, 1]").unwrap().contains("fewer points than the mesh: 10 for 27"));
}

/// The functions of pyramids have no value at the apex, which is a point of the finer mesh as well.
#[test]
fn pyramids_have_finer_bodies() {
    for element in ["pyramid5", "pyramid13"] {
        let text = format!(
            "[mesh]\nbox = {{ element = \"{element}\", size = [1, 1, 2], cells = [2, 2, 4] }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
             [reference]\nrefine = 1\n[[fix]]\ngroup = \"zmin\"\n[[load]]\nname = \"pull\"\ngroup = \"zmax\"\n\
             traction = [0, 0, 100]\n[[fit]]\nobjective = \"exact\"\n"
        );
        let error = outcome(&text).loads[0].measured.as_ref().unwrap().fem_e_rms.unwrap();
        assert!(error < 20.0, "{element}: {error:?}");
    }
}

/// The starting network of moduli has springs between all nodes, a support counts once, and patches of two regions have no Poisson's ratio of one.
#[test]
fn keys_that_a_fit_of_moduli_cannot_serve_are_errors() {
    for (element, keys, words) in [
        ("hex8", "springs = [\"edge\"]", "springs: expected no groups"),
        (
            "hex8",
            "supports = [[\"xmin\"], [\"xmin\"]]",
            "supports[1]: expected a support of its own, found supports[0] again",
        ),
        (
            "hex8",
            "supports = [[\"xmin\", \"xmax\"], [\"xmax\", \"xmin\"]]",
            "supports[1]: expected a support of its own",
        ),
        (
            "hex8",
            "other_supports = [[\"xmin\", \"xmin\"]]",
            "other_supports[0]: expected groups that are held or conditions, each once",
        ),
        ("hex8", "validate_supports = [[]]", "validate_supports[0]: expected groups that are held"),
        ("tet4", "unknowns = \"region-young\"\nvolume = \"patches\"", "volume: expected \"points\" or \"cells\""),
    ] {
        let found = refusal(&scene(element, "exact", keys));
        assert!(found.contains("fit[1].") && found.contains(words), "{keys}: {found}");
    }
}
