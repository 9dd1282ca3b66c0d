//! `springfit compare`.

use super::output::OutputOptions;
use super::scene_file::{Settings, is_scene};
use super::state::State;
use crate::terminal::Terminal;
use clap::Args;
use serde::Serialize;
use springfit::element::Element;
use springfit::error::{Error, Result};
use springfit::fit::Solver;
use springfit::material::Material;
use springfit::report::{self, Comparison};
use springfit::study::{self, Event, Forecast, stages};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Compare objectives and solvers on random shapes of an element or on a scene
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    /// A shipped element's name, an element file, or a scene
    what: String,
    #[command(flatten)]
    settings: Settings,
    /// Random shapes of an element
    #[arg(long, default_value_t = 100, help_heading = "Element")]
    shapes: usize,
    /// Iterations of the general optimisers
    #[arg(long, default_value_t = Solver::DEFAULT_ITERATIONS, help_heading = "Element")]
    iterations: u64,
    /// Poisson's ratio, for an element
    #[arg(long, default_value_t = 0.3, allow_hyphen_values = true, help_heading = "Element")]
    poisson: f64,
    /// An element at large deformation: the energy, a shipped name such as neo-hookean, or a file
    #[arg(long, help_heading = "Element")]
    law: Option<String>,
    /// With --law, the largest stretch that is sampled
    #[arg(long, default_value_t = 0.35, allow_hyphen_values = true, help_heading = "Element")]
    stretch: f64,
    /// Plane element: stress or strain [default: stress]
    #[arg(long, help_heading = "Element")]
    plane: Option<State>,
    /// Of a scene: print what would be done, with estimates of time and memory, and stop
    #[arg(long)]
    explain: bool,
    /// Folder of the tables and figures [default: out/compare-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit compare tet4
  springfit compare hex8 --shapes 20 --poisson 0.45
  springfit compare tri3 --law neo-hookean --plane strain
  springfit compare scene.toml --explain                 # the fits of a scene and their expected times
  springfit compare scene.toml --json                    # of a scene: the keys of report.json";

impl Compare {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let path = Path::new(&self.what);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(format!("compare-{stem}")));
        let names: &[&str] = if self.law.is_some() { &report::STRETCHES_FILES } else { &report::COMPARISON_FILES };
        let mut inputs = vec![PathBuf::from(&self.what)];
        inputs.extend(self.law.as_ref().map(PathBuf::from));
        report::check_outputs(&folder, names, &inputs)?;
        let mut progress = |event: Event| terminal.show(event);
        if self.law.is_some() && is_scene(path) {
            return Err(Error::at("--law", "belongs to an element; a scene names its law in [material]"));
        }
        if is_scene(path) {
            let scene = self.settings.scene(path)?;
            if self.explain {
                let scene = study::compared(&scene)?;
                let forecast = Forecast::of(&scene)?;
                let text = || report::forecast_text(scene.title(), &forecast, &stages(&scene));
                self.output.print_plan(terminal, &forecast, text)?;
                return Ok(ExitCode::SUCCESS);
            }
            report::check_outputs(&folder, names, &scene.inputs())?;
            let outcome = study::compare_scene(&scene, &mut progress)?;
            outcome.assumed.iter().for_each(|assumed| progress(Event::Note(assumed)));
            self.print(terminal, &Comparison::of_scene(&outcome), || report::Report::of(&outcome), &folder)
        } else {
            self.settings.expect_none()?;
            if self.explain {
                return Err(Error::at("--explain", "belongs to a scene, found an element"));
            }
            let element = Element::load(&self.what)?;
            let plane = self.plane.map(Into::into);
            let material =
                Material::for_body(element.dimension(), 10e3, self.poisson, plane, None).map_err(Error::of_option)?;
            if let Some(law) = &self.law {
                let element = Arc::new(element);
                let study = study::compare_stretches(&element, material, law, self.stretch, &mut progress);
                let law = |e: Error| if e.key() == Some("energy") { e.at_key("--law") } else { e.of_option() };
                let study = study.map_err(|e| e.placed(law))?;
                let paths = report::write_stretches(&study, &folder);
                let tables = || report::stretches_tables(&study);
                self.output.print(terminal, || &study, tables, || report::stretches_text(&study))?;
                terminal.written(&paths?)?;
                return Ok(ExitCode::SUCCESS);
            }
            if self.iterations == 0 {
                return Err(Error::expected("--iterations", "a number above 0", 0));
            }
            let (shapes, iterations) = (self.shapes, self.iterations);
            let outcomes = study::compare_element(&element, material, shapes, iterations, &mut progress)
                .map_err(|e| e.placed(Error::of_option))?;
            let title = format!("{}: {shapes} random shapes, nu = {}, one thread", element.name, self.poisson);
            let comparison = Comparison::of_element(title, &outcomes, material.young());
            self.print(terminal, &comparison, || &outcomes, &folder)
        }
    }

    /// Writes the files of a comparison, and prints it.
    fn print<R: Serialize>(
        &self,
        terminal: &mut Terminal,
        comparison: &Comparison,
        record: impl FnOnce() -> R,
        folder: &Path,
    ) -> Result<ExitCode> {
        let paths = comparison.write(folder);
        self.output.print(terminal, record, || vec![comparison.result_table()], || comparison.table())?;
        terminal.written(&paths?)?;
        Ok(ExitCode::SUCCESS)
    }
}
