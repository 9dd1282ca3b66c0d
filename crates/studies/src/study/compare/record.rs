//! What a comparison finds, as it is kept on disk: a line for each case.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// What came out of one case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// What the case is: its element or scene, and the values of the keys that cases differ in.
    pub settings: BTreeMap<String, Value>,
    /// A sum of all that the case depends on: where it differs, the figures are those of something else.
    pub inputs: String,
    /// Each method with its figures, in the order of the fits; the finite elements of a scene come last.
    pub methods: Vec<MethodRecord>,
    /// Why the case failed.
    pub error: Option<String>,
}

impl CaseRecord {
    /// The name of the element or of the scene.
    pub fn object(&self) -> &str {
        let named = ["element", "scene"].iter().find_map(|key| self.settings.get(*key)?.as_str());
        named.unwrap_or_default()
    }
}

/// A fit on one case.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MethodRecord {
    /// The name of the fit.
    pub fit: String,
    /// The settings of the fit, by their keys.
    pub settings: BTreeMap<String, Value>,
    /// This number of elements was fitted.
    pub fitted: usize,
    /// This number of elements has the constants of a congruent one.
    pub copied: usize,
    /// What the values are of: the numbers of shapes, the names of loads, or stretches.
    pub items: Vec<String>,
    /// The values of each quantity, one for each item.
    pub values: BTreeMap<String, Vec<Option<f64>>>,
    /// Figures of the whole case.
    pub figures: BTreeMap<String, Option<f64>>,
    /// The processor time of each pass, s, by what was done.
    pub times: BTreeMap<String, Vec<f64>>,
    /// Why the method has no figures here.
    pub refused: Option<String>,
}
