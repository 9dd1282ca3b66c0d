//! The settings of a fit, as a report has them.

use super::exact::ExactRecord;
use super::published::PublishedRecord;
use super::sampled::SampledRecord;
use super::stiffness::StiffnessRecord;
use super::whole::WholeRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of a fit by its kind; the key `objective` tells which.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum KindRecord {
    Sampled(Box<SampledRecord>),
    Whole(Box<WholeRecord>),
    Published(PublishedRecord),
    Exact(ExactRecord),
    Stiffness(StiffnessRecord),
}
