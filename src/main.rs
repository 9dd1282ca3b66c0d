//! The program: parses the command line, runs the command, and sets the exit code.

mod commands;
mod terminal;

use clap::Parser;
use commands::Command;
use std::process::ExitCode;
use terminal::{Terminal, tell};

/// Mass-spring models that answer like finite elements.
#[derive(Parser)]
#[command(version, about)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    // A file that may not grow further is an error like a full disk, not the end.
    #[cfg(unix)]
    #[allow(unsafe_code)]
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
    CommandLine::parse().command.run(&mut Terminal::new()).unwrap_or_else(|error| {
        tell(&format!("error: {error}"));
        ExitCode::from(2)
    })
}
