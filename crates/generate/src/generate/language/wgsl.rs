//! WGSL, in single precision.

use super::syntax::{Arguments, Syntax, between, end};
use crate::generate::code::{Array, Function, Result, Role};

/// WGSL.
#[derive(Debug)]
pub struct Wgsl;

impl Syntax for Wgsl {
    fn is_single(&self) -> bool {
        true
    }

    fn integer(&self, integer: isize) -> String {
        format!("{integer}u")
    }

    fn entry(&self, array: &Array, name: &str, at: &str) -> String {
        match array.role {
            Role::Input | Role::Output => format!("(*{name})[{at}]"),
            Role::Work | Role::Table(_) | Role::Integers(_) => format!("{name}[{at}]"),
        }
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("select(0.0, 1.0, {a} == {b})")
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("select({no}, {yes}, {greater} > {than})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("let {name}: f32 = {value};")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("var {name}: array<f32, {length}>;")
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = format!("array<{}, {length}>", if is_integer { "u32" } else { "f32" });
        between(format!("var<private> {name}: {kind} = {kind}("), entries, ");")
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        let first = format!("for (var {variable}: u32 = {from}; {variable} < {to}; {variable}++) {{");
        [Some(first), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if (!({greater} > {than})) {{ return {status}u; }}")]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let pointer = |array: &Array| format!("{}: ptr<function, array<f32, {}>>", array.name, array.length);
        let arguments = lists.list(pointer, |name| format!("{name}: f32"), pointer);
        let result = match function.result {
            Result::Status => " -> u32",
            Result::Value(_) => " -> f32",
            Result::Nothing => "",
        };
        vec![format!("fn {}({arguments}){result} {{", function.name)]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value.map(|value| format!("return {value};")), "return 0u;")
    }
}
