//! `springfit elements`.

use super::output::OutputOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit::element::{Element, SHIPPED};
use springfit::error::Result;
use springfit::report::{self, ElementRecord};
use std::process::ExitCode;

/// List the shipped elements with their spring groups
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Elements {
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit elements
  springfit check hex8                    # what is proved of one of them
  springfit elements --json | jq -r '.[].name'

With --json: a list of elements with the keys name, title, cell, nodes, springs, gmsh, vtk, source";

impl Elements {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let record = |file| Ok(ElementRecord::of(&Element::shipped(file)?, file));
        let elements = SHIPPED.iter().map(record).collect::<Result<Vec<_>>>()?;
        match self.output.json {
            true => terminal.print_json(&elements)?,
            false => terminal.print(&report::elements_text(&elements))?,
        }
        Ok(ExitCode::SUCCESS)
    }
}
