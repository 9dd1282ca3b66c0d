//! Cavities that are filled to a given volume.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::component::Component;
use super::pressed::PressedFaces;
use super::support::Support;
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{Mesh, Selection};

/// A cavity of a body that is filled until it has a given volume.
///
/// The forces of a pressure of 1 Pa on its sides are the gradient of its volume `V(x) = −∫ x·n dA/d`, so that `V = f·x/d`; n points
/// out of the body, into the cavity. Sides that end in planes `x_k = c` are closed by these planes, on which `(x_k − c) n_k` vanishes: with
/// positions from the planes they add nothing to V, and nothing to its gradient in points that stay in them.
#[derive(Debug, Clone)]
pub struct Cavity {
    /// Its sides under a pressure of 1 Pa.
    pub sides: PressedFaces,
    /// The volume that it shall have, m³; of a plane body the area times the thickness.
    pub volume: f64,
    /// The places of the planes across each axis that close it, `[dimension]`, m.
    planes: Vec<Vec<f64>>,
}

/// Points within this share of the extent of a body are in one plane.
// Points of a plane across an axis have one coordinate, which files give in the same digits for all: they differ by rounding of
// the unit alone. A wider bound would take bent rims for plane ones, and their volume would be wrong by as much.
const IN_PLANE: f64 = 1e-9;

impl Cavity {
    /// The cavity whose sides are this part of the mesh; `thickness` is that of the cells of a plane body, m. Sides need not close it where they
    /// end in planes across an axis whose points `support` holds along it, such as planes of symmetry: V is the volume between them.
    ///
    /// # Errors
    /// The part has no sides, its sides do not close a space, or that space is outside of the body.
    pub fn new(
        mesh: &Mesh,
        part: &Selection,
        volume: f64,
        thickness: &CellMap<f64>,
        support: &Support,
    ) -> Result<Cavity> {
        if mesh.cell_dimension() < mesh.dimension {
            let found = "a surface or curve in space";
            return Err(Error::expected("volume", "a cavity of a body whose cells fill their space", found));
        }
        let sides = PressedFaces::new(mesh, part, &Component::Constant(1.0), thickness)?;
        let rim = mesh.rim(&part.sides(mesh)?);
        let Some(planes) = planes(mesh, &rim, &sides, support) else {
            let ends = ["points at which the sides end", "edges that only one side has"][mesh.dimension - 2];
            let found = format!("{} {ends}, the first at {:?} m", rim.len(), mesh.mean_place(&rim[0]));
            let expected = "sides that close a cavity, alone or with planes across an axis in which [[fix]] holds their ends along it";
            return Err(Error::expected("volume", expected, found));
        };
        let cavity = Cavity { sides, volume, planes };
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
        let d = self.planes.len();
        let first = self.sides.points().next().map_or(0, |point| point * d);
        let forces = self.sides.forces(x);
        let along = |k: usize| -> f64 {
            let origin = self.planes[k].first().copied().unwrap_or(x[first + k]);
            forces.iter().zip(x).skip(k).step_by(d).map(|(f, x)| f * (x - origin)).sum()
        };
        // Each axis gives the volume, but for those with two planes across them.
        let axes: Vec<usize> = (0..d).filter(|&k| self.planes[k].len() < 2).collect();
        axes.iter().map(|&k| along(k)).sum::<f64>() / axes.len() as f64
    }
}

/// The planes across each axis in which the sides of a cavity end, `[dimension]`: all its points there are held along the axis. `None` if an end is
/// in no such plane, or if all axes have several.
fn planes(mesh: &Mesh, rim: &[Vec<usize>], sides: &PressedFaces, support: &Support) -> Option<Vec<Vec<f64>>> {
    let d = mesh.dimension;
    let low = |k: usize| mesh.points.iter().skip(k).step_by(d).copied().fold(f64::INFINITY, f64::min);
    let high = |k: usize| mesh.points.iter().skip(k).step_by(d).copied().fold(f64::NEG_INFINITY, f64::max);
    let reach = IN_PLANE * (0..d).map(|k| high(k) - low(k)).fold(0.0, f64::max);
    let is_in = |p: usize, k: usize, place: f64| (mesh.points[p * d + k] - place).abs() <= reach;
    // A prescribed motion along the axis would move the plane.
    let is_held = |p: usize, k: usize| support.prescribed[p * d + k] == Some(0.0);
    // A side that could leave the plane would open the cavity there.
    let closes = |k: usize, place: f64| sides.points().filter(|&p| is_in(p, k, place)).all(|p| is_held(p, k));
    let mut planes = vec![Vec::new(); d];
    for end in rim {
        let is_along = |k: usize, place: f64| end.iter().all(|&p| is_in(p, k, place));
        // Ends of the rim that lie in one plane are closed by one face.
        if (0..d).any(|k| planes[k].iter().any(|&place| is_along(k, place))) {
            continue;
        }
        let place = |k: usize| mesh.points[end[0] * d + k];
        let axis = (0..d).find(|&k| is_along(k, place(k)) && closes(k, place(k)))?;
        planes[axis].push(place(axis));
    }
    planes.iter().any(|places| places.len() < 2).then_some(planes)
}
