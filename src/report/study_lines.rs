//! Files of one line for each study, which grow while a sweep runs and which it goes on from.

use super::study_record::StudyRecord;
use crate::error::{Error, ErrorKind, Result};
use crate::file::{create_folder, files_in, read_text};
use crate::network::Shard;
use crate::study::Sweep;
use std::collections::HashMap;
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

/// The names of the files begin so.
const STEM: &str = "studies";

/// The records of the studies that are done, in the folder of a sweep.
pub struct StudyLines {
    file: File,
    path: PathBuf,
    /// By [`StudyRecord::mark`].
    records: HashMap<String, StudyRecord>,
}

impl StudyLines {
    /// Opens the file of a shard in `folder`, which is made. With `resume` the studies are known that any file there has; without,
    /// the file must have none, and those of other shards must be of the same scene.
    ///
    /// # Errors
    /// The file cannot be written, or another process writes it; it has studies already; or one of them is of another scene, or of this
    /// one before a change.
    pub fn open(folder: &Path, shard: Shard, resume: bool, sweep: &Sweep) -> Result<StudyLines> {
        create_folder(folder)?;
        let path = folder.join(shard.file_name(STEM, "jsonl"));
        let mut others = files_in(folder, "jsonl")?;
        if !resume {
            let is_of_shard =
                |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STEM));
            others.retain(is_of_shard);
        }
        let mut lines = StudyLines::open_file(path, &others, resume, sweep)?;
        if !resume {
            lines.records.clear();
        }
        Ok(lines)
    }

    /// Opens one file, with what `others` have as well.
    ///
    /// # Errors
    /// Those of [`StudyLines::open`].
    pub fn open_file(path: PathBuf, others: &[PathBuf], resume: bool, sweep: &Sweep) -> Result<StudyLines> {
        let failed = |what: &str, e| Error::io(what, e).in_file(&path);
        let opened = File::options().read(true).append(true).create(true).open(&path);
        let mut file = opened.map_err(|e| failed("cannot be written", e))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(Error::new("another process is writing to it: is the same sweep running?")
                .of_kind(ErrorKind::Io)
                .in_file(&path));
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(|e| failed("cannot be read", e))?;
        if !is_of_sweep(&text) {
            let words =
                "expected a file of a sweep, or none, found one of others: move it away, or choose another folder";
            return Err(Error::new(words).in_file(&path));
        }
        let found = text.iter().filter(|byte| **byte == b'\n').count();
        if found > 0 && !resume {
            let words = format!(
                "expected a file without studies, found {found}: --resume goes on from them, --out names another folder"
            );
            return Err(Error::new(words).in_file(&path));
        }
        let mut lines = StudyLines { file, path, records: HashMap::new() };
        let expected: HashMap<String, usize> =
            sweep.studies().iter().enumerate().map(|(i, study)| (StudyRecord::mark(&study.values()), i)).collect();
        let own = lines.path.clone();
        for other in others.iter().filter(|other| **other != own) {
            let text = read_text(other)?;
            lines.take(&text, other, sweep, &expected)?;
        }
        // What a kill has left of a line is cut off.
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let kept = String::from_utf8_lossy(&text[..whole]).into_owned();
        lines.take(&kept, &own, sweep, &expected)?;
        if whole < text.len() {
            let cut = lines.file.set_len(whole as u64).and_then(|()| lines.file.seek(SeekFrom::End(0)));
            cut.map_err(|e| Error::io("cannot be written", e).in_file(&lines.path))?;
        }
        Ok(lines)
    }

    /// Takes over the complete lines of a file.
    fn take(&mut self, text: &str, path: &Path, sweep: &Sweep, expected: &HashMap<String, usize>) -> Result<()> {
        let complete = text.rfind('\n').map_or("", |end| &text[..end]);
        for (number, line) in complete.lines().enumerate() {
            let fault = |words: String| Error::new(words).on_line(number + 1).in_file(path);
            let record: StudyRecord = serde_json::from_str(line)
                .map_err(|e| fault(format!("expected a study of a sweep, found something else: {e}")))?;
            let mark = StudyRecord::mark(&record.settings);
            // Studies that the sweep no longer has stay in the file.
            let Some(&place) = expected.get(&mark) else { continue };
            if record.inputs != format!("{:016x}", sweep.sum(&sweep.studies()[place])) {
                let words = "expected a study of this scene and its files, found one of others, or of these before a change or by \
                             another version: choose another folder";
                return Err(fault(words.into()));
            }
            self.records.insert(mark, record);
        }
        Ok(())
    }

    /// The record of the study of these values.
    pub fn record(&self, mark: &str) -> Option<&StudyRecord> {
        self.records.get(mark)
    }

    /// Adds a line.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn push(&mut self, record: StudyRecord) -> Result<()> {
        let written = self.file.write_all(record.line().as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|e| Error::io("cannot be written", e).in_file(&self.path))?;
        self.records.insert(StudyRecord::mark(&record.settings), record);
        Ok(())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}
