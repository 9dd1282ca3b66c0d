//! The springs by which a sheet resists bending.
//!
//! Each edge has a director, a point that two springs hold beside the edge: it can turn about the edge, and nothing else. Three springs of each
//! triangle measure how the triangle has turned from its directors. They are the plate of Morley: its finite elements and its network are the same.
//!
//! Theory: page *Sheets that bend* of the book.

use super::network::{LengthSpring, MeasureSpring, Network};
use crate::element::SpringKind;
use crate::material::{CellMap, EnergyMap, Hooke, Material};
use crate::mesh::{Directors, Mesh};
use crate::springs::{BEND_POINTS, Bend, Measure, cross, distance, dot, norm};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use smallvec::SmallVec;

/// The springs of the directors of a sheet, or none. `moduli` are those of the membrane, N/m: a plate of thickness t has `D = C t²/12` of them, N·m.
///
/// A triangle of area A has the curvature `κ = (1/A) Σ_i l_i a_i n_i n_iᵀ`, with l_i the lengths of its edges, n_i their conormals and a_i its turns from their
/// directors, and the energy `A/2 κ·D·κ`. With the eigenvectors d_m of D and their eigenvalues λ_m this is the energy of three springs
/// `½ (λ_m/A) c_m²` with `c_m = Σ_i l_i (d_m·v_i) a_i` and `v_i = (n_x², n_y², 2 n_x n_y)` of the conormal in the axes of the triangle.
pub fn plate_springs(mesh: &Mesh, moduli: &CellMap<Hooke>) -> Network {
    let mut network = Network { dimension: mesh.dimension, ..Network::default() };
    let Some(directors) = &mesh.directors else { return network };
    let mut holds = vec![0.0; directors.edges.len()];
    let first = mesh.node_count();
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let membrane = Matrix3::from_row_slice(&moduli.at(0, cell).entries(2).0);
        for director in directors.of_cells[cell] {
            holds[director - first] += membrane[(0, 0)];
        }
        let points: SmallVec<[usize; 4]> = nodes.iter().copied().chain(directors.of_cells[cell]).collect();
        network.others.extend(bends(mesh, &points, &(membrane * directors.gyration[cell])));
    }
    network.lengths = levers(mesh, directors, &holds);
    network
}

/// The springs of the directors of a sheet with laws of large deformation, of which a plate has the moduli at rest.
pub(super) fn plate_at_large_deformation(mesh: &Mesh, laws: &EnergyMap) -> Network {
    let hooke = |cell: usize| {
        let (energy, state) = laws.at(0, cell);
        let material = Material::new(energy.young(), energy.poisson(), state);
        Hooke::Isotropic(material.expect("a law is that of a material").moduli())
    };
    match &mesh.directors {
        None => Network { dimension: mesh.dimension, ..Network::default() },
        Some(directors) => {
            plate_springs(mesh, &CellMap::of_blocks(vec![(0..directors.of_cells.len()).map(hooke).collect()]))
        }
    }
}

/// The three springs of a triangle with the flexural stiffness D, N·m, in the order xx, yy, xy with shear strains 2 ε.
fn bends(mesh: &Mesh, points: &SmallVec<[usize; 4]>, d: &Matrix3<f64>) -> Vec<MeasureSpring> {
    let at = |place: usize| -> [f64; 3] { std::array::from_fn(|k| mesh.point(points[place])[k]) };
    let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let vector = mesh.area_vector(&points[..3]);
    let area = norm(&vector);
    let normal = vector.map(|a| a / area);
    let edge = |corner: usize| minus(at((corner + 2) % 3), at((corner + 1) % 3));
    // The axes of the triangle: along its first edge, as those of its membrane are, and across it.
    let along = minus(at(1), at(0));
    let axis = along.map(|x| x / norm(&along));
    let other = cross(normal, axis);
    let of_edge = |corner: usize| {
        let edge = edge(corner);
        let length = norm(&edge);
        let conormal = cross(edge.map(|x| x / length), normal);
        let [x, y] = [dot(&conormal, &axis), dot(&conormal, &other)];
        length * Vector3::new(x * x, y * y, 2.0 * x * y)
    };
    let of_edges: [Vector3<f64>; 3] = std::array::from_fn(of_edge);
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(*d);
    let positions: Vec<f64> = (0..BEND_POINTS).flat_map(at).collect();
    let spring = |m: usize| {
        let weights = of_edges.map(|v| v.dot(&eigenvectors.column(m)));
        let measure = Measure::Bend(Box::new(Bend { weights }));
        let rest = measure.value(&positions, 3);
        let constant = eigenvalues[m] / area;
        MeasureSpring { kind: SpringKind::Bend, points: points.clone(), constant, rest, measure, law: None }
    };
    (0..3).map(spring).collect()
}

/// The springs from the ends of each edge to its director. They hold it in the plane of the edge and of itself, in which nothing pulls at it.
fn levers(mesh: &Mesh, directors: &Directors, holds: &[f64]) -> Vec<LengthSpring> {
    let first = mesh.node_count();
    let lever = |(e, edge): (usize, &[usize; 2])| {
        edge.map(|end| LengthSpring {
            points: [end, first + e],
            constant: holds[e],
            rest: distance(mesh.point(end), mesh.point(first + e)),
        })
    };
    let mut all: Vec<LengthSpring> = directors.edges.iter().enumerate().flat_map(lever).collect();
    all.sort_by_key(|spring| spring.points);
    all
}
