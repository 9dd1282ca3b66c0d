//! C, from the standard of 1999 on, and C++; and CUDA C++, whose functions are for the device, in double precision.

use super::syntax::{Arguments, Syntax, has_status};
use crate::generate::code::{Array, Function, Result};

/// What the dialects of C differ in.
#[derive(Debug)]
pub struct Dialect {
    /// The end of the guard's name.
    guard: &'static str,
    /// What stands before a function.
    function: &'static str,
    /// What stands before the type of a table.
    table: &'static str,
}

pub const C: Dialect = Dialect { guard: "H", function: "static inline", table: "static const" };
pub const CUDA: Dialect =
    Dialect { guard: "CUH", function: "static __device__ __forceinline__", table: "static __device__ const" };

impl Syntax for Dialect {
    fn file(&self, prefix: &str) -> [Vec<String>; 2] {
        let guard = format!("{}_{}", prefix.to_uppercase(), self.guard);
        let first = [
            format!("#ifndef {guard}"),
            format!("#define {guard}"),
            String::new(),
            "#include <math.h>".into(),
            String::new(),
        ];
        [first.into(), vec![format!("#endif // {guard}")]]
    }

    fn entry(&self, _: &Array, name: &str, at: &str) -> String {
        format!("{name}[{at}]")
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("({a} == {b} ? 1.0 : 0.0)")
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("({greater} > {than} ? {yes} : {no})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("const double {name} = {value};")
    }

    fn store(&self, entry: &str, value: &str) -> String {
        format!("{entry} = {value};")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("double {name}[{length}];")
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = if is_integer { "int" } else { "double" };
        braced(format!("{} {kind} {name}[{length}] = {{", self.table), entries)
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [Some(format!("for (int {variable} = {from}; {variable} < {to}; ++{variable}) {{")), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if (!({greater} > {than})) return {status};")]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        vec![format!("{} {} {{", self.function, signature(function, lists))]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value)
    }
}

/// The type, the name and the arguments of a function.
fn signature(function: &Function, lists: &Arguments) -> String {
    let arguments = lists.list(
        |array| format!("const double {}[{}]", array.name, array.length),
        |name| format!("double {name}"),
        |array| format!("double {}[{}]", array.name, array.length),
    );
    let result = match function.result {
        Result::Status => "int",
        Result::Value(_) => "double",
        Result::Nothing => "void",
    };
    format!("{result} {}({arguments})", function.name)
}

/// The end of a function.
pub fn end(function: &Function, value: Option<&str>) -> Vec<String> {
    let result = match value {
        Some(value) => Some(format!("    return {value};")),
        None => has_status(function).then(|| "    return 0;".into()),
    };
    result.into_iter().chain(["}".into()]).collect()
}

/// A table in braces.
fn braced(first: String, entries: &[String]) -> Vec<String> {
    let lines = entries.iter().map(|line| format!("    {line}"));
    std::iter::once(first).chain(lines).chain(["};".into()]).collect()
}
