//! How the forces of a network depend on its numbers: the constants and rest measures of its springs, and the points from which small
//! displacements are measured. With them one more solution with a factor that is there gives the gradient of a number that depends on the
//! displacements.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::network::{LengthSpring, MeasureSpring, Network, SpringLaw};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{LawJet, Measure, dot};
use crate::stiffness::{gather, gathered};

/// One number for each number of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkNumbers {
    /// Numbers of the constants, `[springs]`, springs on lengths first.
    pub constants: Vec<f64>,
    /// Numbers of the rest measures, `[springs]`.
    pub rests: Vec<f64>,
    /// Numbers of the points, `[points × dimension]`.
    pub points: Vec<f64>,
}

/// A spring on a length between its ends: `ℓ` and n of the edge d.
struct Edge {
    ends: [usize; 2],
    length: f64,
    n: [f64; 3],
}

impl Edge {
    fn of(spring: &LengthSpring, x: &[f64], d: usize) -> Edge {
        Edge::between(spring.points, x, d)
    }

    fn between(ends: [usize; 2], x: &[f64], d: usize) -> Edge {
        let [i, j] = ends;
        let mut n = [0.0; 3];
        n.iter_mut().zip(&x[j * d..(j + 1) * d]).zip(&x[i * d..(i + 1) * d]).for_each(|((n, b), a)| *n = b - a);
        let length = dot(&n, &n).sqrt();
        // A spring without a rest length has no direction where its ends meet, and needs none.
        n.iter_mut().for_each(|n| *n = if length > 0.0 { *n / length } else { 0.0 });
        Edge { ends, length, n }
    }

    /// The difference of two vectors of the points.
    fn change(&self, v: &[f64], d: usize) -> [f64; 3] {
        let [i, j] = self.ends;
        std::array::from_fn(|k| if k < d { v[j * d + k] - v[i * d + k] } else { 0.0 })
    }

    /// `(a·u − 3 n·a n·u) n + n·a u + n·u a`, by which the stiffness along u turns where the edge changes by a.
    fn turn(&self, a: &[f64; 3], u: &[f64; 3]) -> [f64; 3] {
        let (both, na, nu) = (dot(a, u), dot(&self.n, a), dot(&self.n, u));
        std::array::from_fn(|i| (both - 3.0 * na * nu) * self.n[i] + na * u[i] + nu * a[i])
    }

    fn add(&self, force: [f64; 3], to: &mut [f64], d: usize) {
        let [i, j] = self.ends;
        for (k, force) in force.into_iter().enumerate().take(d) {
            to[j * d + k] += force;
            to[i * d + k] -= force;
        }
    }
}

/// `M v` of a square matrix.
fn product(matrix: &[f64], v: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(v.len().max(1)).map(|row| dot(row, v)).collect()
}

impl Network {
    /// Checks that the derivatives of the springs in their numbers are known.
    ///
    /// # Errors
    /// A spring has a law of force that is a function, or that its constant does not scale, or, `of_points`, measures something else than a length
    /// or a content in a cell that fills its space; the kind is `Unsupported`.
    pub fn check_sensitivities(&self, of_points: bool) -> Result<()> {
        let refuse = |expected: &str, found: &str| {
            Err(Error::expected("network", expected, found).of_kind(ErrorKind::Unsupported))
        };
        for spring in &self.others {
            if let Some(SpringLaw { law, .. }) = spring.law.as_deref() {
                if law.is_function() {
                    return refuse("laws of force that are expressions, whose derivatives are known", &law.text);
                }
                // The force is in proportion to the constant: `T/k` would be 0/0, or not the derivative.
                if spring.constant == 0.0 || !law.outer().contains(&true) {
                    let expected = "laws of force with a slope at rest, in proportion to some of their parameters";
                    return refuse(expected, &format!("\"{}\" with the slope {:e}", law.text, spring.constant));
                }
            }
            let is_length = matches!(spring.measure, Measure::Length);
            if of_points && !is_length && degree(spring, self.dimension).is_none() {
                // The third derivatives of other measures are not known in closed form.
                return refuse("springs on lengths and on contents of cells that fill their space", spring.kind.name());
            }
        }
        Ok(())
    }

    /// The gradient of `aᵀ F(x)`, with the slopes F of the energy at positions x, in constants and rest measures; the points have none.
    ///
    /// With the force T of a spring, `∂F/∂k = (T/k) g` and `∂F/∂c₀ = (∂T/∂c₀) g`. The force of a law is in proportion to its constant, the
    /// slope at rest.
    pub fn force_sensitivities(&self, x: &[f64], a: &[f64]) -> NetworkNumbers {
        let d = self.dimension;
        let (mut found, mut gradient) = (self.nothing(0), Vec::new());
        for (s, spring) in self.lengths.iter().enumerate() {
            let edge = Edge::of(spring, x, d);
            let along = dot(&edge.n, &edge.change(a, d));
            found.constants[s] = (edge.length - spring.rest) * along;
            found.rests[s] = -spring.constant * along;
        }
        self.each_other(x, |s, spring, x| {
            let pull = Pull::of(spring, spring.measure.both(x, d, &mut gradient));
            let along = dot(&gradient, &gathered(a, d, &spring.points));
            found.constants[s] = pull.by_constant * along;
            found.rests[s] = pull.jet.by_rest * along;
        });
        found
    }

    /// The change of the slopes F of the energy at positions x with changes of constants and rest measures, `[points × dimension]`, N.
    pub fn force_change(&self, x: &[f64], change: &NetworkNumbers) -> Vec<f64> {
        let d = self.dimension;
        let (mut force, mut gradient) = (vec![0.0; x.len()], Vec::new());
        for (s, spring) in self.lengths.iter().enumerate() {
            let edge = Edge::of(spring, x, d);
            let pull = change.constants[s] * (edge.length - spring.rest) - spring.constant * change.rests[s];
            edge.add(edge.n.map(|n| pull * n), &mut force, d);
        }
        self.each_other(x, |s, spring, x| {
            let of = Pull::of(spring, spring.measure.both(x, d, &mut gradient));
            let pull = change.constants[s] * of.by_constant + of.jet.by_rest * change.rests[s];
            add(spring, gradient.iter().map(|g| pull * g), &mut force, d);
        });
        force
    }

    /// The gradient of `aᵀ K(x) u`, with the tangent K at positions x, in constants, rest measures and x.
    ///
    /// A length with the edge d = ℓ n has `K = k ((1 − L/ℓ) I + (L/ℓ) n nᵀ)`; another measure `K = T' g gᵀ + T H` with its force T, which is
    /// `k (c − c₀)` or a law; its third derivatives are known of lengths and contents.
    pub fn stiffness_sensitivities(&self, x: &[f64], a: &[f64], u: &[f64]) -> NetworkNumbers {
        let d = self.dimension;
        let mut found = self.nothing(x.len());
        for (s, spring) in self.lengths.iter().enumerate() {
            let edge = Edge::of(spring, x, d);
            let (a, u, k) = (edge.change(a, d), edge.change(u, d), spring.constant);
            let (both, na, nu) = (dot(&a, &u), dot(&edge.n, &a), dot(&edge.n, &u));
            // Without a rest length `K = k I` in any direction, and the quotients below would be 0/0.
            if spring.rest == 0.0 && edge.length == 0.0 {
                found.constants[s] = both;
                continue;
            }
            let share = spring.rest / edge.length;
            found.constants[s] = (1.0 - share) * both + share * na * nu;
            found.rests[s] = k / edge.length * (na * nu - both);
            let turn = k * share / edge.length;
            edge.add(edge.turn(&a, &u).map(|t| turn * t), &mut found.points, d);
        }
        let (mut points, mut constants, mut rests) = (found.points, found.constants, found.rests);
        self.each_other(x, |s, spring, x| {
            let jet = spring.measure.jet(x, d);
            let pull = Pull::of(spring, jet.value);
            let LawJet { force, slope, curvature, by_rest, slope_by_rest } = pull.jet;
            let (a, u) = (gathered(a, d, &spring.points), gathered(u, d, &spring.points));
            let (ga, gu) = (dot(&jet.gradient, &a), dot(&jet.gradient, &u));
            let (ha, hu) = (product(&jet.hessian, &a), product(&jet.hessian, &u));
            let bent = dot(&ha, &u);
            constants[s] = pull.slope_by_constant * ga * gu + pull.by_constant * bent;
            rests[s] = slope_by_rest * ga * gu + by_rest * bent;
            let third = third(spring, x, &a, &u, d);
            // The product rule: the derivative of g is H, that of c is g, and that of H is the third derivative of c.
            let along = |i: usize| {
                curvature * jet.gradient[i] * ga * gu
                    + slope * (ha[i] * gu + hu[i] * ga + jet.gradient[i] * bent)
                    + force * third[i]
            };
            add(spring, (0..a.len()).map(along), &mut points, d);
        });
        NetworkNumbers { constants, rests, points }
    }

    /// The change of `K(x) u` with changes of constants, rest measures and x, `[points × dimension]`, N.
    pub fn stiffness_change(&self, x: &[f64], u: &[f64], change: &NetworkNumbers) -> Vec<f64> {
        let d = self.dimension;
        let mut force = vec![0.0; x.len()];
        for (s, spring) in self.lengths.iter().enumerate() {
            let edge = Edge::of(spring, x, d);
            let (b, u, k) = (edge.change(&change.points, d), edge.change(u, d), spring.constant);
            if spring.rest == 0.0 && edge.length == 0.0 {
                edge.add(u.map(|u| change.constants[s] * u), &mut force, d);
                continue;
            }
            let nu = dot(&edge.n, &u);
            let share = spring.rest / edge.length;
            let (own, of_rest, turn) =
                (change.constants[s], k * change.rests[s] / edge.length, k * share / edge.length);
            let turned = edge.turn(&b, &u);
            let along = |i: usize| {
                own * ((1.0 - share) * u[i] + share * nu * edge.n[i])
                    + of_rest * (nu * edge.n[i] - u[i])
                    + turn * turned[i]
            };
            edge.add(std::array::from_fn(along), &mut force, d);
        }
        self.each_other(x, |s, spring, x| {
            let jet = spring.measure.jet(x, d);
            let pull = Pull::of(spring, jet.value);
            let LawJet { force: tension, slope, curvature, by_rest, slope_by_rest } = pull.jet;
            let (b, u) = (gathered(&change.points, d, &spring.points), gathered(u, d, &spring.points));
            let (gb, gu) = (dot(&jet.gradient, &b), dot(&jet.gradient, &u));
            let (hb, hu) = (product(&jet.hessian, &b), product(&jet.hessian, &u));
            let bent = dot(&hb, &u);
            let third = third(spring, x, &b, &u, d);
            let (of_constant, of_rest) = (change.constants[s], change.rests[s]);
            // The changes of the slope and of the force.
            let steeper = of_constant * pull.slope_by_constant + of_rest * slope_by_rest + curvature * gb;
            let stronger = of_constant * pull.by_constant + of_rest * by_rest + slope * gb;
            let along = |i: usize| {
                steeper * gu * jet.gradient[i]
                    + stronger * hu[i]
                    + slope * (hb[i] * gu + jet.gradient[i] * bent)
                    + tension * third[i]
            };
            add(spring, (0..b.len()).map(along), &mut force, d);
        });
        force
    }

    fn nothing(&self, points: usize) -> NetworkNumbers {
        let of_springs = || vec![0.0; self.len()];
        NetworkNumbers { constants: of_springs(), rests: of_springs(), points: vec![0.0; points] }
    }

    /// Calls `visit(s, spring, x)` with the number of each other spring and the positions of its points.
    fn each_other(&self, x: &[f64], mut visit: impl FnMut(usize, &MeasureSpring, &[f64])) {
        let mut own = Vec::new();
        for (s, spring) in (self.lengths.len()..).zip(&self.others) {
            own.resize(spring.points.len() * self.dimension, 0.0);
            gather(x, self.dimension, &spring.points, &mut own);
            visit(s, spring, &own);
        }
    }
}

fn add(spring: &MeasureSpring, force: impl Iterator<Item = f64>, to: &mut [f64], d: usize) {
    let places = spring.points.iter().flat_map(|p| p * d..(p + 1) * d);
    places.zip(force).for_each(|(place, force)| to[place] += force);
}

/// The force of a spring, and how it depends on its numbers.
struct Pull {
    jet: LawJet,
    /// `∂T/∂k`.
    by_constant: f64,
    /// `∂²T/∂c∂k`.
    slope_by_constant: f64,
}

impl Pull {
    /// Evaluates the force of a spring that measures c.
    fn of(spring: &MeasureSpring, c: f64) -> Pull {
        let (k, past) = (spring.constant, c - spring.rest);
        let of_law = |own: &SpringLaw| own.law.jet(c, spring.rest, &own.parameters);
        match spring.law.as_deref().and_then(of_law) {
            Some(jet) => Pull { jet, by_constant: jet.force / k, slope_by_constant: jet.slope / k },
            None => {
                let jet = LawJet { force: k * past, slope: k, curvature: 0.0, by_rest: -k, slope_by_rest: 0.0 };
                Pull { jet, by_constant: past, slope_by_constant: 1.0 }
            }
        }
    }
}

/// The degree of a measure that is a polynomial of the positions.
fn degree(spring: &MeasureSpring, d: usize) -> Option<usize> {
    let of = |element: &Element| (element.dimension() == d).then_some(d);
    match &spring.measure {
        Measure::Content(element) | Measure::PointContent(element, _) => of(element),
        Measure::Length
        | Measure::Span(_)
        | Measure::Patch(_)
        | Measure::Turns(_)
        | Measure::Squares(_)
        | Measure::Function(_) => None,
    }
}

/// `Σ_jl (∂³c/∂x_i∂x_j∂x_l) a_j u_l` at the positions x: of a length `−t/ℓ²` with t of [`Edge::turn`]. A content in three dimensions is a
/// homogeneous polynomial of degree three, so that its second derivatives at a are their changes along a; in less dimensions they do not change.
fn third(spring: &MeasureSpring, x: &[f64], a: &[f64], u: &[f64], d: usize) -> Vec<f64> {
    if let Measure::Length = spring.measure {
        let edge = Edge::between([0, 1], x, d);
        let (a, u) = (edge.change(a, d), edge.change(u, d));
        let mut found = vec![0.0; x.len()];
        edge.add(edge.turn(&a, &u).map(|t| -t / (edge.length * edge.length)), &mut found, d);
        return found;
    }
    match degree(spring, d) {
        // The content at a point is a determinant of sums of positions, a polynomial of degree 3 in space. Its second
        // derivatives are linear in the positions, so that their change along a is their value at a. In the plane they
        // are constant.
        Some(3) => product(&spring.measure.jet(a, d).hessian, u),
        _ => vec![0.0; a.len()],
    }
}
