//! The keys of a `[[fit]]` by a published method.

use serde::Deserialize;

/// The keys: none of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedEntry {}
