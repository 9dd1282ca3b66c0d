//! `springfit stability`.

use super::output::OutputOptions;
use super::scene_file::{Settings, is_scene};
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::element::Element;
use springfit_foundation::error::Result;
use springfit_report::report;
use springfit_studies::study::{self, Event};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Test the numerical accuracy in ill-conditioned cases; exit code 1 if an error is too large
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Stability {
    /// A shipped element's name, an element file, or a scene [default: an element of each kind, bodies and motions]
    what: Option<String>,
    #[command(flatten)]
    settings: Settings,
    /// Folder of the table and the maps [default: out/stability, or out/stability-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit stability                     # the whole sweep
  springfit stability tet4
  springfit stability scene.toml          # the scene in other units and materials";

impl Stability {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let what = self.what.as_deref();
        let stem = what.map(|what| Path::new(what).file_stem().unwrap_or_default().to_string_lossy());
        let name = stem.map_or("stability".to_string(), |stem| format!("stability-{stem}"));
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(name));
        let mut progress = |event: Event| terminal.show(event);
        let open = |inputs: &[PathBuf]| report::open_outputs(&folder, &report::STABILITY_FILES, inputs);
        let (edition, outcome) = match what {
            Some(path) if is_scene(Path::new(path)) => {
                let scene = self.settings.scene(Path::new(path))?;
                (open(&scene.inputs())?, study::stability_of_scene(&scene, &mut progress)?)
            }
            _ => {
                self.settings.expect_none("an element")?;
                let edition = open(&what.map(PathBuf::from).into_iter().collect::<Vec<_>>())?;
                (edition, study::stability(what.map(Element::load).transpose()?, &mut progress)?)
            }
        };
        let paths = report::write_stability(&outcome, edition);
        let tables = || vec![report::stability_table(&outcome)];
        self.output.print(terminal, || &outcome, tables, || report::stability_text(&outcome))?;
        terminal.written(&paths?)?;
        Ok(if outcome.lost().count() == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}
