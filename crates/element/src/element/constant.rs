//! A number in an element file: `1`, `0.5`, or a text such as `"1/3"` or `"sqrt(3)/3"`.

use crate::symbolic::{Expr, Scope};
use num_rational::BigRational;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, Visitor};
use std::borrow::Cow;
use std::fmt;

#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    expr: Expr,
    value: f64,
}

impl Constant {
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The exact value, if it is rational.
    pub fn exact(&self) -> Option<BigRational> {
        self.expr.value(&[])
    }

    fn parse(text: &str) -> Result<Constant, String> {
        let expr = Scope::default().expression(text).map_err(|e| e.problem().to_string())?;
        let value = expr.evaluate(&[]);
        if value.is_finite() {
            Ok(Constant { expr, value })
        } else {
            Err(format!("expected a finite number, found \"{text}\""))
        }
    }
}

impl JsonSchema for Constant {
    fn schema_name() -> Cow<'static, str> {
        "Constant".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let description = "A number, or a constant expression such as \"sqrt(3)/3\".";
        json_schema!({ "type": ["number", "string"], "x-type": "number or expression", "description": description })
    }
}

impl<'de> Deserialize<'de> for Constant {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Constant, D::Error> {
        struct ConstantVisitor;
        impl Visitor<'_> for ConstantVisitor {
            type Value = Constant;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or a text such as \"1/3\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> Result<Constant, E> {
                Ok(Constant { expr: Expr::integer(v), value: v as f64 })
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> Result<Constant, E> {
                if !v.is_finite() {
                    return Err(E::custom(format!("expected a finite number, found {}", v.to_string().to_lowercase())));
                }
                // The text of a double is the shortest decimal that is read as the same double. Parsed as an expression
                // it is that decimal: 0.1 is the rational number 1/10 then, and proofs with it are exact.
                if v < 0.0 { self.visit_str(&format!("-({})", -v)) } else { self.visit_str(&v.to_string()) }
            }
            fn visit_str<E: de::Error>(self, v: &str) -> Result<Constant, E> {
                Constant::parse(v).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(ConstantVisitor)
    }
}
