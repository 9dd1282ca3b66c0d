//! What fits and models cost: which costs a run has, and that each is of what it says.

use crate::kit::{outcome, write_run};
use springfit_report::report::{Cost, Figure, Picture, Report, RunFolder, Table};
use springfit_studies::study::{FitOutcome, Outcome, Scene, Times, run};
use std::path::Path;
use tempfile::TempDir;

const BOX: &str = r#"[mesh]
box = { element = "quad4", size = [2, 1], cells = [6, 3] }
[material]
young = 1000
poisson = 0.3
thickness = 0.01
[[fit]]
objective = "frobenius"
[[fit]]
objective = "spectral"
[[fit]]
objective = "whole"
loads = ["pull"]
validate = ["shear"]
[[fix]]
group = "xmin"
[[load]]
name = "pull"
group = "xmax"
traction = [1, 0]
[[load]]
name = "shear"
group = "xmax"
traction = [0, 1]
"#;

fn timed(text: &str) -> Outcome {
    outcome(&format!("{text}[output]\ntime = true\n"))
}

fn is_sound(times: &Times) -> bool {
    let sorted = times.least > 0.0 && times.median >= times.least && times.seconds.len() == times.passes;
    sorted && times.passes >= 5 && times.seconds.iter().all(|seconds| *seconds >= times.least)
}

/// Every fit and every model has all its costs, each with passes that together take long enough to be told.
#[test]
fn a_run_that_is_timed_has_all_costs() {
    let outcome = timed(BOX);
    for fit in &outcome.fits {
        let (times, model) = (fit.times.as_ref().unwrap(), fit.model_times.as_ref().unwrap());
        let all = [Some(&times.constants), Some(&times.assembly), Some(&times.moduli), model.solve.as_ref()];
        let steps = [model.explicit_step.as_ref(), model.implicit_step.as_ref()];
        assert!(all.into_iter().chain(steps).all(|times| is_sound(times.unwrap())), "{}", fit.fit.name);
        assert_eq!(times.errors.is_some(), fit.fit.recipe.whole().is_none(), "{}", fit.fit.name);
        // Where little of a pass is the fit, there are many.
        assert!(times.constants.seconds.iter().sum::<f64>() > 0.01 || times.constants.passes >= 100);
        // A pass of steps is of many, and long enough for a look at the clock not to be seen: some dozens of passes take as long as is asked.
        assert!(steps.iter().all(|times| (5..300).contains(&times.unwrap().passes)), "{}: {steps:?}", fit.fit.name);
        // Without a density the longest step is not known.
        assert!(model.longest_step.is_none() && model.simulated_second.is_none());
    }
    let body = outcome.model_times.as_ref().unwrap();
    assert!([&body.solve, &body.explicit_step, &body.implicit_step].iter().all(|t| is_sound(t.as_ref().unwrap())));
    // The longest step is that of the stiffest motion: ρ ten times larger makes it √10 times as long.
    let step = |density: &str| {
        let text = BOX.replace("poisson = 0.3", &format!("poisson = 0.3\ndensity = {density}"));
        timed(&text).fits[0].model_times.as_ref().unwrap().longest_step.unwrap()
    };
    assert!((step("1000") / step("100") - 10f64.sqrt()).abs() < 1e-6);
}

/// A second of motion is that of explicit steps, and of a network for an engine that of its own steps, which grows with the sweeps.
#[test]
fn a_simulated_second_is_that_of_the_steps_that_move_the_network() {
    let engine = |substeps: usize| {
        let fit = "[[fit]]\nname = \"NAME\"\nobjective = \"offdiag\"\nsprings = \"all + volume\"\nnonnegative = true\n";
        let keys = format!("engine = {{ method = \"xpbd\", step = \"1/30 s\", substeps = {substeps} }}\n");
        fit.replace("NAME", &format!("of {substeps}")) + &keys
    };
    let bar = BOX.replace("quad4", "tri3").replace("poisson = 0.3", "poisson = 0.3\ndensity = 1000");
    let text = bar.replace("[[fix]]", &format!("{}{}[[fix]]", engine(40), engine(400)));
    let outcome = timed(&text);
    let model = |name: &str| outcome.fits.iter().find(|f| f.fit.name == name).unwrap().model_times.as_ref().unwrap();
    let plain = model("frobenius");
    let second = plain.simulated_second.as_ref().unwrap();
    let steps = 1.0 / (0.5 * plain.longest_step.unwrap());
    assert!((second.median / (steps * plain.explicit_step.as_ref().unwrap().median) - 1.0).abs() < 1e-9);
    assert!(outcome.model_times.as_ref().unwrap().simulated_second.is_some());
    let of = |name: &str| model(name).simulated_second.as_ref().unwrap().clone();
    assert!(is_sound(&of("of 40")));
    let growth = of("of 400").least / of("of 40").least;
    assert!((7.0..13.0).contains(&growth), "ten times the substeps take {growth} times as long");
    // The table and the figure have it.
    let costs = Table::all(&Report::of(&outcome)).into_iter().find(|table| table.name == "costs").unwrap();
    assert!(costs.csv().lines().next().unwrap().contains("\"simulated second: median, s\""), "{}", costs.csv());
    let scene = Scene::parse(&text, Path::new("s.toml")).unwrap();
    let folder = TempDir::new().unwrap();
    write_run(&scene, &outcome, folder.path());
    let run = RunFolder::at(folder.path());
    match Figure::WorkPrecision.picture(&run, None, None, Some(Cost::Second)).unwrap() {
        Picture::Chart(chart) => {
            assert_eq!(chart.x.title, "processor time of a simulated second, s (median)");
            let names: Vec<&str> = chart.series.iter().map(|series| &*series.name).collect();
            assert!(names.iter().any(|name| name.starts_with("of 40")), "{names:?}");
        }
        Picture::Moduli(_) | Picture::Deformation(_) => panic!("no chart"),
    }
}

/// The time of an element is that of all divided by those that were fitted: all cells of this box are congruent.
#[test]
fn the_time_of_an_element_does_not_count_copies() {
    let outcome = timed(BOX);
    let fit = |name: &str| outcome.fits.iter().find(|fit| fit.fit.name == name).unwrap();
    let of = |fit: &FitOutcome, fitted: usize| {
        let times = fit.times.as_ref().unwrap();
        assert!((times.element.median * fitted as f64 / times.constants.median - 1.0).abs() < 1e-12);
        assert_eq!(fit.seconds_per_element(18), times.element.median);
    };
    assert_eq!(fit("spectral").reused, 17);
    of(fit("spectral"), 1);
    of(fit("frobenius"), 18);
    let plain = self::outcome(BOX);
    let spectral = plain.fits.iter().find(|fit| fit.fit.name == "spectral").unwrap();
    assert_eq!(spectral.seconds_per_element(18), spectral.seconds);
    assert!(spectral.times.is_none() && spectral.model_times.is_none() && plain.model_times.is_none());
    let record = Report::of(&plain);
    assert_eq!(record.fits.iter().find(|fit| fit.name == "spectral").unwrap().fitted_elements, 1);
    // Without repeats the table says that the time is of one pass.
    let heading = |report: &Report| Table::all(report)[1].text();
    assert!(heading(&record).contains("fit once") && heading(&Report::of(&outcome)).contains("fit median"));
}

/// A network that is not stable has no solution to time, and its steps still have a cost. At large deformation a solution is all of
/// Newton's steps.
#[test]
fn what_has_no_solution_has_no_cost_of_one() {
    let brick = BOX.replace("quad4", "hex8").replace("[2, 1]", "[2, 1, 1]").replace("[6, 3]", "[3, 2, 2]");
    let brick = brick.replace("thickness = 0.01\n", "").replace("[1, 0]", "[1, 0, 0]").replace("[0, 1]", "[0, 1, 0]");
    let springs = "[[fit]]\nobjective = \"frobenius\"\nsprings = [\"edge\"]\n[[fix]]";
    let loose = timed(&brick.replace("[[fix]]", springs));
    let fit = loose.fits.last().unwrap();
    let model = fit.model_times.as_ref().unwrap();
    assert!(fit.status() != "stable" && model.solve.is_none() && model.explicit_step.is_some(), "{}", fit.status());
    let large = BOX.replace("poisson = 0.3", "poisson = 0.3\nlaw = \"neo-hookean\"").replace("\"whole\"", "\"exact\"");
    let large = large
        .replace("loads = [\"pull\"]\nvalidate = [\"shear\"]\n", "")
        .replace("objective = \"exact\"\n", "objective = \"offdiag\"\n");
    let large = timed(&large);
    let of_newton = large.fits[0].model_times.as_ref().unwrap().solve.as_ref().unwrap().median;
    assert!(is_sound(large.model_times.as_ref().unwrap().solve.as_ref().unwrap()) && of_newton > 0.0);
}

#[test]
fn figures_have_each_cost_and_name_its_kind() {
    let scene = Scene::parse(&format!("{BOX}[output]\ntime = true\n"), Path::new("s.toml")).unwrap();
    let folder = TempDir::new().unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    write_run(&scene, &outcome, folder.path());
    let run = RunFolder::at(folder.path());
    let axis = |cost: Cost| match Figure::WorkPrecision.picture(&run, None, None, Some(cost)).unwrap() {
        Picture::Chart(chart) => (chart.x.title.clone(), chart.series.len()),
        Picture::Moduli(_) | Picture::Deformation(_) => panic!("no chart"),
    };
    assert_eq!(axis(Cost::Fit), ("processor time to fit, µs per element (median)".into(), 3));
    // The finite elements have a cost of a solution, and of a step.
    assert_eq!(axis(Cost::Solve), ("processor time of a solution, ms (median)".into(), 4));
    assert_eq!(axis(Cost::ExplicitStep).1, 4);
    assert_eq!(axis(Cost::ImplicitStep).1, 4);
    let wrong = Figure::Constants.picture(&run, None, None, Some(Cost::Solve)).unwrap_err().to_string();
    assert_eq!(wrong, "--cost: expected the figure work-precision, found solve");
}

#[test]
fn costs_that_were_not_measured_are_asked_for() {
    let scene = Scene::parse(BOX, Path::new("s.toml")).unwrap();
    let folder = TempDir::new().unwrap();
    write_run(&scene, &outcome(BOX), folder.path());
    let run = RunFolder::at(folder.path());
    let wrong = Figure::WorkPrecision.picture(&run, None, None, Some(Cost::Solve)).unwrap_err().to_string();
    assert!(wrong.contains("has no costs of models: springfit run --time measures them"), "{wrong}");
}
