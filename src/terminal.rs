//! What the program prints: results on standard output; notes, errors and progress on standard error.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use springfit::error::{Error, Result};
use springfit::report;
use springfit::study::{Event, Outcome};
use springfit::text::{printable, printable_lines};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Shows progress in a bar that appears on a terminal once work has taken a second.
pub struct Terminal {
    start: Instant,
    bar: Option<ProgressBar>,
}

impl Terminal {
    pub fn new() -> Terminal {
        Terminal { start: Instant::now(), bar: None }
    }

    /// Shows a stage in the bar, and a note above it.
    pub fn show(&mut self, event: Event) {
        let (name, done, total) = match event {
            Event::Stage { name, done, total } => (name, done, total),
            Event::Note(note) => {
                self.clear();
                return tell(&format!("note: {note}"));
            }
        };
        if self.bar.is_none() && std::io::stderr().is_terminal() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            self.bar = Some(style.into_iter().fold(bar, ProgressBar::with_style));
        }
        if let Some(bar) = &self.bar {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            bar.set_message(printable(name).into_owned());
        }
    }

    /// Removes the bar.
    pub fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// Prints to standard output; a reader who has gone away, as `head` does, ends the program quietly.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print(&mut self, text: &str) -> Result<()> {
        self.clear();
        match std::io::stdout().write_all(printable_lines(text).as_bytes()) {
            Ok(()) => Ok(()),
            Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => std::process::exit(0),
            Err(e) => Err(Error::io(format!("standard output cannot be written: {e}"), e)),
        }
    }

    /// Prints the tables of an outcome, and its notes.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print_outcome(&mut self, outcome: &Outcome) -> Result<()> {
        self.print(&format!("{}\n{}", report::summary(outcome), report::table(outcome)))?;
        report::notes(outcome).iter().for_each(|note| tell(&format!("note: {note}")));
        Ok(())
    }

    /// Names the files that were written.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn written(&mut self, paths: &[PathBuf]) -> Result<()> {
        paths.iter().try_for_each(|path| self.print(&format!("written: {}\n", path.display())))
    }
}

/// A line on standard error; if nobody can read it, nothing is lost.
pub fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", printable_lines(line));
}
