//! How results are printed.

use clap::Args;

/// The option `--json` of a command that prints tables.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub struct OutputOptions {
    /// Print one JSON document to standard output in place of tables; names of files go to standard error
    #[arg(long)]
    pub json: bool,
}
