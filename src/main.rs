//! The command line: parses, calls the library, prints, and sets the exit code.

use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use springfit::element::Element;
use springfit::error::{Error, Result};
use springfit::fit::{Choices, ClosedForm, Fit, Objective, Solver, Weight};
use springfit::material::{Material, Plane, parse_pressure};
use springfit::mesh::{Mesh, MeshSource, vtk};
use springfit::report::Comparison;
use springfit::springs::Springs;
use springfit::study::{NamedFit, Scene, fit_mesh, load_elements, run, stages};
use springfit::{model, report, study};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Mass-spring models that answer like finite elements.
#[derive(Parser)]
#[command(version, about)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Fit, solve and compare a scene
    Run(RunArguments),
    /// Fit the springs of a mesh, without a scene
    Fit(FitArguments),
    /// Prove element files: one line per property, exit code 1 if one fails
    Check(CheckArguments),
    /// Exact closed forms of an element's stiffness and spring constants
    Derive(DeriveArguments),
    /// Objectives and solvers side by side: error against run time, on random shapes of an element or on a scene
    Compare(CompareArguments),
}

#[derive(Args)]
struct CheckArguments {
    /// Element files, folders of them, or names of shipped elements
    #[arg(required = true)]
    what: Vec<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct DeriveArguments {
    /// A shipped element's name, or an element file
    element: String,
    /// Lengths a, b, c along the axes as variables, instead of the reference cell
    #[arg(long)]
    sides: bool,
    /// Plane element: stress or strain, for the constants in terms of E and nu [default: stress]
    #[arg(long)]
    plane: Option<PlaneArgument>,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    springs: Option<Vec<String>>,
    /// Print the stiffness matrix as well
    #[arg(long)]
    matrix: bool,
    /// Print LaTeX
    #[arg(long)]
    latex: bool,
}

#[derive(Args)]
struct CompareArguments {
    /// A shipped element's name, an element file, or a scene
    what: String,
    /// Random shapes of an element
    #[arg(long, default_value_t = 100)]
    shapes: usize,
    /// Iterations of the general optimisers
    #[arg(long, default_value_t = Solver::DEFAULT_ITERATIONS)]
    iterations: u64,
    /// Poisson's ratio, for an element
    #[arg(long, default_value_t = 0.3, allow_hyphen_values = true)]
    poisson: f64,
    /// Where table.csv and plot.svg go [default: out/compare-NAME]
    #[arg(long)]
    out: Option<PathBuf>,
}

#[derive(Args)]
struct RunArguments {
    /// The scene file
    scene: PathBuf,
    /// Where the report goes [default: out/NAME of the scene]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Say which stages will run and which are left out, and stop
    #[arg(long)]
    explain: bool,
}

#[derive(Args)]
struct FitArguments {
    /// The mesh: .msh, .vtu or .vtk
    mesh: PathBuf,
    /// Young's modulus, such as 10kPa
    #[arg(long, allow_hyphen_values = true)]
    young: String,
    /// Poisson's ratio
    #[arg(long, allow_hyphen_values = true)]
    poisson: f64,
    /// frobenius, offdiag or modal [default: offdiag with --nonnegative]
    #[arg(long)]
    objective: Option<String>,
    /// What counts: none, offdiag, modal or relative (with the objectives frobenius and spectral)
    #[arg(long)]
    weight: Option<String>,
    /// Scale of the modes beyond constant strain (modal only)
    #[arg(long)]
    higher: Option<f64>,
    /// From 0, which errs to the soft side, to 1 (divergence only)
    #[arg(long)]
    balance: Option<f64>,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    springs: Option<Vec<String>>,
    /// One constant per group
    #[arg(long)]
    tied: bool,
    /// No constant below zero
    #[arg(long)]
    nonnegative: bool,
    /// Plane mesh or surface: stress or strain [default: stress]
    #[arg(long)]
    plane: Option<PlaneArgument>,
    /// Plane mesh or surface: thickness in m [default: 1]
    #[arg(long, allow_hyphen_values = true)]
    thickness: Option<f64>,
    /// Mesh of lines: cross-section in m² [default: 1]
    #[arg(long, allow_hyphen_values = true)]
    area: Option<f64>,
    /// In kg/m³; gives the points masses
    #[arg(long, allow_hyphen_values = true)]
    density: Option<f64>,
    /// Mesh units to metres
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true)]
    scale: f64,
    /// An element file to look in before the shipped ones; may be repeated
    #[arg(long)]
    element: Vec<String>,
    /// Where the springs go: .vtu, .json or .csv
    #[arg(short, long)]
    output: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum PlaneArgument {
    Stress,
    Strain,
}

fn main() -> ExitCode {
    let command = CommandLine::parse().command;
    let done = |result: Result<()>| result.map(|()| ExitCode::SUCCESS);
    let result = match command {
        Command::Run(arguments) => done(run_scene(&arguments)),
        Command::Fit(arguments) => done(fit(&arguments)),
        Command::Check(arguments) => check(&arguments),
        Command::Derive(arguments) => done(derive(&arguments)),
        Command::Compare(arguments) => done(compare(&arguments)),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
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
    let mut bar = Bar::new();
    let outcome = run(&scene, &mut |stage, done, total| bar.show(stage, done, total))?;
    bar.clear();
    print(&format!("{}\n{}", report::summary(&outcome), report::table(&outcome)))?;
    for note in report::notes(&outcome) {
        eprintln!("note: {note}");
    }
    for path in report::write_outputs(&outcome, &scene.output, &folder)? {
        print(&format!("written: {}\n", path.display()))?;
    }
    Ok(())
}

fn fit(arguments: &FitArguments) -> Result<()> {
    let ending = arguments.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if !["vtu", "json", "csv"].contains(&ending) {
        return Err(Error::expected("--output", "a file ending in .vtu, .json or .csv", arguments.output.display()));
    }
    let young = parse_pressure(&arguments.young).map_err(|e| e.under("--young"))?;
    // Of the fits that serve every element alike, the one with the least error among those that always stand.
    let chosen = arguments.objective.as_deref();
    let choices = Choices { weight: arguments.weight.as_deref(), higher: arguments.higher, balance: arguments.balance };
    let objective = Objective::named(chosen.unwrap_or("offdiag"), choices).map_err(Error::of_option)?;
    if !(arguments.scale > 0.0 && arguments.scale.is_finite()) {
        return Err(Error::expected("--scale", "a positive number of metres per mesh unit", arguments.scale));
    }
    if let Some(density) = arguments.density.filter(|d| !(*d > 0.0 && d.is_finite())) {
        return Err(Error::expected("--density", "a positive number of kg/m³", density));
    }
    let own = load_elements(&arguments.element, Path::new(""))
        .map_err(|e| e.placed(|e| Error::at("--element", e.problem())))?;
    let source = MeshSource::read(&arguments.mesh)?;
    let mesh = Mesh::resolve(&source, &own, arguments.scale).map_err(|e| e.in_file(&arguments.mesh))?;
    let plane = arguments.plane.map(|p| match p {
        PlaneArgument::Stress => Plane::Stress,
        PlaneArgument::Strain => Plane::Strain,
    });
    let material = Material::for_body(mesh.cell_dimension(), young, arguments.poisson, plane, arguments.thickness)
        .and_then(|m| arguments.area.map_or(Ok(m), |area| m.with_area(area)))
        .map_err(Error::of_option)?;
    let nonnegative = arguments.nonnegative || chosen.is_none();
    let fit = Fit { tied: arguments.tied, nonnegative, ..Fit::new(objective) };
    let mut bar = Bar::new();
    let named = NamedFit::new(fit, arguments.springs.clone());
    let outcome = fit_mesh(&mesh, material, None, &named, &mut |stage, done, total| bar.show(stage, done, total))?;
    bar.clear();
    let masses = arguments.density.map(|density| model::masses(&mesh, density, material.thickness()));
    match ending {
        "vtu" => vtk::write(&arguments.output, &report::network_grid(&mesh, masses.as_deref(), &outcome, &[]))?,
        "json" => write(&arguments.output, &report::network_json(&mesh, masses.as_deref(), &outcome.network))?,
        _ => write(&arguments.output, &report::network_csv(&outcome.network))?,
    }
    let outcome = study::Outcome::of_fit(arguments.mesh.display().to_string(), mesh, material, masses, outcome);
    print(&format!("{}\n{}", report::summary(&outcome), report::table(&outcome)))?;
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
        bar.show("check", done, files.len());
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
    bar.show("closed form", 0, 1);
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
    let mut progress = |stage: &str, done, total| bar.show(stage, done, total);
    let comparison = if is_scene(path) {
        Comparison::of_scene(&study::compare_scene(&Scene::load(path)?, &mut progress)?)
    } else {
        let element = Element::load(&arguments.what)?;
        let material =
            Material::for_body(element.dimension(), 10e3, arguments.poisson, None, None).map_err(Error::of_option)?;
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
    print(&comparison.table())?;
    for path in comparison.write(&folder)? {
        print(&format!("written: {}\n", path.display()))?;
    }
    Ok(())
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

    fn show(&mut self, stage: &str, done: usize, total: usize) {
        if self.bar.is_none() && std::io::stderr().is_terminal() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            self.bar = Some(style.into_iter().fold(bar, ProgressBar::with_style));
        }
        if let Some(bar) = &self.bar {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            bar.set_message(stage.to_string());
        }
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
