//! Functions as text: what is the same in every language.

use super::syntax::{Arguments, Syntax};
use crate::generate::cell::in_single;
use crate::generate::code::{Array, Atom, Function, Index, Node, Result, Role, Statement, Uses};
use crate::text::comment;
use std::collections::BTreeSet;

/// The width of the lines of tables.
const WIDTH: usize = 100;

/// Prints functions.
#[derive(Debug)]
pub struct Printer<'a> {
    syntax: &'a dyn Syntax,
    prefix: &'a str,
}

/// How tightly an expression holds together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Sum,
    Product,
    Sign,
    Whole,
}

impl<'a> Printer<'a> {
    /// A printer; the names of tables begin with the prefix.
    pub fn new(syntax: &'a dyn Syntax, prefix: &'a str) -> Printer<'a> {
        Printer { syntax, prefix }
    }

    /// The whole file.
    pub fn file(&self, heading: &[String], functions: &[Function]) -> String {
        let [first, last] = self.syntax.file(self.prefix);
        let encoding = self.syntax.encoding().map(String::from);
        let heading = encoding.into_iter().chain(self.comment(heading));
        let mut lines: Vec<String> = heading.chain([String::new()]).chain(first).collect();
        let mut known = BTreeSet::new();
        for array in functions.iter().flat_map(|function| &function.arrays) {
            let (entries, is_integer): (Vec<String>, bool) = match &array.role {
                Role::Table(numbers) => (numbers.iter().map(|number| self.number(*number)).collect(), false),
                Role::Integers(numbers) => {
                    (numbers.iter().map(|n| self.syntax.integer(n.cast_signed())).collect(), true)
                }
                Role::Input | Role::Output | Role::Work => continue,
            };
            if known.insert(&array.name) {
                lines.extend(self.syntax.table(&self.name(array), array.length, is_integer, &wrapped(&entries)));
                lines.push(String::new());
            }
        }
        for function in functions {
            lines.extend(self.comment(&function.comment));
            lines.extend(Writer::new(self, function).lines());
            lines.push(String::new());
        }
        lines.extend(last);
        while lines.last().is_some_and(String::is_empty) {
            lines.pop();
        }
        lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
    }

    fn comment<'b>(&'b self, lines: &'b [String]) -> impl Iterator<Item = String> + 'b {
        lines.iter().map(|line| comment(self.syntax.comment(), line))
    }

    fn name(&self, array: &Array) -> String {
        match array.role {
            Role::Table(_) | Role::Integers(_) => format!("{}_{}", self.prefix.to_uppercase(), array.name),
            Role::Input | Role::Output | Role::Work => array.name.clone(),
        }
    }

    /// A number, with its sign.
    fn number(&self, number: f64) -> String {
        let number = if self.syntax.is_single() { in_single(number) } else { number };
        let size = self.syntax.number(number.abs());
        if number < 0.0 { format!("-{size}") } else { size }
    }
}

/// Entries on lines of the width of a page.
fn wrapped(entries: &[String]) -> Vec<String> {
    let mut lines = vec![String::new()];
    for (i, entry) in entries.iter().enumerate() {
        let comma = if i + 1 < entries.len() { "," } else { "" };
        let line = lines.last_mut().expect("there is a line");
        if line.is_empty() {
            *line = format!("{entry}{comma}");
        } else if line.len() + entry.len() + 2 > WIDTH {
            lines.push(format!("{entry}{comma}"));
        } else {
            *line = format!("{line} {entry}{comma}");
        }
    }
    lines
}

/// One function.
struct Writer<'a> {
    printer: &'a Printer<'a>,
    syntax: &'a dyn Syntax,
    function: &'a Function,
    uses: Uses,
    lines: Vec<String>,
    depth: usize,
    /// The names of values, counted in the order in which they are printed.
    names: Vec<Option<String>>,
    count: usize,
}

impl<'a> Writer<'a> {
    fn new(printer: &'a Printer<'a>, function: &'a Function) -> Writer<'a> {
        let (uses, names) = (Uses::of(function), vec![None; function.nodes.len()]);
        Writer { printer, syntax: printer.syntax, function, uses, lines: Vec::new(), depth: 0, names, count: 0 }
    }

    fn lines(mut self) -> Vec<String> {
        let lists = Arguments::of(self.syntax, self.function);
        self.extend(self.syntax.open(self.function, &lists));
        self.depth = 1;
        for array in self.function.arrays_of(&Role::Work) {
            let memory = self.syntax.memory(&array.name, array.length);
            self.push(memory);
        }
        self.steps(&self.function.steps);
        let value = match self.function.result {
            Result::Value(value) => Some(self.value(value, Rank::Sum)),
            Result::Status | Result::Nothing => None,
        };
        let last = self.syntax.close(self.function, &lists, value.as_deref());
        self.depth = 0;
        self.extend(last);
        self.lines
    }

    fn push(&mut self, line: String) {
        self.lines.push(format!("{}{line}", self.syntax.indent().repeat(self.depth)));
    }

    fn extend(&mut self, lines: Vec<String>) {
        lines.into_iter().for_each(|line| self.push(line));
    }

    fn steps(&mut self, steps: &[Statement]) {
        for step in steps {
            match step {
                Statement::Value(value) => self.define(*value),
                Statement::Store { array, at, value } => {
                    let (entry, value) = (self.entry(*array, at), self.value(*value, Rank::Sum));
                    self.push(self.syntax.store(&entry, &value));
                }
                Statement::Guard { greater, than, status } => {
                    let (greater, than) = (self.value(*greater, Rank::Sum), self.value(*than, Rank::Sum));
                    self.extend(self.syntax.guard(&greater, &than, status.code()));
                }
                Statement::Loop { variable, from, to, body } => {
                    let (from, to) = (self.index(from), self.index(to));
                    let [begin, end] = self.syntax.repeat(&self.syntax.variable('i', *variable), &from, &to);
                    begin.into_iter().for_each(|line| self.push(line));
                    self.depth += 1;
                    self.steps(body);
                    self.depth -= 1;
                    end.into_iter().for_each(|line| self.push(line));
                }
            }
        }
    }

    fn define(&mut self, value: usize) {
        if self.uses.is_named(value) {
            let text = self.expression(value, Rank::Sum);
            let name = self.syntax.variable('v', self.count);
            self.count += 1;
            self.push(self.syntax.define(&name, &text));
            self.names[value] = Some(name);
        }
    }

    /// A value by its name, or as an expression that holds together at least as `rank`.
    fn value(&self, value: usize, rank: Rank) -> String {
        match &self.names[value] {
            Some(name) => name.clone(),
            None => self.expression(value, rank),
        }
    }

    fn expression(&self, value: usize, rank: Rank) -> String {
        let of = |value: &usize, rank: Rank| self.value(*value, rank);
        let (own, text) = match &self.function.nodes[value] {
            Node::Number(bits) => {
                let number = f64::from_bits(*bits);
                (if number < 0.0 { Rank::Sign } else { Rank::Whole }, self.printer.number(number))
            }
            Node::Parameter(place) => (Rank::Whole, self.syntax.parameter(&self.function.parameters[*place])),
            Node::Entry { array, at, .. } => (Rank::Whole, self.entry(*array, at)),
            Node::Equal(a, b) => (Rank::Whole, self.syntax.equal(&self.index(a), &self.index(b))),
            Node::Add(a, b) => (Rank::Sum, format!("{} + {}", of(a, Rank::Sum), of(b, Rank::Product))),
            Node::Subtract(a, b) => (Rank::Sum, format!("{} - {}", of(a, Rank::Sum), of(b, Rank::Product))),
            Node::Multiply(a, b) => (Rank::Product, self.syntax.product(&of(a, Rank::Product), &of(b, Rank::Whole))),
            Node::Divide(a, b) => (Rank::Product, self.syntax.quotient(&of(a, Rank::Product), &of(b, Rank::Whole))),
            Node::Negate(a) => (Rank::Sign, format!("-{}", of(a, Rank::Whole))),
            Node::Root(a) => (Rank::Whole, self.syntax.root(&of(a, Rank::Sum))),
            Node::Power(a, bits) => {
                let exponent = self.printer.number(f64::from_bits(*bits));
                (Rank::Whole, self.syntax.power(&of(a, Rank::Sum), &exponent))
            }
            Node::Call(call, a) => (Rank::Whole, self.syntax.call(call.0, &of(a, Rank::Sum))),
            Node::Select([a, b, yes, no]) => {
                let [a, b, yes, no] = [a, b, yes, no].map(|value| of(value, Rank::Sum));
                (Rank::Whole, self.syntax.select(&a, &b, &yes, &no))
            }
        };
        if own < rank { format!("({text})") } else { text }
    }

    fn entry(&self, array: usize, at: &Index) -> String {
        let array = &self.function.arrays[array];
        self.syntax.entry(array, &self.printer.name(array), &self.index(at))
    }

    /// An index; what is added comes before what is subtracted, because integers of some languages have no sign.
    fn index(&self, index: &Index) -> String {
        let atom = |atom: &Atom| match atom {
            Atom::Variable(variable) => self.syntax.variable('i', *variable),
            Atom::Entry(table, at) => self.entry(*table, at),
        };
        let mut terms: Vec<(bool, String)> = Vec::new();
        for (of, factor) in &index.terms {
            let size = factor.abs();
            let text = if size == 1 { atom(of) } else { format!("{} * {}", self.syntax.integer(size), atom(of)) };
            terms.push((*factor < 0, text));
        }
        if index.constant != 0 || terms.is_empty() {
            terms.push((index.constant < 0, self.syntax.integer(index.constant.abs())));
        }
        // A positive term in front spares a sign at the beginning.
        terms.sort_by_key(|(is_negative, _)| *is_negative);
        let mut text = String::new();
        for (i, (is_negative, term)) in terms.iter().enumerate() {
            text += match (i, is_negative) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            };
            text += term;
        }
        text
    }
}
