//! `springfit elements`.

use super::output::OutputOptions;
use super::shipped::shipped_text;
use crate::terminal::Terminal;
use clap::Args;
use springfit::element::{Outline, SHIPPED};
use springfit::error::Result;
use springfit::report::{self, ElementRecord};
use std::process::ExitCode;

/// List the shipped elements with their spring groups, or print the file of one
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Elements {
    /// The element whose file is printed, as a start for one of your own
    #[arg(conflicts_with_all = ["json", "table"])]
    name: Option<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit elements
  springfit elements quad4 > quad5.toml   # the file of one of them
  springfit check hex8                    # what is proved of one of them
  springfit elements --json | jq -r '.[].name'

With --json: a list of elements with the keys name, title, cell, nodes, springs, gmsh, vtk, source";

impl Elements {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        if let Some(name) = &self.name {
            terminal.print(shipped_text(SHIPPED.iter().map(|file| (file.name, file.text)), name)?)?;
            return Ok(ExitCode::SUCCESS);
        }
        let record = |file| Ok(ElementRecord::of(&Outline::shipped(file)?, file));
        let elements = SHIPPED.iter().map(record).collect::<Result<Vec<_>>>()?;
        let tables = || vec![report::elements_table(&elements)];
        self.output.print(terminal, || &elements, tables, || report::elements_table(&elements).text())?;
        Ok(ExitCode::SUCCESS)
    }
}
