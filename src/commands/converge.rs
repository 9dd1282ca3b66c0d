//! `springfit converge`.

use super::interrupt::{Answer, interrupted};
use super::output::OutputOptions;
use super::scene_file::Settings;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_report::report;
use springfit_studies::study::{self, Convergence, Event, Forecast, Scene, stages};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Refine the mesh of a scene, and report how finite elements and networks converge
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Converge {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Meshes, from 2 to 8: that of the scene, and others with cells of half the size each [default: 4, or fewer if they would take long]
    #[arg(long, allow_hyphen_values = true)]
    levels: Option<usize>,
    /// A scene of the same body and loads whose finite elements are the reference solution, such as one of quadratic cells; its fits are ignored [default: the scene itself]
    #[arg(long)]
    truth: Option<PathBuf>,
    /// Print what would be done on each level, with estimates of time and memory, and stop
    #[arg(long)]
    explain: bool,
    /// Folder of the table and the plot [default: out/converge-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit converge scene.toml
  springfit converge scene.toml --levels 3 --set material.poisson=0.45
  springfit converge linear.toml --truth quadratic.toml  # both have the same body, supports and loads";

impl Converge {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let scene = self.settings.scene(&self.scene)?;
        if self.explain {
            let levels = study::refinements(&scene, self.levels).map_err(|e| e.placed(Error::of_option))?;
            let forecasts = levels.iter().map(Forecast::of).collect::<Result<Vec<_>>>()?;
            let title = |level: usize| format!("{}, level {} of {}", scene.title(), level + 1, levels.len());
            let text = forecasts.iter().enumerate().map(|(level, forecast)| {
                let stages = if level == 0 { stages(&levels[0]) } else { Vec::new() };
                report::forecast_text(&title(level), forecast, &stages)
            });
            return self.output.print_plan(terminal, &forecasts, || text.collect::<Vec<_>>().join("\n"));
        }
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(format!("converge-{stem}")));
        let truth = self.truth.as_ref().map(|path| self.settings.reference(path)).transpose()?;
        let inputs: Vec<PathBuf> =
            [Some(&scene), truth.as_ref()].into_iter().flatten().flat_map(Scene::inputs).collect();
        let open = || report::open_outputs(&folder, &report::CONVERGENCE_FILES, &inputs);
        let mut edition = Some(open()?);
        let so_far: Arc<Mutex<String>> = Arc::default();
        let told = so_far.clone();
        interrupted(move || {
            // The files have it as well. Whoever reads may have gone away.
            let text = told.lock().unwrap_or_else(PoisonError::into_inner);
            _ = std::io::stdout().write_all(text.as_bytes()).and_then(|()| std::io::stdout().flush());
            Answer::Ends
        });
        let mut paths = Vec::new();
        let mut each = |convergence: &Convergence| {
            let opened = edition.take().map_or_else(open, Ok)?;
            paths = report::write_convergence(convergence, opened)?;
            edition = Some(open()?);
            *so_far.lock().unwrap_or_else(PoisonError::into_inner) = self.text(convergence);
            Ok(())
        };
        let mut show = |event: Event| terminal.show(event);
        let convergence = study::converge_with(&scene, truth.as_ref(), self.levels, &mut each, &mut show);
        let convergence = convergence.map_err(|e| e.placed(Error::of_option))?;
        self.output.print_text(terminal, &self.text(&convergence))?;
        terminal.written(&paths)
    }

    /// What is printed of the levels.
    fn text(&self, convergence: &Convergence) -> String {
        let tables = || report::convergence_tables(convergence);
        self.output.text(|| convergence, tables, || report::convergence_text(convergence))
    }
}
