//! The `[material.relaxation]` of a scene.

use super::value;
use crate::error::Result;
use crate::material::{Relaxation, RelaxationTerm};
use schemars::JsonSchema;
use serde::Deserialize;

/// How the moduli of a material relax.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelaxationEntry {
    /// The moduli relax in these terms of a Prony series, one or more. Of each modulus the shares add up to at most 1.
    terms: Vec<TermEntry>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TermEntry {
    /// This share of the shear modulus relaxes, from 0 to 1. A term has `shear` or `bulk` above 0.
    #[serde(default)]
    shear: f64,
    /// This share of the bulk modulus relaxes, from 0 to 1. With a law it is 0.
    #[serde(default)]
    bulk: f64,
    /// The term has this relaxation time in s, above 0.
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::time_schema")]
    time: f64,
}

impl RelaxationEntry {
    /// The Prony series of the key `relaxation`.
    ///
    /// # Errors
    /// A share or a time is out of its range.
    pub fn check(&self) -> Result<Relaxation> {
        self.series().map_err(|e| e.under("relaxation"))
    }

    fn series(&self) -> Result<Relaxation> {
        let term = |term: &TermEntry| RelaxationTerm { shear: term.shear, bulk: term.bulk, time: term.time };
        Relaxation::new(self.terms.iter().map(term).collect())
    }
}
