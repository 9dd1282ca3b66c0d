//! Functions: straight-line code and loops, independent of the language in which they are printed.

use super::index::Index;
use super::node::Node;

/// An array of a function.
#[derive(Debug, Clone)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// The number of its entries.
    pub length: usize,
    /// What it is for.
    pub role: Role,
}

/// What an array is for.
#[derive(Debug, Clone, PartialEq)]
pub enum Role {
    /// The caller fills it in.
    Input,
    /// The function fills it in.
    Output,
    /// Memory of the function.
    Work,
    /// Constant numbers.
    Table(Vec<f64>),
    /// Constant integers.
    Integers(Vec<usize>),
}

/// One step.
#[derive(Debug, Clone)]
pub enum Statement {
    /// The place at which a value is first known.
    Value(usize),
    /// Writes a value.
    Store { array: usize, at: Index, value: usize },
    /// Ends the function with this status unless the first value is greater than the second.
    Guard { greater: usize, than: usize, status: Status },
    /// Runs the body with the variable from `from` up to `to`, exclusively.
    Loop { variable: usize, from: Index, to: Index, body: Vec<Statement> },
}

/// Why a function has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The Jacobian is not safely positive: the cell is flat, turned inside out, or not a number.
    Shape,
    /// The springs are linearly dependent under the objective.
    Dependent,
    /// A modulus is out of its range.
    Moduli,
    /// A result is infinite or not a number.
    Infinite,
}

impl Status {
    /// All of them, with what is printed about each; the codes count from 1.
    pub const ALL: [(Status, &'static str); 4] = [
        (Status::Shape, "the cell is flat, tangled, turned inside out, or a coordinate is not a number"),
        (Status::Dependent, "the springs are linearly dependent at this shape"),
        (Status::Moduli, "a modulus, ratio or thickness is out of its range"),
        (Status::Infinite, "a constant is infinite or not a number"),
    ];

    /// The number that the function returns.
    pub fn code(self) -> usize {
        Status::ALL.iter().position(|(status, _)| *status == self).map_or(0, |place| place + 1)
    }
}

/// What a function returns.
#[derive(Debug, Clone, PartialEq)]
pub enum Result {
    /// 0, or the code of a status.
    Status,
    /// This value.
    Value(usize),
    /// Nothing.
    Nothing,
}

/// A function with all that a printer needs.
#[derive(Debug, Clone)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// What it computes, line by line.
    pub comment: Vec<String>,
    /// Its parameters that are numbers; in the order of the list of arguments they follow the arrays that are given.
    pub parameters: Vec<String>,
    /// Its arrays.
    pub arrays: Vec<Array>,
    /// The values.
    pub nodes: Vec<Node>,
    /// The steps.
    pub steps: Vec<Statement>,
    /// What it returns.
    pub result: Result,
}

impl Function {
    /// The arrays with this role.
    pub fn arrays_of(&self, role: &Role) -> impl Iterator<Item = &Array> {
        self.arrays.iter().filter(move |array| array.role == *role)
    }

    /// The number of numbers in its own memory.
    pub fn work(&self) -> usize {
        self.arrays_of(&Role::Work).map(|array| array.length).sum()
    }
}
