//! The record of one study of a sweep: a line of `studies.jsonl`.

use super::json::Report;
use super::study_lines::{Line, mark_of};
use crate::error::Result;
use crate::study::{Outcome, Study, Sweep};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};

/// What came out of one study of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// The values that were set, by their keys.
    pub settings: BTreeMap<String, Value>,
    /// A sum of the scene, of the files that it names and of the values: where it differs, the figures are those of something else.
    pub inputs: String,
    /// The report of a run with these values; null if the study failed.
    pub report: Option<Value>,
    /// Why it failed.
    pub error: Option<String>,
}

impl StudyRecord {
    /// The record of a study of this sweep.
    pub fn of(sweep: &Sweep, study: &Study, outcome: &Result<Outcome>) -> StudyRecord {
        let report = |outcome: &Outcome| serde_json::to_value(Report::of(outcome)).expect("keys are text");
        StudyRecord {
            settings: study.values(),
            inputs: sweep.inputs(study),
            report: outcome.as_ref().ok().map(report),
            error: outcome.as_ref().err().map(|error| error.to_string()),
        }
    }

    /// What tells a study from others of its sweep.
    pub fn mark(settings: &BTreeMap<String, Value>) -> String {
        mark_of(settings)
    }

    /// The sums of all studies of a sweep, by their marks.
    pub fn sums(sweep: &Sweep) -> impl Fn(&str) -> Option<String> + use<'_> {
        let places: HashMap<String, usize> =
            sweep.studies().iter().enumerate().map(|(i, study)| (mark_of(&study.values()), i)).collect();
        move |mark| places.get(mark).map(|&place| sweep.inputs(&sweep.studies()[place]))
    }
}

/// What the errors of a fit under one of its loads are relative to: the finite elements of the mesh, `cells`, or a measurement or finer solution.
pub fn reference<'a>(report: &'a Value, load: &Value) -> &'a str {
    let measured = report["measured"].as_array().into_iter().flatten();
    let mut standards = measured.filter(|known| known["load"] == load["name"]).map(|known| &known["standard"]);
    standards.next().and_then(Value::as_str).unwrap_or("cells")
}

impl Line for StudyRecord {
    fn settings(&self) -> &BTreeMap<String, Value> {
        &self.settings
    }

    fn inputs(&self) -> &str {
        &self.inputs
    }
}
