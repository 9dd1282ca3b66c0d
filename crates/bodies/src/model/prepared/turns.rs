//! Springs on weighted sums of turns of triangles about their edges. Those of one triangle share its turns. They are evaluated in `f64`, whatever the numbers of the
//! positions are.
//!
//! With the tensions `T_m = k_m (Σ_i w_mi a_i − c_m⁰)` a turn pulls with `Σ_m T_m w_mi ∇a_i`.

use crate::model::network::{MeasureSpring, Network};
use crate::scalar::Coordinate;
use crate::springs::{Measure, Turns};

/// The most turns, and the most springs, that are evaluated together: those of a triangle.
const TOGETHER: usize = 3;

/// Up to three springs on up to three turns; unused entries have weights of zero.
#[derive(Debug, Clone, Copy)]
struct Fold {
    /// The rows of the apex, of both ends of the edge and of the director.
    turns: [[u32; 4]; TOGETHER],
    turn_count: usize,
    /// `[turns][springs]`.
    weights: [[f64; TOGETHER]; TOGETHER],
    constants: [f64; TOGETHER],
    rests: [f64; TOGETHER],
    spring_count: usize,
}

/// The turns of a part.
#[derive(Debug)]
pub struct Folds {
    all: Vec<Fold>,
    /// What one turn measures.
    turn: Measure,
}

impl Folds {
    /// The turns of these springs, which follow each other where they are those of one triangle.
    pub fn new(network: &Network, springs: &[usize], place: &[usize]) -> Folds {
        let mut all: Vec<Fold> = Vec::new();
        for &s in springs {
            let spring = &network.others[s];
            let Measure::Turns(turns) = &spring.measure else { continue };
            if !all.last_mut().is_some_and(|last| last.add(spring, turns, place)) {
                let mut fold = Fold {
                    turns: [[0; 4]; TOGETHER],
                    turn_count: 0,
                    weights: [[0.0; TOGETHER]; TOGETHER],
                    constants: [0.0; TOGETHER],
                    rests: [0.0; TOGETHER],
                    spring_count: 0,
                };
                fold.add(spring, turns, place);
                all.push(fold);
            }
        }
        Folds { all, turn: Measure::Turns(Box::new(Turns::of_hinge())) }
    }

    /// Adds the forces of the rows, as (z, x, y); false if a spring has none.
    pub fn pull<N: Coordinate>(&self, x: &[[N; 4]], force: &mut [[N; 4]]) -> bool {
        let mut sound = true;
        for fold in &self.all {
            let places = fold
                .turns
                .map(|rows| rows.map(|row| -> [f64; 3] { std::array::from_fn(|k| x[row as usize][k].wide()) }));
            let turns: [f64; TOGETHER] = std::array::from_fn(|i| match i < fold.turn_count {
                // Turns are evaluated in double precision also where positions are single: an angle is a quotient of
                // small differences.
                true => self.turn.value(places[i].as_flattened(), 3),
                false => 0.0,
            });
            let tension = |m: usize| {
                let measure: f64 = (0..TOGETHER).map(|i| fold.weights[i][m] * turns[i]).sum();
                fold.constants[m] * (measure - fold.rests[m])
            };
            let tensions: [f64; TOGETHER] = std::array::from_fn(tension);
            for i in 0..fold.turn_count {
                let pull: f64 = (0..TOGETHER).map(|m| tensions[m] * fold.weights[i][m]).sum();
                sound &= pull.is_finite();
                let gradient = self.turn.gradient(places[i].as_flattened(), 3);
                for (row, gradient) in fold.turns[i].into_iter().zip(gradient.chunks_exact(3)) {
                    let sum = &mut force[row as usize];
                    (0..3).for_each(|k| sum[(k + 1) % 3] = sum[(k + 1) % 3] + N::of(pull * gradient[k]));
                }
            }
        }
        sound
    }
}

impl Fold {
    /// Adds a spring; false if there is no room for it or its turns.
    fn add(&mut self, spring: &MeasureSpring, turns: &Turns, place: &[usize]) -> bool {
        if self.spring_count == TOGETHER {
            return false;
        }
        // Changed in a copy: a spring without room leaves the fold as it was.
        let mut own = *self;
        for (places, weight) in turns.iter() {
            let rows = places.map(|p| place[spring.points[p]] as u32);
            let known = own.turns[..own.turn_count].iter().position(|turn| *turn == rows);
            let i = known.unwrap_or(own.turn_count);
            if i == TOGETHER {
                return false;
            }
            own.turns[i] = rows;
            own.turn_count = own.turn_count.max(i + 1);
            own.weights[i][own.spring_count] += weight;
        }
        own.constants[own.spring_count] = spring.constant;
        own.rests[own.spring_count] = spring.rest;
        own.spring_count += 1;
        *self = own;
        true
    }
}

/// Whether a spring is on turns of one triangle, without a law.
pub fn is_fold(spring: &MeasureSpring) -> bool {
    let has_room = |turns: &Turns| turns.iter().count() <= TOGETHER;
    spring.law.is_none() && matches!(&spring.measure, Measure::Turns(turns) if has_room(turns))
}
