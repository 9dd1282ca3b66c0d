//! The sets of shapes of a cell, each with its weight, as one sequence.
//!
//! Theory: page *Sampled fits* of the book.

use super::sampling::{Part, Sampling};
use super::shapes::{Drawing, Shapes};

/// The shapes of all sets that belong to one part, set after set.
pub struct Sets<'a> {
    sets: Vec<Shapes<'a>>,
    /// By what the weight of each shape of a set is multiplied.
    shares: Vec<f64>,
    count: usize,
}

/// A shape among those of all sets.
#[derive(Clone, Copy)]
pub struct Place<'s, 'a> {
    /// The set and its number.
    pub shapes: &'s Shapes<'a>,
    pub set: usize,
    /// The number of the shape in its set.
    pub index: usize,
    /// By what its weight is multiplied.
    pub share: f64,
}

impl<'a> Sets<'a> {
    /// The shapes of a part.
    pub fn new(samplings: impl Iterator<Item = &'a Sampling>, drawing: Drawing<'a>, part: Part) -> Sets<'a> {
        let shapes = |sampling: &'a Sampling| match (part, &sampling.others) {
            (Part::HeldOut, Some(others)) => Shapes::new(others, drawing, part, false),
            (Part::Trained, others) => Shapes::new(sampling, drawing, part, others.is_none()),
            (Part::HeldOut, None) => Shapes::new(sampling, drawing, part, true),
        };
        let weighed = samplings.map(|sampling| (sampling.weight, shapes(sampling)));
        let is_used = |shapes: &Shapes| part == Part::Trained || shapes.are_others();
        let (weights, sets): (Vec<f64>, Vec<Shapes>) = weighed.filter(|(_, shapes)| is_used(shapes)).unzip();
        let count = sets.iter().map(Shapes::count).sum();
        // The weight of a set is that of all its shapes together, and on average a shape has that of one set alone.
        let total: f64 = weights.iter().sum();
        let share = |(weight, shapes): (&f64, &Shapes)| weight / total * count as f64 / shapes.count().max(1) as f64;
        // One set alone has the share one to the last bit, whatever its weight.
        let shares = if sets.len() == 1 { vec![1.0] } else { weights.iter().zip(&sets).map(share).collect() };
        Sets { sets, shares, count }
    }

    /// The number of all shapes.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The shape with this number.
    pub fn at(&self, number: usize) -> Place<'_, 'a> {
        let mut index = number;
        for (set, shapes) in self.sets.iter().enumerate() {
            if index < shapes.count() {
                return Place { shapes, set, index, share: self.shares[set] };
            }
            index -= shapes.count();
        }
        panic!("shape {number} of {}", self.count)
    }
}
