//! Arrays in the record of a page: their bytes in base64, which a script reads without parsing numbers.

use base64::prelude::{BASE64_STANDARD, Engine};
use serde::{Serialize, Serializer};

/// Numbers with seven digits, which a picture needs: little-endian, 32 bits each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Floats(pub Vec<f32>);

/// Places: little-endian, 32 bits each.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Places(pub Vec<u32>);

impl Serialize for Floats {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&text(self.0.iter().map(|value| value.to_le_bytes())))
    }
}

impl Serialize for Places {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&text(self.0.iter().map(|value| value.to_le_bytes())))
    }
}

fn text(values: impl Iterator<Item = [u8; 4]>) -> String {
    BASE64_STANDARD.encode(values.flatten().collect::<Vec<u8>>())
}

impl FromIterator<f64> for Floats {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Floats {
        Floats(values.into_iter().map(|value| value as f32).collect())
    }
}

impl FromIterator<usize> for Places {
    /// A place that does not fit is the largest.
    fn from_iter<I: IntoIterator<Item = usize>>(values: I) -> Places {
        Places(values.into_iter().map(|value| u32::try_from(value).unwrap_or(u32::MAX)).collect())
    }
}
