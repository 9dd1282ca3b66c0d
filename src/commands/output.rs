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

/// The command as it was typed, for files that say where they come from.
pub fn command() -> String {
    let words = std::env::args().skip(1).map(|word| match word.chars().any(|c| c.is_whitespace() || c == '"') {
        true => format!("{word:?}"),
        false => word,
    });
    std::iter::once("springfit".to_string()).chain(words).collect::<Vec<_>>().join(" ")
}
