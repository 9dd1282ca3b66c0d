//! What an element file must satisfy before a number is computed from it. Identities of polynomials with rational
//! coefficients are decided exactly; those of other functions are sampled in floating point.

use super::constant::Constant;
use super::definition::{Definition, FormatEntry, Rule, SpringKind};
use super::quadrature::{MOST_POINTS, Quadrature};
use super::{SpringGroup, Tabulation};
use crate::error::{Error, Result};
use crate::symbolic::{Expr, Polynomial, Scope};
use num_rational::BigRational;
use num_traits::Zero;

const MOST_NODES: usize = 512;
/// Sampled identities hold to this; a few roundings of numbers of size one.
const ROUNDING: f64 = 1e-12;

pub fn coordinates(definition: &Definition) -> Result<()> {
    let d = definition.cell.dimension();
    if definition.coordinates.len() != d {
        let expected = format!("{d} names for a cell of dimension {d}");
        return Err(Error::expected("coordinates", expected, definition.coordinates.len()));
    }
    let mut scope = Scope::default();
    for (k, name) in definition.coordinates.iter().enumerate() {
        scope.define(name, "0").map_err(|e| Error::at(format!("coordinates[{k}]"), e.problem()))?;
    }
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

/// Kronecker property, partition of unity, linear completeness.
pub fn nodal(definition: &Definition, shapes: &[Expr]) -> Result<()> {
    for (a, shape) in shapes.iter().enumerate() {
        for (b, node) in definition.nodes.iter().enumerate() {
            let expected = i64::from(a == b);
            let (holds, found) = compare(shape, &node.at, expected);
            if !holds {
                let problem = format!("is {found} at nodes[{b}], expected {expected}");
                return Err(Error::at(format!("nodes[{a}].shape"), problem));
            }
        }
    }
    let minus_one = Expr::integer(-1);
    vanishes(definition, Expr::sum(shapes.iter().cloned().chain([minus_one])))
        .map_err(|found| Error::expected("nodes", "shape functions that sum to 1", format!("1 {found}")))?;
    for (k, name) in definition.coordinates.iter().enumerate() {
        let at = definition.nodes.iter().map(|n| number(&n.at[k]));
        let moments = shapes.iter().cloned().zip(at).map(|(n, x)| Expr::product([n, x]));
        let defect = Expr::sum(moments.chain([Expr::Variable(k).negated()]));
        vanishes(definition, defect).map_err(|found| {
            Error::expected("nodes", format!("shape functions that reproduce {name}"), format!("{name} {found}"))
        })?;
    }
    Ok(())
}

fn number(c: &Constant) -> Expr {
    let exact = c.exact().or_else(|| BigRational::from_float(c.value()));
    Expr::Number(exact.unwrap_or_else(BigRational::zero))
}

fn compare(shape: &Expr, at: &[Constant], expected: i64) -> (bool, String) {
    let exact: Option<Vec<BigRational>> = at.iter().map(Constant::exact).collect();
    if let Some(value) = exact.and_then(|at| shape.value(&at)) {
        return (value == BigRational::from_integer(expected.into()), value.to_string());
    }
    let value = shape.evaluate(&at.iter().map(Constant::value).collect::<Vec<_>>());
    ((value - expected as f64).abs() <= ROUNDING, value.to_string())
}

/// Whether the defect is zero everywhere; if not, its value somewhere, as text.
fn vanishes(definition: &Definition, defect: Expr) -> std::result::Result<(), String> {
    let d = definition.cell.dimension();
    let sample = Quadrature::of_degree(definition.cell, 6);
    let (at, worst) = sample
        .points
        .chunks_exact(d)
        .map(|at| (at, defect.evaluate(at)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap_or((&[], 0.0));
    let holds = match Polynomial::expand(&defect, d) {
        Some(polynomial) if definition.nodes.iter().all(|n| n.at.iter().all(|c| c.exact().is_some())) => {
            polynomial.is_zero()
        }
        _ => worst.abs() <= ROUNDING,
    };
    if holds { Ok(()) } else { Err(format!("{worst:+.3e} at {at:.3?}")) }
}

pub fn quadrature(definition: &Definition) -> Result<Quadrature> {
    let cell = definition.cell;
    let d = cell.dimension();
    let limited = |key: &str, n: usize| {
        if (1..=MOST_POINTS).contains(&n) {
            Ok(())
        } else {
            Err(Error::expected(format!("quadrature.{key}"), format!("1 to {MOST_POINTS}"), n))
        }
    };
    match &definition.quadrature {
        Rule::GaussLegendre { points } if !cell.is_simplex() => {
            limited("points", *points)?;
            Ok(Quadrature::gauss_legendre(d, *points))
        }
        Rule::GaussLegendre { .. } => {
            Err(Error::expected("quadrature.rule", "\"simplex\" or \"explicit\" on a simplex", "\"gauss-legendre\""))
        }
        Rule::Simplex { degree } if cell.is_simplex() => {
            limited("degree", *degree)?;
            Ok(Quadrature::of_degree(cell, *degree))
        }
        Rule::Simplex { .. } => {
            Err(Error::expected("quadrature.rule", "\"gauss-legendre\" or \"explicit\" on this cell", "\"simplex\""))
        }
        Rule::Explicit { points, weights } => {
            if points.is_empty() {
                return Err(Error::expected("quadrature.points", "at least one point", "none"));
            }
            if points.len() != weights.len() {
                let expected = format!("one weight for each of the {} points", points.len());
                return Err(Error::expected("quadrature.weights", expected, weights.len()));
            }
            if let Some(q) = points.iter().position(|p| p.len() != d) {
                let key = format!("quadrature.points[{q}]");
                return Err(Error::expected(key, format!("{d} coordinates"), points[q].len()));
            }
            let rule = Quadrature {
                dimension: d,
                points: points.iter().flatten().map(Constant::value).collect(),
                weights: weights.iter().map(Constant::value).collect(),
            };
            let sum: f64 = rule.weights.iter().sum();
            if (sum - cell.content()).abs() > ROUNDING * cell.content() {
                let expected = format!("weights that sum to the cell's content {}", cell.content());
                return Err(Error::expected("quadrature.weights", expected, sum));
            }
            Ok(rule)
        }
    }
}

pub fn springs(definition: &Definition) -> Result<Vec<SpringGroup>> {
    let nodes = definition.nodes.len();
    let mut groups: Vec<SpringGroup> = Vec::new();
    for (i, entry) in definition.springs.iter().enumerate() {
        let key = |rest: &str| format!("springs[{i}].{rest}");
        if groups.iter().any(|g| g.name == entry.group) {
            return Err(Error::expected(key("group"), "a name used once", format!("\"{}\" again", entry.group)));
        }
        let pairs = match (entry.kind, &entry.nodes) {
            (SpringKind::Length, Some(lists)) if !lists.is_empty() => node_pairs(i, lists)?,
            (SpringKind::Length, _) => return Err(Error::expected(key("nodes"), "pairs of nodes", "none")),
            (SpringKind::Area, None) if definition.cell.dimension() == 2 => Vec::new(),
            (SpringKind::Volume, None) if definition.cell.dimension() == 3 => Vec::new(),
            (SpringKind::Area, None) => {
                return Err(Error::expected(
                    key("kind"),
                    "\"volume\" in a solid, \"area\" in a plane cell",
                    "\"area\"",
                ));
            }
            (SpringKind::Volume, None) => {
                return Err(Error::expected(
                    key("kind"),
                    "\"area\" in a plane cell, \"volume\" in a solid",
                    "\"volume\"",
                ));
            }
            (_, Some(_)) => {
                return Err(Error::at(
                    key("nodes"),
                    "expected no nodes: an area or volume spring measures the whole cell",
                ));
            }
        };
        for (p, &[a, b]) in pairs.iter().enumerate() {
            let key = format!("springs[{i}].nodes[{p}]");
            if a.max(b) >= nodes || a == b {
                return Err(Error::expected(key, format!("two different nodes below {nodes}"), format!("[{a}, {b}]")));
            }
            let same = |&[c, d]: &[usize; 2]| (c, d) == (a, b) || (d, c) == (a, b);
            if groups.iter().flat_map(|g| &g.pairs).chain(&pairs[..p]).any(same) {
                return Err(Error::at(key, format!("the pair [{a}, {b}] has a spring already")));
            }
        }
        if pairs.is_empty() && groups.iter().any(|g| g.pairs.is_empty()) {
            return Err(Error::at(key("kind"), "the cell's content has a spring already"));
        }
        groups.push(SpringGroup { name: entry.group.clone(), kind: entry.kind, pairs, optional: entry.optional });
    }
    Ok(groups)
}

fn node_pairs(group: usize, lists: &[Vec<usize>]) -> Result<Vec<[usize; 2]>> {
    let pair = |(p, list): (usize, &Vec<usize>)| {
        <[usize; 2]>::try_from(list.as_slice())
            .map_err(|_| Error::expected(format!("springs[{group}].nodes[{p}]"), "two nodes", list.len()))
    };
    lists.iter().enumerate().map(pair).collect()
}

pub fn formats(definition: &Definition) -> Result<()> {
    let nodes = definition.nodes.len();
    let permutation = |entry: &Option<FormatEntry>, key: &str| {
        let Some(order) = entry.as_ref().and_then(|e| e.order.as_ref()) else { return Ok(()) };
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
    let bad = |values: &[f64], per_node: usize| values.iter().position(|v| !v.is_finite()).map(|i| i / per_node);
    match bad(&tabulation.values, 1).or_else(|| bad(&tabulation.gradients, tabulation.dimension)) {
        Some(i) => {
            let key = format!("nodes[{}].shape", i % nodes);
            Err(Error::at(key, format!("has no finite value or gradient at quadrature point {}", i / nodes)))
        }
        None => Ok(()),
    }
}
