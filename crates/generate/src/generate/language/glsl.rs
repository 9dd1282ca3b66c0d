//! GLSL from 4.3 on, and of OpenGL ES from 3.1 on, in single precision.

use super::c::{C, end};
use super::syntax::{Arguments, Syntax};
use crate::generate::code::{Array, Function, Result};
use crate::symbolic;

/// GLSL.
#[derive(Debug)]
pub struct Glsl;

impl Syntax for Glsl {
    fn is_single(&self) -> bool {
        true
    }

    fn entry(&self, array: &Array, name: &str, at: &str) -> String {
        C.entry(array, name, at)
    }

    fn equal(&self, a: &str, b: &str) -> String {
        C.equal(a, b)
    }

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        let name = if function == symbolic::Function::Ln { "log" } else { function.name() };
        format!("{name}({argument})")
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        C.select(greater, than, yes, no)
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("float {name} = {value};")
    }

    fn store(&self, entry: &str, value: &str) -> String {
        C.store(entry, value)
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("float {name}[{length}];")
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = if is_integer { "int" } else { "float" };
        let lines = entries.iter().map(|line| format!("    {line}"));
        let first = format!("const {kind} {name}[{length}] = {kind}[{length}](");
        std::iter::once(first).chain(lines).chain([");".into()]).collect()
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        C.repeat(variable, from, to)
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        C.guard(greater, than, status)
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let arguments = lists.list(
            |array| format!("in float {}[{}]", array.name, array.length),
            |name| format!("float {name}"),
            |array| format!("inout float {}[{}]", array.name, array.length),
        );
        let result = match function.result {
            Result::Status => "int",
            Result::Value(_) => "float",
            Result::Nothing => "void",
        };
        vec![format!("{result} {}({arguments}) {{", function.name)]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value)
    }
}
