//! The shapes of a cell with the forces of the material, many at once, so that an energy that is a function is called seldom.

use super::sampling::FLATTEST;
use super::sets::{Place, Sets};
use crate::error::{Error, ErrorKind, Result};
use crate::material::State;
use crate::stiffness::{Geometry, Hyperelastic};

/// A shape that leaves less than this share of the volume at some point is replaced by one with half of its
/// deformation.
// At a fifth of the volume ln J is −1.6, and 1/J is five times what it is at rest: the forces of flatter shapes would outweigh those
// of all others.
const FLAT: f64 = 0.2;
/// The number of deformations that are tried of a shape, each half of the one before.
// The last is 1/128 of the first: a shape that is too flat then is so at rest.
const HALVINGS: i32 = 8;

/// A shape of the cell.
#[derive(Debug, Clone, Default)]
pub struct Placed {
    /// The positions of the nodes, `[nodes × dimension]`, m.
    pub x: Vec<f64>,
    /// The forces of the material, `[nodes × dimension]`, N.
    pub force: Vec<f64>,
    /// By what the weight of the shape is multiplied.
    pub share: f64,
    /// Whether it has less of its deformation than was drawn.
    pub is_reduced: bool,
}

/// What gives the shapes of a cell their forces.
pub struct ShapeForces<'s, 'a> {
    pub sets: &'s Sets<'a>,
    pub geometry: &'a Geometry,
    pub energy: &'a dyn Hyperelastic,
    pub state: State,
}

impl ShapeForces<'_, '_> {
    /// The shapes with these numbers, and the forces of the material. A shape of a family has less of its deformation if it would invert
    /// the cell, one of a list less of the displacements of its nodes.
    ///
    /// # Errors
    /// A shape of a list is flat or inverted, or has no forces; one of a family is inverted however small its deformation is made; or the
    /// energy has failed.
    pub fn at(&self, numbers: &[usize]) -> Result<Vec<Placed>> {
        let places: Vec<Place> = numbers.iter().map(|&number| self.sets.at(number)).collect();
        let mut all = vec![Placed::default(); numbers.len()];
        let mut limits = vec![FLAT; numbers.len()];
        let mut waiting: Vec<usize> = (0..numbers.len()).collect();
        // All shapes of a round are asked of the energy at once: a call into Python costs more than the stresses of a shape.
        for halvings in 0..HALVINGS {
            let (mut f, mut left, mut asked) = (Vec::new(), Vec::new(), Vec::new());
            for &i in &waiting {
                let Place { shapes, index, .. } = places[i];
                let x = shapes.place(index, 0.5f64.powi(halvings));
                let first = f.len();
                let mut is_upright = self.geometry.deformations(&x, limits[i], &mut f);
                if !is_upright && shapes.are_listed() && limits[i] == FLAT {
                    limits[i] = self.limit(&places[i])?;
                    is_upright = self.geometry.deformations(&x, limits[i], &mut f);
                }
                match is_upright {
                    true => asked.push((i, first..f.len(), x)),
                    false => left.push(i),
                }
            }
            self.energy.stresses(self.state, &mut f)?;
            for (i, points, x) in asked {
                let mut force = vec![0.0; x.len()];
                // An energy may have no finite stress at a shape that is upright: less of the deformation is tried there too.
                match self.geometry.forces_of(&f[points], self.state, &mut force) {
                    true => all[i] = Placed { x, force, share: places[i].share, is_reduced: halvings > 0 },
                    false => left.push(i),
                }
            }
            if left.is_empty() {
                return Ok(all);
            }
            waiting = left;
        }
        let Place { shapes, index, .. } = places[waiting[0]];
        if shapes.are_listed() {
            let ((key, cell), expected) = (shapes.named(index), "a shape at which the energy has finite forces");
            return Err(Error::expected(key, expected, format!("none{cell}")).of_kind(ErrorKind::Infeasible));
        }
        let problem = "the sampled shapes are turned inside out: expected a smaller stretch";
        Err(Error::new(problem).of_kind(ErrorKind::Infeasible))
    }

    /// The least det F of a shape of a list with displacements of its nodes: half of what it has without them.
    ///
    /// # Errors
    /// Without them it is flat or inverted.
    fn limit(&self, place: &Place) -> Result<f64> {
        let least = self.geometry.least_determinant(&place.shapes.place(place.index, 0.0));
        if !(least >= FLATTEST) {
            let expected = format!("a shape that is neither flat nor inverted, with det F of at least {FLATTEST}");
            let (key, cell) = place.shapes.named(place.index);
            let error = Error::expected(key, expected, format!("det F = {least:.4}{cell}"));
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        // A cell that a list makes flatter than usual may become half as flat again, so that displacements of its nodes
        // leave it a shape.
        Ok((0.5 * least).min(FLAT))
    }
}
