//! The settings of a fit in a report.

use super::exact::ExactRecord;
use super::published::PublishedRecord;
use super::sampled::SampledRecord;
use super::stiffness::StiffnessRecord;
use super::whole::WholeRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of a fit by its kind, which the key `objective` determines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum KindRecord {
    /// A sampled fit.
    Sampled(Box<SampledRecord>),
    /// A whole-object fit.
    Whole(Box<WholeRecord>),
    /// A published method.
    Published(PublishedRecord),
    /// An exact network.
    Exact(ExactRecord),
    /// A fit to the stiffness at rest.
    Stiffness(StiffnessRecord),
}
