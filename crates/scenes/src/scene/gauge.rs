//! The `[gauge]` of a scene: where the strain of a specimen is measured.

use super::part::Part;
use super::value;
use crate::error::{Error, Result};
use crate::range;
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GaugeEntry {
    /// The straight part is this group of the mesh; one of `group` and `where` is required.
    pub group: Option<String>,
    /// The straight part has the points that satisfy this condition on x, y, z in m; one of `group` and `where` is required.
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// The part is pulled in this direction.
    #[schemars(extend("enum" = ["x", "y", "z"]))]
    pub axis: String,
    /// The straight part has this cross-section in m², above 0.
    #[serde(deserialize_with = "value::area")]
    #[schemars(schema_with = "value::area_schema")]
    pub area: f64,
}

/// A straight part of the body, the direction in which it is pulled, and its cross-section.
#[derive(Debug, Clone, PartialEq)]
pub struct Gauge {
    pub part: Part,
    pub axis: usize,
    /// The cross-section, m².
    pub area: f64,
}

impl GaugeEntry {
    /// The gauge of these keys.
    ///
    /// # Errors
    /// The part is missing or given twice, the axis is unknown, or the cross-section is not positive.
    pub fn check(self) -> Result<Gauge> {
        let part = Part::required(self.group, self.condition)?;
        let axis = ["x", "y", "z"].iter().position(|name| *name == self.axis);
        let axis =
            axis.ok_or_else(|| Error::expected("axis", "\"x\", \"y\" or \"z\"", format!("\"{}\"", self.axis)))?;
        Ok(Gauge { part, axis, area: range::positive("area", self.area, "m²")? })
    }
}
