//! `springfit schema`.

use crate::terminal::Terminal;
use clap::{Args, ValueEnum};
use springfit::error::Result;
use springfit::{element, material, report, study};
use std::process::ExitCode;

/// Write the JSON Schema of scenes, elements, materials, networks or reports, for editors
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Schema {
    /// The kind of file
    #[arg(value_enum)]
    of: Kind,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// Scenes, in TOML
    Scene,
    /// Element files, in TOML
    Element,
    /// Material files, in TOML
    Material,
    /// Networks in JSON, as run and fit write them
    Network,
    /// report.json, and what run and fit print with --json
    Report,
}

const EXAMPLES: &str = "\
Examples:
  springfit schema scene > scene.schema.json
  # In the first line of a scene, for the editor plugins of taplo:
  #:schema ./scene.schema.json";

impl Schema {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let schema = match self.of {
            Kind::Scene => study::scene_schema(),
            Kind::Element => element::schema(),
            Kind::Material => material::schema(),
            Kind::Network => report::network_schema(),
            Kind::Report => report::schema(),
        };
        terminal.print_json(&schema)?;
        Ok(ExitCode::SUCCESS)
    }
}
