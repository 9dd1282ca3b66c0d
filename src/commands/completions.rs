//! `springfit completions`.

use crate::terminal::Terminal;
use clap::Args;
use clap_complete::{Shell, generate};
use springfit_foundation::error::Result;

/// Write a shell's completion script to standard output
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

const EXAMPLES: &str = "\
Examples:
  springfit completions bash > ~/.local/share/bash-completion/completions/springfit
  springfit completions zsh > ~/.zfunc/_springfit        # with ~/.zfunc in fpath
  springfit completions fish > ~/.config/fish/completions/springfit.fish";

impl Completions {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let mut command = (terminal.grammar)();
        let mut script = Vec::new();
        generate(self.shell, &mut command, "springfit", &mut script);
        terminal.print_bytes(&script)
    }
}
