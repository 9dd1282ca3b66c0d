//! What tells the state of one whole-object fit from that of another.

use super::recipe::{DISCREPANCY, LEAVE_ONE_OUT, ValidationRecipe, WholeRecipe};
use super::record::WholeRecord;
use crate::solve::Newton;
use crate::whole::Weighing;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// All settings on which the steps of a fit depend, by their keys: what tells the state of one fit from that of another.
pub(super) fn identity(
    recipe: &WholeRecipe,
    springs: Option<&[String]>,
    newton: Option<&Newton>,
) -> BTreeMap<String, Value> {
    let mut settings: BTreeMap<String, Value> = match serde_json::to_value(WholeRecord::of(recipe)) {
        Ok(Value::Object(record)) => record.into_iter().collect(),
        _ => BTreeMap::new(),
    };
    let whole = &recipe.settings;
    let validated = match &recipe.validation {
        ValidationRecipe::Loads(loads) => json!({ "names": loads.names, "made": loads.made }),
        ValidationRecipe::LeaveOneOut => LEAVE_ONE_OUT.into(),
        ValidationRecipe::Discrepancy => DISCREPANCY.into(),
        ValidationRecipe::None => Value::Null,
    };
    let newton = newton
        .map(|newton| json!({ "steps": newton.steps, "iterations": newton.iterations, "tolerance": newton.tolerance }));
    let more = [
        ("springs", json!(springs)),
        ("loads", json!({ "names": recipe.loads.names, "made": recipe.loads.made })),
        ("validate", validated),
        ("regularization", json!(whole.regularizations)),
        ("iterations", json!(whole.iterations)),
        ("range", json!(whole.range)),
        ("by_error", json!(whole.weighing == Weighing::ByError)),
        ("newton", json!(newton)),
        ("stretch", json!(recipe.stretch)),
        ("engine", json!(recipe.engine)),
    ];
    settings.extend(more.map(|(key, value)| (key.to_string(), value)));
    settings
}
