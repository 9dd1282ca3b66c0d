//! The command line: parses, calls the library, prints, and sets the exit code.

mod arguments;

use arguments::{
    CheckArguments, Command, CommandLine, CompareArguments, DeriveArguments, FitArguments, PaperArguments,
    PlaneArgument, RunArguments, StabilityArguments,
};
use clap::Parser;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use springfit::element::Element;
use springfit::error::{Error, Result};
use springfit::fit::{ClosedForm, Weight};
use springfit::material::{Material, Plane, parse_pressure};
use springfit::mesh::{Gate, Mesh, MeshSource, Selection, vtk};
use springfit::model::Support;
use springfit::report::Comparison;
use springfit::springs::Springs;
use springfit::study::{
    Controls, Event, FitEntry, Index, Reference, Scene, WholeBody, fit_mesh, load_elements, run_with, stages,
};
use springfit::{model, report, study};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

fn main() -> ExitCode {
    // A file that may not grow further is an error like a full disk, not the end.
    #[cfg(unix)]
    #[allow(unsafe_code)]
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
    let command = CommandLine::parse().command;
    let done = |result: Result<()>| result.map(|()| ExitCode::SUCCESS);
    let result = match command {
        Command::Run(arguments) => done(run_scene(&arguments)),
        Command::Fit(arguments) => done(fit(&arguments)),
        Command::Check(arguments) => check(&arguments),
        Command::Derive(arguments) => done(derive(&arguments)),
        Command::Compare(arguments) => done(compare(&arguments)),
        Command::Paper(arguments) => done(paper(&arguments)),
        Command::Stability(arguments) => stability(&arguments),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            tell(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

fn run_scene(arguments: &RunArguments) -> Result<()> {
    let scene = Scene::load(&arguments.scene)?;
    if arguments.explain {
        let lines = stages(&scene).into_iter().map(|(stage, left_out)| match left_out {
            None => format!("run       {stage}\n"),
            Some(why) => format!("left out  {stage}: {why}\n"),
        });
        return print(&lines.collect::<String>());
    }
    let stem = arguments.scene.file_stem().unwrap_or_default();
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(stem));
    springfit::check_folder(&folder)?;
    let controls = Arc::new(Controls { checkpoint: arguments.checkpoint.clone(), ..Controls::default() });
    if scene.fits().iter().any(|fit| fit.recipe.whole().is_some()) {
        end_early(&controls);
    } else if arguments.checkpoint.is_some() {
        return Err(Error::at("--checkpoint", "goes with fits whose objective is \"whole\", found none in the scene"));
    }
    let mut bar = Bar::new();
    let outcome = run_with(&scene, &controls, &mut |event| bar.show(event))?;
    bar.clear();
    // Files first: who reads the table may have gone away.
    let paths = report::write_outputs(&outcome, scene.output(), &folder);
    print(&format!("{}\n{}", report::summary(&outcome), report::table(&outcome)))?;
    notes(&outcome);
    written(&paths?)
}

fn notes(outcome: &study::Outcome) {
    report::notes(outcome).iter().for_each(|note| tell(&format!("note: {note}")));
}

/// A line on standard error; if nobody can read it, nothing is lost.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// The first interrupt ends whole-object fits at their best point, the second the program.
fn end_early(controls: &Arc<Controls>) {
    let controls = controls.clone();
    // Without a handler an interrupt ends the program at once, as it does anyway.
    let _ = ctrlc::set_handler(move || {
        if controls.cancelled.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        tell("ending the whole-object fits where they are; again to end at once");
    });
}

fn fit(arguments: &FitArguments) -> Result<()> {
    let ending = arguments.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if !["vtu", "json", "csv"].contains(&ending) {
        return Err(Error::expected("--output", "a file ending in .vtu, .json or .csv", arguments.output.display()));
    }
    springfit::check_file(&arguments.output)?;
    let young = parse_pressure(&arguments.young).map_err(|e| e.under("--young"))?;
    // Of the fits that serve every element alike, the one with the least error among those that always stand.
    let chosen = arguments.objective.clone();
    let nonnegative = arguments.nonnegative || chosen.is_none();
    let mut shapes = toml::Table::new();
    shapes.extend(arguments.shapes.map(|count| ("count".into(), (count as i64).into())));
    shapes.extend(arguments.stretch.map(|stretch| ("stretch".into(), stretch.into())));
    let entry = FitEntry::new(chosen.unwrap_or("offdiag".into()))
        .with_springs(arguments.springs.clone())
        .with("weight", arguments.weight.clone())
        .with("higher", arguments.higher)
        .with("balance", arguments.balance)
        .with("tied", arguments.tied.then_some(true))
        .with("nonnegative", nonnegative.then_some(true))
        .with("force", arguments.force.clone())
        .with("shapes", Some(shapes).filter(|shapes| !shapes.is_empty()))
        .with("law", arguments.law.clone());
    let named = entry.fits(Path::new("")).map_err(|e| e.placed(Error::of_option))?.remove(0);
    let whole = named.recipe.whole().is_some();
    let sampled = !whole && named.recipe.sampled().is_some();
    if whole == arguments.fix.is_empty() {
        let problem = "goes with the objective \"whole\", and that with it: a group of the mesh that is held";
        return Err(Error::at("--fix", problem));
    }
    if sampled && arguments.law.is_none() {
        let problem = "goes with the objective \"sampled\": the energy whose forces are sampled";
        return Err(Error::at("--law", problem));
    }
    if !(arguments.scale > 0.0 && arguments.scale.is_finite()) {
        return Err(Error::expected("--scale", "a positive number of metres per mesh unit", arguments.scale));
    }
    if let Some(density) = arguments.density.filter(|d| !(*d > 0.0 && d.is_finite())) {
        return Err(Error::expected("--density", "a positive number of kg/m³", density));
    }
    let own = load_elements(&arguments.element, Path::new(""))
        .map_err(|e| e.placed(|e| Error::at("--element", e.problem())))?;
    let source = MeshSource::read(&arguments.mesh)?;
    let asked = arguments.below.is_some() || arguments.least.is_some();
    let gate = Gate::named(arguments.below.as_deref(), arguments.least).map_err(Error::of_option)?;
    let mesh = Mesh::resolve_within(&source, &own, arguments.scale, asked.then_some(gate));
    let mesh = mesh.map_err(|e| e.in_file(&arguments.mesh))?;
    let plane = arguments.plane.map(plane);
    let material = Material::for_body(mesh.cell_dimension(), young, arguments.poisson, plane, arguments.thickness)
        .and_then(|m| arguments.area.map_or(Ok(m), |area| m.with_area(area)))
        .map_err(Error::of_option)?;
    let mut support = Support::free(&mesh);
    let directions: Vec<usize> = (0..mesh.dimension).collect();
    for group in &arguments.fix {
        let points = Selection::Group(group.clone()).points(&mesh).map_err(|e| Error::at("--fix", e.problem()))?;
        support.fix(&points, &directions, mesh.dimension);
    }
    let controls = Arc::new(Controls::default());
    if whole {
        end_early(&controls);
    }
    let body = whole.then(|| WholeBody::new(&mesh, material, &support, &controls));
    let reference = Reference { large: None, whole: body.as_ref() };
    let mut bar = Bar::new();
    let mut progress = |event: Event| bar.show(event);
    let outcome = fit_mesh(&mesh, material, &reference, &named, &mut progress);
    let outcome = outcome.map_err(|e| if sampled || whole { e.placed(Error::of_option) } else { e })?;
    bar.clear();
    let masses = arguments.density.map(|density| model::masses(&mesh, density, material.thickness()));
    match ending {
        "vtu" => vtk::write(&arguments.output, &report::network_grid(&mesh, masses.as_deref(), &outcome, &[]))?,
        "json" => write(&arguments.output, &report::network_json(&mesh, masses.as_deref(), &outcome.network))?,
        _ => write(&arguments.output, &report::network_csv(&outcome.network))?,
    }
    let outcome = study::Outcome::of_fit(arguments.mesh.display().to_string(), mesh, material, masses, outcome);
    print(&format!("{}\n{}", report::summary(&outcome), report::table(&outcome)))?;
    notes(&outcome);
    print(&format!("written: {}\n", arguments.output.display()))
}

fn check(arguments: &CheckArguments) -> Result<ExitCode> {
    let mut files = Vec::new();
    for what in &arguments.what {
        let path = Path::new(what);
        if !path.is_dir() {
            files.push(what.clone());
            continue;
        }
        let before = files.len();
        files.extend(springfit::files_in(path, "toml")?.iter().map(|file| file.display().to_string()));
        if files.len() == before {
            return Err(Error::new("expected element files that end in .toml, found none").in_file(path));
        }
    }
    let mut bar = Bar::new();
    let mut inspections = Vec::new();
    for (done, file) in files.iter().enumerate() {
        bar.show(Event::stage("check", done, files.len()));
        let loaded = Element::load(file);
        // A file that is not there is no fault of an element.
        if let (Err(error), false) = (&loaded, Path::new(file).is_file()) {
            return Err(error.clone());
        }
        let inspection = study::inspect(file, loaded);
        if !arguments.json {
            bar.clear();
            print(&(report::check_text(&inspection) + "\n"))?;
        }
        inspections.push(inspection);
    }
    bar.clear();
    if arguments.json {
        print(&report::check_json(&inspections))?;
    } else {
        let failed = inspections.iter().filter(|i| !i.passes()).count();
        print(&format!("{} of {} files pass\n", inspections.len() - failed, inspections.len()))?;
    }
    Ok(if inspections.iter().all(|i| i.passes()) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn derive(arguments: &DeriveArguments) -> Result<()> {
    let element = Element::load(&arguments.element)?;
    let plane = match (element.dimension(), arguments.plane) {
        (2, Some(PlaneArgument::Strain)) => Some(Plane::Strain),
        (2, _) => Some(Plane::Stress),
        (_, Some(_)) => return Err(Error::at("--plane", format!("expected a plane element, found {}", element.name))),
        _ => None,
    };
    let springs = Springs::select(&element, arguments.springs.as_deref()).map_err(Error::of_option)?;
    let mut bar = Bar::new();
    bar.show(Event::stage("closed form", 0, 1));
    let form = ClosedForm::new(&element, &springs, arguments.sides)?;
    let fits = [Weight::None, Weight::OffDiagonal].map(|weight| form.fit(weight));
    bar.clear();
    let derivation =
        report::Derivation { element: &element, form: &form, fits: &fits, plane, matrix: arguments.matrix };
    print(&if arguments.latex { derivation.latex() } else { derivation.text() })
}

fn compare(arguments: &CompareArguments) -> Result<()> {
    let path = Path::new(&arguments.what);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(format!("compare-{stem}")));
    springfit::check_folder(&folder)?;
    let mut bar = Bar::new();
    let mut progress = |event: Event| bar.show(event);
    if arguments.law.is_some() && is_scene(path) {
        return Err(Error::at("--law", "goes with an element; a scene names it in its material"));
    }
    let comparison = if is_scene(path) {
        Comparison::of_scene(&study::compare_scene(&Scene::load(path)?, &mut progress)?)
    } else {
        let element = Element::load(&arguments.what)?;
        let plane = arguments.plane.map(plane);
        let material =
            Material::for_body(element.dimension(), 10e3, arguments.poisson, plane, None).map_err(Error::of_option)?;
        if let Some(law) = &arguments.law {
            let element = Arc::new(element);
            let study = study::compare_stretches(&element, material, law, arguments.stretch, &mut progress);
            let study = study.map_err(|e| e.placed(Error::of_option))?;
            bar.clear();
            let paths = report::write_stretches(&study, &folder);
            print(&report::stretches_text(&study))?;
            return written(&paths?);
        }
        if arguments.iterations == 0 {
            return Err(Error::expected("--iterations", "a number above 0", 0));
        }
        let (shapes, iterations) = (arguments.shapes, arguments.iterations);
        let outcomes = study::compare_element(&element, material, shapes, iterations, &mut progress)
            .map_err(|e| e.placed(Error::of_option))?;
        let title = format!("{}: {shapes} random shapes, nu = {}, one thread", element.name, arguments.poisson);
        Comparison::of_element(title, &outcomes, material.young())
    };
    bar.clear();
    let paths = comparison.write(&folder);
    print(&comparison.table())?;
    written(&paths?)
}

fn paper(arguments: &PaperArguments) -> Result<()> {
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join("paper"));
    springfit::check_folder(&folder)?;
    let index = arguments.index.as_ref().map_or_else(Index::shipped, |path| Index::load(path))?;
    index.expect(&arguments.table).map_err(Error::of_option)?;
    let path = match &arguments.index {
        Some(path) => path.clone(),
        None => study::write_experiments(&folder.join("scenes"))?,
    };
    let mut bar = Bar::new();
    let paper = study::run_paper(&index, &arguments.table, &path, &mut |event| bar.show(event));
    bar.clear();
    let paper = paper.map_err(|e| e.placed(Error::of_option))?;
    let written = report::write_paper(&paper, &folder);
    for table in &paper.tables {
        print(&(report::paper_text(table) + "\n"))?;
    }
    let written = written?;
    print(&format!("written: {} files in {}\n", written.len(), folder.display()))
}

fn stability(arguments: &StabilityArguments) -> Result<ExitCode> {
    let what = arguments.what.as_deref();
    let stem = what.map(|what| Path::new(what).file_stem().unwrap_or_default().to_string_lossy());
    let name = stem.map_or("stability".to_string(), |stem| format!("stability-{stem}"));
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(name));
    springfit::check_folder(&folder)?;
    let mut bar = Bar::new();
    let mut progress = |event: Event| bar.show(event);
    let outcome = match what {
        Some(path) if is_scene(Path::new(path)) => study::sweep_scene(&Scene::load(Path::new(path))?, &mut progress)?,
        _ => study::sweep(what.map(Element::load).transpose()?, &mut progress)?,
    };
    bar.clear();
    let paths = report::write_stability(&outcome, &folder);
    print(&report::stability_text(&outcome))?;
    written(&paths?)?;
    Ok(if outcome.lost().count() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn written(paths: &[PathBuf]) -> Result<()> {
    paths.iter().try_for_each(|path| print(&format!("written: {}\n", path.display())))
}

fn plane(argument: PlaneArgument) -> Plane {
    match argument {
        PlaneArgument::Stress => Plane::Stress,
        PlaneArgument::Strain => Plane::Strain,
    }
}

/// Whether a file is a scene: it has a `[mesh]`, where an element has nodes. What cannot be read is told as an element.
fn is_scene(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.lines().any(|line| line.trim_start().starts_with("[mesh]") || line.trim_start().starts_with("mesh."))
}

fn write(path: &Path, text: &str) -> Result<()> {
    springfit::write_whole(path, text.as_bytes())
}

/// Prints to standard output; a reader who has gone away, as `head` does, ends the program quietly.
fn print(text: &str) -> Result<()> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Ok(()) => Ok(()),
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => std::process::exit(0),
        Err(e) => Err(Error::new(format!("standard output cannot be written: {e}"))),
    }
}

/// A progress bar that appears on a terminal once work has taken a second.
struct Bar {
    start: Instant,
    bar: Option<ProgressBar>,
}

impl Bar {
    fn new() -> Bar {
        Bar { start: Instant::now(), bar: None }
    }

    fn show(&mut self, event: Event) {
        let (name, done, total) = match event {
            Event::Stage { name, done, total } => (name, done, total),
            Event::Note(note) => {
                self.clear();
                return tell(&format!("note: {note}"));
            }
        };
        if self.bar.is_none() && std::io::stderr().is_terminal() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            self.bar = Some(style.into_iter().fold(bar, ProgressBar::with_style));
        }
        if let Some(bar) = &self.bar {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            bar.set_message(name.to_string());
        }
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
