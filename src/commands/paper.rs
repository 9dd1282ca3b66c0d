//! `springfit paper`.

use super::output::OutputOptions;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_report::report::{self, open_outputs};
use springfit_studies::study::{self, Index};
use std::path::{Path, PathBuf};

/// Reproduce the tables and figures of Natsupakpong and Cavusoglu (2010)
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Paper {
    /// Only this table or figure, such as 1 or "figure 9"; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// An index of experiments of your own, such as scenes/paper/index.toml
    #[arg(long)]
    index: Option<PathBuf>,
    /// Folder of the tables and figures, and of the scenes that were run [default: out/paper]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit paper
  springfit paper --only 1 --only 'figure 9'
  springfit paper --only 1 --table latex
  springfit paper --index my-experiments/index.toml";

/// The folder of the experiments, in that of the tables.
const SCENES: &str = "scenes";

impl Paper {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join("paper"));
        let index = self.index.as_ref().map_or_else(Index::shipped, |path| Index::load(path))?;
        index.expect(&self.only).map_err(|e| e.at_key("--only"))?;
        let mut edition = open_outputs(&folder, &report::PAPER_FILES, self.index.as_slice())?;
        let path = match &self.index {
            Some(path) => path.clone(),
            None => {
                study::check_experiments(&folder.join(SCENES))?;
                let path = study::write_experiments(&edition.staging().join(SCENES))?;
                edition.take_folder(SCENES)?;
                path
            }
        };
        let paper = study::run_paper(&index, &self.only, &path, &mut |event| terminal.show(event));
        let paper = paper.map_err(|e| e.placed(Error::of_option))?;
        let written = report::write_paper(&paper, edition);
        self.output.print(
            terminal,
            || &paper.tables,
            || paper.tables.iter().map(report::paper_table).collect(),
            || paper.tables.iter().map(|table| report::paper_table(table).titled_text() + "\n").collect(),
        )?;
        // The experiments are in a folder of their own.
        let written: Vec<PathBuf> = written?.into_iter().filter(|path| path.parent() == Some(&folder)).collect();
        terminal.say(&format!("written: {} files in {}", written.len(), folder.display()))
    }
}
