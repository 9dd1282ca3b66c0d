//! Closed forms as text and as LaTeX.

use crate::element::Element;
use crate::error::Result;
use crate::fit::{ClosedFit, ClosedForm, ExactForm, Modulus};
use crate::material::Plane;
use crate::symbolic::{Fraction, Polynomial};
use crate::text::{comment, latex};
use num_rational::BigRational;
use std::fmt::Write;

/// What is printed of a closed form.
#[derive(Debug)]
pub struct Derivation<'a> {
    /// The element.
    pub element: &'a Element,
    /// Its stiffness and springs as formulas.
    pub form: &'a ClosedForm,
    /// The exact network, where it is asked for.
    pub exact: Option<&'a ExactForm>,
    /// The fits, each with its constants as formulas or the reason why there are none.
    pub fits: &'a [Result<ClosedFit>],
    /// The plane state tells what E and ν of plane elements mean.
    pub plane: Option<Plane>,
    /// With the stiffness matrix.
    pub matrix: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Notation {
    Text,
    Latex,
}

impl Derivation<'_> {
    /// Plain text.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.element.name, self.element.title);
        let sides = self.form.variables.len() - 1;
        let shape = match (sides, self.plane) {
            (0, _) => "the reference cell".to_string(),
            _ => format!("sides {}", self.form.variables[..sides].join(", ")),
        };
        writeln!(text, "on {shape}; {}\n", self.meaning()).expect("a String grows");
        if self.matrix {
            text += "R, the stiffness, by rows up to the diagonal:\n";
            self.each_entry(|i, j, entry| {
                writeln!(text, "  R[{i}][{j}] = {}", self.linear(entry, Notation::Text)).expect("a String grows");
            });
            text.push('\n');
        }
        writeln!(text, "|R|^2 = {}\n", self.square(&self.form.norm, Notation::Text)).expect("a String grows");
        if let Some(exact) = self.exact {
            self.exact_text(exact, &mut text);
        }
        for fit in self.fits {
            match fit {
                Ok(fit) => self.fit_text(fit, &mut text),
                Err(error) => writeln!(text, "{error}\n").expect("a String grows"),
            }
        }
        text
    }

    /// LaTeX, for a document that loads amsmath.
    pub fn latex(&self) -> String {
        let about = format!("{}: {}; {}", self.element.name, self.element.title, self.meaning());
        let mut text = comment("% ", &about) + "\n";
        if self.matrix {
            text += "\\begin{align*}\n";
            self.each_entry(|i, j, entry| {
                let value = self.linear(entry, Notation::Latex);
                writeln!(text, "  R_{{{},{}}} &= {value} \\\\", i + 1, j + 1).expect("a String grows");
            });
            text += "\\end{align*}\n";
        }
        if let Some(exact) = self.exact {
            self.exact_latex(exact, &mut text);
        }
        for fit in self.fits.iter().flatten() {
            writeln!(text, "% {}\n\\begin{{align*}}", objective(fit)).expect("a String grows");
            for (class, constants) in self.form.classes.iter().zip(&fit.constants) {
                let name = format!("k_{{\\text{{{}}}}}", named(&latex(&class.group), &class.springs[0]));
                writeln!(text, "  {name} &= {} \\\\", self.constant_latex(constants)).expect("a String grows");
            }
            text += "\\end{align*}\n";
        }
        // The last line of a block has no line after it.
        text.replace(" \\\\\n\\end{align*}", "\n\\end{align*}")
    }

    fn exact_text(&self, exact: &ExactForm, text: &mut String) {
        let zero = exact.content.clone() - &exact.content;
        *text += "exact: springs of rest length zero between all nodes, and springs on the content; K = R\n";
        for (class, constant) in &exact.pairs {
            let count = class.springs.len();
            let like = if count > 1 { format!(" and {} more like it", count - 1) } else { String::new() };
            writeln!(text, "  {}{like}", named(&class.group, &class.springs[0])).expect("a String grows");
            let constants = [zero.clone(), constant.clone()];
            self.constant_text(&constants, text);
        }
        let names = self.names(Notation::Text);
        let (what, size) = (self.content_name(), exact.content.text(&names));
        match self.element.tabulation.points() {
            1 => writeln!(text, "  {what} V = {size}"),
            points => {
                writeln!(text, "  {what} V_q = w_q |J_q| at each of {points} quadrature points; their sum is {size}")
            }
        }
        .expect("a String grows");
        let index = if self.element.tabulation.points() == 1 { "" } else { "_q" };
        writeln!(text, "    k = (lambda + mu)/V{index}, rest {what} (1 + mu/(lambda + mu))*V{index}\n")
            .expect("a String grows");
    }

    fn exact_latex(&self, exact: &ExactForm, text: &mut String) {
        let zero = exact.content.clone() - &exact.content;
        *text +=
            "% exact: springs of rest length zero between all nodes, and springs on the content\n\\begin{align*}\n";
        for (class, constant) in &exact.pairs {
            let constants = [zero.clone(), constant.clone()];
            let name = format!("k_{{\\text{{{}}}}}", named(&latex(&class.group), &class.springs[0]));
            writeln!(text, "  {name} &= {} \\\\", self.constant_latex(&constants)).expect("a String grows");
        }
        let content = exact.content.latex(&self.names(Notation::Latex));
        let (volume, sum) = match self.element.tabulation.points() {
            1 => ("V", format!("V = {content}")),
            _ => ("V_q", format!("V_q = w_q \\lvert J_q\\rvert, \\quad \\textstyle\\sum_q V_q = {content}")),
        };
        writeln!(text, "  k_{{\\text{{content}}}} &= \\frac{{\\lambda + \\mu}}{{{volume}}}, \\quad {sum} \\\\")
            .expect("a String grows");
        writeln!(
            text,
            "  {volume}^{{\\text{{rest}}}} &= \\left(1 + \\frac{{\\mu}}{{\\lambda + \\mu}}\\right) {volume} \\\\"
        )
        .expect("a String grows");
        *text += "\\end{align*}\n";
    }

    fn constant_text(&self, constants: &[Fraction], text: &mut String) {
        writeln!(text, "    k = {}", self.linear(constants, Notation::Text)).expect("a String grows");
        if let Some(engineering) = self.engineering(constants, Notation::Text) {
            writeln!(text, "      = {engineering}").expect("a String grows");
        }
    }

    /// A constant in one line, in terms of E and ν where the material is isotropic.
    pub(super) fn constant(&self, constants: &[Fraction]) -> String {
        self.engineering(constants, Notation::Text).unwrap_or_else(|| self.linear(constants, Notation::Text))
    }

    fn constant_latex(&self, constants: &[Fraction]) -> String {
        let linear = self.linear(constants, Notation::Latex);
        self.engineering(constants, Notation::Latex).map_or(linear.clone(), |other| format!("{linear} = {other}"))
    }

    fn content_name(&self) -> &'static str {
        ["length", "area", "volume"][self.element.dimension() - 1]
    }

    fn fit_text(&self, fit: &ClosedFit, text: &mut String) {
        writeln!(text, "{}", objective(fit)).expect("a String grows");
        for (class, constants) in self.form.classes.iter().zip(&fit.constants) {
            let count = class.springs.len();
            let like = if count > 1 { format!(" and {} more like it", count - 1) } else { String::new() };
            writeln!(text, "  {}{like}", named(&class.group, &class.springs[0])).expect("a String grows");
            self.constant_text(constants, text);
        }
        writeln!(text, "  |R-K|^2 = {}", self.square(&fit.residual, Notation::Text)).expect("a String grows");
        if let Some(error) = self.relative_error(fit) {
            writeln!(text, "  |R-K|/|R| = {error:.6} at nu = 0.3").expect("a String grows");
        }
        text.push('\n');
    }

    fn is_isotropic(&self) -> bool {
        self.form.moduli.len() == 2
    }

    /// What the constants are in terms of.
    pub(super) fn meaning(&self) -> &'static str {
        match self.plane {
            _ if !self.is_isotropic() && self.element.dimension() == 1 => "C11 = E, cross-section 1",
            Some(Plane::Stress) if !self.is_isotropic() => {
                "orthotropic, plane stress, C11 = E1/d, C22 = E2/d, C12 = nu12*E2/d, C66 = G12, d = 1 - nu12^2*E2/E1, thickness 1"
            }
            Some(Plane::Strain) if !self.is_isotropic() => {
                "orthotropic, plane strain, C11, C22, C12 and C66 of the solid, thickness 1"
            }
            None if !self.is_isotropic() => {
                "orthotropic, C in the order xx, yy, zz, yz, xz, xy: the inverse of the compliance in E, nu and G"
            }
            None if self.element.dimension() == 1 => "lambda = 0, mu = E/2, cross-section 1",
            Some(Plane::Stress) => "plane stress, lambda = E*nu/(1 - nu^2), mu = E/(2*(1 + nu)), thickness 1",
            Some(Plane::Strain) => {
                "plane strain, lambda = E*nu/((1 + nu)*(1 - 2*nu)), mu = E/(2*(1 + nu)), thickness 1"
            }
            None => "lambda = E*nu/((1 + nu)*(1 - 2*nu)), mu = E/(2*(1 + nu))",
        }
    }

    /// λ/E and μ/E as functions of ν.
    fn moduli(&self) -> [Fraction; 2] {
        let count = self.form.variables.len();
        let number = |n: i64| Fraction::number(BigRational::from_integer(n.into()), count);
        let nu = Fraction::variable(count - 1, count);
        let less = |factor: i64| number(1) - &(nu.clone() * &number(factor));
        if self.element.dimension() == 1 {
            return [number(0), number(1) / &number(2)];
        }
        let lambda = match self.plane {
            Some(Plane::Stress) => nu.clone() / &(less(-1) * &less(1)),
            _ => nu.clone() / &(less(-1) * &less(2)),
        };
        [lambda, number(1) / &(less(-1) * &number(2))]
    }

    /// `|R − K|/|R|` at ν = 0.3, where the sides are numbers.
    pub(super) fn relative_error(&self, fit: &ClosedFit) -> Option<f64> {
        let at = [BigRational::new(3.into(), 10.into())];
        if self.form.variables.len() > 1 || !self.is_isotropic() {
            return None;
        }
        let [lambda, mu] = self.moduli().map(|m| m.evaluate(&at));
        let (lambda, mu) = (lambda?, mu?);
        let value = |form: &[Fraction]| -> Option<f64> {
            let [ll, lm, mm] = [form[0].evaluate(&at)?, form[1].evaluate(&at)?, form[2].evaluate(&at)?];
            num_traits::ToPrimitive::to_f64(&(ll * &lambda * &lambda + lm * &lambda * &mu + mm * &mu * &mu))
        };
        Some((value(&fit.residual)?.max(0.0) / value(&self.form.norm)?).sqrt())
    }

    fn each_entry(&self, mut visit: impl FnMut(usize, usize, &[Fraction])) {
        let size = self.form.positions.len();
        for i in 0..size {
            for j in 0..=i {
                let entry: Vec<Fraction> = self.form.stiffness.iter().map(|r| r[i * size + j].clone()).collect();
                visit(i, j, &entry);
            }
        }
    }

    fn names(&self, notation: Notation) -> Vec<&str> {
        let names = self.form.variables.iter().map(String::as_str);
        names.map(|v| if v == "nu" && notation == Notation::Latex { "\\nu" } else { v }).collect()
    }

    /// Such as `α λ + β μ`.
    fn linear(&self, coefficients: &[Fraction], notation: Notation) -> String {
        let name = |modulus: &Modulus| if notation == Notation::Text { &modulus.name } else { &modulus.latex }.clone();
        let names: Vec<String> = self.form.moduli.iter().map(name).collect();
        self.combination(coefficients.iter().zip(&names), notation)
    }

    fn square(&self, coefficients: &[Fraction], notation: Notation) -> String {
        let moduli = &self.form.moduli;
        let product = |(i, a): (usize, &Modulus)| {
            let times = |b: &Modulus| if *b == *a { format!("{}^2", a.name) } else { format!("{}*{}", a.name, b.name) };
            moduli[i..].iter().map(times).collect::<Vec<_>>()
        };
        let products: Vec<String> = moduli.iter().enumerate().flat_map(product).collect();
        self.combination(coefficients.iter().zip(&products), notation)
    }

    /// `E f(ν)`, with the factors of the moduli told apart in the denominator; none of zero and of orthotropic materials.
    fn engineering(&self, constants: &[Fraction], notation: Notation) -> Option<String> {
        if !self.is_isotropic() || constants.iter().all(Fraction::is_zero) {
            return None;
        }
        let [lambda, mu] = self.moduli();
        let mut value = constants[0].clone() * &lambda + &(constants[1].clone() * &mu);
        let count = self.form.variables.len();
        let one = Fraction::number(BigRational::from_integer(1.into()), count);
        let nu = Fraction::variable(count - 1, count);
        let mut below = Vec::new();
        for (multiple, text, latex) in
            [(1i64, "(1 + nu)", "(1+\\nu)"), (-1, "(1 - nu)", "(1-\\nu)"), (-2, "(1 - 2*nu)", "(1-2\\nu)")]
        {
            let factor =
                one.clone() + &(nu.clone() * &Fraction::number(BigRational::from_integer(multiple.into()), count));
            if value.denominator().divided_by(factor.numerator()).is_some() {
                value = value * &factor;
                below.push(if notation == Notation::Text { text } else { latex });
            }
        }
        let negative = num_traits::Signed::is_negative(value.content());
        let size = if negative { -value } else { value };
        let names = self.names(notation);
        // Numerator and denominator apart: the factors join the latter.
        let whole = |p: &Polynomial, c: &num_bigint::BigInt| {
            let number = Fraction::number(BigRational::from_integer(c.clone()), count);
            let one = Polynomial::constant(BigRational::from_integer(1.into()), count);
            number * &Fraction::new(p.clone(), one)
        };
        let above = whole(size.numerator(), size.content().numer());
        let under = whole(size.denominator(), size.content().denom());
        let sign = if negative { "-" } else { "" };
        if notation == Notation::Latex {
            let spaced = |part: &Fraction, text: String| if *part == one { String::new() } else { text + " " };
            let above = spaced(&above, bracketed(&above, above.latex(&names)));
            let below = spaced(&under, under.latex(&names)) + &below.join(" ");
            return Some(match below.trim() {
                "" => format!("{sign}{above}E"),
                below => format!("{sign}\\frac{{{above}E}}{{{below}}}"),
            });
        }
        let under = bracketed(&under, under.text(&names));
        let factors: Vec<&str> = [under.as_str()].into_iter().chain(below).filter(|f| *f != "1").collect();
        let (sign, above) = match ascending(&above, negative, &names) {
            Some(text) => ("", text),
            None => (sign, bracketed(&above, above.text(&names))),
        };
        let above = if above == "1" { "E".to_string() } else { format!("E*{above}") };
        Some(match factors.len() {
            0 => format!("{sign}{above}"),
            // The factors with nu are in brackets.
            1 if under == "1" || !under.contains('*') => format!("{sign}{above}/{}", factors[0]),
            _ => format!("{sign}{above}/({})", factors.join("*")),
        })
    }

    fn combination<'b>(&self, terms: impl Iterator<Item = (&'b Fraction, &'b String)>, notation: Notation) -> String {
        let names = self.names(notation);
        let mut text = String::new();
        for (fraction, symbol) in terms.filter(|(fraction, _)| !fraction.is_zero()) {
            let negative = num_traits::Signed::is_negative(fraction.content());
            let size = if negative { -fraction.clone() } else { fraction.clone() };
            let factor = if notation == Notation::Text { size.text(&names) } else { size.latex(&names) };
            let sign = match (text.is_empty(), negative) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            let factor = if size.denominator().is_one() { bracketed(&size, factor) } else { factor };
            let dot = if notation == Notation::Text { "*" } else { " " };
            text += sign;
            text += &if factor == "1" { symbol.clone() } else { format!("{factor}{dot}{symbol}") };
        }
        if text.is_empty() { "0".into() } else { text }
    }
}

/// A negative sum whose last term is positive reads better turned round: `(6 - 7*nu)` for `-(7*nu - 6)`.
fn ascending(sum: &Fraction, negative: bool, names: &[&str]) -> Option<String> {
    let alone = matches!(&sum.numerator().factors()[..], [(p, 1)] if p.term_count() > 1);
    if !negative || !alone {
        return None;
    }
    let terms = sum.numerator().sorted();
    let mut text = String::new();
    for (exponents, c) in terms.into_iter().rev() {
        let positive = num_traits::Signed::is_negative(c);
        if text.is_empty() && !positive {
            return None;
        }
        let size = Polynomial::monomial(exponents.to_vec(), num_traits::Signed::abs(c)).text(names);
        text += match (text.is_empty(), positive) {
            (true, _) => "",
            (false, true) => " + ",
            (false, false) => " - ",
        };
        text += &size;
    }
    let number = sum.content().numer().to_string();
    Some(if number == "1" { format!("({text})") } else { format!("{number}*({text})") })
}

/// The text of a polynomial as a factor: a sum that nothing multiplies needs parentheses.
fn bracketed(polynomial: &Fraction, text: String) -> String {
    let factors = polynomial.numerator().factors();
    let alone = polynomial.content().is_integer() && *polynomial.content() == BigRational::from_integer(1.into());
    match &factors[..] {
        [(p, 1)] if alone && p.term_count() > 1 => format!("({text})"),
        _ => text,
    }
}

fn objective(fit: &ClosedFit) -> String {
    match fit.weight {
        crate::fit::Weight::OffDiagonal => "offdiag: least squares over the blocks of different nodes".into(),
        crate::fit::Weight::None => "frobenius: least squares over all entries".into(),
        other => format!("frobenius, weight {}", other.name()),
    }
}

/// The group of a spring and its nodes. A colon separates them where the group ends in a digit, as in "mid-mid 1: 4-5".
pub(super) fn named(group: &str, spring: &[usize]) -> String {
    let nodes: Vec<String> = spring.iter().map(usize::to_string).collect();
    let colon = if group.ends_with(|c: char| c.is_ascii_digit()) { ":" } else { "" };
    format!("{group}{colon} {}", nodes.join("-"))
}
