//! A network as a material, measured on samples of its cells.

use super::frame::{Plane, axis_order};
use super::isotropic::{constants, distance, flattened, of_material};
use super::owners::SpringOwners;
use super::piece::Piece;
use super::relaxation::{body_tensor, tensor};
use super::sample::{Sample, Stars};
use crate::clock::Clock;
use crate::material::{CellMap, Material, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Moments, Network, edge_springs};
use crate::number::or_nan;
use nalgebra::DMatrix;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The largest number of samples.
// On unstructured tetrahedra the distances of samples differ by a tenth: the mean of six is known to about 4 %, and each further
// sample costs a dense solution.
const SAMPLES: usize = 6;
/// The number of points whose cells form a sample. More points allow more relaxation: on unstructured tetrahedra the
/// distance of classical fits is 0.70 to 0.80 with single cells, 0.31 with the cells around 1 point, 0.165 around 8,
/// 0.137 around 30, 0.124 around 100, and 0.115 around 300, which takes 170 times as long.
const POINTS: usize = 30;
/// Samples of surfaces and curves whose points are farther from their plane, relative to their size, have fewer points.
/// Motions in the plane of a cap with this height see its cells tilted by 10° at most, by which their stiffness changes
/// by 1.5 %, as that of the finite elements does.
const FLAT: f64 = 0.05;
/// Samples with a cell whose angle to their plane has a smaller cosine than this have fewer points: where sheets meet, as in a T, the
/// plane through all points crosses some of them, and a strain in it meets no stiffness there. The bound is 30°; smoothly bent sheets
/// of the height above stay below it.
const ALONG: f64 = 0.866;
/// Heights above the plane of a sample, relative to its size, that are rounding errors.
// Coordinates that are rounded to 1.1e-16 of their size leave less up to 1e6 sizes away from the origin. A flat sample above the bound
// has its tensor compared with that of its finite elements, which costs time alone.
const ROUNDING: f64 = 1e-9;

/// A network as a material.
///
/// The boundary of each sample, which has all cells around 30 neighbouring points, is strained, and the points inside
/// find their equilibrium. The energies give the elasticity tensor C of the sample, with normal–shear coupling and
/// anisotropy. An affine strain of every point would ignore that neighbours give way to each other; a single tensor of
/// the whole network would ignore variations in space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct NetworkMaterial {
    /// The harmonic mean of Young's modulus of the mean tensor over all directions of tension is in Pa; it is null if some strain meets no
    /// resistance.
    pub young: Option<f64>,
    /// The mean of Poisson's ratio over all directions is null as `young` is, and for a rod.
    pub poisson: Option<f64>,
    /// The material has this Young's modulus in Pa. Where it differs from cell to cell, it is that of the finite elements of the samples,
    /// to which `young` belongs.
    pub asked_young: Option<f64>,
    /// The material has this Poisson's ratio. Where it differs from cell to cell, it is that of the finite elements of the samples, to
    /// which `poisson` belongs.
    pub asked_poisson: Option<f64>,
    /// The elasticity tensors have the distance `‖C − C₀‖/‖C₀‖` in the Frobenius norm, which does not depend on the axes, root mean square over
    /// the samples; it is null where it is not finite. C₀ is the tensor of the material; in samples of several materials it is that of their
    /// finite elements, strained in the same way.
    #[serde(rename = "tensor_distance", deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub distance: f64,
    /// The mean of the samples' tensors has this distance, the part that does not vary in space.
    #[serde(rename = "mean_tensor_distance", deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub mean_distance: f64,
    /// The worst sample has this distance.
    #[serde(rename = "largest_tensor_distance", deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub largest_distance: f64,
    /// The mean of the samples' tensors is in Kelvin's notation, `σ = C ε`, Pa; it is times the thickness in the plane, and times the
    /// cross-section for a rod. Rows are those of the stresses xx, yy, (zz,) √2 xy, (√2 xz, √2 yz). On surfaces in space the axes are
    /// projections of coordinate axes onto the plane of each sample: x and y of a sheet in their plane.
    #[serde(with = "rows")]
    #[schemars(with = "Vec<Vec<Option<f64>>>")]
    pub stiffness: DMatrix<f64>,
    /// This number of cells or patches was measured.
    pub samples: usize,
    /// The computation took this processor time in s.
    pub seconds: f64,
}

/// A matrix as the list of its rows, null where an entry is not finite.
mod rows {
    use nalgebra::DMatrix;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(matrix: &DMatrix<f64>, target: S) -> Result<S::Ok, S::Error> {
        let row = |i: usize| matrix.row(i).iter().copied().collect::<Vec<f64>>();
        (0..matrix.nrows()).map(row).collect::<Vec<_>>().serialize(target)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(source: D) -> Result<DMatrix<f64>, D::Error> {
        let rows: Vec<Vec<Option<f64>>> = Deserialize::deserialize(source)?;
        let entry = |i: usize, j: usize| rows[i].get(j).copied().flatten().unwrap_or(f64::NAN);
        Ok(DMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), entry))
    }
}

/// The number of samples that a mesh has room for.
pub fn most_samples(mesh: &Mesh) -> usize {
    SAMPLES.min(mesh.point_count().div_ceil(POINTS))
}

/// Measures a network that was fitted to `material`, at rest.
///
/// On surfaces and curves each sample moves in its own plane or line, and its tensor is relative to that of its finite elements. Where
/// they bend, samples have fewer points, down to single cells.
pub fn network_material(
    mesh: &Mesh,
    material: impl Into<MaterialMap>,
    owners: SpringOwners,
    network: &Network,
) -> NetworkMaterial {
    material_of(mesh, &material.into(), owners, network)
}

/// [`network_material`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn material_of(mesh: &Mesh, material: &MaterialMap, owners: SpringOwners, network: &Network) -> NetworkMaterial {
    let start = Clock::start();
    let (stars, dimension) = (Stars::of(mesh), mesh.cell_dimension());
    // Points that only attached cells have are in no sample.
    let seeds: Vec<usize> = (0..mesh.point_count()).filter(|&p| stars.around(p).next().is_some()).collect();
    let points = seeds.len();
    let count = most_samples(mesh);
    let flat: Vec<(Sample, Plane)> = (0..count)
        .into_par_iter()
        // Seeds are the middles of equal parts of the list of points. Samples are collected in order, so that sums have
        // the same bits on any number of threads.
        .map(|i| flat_sample(&stars, seeds[(2 * i + 1) * points / (2 * count)], dimension))
        .collect();
    let order = axis_order(&flat.iter().map(|(_, plane)| plane).collect::<Vec<_>>());
    let patches = Piece::patches_of(network);
    let measure = |(sample, plane): &(Sample, Plane)| {
        let directions = plane.frame(&order);
        let own = material.of_some(&sample.cells);
        let whole = || Piece::of_network(mesh, &stars, sample, network, &patches);
        let piece = match owners {
            SpringOwners::Body => whole(),
            SpringOwners::Cells(cells) => Piece::of_cells(mesh, sample, cells, &patches),
            SpringOwners::Edges(fit) => edge_springs(&sample.mesh, own.clone(), &fit)
                .map_or_else(|_| whole(), |of_sample| Piece::of_sample(mesh, sample, of_sample, &patches)),
        };
        let found = tensor(sample, &piece, &directions);
        let (found, asked) = match own.moduli() {
            CellMap::Uniform(one) if plane.height > ROUNDING || sample.is_joined => {
                let asked = of_material(&one, dimension);
                (flattened(found, body_tensor(sample, CellMap::Uniform(one), &directions), &asked), asked)
            }
            CellMap::Uniform(one) => (found, of_material(&one, dimension)),
            moduli => (found, body_tensor(sample, moduli, &directions)),
        };
        (found, asked, thickness(sample, own.thicknesses()))
    };
    let samples: Vec<_> = flat.par_iter().map(measure).collect();
    let thicknesses: Vec<f64> = samples.iter().map(|(.., thickness)| *thickness).collect();
    let (tensors, asked): (Vec<DMatrix<f64>>, Vec<DMatrix<f64>>) =
        samples.into_iter().map(|(c, asked, _)| (c, asked)).unzip();
    // The mean of tensors in Pa.
    let solid = |all: &[DMatrix<f64>]| -> DMatrix<f64> {
        let parts: Vec<_> = all.iter().zip(&thicknesses).map(|(c, thickness)| c / *thickness).collect();
        parts.iter().skip(1).fold(parts[0].clone(), |sum, c| sum + c) / count as f64
    };
    let mean = |all: &[DMatrix<f64>]| -> DMatrix<f64> {
        all.iter().skip(1).fold(all[0].clone(), |sum, c| sum + c) / count as f64
    };
    let stiffness = mean(&tensors);
    let distances: Vec<f64> = tensors.iter().zip(&asked).map(|(c, asked)| distance(c, asked)).collect();
    let state = material.state();
    let found = constants(&solid(&tensors), state);
    let has_one_thickness = material.thicknesses().uniform().is_some();
    let (asked, found, wanted) = match material.uniform() {
        Some(one) if has_one_thickness => {
            (of_material(&one.moduli().into(), dimension), found, Some((one.young(), Some(one.poisson()))))
        }
        _ => {
            let wanted = constants(&solid(&asked), state);
            // Where the thickness alone differs, the finite elements have Young's modulus of the material.
            let scale = one_young(material).zip(wanted).map_or(1.0, |(one, (young, _))| one / young);
            let scaled = |(young, poisson): (f64, Option<f64>)| (scale * young, poisson);
            (mean(&asked), found.map(scaled), wanted.map(scaled))
        }
    };
    if mesh.is_mixed() && matches!(owners, SpringOwners::Body) {
        // Springs that belong to no cell cannot be told from those of membranes and rods beside them.
        return NetworkMaterial {
            young: None,
            poisson: None,
            asked_young: wanted.map(|(young, _)| young),
            asked_poisson: wanted.and_then(|(_, poisson)| poisson),
            distance: f64::NAN,
            mean_distance: f64::NAN,
            largest_distance: f64::NAN,
            samples: count,
            seconds: start.seconds(),
            stiffness: stiffness * f64::NAN,
        };
    }
    NetworkMaterial {
        young: found.map(|(young, _)| young),
        poisson: found.and_then(|(_, poisson)| poisson),
        asked_young: wanted.map(|(young, _)| young),
        asked_poisson: wanted.and_then(|(_, poisson)| poisson),
        distance: (distances.iter().map(|d| d * d).sum::<f64>() / count as f64).sqrt(),
        mean_distance: distance(&stiffness, &asked),
        largest_distance: distances.iter().copied().fold(0.0, f64::max),
        samples: count,
        seconds: start.seconds(),
        stiffness,
    }
}

/// The sample around a point of as many points as are flat, or else of one cell, with its plane.
fn flat_sample(stars: &Stars, seed: usize, dimension: usize) -> (Sample, Plane) {
    let with_plane = |sample: Sample| {
        let plane = Plane::of(&sample, dimension);
        (sample, plane)
    };
    // A smaller piece of a bent sheet is flatter.
    let counts = std::iter::successors(Some(POINTS), |count| Some(count / 2)).take_while(|count| *count > 0);
    let mut samples = counts.map(|count| with_plane(stars.sample(seed, count)));
    samples
        .find(|(_, plane)| plane.height <= FLAT && plane.along >= ALONG)
        .unwrap_or_else(|| with_plane(stars.single(stars.around(seed).next().expect("every point belongs to a cell"))))
}

/// The mean thickness of a sample, m, or the mean cross-section, m²; 1 of a solid.
fn thickness(sample: &Sample, of_cells: CellMap<f64>) -> f64 {
    let content = |thickness| Moments::of_body(&sample.mesh, CellMap::Uniform(1.0), thickness).mass;
    content(of_cells) / content(CellMap::Uniform(1.0))
}

/// Young's modulus of all cells, if they have the same.
fn one_young(material: &MaterialMap) -> Option<f64> {
    let mut all = material.materials().ok()?.values().map(Material::young);
    let first = all.next()?;
    all.all(|young| young == first).then_some(first)
}
