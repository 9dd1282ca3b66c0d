//! Scenes in motion: against closed forms, as files, and every wrong key.

use crate::kit::{self, holding, json, outcome, outcome_of, place, prints, said, springfit};
use crate::messages::reads;
use springfit_mesh::mesh::MeshSource;
use springfit_report::report;
use springfit_studies::study::{Event, ModelMotion, MotionEnding, Scene, run, stages};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// A block of 2 cm that hangs by nothing or by its lower side; motion to be filled in.
const BLOCK: &str = r#"[mesh]
box = { element = "hex8", size = [0.02, 0.02, 0.02], cells = [3, 3, 3] }
[material]
young = 10e3
poisson = 0.3
density = 1000
[[fit]]
objective = "modal"
springs = ["edge", "face diagonal", "body diagonal", "bulk"]
nonnegative = true
[[fix]]
group = "zmin"
[motion]
duration = 0.05
step = 0.001
integrator = "newmark"
linear = true
every = 0.01
watch = { group = "zmax" }
[[motion.force]]
group = "zmax"
force = ["0.01*sin(60*t)", 0, "0.1*t"]
[[motion.pull]]
where = "x < 1e-9 && z > 0.0199"
displacement = ["free", "1e-4*(1 - cos(80*t))", "free"]
"#;

fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from:?} in {text}");
    text.replace(from, to)
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

#[test]
fn finite_elements_and_springs_move_alike() {
    let outcome = outcome(BLOCK);
    let motion = outcome.motion.as_ref().unwrap();
    let names: Vec<&str> = motion.models.iter().map(|model| model.name.as_str()).collect();
    assert_eq!(names, ["finite elements", outcome.fits[0].fit.name.as_str()]);
    for model in &motion.models {
        assert_eq!((model.steps, model.records.len(), &model.ending), (50, 6, &MotionEnding::Complete));
        assert!(model.growth.is_none() && model.unsolved == 0 && model.seconds > 0.0);
        for (i, record) in model.records.iter().enumerate() {
            assert_near(record.account.time, 0.01 * i as f64, 1e-12);
            let balance = record.account.balance.unwrap();
            // Newmark's average acceleration keeps the energy of a linear model; the pulled edge does work with the forces there.
            assert!(balance.drift.abs() < 1e-2, "{balance:?}");
        }
        let last = model.records.last().unwrap();
        assert!(last.account.kinetic > 0.0 && last.account.elastic > 0.0 && last.watched[2] > 0.0);
    }
    assert_eq!(motion.models[0].error(), None);
    let [mean, largest] = motion.models[1].error().unwrap();
    assert!(0.0 < mean && mean < 2.0 && largest < 4.0, "{mean} {largest}");
    assert!(report::tables(&outcome).contains("complete"));
}

/// `u = −g t²/2`, to the last digits with Newmark's average acceleration; nothing deforms, so nothing differs.
#[test]
fn a_body_that_nothing_holds_falls() {
    let free = edited(BLOCK, "[[fix]]\ngroup = \"zmin\"\n", "");
    let free = edited(&free, "watch =", "gravity = [0, 0, -9.81]\nwatch =");
    let free = free.split("[[motion.force]]").next().unwrap().to_string();
    for linear in ["linear = true\n", ""] {
        let outcome = outcome(&edited(&free, "linear = true\n", linear));
        let motion = outcome.motion.unwrap();
        for model in &motion.models {
            for record in &model.records {
                let t = record.account.time;
                assert_near(record.watched[2], -9.81 * t * t / 2.0, 1e-11);
                assert_near(record.account.momentum[2], -8e-3 * 9.81 * t, 1e-11);
                assert!(record.account.elastic.abs() < 1e-15);
            }
            assert_near(model.records[5].account.time, 0.05, 1e-12);
        }
        assert!(motion.models[1].error().unwrap()[1] < 1e-6);
    }
}

/// A row of masses on springs along x: `f = √(E/ρ) sin(π (2i − 1)/4n)/πh` held at one end, `√(E/ρ) sin(π i/2n)/πh` free. With the consistent
/// matrix of linear elements `ω² = 6 (E/ρh²) (1 − cos κ)/(2 + cos κ)`, κ twice these angles (Hughes, *The Finite Element Method*, 7.4).
#[test]
fn natural_frequencies_are_those_of_a_row_of_masses() {
    let text = r#"[mesh]
box = { element = "quad4", size = [1, 0.1], cells = [10, 1] }
[material]
young = 10e3
poisson = 0
density = 1000
thickness = 0.1
[[fit]]
objective = "frobenius"
springs = ["edge"]
[[fit]]
objective = "offdiag"
[[fix]]
where = "y > -1"
axes = ["y"]
[[fix]]
group = "xmin"
[output]
frequencies = 3
"#;
    let speed = (10e3f64 / 1000.0).sqrt();
    let free = edited(text, "[[fix]]\ngroup = \"xmin\"\n", "");
    for (text, rigid, place) in [(text.to_string(), 0, 0.5), (free, 1, 0.0)] {
        let outcome = outcome(&text);
        assert_eq!(outcome.frequencies.len(), 3);
        let finite = &outcome.frequencies[0];
        assert_eq!((finite.name.as_str(), finite.rigid), ("finite elements", rigid));
        for (i, f) in finite.frequencies.as_ref().unwrap().iter().enumerate() {
            let angle = PI * (i as f64 + 1.0 - place) / 20.0;
            assert_near(*f, speed * angle.sin() / (PI * 0.1), 1e-6 * f);
            let cosine = (2.0 * angle).cos();
            let square = 6.0 * speed * speed / (0.1 * 0.1) * (1.0 - cosine) / (2.0 + cosine);
            let consistent = finite.consistent.as_ref().unwrap()[i];
            assert_near(consistent, square.sqrt() / (2.0 * PI), 1e-6 * consistent);
        }
        let table = report::tables(&outcome);
        assert!(table.contains("relative to the finite elements with consistent masses"), "{table}");
        assert!(table.contains("Natural frequencies") && table.contains("rigid motion") == (rigid > 0), "{table}");
        let json: serde_json::Value = serde_json::from_str(&report::report(&outcome)).unwrap();
        assert_eq!(json["frequencies"][0]["frequencies"].as_array().unwrap().len(), 3);
        assert_eq!(json["frequencies"][0]["rigid_motions"], rigid);
    }
}

#[test]
fn a_disc_is_the_membrane_of_1607_springs() {
    let outcome = outcome_of("membrane");
    let mesh = &outcome.mesh;
    assert_eq!((mesh.point_count(), mesh.cell_count(), mesh.dimension), (558, 1050, 3));
    assert_eq!(mesh.groups["rim"].points.len(), 64);
    assert_eq!(outcome.fits[0].network.len(), 1607);
    let motion = outcome.motion.as_ref().unwrap();
    for model in &motion.models {
        assert_eq!((model.steps, &model.ending), (200, &MotionEnding::Complete));
        // The middle is where the instrument is.
        for record in &model.records {
            let t = record.account.time;
            assert_near(record.watched[2], -5e-4 * (1.0 - (6.0 * t).cos()), 1e-12);
        }
    }
}

/// `<DataSet timestep="…" file="…"/>` of a collection.
fn sets(pvd: &str) -> Vec<(f64, String)> {
    let value = |line: &str, key: &str| {
        let start = line.find(&format!("{key}=\"")).unwrap() + key.len() + 2;
        line[start..].split('"').next().unwrap().to_string()
    };
    let lines = pvd.lines().filter(|line| line.contains("<DataSet"));
    lines.map(|line| (value(line, "timestep").parse().unwrap(), value(line, "file"))).collect()
}

#[test]
fn a_motion_is_written_for_paraview_and_over_time() {
    let text = edited(BLOCK, "[[fit]]", "[output]\nvtu = true\n[[fit]]\nname = \"springs\"");
    // The reader of meshes knows no cells that are sets of points, as springs on a volume are.
    let text = edited(&text, ", \"bulk\"]", "]");
    let folder = holding("scene.toml", &text);
    let printed = prints(folder.path(), &["run", "scene.toml"]);
    let out = folder.path().join("out/scene");
    for stem in ["motion-finite-elements", "motion-springs"] {
        assert!(printed.contains(&format!("{stem}.pvd")) && printed.contains(&format!("{stem}.csv")), "{printed}");
        let sets = sets(&fs::read_to_string(out.join(format!("{stem}.pvd"))).unwrap());
        let times: Vec<f64> = sets.iter().map(|(time, _)| *time).collect();
        assert_eq!(times, [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]);
        for (_, file) in &sets {
            let source = MeshSource::read(&out.join(file)).unwrap();
            assert_eq!(source.points.len(), 64);
        }
        let first = MeshSource::read(&out.join(&sets[0].1)).unwrap();
        let last = MeshSource::read(&out.join(&sets[5].1)).unwrap();
        assert!(first.points != last.points);
        assert_eq!(fs::read_dir(out.join(stem)).unwrap().count(), 6);
        let csv = fs::read_to_string(out.join(format!("{stem}.csv"))).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        let head =
            ["t", "kinetic", "elastic", "total", "work", "dissipated", "drift", "px", "py", "pz", "ux", "uy", "uz"];
        assert_eq!(rows[0][..13], head);
        assert_eq!(rows[0].len(), if stem.ends_with("springs") { 14 } else { 13 });
        assert!(rows.len() == 7 && rows.iter().all(|row| row.len() == rows[0].len()));
        assert_eq!(rows[6][0], "0.05");
    }
    let json = json(&out.join("report.json"));
    assert_eq!(json["motion_options"]["integrator"], "newmark");
    assert_eq!(json["motion"][1]["name"], "springs");
    assert_eq!(json["motion"][1]["ended"], "complete");
    assert_eq!(json["motion"][1]["time"].as_array().unwrap().len(), 6);
    assert!(json["motion"][1]["e_rms_max"].as_f64().unwrap() > 0.0);
    let partial = fs::read_dir(&out).unwrap().any(|f| f.unwrap().file_name().to_string_lossy().contains("partial"));
    assert!(!partial);
}

/// It is found before the work, and nothing is written.
#[test]
fn a_series_that_cannot_be_written_has_no_collection() {
    let text = edited(BLOCK, "[[fit]]", "[output]\nvtu = true\n[[fit]]\nname = \"springs\"");
    let folder = holding("scene.toml", &text);
    let out = folder.path().join("out/scene");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("motion-springs"), "in the way").unwrap();
    let seen = springfit(folder.path(), &["run", "scene.toml"]);
    assert_eq!(seen.status.code(), Some(2));
    assert!(String::from_utf8(seen.stderr).unwrap().starts_with("error: out/scene/motion-springs: the folder cannot"));
    assert_eq!(fs::read_dir(&out).unwrap().count(), 1);
}

#[test]
fn a_scene_without_motion_does_none() {
    let still = BLOCK.split("[motion]").next().unwrap();
    let scene = Scene::parse(still, Path::new("scene.toml")).unwrap();
    let left_out: Vec<String> = stages(&scene).into_iter().filter_map(|(what, why)| why.map(|_| what)).collect();
    assert!(left_out.contains(&"motion".into()) && left_out.contains(&"natural frequencies".into()));
    let outcome =
        run(&scene, &mut |event| assert!(!matches!(event, Event::Stage { name, .. } if name.contains("motion"))))
            .unwrap();
    assert!(outcome.motion.is_none() && outcome.frequencies.is_empty());
    assert!(!report::tables(&outcome).contains("otion"));
    let json: serde_json::Value = serde_json::from_str(&report::report(&outcome)).unwrap();
    assert!(json["motion"].as_array().unwrap().is_empty() && json["motion_options"].is_null());
    let stages = stages(&Scene::parse(BLOCK, Path::new("scene.toml")).unwrap());
    let told = stages.iter().any(|(what, why)| {
        why.is_none() && what == "move finite elements and 1 networks for 0.05 s in 50 steps of 0.001 s by newmark"
    });
    assert!(told, "{stages:?}");
}

/// States are written at the first step at or after each multiple of `every`, and at the end.
/// A motion in which nothing acts is told, and one with any of the three is not.
#[test]
fn a_motion_of_nothing_is_told() {
    let still = BLOCK.split("[[motion.force]]").next().unwrap().replace("0.05\n", "0.003\n");
    let said = |text: &str| report::notes(&outcome(text)).join("\n");
    let words = "nothing moves: [motion] has neither gravity nor a pull nor a force";
    assert!(said(&still).contains(words), "{}", said(&still));
    assert!(said(&edited(&still, "every = 0.01", "gravity = [0, 0, 0]")).contains(words));
    assert!(!said(&edited(&still, "every = 0.01", "gravity = [0, 0, -1]")).contains(words));
    assert!(!said(&(still + "[[motion.force]]\ngroup = \"zmax\"\nforce = [0, 0, 1]\n")).contains(words));
}

#[test]
fn states_are_written_at_steps() {
    let text = edited(BLOCK, "every = 0.01", "every = 0.0125");
    let text = edited(&text, "duration = 0.05", "duration = 0.0302");
    let outcome = outcome(&edited(&text, "watch =", "finite_elements = false\nwatch ="));
    let motion = outcome.motion.unwrap();
    assert_eq!((motion.models.len(), motion.models[0].error()), (1, None));
    let times: Vec<usize> =
        motion.models[0].records.iter().map(|record| (record.account.time * 1e3).round() as usize).collect();
    assert_eq!(times, [0, 13, 25, 31]);
}

/// A note has the real end and says that states are not evenly apart; there is no such note where steps divide both times. Without `every` the
/// states are whole steps apart.
#[test]
fn times_that_steps_do_not_divide_are_told() {
    let short = edited(BLOCK, "watch =", "finite_elements = false\nwatch =");
    let notes = |text: &str| report::notes(&outcome(text)).join("\n");
    let told = notes(&short);
    assert!(!told.contains("no multiple"), "{told}");
    let longer = notes(&edited(&short, "duration = 0.05", "duration = 0.0502"));
    assert!(longer.contains("the motion ends at 0.051 s, with the first step that reaches 0.0502 s"), "{longer}");
    let uneven = notes(&edited(&short, "every = 0.01", "every = 0.0125"));
    assert!(uneven.contains("each multiple of 0.0125 s, which is no multiple of 0.001 s"), "{uneven}");
    let text = edited(&edited(&short, "every = 0.01\n", ""), "duration = 0.05", "duration = 0.15");
    let free = outcome(&text);
    let motion = free.motion.as_ref().unwrap();
    assert_near(motion.recipe.every, 0.002, 1e-15);
    assert_eq!(motion.models[0].records.len(), 76);
    assert!(!report::notes(&free).join("\n").contains("no multiple"));
}

/// One Newton iteration more than the linearised step does not solve a large step: such a motion is not called complete.
#[test]
fn a_motion_with_unsolved_steps_is_not_complete() {
    let text = edited(BLOCK, "linear = true\n", "iterations = 2\ntolerance = 1e-14\n");
    let text = edited(&text, "[\"0.01*sin(60*t)\", 0, \"0.1*t\"]", "[0, 0, \"4*t\"]");
    let outcome = outcome(&text);
    let springs = &outcome.motion.as_ref().unwrap().models[1];
    assert!(springs.unsolved > 0 && springs.steps == 50, "{}", springs.unsolved);
    assert_eq!(springs.ending, MotionEnding::Unsolved);
    assert!(report::tables(&outcome).contains(&format!("not solved in {} steps", springs.unsolved)));
    assert_eq!(report::Report::of(&outcome).motion[1].ended, "not solved");
}

/// Symplectic Euler within its limit, dampers beside the springs, BDF2 with Newton's method: all go where Newmark goes.
#[test]
fn methods_agree() {
    let motion = |from: &str, to: &str| {
        let text = edited(BLOCK, "integrator = \"newmark\"\nlinear = true", from);
        let text = edited(&text, "step = 0.001", to);
        outcome(&text).motion.unwrap().models.remove(1)
    };
    let newmark = motion("integrator = \"newmark\"\nlinear = true", "step = 0.0001").records[5].watched.clone();
    for (keys, step, tolerance) in [
        ("integrator = \"symplectic-euler\"", "step = 0.0001", 0.02),
        ("integrator = \"bdf2\"", "step = 0.0002", 0.02),
        ("integrator = \"implicit-euler\"\niterations = 2", "step = 0.0001", 0.05),
    ] {
        let other = motion(keys, step);
        assert_eq!(other.ending, MotionEnding::Complete);
        for (a, b) in other.records[5].watched.iter().zip(&newmark) {
            assert_near(*a, *b, tolerance * newmark[0].abs().max(newmark[2].abs()));
        }
    }
    let keys = "integrator = \"newmark\"\ndamping = { ratio = 0.5 }\nfinite_elements = false";
    let damped = outcome(&edited(BLOCK, "integrator = \"newmark\"\nlinear = true", keys)).motion.unwrap();
    assert!(damped.models[0].records[5].account.balance.unwrap().dissipated > 0.0);
}

/// With a law the finite elements are hyperelastic, and the springs turn and stretch.
/// At small strain one iteration is the solution, also of an exact network, whose springs and contents pull at rest against each other.
#[test]
fn one_iteration_is_the_linearised_step() {
    let text = BLOCK.replace("objective = \"modal\"\nsprings = [\"edge\", \"face diagonal\", \"body diagonal\", \"bulk\"]\nnonnegative = true", "objective = \"exact\"");
    let text = text.split("[[motion.force]]").next().unwrap().to_string() + "gravity = [1e-3, 0, -0.01]\n";
    let watched = |text: &str| -> Vec<Vec<f64>> {
        let found = outcome(text).motion.unwrap();
        found.models[1].records.iter().map(|record| record.watched.to_vec()).collect()
    };
    let linear = watched(&text);
    let one = watched(&edited(&text, "linear = true\n", "iterations = 1\n"));
    let size = linear.iter().flatten().fold(0.0f64, |size, u| size.max(u.abs()));
    for (a, b) in one.iter().flatten().zip(linear.iter().flatten()) {
        assert!((a - b).abs() < 1e-3 * size, "{one:?} {linear:?}");
    }
}

#[test]
fn bodies_with_a_law_move_at_large_deformation() {
    let text = edited(BLOCK, "density = 1000", "density = 1000\nlaw = \"neo-hookean\"");
    let text = edited(&text, "linear = true\n", "tolerance = 1e-6\n");
    let text = edited(&text, "cells = [3, 3, 3]", "cells = [2, 2, 2]");
    let motion = outcome(&text).motion.unwrap();
    assert!(motion.models.iter().all(|model| model.ending == MotionEnding::Complete && model.unsolved == 0));
    assert!(motion.models[1].error().unwrap()[0] < 5.0);
}

#[test]
fn wrong_keys_are_told() {
    let force = "group = \"zmax\"\nforce = [\"0.01*sin(60*t)\", 0, \"0.1*t\"]";
    let pull = "displacement = [\"free\", \"1e-4*(1 - cos(80*t))\", \"free\"]";
    let cases = [
        ("step = 0.001", "step = -0.001", "motion.step: … found -0.001"),
        ("step = 0.001", "step = nan", "motion.step: … found NaN"),
        ("step = 0.001", "step = 0.06", "motion.duration: … 0.06 s, found 0.05 s"),
        ("step = 0.001", "step = 1e-12", "motion.step: … at most 1e9 … found 5e10"),
        ("duration = 0.05", "duration = 0", "motion.duration: … found 0"),
        ("duration = 0.05", "duration = inf", "motion.duration: … found inf"),
        ("duration = 0.05\n", "", ":13: motion: missing field \"duration\""),
        ("\"newmark\"", "\"verlet\"", "motion.integrator: … found \"verlet\""),
        (
            "linear = true",
            "lineal = true",
            ":17: motion.lineal: unknown field \"lineal\", expected one of \"duration\", \"step\", \"integrator\", \
             \"iterations\", \"tolerance\", \"linear\", \"quasi-static\", \"error\", \"account\", \"precision\", \"solver\", \"remainder\", \"mass\", \"gravity\", \"damping\", \
             \"every\", \"watch\", \"finite_elements\", \"pull\", \"force\"",
        ),
        ("linear = true", "linear = true\niterations = 3", "motion.iterations: … found with linear = true"),
        ("linear = true", "solver = \"lu\"", "motion.solver: … found \"lu\""),
        (
            "integrator = \"newmark\"\nlinear = true",
            "integrator = \"symplectic-euler\"\nsolver = \"factor\"",
            "motion.solver: … found with integrator = \"symplectic-euler\"",
        ),
        ("linear = true", "precision = \"half\"", "motion.precision: … found \"half\""),
        (
            "linear = true",
            "precision = \"single\"",
            "motion.precision: … \"symplectic-euler\" … found with integrator = \"newmark\"",
        ),
        (
            "integrator = \"newmark\"\nlinear = true",
            "integrator = \"symplectic-euler\"\nlinear = true\nprecision = \"single\"",
            "motion.precision: … found with linear = true",
        ),
        ("linear = true", "linear = true\nremainder = 0.1", "motion.remainder: … solver = \"conjugate-gradients\""),
        (
            "linear = true",
            "solver = \"conjugate-gradients\"\nremainder = 1",
            "motion.remainder: … from 1e-15 … found 1.0",
        ),
        (
            "linear = true",
            "solver = \"conjugate-gradients\"\nremainder = 1e-170",
            "motion.remainder: … from 1e-15 … found 1e-170",
        ),
        ("watch =", "gravity = [0, 0, 1e300]\nwatch =", "motion.gravity: … found 1e300"),
        ("duration = 0.05\nstep = 0.001", "duration = 1e300\nstep = 1e299", "motion.duration: … found 1e300"),
        ("\"0.1*t\"", "\"sqrt(0.0499 - t)\"", "motion.force[0].force[2]: … found NaN at 0.05 s"),
        ("\"1e-4*(1 - cos(80*t))\"", "\"sqrt(0.05 - t)\"", "motion.pull[0].displacement[1]: … found NaN at 0.0505 s…"),
        ("linear = true", "iterations = 0", "motion.iterations: … found 0"),
        ("linear = true", "tolerance = 2", "motion.tolerance: … found 2"),
        ("every = 0.01", "every = 0.0005", "motion.every: … 0.001 s, found 0.0005 s"),
        ("every = 0.01", "every = -1", "motion.every: … found -1"),
        ("density = 1000\n", "", "material.density: … found none"),
        ("watch = { group = \"zmax\" }", "watch = { where = \"z > 1\" }", "motion.watch: … no points"),
        ("watch = { group = \"zmax\" }", "watch = {}", "motion.watch: … found neither"),
        ("watch = { group = \"zmax\" }", "watch = { group = \"top\" }", "motion.watch.group: … found \"top\""),
        ("watch =", "mass = \"nodal\"\nwatch =", "motion.mass: … found \"nodal\""),
        ("watch =", "gravity = [0, -9.81]\nwatch =", "motion.gravity: … 3 entries … found 2"),
        (
            "watch =",
            "damping = { ratio = 0.1 }\nwatch =",
            "motion.damping.ratio: … \"rayleigh\"… finite_elements = false",
        ),
        ("watch =", "damping = {}\nwatch =", "motion.damping: … found neither"),
        ("watch =", "damping = { rayleigh = [0.1, -1] }\nwatch =", "motion.damping.rayleigh: … found -1.0"),
        (
            pull,
            "displacement = [\"free\", \"0.1*s\", \"free\"]",
            "motion.pull[0].displacement[1]: … found the name \"s\" in \"0.1*s\"",
        ),
        (
            pull,
            "displacement = [\"free\", \"1/(t - 0.02)\", \"free\"]",
            "motion.pull[0].displacement[1]: … found inf at 0.02 s",
        ),
        (pull, "displacement = [\"free\", 0]", "motion.pull[0].displacement: … 3 entries … found 2"),
        (
            pull,
            "displacement = [\"free\", \"free\", \"free\"]",
            "motion.pull[0].displacement: … a direction that is moved, found \"free\" in all",
        ),
        (
            "where = \"x < 1e-9 && z > 0.0199\"",
            "group = \"zmin\"",
            "motion.pull[0].displacement[1]: … point 0 at [0.0, 0.0, 0.0] m along y… [[fix]] …",
        ),
        ("where = \"x < 1e-9 && z > 0.0199\"", "where = \"x > 1\"", "motion.pull[0]: … no points"),
        ("where = \"x < 1e-9 && z > 0.0199\"", "", "motion.pull[0]: … found neither"),
        (
            force,
            "group = \"zmax\"\nforce = [\"0.01*x\", 0, 0]",
            "motion.force[0].force[0]: … found the name \"x\" in \"0.01*x\"",
        ),
        (force, "group = \"zmin\"\nforce = [1, 0, 0]", "motion.force[0].force: … nothing …"),
        (force, "group = \"zmax\"\nforce = [\"ln(t)\", 0, 0]", "motion.force[0].force[0]: … found -inf at 0 s"),
        ("[motion]", "[output]\nfrequencies = 200\n[motion]", "output.frequencies: … at most 144, … found 200"),
        (
            "[motion]",
            "[output]\nfrequencies = -1\n[motion]",
            ":14: output.frequencies: invalid value: integer \"-1\", expected a whole number",
        ),
    ];
    let mut wrong = Vec::new();
    let mut expect = |text: &str, message: &str| {
        let folder = holding("scene.toml", text);
        let seen = springfit(folder.path(), &["run", "scene.toml"]);
        let line = said(&seen);
        let expected = format!("error: scene.toml{}{message}…\n", if message.starts_with(':') { "" } else { ":…: " });
        let clean = fs::read_dir(folder.path()).unwrap().count() == 1 && seen.stdout.is_empty();
        if reads(&line, &expected).is_err() || seen.status.code() != Some(2) || !clean {
            wrong.push(format!("expected {expected}found    {line} {:?} {clean}", seen.status));
        }
    };
    for (from, to, message) in cases {
        expect(&edited(BLOCK, from, to), message);
    }
    let twice = format!("{BLOCK}[[motion.pull]]\ngroup = \"zmax\"\ndisplacement = [0, 0, 0]\n");
    expect(&twice, "motion.pull[1].displacement[1]: … point 48 at [0.0, 0.0, 0.02] m along y… motion.pull[0] …");
    let many = edited(BLOCK, "duration = 0.05", "duration = 5000");
    let many = edited(&many, "every = 0.01", "every = 0.001");
    expect(&many, "motion.every: … at most 1000000 … found 5000000");
    let many = edited(&many, "every = 0.001", "every = 0.006");
    let many = edited(&many, "cells = [3, 3, 3]", "cells = [10, 10, 10]");
    expect(&many, "motion.every: … at most 125219 … found 833335");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_explicit_step_beyond_its_limit_is_refused_with_the_limit() {
    let text = edited(BLOCK, "integrator = \"newmark\"\nlinear = true", "integrator = \"symplectic-euler\"");
    let folder = holding("scene.toml", edited(&text, "step = 0.001", "step = 0.01"));
    let seen = springfit(folder.path(), &["run", "scene.toml"]);
    let line = String::from_utf8(seen.stderr).unwrap();
    assert_eq!(seen.status.code(), Some(2));
    assert!(
        line.starts_with("error: scene.toml:15: motion.step: expected at most ") && line.contains("found 1e-2 s"),
        "{line}"
    );
    assert!(!folder.path().join("out").exists());
}

/// Rounded to 6e-8 of the body, which is ten times as large as its motion; 500 steps. Without an account the state is rounded as well,
/// and work is not summed.
#[test]
fn single_precision_moves_a_scene_as_double_precision() {
    let moved = |keys: &str| {
        let keys = format!("integrator = \"symplectic-euler\"\n{keys}");
        let text = edited(BLOCK, "integrator = \"newmark\"\nlinear = true", &keys);
        outcome(&edited(&text, "step = 0.001", "step = 0.0001")).motion.unwrap()
    };
    let double = moved("");
    for (keys, has_balance) in [("precision = \"single\"", false), ("precision = \"single\"\naccount = true", true)] {
        let single = moved(keys);
        assert!(single.recipe.title().ends_with("in single precision"));
        let [a, b] = [&double, &single].map(|motion| &motion.models[1]);
        assert!(b.ending == MotionEnding::Complete && b.records.len() == a.records.len());
        let size = a.records.iter().flat_map(|record| &record.watched).fold(0.0f64, |size, u| size.max(u.abs()));
        for (a, b) in a.records.iter().zip(&b.records) {
            a.watched.iter().zip(&b.watched).for_each(|(a, b)| assert_near(*a, *b, 1e-5 * size));
            assert_near(a.account.elastic, b.account.elastic, 1e-4 * a.account.elastic);
            assert_eq!(b.account.balance.is_some(), has_balance);
        }
    }
}

/// A force is asked for until the end, not after it.
#[test]
fn a_force_may_end_with_the_motion() {
    let text = edited(BLOCK, "\"0.1*t\"", "\"sqrt(0.05 - t)\"");
    assert!(outcome(&text).motion.unwrap().models.iter().all(|model| model.ending == MotionEnding::Complete));
}

/// A cylinder with a network that releases energy, and one that does not.
fn cylinder(rest: &str) -> String {
    let mesh = place("scenes/meshes/cylinder_hex.msh");
    format!(
        "[mesh]\nfile = {mesh:?}\nscale = 0.01\n[material]\nyoung = 10e3\npoisson = 0.3\ndensity = 1000\n[[fit]]\n\
         objective = \"modal\"\nhigher = 0.316\n[[fit]]\nobjective = \"offdiag\"\n[[fix]]\ngroup = \"fixed\"\n{rest}"
    )
}

/// A network with negative springs is reported with its rate of growth. A motion whose linear step is too long for it is not begun, and the others are.
#[test]
fn an_indefinite_network_is_told() {
    let text = cylinder(
        "[output]\nfrequencies = 1\n[motion]\nduration = 0.02\nstep = 0.01\nlinear = true\ngravity = [0, 0, -1]\n",
    );
    let outcome = outcome(&text);
    let motion = outcome.motion.as_ref().unwrap();
    let [finite, indefinite, sound] = &motion.models[..] else { panic!("three models move") };
    assert!(finite.growth.is_none() && sound.growth.is_none());
    assert!(indefinite.growth.unwrap() > 100.0 && indefinite.records.is_empty());
    assert!(matches!(&indefinite.ending, MotionEnding::Refused(why) if why.contains("releases energy")));
    assert_eq!((sound.steps, &sound.ending), (2, &MotionEnding::Complete));
    assert!(outcome.frequencies[1].frequencies.is_none() && outcome.frequencies[2].frequencies.is_some());
    let notes = report::notes(&outcome).join("\n");
    for part in ["indefinite, the fastest-growing motion grows by a factor of e every", "208 spring", "was not started"]
    {
        assert!(notes.contains(part), "{notes}");
    }
    assert!(report::tables(&outcome).contains("not begun"));
    assert!(report::motion_csv(indefinite).lines().count() == 1);
    // However far the steps are solved, what is definite is decided alike.
    for remainder in ["0.9", "1e-15"] {
        let solver = format!("linear = true\nsolver = \"conjugate-gradients\"\nremainder = {remainder}");
        let outcome = kit::outcome(&edited(&text, "linear = true", &solver));
        let [_, indefinite, sound] = &outcome.motion.as_ref().unwrap().models[..] else { panic!("three models move") };
        assert!(matches!(&indefinite.ending, MotionEnding::Refused(why) if why.contains("releases energy")));
        assert_eq!((sound.steps, &sound.ending), (2, &MotionEnding::Complete));
    }
}

/// Both networks turn, and the first releases energy: without turning its springs run away, to errors of many millions of percent, which are
/// not errors of the fit.
#[test]
fn of_an_indefinite_network_no_error_is_that_of_the_fit() {
    let outcome = outcome(&cylinder("[motion]\nduration = 0.01\nstep = 0.001\ngravity = [200, 0, 0]\n"));
    let [_, indefinite, sound] = &outcome.motion.as_ref().unwrap().models[..] else { panic!("three models move") };
    assert!(indefinite.growth.is_some() && indefinite.ending == MotionEnding::Complete);
    assert!(indefinite.linear_error.is_none() && indefinite.error().is_some());
    assert!(sound.growth.is_none() && sound.linear_error.is_some());
    let notes = report::notes(&outcome).join("\n");
    assert_eq!(notes.matches("the fit's is").count(), 1, "{notes}");
}

/// A note prints the share of the energy that implicit Euler or BDF2 has dissipated. Newmark's method conserves the energy of a linear model.
#[test]
fn what_an_integrator_takes_is_told() {
    let found = |integrator: &str| {
        let outcome = outcome(&edited(BLOCK, "\"newmark\"", &format!("\"{integrator}\"")));
        let motion = outcome.motion.as_ref().unwrap();
        let drift = |model: &ModelMotion| model.records.last().unwrap().account.balance.as_ref().unwrap().drift;
        let lost = motion.models.iter().map(|model| -drift(model)).fold(0.0, f64::max);
        (lost, report::notes(&outcome).join("\n"))
    };
    for integrator in ["implicit-euler", "bdf2"] {
        let (lost, said) = found(integrator);
        let words = format!("{integrator} has taken {:.0} % of the largest energy from", 100.0 * lost);
        assert_eq!(said.contains(&words), lost > 0.01, "{lost}: {said}");
        assert!(lost > 0.01 || integrator == "bdf2", "{lost}");
    }
    let (lost, said) = found("newmark");
    assert!(lost < 1e-6 && !said.contains("has taken"), "{lost}: {said}");
}

/// A force of a thousand times the block's stiffness turns cells inside out: the run says so first, and the motion of a small force is trusted.
#[test]
fn a_motion_with_cells_inside_out_is_not_trusted() {
    let summary = |force: &str| {
        let text = edited(BLOCK, "force = [\"0.01*sin(60*t)\", 0, \"0.1*t\"]", &format!("force = [0, 0, \"{force}\"]"));
        let text = edited(&text, "linear = true\n", "");
        let outcome = outcome(&text);
        let inverted: Vec<usize> = outcome.motion.as_ref().unwrap().models.iter().map(|model| model.inverted).collect();
        (report::summary(&outcome), inverted)
    };
    let (said, inverted) = summary("-0.01*t");
    assert!(!said.contains("NOT TRUSTED") && inverted == [0, 0], "{said} {inverted:?}");
    let (said, _) = summary("-4e3*t");
    assert!(said.starts_with("NOT TRUSTED: the motion of finite elements ("), "{said}");
}
