//! C, from the standard of 1999 on, and C++.

use super::syntax::{Arguments, Syntax, has_status};
use crate::generate::code::{Array, Function, Result};

/// C.
#[derive(Debug)]
pub struct C;

impl Syntax for C {
    fn file(&self, prefix: &str) -> [Vec<String>; 2] {
        let guard = format!("{}_H", prefix.to_uppercase());
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
        braced(format!("static const {} {name}[{length}] = {{", if is_integer { "int" } else { "double" }), entries)
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [Some(format!("for (int {variable} = {from}; {variable} < {to}; ++{variable}) {{")), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if (!({greater} > {than})) return {status};")]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        vec![format!("static inline {} {{", signature(function, lists))]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value)
    }
}

/// The type, the name and the arguments of a function.
pub fn signature(function: &Function, lists: &Arguments) -> String {
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
pub fn braced(first: String, entries: &[String]) -> Vec<String> {
    let lines = entries.iter().map(|line| format!("    {line}"));
    std::iter::once(first).chain(lines).chain(["};".into()]).collect()
}
