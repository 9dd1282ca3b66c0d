//! JSON objects whose keys are listed where they are written, without a structure of their own.

use serde::{Serialize, Serializer};
use serde_json::Value;

/// Keys with their values, in this order; those of a [`Value`] are sorted.
#[derive(Debug, Clone, PartialEq)]
pub struct Object(pub Vec<(&'static str, Value)>);

impl Serialize for Object {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}
