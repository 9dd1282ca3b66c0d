//! The lexer in front of the parser: numbers, names, operators and parentheses, and the functions that are known.

use super::{Expr, Function};
use crate::error::{Error, ErrorKind, Result};
use crate::quantity::Quantity;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Pow;
use std::cell::Cell;

/// The longest text, in characters; the shipped elements use a few hundred.
const LONGEST_TEXT: usize = 10_000;
/// The deepest nesting of parentheses. The parser is recursive, and a deeper text could overflow the stack.
const DEEPEST_NESTING: usize = 100;
/// The largest number of operators, because a chain of operators becomes a tree as deep as it is long.
const MOST_OPERATORS: usize = 1000;
/// The largest number of parts, because named sub-expressions are copied to each place of use and grow exponentially.
const MOST_PARTS: usize = 2000;
/// Letters of a unit, and one more: more than any has.
const LONGEST_UNIT: usize = 16;
/// The largest decimal exponent of a literal: a little above the range of `f64`.
const LARGEST_DECIMAL_EXPONENT: u32 = 400;

/// What a name before a parenthesis calls.
pub(super) enum Called {
    Sqrt,
    Ramp,
    Function(Function),
}

pub(super) fn function(name: &str) -> Option<Called> {
    match name {
        "sqrt" => return Some(Called::Sqrt),
        "ramp" => return Some(Called::Ramp),
        _ => {}
    }
    Function::all().find(|function| function.name() == name).map(Called::Function)
}

pub(super) fn unknown_function(name: &str) -> String {
    let names = Function::NAMES.join(", ");
    format!("expected an operator, or a function of sqrt, ramp, {names}, found \"{name}(\"")
}

pub(super) fn malformed(problem: impl Into<String>) -> Error {
    Error::new(problem).of_kind(ErrorKind::Syntax)
}

pub(super) fn excessive(problem: impl Into<String>) -> Error {
    Error::new(problem).of_kind(ErrorKind::Limit)
}

/// The text with each literal replaced by `#index`, and the values of the literals.
pub(super) struct Lexed {
    pub rewritten: String,
    pub literals: Vec<BigRational>,
    /// The power of a length that the unit of each literal is.
    pub powers: Vec<Option<u8>>,
    /// The number of terms and factors that have been copied so far.
    parts: Cell<usize>,
}

impl Lexed {
    /// Counts one more copy of `expr`; an error if there are too many.
    pub fn count(&self, expr: &Expr) -> Result<()> {
        self.parts.set(self.parts.get() + expr.parts());
        if self.parts.get() <= MOST_PARTS {
            return Ok(());
        }
        Err(excessive(format!("expected at most {MOST_PARTS} terms and factors in all")))
    }
}

/// Splits the text into numbers, names, operators and parentheses, and checks that operands and operators alternate.
pub(super) fn lex(text: &str, units: &[Quantity]) -> Result<Lexed> {
    if text.len() > LONGEST_TEXT {
        return Err(excessive(format!("expected at most {LONGEST_TEXT} characters, found {}", text.len())));
    }
    let chars: Vec<char> = text.chars().collect();
    let mut lexed = Lexed {
        rewritten: String::with_capacity(2 * text.len()),
        literals: Vec::new(),
        powers: Vec::new(),
        parts: Cell::new(0),
    };
    let mut operators = 0;
    // The operator before the operand that comes next.
    let mut before = ' ';
    let (mut at, mut open, mut operand_next, mut sign_allowed) = (0, 0usize, true, true);
    let fault = |at: usize, expected: &str| {
        let found = chars.get(at).map_or("the end".to_string(), |c| format!("'{c}'"));
        Err(malformed(format!("column {}: expected {expected}, found {found}", at + 1)))
    };
    while at < chars.len() {
        let c = chars[at];
        let start = at;
        if c.is_whitespace() {
            at += 1;
            continue;
        }
        if operand_next {
            match c {
                '(' => {
                    (open, before) = (open + 1, c);
                    if open > DEEPEST_NESTING {
                        let deep = fault(at, &format!("at most {DEEPEST_NESTING} open parentheses"));
                        return deep.map_err(|e: Error| e.of_kind(ErrorKind::Limit));
                    }
                    (at, sign_allowed) = (at + 1, true);
                }
                '-' if sign_allowed => (at, sign_allowed, operators) = (at + 1, false, operators + 1),
                '-' => return fault(at, "parentheses around a negative term"),
                '!' if sign_allowed && chars.get(at + 1) != Some(&'=') => (at, operators) = (at + 1, operators + 1),
                _ if c.is_ascii_digit() || c == '.' => {
                    at = end_of_number(&chars, at);
                    let literal: String = chars[start..at].iter().collect();
                    let Some(mut value) = decimal(&literal) else { return fault(start, "a decimal number") };
                    let mut power = None;
                    // The longest unit that fits is taken: `mm` is not the unit `m` before a name.
                    if let Some((end, size, of_length)) = unit_after(&chars, at, units) {
                        let follows = chars[end..].iter().find(|c| !c.is_whitespace());
                        if before == '/' || before == '^' || follows == Some(&'^') {
                            let own: String = chars[start..end].iter().collect();
                            let near = if before == '/' { '/' } else { '^' };
                            return fault(
                                start,
                                &format!("parentheses around a number with a unit beside {near}: ({own})"),
                            );
                        }
                        (value, at, power) = (value * size, end, of_length);
                    }
                    lexed.rewritten += &format!("#{}", lexed.literals.len());
                    lexed.literals.push(value);
                    lexed.powers.push(power);
                    operand_next = false;
                    continue;
                }
                _ if c.is_ascii_alphabetic() || c == '_' => {
                    while at < chars.len() && (chars[at].is_ascii_alphanumeric() || chars[at] == '_') {
                        at += 1;
                    }
                    let name: String = chars[start..at].iter().collect();
                    let called = chars[at..].iter().find(|c| !c.is_whitespace()) == Some(&'(');
                    match (called, function(&name).is_some()) {
                        (true, false) => return Err(Error::new(unknown_function(&name))),
                        (false, true) => return fault(at, &format!("'(' after {name}")),
                        _ => {}
                    }
                    operand_next = called;
                    sign_allowed = true;
                }
                _ => return fault(at, "a number, a name or '('"),
            }
        } else {
            match c {
                ')' if open > 0 => (at, open) = (at + 1, open - 1),
                ')' => return fault(at, "an operator or the end"),
                '+' | '-' | '*' | '/' | '^' => {
                    before = c;
                    (at, operand_next, sign_allowed, operators) = (at + 1, true, false, operators + 1);
                }
                '<' | '>' | '=' | '!' | '&' | '|' => {
                    before = c;
                    let pair: String = chars[at..chars.len().min(at + 2)].iter().collect();
                    at += match pair.as_str() {
                        "<=" | ">=" | "==" | "!=" | "&&" | "||" => 2,
                        _ if c == '<' || c == '>' => 1,
                        _ => return fault(at, "one of <, <=, >, >=, ==, !=, &&, ||"),
                    };
                    (operand_next, sign_allowed, operators) = (true, true, operators + 1);
                }
                _ if c.is_alphabetic() && !units.is_empty() => return fault(at, "an operator, or a unit such as mm"),
                _ => return fault(at, "an operator"),
            }
        }
        lexed.rewritten.extend(&chars[start..at]);
        lexed.rewritten.push(' ');
    }
    if operand_next {
        return fault(chars.len(), "a number, a name or '('");
    }
    if open > 0 {
        return fault(chars.len(), "')'");
    }
    if operators > MOST_OPERATORS {
        return Err(excessive(format!("expected at most {MOST_OPERATORS} operators, found {operators}")));
    }
    Ok(lexed)
}

/// Where the unit after a number ends, its size in the SI unit, and the power of a length that it is; spaces may stand between number and unit.
fn unit_after(chars: &[char], number_end: usize, units: &[Quantity]) -> Option<(usize, BigRational, Option<u8>)> {
    let start = number_end + chars[number_end..].iter().take_while(|c| c.is_whitespace()).count();
    // Most numbers have no unit: nothing is copied or compared for them. Every unit begins with a letter.
    chars.get(start).filter(|c| c.is_alphabetic())?;
    // Of a text of some thousand numbers only the beginning of what follows is copied.
    let rest: String = chars[start..].iter().take(LONGEST_UNIT).collect();
    let found = units.iter().filter_map(|quantity| Some((quantity.unit_at(&rest)?, quantity.power_of_length())));
    let ((length, number, power), of_length) = found.max_by_key(|((length, ..), _)| *length)?;
    let size = decimal(&format!("{number}e{power}"))?;
    Some((start + rest[..length].chars().count(), size, of_length))
}

/// The names in a text that are not called as functions, in the order in which they appear.
pub fn variables_of(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut names: Vec<String> = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let start = at;
        if chars[at].is_ascii_digit() || chars[at] == '.' {
            at = end_of_number(&chars, at).max(at + 1);
        } else if is_name(chars[at]) {
            at += chars[at..].iter().take_while(|c| is_name(**c)).count();
            let name: String = chars[start..at].iter().collect();
            let called = chars[at..].iter().find(|c| !c.is_whitespace()) == Some(&'(');
            if !called && function(&name).is_none() && !names.contains(&name) {
                names.push(name);
            }
        } else {
            at += 1;
        }
    }
    names
}

fn end_of_number(chars: &[char], start: usize) -> usize {
    let digits = |mut at: usize| {
        while at < chars.len() && (chars[at].is_ascii_digit() || chars[at] == '.') {
            at += 1;
        }
        at
    };
    let at = digits(start);
    if !matches!(chars.get(at), Some('e' | 'E')) {
        return at;
    }
    // A letter e that no digit follows is the beginning of a name or unit.
    let signed = at + 1 + matches!(chars.get(at + 1), Some('+' | '-')) as usize;
    let end = digits(signed);
    if end > signed { end } else { at }
}

/// The exact rational value of `12`, `0.1` or `2.5e-3`; `None` if the text is no decimal number or too large.
fn decimal(literal: &str) -> Option<BigRational> {
    let (mantissa, exponent) = match literal.find(['e', 'E']) {
        Some(e) => (&literal[..e], literal[e + 1..].parse::<i32>().ok()?),
        None => (literal, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if whole.len() + fraction.len() == 0 || fraction.contains('.') || exponent.unsigned_abs() > LARGEST_DECIMAL_EXPONENT
    {
        return None;
    }
    let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
    let scale = exponent - i32::try_from(fraction.len()).ok()?;
    Some(BigRational::from_integer(digits) * Pow::pow(BigRational::from_integer(10.into()), scale))
}
