//! The record of a published method in a report.

use crate::fit::published::Method;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method, and where it is published.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "(published)")]
pub struct PublishedRecord {
    /// The objective is the name of a published formula.
    pub objective: String,
    /// The formula is published there.
    pub source: String,
}

impl PublishedRecord {
    pub(super) fn of(method: Method) -> PublishedRecord {
        PublishedRecord { objective: method.name().into(), source: method.reference().into() }
    }
}
