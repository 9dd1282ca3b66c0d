//! The keys of a `[[fit]]` by a published method.

use schemars::JsonSchema;
use serde::Deserialize;

/// The keys: none of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PublishedEntry {}
