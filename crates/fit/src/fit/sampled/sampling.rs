//! Which deformed shapes a fit sees: their source, their numbers, and what is held out.
//!
//! Theory: page *Sampled fits* of the book.

use super::family::{DeformationFamily, within};
use super::numbers::Design;
use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::fit::input::{check_finite, check_length};
use std::sync::Arc;

/// Every fifth shape of a list is held out.
// What is held out must be enough for a mean error, and is lost for the fit: a fifth is a usual share (Hastie, Tibshirani, Friedman
// 2009, section 7.10).
pub const APART: usize = 5;
/// A deformation gradient of a list with a smaller det F is flat or turns cells inside out. Laws with ln J or 1/J have
/// no force to fit there.
pub const FLATTEST: f64 = 1e-3;
/// The largest entry of a deformation gradient of a list: beyond all materials, and far from where squares of forces overflow.
const LARGEST: f64 = 1e6;
/// The sine of the angle between two directions below which they are one. Two such axes span no plane in which a shape
/// could be turned.
const PARALLEL: f64 = 1e-6;

/// The source of the shapes.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Families of deformations, which take turns.
    Families(Vec<DeformationFamily>),
    /// Deformation gradients, `[shapes × dimension × dimension]`.
    Gradients(Arc<Vec<f64>>),
    /// Positions of all points of the mesh, `[states][points × dimension]`, m. A cell uses those of its own nodes and
    /// of the cells that have its shape.
    States(Arc<Vec<Vec<f64>>>),
}

/// The deformed shapes of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// The source of the shapes.
    pub source: Source,
    /// The number of shapes of the fit, at most. Of a list of gradients each is used once. States are used equally often, with different
    /// displacements of the nodes: once each without them, and as often as this number allows with them.
    pub shapes: usize,
    /// The number of other shapes on which the error is measured, at most, by the same rule. Of a list of at least five shapes, every fifth
    /// is kept for them.
    pub held_out: usize,
    /// Shapes on which the error is measured in place of those, such as other families or larger stretches: as many as its `shapes`. Then
    /// no shape of a list is kept apart.
    pub others: Option<Box<Sampling>>,
    /// The least and the largest amplitude of the families.
    pub stretch: [f64; 2],
    /// How amplitudes and axes of the families are spread over their ranges.
    pub design: Design,
    /// The number of shapes over which a Latin hypercube is laid, of which the fit uses the first; as many as it uses, if absent.
    pub laid: Option<usize>,
    /// The axes of the families, `[dimension]` or two after each other, which take turns; random ones if there are none.
    pub directions: Vec<Vec<f64>>,
    /// How far each node is moved in addition, as a share of the size of the cell.
    pub perturbation: f64,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The seed of those of the shapes that are held out, if it is another one.
    pub seed_held_out: Option<u64>,
    /// The weight of all shapes together, beside those of other sets of shapes.
    pub weight: f64,
}

impl Default for Sampling {
    fn default() -> Sampling {
        Sampling {
            source: Source::Families(vec![DeformationFamily::Gradients]),
            shapes: 300,
            held_out: 100,
            others: None,
            stretch: [-0.3, 0.3],
            design: Design::Scrambled,
            laid: None,
            directions: Vec::new(),
            perturbation: 0.05,
            seed: 1,
            seed_held_out: None,
            weight: 1.0,
        }
    }
}

/// Whether a shape belongs to the fit or to its test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The fit sees the shape.
    Trained,
    /// The shape is held out.
    HeldOut,
}

crate::named!(Part { "trained" => Trained, "held-out" => HeldOut });

impl Part {
    /// How many shapes of a list of `count` belong to the part. A list that is too short to hold any out has all of them in both parts.
    pub fn of(self, count: usize) -> usize {
        match (self, count / APART) {
            (Part::HeldOut, 1..) => count / APART,
            (Part::HeldOut, 0) => count,
            (Part::Trained, apart) => count - apart,
        }
    }
}

impl Sampling {
    /// The seed of the shapes of a part.
    pub(super) fn seed_of(&self, part: Part) -> u64 {
        match part {
            // Even and odd seeds are never equal, so that no shape of the fit is held out as well.
            Part::Trained => self.seed.wrapping_mul(2),
            Part::HeldOut => self.seed_held_out.unwrap_or(self.seed).wrapping_mul(2).wrapping_add(1),
        }
    }

    /// Checks the settings for cells of this dimension.
    ///
    /// # Errors
    /// A number is out of range; a list is empty or has a wrong length; a shape of a list is flat or inverted; a family or a direction
    /// belongs to another dimension.
    pub fn check(&self, dimension: usize) -> Result<()> {
        self.check_numbers()?;
        match &self.source {
            Source::Families(families) => {
                if let Some(family) = families.iter().find(|family| family.least_dimension() > dimension) {
                    let expected = format!("families that cells of {dimension} dimensions have");
                    return Err(Error::expected("families", expected, format!("\"{}\"", family.name())));
                }
                self.check_directions(dimension)?;
            }
            Source::Gradients(list) => check_gradients(list, dimension)?,
            Source::States(_) => {}
        }
        self.others.as_ref().map_or(Ok(()), |others| others.check(dimension).map_err(|e| e.under("held_out")))
    }

    /// Checks what does not depend on the cells.
    ///
    /// # Errors
    /// A number is out of range, or there is no family or state.
    pub fn check_numbers(&self) -> Result<()> {
        check_count("shapes", self.shapes as u64, 1, bound::SHAPES)?;
        check_count("held_out", self.held_out as u64, 0, bound::SHAPES)?;
        let [least, largest] = self.stretch;
        if !(-2.0..=2.0).contains(&least) || !(least..=2.0).contains(&largest) {
            return Err(Error::expected("stretch", "a range within -2 to 2", format!("{least} to {largest}")));
        }
        if !(0.0..=2.0).contains(&self.perturbation) {
            return Err(Error::expected("perturbation", "a share from 0 to 2", self.perturbation));
        }
        // In a sum with such a weight, a shape of the weight 1 has four digits left.
        if !(self.weight > 0.0 && self.weight <= 1e12) {
            return Err(Error::expected("weight", "a number above 0, up to 1e12", self.weight));
        }
        match &self.source {
            Source::Families(families) if families.is_empty() => {
                Err(Error::expected("families", "at least one family", "none"))
            }
            Source::Families(_) if self.stretch == [0.0; 2] && self.perturbation == 0.0 => {
                Err(Error::expected("stretch", "shapes that differ from the one at rest", "none"))
            }
            Source::Families(families)
                if !self.directions.is_empty() && !families.iter().any(|family| family.has_axes()) =>
            {
                Err(Error::expected("directions", "a family with axes", families[0].name()))
            }
            Source::States(states) if states.is_empty() => Err(Error::expected("states", "at least one state", "none")),
            Source::Gradients(_) | Source::States(_) | Source::Families(_) => Ok(()),
        }?;
        self.others.as_ref().map_or(Ok(()), |others| others.check_numbers().map_err(|e| e.under("held_out")))
    }

    fn check_directions(&self, d: usize) -> Result<()> {
        for (i, direction) in self.directions.iter().enumerate() {
            let key = || format!("directions[{i}]");
            if ![d, 2 * d].contains(&direction.len()) {
                let expected = format!("{d} numbers, or {} for two axes", 2 * d);
                return Err(Error::expected(key(), expected, direction.len()));
            }
            check_finite(&key(), direction)?;
            let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            // A norm outside of these has lost its digits, as its square is near the least or the largest number.
            if direction.chunks_exact(d).any(|axis| !(norm(axis) > 1e-100 && norm(axis) < 1e100)) {
                return Err(Error::expected(key(), "a direction", "the zero vector, or one too long"));
            }
            if let [e, f] = direction.chunks_exact(d).collect::<Vec<_>>()[..] {
                let (e_norm, f_norm) = (norm(e), norm(f));
                let cosine = e.iter().zip(f).map(|(e, f)| e / e_norm * (f / f_norm)).sum::<f64>();
                // The square of the sine is a difference that rounding changes by some 1e-16, a ten thousandth of the
                // bound.
                if 1.0 - cosine * cosine < PARALLEL * PARALLEL {
                    return Err(Error::expected(key(), "two directions that differ", "one"));
                }
            }
        }
        Ok(())
    }

    /// How many shapes of its list, in a body of this dimension, belong to the fit and to its test. `None` without a list of gradients.
    pub fn listed(&self, dimension: usize) -> Option<[usize; 2]> {
        match &self.source {
            Source::Gradients(list) => {
                let all = list.len() / (dimension * dimension);
                let trained = if self.others.is_some() { all } else { Part::Trained.of(all) };
                Some([trained, Part::HeldOut.of(all)])
            }
            Source::Families(_) | Source::States(_) => None,
        }
    }

    /// Checks that every state has this many numbers, all finite.
    ///
    /// # Errors
    /// A state does not.
    pub(super) fn check_states(&self, numbers: usize) -> Result<()> {
        match &self.source {
            Source::States(states) => states.iter().try_for_each(|state| {
                check_length("states", state.len(), numbers)?;
                check_finite("states", state)
            }),
            Source::Families(_) | Source::Gradients(_) => Ok(()),
        }?;
        self.others.as_ref().map_or(Ok(()), |others| others.check_states(numbers).map_err(|e| e.under("held_out")))
    }
}

/// Checks deformation gradients, `[shapes × dimension × dimension]`.
fn check_gradients(list: &[f64], d: usize) -> Result<()> {
    if list.is_empty() || !list.len().is_multiple_of(d * d) {
        let expected = format!("deformation gradients of {} numbers", d * d);
        return Err(Error::expected("gradients", expected, format!("{} numbers in all", list.len())));
    }
    check_finite("gradients", list)?;
    for (i, gradient) in list.chunks_exact(d * d).enumerate() {
        if let Some(entry) = gradient.iter().find(|entry| entry.abs() > LARGEST) {
            return Err(Error::expected(format!("gradients[{i}]"), format!("entries up to {LARGEST:e}"), entry));
        }
        let content = within(d, |k, l| gradient[k * d + l]).determinant();
        // The comparison is negated so that a determinant that is not a number is refused.
        if !(content >= FLATTEST) {
            let expected = format!("a shape that is neither flat nor inverted, with det F of at least {FLATTEST}");
            return Err(Error::expected(format!("gradients[{i}]"), expected, format!("det F = {content:.4}")));
        }
    }
    Ok(())
}
