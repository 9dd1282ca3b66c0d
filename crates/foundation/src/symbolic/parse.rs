//! The parser of expressions and conditions. The crate `evalexpr` builds the operator tree. A lexer in front of it
//! rejects what evalexpr would misread (`a b`, `a**b`, `+a`, `//`), reports columns, and keeps every literal exact by
//! handing evalexpr a name in its place.
//!
//! `-x^2` is `-(x^2)`. A power of a power and a sign inside a term require parentheses: `(a^b)^c`, `a*(-b)`. Where a scope has units, a number
//! may have one, `10 mm`, and stands for its size in the SI unit; after `/` and before `^` it requires parentheses, for readers differ there.

use super::lex::{Called, Lexed, excessive, function, lex, malformed, unknown_function};
use super::predicate::{Comparison, Predicate};
use super::{Expr, Function};
use crate::error::{Error, Result};
use crate::quantity::Quantity;
use evalexpr::{Node, Operator};
use num_rational::BigRational;
use num_traits::{One, Zero};

/// The largest number of bits of a constant: about a thousand decimal digits.
const MOST_BITS: u64 = 3322;
/// What is measured at places.
const OF_PLACES: [Quantity; 3] = [Quantity::Length, Quantity::Area, Quantity::Volume];

/// The names that an expression may use: variables, known by position, and named sub-expressions.
#[derive(Debug, Clone, Default)]
pub struct Scope {
    variables: Vec<String>,
    definitions: Vec<(String, Expr)>,
    units: Vec<Quantity>,
}

impl Scope {
    /// A scope with these variables and no sub-expressions.
    pub fn new<S: AsRef<str>>(variables: &[S]) -> Scope {
        let variables = variables.iter().map(|v| v.as_ref().to_string()).collect();
        Scope { variables, definitions: Vec::new(), units: Vec::new() }
    }

    /// The scope of a place in space of this dimension: x, y and z in m. Numbers may have units of length, area and volume.
    pub fn of_place(dimension: usize) -> Scope {
        Scope::new(&["x", "y", "z"][..dimension.min(3)]).with_units(&OF_PLACES)
    }

    /// With units of these quantities, which numbers may have.
    pub fn with_units(mut self, units: &[Quantity]) -> Scope {
        self.units.extend(units);
        self
    }

    /// The value of a quantity in its SI unit, over x, y and z in m, and t in s. Numbers may have units of the quantity, and where the
    /// variables decide, units of theirs: `"10 kPa * (1 + x/(5 mm))"`.
    ///
    /// # Errors
    /// Those of [`Scope::expression`]; a value that is the same everywhere has a unit of another quantity.
    pub fn value_over(variables: &[&str], quantity: Option<Quantity>, text: &str) -> Result<Expr> {
        let own = Scope::new(variables).with_units(quantity.as_slice());
        own.expression(text).or_else(|error| {
            match own.with_units(&OF_PLACES).with_units(&[Quantity::Time]).expression(text) {
                Ok(value) if (0..variables.len()).any(|variable| value.uses(variable)) => Ok(value),
                Ok(_) | Err(_) => Err(error),
            }
        })
    }

    /// Whether the variables are coordinates, in m.
    pub(super) fn is_of_places(&self) -> bool {
        self.units == OF_PLACES
    }

    pub(super) fn has_variable(&self, name: &str) -> bool {
        self.variables.iter().any(|variable| variable == name)
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
        let lexed = lex(text, &self.units).map_err(in_text)?;
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
        let compare = |c| {
            self.check_powers(node, lexed)?;
            Ok(Parsed::Condition(Predicate::Compare(c, real(0)?, real(1)?)))
        };
        let parsed = match node.operator() {
            Operator::RootNode => return child(0),
            Operator::Add => Expr::sum([real(0)?, real(1)?]),
            Operator::Sub => Expr::sum([real(0)?, real(1)?.negated()]),
            Operator::Neg => real(0)?.negated(),
            Operator::Mul => Expr::product([real(0)?, real(1)?]),
            Operator::Div => {
                let divisor = real(1)?;
                // A division by the number zero is a mistake in the text. The parser reports it, because it knows the place.
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
                    // An exponent with variables makes a real power of positive bases alone, which this has.
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
                        // The argument is in the result twice: nested ramps would double its size each time.
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

fn shortened(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_string() } else { text.chars().take(57).chain("...".chars()).collect() }
}

/// The rational value of a constant expression such as `1/3` or `-0.25`.
///
/// # Errors
/// The text does not parse, or has no rational value.
pub fn parse_rational(text: &str) -> Result<BigRational> {
    let expr = Scope::default().expression(text)?;
    expr.value(&[]).ok_or_else(|| Error::new(format!("expected a rational number, found \"{text}\"")))
}
