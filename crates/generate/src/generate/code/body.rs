//! The function that is being written.

use super::function::{Array, Function, Result, Role, Statement, Status};
use super::index::{Atom, Index};
use super::node::Node;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// A function that is being written. Equal operations are one value (hash-consing); a value that is made in a loop is
/// known in that loop alone.
#[derive(Debug, Clone)]
pub struct Body(Rc<RefCell<State>>);

#[derive(Debug)]
struct State {
    nodes: Vec<Node>,
    known: HashMap<Node, usize>,
    /// The open loops, the outermost first: their steps, and the nodes that are known in them alone.
    open: Vec<(Vec<Statement>, Vec<Node>)>,
    arrays: Vec<Array>,
    /// The number of writes to each array.
    writes: Vec<usize>,
    parameters: Vec<String>,
    variables: usize,
    status: Status,
}

impl Body {
    /// An empty function.
    pub fn new() -> Body {
        Body(Rc::new(RefCell::new(State {
            nodes: Vec::new(),
            known: HashMap::new(),
            open: vec![(Vec::new(), Vec::new())],
            arrays: Vec::new(),
            writes: Vec::new(),
            parameters: Vec::new(),
            variables: 0,
            status: Status::Shape,
        })))
    }

    /// The number of the value of this operation.
    pub(super) fn make(&self, node: Node) -> usize {
        let mut state = self.0.borrow_mut();
        if let Some(&known) = state.known.get(&node) {
            return known;
        }
        let number = state.nodes.len();
        state.nodes.push(node.clone());
        state.known.insert(node.clone(), number);
        let (steps, own) = state.open.last_mut().expect("the function itself is open");
        steps.push(Statement::Value(number));
        own.push(node);
        number
    }

    /// The operation of a value.
    pub(super) fn node(&self, value: usize) -> Node {
        self.0.borrow().nodes[value].clone()
    }

    /// The place of a new parameter that is a number.
    pub(super) fn add_parameter(&self, name: &str) -> usize {
        let mut state = self.0.borrow_mut();
        state.parameters.push(name.to_string());
        state.parameters.len() - 1
    }

    /// An array of so many entries.
    pub fn array(&self, name: &str, length: usize, role: Role) -> usize {
        let mut state = self.0.borrow_mut();
        if let Some(known) = state.arrays.iter().position(|array| array.name == name) {
            return known;
        }
        state.arrays.push(Array { name: name.to_string(), length, role });
        state.writes.push(0);
        state.arrays.len() - 1
    }

    /// The operation that reads an entry of an array; of a table, the number itself if the place is known.
    pub(super) fn read(&self, array: usize, at: Index) -> Node {
        let state = self.0.borrow();
        let known = match (&state.arrays[array].role, at.number()) {
            (Role::Table(numbers), Some(at)) => numbers.get(at).copied(),
            _ => None,
        };
        match known {
            Some(number) => Node::of_number(number),
            // The number of writes tells readings before and after a write apart: they are not one value.
            None => Node::Entry { array, at, writes: state.writes[array] },
        }
    }

    /// An entry of a table of integers.
    pub fn integer(&self, table: usize, at: impl Into<Index>) -> Index {
        let at = at.into();
        let state = self.0.borrow();
        match (&state.arrays[table].role, at.number()) {
            (Role::Integers(numbers), Some(at)) => numbers[at].into(),
            _ => Index { terms: vec![(Atom::Entry(table, Box::new(at)), 1)], constant: 0 },
        }
    }

    /// Writes a value into an entry of an array.
    pub(super) fn write(&self, array: usize, at: Index, value: usize) {
        let mut state = self.0.borrow_mut();
        state.writes[array] += 1;
        state.step(Statement::Store { array, at, value });
    }

    /// Ends the function unless one value is greater than the other.
    pub(super) fn require(&self, greater: usize, than: usize) {
        let mut state = self.0.borrow_mut();
        let status = state.status;
        state.step(Statement::Guard { greater, than, status });
    }

    /// The status with which the guards that follow end the function.
    pub fn fail_with(&self, status: Status) {
        self.0.borrow_mut().status = status;
    }

    /// Runs `work` for the integers from `from` up to `to`, exclusively: once for each if `unrolled`, otherwise once
    /// in a loop of the function.
    pub fn each(&self, unrolled: bool, from: impl Into<Index>, to: impl Into<Index>, mut work: impl FnMut(&Index)) {
        let (from, to) = (from.into(), to.into());
        if let (true, Some(from), Some(to)) = (unrolled, from.number(), to.number()) {
            (from..to).for_each(|i| work(&i.into()));
            return;
        }
        let variable = {
            let mut state = self.0.borrow_mut();
            state.variables += 1;
            state.open.push((Vec::new(), Vec::new()));
            state.forget_entries();
            state.variables - 1
        };
        work(&Index::variable(variable));
        let mut state = self.0.borrow_mut();
        if let Some((body, own)) = state.open.pop() {
            // What was computed in the loop has no value after it.
            own.iter().for_each(|node| _ = state.known.remove(node));
            state.forget_entries();
            state.step(Statement::Loop { variable, from, to, body });
        }
    }

    /// The finished function.
    pub fn finish(self, name: String, comment: Vec<String>, result: Result) -> Function {
        let mut state = self.0.borrow_mut();
        let steps = state.open.pop().map(|(steps, _)| steps).unwrap_or_default();
        Function {
            name,
            comment,
            parameters: std::mem::take(&mut state.parameters),
            arrays: std::mem::take(&mut state.arrays),
            nodes: std::mem::take(&mut state.nodes),
            steps,
            result,
        }
    }
}

impl State {
    fn step(&mut self, step: Statement) {
        self.open.last_mut().expect("the function itself is open").0.push(step);
    }

    /// At the edges of loops: entries that are read on both sides may differ.
    fn forget_entries(&mut self) {
        for (array, writes) in self.arrays.iter().zip(&mut self.writes) {
            *writes += usize::from(matches!(array.role, Role::Output | Role::Work));
        }
    }
}
