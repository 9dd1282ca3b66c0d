//! Expressions printed as text that can be parsed again.

use super::Expr;
use num_rational::BigRational;
use num_traits::{One, Signed};
use std::fmt::Write;

impl Expr {
    /// The expression as text that can be parsed again, with the variables called `names`.
    pub fn text(&self, names: &[&str]) -> String {
        match self {
            Expr::Number(c) => c.to_string(),
            Expr::Variable(v) => names[*v].to_string(),
            Expr::Sum(terms) => {
                let mut text = String::new();
                for (i, term) in terms.iter().enumerate() {
                    match (i, term.is_negative()) {
                        (0, _) => text += &term.text(names),
                        (_, true) => {
                            write!(text, " - {}", term.clone().negated().as_operand(names)).expect("a String grows")
                        }
                        (_, false) => write!(text, " + {}", term.text(names)).expect("a String grows"),
                    }
                }
                text
            }
            Expr::Product(factors) => {
                let (sign, factors) = match &factors[0] {
                    Expr::Number(c) if (-c).is_one() => ("-", &factors[1..]),
                    _ => ("", &factors[..]),
                };
                let texts: Vec<_> = factors.iter().map(|f| f.as_operand(names)).collect();
                format!("{sign}{}", texts.join("*"))
            }
            Expr::Power(base, p) => format!("{}^{}", base.as_base(names), exponent(p)),
            Expr::Call(function, x) => format!("{}({})", function.name(), x.text(names)),
        }
    }

    fn as_operand(&self, names: &[&str]) -> String {
        match self {
            Expr::Sum(_) => format!("({})", self.text(names)),
            _ => self.text(names),
        }
    }

    fn as_base(&self, names: &[&str]) -> String {
        match self {
            Expr::Variable(_) | Expr::Call(..) => self.text(names),
            _ => format!("({})", self.text(names)),
        }
    }
}

fn exponent(p: &BigRational) -> String {
    if p.is_integer() && !p.is_negative() { p.to_string() } else { format!("({p})") }
}
