//! The quantities of a cell and its material on which the formulas depend.

use super::corners::Corners;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::material::{Material, Moduli, State};

/// The quantities of a cell on which a formula depends.
pub struct CellShape<'a> {
    pub dimension: usize,
    pub corners: &'a Corners,
    /// The nodes that the formula joins, and their distances, m.
    pub pairs: &'a [[usize; 2]],
    pub lengths: Vec<f64>,
    /// The area or volume, m² or m³.
    pub content: f64,
}

impl CellShape<'_> {
    /// The mean length of the edges in each direction, m; zero if the formula joins no edges.
    pub fn extents(&self) -> Vec<f64> {
        let place = |[a, b]: [usize; 2]| self.pairs.iter().position(|p| *p == [a, b] || *p == [b, a]);
        self.corners.extents(|pair| place(pair).map_or(0.0, |s| self.lengths[s]))
    }
}

/// The elastic constants in the dimensions of the cell.
pub struct Elasticity {
    /// Young's modulus in Pa; in the plane in N/m.
    pub young: f64,
    pub poisson: f64,
    pub moduli: Moduli,
}

impl Elasticity {
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
