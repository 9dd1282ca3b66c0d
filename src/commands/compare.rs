//! `springfit compare`.

use super::output::OutputOptions;
use super::scene_file::{Settings, is_scene};
use super::state::State;
use crate::terminal::Terminal;
use clap::Args;
use serde::Serialize;
use springfit::Edition;
use springfit::element::Element;
use springfit::error::{Error, Result};
use springfit::fit::Solver;
use springfit::material::Material;
use springfit::report::{self, Comparison, Table};
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
    /// Random shapes of an element [default: 100]
    #[arg(long, help_heading = "Element")]
    shapes: Option<usize>,
    /// Iterations of the general optimisers [default: 2000]
    #[arg(long, help_heading = "Element")]
    iterations: Option<u64>,
    /// Poisson's ratio, for an element [default: 0.3]
    #[arg(long, allow_hyphen_values = true, help_heading = "Element")]
    poisson: Option<f64>,
    /// An element at large deformation: the energy, a shipped name such as neo-hookean, or a file
    #[arg(long, help_heading = "Element")]
    law: Option<String>,
    /// With --law, the largest stretch that is sampled [default: 0.35]
    #[arg(long, allow_hyphen_values = true, help_heading = "Element")]
    stretch: Option<f64>,
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
        self.check_options(is_scene(path))?;
        let mut progress = |event: Event| terminal.show(event);
        if is_scene(path) {
            let scene = self.settings.scene(path)?;
            if self.explain {
                let scene = study::compared(&scene)?;
                let forecast = Forecast::of(&scene)?;
                let text = || report::forecast_text(scene.title(), &forecast, &stages(&scene));
                self.output.print_plan(terminal, &forecast, text)?;
                return Ok(ExitCode::SUCCESS);
            }
            let edition = report::open_outputs(&folder, names, &scene.inputs())?;
            let outcome = study::compare_scene(&scene, &mut progress)?;
            outcome.assumed.iter().for_each(|assumed| progress(Event::Note(assumed)));
            self.print(terminal, &Comparison::of_scene(&outcome), || report::Report::of(&outcome), edition)
        } else {
            self.settings.expect_none()?;
            let edition = report::open_outputs(&folder, names, &inputs)?;
            let element = Element::load(&self.what)?;
            let plane = self.plane.map(Into::into);
            let poisson = self.poisson.unwrap_or(0.3);
            let material =
                Material::for_body(element.dimension(), 10e3, poisson, plane, None).map_err(Error::of_option)?;
            if let Some(law) = &self.law {
                let element = Arc::new(element);
                let stretch = self.stretch.unwrap_or(0.35);
                let study = study::compare_stretches(&element, material, law, stretch, &mut progress);
                let law = |e: Error| if e.key() == Some("energy") { e.at_key("--law") } else { e.of_option() };
                let study = study.map_err(|e| e.placed(law))?;
                let paths = report::write_stretches(&study, edition);
                let tables = report::stretches_tables(&study);
                let text = tables.each_ref().map(Table::titled_text).join("\n");
                self.output.print(terminal, || &study, || tables.to_vec(), || text)?;
                terminal.written(&paths?)?;
                return Ok(ExitCode::SUCCESS);
            }
            let iterations = self.iterations.unwrap_or(Solver::DEFAULT_ITERATIONS);
            if iterations == 0 {
                return Err(Error::expected("--iterations", "a number above 0", 0));
            }
            let shapes = self.shapes.unwrap_or(100);
            let outcomes = study::compare_element(&element, material, shapes, iterations, &mut progress)
                .map_err(|e| e.placed(Error::of_option))?;
            let title = format!("{}: {shapes} random shapes, nu = {poisson}, one thread", element.name);
            let comparison = Comparison::of_element(title, &outcomes, material.young());
            self.print(terminal, &comparison, || &outcomes, edition)
        }
    }

    /// That each option belongs to what is compared.
    fn check_options(&self, is_scene: bool) -> Result<()> {
        let of_element = [
            ("--law", self.law.is_some()),
            ("--poisson", self.poisson.is_some()),
            ("--plane", self.plane.is_some()),
            ("--shapes", self.shapes.is_some()),
            ("--iterations", self.iterations.is_some()),
            ("--stretch", self.stretch.is_some()),
        ];
        let given = |options: &[(&'static str, bool)]| options.iter().find(|(_, given)| *given).map(|(name, _)| *name);
        let wrong = match (is_scene, self.law.is_some()) {
            (true, _) => {
                given(&of_element).map(|option| (option, "an element, found a scene, which names its material"))
            }
            _ if self.explain => Some(("--explain", "a scene, found an element")),
            (false, true) => given(&of_element[3..5]).map(|option| (option, "a comparison without --law")),
            (false, false) => given(&of_element[5..]).map(|option| (option, "a comparison with --law")),
        };
        match wrong {
            Some((option, owner)) => Err(Error::at(option, format!("belongs to {owner}"))),
            None => Ok(()),
        }
    }

    /// Writes the files of a comparison, and prints it.
    fn print<R: Serialize>(
        &self,
        terminal: &mut Terminal,
        comparison: &Comparison,
        record: impl FnOnce() -> R,
        edition: Edition,
    ) -> Result<ExitCode> {
        let paths = comparison.write(edition);
        self.output.print(terminal, record, || vec![comparison.table.clone()], || comparison.text())?;
        terminal.written(&paths?)?;
        Ok(ExitCode::SUCCESS)
    }
}
