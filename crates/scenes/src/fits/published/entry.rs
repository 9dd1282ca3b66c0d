//! The keys of a `[[fit]]` by a published method.

use schemars::JsonSchema;
use serde::Deserialize;

/// There are no keys besides those of all fits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PublishedEntry {}
