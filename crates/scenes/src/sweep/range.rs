//! Values of one key: a list, or a range.

use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::keys::keys;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::{Table, Value};

/// The keys of a range. They are read one by one, for errors that name them.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "range")]
#[allow(dead_code)]
pub struct RangeEntry {
    /// The values begin at this number, or at this text with a unit.
    #[schemars(with = "serde_json::Value", extend("x-type" = "number or text"))]
    from: Value,
    /// The values end at this number, or at this text with the unit of `from`.
    #[schemars(with = "serde_json::Value", extend("x-type" = "number or text"))]
    to: Value,
    /// The range has this number of values with both ends, 1 or more. A range of a random or Sobol design has none.
    #[schemars(extend("x-default" = "required in a grid without `step`"))]
    count: Option<usize>,
    /// The values go from the first end on by this step, in place of `count`. They are whole numbers where ends and step are.
    step: Option<f64>,
    /// The values have equal differences (`linear`), or equal ratios (`log`) with ends above 0.
    #[schemars(extend("enum" = ["linear", "log"], "default" = "linear"))]
    spacing: Option<String>,
}

/// The values that a key takes.
#[derive(Debug, Clone)]
pub enum Values {
    List(Vec<Value>),
    Range(Range),
}

/// Every number between two, with a unit if both have it.
#[derive(Debug, Clone)]
pub struct Range {
    from: f64,
    to: f64,
    unit: Option<String>,
    is_logarithmic: bool,
    /// Where only evenly spaced ones are taken.
    pub count: Option<usize>,
}

impl Values {
    /// Whether a table is a range, and not keys of a scene that lie deeper.
    pub fn is_range(table: &Table) -> bool {
        keys::<RangeEntry>().iter().any(|key| table.get(*key).is_some_and(|value| !value.is_table()))
    }

    /// # Errors
    /// The value is no list, or a range has a key that is unknown, missing or of the wrong type.
    pub fn read(key: &str, value: &Value) -> Result<Values> {
        match value {
            Value::Array(list) if list.is_empty() => Err(Error::expected(key, "a list of at least one value", "none")),
            Value::Array(list) => Ok(Values::List(list.clone())),
            Value::Table(table) => range(table).map_err(|e| e.under(key)),
            other => {
                let expected = "a list of values, or a range such as { from = 0.1, to = 0.4, count = 4 }";
                Err(Error::expected(key, expected, format!("a value of type {}", other.type_str())))
            }
        }
    }

    /// All values in their order; `None` of a range that has no number of them.
    pub fn all(&self) -> Option<Vec<Value>> {
        match self {
            Values::List(list) => Some(list.clone()),
            Values::Range(range) => {
                let count = range.count?;
                let share = |i: usize| if count == 1 { 0.0 } else { i as f64 / (count - 1) as f64 };
                Some((0..count).map(|i| range.at(share(i))).collect())
            }
        }
    }

    /// The value at a share from 0 to below 1 of all.
    pub fn at(&self, share: f64) -> Value {
        match self {
            // A share just below 1 may be rounded up to the length.
            Values::List(list) => list[((share * list.len() as f64) as usize).min(list.len() - 1)].clone(),
            Values::Range(range) => range.at(share),
        }
    }
}

impl Range {
    fn at(&self, share: f64) -> Value {
        // The ends are as they were given.
        let value = match share {
            0.0 => self.from,
            1.0 => self.to,
            _ if self.is_logarithmic => self.from * (self.to / self.from).powf(share),
            _ => self.from * (1.0 - share) + self.to * share,
        };
        match &self.unit {
            Some(unit) => Value::String(format!("{value} {unit}")),
            None => Value::Float(value),
        }
    }
}

fn range(table: &Table) -> Result<Values> {
    let known = keys::<RangeEntry>();
    if let Some(unknown) = table.keys().find(|key| !known.contains(&key.as_str())) {
        let known: Vec<String> = known.iter().map(|key| format!("\"{key}\"")).collect();
        let problem = format!("unknown field \"{unknown}\", expected one of {}", known.join(", "));
        return Err(Error::at(unknown, problem));
    }
    let required = |key: &str| {
        let value = table.get(key).ok_or_else(|| Error::expected(key, "a number, for a range has two ends", "none"))?;
        number(key, value)
    };
    let ((from, unit), (to, other)) = (required("from")?, required("to")?);
    if unit != other {
        let named = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "none".into());
        return Err(Error::expected("to", format!("the unit of \"from\": {}", named(&unit)), named(&other)));
    }
    if let Some(step) = table.get("step") {
        if let Some(other) = ["count", "spacing"].iter().find(|key| table.contains_key(**key)) {
            return Err(Error::at(*other, "is not for a range with a \"step\""));
        }
        return stepped(table, step, [from, to]);
    }
    let spacing = match table.get("spacing") {
        None => "linear",
        Some(value) => value.as_str().unwrap_or(value.type_str()),
    };
    let is_logarithmic = match spacing {
        "linear" => false,
        "log" => true,
        other => return Err(Error::expected("spacing", "\"linear\" or \"log\"", format!("\"{other}\""))),
    };
    if is_logarithmic && !(from > 0.0 && to > 0.0) {
        return Err(Error::expected("spacing", "\"linear\", or ends above 0 for \"log\"", format!("{from} and {to}")));
    }
    let count = match table.get("count") {
        None => None,
        Some(Value::Integer(count)) => {
            let count = u64::try_from(*count).unwrap_or(0);
            check_count("count", count, 1, bound::STUDIES)?;
            Some(count as usize)
        }
        Some(other) => {
            return Err(Error::expected("count", "a whole number", format!("a value of type {}", other.type_str())));
        }
    };
    Ok(Values::Range(Range { from, to, unit, is_logarithmic, count }))
}

/// From the first end by steps as far as the other; whole numbers where all three are.
fn stepped(table: &Table, step: &Value, [from, to]: [f64; 2]) -> Result<Values> {
    let (size, unit) = number("step", step)?;
    if unit.is_some() || !(size != 0.0 && (to - from) / size >= 0.0) {
        return Err(Error::expected("step", "a number that leads from \"from\" to \"to\"", format!("{size}")));
    }
    // The last one is reached in spite of rounding.
    // Both ends may be far from zero beside the step: their rounding counts in steps.
    let steps = (to - from) / size;
    let count = (steps + 4.0 * f64::EPSILON * (steps + (from.abs() + to.abs()) / size.abs())).floor() + 1.0;
    if count > bound::STUDIES as f64 {
        return Err(Error::expected("step", format!("at most {} values", bound::STUDIES), count));
    }
    let whole = |key: &str| table.get(key).and_then(Value::as_integer);
    if let (Some(from), Some(_), Some(step)) = (whole("from"), whole("to"), step.as_integer()) {
        return Ok(Values::List((0..count as i64).map(|i| Value::Integer(from + i * step)).collect()));
    }
    let unit = number("from", &table["from"])?.1;
    let value = |i: usize| {
        let value = from + i as f64 * size;
        unit.as_ref().map_or(Value::Float(value), |unit| Value::String(format!("{value} {unit}")))
    };
    Ok(Values::List((0..count as usize).map(value).collect()))
}

/// A finite number, and its unit where it is a text such as `10 kPa`.
fn number(key: &str, value: &Value) -> Result<(f64, Option<String>)> {
    let fault = |found: String| Error::expected(key, "a finite number, or a text such as \"10 kPa\"", found);
    let found = match value {
        Value::Integer(number) => Some((*number as f64, None)),
        Value::Float(number) => Some((*number, None)),
        Value::String(text) => {
            // The longest beginning that is a number.
            let text = text.trim();
            let ends = text.char_indices().map(|(i, c)| i + c.len_utf8()).rev();
            let mut split = ends.filter_map(|end| Some((text[..end].trim().parse().ok()?, text[end..].trim())));
            split.next().map(|(number, unit)| (number, Some(unit.to_string()).filter(|unit| !unit.is_empty())))
        }
        Value::Boolean(_) | Value::Datetime(_) | Value::Array(_) | Value::Table(_) => None,
    };
    match found {
        Some((number, unit)) if number.is_finite() => Ok((number, unit)),
        Some((number, _)) => Err(fault(number.to_string())),
        None => Err(fault(
            value.as_str().map_or_else(|| format!("a value of type {}", value.type_str()), |t| format!("\"{t}\"")),
        )),
    }
}
