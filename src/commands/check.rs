//! `springfit check`.

use super::output::OutputOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::element::Element;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::files_in;
use springfit_report::report;
use springfit_studies::study::{self, Event};
use std::path::Path;
use std::process::ExitCode;

/// Check element files: one line for each property; exit code 1 if one fails
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Check {
    /// Element files, folders of them, or names of shipped elements
    #[arg(required = true)]
    what: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit check my-element.toml
  springfit check elements                # all files of a folder
  springfit check hex8 --json             # a list of files with the keys file, title, passes, properties";

impl Check {
    pub fn run(&self, terminal: &mut Terminal) -> Result<ExitCode> {
        let mut files = Vec::new();
        for what in &self.what {
            let path = Path::new(what);
            if !path.is_dir() {
                files.push(what.clone());
                continue;
            }
            let before = files.len();
            files.extend(files_in(path, "toml")?.iter().map(|file| file.display().to_string()));
            if files.len() == before {
                return Err(Error::new("expected element files that end in .toml, found none").in_file(path));
            }
        }
        let mut inspections = Vec::new();
        for (done, file) in files.iter().enumerate() {
            terminal.show(Event::stage("check", done, files.len()));
            let loaded = Element::load(file);
            // A file that is not there is no fault of an element.
            if let (Err(error), false) = (&loaded, Path::new(file).is_file()) {
                return Err(error.clone());
            }
            let inspection = study::inspect(file, loaded);
            if self.output.is_text() {
                terminal.print(&(report::check_text(&inspection) + "\n"))?;
            }
            inspections.push(inspection);
        }
        let failing: Vec<&str> = inspections.iter().filter(|i| !i.passes).map(|i| i.file.as_str()).collect();
        self.output.print(
            terminal,
            || inspections.to_vec(),
            || vec![report::check_table(&inspections)],
            || {
                let (all, passing) = (inspections.len(), inspections.len() - failing.len());
                let is_mixed = passing > 0 && passing < all;
                let which = if is_mixed { format!("; not {}", failing.join(", ")) } else { String::new() };
                format!("{passing} of {all} files pass{which}\n")
            },
        )?;
        Ok(if failing.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}
