//! Formulas of what springs measure, as texts in the coordinates of their nodes.

use crate::error::Result;
use crate::symbolic::{Expr, Scope};

/// Builds formulas in the coordinates of some points.
pub struct Formula {
    names: Vec<String>,
    scope: Scope,
    nodes: usize,
    dimension: usize,
}

impl Formula {
    pub fn new(nodes: usize, dimension: usize) -> Formula {
        let names = coordinate_names(nodes, dimension);
        Formula { scope: Scope::new(&names), names, nodes, dimension }
    }

    /// Parses a formula.
    ///
    /// # Errors
    /// Those of an expression.
    pub fn expression(&self, text: &str) -> Result<Expr> {
        self.scope.expression(text)
    }

    /// The vector from point a to point b.
    pub fn vector(&self, a: usize, b: usize) -> Vec<String> {
        let name = |point: usize, k: usize| &self.names[point * self.dimension + k];
        (0..self.dimension).map(|k| format!("({} - {})", name(b, k), name(a, k))).collect()
    }

    pub fn distance(&self, a: usize, b: usize) -> String {
        let u = self.vector(a, b);
        format!("sqrt({})", dot(&u, &u))
    }

    /// `θ = 2 atan(|u × v|/(|u||v| + u·v))`, the angle at the second of three points. It is accurate at every angle
    /// (Kahan 2006).
    pub fn angle(&self) -> String {
        let (u, v) = (self.vector(1, 0), self.vector(1, 2));
        let across: Vec<String> = cross(&u, &v);
        let (uu, vv, uv) = (dot(&u, &u), dot(&v, &v), dot(&u, &v));
        format!("2*atan(sqrt({})/(sqrt(({uu})*({vv})) + {uv}))", dot(&across, &across))
    }

    /// Half the sum of the cross products of the fan from the first point; in space the length of that vector.
    pub fn area(&self) -> String {
        let fan = |i: usize| cross(&self.vector(0, i), &self.vector(0, i + 1));
        let parts: Vec<Vec<String>> = (1..self.nodes - 1).map(fan).collect();
        let sum = |k: usize| parts.iter().map(|p| p[k].clone()).collect::<Vec<_>>().join(" + ");
        if self.dimension == 2 {
            return format!("({})/2", sum(0));
        }
        format!("sqrt(({})^2 + ({})^2 + ({})^2)/2", sum(0), sum(1), sum(2))
    }

    pub fn volume(&self) -> String {
        format!("({})/6", dot(&self.vector(0, 1), &cross(&self.vector(0, 2), &self.vector(0, 3))))
    }
}

/// `u · v`.
pub fn dot(u: &[String], v: &[String]) -> String {
    u.iter().zip(v).map(|(a, b)| format!("{a}*{b}")).collect::<Vec<_>>().join(" + ")
}

/// The cross product; in the plane its single component.
fn cross(u: &[String], v: &[String]) -> Vec<String> {
    let part = |k: usize, l: usize| format!("({}*{} - {}*{})", u[k], v[l], u[l], v[k]);
    if u.len() == 2 { vec![part(0, 1)] } else { vec![part(1, 2), part(2, 0), part(0, 1)] }
}

/// The names of the coordinates of some nodes: `x0, y0, z0, x1, …`.
pub fn coordinate_names(nodes: usize, dimension: usize) -> Vec<String> {
    let axes = &["x", "y", "z"][..dimension];
    (0..nodes).flat_map(|a| axes.iter().map(move |axis| format!("{axis}{a}"))).collect()
}
