//! LaTeX, for a document that loads amsmath: the same steps as equations, to be read and checked.

use super::syntax::{Arguments, Syntax};
use crate::generate::code::{Array, Function};
use crate::symbolic;

/// LaTeX.
#[derive(Debug)]
pub struct Latex;

/// A name in upright letters, or one letter.
fn upright(name: &str) -> String {
    match name {
        "lambda" | "mu" => format!("\\{name}"),
        "young" => "E".into(),
        "poisson" => "\\nu".into(),
        "x" | "b" => name.into(),
        other => format!("\\mathit{{{}}}", other.replace('_', "\\_")),
    }
}

impl Syntax for Latex {
    fn comment(&self) -> &'static str {
        "% "
    }

    fn indent(&self) -> &'static str {
        "  "
    }

    fn file(&self, _: &str) -> [Vec<String>; 2] {
        [vec!["\\allowdisplaybreaks".into()], Vec::new()]
    }

    fn number(&self, number: f64) -> String {
        let text = format!("{number:?}");
        match text.split_once('e') {
            Some((digits, exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
            None => text.trim_end_matches(".0").to_string(),
        }
    }

    fn parameter(&self, name: &str) -> String {
        upright(name)
    }

    fn variable(&self, letter: char, number: usize) -> String {
        format!("{letter}_{{{number}}}")
    }

    fn entry(&self, _: &Array, name: &str, at: &str) -> String {
        format!("{}_{{{at}}}", upright(name))
    }

    fn equal(&self, a: &str, b: &str) -> String {
        format!("[{a} = {b}]")
    }

    fn root(&self, argument: &str) -> String {
        format!("\\sqrt{{{argument}}}")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("({base})^{{{exponent}}}")
    }

    fn call(&self, function: symbolic::Function, argument: &str) -> String {
        use symbolic::Function;
        match function {
            Function::Abs => format!("\\lvert {argument} \\rvert"),
            Function::Asin | Function::Acos | Function::Atan => format!("\\arc{}({argument})", &function.name()[1..]),
            _ => format!("\\{}({argument})", function.name()),
        }
    }

    fn select(&self, greater: &str, than: &str, yes: &str, no: &str) -> String {
        format!("\\begin{{cases}} {yes} & {greater} > {than} \\\\ {no} \\end{{cases}}")
    }

    fn quotient(&self, above: &str, below: &str) -> String {
        format!("{above} / {below}")
    }

    fn product(&self, a: &str, b: &str) -> String {
        format!("{a} \\, {b}")
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("{name} &= {value} \\\\")
    }

    fn store(&self, entry: &str, value: &str) -> String {
        format!("{entry} &\\leftarrow {value} \\\\")
    }

    fn memory(&self, name: &str, length: usize) -> String {
        format!("&{} \\in \\mathbb{{R}}^{{{length}}} \\\\", upright(name))
    }

    fn table(&self, name: &str, _: usize, _: bool, entries: &[String]) -> Vec<String> {
        let mut lines = vec!["\\begin{align*}".to_string(), format!("  {} = (&", upright(name))];
        let last = entries.len().saturating_sub(1);
        let line = |(i, line): (usize, &String)| format!("    & {line}{}", if i == last { ")" } else { " \\\\" });
        lines.extend(entries.iter().enumerate().map(line));
        lines.push("\\end{align*}".into());
        lines
    }

    fn repeat(&self, variable: &str, from: &str, to: &str) -> [Option<String>; 2] {
        [
            Some(format!("&\\text{{for }} {variable} = {from}, \\dots, {to} - 1: \\\\")),
            Some(format!("&\\text{{next }} {variable} \\\\")),
        ]
    }

    fn guard(&self, greater: &str, than: &str, status: usize) -> Vec<String> {
        vec![format!("&\\text{{status {status} unless }} {greater} > {than} \\\\")]
    }

    fn open(&self, function: &Function, _: &Arguments) -> Vec<String> {
        vec![format!("\\paragraph{{{}}}", function.name.replace('_', "\\_")), "\\begin{align*}".into()]
    }

    fn close(&self, _: &Function, lists: &Arguments, value: Option<&str>) -> Vec<String> {
        let outputs: Vec<String> = lists.outputs.iter().map(|array| upright(&array.name)).collect();
        let result = value.map_or_else(|| outputs.join(", \\; "), String::from);
        vec![format!("  &\\text{{result: }} {result}"), "\\end{align*}".into()]
    }
}
