//! The output of the program: results on standard output; notes, errors and progress on standard error.

use clap::builder::styling::{AnsiColor, Style};
use clap::error::{ContextKind, ContextValue};
use console::measure_text_width;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::text::{cut, printable, printable_lines, time_in_words};
use springfit_report::report::{self, Detail};
use springfit_studies::study::Event;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// How much the program says beside its results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Level {
    /// Errors alone.
    Quiet,
    /// Notes and progress as well.
    #[default]
    Usual,
    /// All tables and notes, and the time of each stage as well.
    Verbose,
}

/// Shows progress: on a terminal in a bar that appears once work has taken a second, elsewhere in a line every ten seconds.
pub struct Terminal {
    /// The arguments of the program, for completions and manual pages.
    pub grammar: fn() -> clap::Command,
    level: Level,
    /// The columns that lines are broken to, if anything sets them.
    page: Option<usize>,
    start: Instant,
    bar: Option<ProgressBar>,
    stage: Stage,
    /// When the last line was printed.
    last: Instant,
    /// Whether standard output is a document that other programs read.
    is_document: bool,
}

/// The running stage, and how much of it was done when it began.
struct Stage {
    name: String,
    start: Instant,
    first: usize,
    /// Whether it was said that it will take long.
    is_announced: bool,
}

/// The time between two lines of progress: long enough that a log of hours stays short, and short enough to see that work goes on.
const BETWEEN_LINES: Duration = Duration::from_secs(10);
/// A stage states the remaining time after it has run this long and so many parts in a hundred are done, or after the longer time: the first parts
/// are seldom like the others.
const TRIAL: Duration = Duration::from_secs(1);
const ENOUGH: usize = 5;
const LONG_TRIAL: Duration = Duration::from_secs(6);
/// A stage that will take longer says so.
const LONG: Duration = Duration::from_secs(10);
/// Columns of a page where there is no terminal, and the least that tables are fitted to.
const PAGE: usize = 100;
const NARROWEST: usize = 40;
/// More files of a folder are named in one line.
const FEW_FILES: usize = 2;

/// A record as a JSON document.
pub fn json_text(record: &impl Serialize) -> String {
    serde_json::to_string_pretty(record).expect("keys are text") + "\n"
}

impl Level {
    fn detail(self) -> Detail {
        if self == Level::Verbose { Detail::All } else { Detail::Overview }
    }
}

impl Stage {
    fn new(name: &str, done: usize) -> Stage {
        Stage { name: name.into(), start: Instant::now(), first: done, is_announced: false }
    }

    /// The remaining time at the present pace.
    fn left(&self, done: usize, total: usize) -> Option<Duration> {
        let elapsed = self.start.elapsed();
        // How many steps there will be may not be known, and none may be left.
        let left = total.checked_sub(done).filter(|left| *left > 0)?;
        // What was done before the stage was seen, as by a checkpoint, took none of the time.
        let made = done.checked_sub(self.first)?;
        let is_enough = 100 * made >= ENOUGH * total || elapsed > LONG_TRIAL;
        (made > 0 && elapsed > TRIAL && is_enough)
            // A pace near zero gives a time beyond all durations.
            .then(|| Duration::try_from_secs_f64(elapsed.as_secs_f64() * left as f64 / made as f64).ok())
            .flatten()
    }
}

impl Terminal {
    pub fn new(grammar: fn() -> clap::Command, level: Level) -> Terminal {
        let now = Instant::now();
        let page = page_width();
        report::set_page(page.unwrap_or(PAGE), level.detail());
        Terminal {
            grammar,
            level,
            page,
            start: now,
            bar: None,
            stage: Stage::new("", 0),
            last: now,
            is_document: false,
        }
    }

    /// Shows a stage in the bar, and a note above it.
    pub fn show(&mut self, event: Event) {
        let (name, done, total) = match event {
            Event::Stage { name, done, total } => (name, done, total),
            Event::Note(note) => return self.note(note),
        };
        // A count that falls is that of a stage with the same name that begins again.
        if self.stage.name != name || done < self.stage.first {
            self.end_stage();
            self.stage = Stage::new(name, done);
        }
        if self.level == Level::Quiet {
            return;
        }
        let left = self.stage.left(done, total);
        let steps = if total > 0 { format!("{done} of {total}") } else { format!("{done} steps") };
        let words = left.map_or(String::new(), |left| format!(", about {} left", time_in_words(left.as_secs_f64())));
        if left.is_some_and(|left| left > LONG) && !self.stage.is_announced {
            self.stage.is_announced = true;
            self.last = Instant::now();
            let line = self.within_page(&format!("note: {name}: {steps}{words}, estimated from the pace so far"));
            return self.above_bar(|| tell(&line));
        }
        if !std::io::stderr().is_terminal() {
            if self.last.elapsed() >= BETWEEN_LINES {
                self.last = Instant::now();
                tell(&self.within_page(&format!("note: {name}: {steps}{words}")));
            }
            return;
        }
        if self.bar.is_none() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len}{prefix}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            self.bar = Some(style.into_iter().fold(bar, ProgressBar::with_style));
        }
        if let Some(bar) = &self.bar {
            // Without an end the bar is empty, and the words count.
            let is_open = total == 0;
            bar.set_length(total.max(1) as u64);
            bar.set_position(if is_open { 0 } else { done as u64 });
            bar.set_message(if is_open {
                format!("{}, {steps}", printable(name))
            } else {
                printable(name).into_owned()
            });
            bar.set_prefix(words);
        }
    }

    /// Says how long the stage took, if that is asked for.
    fn end_stage(&mut self) {
        if self.level == Level::Verbose && !self.stage.name.is_empty() {
            let line = format!("stage: {}: {:.2} s", self.stage.name, self.stage.start.elapsed().as_secs_f64());
            self.above_bar(|| tell(&line));
        }
        self.stage = Stage::new("", 0);
    }

    fn above_bar(&self, print: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// A sentence for the user on standard error.
    pub fn note(&mut self, note: &str) {
        if self.level != Level::Quiet {
            self.clear();
            tell(&self.within_page(&format!("note: {note}")));
        }
    }

    /// How much of the tables of a run is printed.
    pub fn detail(&self) -> Detail {
        self.level.detail()
    }

    /// Breaks sentences into lines where a terminal or `COLUMNS` sets a width. Elsewhere a sentence is a line, which other programs search.
    pub fn within_page(&self, text: &str) -> String {
        let Some(page) = self.page else { return text.into() };
        text.lines().map(|line| broken(line, page) + "\n").collect::<String>().trim_end_matches('\n').to_string()
            + if text.ends_with('\n') { "\n" } else { "" }
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
        self.print_bytes(printable_lines(text).as_bytes())
    }

    /// Prints text of this program, which may have control characters, as [`Terminal::print`] does.
    ///
    /// # Errors
    /// As there.
    pub fn print_bytes(&mut self, text: &[u8]) -> Result<()> {
        self.end_stage();
        self.clear();
        match std::io::stdout().write_all(text).and_then(|()| std::io::stdout().flush()) {
            Ok(()) => Ok(()),
            Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => std::process::exit(0),
            Err(e) => Err(Error::io(format!("standard output cannot be written: {e}"), e)),
        }
    }

    /// Prints all that standard output is to have: names of files go to standard error.
    ///
    /// # Errors
    /// As [`Terminal::print`].
    pub fn print_document(&mut self, text: &str) -> Result<()> {
        self.is_document = true;
        self.print(text)
    }

    /// Prints a record as the one JSON document of standard output.
    ///
    /// # Errors
    /// As [`Terminal::print`].
    pub fn print_json(&mut self, record: &impl Serialize) -> Result<()> {
        self.print_document(&json_text(record))
    }

    /// Names the files that were written, several of a folder in one line; beside a document on standard error.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn written(&mut self, paths: &[PathBuf]) -> Result<()> {
        // Programs read what stands beside a document.
        let is_listed =
            |files: &[PathBuf]| files.len() <= FEW_FILES || self.is_document || self.detail() == Detail::All;
        let mut lines = Vec::new();
        for files in paths.chunk_by(|a, b| a.parent() == b.parent()) {
            if is_listed(files) {
                lines.extend(files.iter().map(|path| format!("written: {}", path.display())));
                continue;
            }
            let folder = files[0].parent().map_or(String::new(), |folder| folder.display().to_string());
            let names: Vec<_> =
                files.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy()).collect();
            lines.push(self.within_page(&format!("written: {} in {folder}", names.join(", "))));
        }
        lines.iter().try_for_each(|line| self.say(line))
    }

    /// A line after the results.
    ///
    /// # Errors
    /// As there.
    pub fn say(&mut self, line: &str) -> Result<()> {
        match (self.level, self.is_document) {
            (Level::Quiet, _) => Ok(()),
            (_, true) => {
                tell(line);
                Ok(())
            }
            (_, false) => self.print(&format!("{line}\n")),
        }
    }
}

/// The error of a command line with the arguments that it quotes made printable, and cut if they are long.
pub fn printable_error(mut error: clap::Error) -> clap::Error {
    let shown = |text: &str| cut(&printable(text)).into_owned();
    let quoted: Vec<(ContextKind, ContextValue)> = error
        .context()
        .filter_map(|(kind, value)| match value {
            ContextValue::String(text) => Some((kind, ContextValue::String(shown(text)))),
            ContextValue::Strings(texts) => {
                Some((kind, ContextValue::Strings(texts.iter().map(|text| shown(text)).collect())))
            }
            _ => None,
        })
        .collect();
    for (kind, value) in quoted {
        // A suggestion has the argument once more, between styles.
        if error.get(kind) != Some(&value) {
            drop(error.remove(ContextKind::Suggested));
        }
        drop(error.insert(kind, value));
    }
    error
}

/// The line in lines of at most `page` columns, as far as its words allow. Those behind the first one are indented; what is aligned in columns
/// stays as it is.
fn broken(line: &str, page: usize) -> String {
    let is_in_columns = line.starts_with(' ') || line.contains("  ");
    if is_in_columns || measure_text_width(line) <= page {
        return line.into();
    }
    let mut text = String::new();
    let mut room = page;
    for word in line.split(' ') {
        let width = measure_text_width(word);
        if text.is_empty() {
            room = page.saturating_sub(width);
        } else if width < room {
            text.push(' ');
            room -= width + 1;
        } else {
            text += "\n  ";
            room = page.saturating_sub(width + 2);
        }
        text += word;
    }
    text
}

/// The columns of the terminal or of `COLUMNS`, which goes first; none where there is neither.
fn page_width() -> Option<usize> {
    let given = std::env::var("COLUMNS").ok().and_then(|columns| columns.trim().parse::<usize>().ok());
    let terminal = || {
        let terminal = console::Term::stdout();
        terminal
            .features()
            .is_attended()
            .then(|| terminal.size_checked())
            .flatten()
            .map(|(_, columns)| usize::from(columns))
    };
    given.filter(|columns| *columns > 0).or_else(terminal).map(|columns| columns.max(NARROWEST))
}

/// Prints a line on standard error; if it cannot be written, nothing is lost. Its first word has a colour on a terminal,
/// unless `NO_COLOR` is set or `CLICOLOR` is 0.
pub fn tell(line: &str) {
    let bold = |color: AnsiColor| Style::new().bold().fg_color(Some(color.into()));
    let styles =
        [("error:", bold(AnsiColor::Red)), ("note:", bold(AnsiColor::Cyan)), ("stage:", bold(AnsiColor::Green))];
    let line = printable_lines(line);
    let mut stream = anstream::stderr();
    let _ = match styles.iter().find(|(word, _)| line.starts_with(word)) {
        Some((word, style)) => writeln!(stream, "{style}{word}{style:#}{}", &line[word.len()..]),
        None => writeln!(stream, "{line}"),
    };
}
