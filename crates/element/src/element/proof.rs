//! The properties that an element file must have before a number is computed from it.
//!
//! Identities of polynomials with rational coefficients are decided exactly. Those of other functions are tested at
//! sample points in floating point.

use super::cell::Cell;
use super::constant::Constant;
use super::definition::{Definition, FormatEntry, NodeEntry, Rule};
use super::quadrature::{MOST_POINTS, Quadrature};
use super::{ShapeFunctions, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::number::first_not_finite;
use crate::symbolic::{Expr, Polynomial, Scope};
use num_rational::BigRational;
use num_traits::Zero;

/// The largest number of nodes, that of a cube with 8³ nodes: the proofs evaluate each shape function at each node.
const MOST_NODES: usize = 512;
/// The largest number of parts of all shape functions: twice that of a cube of 8³ nodes.
const MOST_PARTS: usize = 80_000;
/// The largest number of parts of all gradients, so that they fit into memory.
const MOST_GRADIENT_PARTS: usize = 5_000_000;
/// The largest number of evaluation steps of a tabulation; it takes a few seconds.
const MOST_STEPS: usize = 1_000_000_000;
/// The tolerance of sampled identities: some thousand rounding errors of numbers of size one.
const ROUNDING: f64 = 1e-12;
/// The tolerance of integrals of the coordinates: tables of quadrature points have ten digits.
const DIGITS: f64 = 1e-8;
/// If a function has no value at a node, it is evaluated inside the cell, at this share of the way to the centre. The
/// error of a linear continuation is about its square, far below one, and the function has lost no digits there.
const CONTINUED: f64 = 1e-5;

/// Names are words of options and lists, whose parts are separated by commas.
pub fn names(definition: &Definition) -> Result<()> {
    let groups = definition.springs.iter().enumerate().map(|(i, entry)| (format!("springs[{i}].group"), &entry.group));
    match [("name".into(), &definition.name)].into_iter().chain(groups).find(|(_, name)| !is_word(name)) {
        Some((key, name)) => Err(Error::expected(key, "a name without commas", format!("\"{name}\""))),
        None => Ok(()),
    }
}

fn is_word(name: &str) -> bool {
    !name.trim().is_empty() && !name.contains(',')
}

pub fn coordinates(definition: &Definition) -> Result<()> {
    let d = definition.cell.dimension();
    if definition.coordinates.len() != d {
        let expected = format!("{d} names for a cell of dimension {d}");
        return Err(Error::expected("coordinates", expected, definition.coordinates.len()));
    }
    let mut scope = Scope::default();
    for (k, name) in definition.coordinates.iter().enumerate() {
        scope.define(name, "0").map_err(|e| e.at_key(format!("coordinates[{k}]")))?;
    }
    // A linear field has d + 1 numbers: fewer nodes cannot have it.
    if definition.nodes.len() <= d || definition.nodes.len() > MOST_NODES {
        let expected = format!("{} to {MOST_NODES} nodes", d + 1);
        return Err(Error::expected("nodes", expected, definition.nodes.len()));
    }
    match definition.nodes.iter().position(|n| n.at.len() != d) {
        Some(a) => {
            Err(Error::expected(format!("nodes[{a}].at"), format!("{d} coordinates"), definition.nodes[a].at.len()))
        }
        None => Ok(()),
    }
}

/// Checks that the proofs, which evaluate every shape function at every node, end soon, and that the gradients fit into
/// memory.
pub fn moderate(definition: &Definition, shapes: &[Expr]) -> Result<()> {
    let check = |what: &str, most: usize, parts: usize| {
        let expected = format!("{what} of at most {most} numbers, names and operations in all");
        if parts <= most { Ok(()) } else { Err(Error::expected("nodes", expected, parts).of_kind(ErrorKind::Limit)) }
    };
    check("shape functions", MOST_PARTS, shapes.iter().map(Expr::parts).sum())?;
    let parts: usize = shapes.iter().map(Expr::most_parts_of_derivative).sum();
    check("gradients", MOST_GRADIENT_PARTS, definition.cell.dimension() * parts)
}

/// Checks that the shape functions and their gradients can be evaluated at so many points in a few seconds.
pub fn tabulable(functions: &ShapeFunctions, points: usize) -> Result<()> {
    // Numbers of a file may overflow the product, which then is above any limit.
    let steps = functions.parts().saturating_mul(points);
    if steps <= MOST_STEPS {
        return Ok(());
    }
    let expected = format!("a rule at whose points the shape functions take at most {MOST_STEPS} steps to evaluate");
    let found = format!("{steps} at {points} points");
    Err(Error::expected("quadrature", expected, found).of_kind(ErrorKind::Limit))
}

/// Checks the Kronecker property, the partition of unity and linear completeness.
pub fn nodal(definition: &Definition, shapes: &[Expr]) -> Result<()> {
    let place = |node: &NodeEntry| -> (Option<Vec<BigRational>>, Vec<f64>) {
        (node.at.iter().map(Constant::exact).collect(), node.at.iter().map(Constant::value).collect())
    };
    let places: Vec<_> = definition.nodes.iter().map(place).collect();
    for (a, shape) in shapes.iter().enumerate() {
        for (b, (exact, at)) in places.iter().enumerate() {
            let expected = i64::from(a == b);
            let (holds, found) = compare(definition.cell, shape, exact.as_deref(), at, expected);
            if !holds {
                let problem = format!("is {found} at nodes[{b}], expected {expected}");
                return Err(Error::at(format!("nodes[{a}].shape"), problem));
            }
        }
    }
    let is_exact = places.iter().all(|(exact, _)| exact.is_some());
    let minus_one = Expr::integer(-1);
    vanishes(definition, is_exact, Expr::sum(shapes.iter().cloned().chain([minus_one])))
        .map_err(|found| Error::expected("nodes", "shape functions that sum to 1", format!("1 {found}")))?;
    for (k, name) in definition.coordinates.iter().enumerate() {
        let at = definition.nodes.iter().map(|n| number(&n.at[k]));
        let moments = shapes.iter().cloned().zip(at).map(|(n, x)| Expr::product([n, x]));
        let defect = Expr::sum(moments.chain([Expr::Variable(k).negated()]));
        vanishes(definition, is_exact, defect).map_err(|found| {
            Error::expected("nodes", format!("shape functions that reproduce {name}"), format!("{name} {found}"))
        })?;
    }
    Ok(())
}

fn number(c: &Constant) -> Expr {
    let exact = c.exact().or_else(|| BigRational::from_float(c.value()));
    Expr::Number(exact.unwrap_or_else(BigRational::zero))
}

fn compare(cell: Cell, shape: &Expr, exact: Option<&[BigRational]>, at: &[f64], expected: i64) -> (bool, String) {
    // Exact numbers decide exactly, where both the place and the function have them.
    if let Some(value) = exact.and_then(|at| shape.value(at)) {
        return (value == BigRational::from_integer(expected.into()), value.to_string());
    }
    let value = shape.evaluate(at);
    if value.is_finite() {
        return ((value - expected as f64).abs() <= ROUNDING, value.to_string());
    }
    // At the apex of a pyramid a rational function is continued linearly from two points inside.
    let centre = cell.centre();
    let inside = |share: f64| {
        let at: Vec<f64> = at.iter().enumerate().map(|(k, x)| x + share * (centre[k] - x)).collect();
        shape.evaluate(&at)
    };
    let (near, far) = (inside(CONTINUED), inside(2.0 * CONTINUED));
    // A function with a limit changes little between the points; one that has none there is not continued.
    let value = if (far - near).abs() < 1e3 * CONTINUED { 2.0 * near - far } else { f64::NAN };
    ((value - expected as f64).abs() <= 1e3 * CONTINUED * CONTINUED, value.to_string())
}

/// Whether the defect is zero everywhere, exactly if the places of the nodes are; otherwise its value at some point, as text.
fn vanishes(definition: &Definition, is_exact: bool, defect: Expr) -> std::result::Result<(), String> {
    let d = definition.cell.dimension();
    // The sample is for the message, and decides only where coefficients or places are not rational.
    let sample = Quadrature::of_degree(definition.cell, 6);
    let (at, worst) = sample
        .points
        .chunks_exact(d)
        .map(|at| (at, defect.evaluate(at)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap_or((&[], 0.0));
    let holds = match Polynomial::expand(&defect, d) {
        Some(polynomial) if is_exact => polynomial.is_zero(),
        _ => worst.abs() <= ROUNDING,
    };
    if holds { Ok(()) } else { Err(format!("{worst:+.3e} at {at:.3?}")) }
}

/// The quadrature rule that is called `name` in the file.
pub fn quadrature(definition: &Definition, rule: &Rule, name: &str) -> Result<Quadrature> {
    let cell = definition.cell;
    let d = cell.dimension();
    let key = |rest: &str| format!("{name}.{rest}");
    let limited = |rest: &str, n: usize| {
        if (1..=MOST_POINTS).contains(&n) {
            Ok(())
        } else {
            Err(Error::expected(key(rest), format!("1 to {MOST_POINTS}"), n))
        }
    };
    let simplex = cell.is_simplex();
    match rule {
        Rule::GaussLegendre { points } if cell.is_box() => {
            limited("points", *points)?;
            Ok(Quadrature::gauss_legendre(d, *points))
        }
        Rule::GaussLegendre { .. } => {
            let expected = if simplex {
                "\"simplex\", \"degree\" or \"explicit\" on a simplex"
            } else {
                "\"degree\" or \"explicit\" on this cell"
            };
            Err(Error::expected(key("rule"), expected, "\"gauss-legendre\""))
        }
        Rule::Simplex { .. } if !simplex => {
            Err(Error::expected(key("rule"), "\"degree\" or \"explicit\" on this cell", "\"simplex\""))
        }
        Rule::Simplex { degree } | Rule::Degree { degree } => {
            limited("degree", *degree)?;
            Ok(Quadrature::of_degree(cell, *degree))
        }
        Rule::Explicit { points, weights } => {
            if points.is_empty() {
                return Err(Error::expected(key("points"), "at least one point", "none"));
            }
            if points.len() != weights.len() {
                let expected = format!("one weight for each of the {} points", points.len());
                return Err(Error::expected(key("weights"), expected, weights.len()));
            }
            if let Some(q) = points.iter().position(|p| p.len() != d) {
                let key = key(&format!("points[{q}]"));
                return Err(Error::expected(key, format!("{d} coordinates"), points[q].len()));
            }
            let rule = Quadrature {
                dimension: d,
                points: points.iter().flatten().map(Constant::value).collect(),
                weights: weights.iter().map(Constant::value).collect(),
            };
            let sum: f64 = rule.weights.iter().sum();
            // A rule that does not integrate one gives a wrong volume to every cell.
            if (sum - cell.content()).abs() > ROUNDING * cell.content() {
                let expected = format!("weights that sum to the cell's content {}", cell.content());
                return Err(Error::expected(key("weights"), expected, sum));
            }
            let at = |q: usize| &rule.points[q * d..(q + 1) * d];
            if let Some(q) = (0..points.len()).find(|q| !cell.contains(at(*q))) {
                return Err(Error::expected(
                    key(&format!("points[{q}]")),
                    "a point in the cell",
                    format!("{:?}", at(q)),
                ));
            }
            // Without them a linear displacement has not the energy that it must have.
            let (moments, found) = (Quadrature::of_degree(cell, 1).moments(), rule.moments());
            if moments.iter().zip(&found).any(|(a, b)| (a - b).abs() > DIGITS * cell.content()) {
                let expected = format!("a rule whose integrals of the coordinates are {moments:?}");
                return Err(Error::expected(key("points"), expected, format!("{found:?}")));
            }
            Ok(rule)
        }
    }
}

pub fn formats(definition: &Definition) -> Result<()> {
    let nodes = definition.nodes.len();
    let permutation = |entry: &Option<FormatEntry>, key: &str| {
        let Some(order) = entry.as_ref().and_then(|e| e.order.as_ref()) else { return Ok(()) };
        // Sorting shows a number that is missing, too large or there twice in one comparison.
        let mut sorted = order.clone();
        sorted.sort_unstable();
        if sorted.iter().copied().eq(0..nodes) {
            return Ok(());
        }
        let expected = format!("each of 0 to {} once", nodes - 1);
        Err(Error::expected(format!("formats.{key}.order"), expected, format!("{order:?}")))
    };
    permutation(&definition.formats.gmsh, "gmsh")?;
    permutation(&definition.formats.vtk, "vtk")
}

pub fn finite(tabulation: &Tabulation) -> Result<()> {
    let nodes = tabulation.nodes;
    let bad = |values: &[f64], per_node: usize| first_not_finite(values).map(|i| i / per_node);
    match bad(&tabulation.values, 1).or_else(|| bad(&tabulation.gradients, tabulation.dimension)) {
        Some(i) => {
            let key = format!("nodes[{}].shape", i % nodes);
            Err(Error::at(key, format!("has no finite value or gradient at quadrature point {}", i / nodes)))
        }
        None => Ok(()),
    }
}
