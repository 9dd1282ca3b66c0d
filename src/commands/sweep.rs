//! `springfit sweep`.

use super::output::OutputOptions;
use super::scene_file::Settings;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::Result;
use springfit_foundation::file::write_whole;
use springfit_report::report::{self, Shard, StudyLines, StudyRecord, StudyTable};
use springfit_studies::study::{Event, Sweep as Studies, check_jobs};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Run a scene for many values of its keys, as its [sweep] says: lists, grids, random and Sobol samples
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Sweep {
    /// The scene file, with a table [sweep]
    scene: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Studies that run at the same time; the processors are shared out among them
    #[arg(long, default_value_t = 1, value_name = "N")]
    jobs: usize,
    /// Run every COUNT-th study from the NUMBER-th on, into files of its own in the same folder, for several machines
    #[arg(long, value_name = "NUMBER/COUNT", allow_hyphen_values = true)]
    shard: Option<String>,
    /// Go on from the studies that the folder has, those of other shards as well; failed ones are not run again
    #[arg(long)]
    resume: bool,
    /// List the studies, and stop
    #[arg(long)]
    explain: bool,
    /// Write a page as well, OUT/sweep.html: errors over the first key with several numbers, and the table
    #[arg(long, help_heading = "Output")]
    report: bool,
    /// Folder of the lines and the table [default: out/sweep-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit sweep scene.toml --explain            # the studies; nothing is run
  springfit sweep scene.toml --jobs 4
  springfit sweep scene.toml --resume             # after an interruption, or with more values in [sweep]
  springfit sweep scene.toml --shard 2/5          # on the second of five machines with a common folder
  springfit sweep scene.toml --set sweep.samples=100 --out out/more";

/// The table is written no more often while the sweep runs.
const BETWEEN_TABLES: Duration = Duration::from_secs(5);

impl Sweep {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        check_jobs(self.jobs)?;
        let shard = self.shard.as_deref().map_or(Ok(Shard::WHOLE), Shard::parse)?;
        let sweep = self.settings.sweep(&self.scene)?;
        let marks: Vec<String> = sweep.studies().iter().map(|study| StudyRecord::mark(&study.values())).collect();
        if self.explain {
            return self.explain(terminal, &sweep);
        }
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(format!("sweep-{stem}")));
        let name = shard.file_name("table", "csv");
        report::check_study_table(&folder.join(&name), std::slice::from_ref(&self.scene))?;
        let page = self.report.then(|| folder.join(shard.file_name("sweep", "html")));
        if let Some(page) = &page {
            report::check_study_page(page, std::slice::from_ref(&self.scene))?;
        }
        let mut lines = StudyLines::open(&folder, shard, self.resume, &StudyRecord::sums(&sweep))?;
        let own: HashSet<&str> =
            (0..marks.len()).filter(|place| shard.has(*place)).map(|place| marks[place].as_str()).collect();
        let table = |lines: &StudyLines<StudyRecord>| {
            let of_shard = |mark: &str| lines.record(mark).filter(|_| own.contains(mark));
            StudyTable::of(sweep.keys(), sweep.studies(), of_shard)
        };
        let path = folder.join(name);
        let beyond = lines.beyond();
        if beyond > 0 {
            terminal.note(&format!(
                "the folder has {beyond} studies of other values: the table leaves them out, and figures of the folder have them as well"
            ));
        }
        // Each is run once, also where the design has it twice.
        let mut known = HashSet::new();
        let mut is_left = |mark| lines.record(mark).is_none() && own.contains(mark) && known.insert(mark);
        let places: Vec<usize> = (0..marks.len()).filter(|place| is_left(marks[*place].as_str())).collect();
        let total = own.len();
        let mut done = total - places.len();
        if done > 0 {
            terminal.note(&format!("{done} of {total} studies are there already"));
        }
        let mut last = Instant::now();
        let record = |study: &_, outcome| StudyRecord::of(&sweep, study, &outcome);
        sweep.run(&places, self.jobs, record, |_, record| {
            lines.push(record)?;
            done += 1;
            terminal.show(Event::stage("studies", done, total));
            if last.elapsed() >= BETWEEN_TABLES {
                write_whole(&path, table(&lines).csv().as_bytes())?;
                last = Instant::now();
            }
            Ok(())
        })?;
        let table = table(&lines);
        write_whole(&path, table.csv().as_bytes())?;
        let records: Vec<&StudyRecord> = marks.iter().filter_map(|mark| lines.record(mark)).collect();
        let failed = records.iter().filter(|record| record.error.is_some()).count();
        let title = format!("{}: {} of {} studies", sweep.title(), records.len(), marks.len());
        let (keys, studies) = (sweep.keys(), sweep.studies());
        let found = || report::studies_table(&title, keys, studies, |mark| lines.record(mark));
        self.output.print(terminal, || table.json(), || vec![found()], || report::studies_text(found()))?;
        if failed > 0 {
            terminal.note(&format!(
                "{failed} of {} studies failed; the column \"error\" of the table says why",
                records.len()
            ));
        }
        let mut written = vec![lines.path().to_path_buf(), path];
        if let Some(page) = page {
            write_whole(&page, report::studies_page(&title, &found(), &folder).as_bytes())?;
            written.push(page);
        }
        terminal.written(&written)
    }

    fn explain(&self, terminal: &mut Terminal, sweep: &Studies) -> Result<()> {
        let (keys, studies) = (sweep.keys(), sweep.studies());
        let title = format!("{}: {} studies", sweep.title(), studies.len());
        self.output.print(
            terminal,
            || studies.iter().map(|study| study.values()).collect::<Vec<_>>(),
            || vec![report::planned_table(&title, keys, studies)],
            || report::studies_text(report::planned_table(&title, keys, studies)),
        )
    }
}
