//! `springfit run`.

use super::interrupt::end_early;
use super::output::{OutputOptions, command};
use super::scene_file::Settings;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::check_apart;
use springfit_report::report;
use springfit_studies::study::{Controls, Forecast, engine_limits, run_with, stages};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Fit, solve and compare a scene
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Run {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Where whole-object fits save their state, and what they go on from if it is there; Ctrl-C ends them at their best point
    #[arg(long)]
    checkpoint: Option<PathBuf>,
    /// Print what would be done, with estimates of time and memory, and stop
    #[arg(long)]
    explain: bool,
    /// Write the report as a page as well, OUT/report.html: tables, figures and a view of the body in one file that needs no network
    #[arg(long, help_heading = "Output")]
    report: bool,
    /// Measure what fits and models cost, as `time = true` in [output] does: processor time of one thread, in passes that take turns
    #[arg(long)]
    time: bool,
    /// Folder of report.json, of the networks and of the files that [output] asks for [default: out/NAME of the scene]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit run scene.toml
  springfit run scene.toml --report                      # and a page to look at: out/scene/report.html
  springfit run scene.toml --explain                     # sizes, stages, estimates; nothing is run
  springfit run scene.toml --time                        # what each fit, network and the finite elements cost
  springfit run scene.toml --set material.poisson=0.45 --out out/soft
  springfit run scene.toml --json | jq '.fits[].name'    # the keys of report.json: springfit schema report";

impl Run {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let mut scene = self.settings.scene(&self.scene)?;
        if self.report {
            scene.output_mut().report = Some(true);
        }
        if self.time {
            scene.output_mut().time = true;
        }
        if self.explain {
            let mut forecast = Forecast::of(&scene)?;
            forecast.engines = engine_limits(&scene)?;
            let text = || report::forecast_text(scene.title(), &forecast, &stages(&scene));
            return self.output.print_plan(terminal, &forecast, text);
        }
        let stem = self.scene.file_stem().unwrap_or_default();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(stem));
        let edition = report::open_scene_outputs(&scene, &folder)?;
        let controls =
            Arc::new(Controls { checkpoint: self.checkpoint.clone(), announce: true, ..Controls::default() });
        if scene.fits().iter().any(|fit| fit.recipe.whole().is_some()) {
            check_apart(self.checkpoint.as_slice(), &scene.inputs()).map_err(|e| e.at_key("--checkpoint"))?;
            end_early(&controls);
        } else if self.checkpoint.is_some() {
            return Err(Error::at(
                "--checkpoint",
                "belongs to fits whose objective is \"whole\", found none in the scene",
            ));
        }
        let mut outcome = run_with(&scene, &controls, &mut |event| terminal.show(event))?;
        outcome.command = Some(command());
        // Files first: who reads the table may have gone away.
        let paths = report::write_outputs(&outcome, scene.output(), edition);
        self.output.print_outcome(terminal, &outcome)?;
        terminal.written(&paths?)
    }
}
