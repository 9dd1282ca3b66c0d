//! `springfit merge`.

use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_report::report::merge_shards;
use std::path::PathBuf;

/// Merge the shards that springfit fit --shard wrote into one network
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Merge {
    /// All shards, in any order
    #[arg(required = true)]
    shards: Vec<PathBuf>,
    /// Where the springs go: .csv, with the bytes of a fit of all cells at once
    #[arg(short, long, help_heading = "Output")]
    output: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  springfit fit organ.msh --young 10kPa --poisson 0.3 --shard 1/2 -o organ-1.shard
  springfit fit organ.msh --young 10kPa --poisson 0.3 --shard 2/2 -o organ-2.shard
  springfit merge organ-1.shard organ-2.shard -o springs.csv";

impl Merge {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        if self.output.extension().is_none_or(|ending| ending != "csv") {
            let found = self.output.display();
            return Err(Error::expected("--output", "a file ending in .csv", found).of_kind(ErrorKind::Unsupported));
        }
        springfit_foundation::file::check_apart(std::slice::from_ref(&self.output), &self.shards)?;
        springfit_foundation::file::check_file(&self.output)?;
        let merged = merge_shards(&self.shards, &self.output)?;
        let shards = self.shards.len();
        terminal.print(&format!("{} springs of {shards} shards, {} with k < 0\n", merged.springs, merged.negative))?;
        terminal.written(std::slice::from_ref(&self.output))
    }
}
