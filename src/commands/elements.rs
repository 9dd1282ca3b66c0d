//! `springfit elements`.

use super::output::OutputOptions;
use super::shipped::shipped_text;
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::element::{Cell, Element, Outline, SHIPPED};
use springfit_foundation::error::Result;
use springfit_report::report;
use springfit_studies::study::Event;
use std::path::PathBuf;

/// List the shipped elements with their spring groups, print the file of one, or draw them
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Elements {
    /// The element whose file is printed, as a start for one of your own; with --out also an element file, which is drawn
    #[arg(conflicts_with_all = ["json", "table"])]
    name: Option<String>,
    /// Folder of a page in Markdown: pictures of nodes and springs, and spring constants as formulas
    #[arg(long, help_heading = "Output", conflicts_with_all = ["json", "table"])]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit elements
  springfit elements quad4 > quad5.toml   # the file of one of them
  springfit check hex8                    # what is proved of one of them
  springfit elements --out elements       # a page with pictures and formulas
  springfit elements --json | jq -r '.[].name'

With --json: a list of elements with the keys name, title, cell, nodes, springs, gmsh, vtk, source";

impl Elements {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        if let Some(folder) = &self.out {
            let elements = match &self.name {
                Some(name) => vec![Element::load(name)?],
                None => by_cell()?,
            };
            let files = report::element_page_files(&elements);
            let inputs: Vec<PathBuf> = self.name.iter().map(PathBuf::from).collect();
            let edition = report::open_outputs(folder, &files.iter().map(String::as_str).collect::<Vec<_>>(), &inputs)?;
            let mut progress = |event: Event| terminal.show(event);
            let paths = report::write_element_page(&elements, edition, &mut progress)?;
            return terminal.written(&paths);
        }
        if let Some(name) = &self.name {
            return terminal.print(shipped_text(SHIPPED.iter().map(|file| (file.name, file.text)), name)?);
        }
        let elements = SHIPPED.iter().map(Outline::shipped).collect::<Result<Vec<_>>>()?;
        let tables = || vec![report::elements_table(&elements)];
        self.output.print(terminal, || &elements, tables, || report::elements_table(&elements).text())
    }
}

/// The shipped elements, those of one cell together.
fn by_cell() -> Result<Vec<Element>> {
    let mut elements = SHIPPED.iter().map(Element::shipped).collect::<Result<Vec<_>>>()?;
    let place = |element: &Element| Cell::ALL.iter().position(|cell| *cell == element.cell);
    elements.sort_by_key(|element| (place(element), element.nodes()));
    Ok(elements)
}
