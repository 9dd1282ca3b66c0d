//! WGSL, in single precision.

use super::syntax::{Arguments, Syntax, has_status};
use crate::generate::code::{Array, Function, Result, Role};
use crate::symbolic;

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

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        let name = if function == symbolic::Function::Ln { "log" } else { function.name() };
        format!("{name}({argument})")
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("select({no}, {yes}, {greater} > {than})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("let {name}: f32 = {value};")
    }

    fn store(&self, entry: &str, value: &str) -> String {
        format!("{entry} = {value};")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("var {name}: array<f32, {length}>;")
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = format!("array<{}, {length}>", if is_integer { "u32" } else { "f32" });
        let lines = entries.iter().map(|line| format!("    {line}"));
        std::iter::once(format!("var<private> {name}: {kind} = {kind}(")).chain(lines).chain([");".into()]).collect()
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
        let result = match value {
            Some(value) => Some(format!("    return {value};")),
            None => has_status(function).then(|| "    return 0u;".into()),
        };
        result.into_iter().chain(["}".into()]).collect()
    }
}
