//! Python, without packages. Sequences of numbers are flat; a status is an exception.

use super::syntax::{Arguments, Syntax, between, function_of_c};
use crate::generate::code::{Function, Status};
use crate::symbolic;

/// Python.
#[derive(Debug)]
pub struct Python;

impl Syntax for Python {
    fn comment(&self) -> &'static str {
        "# "
    }

    /// Otherwise `coding: utf-7` in a title would be one.
    fn encoding(&self) -> Option<&'static str> {
        Some("# -*- coding: utf-8 -*-")
    }

    fn file(&self, _: &str) -> [Vec<String>; 2] {
        let mut first: Vec<String> = [
            "import math",
            "",
            "",
            "class SpringError(ValueError):",
            "    \"\"\"A status other than 0.\"\"\"",
            "",
            "    MESSAGES = {",
        ]
        .map(String::from)
        .into();
        first.extend(Status::ALL.iter().map(|(status, what)| format!("        {}: {what:?},", status.code())));
        let last = [
            "    }",
            "",
            "    def __init__(self, status):",
            "        super().__init__(self.MESSAGES[status])",
            "        self.status = status",
            "",
            "",
        ];
        first.extend(last.map(String::from));
        [first, Vec::new()]
    }

    fn parameter(&self, name: &str) -> String {
        if name == "lambda" { "lambda_".into() } else { name.into() }
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("(1.0 if {a} == {b} else 0.0)")
    }

    fn root(&self, argument: &str) -> String {
        format!("math.sqrt({argument})")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("({base}) ** {exponent}")
    }

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        format!("math.{}({argument})", function_of_c(function))
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("({yes} if {greater} > {than} else {no})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("{name} = {value}")
    }

    fn store(&self, entry: &str, value: &str) -> String {
        format!("{entry} = {value}")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("{name} = [0.0] * {length}")
    }

    fn table(&self, name: &str, _: usize, _: bool, entries: &[String]) -> Vec<String> {
        between(format!("{name} = ("), entries, ",)")
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        let range = if from == "0" { to.to_string() } else { format!("{from}, {to}") };
        [Some(format!("for {variable} in range({range}):")), None]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if not {greater} > {than}:"), format!("    raise SpringError({status})")]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let inputs = lists.inputs.iter().map(|array| array.name.clone());
        let arguments: Vec<String> = inputs.chain(lists.parameters.iter().cloned()).collect();
        let mut lines = vec![format!("def {}({}):", function.name, arguments.join(", "))];
        // Numbers of NumPy are slower than those of Python, and division by zero is no exception in them.
        for array in &lists.inputs {
            lines.push(format!("    {0} = [float(entry) for entry in {0}]", array.name));
            lines.push(format!("    if len({}) != {}:", array.name, array.length));
            lines
                .push(format!("        raise ValueError(\"{} has another length than {}\")", array.name, array.length));
        }
        lines.extend(lists.outputs.iter().map(|array| format!("    {} = [0.0] * {}", array.name, array.length)));
        lines
    }

    fn close(&self, _: &Function, lists: &Arguments, value: Option<&str>) -> Vec<String> {
        let outputs: Vec<&str> = lists.outputs.iter().map(|array| array.name.as_str()).collect();
        vec![format!("    return {}", value.unwrap_or(&outputs.join(", "))), String::new()]
    }
}
