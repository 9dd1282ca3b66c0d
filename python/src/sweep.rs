//! `sweep`: the studies of a scene, each run by itself, and their table.

use crate::error::{invalid, raised, unwritten};
use crate::progress::{self, apart};
use crate::stated::{HeldByName, in_memory};
use crate::study::{dictionary_path, keyless, settings_of, text_of};
use crate::value::table;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_foundation::error::Result;
use springfit_report::report::{Line, StudyLines, StudyRecord, StudyTable};
use springfit_studies::study::{self, Setting, Study};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// The studies of a scene.
#[pyclass(frozen, module = "springfit._core")]
pub struct Sweep {
    sweep: study::Sweep,
    text: String,
    path: PathBuf,
}

/// A file of one line for each study.
#[pyclass(frozen, module = "springfit._core")]
pub struct Studies(Mutex<StudyLines<StudyRecord>>);

#[pymethods]
impl Sweep {
    /// Of a path or a dictionary; `sweep` takes the place of the table `[sweep]`.
    #[new]
    #[pyo3(signature = (scene, folder, settings, held, sweep=None))]
    fn new(
        py: Python,
        scene: &Bound<PyAny>,
        folder: PathBuf,
        settings: &Bound<PyDict>,
        held: HeldByName,
        sweep: Option<&Bound<PyDict>>,
    ) -> PyResult<Sweep> {
        let (text, path) = text_of(py, scene, &folder)?;
        let mut settings = settings_of(py, settings)?;
        if let Some(sweep) = sweep {
            let table = toml::Value::Table(table(sweep, "over")?);
            settings.push(Setting::of("sweep", &table).map_err(|error| raised(py, error))?);
        }
        let (own, memory) = (dictionary_path(scene, &path), in_memory(&held));
        let sweep = apart(py, || study::Sweep::parse(&text, &path, &settings, &memory));
        let sweep = sweep.map_err(|error| raised(py, unwritten(keyless(error), own.as_deref())))?;
        Ok(Sweep { sweep, text, path })
    }

    /// The text of the scene, and its path, to which other files are relative.
    #[getter]
    fn scene(&self) -> (&str, &PathBuf) {
        (&self.text, &self.path)
    }

    /// The values of each study as JSON, which tells it from others.
    #[getter]
    fn marks(&self) -> Vec<String> {
        self.sweep.studies().iter().map(|study| StudyRecord::mark(&study.values())).collect()
    }

    /// Columns and rows, as JSON.
    fn table(&self, lines: &Studies) -> (Vec<String>, String) {
        let lines = lines.0.lock().unwrap_or_else(PoisonError::into_inner);
        let table = StudyTable::of(self.sweep.keys(), self.sweep.studies(), |mark| lines.record(mark));
        let rows = table.json().to_string();
        (table.columns, rows)
    }
}

#[pymethods]
impl Studies {
    /// Opens the file at `path`; what it has of the sweep is known.
    #[new]
    fn new(py: Python, path: PathBuf, sweep: &Sweep) -> PyResult<Studies> {
        let lines = apart(py, || StudyLines::open_file(path, &[], true, &StudyRecord::sums(&sweep.sweep)));
        Ok(Studies(Mutex::new(lines.map_err(|error| raised(py, error))?)))
    }

    fn __contains__(&self, mark: &str) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).record(mark).is_some()
    }

    /// Adds the line of a study.
    fn push(&self, py: Python, line: &str) -> PyResult<()> {
        let record = serde_json::from_str(line).map_err(|e| invalid(py, "executor", "the line of a study", e))?;
        let pushed = self.0.lock().unwrap_or_else(PoisonError::into_inner).push(record);
        pushed.map_err(|error| raised(py, error))
    }
}

/// Runs one study, whose values are a JSON object; returns its line.
#[pyfunction]
#[pyo3(signature = (text, path, settings, values, held, progress=None))]
pub fn study_line(
    py: Python,
    text: String,
    path: PathBuf,
    settings: &Bound<PyDict>,
    values: &str,
    held: HeldByName,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let settings = settings_of(py, settings)?;
    let values: toml::Table = serde_json::from_str(values).map_err(|e| invalid(py, "over", "values of TOML", e))?;
    let own = values.iter().map(|(key, value)| Setting::of(key, value)).collect::<Result<_>>();
    let study = Study { settings: own.map_err(|error| raised(py, error))? };
    let sweep = study::Sweep::of_studies(&text, &path, &settings, vec![study.clone()]).beside(&in_memory(&held));
    progress::run(py, progress, move |told| Ok(StudyRecord::of(&sweep, &study, &sweep.run_study(&study, told)).line()))
}
