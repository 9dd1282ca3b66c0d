//! Files of one line for each study, which grow while a sweep or a comparison runs and which it goes on from.

use crate::error::{Error, ErrorKind, Result};
use crate::file::{create_folder, files_in, read_text};
use crate::network::Shard;
use crate::study::{CaseRecord, ComparedCase, Comparing, MethodRecord};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Each line of the files begins so.
const BEGINNING: &[u8] = br#"{"settings":{"#;

/// Whether each line begins as a study does, the last one as far as it was written.
fn is_of_sweep(text: &[u8]) -> bool {
    text.split_inclusive(|byte| *byte == b'\n').all(|line| {
        let length = line.len().min(BEGINNING.len());
        line[..length] == BEGINNING[..length]
    })
}

/// The names of the files of a sweep begin so.
const STEM: &str = "studies";

/// A record on a line: `settings` come first.
pub trait Line: Serialize + DeserializeOwned {
    /// The values that tell the study from others.
    fn settings(&self) -> &BTreeMap<String, Value>;

    /// A sum of all that the study depends on.
    fn inputs(&self) -> &str;

    /// What contradicts itself in the record, if anything does.
    fn fault(&self) -> Option<&'static str> {
        None
    }

    /// What tells the study from others, in a word.
    fn mark(&self) -> String {
        mark_of(self.settings())
    }

    /// The record on one line, with its end.
    fn line(&self) -> String {
        serde_json::to_string(self).expect("keys are text") + "\n"
    }
}

/// The names of what differs between two lists of names with sums; `None` of sums alone, which do not say it.
fn changed(found: &str, expected: &str) -> Option<String> {
    let parts = |text: &str| -> BTreeMap<String, String> {
        let part = |part: &str| part.rsplit_once(' ').map(|(name, sum)| (name.to_string(), sum.to_string()));
        text.split("; ").filter_map(part).collect()
    };
    let (found, expected) = (parts(found), parts(expected));
    let names: BTreeSet<&String> = found.keys().chain(expected.keys()).collect();
    let other = names.into_iter().filter(|name| found.get(*name) != expected.get(*name));
    let other: Vec<&str> = other.map(String::as_str).collect();
    (!found.is_empty() && !other.is_empty()).then(|| other.join(", "))
}

/// What tells a study with these values from others.
pub fn mark_of(settings: &BTreeMap<String, Value>) -> String {
    serde_json::to_string(settings).expect("keys are text")
}

impl Line for CaseRecord {
    fn settings(&self) -> &BTreeMap<String, Value> {
        &self.settings
    }

    fn inputs(&self) -> &str {
        &self.inputs
    }

    fn fault(&self) -> Option<&'static str> {
        let is_odd = |method: &MethodRecord| method.values.values().any(|list| list.len() != method.items.len());
        match (self.methods.is_empty(), &self.error) {
            (true, None) => Some("no methods"),
            (true, Some(_)) => None,
            (false, _) => self.methods.iter().any(is_odd).then_some("values that are not those of its items"),
        }
    }
}

/// The studies that a file may have, by their marks, and the sum of all that each depends on.
pub type Expected<'a> = &'a dyn Fn(&str) -> Option<String>;

/// The records of the studies that are done, in the folder of a sweep or of a comparison.
pub struct StudyLines<R> {
    file: File,
    path: PathBuf,
    /// By [`Line::mark`].
    records: HashMap<String, R>,
    /// The marks of studies that are not asked for.
    beyond: HashSet<String>,
}

impl StudyLines<CaseRecord> {
    /// Opens the file of a comparison. With `resume` the cases are known that it has; without, it must have none.
    ///
    /// # Errors
    /// Those of [`StudyLines::open_file`].
    pub fn of_comparison(
        path: PathBuf,
        resume: bool,
        comparing: &Comparing,
        folder: &Path,
    ) -> Result<StudyLines<CaseRecord>> {
        create_folder(folder)?;
        let cases: HashMap<String, &ComparedCase> =
            comparing.cases().iter().map(|case| (mark_of(&case.settings), case)).collect();
        StudyLines::open_file(path, &[], resume, &|mark| cases.get(mark).map(|case| comparing.sum(case)))
    }
}

impl<R: Line> StudyLines<R> {
    /// Opens the file of a shard in `folder`, which is made. With `resume` the studies are known that any file there has; without,
    /// the file must have none, and those of other shards must be of the same scene.
    ///
    /// # Errors
    /// The file cannot be written, or another process writes it; it has studies already; or one of them is of another scene, or of this
    /// one before a change.
    pub fn open(folder: &Path, shard: Shard, resume: bool, expected: Expected) -> Result<StudyLines<R>> {
        create_folder(folder)?;
        let path = folder.join(shard.file_name(STEM, "jsonl"));
        let mut others = files_in(folder, "jsonl")?;
        if !resume {
            let is_of_shard =
                |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STEM));
            others.retain(is_of_shard);
        }
        let mut lines = StudyLines::open_file(path, &others, resume, expected)?;
        if !resume {
            lines.records.clear();
        }
        Ok(lines)
    }

    /// Opens one file, with what `others` have as well.
    ///
    /// # Errors
    /// Those of [`StudyLines::open`].
    pub fn open_file(path: PathBuf, others: &[PathBuf], resume: bool, expected: Expected) -> Result<StudyLines<R>> {
        let failed = |what: &str, e| Error::io(what, e).in_file(&path);
        let opened = File::options().read(true).append(true).create(true).open(&path);
        let mut file = opened.map_err(|e| failed("cannot be written", e))?;
        // Other errors, such as those of a file system without locks, do not stop a study. A lock ends with its process.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(Error::new("another process is writing to it: is the same study running?")
                .of_kind(ErrorKind::Io)
                .in_file(&path));
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(|e| failed("cannot be read", e))?;
        if !is_of_sweep(&text) {
            let words = "expected a file of a sweep or of a comparison, or none, found one of others: move it away, or choose another folder";
            return Err(Error::new(words).in_file(&path));
        }
        let found = text.iter().filter(|byte| **byte == b'\n').count();
        if found > 0 && !resume {
            let words = format!(
                "expected a file without studies, found {found}: --resume goes on from them, --out names another folder"
            );
            return Err(Error::new(words).in_file(&path));
        }
        let mut lines = StudyLines { file, path, records: HashMap::new(), beyond: HashSet::new() };
        let own = lines.path.clone();
        for other in others.iter().filter(|other| **other != own) {
            let text = read_text(other)?;
            lines.take(&text, other, expected)?;
        }
        // What a kill has left of a line is cut off.
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let kept = String::from_utf8_lossy(&text[..whole]).into_owned();
        lines.take(&kept, &own, expected)?;
        if whole < text.len() {
            let cut = lines.file.set_len(whole as u64).and_then(|()| lines.file.seek(SeekFrom::End(0)));
            cut.map_err(|e| Error::io("cannot be written", e).in_file(&lines.path))?;
        }
        Ok(lines)
    }

    /// Takes over the complete lines of a file.
    fn take(&mut self, text: &str, path: &Path, expected: Expected) -> Result<()> {
        let complete = text.rfind('\n').map_or("", |end| &text[..end]);
        for (number, line) in complete.lines().enumerate() {
            let fault = |words: String| Error::new(words).on_line(number + 1).in_file(path);
            let record: R = serde_json::from_str(line)
                .map_err(|e| fault(format!("expected a study of this kind, found something else: {e}")))?;
            if let Some(found) = record.fault() {
                return Err(fault(format!("expected a value for each item of a study, found {found}")));
            }
            let mark = record.mark();
            // Studies that are no longer asked for stay in the file.
            let Some(sum) = expected(&mark) else {
                self.beyond.insert(mark);
                continue;
            };
            if record.inputs() != sum {
                let found = match changed(record.inputs(), &sum) {
                    Some(names) => format!("one with another {names}"),
                    None => "one of others, or of these before a change or by another version".into(),
                };
                return Err(fault(format!(
                    "expected a study of this file and those that it names, found {found}: choose another folder"
                )));
            }
            self.records.insert(mark, record);
        }
        Ok(())
    }

    /// The number of studies in the files that are not asked for.
    pub fn beyond(&self) -> usize {
        self.beyond.len()
    }

    /// The record of the study of these values.
    pub fn record(&self, mark: &str) -> Option<&R> {
        self.records.get(mark)
    }

    /// The record of the study of these values.
    pub fn of(&self, settings: &BTreeMap<String, Value>) -> Option<&R> {
        self.record(&mark_of(settings))
    }

    /// Adds a line.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn push(&mut self, record: R) -> Result<()> {
        // One write for each line: what a kill leaves is a beginning of it, which the next run cuts off.
        let written = self.file.write_all(record.line().as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|e| Error::io("cannot be written", e).in_file(&self.path))?;
        self.records.insert(record.mark(), record);
        Ok(())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}
