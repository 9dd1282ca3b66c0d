//! Whether simulators reproduce the modulus in their input: standard bodies come to rest in them, beside finite elements.
//!
//! An engine is a row of [`ENGINES`]; its script, in the folder `exports/referee`, answers requests of a process.
//!
//! Page of the book: *A referee of simulators*.

mod body;
mod engine;
mod rest;
mod session;
mod trial;

pub use engine::{ENGINES, Engine, Interpreter, Law, Solver, engine_list, engine_named};

use body::standard_bodies;
use session::{Session, write_scripts};
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::create_folder;
use springfit_foundation::named::unknown;
use springfit_report::report::{EngineRecord, RefereeRecord, RefereeRow, Telling};
use springfit_studies::study::Event;
use springfit_studies::study::Progress;
use std::path::{Path, PathBuf};
use trial::Trial;

/// What is asked of a referee.
#[derive(Debug, Clone)]
pub struct RefereeOptions {
    /// The engines; all that are there if it is empty.
    pub engines: Vec<&'static Engine>,
    /// The solvers; if it is empty, the usual ones.
    pub solvers: Vec<String>,
    /// Whether an engine without a named solver runs all of its solvers, and not only the usual ones.
    pub all: bool,
    /// Poisson's ratios of the bodies, from 0 to below 0.5.
    pub poisson: Vec<f64>,
    /// The program that runs Python.
    pub python: PathBuf,
    /// The program that runs Node.
    pub node: PathBuf,
    /// Where scripts and exports are written.
    pub folder: PathBuf,
}

/// Runs the engines. A body whose program ends early is noted in the record.
///
/// # Errors
/// An engine that is named is not there; an option is wrong; or a file cannot be written.
pub fn referee(options: &RefereeOptions, progress: &mut Progress) -> Result<RefereeRecord> {
    let named = || if options.engines.is_empty() { ENGINES.iter().collect() } else { options.engines.clone() };
    check_solvers(options, &named())?;
    for &poisson in &options.poisson {
        if !(0.0..0.5).contains(&poisson) {
            return Err(Error::expected("--poisson", "numbers from 0 to below 0.5", poisson));
        }
    }
    create_folder(&options.folder)?;
    // Engines start in the folder of the user, and find the scripts anyway.
    let folder =
        std::path::absolute(&options.folder).map_err(|e| Error::io("cannot be found", e).in_file(&options.folder))?;
    write_scripts(&folder)?;
    let mut record = RefereeRecord::default();
    let mut engines = Vec::new();
    for engine in named() {
        match Session::start(engine, options.program(engine), &folder) {
            Ok(session) => {
                record.engines.push(EngineRecord { name: engine.name.into(), version: session.version.clone() });
                engines.push(engine);
            }
            Err(error) if options.engines.is_empty() => {
                progress(Event::Note(&error.to_string()));
                record.not_run.push(error.to_string());
            }
            Err(error) => return Err(error),
        }
    }
    if engines.is_empty() {
        return Err(Error::new(format!("no engine is there; {}", record.not_run.join("; "))));
    }
    let solvers = || engines.iter().flat_map(|engine| options.chosen(engine));
    // Elements of an engine come with the export of the exact network.
    let mut fits: Vec<&str> = solvers().flat_map(|solver| solver.networks).copied().chain(["exact"]).collect();
    fits.sort_unstable();
    fits.dedup();
    let mut done = 0;
    for &poisson in &options.poisson {
        let bodies = standard_bodies(poisson, &fits, progress)?;
        record.young = bodies[0].moduli[0];
        let loads: usize = bodies.iter().map(|body| body.cases.len()).sum();
        let models = |engine: &'static Engine| options.chosen(engine).map(Solver::models).sum::<usize>();
        let total = done + loads * engines.iter().map(|engine| models(engine)).sum::<usize>();
        for &engine in &engines {
            let mut shown = |row: &RefereeRow| {
                // Repairs come as they are needed.
                done += usize::from(row.telling == Telling::Given);
                let name = format!("{} {}, {}, nu {poisson}", row.engine, row.solver, row.title());
                progress(Event::stage(&name, done, total));
            };
            let (program, folder) = (options.program(engine), &folder);
            let mut trial = Trial { engine, program, folder, bodies: &bodies, record: &mut record, shown: &mut shown };
            options.chosen(engine).try_for_each(|solver| trial.run(solver))?;
        }
    }
    Ok(record)
}

impl RefereeOptions {
    fn program(&self, engine: &Engine) -> &Path {
        match engine.interpreter {
            Interpreter::Python => &self.python,
            Interpreter::Node => &self.node,
        }
    }

    fn chosen<'a>(&'a self, engine: &'static Engine) -> impl Iterator<Item = &'static Solver> + 'a {
        let is_chosen = |solver: &&Solver| match self.solvers.is_empty() {
            true => self.all || solver.is_usual,
            false => self.solvers.iter().any(|name| name == solver.name),
        };
        engine.solvers.iter().filter(is_chosen)
    }
}

impl Solver {
    /// Own elements and the networks.
    fn models(&self) -> usize {
        self.networks.len() + usize::from(self.elements.is_some())
    }
}

fn check_solvers(options: &RefereeOptions, engines: &[&'static Engine]) -> Result<()> {
    let names = || engines.iter().flat_map(|engine| engine.solvers).map(|solver| solver.name);
    for name in &options.solvers {
        if !names().any(|known| known == name) {
            let expected =
                format!("one of {}", names().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", "));
            return Err(unknown(expected, names(), name).at_key("--solver"));
        }
    }
    Ok(())
}
