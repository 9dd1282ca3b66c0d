//! The powers of a length that the two sides of a comparison are, so that a length is not compared with an area.

use super::lex::{Called, Lexed, function};
use super::parse::Scope;
use crate::error::{Error, Result};
use evalexpr::{Node, Operator};
use num_traits::ToPrimitive;

/// Powers that differ by less are equal: a root of a root leaves rounding.
const EQUAL: f64 = 1e-9;

impl Scope {
    /// Checks that both sides of a comparison are the same power of a length, as far as units and places say what they are: a number without a unit may
    /// be anything.
    ///
    /// # Errors
    /// A length is compared with or added to an area, or the like.
    pub(super) fn check_powers(&self, comparison: &Node, lexed: &Lexed) -> Result<()> {
        if self.is_of_places() && lexed.powers.iter().any(Option::is_some) {
            self.common(comparison, lexed)?;
        }
        Ok(())
    }

    /// The power of a length that an expression is; `None` if nothing says so.
    fn power(&self, node: &Node, lexed: &Lexed) -> Result<Option<f64>> {
        let of = |i: usize| node.children().get(i).map_or(Ok(None), |child| self.power(child, lexed));
        Ok(match node.operator() {
            Operator::RootNode | Operator::Neg => of(0)?,
            Operator::Add | Operator::Sub => self.common(node, lexed)?,
            // A factor without a unit may have one that is not written: y = 0.1*x^2 is a parabola.
            Operator::Mul => of(0)?.zip(of(1)?).map(|(a, b)| a + b),
            Operator::Div => of(0)?.zip(of(1)?).map(|(a, b)| a - b),
            Operator::Exp => {
                let exponent = node.children().get(1).and_then(|exponent| self.literal(exponent, lexed));
                of(0)?.zip(exponent).map(|(power, exponent)| power * exponent)
            }
            Operator::Const { value } => self.of_name(&value.to_string(), lexed),
            Operator::VariableIdentifierRead { identifier } => self.of_name(identifier, lexed),
            Operator::FunctionIdentifier { identifier } => match function(identifier) {
                Some(Called::Sqrt) => of(0)?.map(|power| power / 2.0),
                Some(Called::Ramp) => of(0)?,
                Some(Called::Function(_)) | None => None,
            },
            _ => None,
        })
    }

    /// The power of both operands.
    fn common(&self, node: &Node, lexed: &Lexed) -> Result<Option<f64>> {
        let of = |i: usize| node.children().get(i).map_or(Ok(None), |child| self.power(child, lexed));
        match (of(0)?, of(1)?) {
            (Some(a), Some(b)) if (a - b).abs() > EQUAL => Err(Error::new(format!(
                "expected quantities of one kind on both sides of {}, found {} and {}",
                node.operator().to_string().trim(),
                title(a),
                title(b)
            ))),
            (a, b) => Ok(a.or(b)),
        }
    }

    fn of_name(&self, name: &str, lexed: &Lexed) -> Option<f64> {
        match name.strip_prefix('#').and_then(|i| i.parse::<usize>().ok()) {
            Some(literal) => lexed.powers.get(literal).copied().flatten().map(f64::from),
            None => self.has_variable(name).then_some(1.0),
        }
    }

    fn literal(&self, node: &Node, lexed: &Lexed) -> Option<f64> {
        let name = match node.operator() {
            Operator::RootNode => return self.literal(node.children().first()?, lexed),
            Operator::Neg => return self.literal(node.children().first()?, lexed).map(|value| -value),
            Operator::Const { value } => value.to_string(),
            Operator::VariableIdentifierRead { identifier } => identifier.clone(),
            _ => return None,
        };
        lexed.literals.get(name.strip_prefix('#')?.parse::<usize>().ok()?)?.to_f64()
    }
}

fn title(power: f64) -> String {
    match power {
        0.0 => "a number without a unit".into(),
        1.0 => "a length".into(),
        2.0 => "an area".into(),
        3.0 => "a volume".into(),
        _ => format!("a length to the power {power}"),
    }
}
