//! A number in an element file: `1`, `0.5`, or a text such as `"1/3"` or `"sqrt(3)/3"`.

use crate::file::PlainForms;
use crate::symbolic::{Expr, Scope, parse_rational};
use num_rational::BigRational;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer};
use std::borrow::Cow;

#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    value: f64,
    /// The expression, where the file has no number.
    expr: Option<Expr>,
}

impl Constant {
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The exact value, if it is rational. A double stands for the shortest decimal that is read as it: 0.1 is the rational number 1/10, and
    /// proofs with it are exact.
    pub fn exact(&self) -> Option<BigRational> {
        match &self.expr {
            Some(expr) => expr.value(&[]),
            None => parse_rational(&self.value.to_string()).ok(),
        }
    }

    fn parse(text: &str) -> Result<Constant, String> {
        let expr = Scope::default().expression(text).map_err(|e| e.problem().to_string())?;
        let value = expr.evaluate(&[]);
        let constant = Constant { value, expr: Some(expr) };
        value.is_finite().then_some(constant).ok_or_else(|| format!("expected a finite number, found \"{text}\""))
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
        deserializer.deserialize_any(PlainForms {
            // The sum makes zero of negative zero.
            number: Some(|value| value.is_finite().then_some(Constant { value: value + 0.0, expr: None })),
            text: Some(&|text| Constant::parse(text).map_err(Some)),
            ..PlainForms::expecting("a finite number or a text such as \"1/3\"")
        })
    }
}
