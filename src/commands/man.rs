//! `springfit man`.

use crate::terminal::Terminal;
use clap::Args;
use clap_mangen::Man as Page;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::named::unknown;

/// Write the manual page of the program or of a command to standard output
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Man {
    /// A command, such as run [default: the program]
    command: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  springfit man > ~/.local/share/man/man1/springfit.1
  springfit man run | man -l -                          # read it at once";

impl Man {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let mut program = (terminal.grammar)();
        program.build();
        let page = match &self.command {
            None => Page::new(program),
            Some(name) => {
                let names: Vec<String> = program.get_subcommands().map(|c| c.get_name().to_string()).collect();
                let Some(command) = program.find_subcommand(name) else {
                    let expected = format!("one of {}", names.join(", "));
                    return Err(unknown(expected, names.iter().map(String::as_str), name).at_key("COMMAND"));
                };
                let title = format!("springfit-{name}");
                Page::new(command.clone().display_name(&title)).title(title)
            }
        };
        let mut text = Vec::new();
        page.render(&mut text).map_err(|e| Error::io("the manual page cannot be written", e))?;
        terminal.print_bytes(&text)
    }
}
