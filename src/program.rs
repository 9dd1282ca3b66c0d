//! The program: parses the command line, runs the command, and gives the exit code. `main.rs` and the Python module start it.

use crate::commands::{self, Command};
use crate::terminal::{self, Level, Terminal, tell};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// Mass-spring models that answer like finite elements.
#[derive(Parser)]
#[command(name = "springfit", version, about, after_help = AFTER)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// How much is said beside the results.
#[derive(Args)]
struct Verbosity {
    /// Print results and errors alone: no notes, no progress, no names of files
    #[arg(short, long, global = true, help_heading = "Messages", conflicts_with = "verbose")]
    quiet: bool,
    /// Print all tables and notes of a run, and the time of each stage as well
    #[arg(short, long, global = true, help_heading = "Messages")]
    verbose: bool,
}

impl Verbosity {
    fn level(&self) -> Level {
        match (self.quiet, self.verbose) {
            (true, _) => Level::Quiet,
            (_, true) => Level::Verbose,
            _ => Level::Usual,
        }
    }
}

const AFTER: &str = "\
Examples:
  springfit new organ.msh -o organ.toml   # a commented scene for a mesh
  springfit run organ.toml                # fit, solve, compare
  springfit fit organ.msh --young 10kPa --poisson 0.45 -o springs.vtu

Results go to standard output; notes, progress and errors to standard error.
Lines fit the terminal; COLUMNS sets another width. Where there is none, tables fit 100 columns,
and a note is one line.
NO_COLOR=1 or CLICOLOR=0 turns colours off.

Exit codes:
  0    done
  1    done, but a check failed: an element has a fault (check), or an error is too large (stability)
  2    an input is wrong, or something cannot be read, written or solved; a line says what
  130  interrupted";

/// Defines the command line, with the help of all flags.
fn grammar() -> clap::Command {
    commands::explained(CommandLine::command())
}

/// Runs a command line, whose arguments are those after the name of the program. Help, and arguments that are wrong, end the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    say_why_no_thread_starts();
    commands::answer_interrupts();
    let words = || std::iter::once("springfit".into()).chain(arguments.iter().cloned());
    let line = CommandLine::try_parse_from(words()).unwrap_or_else(|error| {
        let full = (error.kind() == ErrorKind::DisplayHelp).then(|| grammar().try_get_matches_from(words()).err());
        terminal::printable_error(full.flatten().unwrap_or(error)).exit()
    });
    commands::typed_as(arguments);
    let mut terminal = Terminal::new(grammar, line.verbosity.level());
    line.command.run(&mut terminal).unwrap_or_else(|error| {
        terminal.clear();
        tell(&format!("error: {error}"));
        ExitCode::from(2)
    })
}

/// The threads of the program start with its first parallel work. Where none can, it ends as an error does.
fn say_why_no_thread_starts() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let words = panic.payload().downcast_ref::<String>().map_or("", String::as_str);
        if !words.contains("global thread pool has not been initialized") {
            return usual(panic);
        }
        tell("error: expected memory for the threads of this program, found none: allow more memory or more processes");
        std::process::exit(2);
    }));
}
