//! The parser of expressions and conditions. The crate `evalexpr` builds the operator tree. A lexer in front of it
//! rejects what evalexpr would misread (`a b`, `a**b`, `+a`, `//`), reports columns, and keeps every literal exact by
//! handing evalexpr a name in its place.
//!
//! `-x^2` is `-(x^2)`. A power of a power and a sign inside a term require parentheses: `(a^b)^c`, `a*(-b)`.

use super::predicate::{Comparison, Predicate};
use super::{Expr, Function};
use crate::error::{Error, ErrorKind, Result};
use evalexpr::{Node, Operator};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, Zero};
use std::cell::Cell;

/// The longest text, in characters; the shipped elements use a few hundred.
const LONGEST_TEXT: usize = 10_000;
/// The deepest nesting of parentheses. The parser is recursive, and a deeper text could overflow the stack.
const DEEPEST_NESTING: usize = 100;
/// The largest number of operators, because a chain of operators becomes a tree as deep as it is long.
const MOST_OPERATORS: usize = 1000;
/// The largest number of parts, because named sub-expressions are copied to each place of use and grow exponentially.
const MOST_PARTS: usize = 2000;
/// The largest number of bits of a constant: about a thousand decimal digits.
const MOST_BITS: u64 = 3322;
/// The largest decimal exponent of a literal: a little above the range of `f64`.
const LARGEST_DECIMAL_EXPONENT: i32 = 400;

/// The names that an expression may use: variables, known by position, and named sub-expressions.
#[derive(Debug, Clone, Default)]
pub struct Scope {
    variables: Vec<String>,
    definitions: Vec<(String, Expr)>,
}

impl Scope {
    /// A scope with these variables and no sub-expressions.
    pub fn new<S: AsRef<str>>(variables: &[S]) -> Scope {
        Scope { variables: variables.iter().map(|v| v.as_ref().to_string()).collect(), definitions: Vec::new() }
    }

    /// Defines `name` as an abbreviation of `text` for every expression that is parsed later.
    ///
    /// # Errors
    /// `text` does not parse, or `name` is taken or not a name.
    pub fn define(&mut self, name: &str, text: &str) -> Result<()> {
        let taken = self.variables.iter().chain(self.definitions.iter().map(|(n, _)| n)).any(|n| n == name);
        let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if taken || !is_name || function(name).is_some() {
            return Err(Error::new(format!("expected a new name of letters, digits and _, found \"{name}\"")));
        }
        let expr = self.expression(text)?;
        self.definitions.push((name.to_string(), expr));
        Ok(())
    }

    /// Parses a real-valued expression.
    ///
    /// # Errors
    /// The text is malformed, or it is a condition. The error gives the column, what was expected and what was found.
    pub fn expression(&self, text: &str) -> Result<Expr> {
        match self.parse(text)? {
            Parsed::Real(expr) => Ok(expr),
            Parsed::Condition(_) => Err(Error::new(format!("expected a number, found the condition \"{text}\""))),
        }
    }

    /// Parses a condition: comparisons joined by `&&`, `||`, `!`.
    ///
    /// # Errors
    /// The text is malformed, or it is a number. The error gives the column, what was expected and what was found.
    pub fn predicate(&self, text: &str) -> Result<Predicate> {
        match self.parse(text)? {
            Parsed::Condition(predicate) => Ok(predicate),
            Parsed::Real(_) => Err(Error::new(format!("expected a condition such as \"z < 0.1\", found \"{text}\""))),
        }
    }

    fn parse(&self, text: &str) -> Result<Parsed> {
        let in_text = |e: Error| e.followed_by(format!(" in \"{}\"", shortened(text)));
        let lexed = lex(text).map_err(in_text)?;
        let tree = evalexpr::build_operator_tree(&lexed.rewritten)
            .map_err(|e| malformed(format!("\"{}\" is not an expression: {e}", shortened(text))))?;
        self.walk(&tree, &lexed).map_err(in_text)
    }

    fn walk(&self, node: &Node, lexed: &Lexed) -> Result<Parsed> {
        let children = node.children();
        let child = |i: usize| match children.get(i) {
            Some(c) => self.walk(c, lexed),
            None => Err(malformed("expected one more operand")),
        };
        let real = |i: usize| child(i)?.real();
        let condition = |i: usize| child(i)?.condition();
        let compare = |c| Ok(Parsed::Condition(Predicate::Compare(c, real(0)?, real(1)?)));
        let parsed = match node.operator() {
            Operator::RootNode => return child(0),
            Operator::Add => Expr::sum([real(0)?, real(1)?]),
            Operator::Sub => Expr::sum([real(0)?, real(1)?.negated()]),
            Operator::Neg => real(0)?.negated(),
            Operator::Mul => Expr::product([real(0)?, real(1)?]),
            Operator::Div => {
                let divisor = real(1)?;
                if divisor.as_number().is_some_and(Zero::is_zero) {
                    return Err(Error::new("division by zero"));
                }
                Expr::product([real(0)?, Expr::power(divisor, -BigRational::one())])
            }
            Operator::Exp => {
                if matches!(children.first().map(Node::operator), Some(Operator::Exp)) {
                    return Err(malformed("expected parentheses in a power of a power"));
                }
                match (real(0)?, real(1)?) {
                    (base, Expr::Number(n)) => Expr::power(base, n),
                    (base, n) => Expr::call(Function::Exp, Expr::product([n, Expr::call(Function::Ln, base)])),
                }
            }
            Operator::Const { value } => self.name(&value.to_string(), lexed)?,
            Operator::VariableIdentifierRead { identifier } => self.name(identifier, lexed)?,
            Operator::FunctionIdentifier { identifier } => {
                let argument = real(0)?;
                match function(identifier) {
                    Some(Called::Sqrt) => Expr::power(argument, BigRational::new(1.into(), 2.into())),
                    Some(Called::Ramp) => {
                        lexed.count(&argument)?;
                        Expr::product([argument.clone(), Expr::call(Function::Step, argument)])
                    }
                    Some(Called::Function(f)) => Expr::call(f, argument),
                    None => return Err(Error::new(unknown_function(identifier))),
                }
            }
            Operator::Lt => return compare(Comparison::Less),
            Operator::Leq => return compare(Comparison::LessOrEqual),
            Operator::Gt => return compare(Comparison::Greater),
            Operator::Geq => return compare(Comparison::GreaterOrEqual),
            Operator::Eq => return compare(Comparison::Equal),
            Operator::Neq => return compare(Comparison::NotEqual),
            Operator::And => {
                return Ok(Parsed::Condition(Predicate::And(condition(0)?.into(), condition(1)?.into())));
            }
            Operator::Or => return Ok(Parsed::Condition(Predicate::Or(condition(0)?.into(), condition(1)?.into()))),
            Operator::Not => return Ok(Parsed::Condition(Predicate::Not(condition(0)?.into()))),
            other => return Err(malformed(format!("the operator {other} is not known here"))),
        };
        if parsed.largest_constant() > MOST_BITS {
            return Err(excessive("expected numbers of at most 1000 digits"));
        }
        Ok(Parsed::Real(parsed))
    }

    fn name(&self, name: &str, lexed: &Lexed) -> Result<Expr> {
        if let Some(literal) = name.strip_prefix('#').and_then(|i| lexed.literals.get(i.parse::<usize>().ok()?)) {
            return Ok(Expr::Number(literal.clone()));
        }
        if let Some(v) = self.variables.iter().position(|v| v == name) {
            return Ok(Expr::Variable(v));
        }
        if let Some((_, expr)) = self.definitions.iter().find(|(n, _)| n == name) {
            lexed.count(expr)?;
            return Ok(expr.clone());
        }
        let mut known: Vec<&str> = self.variables.iter().map(String::as_str).collect();
        known.extend(self.definitions.iter().map(|(n, _)| n.as_str()));
        Err(Error::new(match known.as_slice() {
            [] => format!("expected a constant, found the name \"{name}\""),
            _ => format!("expected one of {}, found the name \"{name}\"", known.join(", ")),
        }))
    }
}

enum Parsed {
    Real(Expr),
    Condition(Predicate),
}

impl Parsed {
    fn real(self) -> Result<Expr> {
        match self {
            Parsed::Real(expr) => Ok(expr),
            Parsed::Condition(_) => Err(Error::new("expected a number, found a condition")),
        }
    }

    fn condition(self) -> Result<Predicate> {
        match self {
            Parsed::Condition(predicate) => Ok(predicate),
            Parsed::Real(_) => Err(Error::new("expected a condition, found a number")),
        }
    }
}

enum Called {
    Sqrt,
    Ramp,
    Function(Function),
}

fn function(name: &str) -> Option<Called> {
    match name {
        "sqrt" => return Some(Called::Sqrt),
        "ramp" => return Some(Called::Ramp),
        _ => {}
    }
    Function::ALL.iter().find(|(n, _)| *n == name).map(|(_, f)| Called::Function(*f))
}

fn unknown_function(name: &str) -> String {
    let names: Vec<_> = Function::ALL.iter().map(|(n, _)| *n).collect();
    format!("expected an operator, or a function of sqrt, ramp, {}, found \"{name}(\"", names.join(", "))
}

fn malformed(problem: impl Into<String>) -> Error {
    Error::new(problem).of_kind(ErrorKind::Syntax)
}

fn excessive(problem: impl Into<String>) -> Error {
    Error::new(problem).of_kind(ErrorKind::Limit)
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_string() } else { text.chars().take(57).chain("...".chars()).collect() }
}

/// The text with each literal replaced by `#index`, and the values of the literals.
struct Lexed {
    rewritten: String,
    literals: Vec<BigRational>,
    /// The number of terms and factors that have been copied so far.
    parts: Cell<usize>,
}

impl Lexed {
    /// Counts one more copy of `expr`; an error if there are too many.
    fn count(&self, expr: &Expr) -> Result<()> {
        self.parts.set(self.parts.get() + expr.parts());
        if self.parts.get() <= MOST_PARTS {
            return Ok(());
        }
        Err(excessive(format!("expected at most {MOST_PARTS} terms and factors in all")))
    }
}

/// Splits the text into numbers, names, operators and parentheses, and checks that operands and operators alternate.
fn lex(text: &str) -> Result<Lexed> {
    if text.len() > LONGEST_TEXT {
        return Err(excessive(format!("expected at most {LONGEST_TEXT} characters, found {}", text.len())));
    }
    let chars: Vec<char> = text.chars().collect();
    let mut lexed =
        Lexed { rewritten: String::with_capacity(2 * text.len()), literals: Vec::new(), parts: Cell::new(0) };
    let mut operators = 0;
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
                    open += 1;
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
                    let Some(value) = decimal(&literal) else { return fault(start, "a decimal number") };
                    lexed.rewritten += &format!("#{}", lexed.literals.len());
                    lexed.literals.push(value);
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
                    (at, operand_next, sign_allowed, operators) = (at + 1, true, false, operators + 1);
                }
                '<' | '>' | '=' | '!' | '&' | '|' => {
                    let pair: String = chars[at..chars.len().min(at + 2)].iter().collect();
                    at += match pair.as_str() {
                        "<=" | ">=" | "==" | "!=" | "&&" | "||" => 2,
                        _ if c == '<' || c == '>' => 1,
                        _ => return fault(at, "one of <, <=, >, >=, ==, !=, &&, ||"),
                    };
                    (operand_next, sign_allowed, operators) = (true, true, operators + 1);
                }
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
    if whole.len() + fraction.len() == 0 || fraction.contains('.') || exponent.abs() > LARGEST_DECIMAL_EXPONENT {
        return None;
    }
    let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
    let scale = exponent - i32::try_from(fraction.len()).ok()?;
    Some(BigRational::from_integer(digits) * Pow::pow(BigRational::from_integer(10.into()), scale))
}

/// The rational value of a constant expression such as `1/3` or `-0.25`.
///
/// # Errors
/// The text does not parse, or has no rational value.
pub fn parse_rational(text: &str) -> Result<BigRational> {
    let expr = Scope::default().expression(text)?;
    expr.value(&[]).ok_or_else(|| Error::new(format!("expected a rational number, found \"{text}\"")))
}
