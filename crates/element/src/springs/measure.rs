//! What a spring measures, c(x), with its first and second derivatives, from which its force and tangent follow.

use super::content::Content;
use super::patch::Patch;
use super::squares::Squares;
use super::turns::Turns;
use crate::element::{Element, Formula, SpringKind, Tabulation, dot};
use crate::error::{Error, ErrorKind, Result};
use crate::symbolic::{Compiled, Expr, Jet};
use std::sync::Arc;

/// One number c that depends on the positions of some points.
#[derive(Debug, Clone)]
pub enum Measure {
    /// The distance of two points, in m.
    Length,
    /// The area (m²) or volume (m³) of a cell, by its quadrature.
    Content(Arc<Element>),
    /// The part of the content that belongs to one quadrature point, `w |J|`, by its index. The index has 32 bits, so that a measure, of
    /// which each spring of a body has one, is of two words.
    PointContent(Arc<Element>, u32),
    /// The length or area that one tangent or two tangents span at the single point of this table.
    Span(Arc<Tabulation>),
    /// A weighted sum of the contents of the cells of a patch.
    Patch(Arc<Patch>),
    /// A weighted sum of turns of triangles about their edges; behind a pointer, so that a measure is of two words.
    Turns(Box<Turns>),
    /// A weighted sum of squared distances, behind a pointer as well.
    Squares(Box<Squares>),
    /// A function of the coordinates of the points, in the order x₀, y₀, (z₀,) x₁, …
    Function(Arc<Compiled>),
}

/// Energy, force and tangent of a spring at given positions.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SpringResponse {
    /// The energy U, in J; `½ k (c − c₀)²` for a linear spring.
    pub energy: f64,
    /// The forces on its points, `−T ∇c`, `[points × dimension]`, N; `T = k (c − c₀)` for a linear spring.
    pub force: Vec<f64>,
    /// The tangent `T' ∇c ∇cᵀ + T ∇∇c`, `[points·dimension × points·dimension]`, N/m.
    pub tangent: Vec<f64>,
}

impl Measure {
    /// The function that a kind measures on `nodes` points with `dimension` coordinates, for kinds that have a formula.
    ///
    /// # Errors
    /// The kind has no formula for so many points.
    pub fn of_kind(kind: SpringKind, nodes: usize, dimension: usize) -> Result<Expr> {
        let properties = kind.properties();
        let is_possible = properties.nodes.contains(&nodes) && (properties.least_dimension..=3).contains(&dimension);
        let Some(text) = properties.formula.filter(|_| is_possible) else {
            let problem = format!("no {} of {nodes} nodes in {dimension} dimensions is known", kind.name());
            return Err(Error::new(problem).of_kind(ErrorKind::Unsupported));
        };
        let formula = Formula::new(nodes, dimension);
        formula.expression(&text(&formula))
    }

    /// The sum of the squared distances of the points 0-1, 2-3, …, in m².
    ///
    /// # Errors
    /// Those of an expression.
    pub fn squared_lengths(pairs: usize, dimension: usize) -> Result<Expr> {
        let formula = Formula::new(2 * pairs, dimension);
        let square = |pair: usize| {
            let u = formula.vector(2 * pair, 2 * pair + 1);
            dot(&u, &u)
        };
        formula.expression(&(0..pairs).map(square).collect::<Vec<_>>().join(" + "))
    }

    /// The distance between the centres of the first `side` points and of the next `side` points, in m.
    ///
    /// # Errors
    /// Those of an expression.
    pub fn extent(side: usize, dimension: usize) -> Result<Expr> {
        let formula = Formula::new(2 * side, dimension);
        let between: Vec<Vec<String>> = (0..side).map(|i| formula.vector(i, side + i)).collect();
        let mean = |k: usize| {
            let sum = between.iter().map(|u| u[k].clone()).collect::<Vec<_>>().join(" + ");
            format!("(({sum})/{side})")
        };
        let u: Vec<String> = (0..dimension).map(mean).collect();
        formula.expression(&format!("sqrt({})", dot(&u, &u)))
    }

    /// c and its first and second derivatives at the positions `x`, `[points × dimension]`, m.
    pub fn jet(&self, x: &[f64], dimension: usize) -> Jet {
        match self {
            Measure::Length => length(x, dimension),
            Measure::Content(element) => Content::of_cell(&element.tabulation, x).jet(),
            Measure::PointContent(element, q) => Content::of_point(&element.tabulation, *q as usize, x).jet(),
            Measure::Span(table) => Content::of_point(table, 0, x).jet(),
            Measure::Patch(patch) => patch.jet(x, dimension),
            Measure::Turns(turns) => turns.jet(x),
            Measure::Squares(squares) => squares.jet(x, dimension),
            Measure::Function(function) => function.program().jet(x, x.len()),
        }
    }

    /// c at the positions `x`, `[points × dimension]`, m.
    pub fn value(&self, x: &[f64], dimension: usize) -> f64 {
        match self {
            Measure::Length => super::distance(&x[..dimension], &x[dimension..]),
            Measure::Content(element) => Content::of_cell(&element.tabulation, x).value(),
            Measure::PointContent(element, q) => Content::of_point(&element.tabulation, *q as usize, x).value(),
            Measure::Span(table) => Content::of_point(table, 0, x).value(),
            Measure::Patch(patch) => patch.value(x, dimension),
            Measure::Turns(turns) => turns.value(x),
            Measure::Squares(squares) => squares.value(x, dimension),
            Measure::Function(function) => function.evaluate(x),
        }
    }

    /// The gradient `∇c` at the positions `x`, `[points × dimension]`.
    pub fn gradient(&self, x: &[f64], dimension: usize) -> Vec<f64> {
        match self {
            Measure::Function(function) => function.program().gradient(x).1,
            Measure::Length => self.jet(x, dimension).gradient,
            Measure::Content(element) => Content::of_cell(&element.tabulation, x).gradient(),
            Measure::PointContent(element, q) => Content::of_point(&element.tabulation, *q as usize, x).gradient(),
            Measure::Span(table) => Content::of_point(table, 0, x).gradient(),
            Measure::Patch(patch) => patch.gradient(x, dimension),
            Measure::Turns(turns) => turns.gradient(x),
            Measure::Squares(squares) => squares.gradient(x, dimension),
        }
    }

    /// c and its gradient at the positions `x`, as [`Measure::value`] and [`Measure::gradient`] give them; the gradient is written into the list,
    /// whose memory serves many springs.
    pub fn both(&self, x: &[f64], dimension: usize, gradient: &mut Vec<f64>) -> f64 {
        gradient.resize(x.len(), 0.0);
        match self {
            Measure::Content(element) => Content::of_cell(&element.tabulation, x).both(gradient),
            Measure::PointContent(element, q) => Content::of_point(&element.tabulation, *q as usize, x).both(gradient),
            Measure::Span(table) => Content::of_point(table, 0, x).both(gradient),
            Measure::Function(function) => {
                let (value, slopes) = function.program().gradient(x);
                *gradient = slopes;
                value
            }
            Measure::Length | Measure::Patch(_) | Measure::Turns(_) | Measure::Squares(_) => {
                *gradient = self.gradient(x, dimension);
                self.value(x, dimension)
            }
        }
    }

    /// The response of a linear spring with this constant and rest measure at the positions `x`,
    /// `[points × dimension]`, m.
    pub fn respond(&self, constant: f64, rest: f64, x: &[f64], dimension: usize) -> SpringResponse {
        self.respond_by(|c| linear(constant, c - rest), x, dimension)
    }

    /// The response of a spring whose energy U, force `T = U'` and slope `T'` are `law(c)`.
    pub fn respond_by(&self, law: impl Fn(f64) -> [f64; 3], x: &[f64], dimension: usize) -> SpringResponse {
        let Jet { value, gradient, hessian } = self.jet(x, dimension);
        let n = gradient.len();
        let [energy, pull, slope] = law(value);
        // The second derivative of `U(c(x))` by the chain rule: `U'' ∇c ∇cᵀ + U' ∇∇c`.
        let entry = |(i, h): (usize, f64)| slope * gradient[i / n] * gradient[i % n] + pull * h;
        SpringResponse {
            energy,
            force: gradient.iter().map(|g| -pull * g).collect(),
            tangent: hessian.into_iter().enumerate().map(entry).collect(),
        }
    }
}

/// Energy, force and slope of a linear spring: `½ k x²`, `k x`, `k`.
pub fn linear(constant: f64, change: f64) -> [f64; 3] {
    [constant * change * change / 2.0, constant * change, constant]
}

/// The distance of two points: `ℓ = ‖d‖`, `∇ℓ = (−n, n)`, `∇∇ℓ = ±(I − n nᵀ)/ℓ`.
fn length(x: &[f64], d: usize) -> Jet {
    let (a, b) = x.split_at(d);
    let value = super::distance(a, b);
    let n: Vec<f64> = a.iter().zip(b).map(|(a, b)| (b - a) / value).collect();
    let gradient = n.iter().map(|n| -n).chain(n.iter().copied()).collect();
    let mut hessian = vec![0.0; 4 * d * d];
    for (row, column) in (0..d).flat_map(|row| (0..d).map(move |column| (row, column))) {
        let identity = f64::from(u8::from(row == column));
        let entry = (identity - n[row] * n[column]) / value;
        for (first, second, entry) in [(0, 0, entry), (0, d, -entry), (d, 0, -entry), (d, d, entry)] {
            hessian[(first + row) * 2 * d + second + column] = entry;
        }
    }
    Jet { value, gradient, hessian }
}
