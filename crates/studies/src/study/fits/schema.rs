//! The JSON Schema of a `[[fit]]`: one alternative for each kind, which its objective tells.

use super::entry::{FitEntry, Kind};
use super::exact::ExactEntry;
use super::published::PublishedEntry;
use super::sampled::SampledEntry;
use super::stiffness::StiffnessEntry;
use super::whole::WholeEntry;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

impl JsonSchema for FitEntry {
    fn schema_name() -> Cow<'static, str> {
        "FitEntry".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let kinds: Vec<Value> = Kind::all().map(|kind| alternative(kind, generator)).collect();
        json_schema!({ "oneOf": kinds })
    }
}

fn alternative(kind: Kind, generator: &mut SchemaGenerator) -> Value {
    let mut properties = Map::new();
    if kind == Kind::Whole {
        // It may start from a sampled fit.
        properties.extend(keys::<SampledEntry>(generator));
        properties.remove("tied");
    }
    properties.extend(match kind {
        Kind::Stiffness => keys::<StiffnessEntry>(generator),
        Kind::Sampled => keys::<SampledEntry>(generator),
        Kind::Whole => keys::<WholeEntry>(generator),
        Kind::Published => keys::<PublishedEntry>(generator),
        Kind::Exact => keys::<ExactEntry>(generator),
    });
    let name = json!({ "type": "string", "description": "A name for tables and files, unlike that of any other fit." });
    let groups = "The spring groups of the elements; all that are not optional if absent.";
    properties.insert("name".into(), name);
    properties.insert("objective".into(), json!({ "enum": kind.objectives() }));
    let springs = json!({ "type": "array", "items": { "type": "string" }, "description": groups });
    properties.insert("springs".into(), springs);
    json!({
        "title": kind.name(),
        "type": "object",
        "properties": properties,
        "required": ["objective"],
        "additionalProperties": false,
    })
}

/// The properties of the keys that a kind has.
fn keys<T: JsonSchema>(generator: &mut SchemaGenerator) -> Map<String, Value> {
    match T::json_schema(generator).get("properties") {
        Some(Value::Object(properties)) => properties.clone(),
        _ => Map::new(),
    }
}
