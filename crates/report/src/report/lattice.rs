//! Lattices of springs as formulas.

use crate::study::{ClosedTensor, NamedLattice, Root};
use crate::symbolic::Fraction;
use std::fmt::Write;

/// The closed forms of a lattice: its shells, its tensor, its moduli, as text.
pub fn lattice_text(lattice: &NamedLattice, tensor: &ClosedTensor) -> String {
    let d = lattice.dimension();
    let names: Vec<&str> = tensor.variables.iter().map(String::as_str).collect();
    let shells: Vec<String> = names.iter().zip(lattice.shells).map(|(k, shell)| format!("{k}: {shell}")).collect();
    let mut text = format!("{}: {}; spacing a, {}\n", lattice.name, lattice.title, shells.join(", "));
    let mut line = |name: &str, value: String| writeln!(text, "  {name:<6}= {value}").expect("a String grows");
    let modulus = |formula: &Fraction| modulus(formula, &names, tensor.root, d);
    let shear = if d == 3 { "C44" } else { "C66" };
    for (name, entry) in ["C11", "C12", shear].iter().zip(&tensor.entries) {
        line(name, modulus(entry));
    }
    match (&tensor.young, &tensor.poisson) {
        (Some(young), Some(poisson)) => {
            line("E", modulus(young));
            line("nu", poisson.text(&names));
        }
        _ => line("E", "none: a strain meets no resistance".into()),
    }
    if let Some(zener) = &tensor.zener {
        line("Zener", zener.text(&names));
    }
    text
}

/// A formula with its root, over the spacing in space.
fn modulus(formula: &Fraction, names: &[&str], root: Root, d: usize) -> String {
    if formula.is_zero() {
        return "0".into();
    }
    let text = formula.text(names);
    let over = if d == 3 { "/a" } else { "" };
    let times = if root == Root::OfThree { "*sqrt(3)" } else { "" };
    match is_sum(&text) && !(over.is_empty() && times.is_empty()) {
        true => format!("({text}){times}{over}"),
        false => format!("{text}{times}{over}"),
    }
}

/// Whether the last operation of a formula is a sum.
fn is_sum(text: &str) -> bool {
    let mut depth = 0i32;
    text.chars().any(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        // A sign between blanks is that of a sum.
        depth == 0 && c == ' '
    })
}
