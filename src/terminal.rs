//! The output of the program: results on standard output; notes, errors and progress on standard error.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use springfit::error::{Error, Result};
use springfit::report;
use springfit::study::{Event, Outcome};
use springfit::text::{printable, printable_lines};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Shows progress: on a terminal in a bar that appears once work has taken a second, elsewhere in a line every ten
/// seconds.
pub struct Terminal {
    start: Instant,
    bar: Option<ProgressBar>,
    stage: Stage,
    /// When the last line was printed.
    last: Instant,
}

/// The running stage, and how much of it was done when it began.
struct Stage {
    name: String,
    start: Instant,
    first: usize,
}

/// The time between two lines of progress.
const BETWEEN_LINES: Duration = Duration::from_secs(10);
/// A stage states the remaining time after it has run this long.
const TRIAL: Duration = Duration::from_secs(1);

impl Stage {
    fn new(name: &str, done: usize) -> Stage {
        Stage { name: name.into(), start: Instant::now(), first: done }
    }

    /// The remaining time at the present pace.
    fn left(&self, done: usize, total: usize) -> Option<Duration> {
        let elapsed = self.start.elapsed();
        let (made, left) = (done.checked_sub(self.first)?, total.saturating_sub(done));
        (made > 0 && elapsed > TRIAL)
            .then(|| Duration::try_from_secs_f64(elapsed.as_secs_f64() * left as f64 / made as f64).ok())
            .flatten()
    }
}

impl Terminal {
    pub fn new() -> Terminal {
        let now = Instant::now();
        Terminal { start: now, bar: None, stage: Stage::new("", 0), last: now }
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
        if self.stage.name != name || done < self.stage.first {
            self.stage = Stage::new(name, done);
        }
        let left = self.stage.left(done, total).map_or(String::new(), |left| format!(", about {} left", words(left)));
        if !std::io::stderr().is_terminal() {
            if self.last.elapsed() >= BETWEEN_LINES {
                self.last = Instant::now();
                tell(&format!("note: {name}: {done} of {total}{left}"));
            }
            return;
        }
        if self.bar.is_none() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len}{prefix}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            self.bar = Some(style.into_iter().fold(bar, ProgressBar::with_style));
        }
        if let Some(bar) = &self.bar {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            bar.set_message(printable(name).into_owned());
            bar.set_prefix(left);
        }
    }

    /// Removes the bar.
    pub fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// Prints to standard output. If the reader is gone, as with `head`, the program ends without an error.
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

    /// Names the written files.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn written(&mut self, paths: &[PathBuf]) -> Result<()> {
        paths.iter().try_for_each(|path| self.print(&format!("written: {}\n", path.display())))
    }
}

/// `45 s`, `12 min` or `3 h`.
fn words(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// Prints a line on standard error; if it cannot be written, nothing is lost.
pub fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", printable_lines(line));
}
