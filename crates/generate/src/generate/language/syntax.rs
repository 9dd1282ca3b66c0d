//! What differs between languages.

use crate::generate::code::{Array, Function, Result, Role};
use crate::symbolic;
use std::fmt::Debug;

/// The parts of a language. What is the same in all of them is in the printer.
pub trait Syntax: Debug + Sync {
    /// What a line of comment begins with.
    fn comment(&self) -> &'static str {
        "// "
    }

    /// The first line, of a language in which a comment at the top can change how the file is read.
    fn encoding(&self) -> Option<&'static str> {
        None
    }

    /// What one level of a block is indented by.
    fn indent(&self) -> &'static str {
        "    "
    }

    /// Lines before and after the functions.
    fn file(&self, _prefix: &str) -> [Vec<String>; 2] {
        [Vec::new(), Vec::new()]
    }

    /// Whether numbers have single precision.
    fn is_single(&self) -> bool {
        false
    }

    /// A number that is finite and not negative.
    fn number(&self, number: f64) -> String {
        if self.is_single() { format!("{:?}", number.min(f64::from(f32::MAX)) as f32) } else { format!("{number:?}") }
    }

    /// A parameter.
    fn parameter(&self, name: &str) -> String {
        name.into()
    }

    /// The name of a value or the variable of a loop.
    fn variable(&self, letter: char, number: usize) -> String {
        format!("{letter}{number}")
    }

    /// An entry of an array.
    fn entry(&self, _array: &Array, name: &str, at: &str) -> String {
        format!("{name}[{at}]")
    }

    /// An integer.
    fn integer(&self, integer: isize) -> String {
        integer.to_string()
    }

    /// 1 if two integers are equal, otherwise 0.
    fn equal(&self, a: &str, b: &str) -> String;

    /// The square root.
    fn root(&self, argument: &str) -> String {
        format!("sqrt({argument})")
    }

    /// A power.
    fn power(&self, base: &str, exponent: &str) -> String {
        format!("pow({base}, {exponent})")
    }

    /// A function.
    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        // Shaders have one name for the absolute values of all kinds of numbers.
        let is_short = self.is_single() && function == symbolic::Function::Abs;
        format!("{}({argument})", if is_short { "abs" } else { function_of_c(function) })
    }

    /// A choice.
    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String;

    /// A quotient and a product.
    fn quotient(&self, above: &str, below: &str) -> String {
        format!("{above} / {below}")
    }

    /// A product.
    fn product(&self, a: &str, b: &str) -> String {
        format!("{a} * {b}")
    }

    /// Gives a value its name.
    fn define(&self, name: &str, value: &str) -> String;

    /// A step that writes a value.
    fn store(&self, entry: &str, value: &str) -> String {
        format!("{entry} = {value};")
    }

    /// Memory of a function.
    fn memory(&self, name: &str, length: usize) -> String;

    /// A table of numbers or, with `is_integer`, of integers; the entries are lines.
    fn table(&self, name: &str, length: usize, is_integer: bool, entries: &[String]) -> Vec<String>;

    /// The beginning and the end of a loop.
    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2];

    /// A step that ends the function unless `greater > than`.
    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String>;

    /// The beginning of a function.
    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String>;

    /// The end of a function that returns `result`; `value` is the value of an energy.
    fn close(&self, function: &Function, lists: &Arguments, value: Option<&str>) -> Vec<String>;
}

/// The arguments of a function.
#[derive(Debug)]
pub struct Arguments<'a> {
    pub inputs: Vec<&'a Array>,
    pub outputs: Vec<&'a Array>,
    pub parameters: Vec<String>,
}

impl<'a> Arguments<'a> {
    /// The arguments of this function.
    pub fn of(syntax: &dyn Syntax, function: &'a Function) -> Arguments<'a> {
        Arguments {
            inputs: function.arrays_of(&Role::Input).collect(),
            outputs: function.arrays_of(&Role::Output).collect(),
            parameters: function.parameters.iter().map(|name| syntax.parameter(name)).collect(),
        }
    }

    /// The list of arguments: inputs, parameters, outputs.
    pub fn list(
        &self,
        input: impl Fn(&Array) -> String,
        parameter: impl Fn(&str) -> String,
        output: impl Fn(&Array) -> String,
    ) -> String {
        let inputs = self.inputs.iter().map(|array| input(array));
        let parameters = self.parameters.iter().map(|name| parameter(name));
        let outputs = self.outputs.iter().map(|array| output(array));
        inputs.chain(parameters).chain(outputs).collect::<Vec<_>>().join(", ")
    }
}

/// A table whose entries stand between two lines.
pub fn between(first: String, entries: &[String], last: &str) -> Vec<String> {
    let lines = entries.iter().map(|line| format!("    {line}"));
    std::iter::once(first).chain(lines).chain([last.into()]).collect()
}

/// The end of a function in braces, which returns a value or, if it has a status, ends with `done`.
pub fn end(function: &Function, value: Option<String>, done: &str) -> Vec<String> {
    let last = value.or_else(|| (function.result == Result::Status).then(|| done.into()));
    last.map(|line| format!("    {line}")).into_iter().chain(["}".into()]).collect()
}

/// The name of a function in C.
pub fn function_of_c(function: symbolic::Function) -> &'static str {
    use symbolic::Function;
    match function {
        Function::Ln => "log",
        Function::Abs => "fabs",
        other => other.name(),
    }
}
