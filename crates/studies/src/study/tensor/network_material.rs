//! What a network is as a material, measured on samples of its cells.

use super::frame::frame;
use super::isotropic::{constants, distance, of_material};
use super::piece::Piece;
use super::relaxation::tensor;
use super::sample::Stars;
use crate::fit::CellFits;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::model::Network;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::time::Instant;

/// How many samples are taken at most. On unstructured tetrahedra samples differ by a tenth of their distance.
const SAMPLES: usize = 6;
/// Each has the cells around so many points. More points relax more: on unstructured tetrahedra the distance of classical fits is
/// 0.70 to 0.80 of single cells, 0.31 of the cells around 1 point, 0.165 around 8, 0.137 around 30, 0.124 around 100, and 0.115
/// around 300, for 170 times the time.
const POINTS: usize = 30;
/// Heights above its plane, as a share of the size of a sample, that are rounding.
const FLAT: f64 = 1e-9;

/// What a network is as a material.
///
/// Of each sample, all cells around 30 neighbouring points, the boundary is strained and the points inside find their places: the
/// energies give the elasticity tensor C of the sample, with normal–shear coupling and anisotropy. An affine strain of every point
/// would miss that neighbours give way to each other; one tensor of the whole network would miss what differs from place to place.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkMaterial {
    /// The mean of the samples' tensors in Kelvin's notation, `σ = C ε` with strains xx, yy, (zz,) and √2 times xy, (xz, yz);
    /// Pa, in the plane times the thickness, of a rod times its cross-section. On surfaces and curves in the directions of each
    /// sample.
    pub stiffness: DMatrix<f64>,
    /// Young's modulus of the mean tensor, Pa, harmonic mean over all directions of tension; `None` where some strain meets no
    /// resistance or releases energy.
    pub young: Option<f64>,
    /// Poisson's ratio of the mean tensor, mean over all directions; `None` as above, and of a rod.
    pub poisson: Option<f64>,
    /// `‖C − C₀‖/‖C₀‖`, root mean square over the samples; C₀ is that of the material. Frobenius norm of the tensors, which does
    /// not depend on the axes.
    pub distance: f64,
    /// The same of the mean tensor: the part that does not differ from place to place.
    pub mean_distance: f64,
    /// The same of the worst sample.
    pub largest_distance: f64,
    pub samples: usize,
    /// For this, s.
    pub seconds: f64,
}

/// Measures a network that was fitted to `material`, at rest. `cells` has the springs of each block of cells; empty where the
/// springs belong to no cell, as in whole-object fits: then each spring is shared equally among the cells that have all its points.
///
/// On curved surfaces and curves the samples are single cells, each in its own plane.
pub fn network_material(mesh: &Mesh, material: Material, cells: &[CellFits], network: &Network) -> NetworkMaterial {
    let start = Instant::now();
    let stars = Stars::of(mesh);
    let points = mesh.point_count();
    let count = SAMPLES.min(points.div_ceil(POINTS));
    let measure = |i: usize| {
        let seed = (2 * i + 1) * points / (2 * count);
        let single = || stars.single(stars.around(seed)[0]);
        let mut sample = stars.sample(seed, POINTS);
        let (mut directions, height) = frame(&sample, mesh.cell_dimension());
        if height > FLAT {
            sample = single();
            directions = frame(&sample, mesh.cell_dimension()).0;
        }
        let piece = match cells {
            [] => Piece::of_network(mesh, &stars, &sample, network),
            cells => Piece::of_cells(mesh, &sample, cells, network),
        };
        tensor(&sample, &piece, &directions)
    };
    let tensors: Vec<DMatrix<f64>> = (0..count).into_par_iter().map(measure).collect();
    let asked = of_material(material);
    let stiffness = tensors.iter().fold(DMatrix::zeros(asked.nrows(), asked.ncols()), |sum, c| sum + c) / count as f64;
    let distances: Vec<f64> = tensors.iter().map(|c| distance(c, &asked)).collect();
    let constants = constants(&stiffness, material.state());
    NetworkMaterial {
        young: constants.map(|(young, _)| young),
        poisson: constants.and_then(|(_, poisson)| poisson),
        distance: (distances.iter().map(|d| d * d).sum::<f64>() / count as f64).sqrt(),
        mean_distance: distance(&stiffness, &asked),
        largest_distance: distances.iter().copied().fold(0.0, f64::max),
        samples: count,
        seconds: start.elapsed().as_secs_f64(),
        stiffness,
    }
}
