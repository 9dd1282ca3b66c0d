//! `springfit referee`.

use super::output::OutputOptions;
use crate::referee::{RefereeOptions, engine_list, engine_named, referee};
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::Result;
use springfit_report::report::{self, REFEREE_FILES, open_outputs};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Measure whether simulators reproduce the modulus in their input; exit code 1 if a simulator ends early
#[derive(Args)]
#[command(after_help = format!("{EXAMPLES}\n{}", engine_list()))]
pub struct Referee {
    /// A simulator; may be repeated [default: all that are there]
    #[arg(long, value_name = "NAME")]
    engine: Vec<String>,
    /// Only this solver of a simulator; may be repeated [default: the usual ones]
    #[arg(long, value_name = "NAME")]
    solver: Vec<String>,
    /// All solvers, also those that take long
    #[arg(long, conflicts_with = "solver")]
    all: bool,
    /// Poisson's ratio of the bodies; may be repeated [default: 0.3 and 0.45]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    poisson: Vec<f64>,
    /// The Python that has the simulators
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// The Node that runs Jolt; it looks for the package in the folder of the files and those above it
    #[arg(long, value_name = "PROGRAM", default_value = "node")]
    node: PathBuf,
    /// Folder of the numbers, the chart and the scripts [default: out/referee]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit referee --engine mujoco --engine newton --python venv/bin/python
  springfit referee --engine newton --solver SemiImplicit --poisson 0.3
  springfit referee --all --table markdown

Simulators:";

/// The folder of the scripts, in that of the numbers.
const SCRIPTS: &str = "scripts";

impl Referee {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join("referee"));
        let mut edition = open_outputs(&folder, &REFEREE_FILES, &[])?;
        let options = RefereeOptions {
            engines: self.engine.iter().map(|name| engine_named(name)).collect::<Result<_>>()?,
            solvers: self.solver.clone(),
            all: self.all,
            poisson: if self.poisson.is_empty() { vec![0.3, 0.45] } else { self.poisson.clone() },
            python: self.python.clone(),
            node: self.node.clone(),
            folder: edition.staging().join(SCRIPTS),
        };
        let record = referee(&options, &mut |event| terminal.show(event))?;
        edition.take_folder(SCRIPTS)?;
        let paths = report::write_referee(&record, edition);
        let tables = || report::referee_tables(&record);
        self.output.print(terminal, || &record, tables, || report::referee_text(&record))?;
        terminal.written(&paths?)?;
        Ok(if record.failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}
