//! `springfit calibrate`.

use super::output::OutputOptions;
use super::scene_file::Settings;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::Result;
use springfit_report::report;
use springfit_studies::study::{self, Event};
use std::path::{Path, PathBuf};

/// Find the moduli of a body from measured displacements and forces, with intervals
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Calibrate {
    /// The scene file, with measurements under its loads
    scene: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Folder of the report and the tables [default: out/calibrate-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit calibrate scene.toml                                  # [calibrate] says what is found; without it Young's moduli
  springfit calibrate scene.toml --set calibrate.unknowns=moduli  # Young's moduli and Poisson's ratios";

impl Calibrate {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let scene = self.settings.scene(&self.scene)?;
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(format!("calibrate-{stem}")));
        let edition = report::open_outputs(&folder, &report::CALIBRATION_FILES, &scene.inputs())?;
        let mut show = |event: Event| terminal.show(event);
        let outcome = study::calibrate(&scene, &mut show)?;
        let paths = report::write_calibration(&outcome, edition)?;
        let tables = || report::calibration_tables(&outcome);
        self.output.print(terminal, || &outcome, tables, || report::calibration_text(&outcome))?;
        terminal.written(&paths)
    }
}
