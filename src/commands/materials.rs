//! `springfit materials`.

use super::output::OutputOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit::error::Result;
use springfit::material::Energy;
use springfit::report::{self, MaterialRecord};
use std::process::ExitCode;

/// List the shipped hyperelastic materials, which "law" names
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Materials {
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit materials
  springfit run scene.toml --set material.law=neo-hookean
  springfit fit organ.msh --young 10kPa --poisson 0.45 --objective sampled --law fung -o springs.vtu

With --json: a list of materials with the keys name, title, parameters, fibres, source";

impl Materials {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let materials: Vec<MaterialRecord> = Energy::shipped()?.iter().map(MaterialRecord::from).collect();
        let tables = || vec![report::materials_table(&materials)];
        self.output.print(terminal, || &materials, tables, || report::materials_text(&materials))?;
        Ok(ExitCode::SUCCESS)
    }
}
