//! Code that computes the springs of a cell at run time, for programs that cut, remesh or adapt: one file without
//! dependencies, for one element and one objective, in one of several languages.
//!
//! The functions are written once, independent of the language: kernels run on values that record their operations, and
//! [`Program::print`] writes what was recorded in the words of a language.
//!
//! Theory: pages *Least squares* and *Exact networks and patches* of the book.

mod cell;
mod code;
mod language;
mod listing;
mod recipe;

pub use language::{LANGUAGES, LanguageRow, language, language_of};
pub use recipe::Recipe;

use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::Springs;
use cell::{Cell, LeastSquares, Plan, State};
use code::{Function, Role, Room, Status, Value};

/// The functions for one element and one objective, before they are printed.
#[derive(Debug)]
pub struct Program {
    /// What the names of all functions begin with.
    pub prefix: String,
    /// The heading of the file, line by line.
    heading: Vec<String>,
    functions: Vec<Function>,
}

impl Program {
    /// Writes the functions of `element` for this recipe; `groups` are the groups of springs of fits to the stiffness.
    ///
    /// # Errors
    /// The element has no such groups, or not those that the recipe needs; or the springs are linearly dependent.
    pub fn new(element: &Element, groups: Option<&[String]>, recipe: Recipe) -> Result<Program> {
        element.check_plain("generated code")?;
        let springs = recipe.springs(element, groups)?;
        let prefix = format!("{}_{}", identifier(&element.name), identifier(recipe.name()));
        let plan = Plan::of(element, &springs);
        let plan = if let Recipe::Published(_) = recipe { plan.with_springs() } else { plan };
        let is_exact = matches!(recipe, Recipe::Exact(_));
        let named = |end: &str| format!("{prefix}_{end}");
        let mut functions = Vec::new();
        for (state, end, what) in State::of_dimension(element.dimension()) {
            functions.push(cell::moduli(named(end), listing::moduli(what), *state));
        }
        functions.push(constants(Cell::new(element, &springs, plan), named("constants"), recipe, groups)?);
        let cell = Cell::new(element, &springs, plan);
        let energy = cell::energy(&cell, is_exact);
        let result = code::Result::Value(energy.number_in_body());
        functions.push(cell.body.finish(named("energy"), listing::energy(), result));
        let cell = Cell::new(element, &springs, plan);
        cell::forces(&cell, is_exact);
        functions.push(cell.body.finish(named("forces"), listing::forces(), code::Result::Nothing));
        let heading = listing::heading(element, &springs, recipe);
        Ok(Program { prefix, heading, functions })
    }

    /// Adds a branch beside the network whose stress relaxes at large deformation: its constants at rest, and a step of it.
    ///
    /// # Errors
    /// The recipe is no exact network.
    pub fn with_branch(mut self, element: &Element, recipe: Recipe) -> Result<Program> {
        if !matches!(recipe, Recipe::Exact(_)) {
            let expected = "the objective \"exact\": a branch whose stress relaxes is an exact network";
            let found = format!("\"{}\"", recipe.name());
            return Err(Error::expected("relaxing", expected, found).of_kind(ErrorKind::Unsupported));
        }
        if element.tabulation.weights.iter().any(|weight| *weight < 0.0) {
            let expected = "an element whose quadrature has positive weights: with others a branch would make energy";
            return Err(Error::expected("relaxing", expected, "a weight below zero").of_kind(ErrorKind::Unsupported));
        }
        let springs = recipe.springs(element, None)?;
        let plan = Plan::of(element, &springs);
        let named = |end: &str| format!("{}_{end}", self.prefix);
        let cell = Cell::new(element, &springs, plan);
        cell::branch(&cell);
        let first = cell.body.finish(named("branch"), listing::branch(), code::Result::Status);
        let cell = Cell::new(element, &springs, plan);
        cell::relax(&cell);
        let step = cell.body.finish(named("relax"), listing::relax(), code::Result::Status);
        self.functions.extend([first, step]);
        Ok(self)
    }

    /// The file in a language.
    ///
    /// # Errors
    /// The language has no room for the working memory of these functions.
    pub fn print(&self, language: &LanguageRow) -> Result<String> {
        let work = self.functions.iter().map(Function::work).max().unwrap_or(0);
        if work > language.most_work {
            let most = language.most_work;
            let expected = format!("one with room for {work} numbers in a function of {}", self.prefix);
            let error = Error::expected("language", expected, format!("\"{}\", with room for {most}", language.name));
            let room = language::languages_for(work).join(", ");
            let way = format!("; {room} have room, and \"exact\" and \"offdiag\" need little");
            return Err(error.of_kind(ErrorKind::Limit).followed_by(way));
        }
        Ok(language::print(language, &self.prefix, &self.heading, &self.functions))
    }
}

/// The function that writes the constants and rest measures.
fn constants(cell: Cell, name: String, recipe: Recipe, groups: Option<&[String]>) -> Result<Function> {
    let body = &cell.body;
    let (lambda, mu) = (body.parameter("lambda"), body.parameter("mu"));
    let m = cell.springs.len();
    let outputs = ["constants", "rests"].map(|name| body.array(name, m, Role::Output));
    let zero = body.number(0.0);
    body.fail_with(Status::Moduli);
    body.guard(&mu, &zero);
    body.guard(&(&lambda + &mu), &zero);
    let (constants, rests) = match recipe {
        Recipe::Exact(volume) => {
            let [constants, rests] = cell::exact(&cell, volume, &lambda, &mu);
            (constants, Some(rests))
        }
        Recipe::Published(method) => {
            let offered = Springs::select(cell.element, groups)?;
            (cell::published(&cell, method, &offered, &lambda, &mu)?, None)
        }
        Recipe::Frobenius(weight) => (cell::least_squares(&cell, LeastSquares::of(weight)?, &lambda, &mu), None),
    };
    let unrolled = matches!(constants, Room::Values(_));
    let mut sum = Room::new(body, "sum", 1, !unrolled);
    body.each(unrolled, 0, m, |s| {
        let constant = constants.get(body, s);
        sum.add(body, 0, &magnitude(&constant));
    });
    cell.guard_finite(&sum.get(body, 0));
    body.each(unrolled, 0, m, |s| body.store(outputs[0], s, &constants.get(body, s)));
    match rests {
        Some(rests) => body.each(unrolled, 0, m, |s| body.store(outputs[1], s, &rests.get(body, s))),
        None => cell.each_measure(|s, measure| body.store(outputs[1], s, measure)),
    }
    let comment = listing::constants();
    Ok(cell.body.finish(name, comment, code::Result::Status))
}

fn magnitude(value: &Value) -> Value {
    value.call(crate::symbolic::Function::Abs)
}

/// A name as it may begin an identifier of every language.
fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let plain: String = name.chars().map(letter).collect();
    let plain = plain.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_");
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("element_{plain}") }
}
