//! C, from the standard of 1999 on, and C++; CUDA C++, whose functions are for the device; both in double precision; and GLSL from 4.3 on,
//! and of OpenGL ES from 3.1 on, in single precision.

use super::syntax::{Arguments, Syntax, between, end};
use crate::generate::code::{Function, Result};

/// What the dialects of C differ in.
#[derive(Debug)]
pub struct Dialect {
    /// The end of the guard's name, of a file that is included.
    guard: Option<&'static str>,
    /// What stands before a function.
    function: &'static str,
    /// What stands before the type of a table.
    table: &'static str,
    /// The type of numbers.
    number: &'static str,
    /// The types of a value, of an array that is read and of one that is written.
    types: [&'static str; 3],
}

pub const C: Dialect = Dialect {
    guard: Some("H"),
    function: "static inline ",
    table: "static const",
    number: "double",
    types: ["const double", "const double", "double"],
};
pub const CUDA: Dialect = Dialect {
    guard: Some("CUH"),
    function: "static __device__ __forceinline__ ",
    table: "static __device__ const",
    ..C
};
pub const GLSL: Dialect =
    Dialect { guard: None, function: "", table: "const", number: "float", types: ["float", "in float", "inout float"] };

impl Syntax for Dialect {
    fn file(&self, prefix: &str) -> [Vec<String>; 2] {
        let Some(end) = self.guard else { return [Vec::new(), Vec::new()] };
        let guard = format!("{}_{end}", prefix.to_uppercase());
        let first = [
            format!("#ifndef {guard}"),
            format!("#define {guard}"),
            String::new(),
            "#include <math.h>".into(),
            String::new(),
        ];
        [first.into(), vec![format!("#endif // {guard}")]]
    }

    fn is_single(&self) -> bool {
        // GLSL is the only dialect in single precision, and the only one without the header of C: it has its functions from the language.
        self.number == "float"
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("({a} == {b} ? 1.0 : 0.0)")
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("({greater} > {than} ? {yes} : {no})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("{} {name} = {value};", self.types[0])
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("{} {name}[{length}];", self.number)
    }

    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String> {
        let kind = if is_integer { "int" } else { self.number };
        let first = format!("{} {kind} {name}[{length}] = ", self.table);
        match self.is_single() {
            true => between(format!("{first}{kind}[{length}]("), entries, ");"),
            false => between(format!("{first}{{"), entries, "};"),
        }
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [Some(format!("for (int {variable} = {from}; {variable} < {to}; ++{variable}) {{")), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if (!({greater} > {than})) return {status};")]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let [_, input, output] = self.types;
        let arguments = lists.list(
            |array| format!("{input} {}[{}]", array.name, array.length),
            |name| format!("{} {name}", self.number),
            |array| format!("{output} {}[{}]", array.name, array.length),
        );
        let result = match function.result {
            Result::Status => "int",
            Result::Value(_) => self.number,
            Result::Nothing => "void",
        };
        vec![format!("{}{result} {}({arguments}) {{", self.function, function.name)]
    }

    fn close(&self, function: &Function, _: &Arguments, value: Option<&str>) -> Vec<String> {
        end(function, value.map(|value| format!("return {value};")), "return 0;")
    }
}
