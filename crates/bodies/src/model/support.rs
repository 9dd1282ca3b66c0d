//! Supports, and whether they hold every body.

use super::network::Network;
use crate::mesh::{Mesh, pieces_of};
use crate::springs::{cross, norm};
use nalgebra::DMatrix;
use springfit_numerics::dense::singular;

/// The distance of points from a line, relative to the extent of the body, that is a rounding error of coordinates far from the origin.
const STRAIGHT: f64 = 1e-9;

/// Prescribed displacements of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The displacements, `[points · dimension]`, m; `None` for degrees of freedom that are free.
    pub prescribed: Vec<Option<f64>>,
}

impl Support {
    /// No supports.
    pub fn free(mesh: &Mesh) -> Support {
        Support { prescribed: vec![None; mesh.points.len()] }
    }

    /// Holds these directions of the points at rest.
    pub fn fix(&mut self, points: &[usize], directions: &[usize], dimension: usize) {
        for &p in points {
            for &k in directions {
                self.prescribed[p * dimension + k] = Some(0.0);
            }
        }
    }

    /// Whether the degree of freedom is held.
    pub fn is_fixed(&self, dof: usize) -> bool {
        self.prescribed[dof].is_some()
    }
}

/// A connected part of the mesh that the support leaves free to move as a rigid body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Unheld {
    /// The number of its points; the directors of a sheet or of rods do not count.
    pub points: usize,
    /// Its point with the lowest index.
    pub first_point: usize,
    /// The number of independent rigid motions that remain.
    pub motions: usize,
}

/// Whether all points are on one line through their centre, to rounding.
fn is_straight<'a>(point: &dyn Fn(usize) -> &'a [f64], points: &[usize], centre: &[f64], extent: f64) -> bool {
    let from = |p: usize| -> [f64; 3] { std::array::from_fn(|k| point(p)[k] - centre[k]) };
    let Some(far) = points.iter().map(|&p| from(p)).max_by(|a, b| norm(a).total_cmp(&norm(b))) else { return false };
    let along = far.map(|x| x / norm(&far));
    points.iter().all(|&p| norm(&cross(along, from(p))) <= STRAIGHT * extent)
}

/// The bodies that can move without deforming, found by the rank of their rigid motions at the held degrees of freedom.
pub fn unheld_bodies(mesh: &Mesh, support: &Support) -> Vec<Unheld> {
    unheld_pieces((&mesh.points, mesh.dimension), mesh.node_count(), mesh.pieces(), support)
}

/// Finds the parts of a network, connected by springs, that can move without deforming, as [`unheld_bodies`] does.
/// `points` are `[points × dimension]`, m.
pub fn unheld_parts(network: &Network, points: &[f64], support: &Support) -> Vec<Unheld> {
    let pieces =
        pieces_of(points.len() / network.dimension, network.springs().map(|(points, _)| points.iter().copied()));
    unheld_pieces((points, network.dimension), points.len() / network.dimension, pieces, support)
}

/// The pieces that are not held; points from `nodes` on are not counted.
fn unheld_pieces(
    (points, d): (&[f64], usize),
    nodes: usize,
    pieces: Vec<Vec<usize>>,
    support: &Support,
) -> Vec<Unheld> {
    let point = |p: usize| &points[p * d..(p + 1) * d];
    let motions = d * (d + 1) / 2;
    let mut unheld = Vec::new();
    for body in pieces {
        let held: Vec<usize> =
            body.iter().flat_map(|p| p * d..(p + 1) * d).filter(|&dof| support.is_fixed(dof)).collect();
        let centre: Vec<f64> =
            (0..d).map(|k| body.iter().map(|&p| point(p)[k]).sum::<f64>() / body.len() as f64).collect();
        let extent = body.iter().map(|&p| crate::springs::distance(point(p), &centre)).fold(0.0, f64::max);
        if extent == 0.0 {
            // To turn points at one place moves nothing.
            let is_free = |k: &usize| !body.iter().any(|p| support.is_fixed(p * d + k));
            let (points, motions) = (body.iter().filter(|p| **p < nodes).count(), (0..d).filter(is_free).count());
            unheld.extend((motions > 0).then_some(Unheld { points, first_point: body[0], motions }));
            continue;
        }
        // Translations e_k, then rotations in the planes (k, l), in units of the size of the body.
        // Rows of zeros where fewer are held than there are motions: the rank is that of the others.
        let mut modes = DMatrix::zeros(held.len().max(motions), motions);
        for (row, &dof) in held.iter().enumerate() {
            let r: Vec<f64> = point(dof / d).iter().zip(&centre).map(|(x, c)| (x - c) / extent).collect();
            modes[(row, dof % d)] = 1.0;
            let mut column = d;
            for k in 0..d {
                for l in 0..k {
                    if dof % d == k {
                        modes[(row, column)] = r[l];
                    } else if dof % d == l {
                        modes[(row, column)] = -r[k];
                    }
                    column += 1;
                }
            }
        }
        // A zero singular value may be as large as the rounding of coordinates far from the origin.
        let least = 1e-9 * (held.len().max(1) as f64).sqrt();
        // Points so far apart that their distances are no numbers count as not held.
        let rank = singular(modes).map_or(0, |modes| modes.values.iter().filter(|value| **value > least).count());
        // To turn a straight rod in space about itself moves no point.
        let idle = usize::from(rank < motions && d == 3 && is_straight(&point, &body, &centre, extent));
        if rank + idle < motions {
            let counted = body.iter().filter(|p| **p < nodes).count();
            unheld.push(Unheld { points: counted, first_point: body[0], motions: motions - idle - rank });
        }
    }
    unheld
}
