//! The JSON Schema of a `[[fit]]`: one alternative for each kind, which its objective tells.

use super::engine::EngineEntry;
use super::entry::{COMMON, FitEntry, Kind};
use super::exact::ExactEntry;
use super::published::PublishedEntry;
use super::sampled::SampledEntry;
use super::stiffness::StiffnessEntry;
use super::whole::WholeEntry;
use crate::element::GROUP_CHOICES;
use crate::engine::Engine;
use crate::model::BendingSprings;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema, schema_for};
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

/// The JSON Schema of fits alone.
pub fn fit_schema() -> Value {
    schema_for!(FitEntry).to_value()
}

fn alternative(kind: Kind, generator: &mut SchemaGenerator) -> Value {
    let mut properties = Map::new();
    if kind == Kind::Whole {
        // It may start from a sampled fit.
        properties.extend(keys::<SampledEntry>(generator));
        properties.remove("tied");
        properties.remove("data");
        properties.values_mut().for_each(|key| key["x-of"] = Kind::Sampled.name().into());
    }
    properties.extend(match kind {
        Kind::Stiffness => keys::<StiffnessEntry>(generator),
        Kind::Sampled => keys::<SampledEntry>(generator),
        Kind::Whole => keys::<WholeEntry>(generator),
        Kind::Published => keys::<PublishedEntry>(generator),
        Kind::Exact => keys::<ExactEntry>(generator),
    });
    properties.extend(common(kind, generator));
    json!({
        "title": kind.name(),
        "type": "object",
        "properties": properties,
        "required": ["objective"],
        "additionalProperties": false,
    })
}

/// The keys that all fits have.
fn common(kind: Kind, generator: &mut SchemaGenerator) -> [(String, Value); COMMON.len()] {
    let [name, objective, springs, engine, bending] = COMMON.map(String::from);
    let names = json!({
        "type": "string",
        "description": "Tables and files call the fit by this name. No two fits have the same name, and no fit is called `finite elements`.",
        "x-default": "made from the settings",
    });
    let objectives = json!({
        "type": "string",
        "enum": kind.objectives(),
        "description": "The objective says what the springs are fitted to, and by it which other keys the fit has.",
    });
    let groups = json!({
        "anyOf": [{ "type": "array", "items": { "type": "string" } }, { "type": "string", "enum": GROUP_CHOICES }],
        "x-type": "list of texts, or a word",
        "description": "The network has the springs of these groups of the element. A word in place of the list stands for groups of any \
                        element: those that are not optional (`default`), all between two points (`all`), or all with those on areas \
                        and volumes (`all + volume`).",
        "x-default": "all that are not optional",
    });
    let table = generator.subschema_for::<EngineEntry>().to_value();
    let mut settings = json!({ "anyOf": [table, { "type": "string", "enum": Engine::NAMES }] });
    settings["description"] = "The constants are for an engine that ends its sweeps early: at these settings the network answers like the \
                               body. A whole-object fit finds its constants so; others are multiplied by one factor for springs on lengths \
                               and one for those on contents. It needs a density. A name alone stands for the settings that the engine has by default."
        .into();
    let sheets = json!({
        "type": "string",
        "enum": BendingSprings::NAMES,
        "description": "A sheet or rods, whose material has bending = \"plate\" or \"rod\", resist bending by these springs. `directors` are the plate at any Poisson's ratio, and the beam. `hinges` \
                        are springs on the angles between triangles, which other programs hold; Poisson's ratio of their bending is near −1/3 whatever that of \
                        the material is. Of rods they are springs on single angles between rods and directors, of second order, where the rods of each joint are in line to 30 degrees.",
        "x-type": "`\"directors\"`, `\"hinges\"`",
        "x-default": "`\"directors\"` of what bends",
    });
    [(name, names), (objective, objectives), (springs, groups), (engine, settings), (bending, sheets)]
}

/// The properties of the keys that a kind has.
fn keys<T: JsonSchema>(generator: &mut SchemaGenerator) -> Map<String, Value> {
    match T::json_schema(generator).get("properties") {
        Some(Value::Object(properties)) => properties.clone(),
        _ => Map::new(),
    }
}
