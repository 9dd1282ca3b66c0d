//! Cavities that are filled to a given volume.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::component::Component;
use super::pressed::PressedFaces;
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{Mesh, Selection};
use crate::springs::dot;

/// A cavity of a body that is filled until it has a given volume.
///
/// The forces of a pressure of 1 Pa on its sides are the gradient of its volume `V(x) = −∫ x·n dA/d`, so that `V = f·x/d`; n points
/// out of the body, into the cavity.
#[derive(Debug, Clone)]
pub struct Cavity {
    /// Its sides under a pressure of 1 Pa.
    pub sides: PressedFaces,
    /// The volume that it shall have, m³; of a plane body the area times the thickness.
    pub volume: f64,
    dimension: usize,
}

impl Cavity {
    /// The cavity whose sides are this part of the mesh; `thickness` is that of the cells of a plane body, m.
    ///
    /// # Errors
    /// The part has no sides, its sides do not close a space, or that space is outside of the body.
    pub fn new(mesh: &Mesh, part: &Selection, volume: f64, thickness: &CellMap<f64>) -> Result<Cavity> {
        if mesh.cell_dimension() < mesh.dimension {
            let found = "a surface or curve in space";
            return Err(Error::expected("volume", "a cavity of a body whose cells fill their space", found));
        }
        let sides = PressedFaces::new(mesh, part, &Component::Constant(1.0), thickness)?;
        if let Some((place, count)) = mesh.rim(&part.sides(mesh)?) {
            let ends = ["points at which the sides end", "edges that only one side has"][mesh.dimension - 2];
            let found = format!("{count} {ends}, the first at {place:?} m");
            return Err(Error::expected("volume", "sides that close a cavity", found));
        }
        let cavity = Cavity { sides, volume, dimension: mesh.dimension };
        // Sides around the body close a space too, whose normals point away from it.
        let own = cavity.volume_at(&mesh.points);
        if !(own > 0.0) {
            let found = format!("sides around the body, which enclose {:.4e} m³ of it", -own);
            return Err(Error::expected("volume", "the sides of a cavity inside the body", found));
        }
        Ok(cavity)
    }

    /// The volume with the points at `x`, `[points · dimension]`, m³.
    pub fn volume_at(&self, x: &[f64]) -> f64 {
        // The forces on a closed surface balance: positions from one of its points keep the digits of a body that is far from the origin.
        let d = self.dimension;
        let origin = self.sides.points().next().map_or(0, |point| point * d);
        let from_origin: Vec<f64> = x.iter().enumerate().map(|(i, x_i)| x_i - x[origin + i % d]).collect();
        dot(&self.sides.forces(x), &from_origin) / d as f64
    }
}
