//! `springfit schema`.

use crate::terminal::Terminal;
use clap::{Args, ValueEnum};
use springfit_element::{element, material};
use springfit_foundation::error::Result;
use springfit_report::report;
use springfit_studies::study;

/// Write the JSON Schema of scenes, comparisons, elements, materials, networks or reports, for editors
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Schema {
    /// The kind of file
    #[arg(value_enum)]
    of: Kind,
    /// Print the keys with their types, defaults and meanings as tables in Markdown instead
    #[arg(long)]
    markdown: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// Scenes, in TOML
    Scene,
    /// Files with a table [compare], in TOML
    Compare,
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
  #:schema ./scene.schema.json
  springfit schema scene --markdown        # what each key means";

impl Schema {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        // The third says whether the program writes such files.
        let (schema, name, is_written) = match self.of {
            Kind::Scene => (study::scene_schema(), "scene", false),
            Kind::Compare => (study::compare_schema(), "comparison", false),
            Kind::Element => (element::schema(), "element", false),
            Kind::Material => (material::schema(), "material", false),
            Kind::Network => (report::network_schema(), "network", true),
            Kind::Report => (report::schema(), "report", true),
        };
        match self.markdown {
            true => terminal.print(&report::key_tables_text(&report::key_tables(&schema, name, is_written))),
            false => terminal.print_json(&schema),
        }
    }
}
