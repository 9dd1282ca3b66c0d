//! The response of the network of a cell at given positions, as code: what each spring measures, the energy
//! `Σ_s ½ k_s (c_s − c₀_s)²`, and the forces `−Σ_s k_s (c_s − c₀_s) ∇c_s`.

use super::expression;
use super::{Cell, Index, Role, Room, Value, dot};
use crate::springs::FunctionSpring;
use std::collections::BTreeMap;

impl Cell<'_> {
    /// What a spring on a function measures, and its gradient in the positions of all nodes, `[nodes × dimension]`.
    pub fn function(&self, spring: &FunctionSpring) -> (Value, Vec<Value>) {
        let d = self.dimension();
        let places: Vec<usize> = spring.nodes.iter().flat_map(|a| a * d..(a + 1) * d).collect();
        let at: Vec<Value> = places.iter().map(|&place| self.x[place].clone()).collect();
        let any = &self.x[0];
        let mut gradient = vec![any.like(0.0); self.x.len()];
        for (variable, &place) in places.iter().enumerate() {
            // Added, because a coupling may name a node twice.
            let slope = expression::value(&spring.function.derivative(variable), &at, any);
            gradient[place] = &gradient[place] + &slope;
        }
        (expression::value(&spring.function, &at, any), gradient)
    }

    /// What the springs measure at the positions: calls `visit(s, c)` for each.
    pub fn each_measure(&self, mut visit: impl FnMut(&Index, &Value)) {
        let springs = self.springs;
        self.each_length(|s, i, j| {
            let edge = self.edge(i, j);
            visit(s, &dot(&edge, &edge).root());
        });
        for (s, function) in (springs.pairs().len()..).zip(springs.functions()) {
            visit(&s.into(), &self.function(function).0);
        }
        if springs.content().is_some() {
            visit(&(springs.len() - 1).into(), &self.content(false).0);
        }
    }

    /// The springs on contents at quadrature points: calls `visit(s, c, ∇c)` for each.
    fn each_point_spring(&self, mut visit: impl FnMut(&Index, &Value, &[Value])) {
        let (points, first) = (self.springs.points(), self.springs.pairs().len());
        // Without such springs the loop over the points would be code that does nothing.
        if points.is_empty() {
            return;
        }
        self.each_content(|q, content, gradient| {
            let place = match q.number() {
                Some(q) => points.iter().position(|p| *p == q).map(Index::from),
                None => Some(q.clone()),
            };
            if let Some(place) = place {
                visit(&(&place + first), content, gradient);
            }
        });
    }
}

/// The arrays of constants and rest measures of a function.
fn given(cell: &Cell) -> [usize; 2] {
    ["constants", "rests"].map(|name| cell.body.array(name, cell.springs.len(), Role::Input))
}

/// Writes the energy of the network; with `is_exact` length springs have the rest length zero.
pub fn energy(cell: &Cell, is_exact: bool) -> Value {
    let (body, plan) = (&cell.body, cell.plan);
    let [constants, rests] = given(cell);
    let half = body.number(0.5);
    let mut sum = Room::new(body, "sum", 1, !(plan.points && plan.springs));
    let energy = |s: &Index, measure: &Value| {
        let change = measure - &body.entry(rests, s);
        &(&body.entry(constants, s) * &half) * &(&change * &change)
    };
    if is_exact {
        cell.each_length(|s, i, j| {
            let edge = cell.edge(i, j);
            sum.add(body, 0, &(&(&body.entry(constants, s) * &half) * &dot(&edge, &edge)));
        });
        cell.each_point_spring(|s, content, _| sum.add(body, 0, &energy(s, content)));
        if cell.springs.content().is_some() {
            let last = (cell.springs.len() - 1).into();
            sum.add(body, 0, &energy(&last, &cell.content(false).0));
        }
    } else {
        cell.each_measure(|s, measure| sum.add(body, 0, &energy(s, measure)));
    }
    sum.get(body, 0)
}

/// Writes the forces on the nodes into the array `forces`, `[nodes × dimension]`.
pub fn forces(cell: &Cell, is_exact: bool) {
    let (body, plan, d) = (&cell.body, cell.plan, cell.dimension());
    let [constants, rests] = given(cell);
    let forces = body.array("forces", cell.x.len(), Role::Output);
    let zero = body.number(0.0);
    let is_array = !(plan.points && plan.springs);
    let mut sums = if is_array {
        body.each(false, 0, cell.x.len(), |i| body.store(forces, i, &zero));
        Room::Array(forces)
    } else {
        Room::new(body, "forces_of_cell", cell.x.len(), false)
    };
    let tension = |s: &Index, measure: &Value| &body.entry(constants, s) * &(measure - &body.entry(rests, s));
    let pull = |sums: &mut Room, tension: &Value, gradient: &[Value]| {
        // Slopes that are known to be zero would be lines that add nothing.
        let at = gradient.iter().enumerate().filter(|(_, slope)| slope.as_number() != Some(0.0));
        at.for_each(|(i, slope)| sums.add(body, i, &(tension * slope).negated()));
    };
    // Of length springs that share a node in unrolled code the sums are made in one step each.
    let mut shares: BTreeMap<usize, Value> = BTreeMap::new();
    cell.each_length(|s, i, j| {
        let edge = cell.edge(i, j);
        let factor = if is_exact {
            body.entry(constants, s)
        } else {
            // A spring of no length has no direction.
            let length = dot(&edge, &edge).root();
            length.select(&zero, &(&tension(s, &length) / &length), &zero)
        };
        for (k, e) in edge.iter().enumerate() {
            let share = &factor * e;
            for (node, share) in [(i, share.clone()), (j, share.negated())] {
                let place = &(node * d) + k;
                match place.number() {
                    Some(place) => {
                        let sum = shares.get(&place).map_or_else(|| share.clone(), |sum| sum + &share);
                        shares.insert(place, sum);
                    }
                    None => sums.add(body, place, &share),
                }
            }
        }
    });
    shares.iter().for_each(|(place, share)| sums.add(body, *place, share));
    for (s, function) in (cell.springs.pairs().len()..).zip(cell.springs.functions()) {
        let (measure, gradient) = cell.function(function);
        let tension = tension(&s.into(), &measure);
        pull(&mut sums, &tension, &gradient);
    }
    cell.each_point_spring(|s, content, gradient| pull(&mut sums, &tension(s, content), gradient));
    if cell.springs.content().is_some() {
        let (content, gradient) = cell.content(true);
        let last: Index = (cell.springs.len() - 1).into();
        pull(&mut sums, &tension(&last, &content), &gradient);
    }
    if let Room::Values(values) = &sums {
        values.iter().enumerate().for_each(|(i, force)| body.store(forces, i, force));
    }
}
