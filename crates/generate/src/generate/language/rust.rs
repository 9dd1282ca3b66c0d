//! Rust, without dependencies.

use super::syntax::{Arguments, Syntax, between, end};
use crate::generate::code::{Function, Result};
use crate::symbolic;

/// Rust.
#[derive(Debug)]
pub struct Rust;

impl Syntax for Rust {
    fn equal(&self, a: &str, b: &str) -> String {
        format!("(if {a} == {b} {{ 1.0 }} else {{ 0.0 }})")
    }

    fn root(&self, argument: &str) -> String {
        format!("f64::sqrt({argument})")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("f64::powf({base}, {exponent})")
    }

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        format!("f64::{}({argument})", function.name())
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("(if {greater} > {than} {{ {yes} }} else {{ {no} }})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("let {name} = {value};")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("let mut {name} = [0.0f64; {length}];")
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = if is_integer { "usize" } else { "f64" };
        between(format!("static {name}: [{kind}; {length}] = ["), entries, "];")
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [Some(format!("for {variable} in {from}..{to} {{")), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if !({greater} > {than}) {{"), format!("    return Err({status});"), "}".into()]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let arguments = lists.list(
            |array| format!("{}: &[f64; {}]", array.name, array.length),
            |name| format!("{name}: f64"),
            |array| format!("{}: &mut [f64; {}]", array.name, array.length),
        );
        let result = match function.result {
            Result::Status => " -> Result<(), u32>",
            Result::Value(_) => " -> f64",
            Result::Nothing => "",
        };
        let allow = "#[allow(unused_parens, clippy::all, clippy::pedantic)]".to_string();
        vec![allow, format!("pub fn {}({arguments}){result} {{", function.name)]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value.map(String::from), "Ok(())")
    }
}
