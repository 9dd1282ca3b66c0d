//! `springfit materials`.

use super::output::OutputOptions;
use super::shipped::shipped_text;
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::material::{Energy, SHIPPED};
use springfit_foundation::error::Result;
use springfit_report::report;

/// List the shipped hyperelastic materials, which "law" names, or print the file of one
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Materials {
    /// The material whose file is printed, as a start for one of your own
    #[arg(conflicts_with_all = ["json", "table"])]
    name: Option<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit materials
  springfit materials yeoh > own.toml   # the file of one of them
  springfit run scene.toml --set material.law=neo-hookean
  springfit fit organ.msh --young 10kPa --poisson 0.45 --objective sampled --law fung -o springs.vtu

With --json: a list of materials with the keys name, title, parameters, fibres, source";

impl Materials {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        if let Some(name) = &self.name {
            return terminal.print(shipped_text(SHIPPED.iter().copied(), name)?);
        }
        let materials = Energy::shipped()?;
        let tables = || vec![report::materials_table(&materials)];
        self.output.print(terminal, || &materials, tables, || report::materials_table(&materials).text())
    }
}
