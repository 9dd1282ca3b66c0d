//! Polynomials and fractions printed as text that can be parsed again, and as LaTeX.

use super::{Fraction, Polynomial};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Notation {
    Text,
    Latex,
}

use Notation::{Latex, Text};

impl Notation {
    fn power(self, base: &str, exponent: u32) -> String {
        match (exponent, self) {
            (1, _) => base.to_string(),
            (_, Text) => format!("{base}^{exponent}"),
            (_, Latex) => format!("{base}^{{{exponent}}}"),
        }
    }

    /// The product of all operands other than 1.
    fn product(self, operands: impl IntoIterator<Item = String>) -> String {
        let operands: Vec<String> = operands.into_iter().filter(|operand| operand != "1").collect();
        match self {
            _ if operands.is_empty() => "1".to_string(),
            Text => operands.join("*"),
            Latex => operands.join(" "),
        }
    }

    /// A positive number.
    fn number(self, c: &BigRational) -> String {
        match self {
            Latex if !c.is_integer() => format!("\\frac{{{}}}{{{}}}", c.numer(), c.denom()),
            _ => c.to_string(),
        }
    }

    fn term(self, exponents: &[u32], c: &BigRational, names: &[&str]) -> String {
        let powers = exponents.iter().zip(names).filter(|(e, _)| **e > 0).map(|(e, name)| self.power(name, *e));
        self.product([self.number(&c.abs())].into_iter().chain(powers))
    }

    fn sum(self, p: &Polynomial, names: &[&str]) -> String {
        let terms: Vec<String> = p
            .sorted()
            .into_iter()
            .enumerate()
            .map(|(i, (exponents, c))| {
                let sign = match (i, c.is_negative()) {
                    (0, false) => "",
                    (0, true) => "-",
                    (_, false) => " + ",
                    (_, true) => " - ",
                };
                sign.to_string() + &self.term(exponents, c, names)
            })
            .collect();
        if terms.is_empty() { "0".to_string() } else { terms.concat() }
    }

    /// The factors and the number in front of them, as the operands of a product.
    fn operands(self, number: &BigInt, factors: &[(Polynomial, u32)], names: &[&str]) -> Vec<String> {
        let factor = |(p, e): &(Polynomial, u32)| match p.sorted().len() {
            1 => self.power(&self.sum(p, names), *e),
            _ => self.power(&format!("({})", self.sum(p, names)), *e),
        };
        let all = [number.to_string()].into_iter().chain(factors.iter().map(factor));
        all.filter(|operand| operand != "1").collect()
    }

    fn fraction(self, fraction: &Fraction, names: &[&str]) -> String {
        let content = fraction.content();
        let sign = if content.is_negative() { "-" } else { "" };
        let (above, below) = (fraction.numerator().factors(), fraction.denominator().factors());
        if below.is_empty() {
            let product = self.operands(&BigInt::one(), &above, names);
            return match (&above[..], content.abs().is_one()) {
                // A sum that is the whole numerator or denominator needs no parentheses.
                ([(p, 1)], true) if sign.is_empty() => self.sum(p, names),
                _ => sign.to_string() + &self.product([self.number(&content.abs())].into_iter().chain(product)),
            };
        }
        let above_operands = self.operands(&content.numer().abs(), &above, names);
        let below_operands = self.operands(content.denom(), &below, names);
        let (top, bottom) = (self.product(above_operands), self.product(below_operands.clone()));
        match self {
            Latex => format!(
                "{sign}\\frac{{{}}}{{{}}}",
                self.unwrapped(&content.numer().abs(), &above, top, names),
                self.unwrapped(content.denom(), &below, bottom, names)
            ),
            Text if below_operands.len() == 1 => format!("{sign}{top}/{bottom}"),
            Text => format!("{sign}{top}/({bottom})"),
        }
    }

    /// The text of a numerator or denominator between braces. A sum that is all of it needs no parentheses there.
    fn unwrapped(self, number: &BigInt, factors: &[(Polynomial, u32)], text: String, names: &[&str]) -> String {
        match factors {
            [(p, 1)] if number.is_one() => self.sum(p, names),
            _ => text,
        }
    }
}

impl Polynomial {
    /// The expanded sum as text, with the variables called `names`, that can be parsed again.
    pub fn text(&self, names: &[&str]) -> String {
        Text.sum(self, names)
    }

    /// The expanded sum as LaTeX, with the variables called `names`.
    pub fn latex(&self, names: &[&str]) -> String {
        Latex.sum(self, names)
    }
}

impl Fraction {
    /// Numerator and denominator in factors, as text that can be parsed again: `(5*a^2 + 3*b^2)/(8*a*b)`.
    pub fn text(&self, names: &[&str]) -> String {
        Text.fraction(self, names)
    }

    /// Numerator and denominator in factors, as LaTeX: `\frac{5 a^{2} + 3 b^{2}}{8 a b}`.
    pub fn latex(&self, names: &[&str]) -> String {
        Latex.fraction(self, names)
    }
}
