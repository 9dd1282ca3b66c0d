//! Sampled fits of scenes: shapes of other runs and of files, sets, errors by family, data as tables, and learning curves.

use crate::kit::outcome;
use springfit_element::material::{Energy, EnergyMap, Material, MaterialMap};
use springfit_fit::fit::Spread;
use springfit_mesh::mesh::NamedState;
use springfit_report::report;
use springfit_studies::study::{FitEntry, LargeBody, NamedFit, Outcome, Reference, Scene, learning_curve, run};
use std::path::Path;
use tempfile::TempDir;

const BODY: &str = "[mesh]\nbox = { element = \"tet4\", size = [0.1, 0.02, 0.02], cells = [4, 1, 1] }\n\
    [material]\nyoung = 1e4\npoisson = 0.3\nlaw = \"neo-hookean\"\ndensity = 1000\n[newton]\nsteps = 1\n[[fix]]\ngroup = \"xmin\"\n\
    [[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [600, 0, 0]\n\
    [[load]]\nname = \"bend\"\ngroup = \"xmax\"\ntraction = [0, 0, 3]\n";

/// The outcome of a scene in a folder, whose files are written into `out`.
fn ran(folder: &Path, text: &str) -> Result<Outcome, springfit_foundation::error::Error> {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = Scene::load(&path)?;
    let edition = report::open_scene_outputs(&scene, &folder.join("out"))?;
    let outcome = run(&scene, &mut |_| {})?;
    report::write_outputs(&outcome, scene.output(), edition)?;
    Ok(outcome)
}

fn constants(outcome: &Outcome) -> Vec<f64> {
    outcome.fits[0].network.lengths.iter().map(|spring| spring.constant).collect()
}

fn fit(shapes: &str) -> String {
    format!("[[fit]]\nobjective = \"sampled\"\nshapes = {{ {shapes} }}\n")
}

/// The final states under loads of the scene are those that a run of the same scene has written, so that the springs are the same up to the
/// digits of the file. `loads` selects among those of the run; a load that it does not have is named.
#[test]
fn shapes_of_a_run_are_those_of_its_loads() {
    let folder = TempDir::new().unwrap();
    let of_loads = ran(
        folder.path(),
        &format!("{BODY}[output]\nvtu = true\n{}", fit("loads = [\"pull\", \"bend\"], perturbation = 0")),
    )
    .unwrap();
    std::fs::rename(folder.path().join("out"), folder.path().join("before")).unwrap();
    let near = |found: &Outcome, known: &Outcome| {
        let (found, known) = (constants(found), constants(known));
        let size = known.iter().fold(0.0f64, |most, k| most.max(k.abs()));
        // The file has 64-bit numbers; the fit of few shapes magnifies their rounding.
        assert!(found.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-6 * size));
    };
    let of_run = ran(folder.path(), &format!("{BODY}{}", fit("run = \"before\", perturbation = 0"))).unwrap();
    near(&of_run, &of_loads);
    let outcome = of_run.fits[0].kind.sampled().unwrap();
    assert!(outcome.loads.is_empty() && outcome.families.iter().all(|family| family.family == "states"));
    let bent = ran(folder.path(), &format!("{BODY}{}", fit("loads = [\"bend\"], perturbation = 0"))).unwrap();
    let of_run =
        ran(folder.path(), &format!("{BODY}{}", fit("run = \"before\", loads = [\"bend\"], perturbation = 0")))
            .unwrap();
    near(&of_run, &bent);
    // The file may have displacements of the network as well.
    let all = NamedState::read(&folder.path().join("before/mesh.vtu"), &of_loads.mesh, 1.0, &|_| true).unwrap();
    for load in &of_loads.loads {
        let state = all.iter().find(|state| state.name == format!("u fem {} (m)", load.name)).unwrap();
        let apart = state.displacements.iter().zip(&load.fem).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12, "{apart}");
    }
    let of_file =
        ran(folder.path(), &format!("{BODY}{}", fit("states = \"before/mesh.vtu\", perturbation = 0"))).unwrap();
    let shapes = |outcome: &Outcome| outcome.fits[0].kind.sampled().unwrap().shapes;
    assert_eq!(shapes(&of_file) > shapes(&of_loads), all.len() > 2);
    let error = ran(folder.path(), &format!("{BODY}{}", fit("run = \"before\", loads = [\"twist\", \"pull\"]")));
    let error = error.err().unwrap().to_string();
    assert!(error.contains("fit[0].shapes.loads: expected loads of the run (pull), found \"twist\""), "{error}");
    let other = BODY.replace("cells = [4, 1, 1]", "cells = [3, 1, 1]");
    let error = ran(folder.path(), &format!("{other}{}", fit("run = \"before\""))).err().unwrap().to_string();
    assert!(error.contains("mesh.vtu: ") && error.contains("that of a point of the mesh"), "{error}");
}

/// The pictures of a motion have the displacements that were computed, also where the points are where they have moved.
#[test]
fn pictures_of_a_motion_are_states() {
    let folder = TempDir::new().unwrap();
    let motion =
        "[motion]\nduration = 0.02\nstep = 0.002\nevery = 0.004\ngravity = [0, 0, -9.81]\n[output]\nvtu = true\n";
    let outcome = ran(folder.path(), &format!("{BODY}{motion}{}", fit("count = 10"))).unwrap();
    let moved = &outcome.motion.as_ref().unwrap().models[0];
    let path = folder.path().join("out/motion-finite-elements.pvd");
    let states = NamedState::read(&path, &outcome.mesh, 1.0, &|_| true).unwrap();
    assert!(states.len() > 3 && states.len() == moved.states.len(), "{}", states.len());
    for (state, known) in states.iter().zip(&moved.states) {
        let apart = state.displacements.iter().zip(known).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12, "{apart}");
    }
    let text = format!(
        "{BODY}{}",
        fit("states = \"out/motion-finite-elements.pvd\", held_out = { families = [\"bending\"] }")
    );
    let path = folder.path().join("other.toml");
    std::fs::write(&path, text).unwrap();
    let outcome = run(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap();
    let found = outcome.fits[0].kind.sampled().unwrap();
    assert_eq!((found.families.len(), found.families[0].family.as_str()), (1, "bending"));
}

/// The tables have a row for each shape and each start of one cell of each shape, whose errors are those of the report.
#[test]
fn data_are_tables_beside_the_network() {
    let folder = TempDir::new().unwrap();
    let sets = "[[fit.shapes]]\nfamilies = [\"uniaxial\", \"biaxial\"]\ncount = 20\nweight = 2\nheld_out = { families = [\"pure-shear\"], stretch = [0.3, 0.5], count = 9 }\n\
        [[fit.shapes]]\nfamilies = [\"simple-shear\"]\ncount = 11\nheld_out = 5\n";
    let head = "[[fit]]\nname = \"own law\"\nobjective = \"sampled\"\nforce = \"k*(exp(a*s) - 1)\"\nbounds = { a = [0.1, 8] }\nstarts = 3\ndata = true\n";
    let outcome = ran(folder.path(), &format!("{BODY}{head}{sets}")).unwrap();
    let found = outcome.fits[0].kind.sampled().unwrap();
    let read = |name: &str| -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').map(String::from).collect()).collect()
    };
    let (shapes, starts) = (read("shapes-own-law.csv"), read("starts-own-law.csv"));
    let cells: std::collections::BTreeSet<&String> = shapes.iter().map(|row| &row[1]).collect();
    assert_eq!(shapes.len(), cells.len() * (20 + 11 + 9 + 5));
    assert_eq!(starts.len(), cells.len() * 3);
    let of = |family: &str, part: &str| shapes.iter().filter(|row| row[5] == family && row[2] == part).count();
    assert_eq!(of("uniaxial", "trained"), 10 * cells.len());
    assert_eq!(of("pure-shear", "held-out"), 9 * cells.len());
    assert_eq!(of("pure-shear", "trained"), 0);
    let largest = shapes.iter().map(|row| row[10].parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert_eq!(found.worst[0].error, largest);
    assert!(found.worst.windows(2).all(|pair| pair[0].error >= pair[1].error) && found.worst.len() == 8);
    // The root mean square of the shapes of a family in a cell is the error of the family there; in the report is its mean over the cells.
    let mean = |family: &str| {
        let of_cell = |cell: &&String| {
            let own = shapes.iter().filter(|row| row[5] == family && row[2] == "held-out" && row[1] == **cell);
            let squares: Vec<f64> = own.map(|row| row[10].parse::<f64>().unwrap().powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        cells.iter().map(of_cell).fold(0.0, f64::max)
    };
    let spread = |family: &str| -> Spread { found.families.iter().find(|one| one.family == family).unwrap().held_out };
    for family in ["pure-shear", "simple-shear"] {
        assert!((spread(family).max - mean(family)).abs() < 1e-9, "{family}");
    }
    assert_eq!(found.starts.len(), 3);
    let text = std::fs::read_to_string(folder.path().join("out/report.json")).unwrap();
    for words in ["\"pure-shear\"", "\"shapes-own-law.csv\"", "\"starts-own-law.csv\"", "\"principal-stretches\""] {
        assert_eq!(text.contains(words), words != "\"principal-stretches\"", "{words}");
    }
    // Without data there are no tables, and those of a run before are gone.
    ran(folder.path(), &format!("{BODY}{}{sets}", head.replace("data = true\n", ""))).unwrap();
    assert!(!folder.path().join("out/shapes-own-law.csv").exists());
}

/// The points of a curve are fits to the first shapes of one sequence: the largest is the fit itself, all have the same shapes held out, and a
/// list is taken from its first row.
#[test]
fn a_learning_curve_has_nested_shapes() {
    let scene = Scene::parse(&format!("{BODY}{}", fit("count = 3")), Path::new("scene.toml")).unwrap();
    let mesh = scene.build_mesh().unwrap();
    let material = Material::for_body(3, 1e4, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let large = LargeBody::at_rest(EnergyMap::from((energy, material.state())));
    let reference = Reference { large: Some(&large), ..Reference::default() };
    let map = MaterialMap::from(material);
    let named = |shapes: &str| -> NamedFit {
        let shapes: toml::Table = toml::from_str(shapes).unwrap();
        FitEntry::new("sampled").with("shapes", Some(shapes)).fits(Path::new("")).unwrap().remove(0)
    };
    let curve = |shapes: &str, counts: &[usize], seeds: &[u64]| {
        learning_curve(&mesh, &map, &reference, &named(shapes), counts, seeds, &mut |_| {})
    };
    for design in ["scrambled", "sobol", "latin-hypercube", "random"] {
        let shapes =
            format!("design = \"{design}\"\nheld_out = {{ families = [\"bending\", \"uniaxial\"], count = 12 }}\n");
        let points = curve(&shapes, &[5, 40], &[7, 8]).unwrap();
        assert_eq!(points.iter().map(|p| (p.seed, p.shapes)).collect::<Vec<_>>(), [(7, 5), (7, 40), (8, 5), (8, 40)]);
        let own = format!(
            "seed = 7\ncount = 40\ndesign = \"{design}\"\nheld_out = {{ families = [\"bending\", \"uniaxial\"], count = 12, seed = 1 }}\n"
        );
        let whole = curve(&own, &[40], &[7]).unwrap();
        assert_eq!((points[1].trained, points[1].held_out), (whole[0].trained, whole[0].held_out), "{design}");
        assert!(
            points.iter().all(|p| p.families.len() == 2 && p.families.iter().all(|f| f.shapes == 6) && p.seconds > 0.0)
        );
        assert!(points[0].held_out != points[1].held_out && points[1].held_out != points[3].held_out);
    }
    let rows: String = (0..10).map(|i| format!("[{}, 0, 0, 0, 1, 0, 0, 0, 1], ", 1.05 + 0.02 * f64::from(i))).collect();
    let list = format!("gradients = [{rows}]\nperturbation = 0\n");
    let points = curve(&list, &[2, 8], &[1, 2]).unwrap();
    assert_eq!(points[0].held_out, points[2].held_out, "the seed of a list without displacements changes nothing");
    for (shapes, counts, seeds, words) in [
        (
            &*list,
            &[9][..],
            &[1][..],
            "shapes.count: expected at most 8, the shapes of the list that are fitted, found 9",
        ),
        ("", &[], &[1], "counts: expected at least one number of shapes, found none"),
        ("", &[0], &[1], "counts: expected a number from 1"),
        ("", &[3], &[], "seeds: expected at least one seed, found none"),
        ("held_out = 0", &[3], &[1], "shapes.held_out: expected shapes that are held out, found 0"),
    ] {
        let error = curve(shapes, counts, seeds).unwrap_err().to_string();
        assert!(error.starts_with(words), "{error}");
    }
    let modal = FitEntry::new("modal").fits(Path::new("")).unwrap().remove(0);
    let error = learning_curve(&mesh, &map, &reference, &modal, &[3], &[1], &mut |_| {}).unwrap_err().to_string();
    assert!(error.starts_with("objective: expected a fit of the objective \"sampled\""), "{error}");
}

/// The errors of forces do not depend on Young's modulus: a body of two materials has those of a body of one, by family, and the data have the
/// cells of both.
#[test]
fn cells_of_several_materials_have_their_places() {
    let shapes = "families = [\"uniaxial\", \"simple-shear\"], count = 40, held_out = { families = [\"bending\", \"biaxial\"], count = 10 }";
    let text = |materials: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [4, 1, 1], cells = [4, 1, 1] }}\n{materials}[[fit]]\nobjective = \"sampled\"\n\
             law = \"neo-hookean\"\ndata = true\nshapes = {{ {shapes} }}\n"
        )
    };
    let found = |materials: &str| {
        let outcome = run(&Scene::parse(&text(materials), Path::new("scene.toml")).unwrap(), &mut |_| {}).unwrap();
        outcome.fits[0].kind.sampled().unwrap().clone()
    };
    let one = found("[material]\nyoung = 1e4\npoisson = 0.3\n");
    let two = found(
        "[[material]]\nwhere = \"x > 1.1 && x < 2.9\"\nyoung = 1e4\npoisson = 0.3\n[[material]]\nyoung = 3e4\npoisson = 0.3\n",
    );
    let names = |outcome: &springfit_studies::study::SampledOutcome| -> Vec<(String, usize)> {
        outcome.families.iter().map(|family| (family.family.clone(), family.shapes)).collect()
    };
    assert_eq!(names(&one), [("bending".to_string(), 5), ("biaxial".to_string(), 5)]);
    assert_eq!(names(&two), names(&one));
    for (own, other) in one.families.iter().zip(&two.families) {
        // Rounding, which Young's modulus changes.
        assert!(
            (own.held_out.mean - other.held_out.mean).abs() < 1e-9
                && (own.held_out.max - other.held_out.max).abs() < 1e-9
        );
    }
    assert!((one.trained.max - two.trained.max).abs() < 1e-9);
    // Cells that are alike are told once for each material: the first of the outer ones, and the first of the inner ones.
    let cells = |outcome: &springfit_studies::study::SampledOutcome| -> std::collections::BTreeSet<usize> {
        outcome.errors[0].iter().map(|error| error.cell).collect()
    };
    assert_eq!(cells(&one), [0].into());
    assert_eq!(cells(&two), [0, 1].into());
}

/// A law that overflows at shapes that are held out has no error there, which is said; the errors of families are of the other elements.
#[test]
fn forces_without_bounds_are_told() {
    let shapes = "families = [\"volumetric\"], stretch = [0, 0.05], perturbation = 0, held_out = { families = [\"volumetric\", \"bending\"], stretch = [0.9, 1], count = 4 }";
    let outcome = outcome(&format!(
        "[mesh]\nbox = {{ element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
         [[fit]]\nobjective = \"sampled\"\nlaw = \"neo-hookean\"\nforce = \"k*(exp(1000*s) - 1)\"\nshapes = {{ {shapes} }}\n"
    ));
    let found = outcome.fits[0].kind.sampled().unwrap();
    assert_eq!((found.infinite, found.held_out), (outcome.mesh.cell_count(), None));
    let notes = report::notes(&outcome);
    assert!(notes.iter().any(|note| note.contains("no finite force at shapes that are held out")), "{notes:?}");
    assert!(report::tables(&outcome).split_whitespace().all(|word| word != "inf" && word != "NaN"));
}

/// Springs whose rest lengths are fitted to forces need not balance where the element is at rest.
#[test]
fn a_network_that_is_not_at_rest_is_told_first() {
    let folder = TempDir::new().unwrap();
    let fit = |force: &str| {
        format!(
            "{BODY}[[fit]]\nname = \"net\"\nobjective = \"sampled\"\nsprings = [\"edge\"]\nforce = \"{force}\"\n\
             shapes = {{ count = 60, stretch = [0.0, 0.4] }}\n"
        )
    };
    let notes = |force: &str| report::notes(&ran(folder.path(), &fit(force)).unwrap());
    let told = notes("free-rest");
    assert!(told.iter().any(|note| note.starts_with("net: the network is not at rest in the mesh")), "{told:?}");
    assert!(!notes("linear").iter().any(|note| note.contains("is not at rest")));
}
