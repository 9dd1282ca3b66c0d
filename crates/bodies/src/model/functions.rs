//! Springs whose laws of force are functions of the program: each law is asked once for all of its springs.

use super::network::{MeasureSpring, SpringLaw};
use crate::springs::{AskedForces, Law};
use crate::stiffness::gather;
use std::sync::Arc;

/// The forces of those of the springs whose laws are functions, in their order, with the points at x, `[points · dimension]`, m.
pub fn function_tensions<'a>(springs: impl Iterator<Item = &'a MeasureSpring>, x: &[f64], d: usize) -> Vec<f64> {
    asked(springs, x, d, |law, asked| law.forces_of_all(asked))
}

/// Energy, force and slope of these springs.
pub fn function_pulls<'a>(springs: impl Iterator<Item = &'a MeasureSpring>, x: &[f64], d: usize) -> Vec<[f64; 3]> {
    asked(springs, x, d, |law, asked| law.pulls_of_all(asked))
}

fn asked<'a, T: Copy + Default>(
    springs: impl Iterator<Item = &'a MeasureSpring>,
    x: &[f64],
    d: usize,
    answer: impl Fn(&Law, &[AskedForces]) -> Vec<T>,
) -> Vec<T> {
    let mut local = Vec::new();
    let mut measure = |spring: &MeasureSpring| {
        local.resize(spring.points.len() * d, 0.0);
        gather(x, d, &spring.points, &mut local);
        spring.measure.value(&local, d)
    };
    let own: Vec<(&SpringLaw, f64, f64)> =
        springs.filter_map(|spring| Some((spring.function()?, measure(spring), spring.rest))).collect();
    let mut all = vec![T::default(); own.len()];
    let mut laws: Vec<(&Arc<Law>, Vec<usize>)> = Vec::new();
    for (place, (of, ..)) in own.iter().enumerate() {
        // Bodies have few laws, so that a search through all is quick; functions cannot be compared but by where they
        // are.
        match laws.iter_mut().find(|(law, _)| Arc::ptr_eq(law, &of.law)) {
            Some((_, places)) => places.push(place),
            None => laws.push((&of.law, vec![place])),
        }
    }
    for (law, places) in laws {
        let one = |place: &usize| {
            let (of, c, rest) = &own[*place];
            AskedForces { c: std::slice::from_ref(c), rest: *rest, parameters: of.parameters.to_vec() }
        };
        let asked: Vec<AskedForces> = places.iter().map(one).collect();
        places.iter().zip(answer(law, &asked)).for_each(|(&place, found)| all[place] = found);
    }
    all
}
