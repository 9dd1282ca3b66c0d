//! Numbers of a scene that may be written in more than one way.

use crate::material::parse_pressure;
use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};
use std::fmt;

/// One direction of a load: a number, or an expression of x, y, z in m.
#[derive(Debug, Clone)]
pub enum Varying {
    Number(f64),
    Text(String),
}

/// One direction of a prescribed displacement: a number of metres, or `"free"`.
#[derive(Debug, Clone, Copy)]
pub struct Given(pub Option<f64>);

/// A number of Pa, or a text with a unit.
#[derive(Debug, Clone, Copy)]
pub struct Pressure(pub f64);

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Given, D::Error> {
        struct GivenVisitor;
        impl Visitor<'_> for GivenVisitor {
            type Value = Given;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a finite number of metres or \"free\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> std::result::Result<Given, E> {
                Ok(Given(Some(v as f64)))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> std::result::Result<Given, E> {
                if v.is_finite() { Ok(Given(Some(v))) } else { Err(E::invalid_value(de::Unexpected::Float(v), &self)) }
            }
            fn visit_str<E: de::Error>(self, v: &str) -> std::result::Result<Given, E> {
                if v == "free" { Ok(Given(None)) } else { Err(E::invalid_value(de::Unexpected::Str(v), &self)) }
            }
        }
        deserializer.deserialize_any(GivenVisitor)
    }
}

impl<'de> Deserialize<'de> for Varying {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Varying, D::Error> {
        struct VaryingVisitor;
        impl Visitor<'_> for VaryingVisitor {
            type Value = Varying;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or an expression of x, y, z such as \"1e5*x\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> std::result::Result<Varying, E> {
                Ok(Varying::Number(v as f64))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> std::result::Result<Varying, E> {
                Ok(Varying::Number(v))
            }
            fn visit_str<E: de::Error>(self, v: &str) -> std::result::Result<Varying, E> {
                Ok(Varying::Text(v.into()))
            }
        }
        deserializer.deserialize_any(VaryingVisitor)
    }
}

impl<'de> Deserialize<'de> for Pressure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Pressure, D::Error> {
        struct PressureVisitor;
        impl Visitor<'_> for PressureVisitor {
            type Value = Pressure;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number of Pa or a text such as \"10kPa\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> std::result::Result<Pressure, E> {
                Ok(Pressure(v as f64))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> std::result::Result<Pressure, E> {
                Ok(Pressure(v))
            }
            fn visit_str<E: de::Error>(self, v: &str) -> std::result::Result<Pressure, E> {
                parse_pressure(v).map(Pressure).map_err(|e| E::custom(e.problem()))
            }
        }
        deserializer.deserialize_any(PressureVisitor)
    }
}
