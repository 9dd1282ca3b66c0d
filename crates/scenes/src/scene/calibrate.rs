//! The `[calibrate]` of a scene: which moduli are found from its measurements.

use crate::calibration::{Asked, Prior};
use crate::choice::choice;
use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::Deserialize;

/// Refinements at most: each has up to eight times as many cells as the mesh before it.
const MOST: usize = 3;

/// `[calibrate]`: what `springfit calibrate` finds.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CalibrateEntry {
    /// Young's modulus of each entry of `[[material]]` is found (`young`), with Poisson's ratio (`moduli`), or that of each cell of the mesh
    /// (`cells`). The values of the scene are the first guess, and what is not found keeps them.
    #[schemars(extend("enum" = Asked::NAMES, "default" = "young"))]
    pub unknowns: Option<String>,
    /// These regions keep the moduli of the scene: names of entries of `[[material]]`.
    #[schemars(extend("x-default" = "none"))]
    pub known: Option<Vec<String>>,
    /// These loads are used: names of loads with measurements.
    #[schemars(extend("x-default" = "all with measurements"))]
    pub loads: Option<Vec<String>>,
    /// Where `unknowns` is `cells`, the field is constant but for jumps (`edges`), or smooth.
    #[schemars(extend("enum" = Prior::NAMES, "default" = Prior::default().name()))]
    pub prior: Option<String>,
    /// The edges of the mesh are halved this number of times, from 0 to 3, to find and to take away the error of the mesh. With 0 intervals are
    /// those by noise alone.
    #[schemars(extend("x-default" = "2, or fewer where they would take long"))]
    pub refinements: Option<usize>,
}

/// What is found of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationRecipe {
    /// The unknowns.
    pub asked: Asked,
    /// The regions whose moduli are known.
    pub known: Vec<String>,
    /// The loads that are used; `None` for all with measurements.
    pub loads: Option<Vec<String>>,
    /// What a field is like.
    pub prior: Prior,
    /// How often the mesh is refined; `None` for as often as takes minutes at most.
    pub refinements: Option<usize>,
}

impl CalibrateEntry {
    /// # Errors
    /// A word is unknown, or a number out of its range.
    pub fn check(self) -> Result<CalibrationRecipe> {
        let asked = choice("unknowns", self.unknowns.as_deref(), Asked::Young, Asked::named)?;
        if self.prior.is_some() && asked != Asked::Cells {
            return Err(Error::at("prior", "belongs to unknowns = \"cells\""));
        }
        if self.known.is_some() && asked == Asked::Cells {
            return Err(Error::at("known", "belongs to unknowns of regions, found unknowns = \"cells\""));
        }
        let prior = choice("prior", self.prior.as_deref(), Prior::default(), Prior::named)?;
        if let Some(found) = self.refinements.filter(|count| *count > MOST) {
            return Err(Error::expected("refinements", format!("a number from 0 to {MOST}"), found));
        }
        if self.loads.as_ref().is_some_and(Vec::is_empty) {
            return Err(Error::expected("loads", "names of loads with measurements", "none"));
        }
        let known = self.known.unwrap_or_default();
        Ok(CalibrationRecipe { asked, known, loads: self.loads, prior, refinements: self.refinements })
    }
}
