//! JavaScript, a module without packages. Sequences of numbers are flat; a status is an exception.

use super::syntax::{Arguments, Syntax, between, function_of_c};
use crate::generate::code::{Array, Function, Status};
use crate::symbolic;

/// JavaScript.
#[derive(Debug)]
pub struct JavaScript;

impl Syntax for JavaScript {
    fn file(&self, _: &str) -> [Vec<String>; 2] {
        let mut first: Vec<String> =
            ["/** A status other than 0. */", "export class SpringError extends Error {", "    static MESSAGES = {"]
                .map(String::from)
                .into();
        first.extend(Status::ALL.iter().map(|(status, what)| format!("        {}: {what:?},", status.code())));
        let last = [
            "    };",
            "",
            "    constructor(status) {",
            "        super(SpringError.MESSAGES[status]);",
            "        this.name = \"SpringError\";",
            "        this.status = status;",
            "    }",
            "}",
            "",
        ];
        first.extend(last.map(String::from));
        [first, Vec::new()]
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("({a} === {b} ? 1.0 : 0.0)")
    }

    fn root(&self, argument: &str) -> String {
        format!("Math.sqrt({argument})")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("Math.pow({base}, {exponent})")
    }

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        match function {
            symbolic::Function::Abs => format!("Math.abs({argument})"),
            function => format!("Math.{}({argument})", function_of_c(function)),
        }
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("({greater} > {than} ? {yes} : {no})")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("const {name} = {value};")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("const {name} = new Float64Array({length});")
    }

    fn table(&self, name: &str, _: usize, _: bool, entries: &[String]) -> Vec<String> {
        between(format!("const {name} = ["), entries, "];")
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [Some(format!("for (let {variable} = {from}; {variable} < {to}; {variable}++) {{")), Some("}".into())]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("if (!({greater} > {than})) {{"), format!("    throw new SpringError({status});"), "}".into()]
    }

    fn open(&self, function: &Function, lists: &Arguments) -> Vec<String> {
        let inputs = lists.inputs.iter().map(|array| array.name.clone());
        let arguments: Vec<String> = inputs.chain(lists.parameters.iter().cloned()).collect();
        let mut lines = vec![format!("export function {}({}) {{", function.name, arguments.join(", "))];
        for array in &lists.inputs {
            lines.push(format!("    if ({}.length !== {}) {{", array.name, array.length));
            lines.push(format!(
                "        throw new RangeError(\"{} has another length than {}\");",
                array.name, array.length
            ));
            lines.push("    }".into());
        }
        let output = |array: &&Array| format!("    const {} = new Float64Array({});", array.name, array.length);
        lines.extend(lists.outputs.iter().map(output));
        lines
    }

    fn close(&self, _: &Function, lists: &Arguments, value: Option<&str>) -> Vec<String> {
        let outputs: Vec<&str> = lists.outputs.iter().map(|array| array.name.as_str()).collect();
        let result = match (value, &outputs[..]) {
            (Some(value), _) => value.to_string(),
            (None, [output]) => output.to_string(),
            (None, outputs) => format!("[{}]", outputs.join(", ")),
        };
        vec![format!("    return {result};"), "}".into()]
    }
}
