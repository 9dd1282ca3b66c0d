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
    #[cfg(unix)]
    #[allow(unsafe_code)]
    unsafe {
        // A file that may not grow further (RLIMIT_FSIZE) gives an error like a full disk instead of ending the
        // program.
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
        // Rust aborts if an allocation fails that no estimate predicted; this ends like other errors.
        libc::signal(libc::SIGABRT, aborted as extern "C" fn(libc::c_int) as libc::sighandler_t);
    }
    CommandLine::parse().command.run(&mut Terminal::new()).unwrap_or_else(|error| {
        tell(&format!("error: {error}"));
        ExitCode::from(2)
    })
}

/// Ends the program as an error does. Nothing here allocates memory.
#[cfg(unix)]
#[allow(unsafe_code)]
extern "C" fn aborted(_: libc::c_int) {
    const LINE: &[u8] =
        b"error: the program cannot go on, as the line above says; if memory failed, take a smaller input\n";
    unsafe {
        libc::write(libc::STDERR_FILENO, LINE.as_ptr().cast(), LINE.len());
        libc::_exit(2);
    }
}
