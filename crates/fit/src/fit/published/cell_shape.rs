//! The quantities of a cell and its material on which the formulas depend.

use super::corners::Corners;
use super::quantity::Quantity;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::material::{Material, Moduli, State};

/// The quantities of a cell on which a formula depends.
pub struct CellShape<'a, T = f64> {
    pub dimension: usize,
    pub corners: &'a Corners,
    /// The nodes that the formula joins, and their distances, m.
    pub pairs: &'a [[usize; 2]],
    pub lengths: Vec<T>,
    /// The area or volume, m² or m³.
    pub content: T,
}

impl<T: Quantity> CellShape<'_, T> {
    /// The mean length of the edges in each direction, m; times zero if the formula joins no edges.
    pub fn extents(&self) -> Vec<T> {
        let place = |[a, b]: [usize; 2]| self.pairs.iter().position(|p| *p == [a, b] || *p == [b, a]);
        // A product with zero, because a formula has no other constant of its kind.
        self.corners.extents(|pair| place(pair).map_or_else(|| self.content.clone() * 0.0, |s| self.lengths[s].clone()))
    }
}

/// The elastic constants in the dimensions of the cell.
#[derive(Debug, Clone)]
pub struct Elasticity<T = f64> {
    /// Young's modulus in Pa; in the plane in N/m.
    pub young: T,
    /// Poisson's ratio in these dimensions.
    pub poisson: T,
    /// λ and μ in these dimensions.
    pub moduli: Moduli<T>,
}

impl Elasticity {
    /// Those of a material.
    ///
    /// # Errors
    /// The material is not one of a body of these dimensions.
    pub fn of(element: &Element, material: Material) -> Result<Elasticity> {
        let (e, nu, moduli) = (material.young(), material.poisson(), material.moduli());
        match (material.state(), element.dimension()) {
            (State::Solid, 3) => Ok(Elasticity { young: e, poisson: nu, moduli }),
            (State::PlaneStress { thickness }, 2) => Ok(Elasticity { young: e * thickness, poisson: nu, moduli }),
            (State::PlaneStrain { thickness }, 2) => {
                let young = e * thickness / ((1.0 + nu) * (1.0 - nu));
                Ok(Elasticity { young, poisson: nu / (1.0 - nu), moduli })
            }
            (_, d) => Err(Error::at("material", format!("is not one of a body of {d} dimensions"))),
        }
    }
}
