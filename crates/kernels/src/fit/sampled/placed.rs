//! The shapes of a cell with the forces of the material, many at once, so that an energy that is a function is called seldom.

use super::shapes::{Part, Shapes};
use crate::error::{Error, ErrorKind, Result};
use crate::material::State;
use crate::stiffness::{Geometry, Hyperelastic};

/// A shape that leaves less than this share of the volume at some point is replaced by one with half of its
/// deformation.
const FLAT: f64 = 0.2;
/// The largest number of such halvings.
const HALVINGS: i32 = 8;

/// A shape of the cell.
#[derive(Debug, Clone, Default)]
pub struct Placed {
    /// The positions of the nodes, `[nodes × dimension]`, m.
    pub x: Vec<f64>,
    /// The forces of the material, `[nodes × dimension]`, N.
    pub force: Vec<f64>,
}

/// What gives the shapes of a cell their forces.
pub struct ShapeForces<'a> {
    pub shapes: &'a Shapes<'a>,
    pub geometry: &'a Geometry,
    pub energy: &'a dyn Hyperelastic,
    pub state: State,
}

impl ShapeForces<'_> {
    /// The shapes with these indices, each with less of its deformation if it would invert the cell, and the forces of the material.
    ///
    /// # Errors
    /// A shape is inverted however small its deformation is made, or the energy has failed.
    pub fn at(&self, part: Part, indices: &[usize]) -> Result<Vec<Placed>> {
        let size = self.shapes.rest.len();
        let mut all = vec![Placed::default(); indices.len()];
        let mut waiting: Vec<usize> = (0..indices.len()).collect();
        for halvings in 0..HALVINGS {
            let (mut f, mut left, mut asked) = (Vec::new(), Vec::new(), Vec::new());
            for &place in &waiting {
                let x = self.shapes.place(part, indices[place], 0.5f64.powi(halvings));
                let first = f.len();
                match self.geometry.deformations(&x, FLAT, &mut f) {
                    true => asked.push((place, first..f.len(), x)),
                    false => left.push(place),
                }
            }
            self.energy.stresses(self.state, &mut f)?;
            for (place, points, x) in asked {
                let mut force = vec![0.0; size];
                match self.geometry.forces_of(&f[points], self.state, &mut force) {
                    true => all[place] = Placed { x, force },
                    false => left.push(place),
                }
            }
            if left.is_empty() {
                return Ok(all);
            }
            waiting = left;
        }
        let problem = "the sampled shapes are turned inside out: expected a smaller stretch";
        Err(Error::new(problem).of_kind(ErrorKind::Infeasible))
    }
}
