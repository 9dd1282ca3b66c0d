//! The springs by which a sheet resists bending.
//!
//! Each edge has a director, a point that two springs hold beside the edge: it can turn about the edge, and nothing else. Three springs of each
//! triangle measure how the triangle has turned from its directors. They are the plate of Morley: its finite elements and its network are the same.
//!
//! Theory: page *Sheets that bend* of the book.

use super::network::{LengthSpring, MeasureSpring, Network};
use crate::element::SpringKind;
use crate::material::{CellMap, Hooke};
use crate::mesh::{Directors, Mesh};
use crate::springs::{BEND_POINTS, Turns, cross, distance, dot, norm, turn_points};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use smallvec::SmallVec;
use std::f64::consts::FRAC_PI_2;

/// The springs of a sheet as a plate, three of each triangle on its turns from all its directors, by the moduli of its membrane, N/m: a plate of thickness t has
/// `D = C t²/12` of them, N·m.
pub(super) fn plate(mesh: &Mesh, directors: &Directors, moduli: &CellMap<Hooke>) -> Network {
    sheet(mesh, directors, moduli, |triangle, stiffness| triangle.bends(stiffness))
}

/// The springs of a sheet with hinges, one of each triangle on its turn from each director.
pub(super) fn hinges(mesh: &Mesh, directors: &Directors, moduli: &CellMap<Hooke>) -> Network {
    sheet(mesh, directors, moduli, |triangle, stiffness| triangle.hinges(stiffness))
}

/// What the springs of a triangle are by the flexural stiffness.
type Springs = fn(&Triangle, &Matrix3<f64>) -> [MeasureSpring; 3];

fn sheet(mesh: &Mesh, directors: &Directors, moduli: &CellMap<Hooke>, springs: Springs) -> Network {
    let mut network = Network { dimension: mesh.dimension, ..Network::default() };
    let mut holds = vec![0.0; directors.edges.len()];
    let first = mesh.node_count();
    let mut sides = vec![0; directors.edges.len()];
    // Directors of three triangles and more keep their angles: no flat shape of such an edge is known.
    directors.of_cells.iter().for_each(|director| sides[director - first] += 1);
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let membrane = Matrix3::from_row_slice(&moduli.at(0, cell).entries(2).0);
        for &director in directors.of_cell(cell) {
            let middle = mesh.mean_place(&directors.edges[director - first]);
            // As stiff for the mass of the director as the membrane is for that of its points, so that no explicit step is shorter.
            let share = directors.gyration[cell] / distance(&middle, mesh.point(director)).powi(2);
            holds[director - first] += share * membrane[(0, 0)];
        }
        let points: SmallVec<[usize; BEND_POINTS]> = nodes.iter().chain(directors.of_cell(cell)).copied().collect();
        let mut triangle = Triangle::of(mesh, &points);
        if directors.flat {
            triangle.flatten(|corner| sides[directors.of_cell(cell)[corner] - first] <= 2);
        }
        let stiffness = membrane * directors.gyration[cell];
        network.others.extend(springs(&triangle, &stiffness));
    }
    network.lengths = levers(mesh, directors, &holds);
    network
}

/// A triangle of a sheet, with the directors of its edges.
struct Triangle<'a> {
    points: &'a [usize],
    positions: Vec<f64>,
    area: f64,
    /// Each edge, in the order of the opposite corners, has its length l, m, and `v = (n_x², n_y², 2 n_x n_y)` of its
    /// conormal in the axes of the triangle, in which its membrane has its moduli.
    edges: [(f64, Vector3<f64>); 3],
    /// How far each turn is from that at rest, rad, in the same order: zero where the sheet is at rest as it is.
    bent: [f64; 3],
}

impl<'a> Triangle<'a> {
    fn of(mesh: &Mesh, points: &'a [usize]) -> Triangle<'a> {
        let at = |place: usize| -> [f64; 3] { std::array::from_fn(|k| mesh.point(points[place])[k]) };
        let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
        let vector = mesh.area_vector(&points[..3]);
        let area = norm(&vector);
        let normal = vector.map(|a| a / area);
        // The axes of the triangle: along its first edge, as those of its membrane are, and across it.
        let along = minus(at(1), at(0));
        let axis = along.map(|x| x / norm(&along));
        let other = cross(normal, axis);
        let of_edge = |corner: usize| {
            let edge = minus(at((corner + 2) % 3), at((corner + 1) % 3));
            let length = norm(&edge);
            let conormal = cross(edge.map(|x| x / length), normal);
            let [x, y] = [dot(&conormal, &axis), dot(&conormal, &other)];
            // A turn about the edge is the curvature `n nᵀ`, whose mixed entry counts twice, as in strains.
            (length, Vector3::new(x * x, y * y, 2.0 * x * y))
        };
        let positions = (0..BEND_POINTS).flat_map(at).collect();
        Triangle { points, positions, area, edges: std::array::from_fn(of_edge), bent: [0.0; 3] }
    }

    /// Lets the sheet be at rest where its directors stand upright on the triangle, at the edges that are asked for: the triangles at each are then in one
    /// plane.
    fn flatten(&mut self, is_flat: impl Fn(usize) -> bool) {
        let hinge = |corner| self.spring(SpringKind::Hinge, turn_points(corner), Turns::of_hinge(), [0.0; 2]).rest;
        let bent = |corner| {
            let turn: f64 = hinge(corner);
            // Triangles of either order have their normals on this side of the director or on the other.
            if is_flat(corner) { turn - FRAC_PI_2.copysign(turn) } else { 0.0 }
        };
        self.bent = std::array::from_fn(bent);
    }

    /// The springs of a plate with the flexural stiffness D, N·m, in the order xx, yy, xy with shear strains 2 ε.
    ///
    /// A triangle of area A has the curvature `κ = (1/A) Σ_i l_i a_i n_i n_iᵀ`, with l_i the lengths of its edges, n_i their conormals and a_i its turns from
    /// their directors, and the energy `A/2 κ·D·κ`. With the eigenvectors d_m of D and their eigenvalues λ_m this is the energy of three springs
    /// `½ (λ_m/A) c_m²` with `c_m = Σ_i l_i (d_m·v_i) a_i`.
    fn bends(&self, d: &Matrix3<f64>) -> [MeasureSpring; 3] {
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(*d);
        std::array::from_fn(|m| {
            let weights = self.edges.map(|(length, v)| length * v.dot(&eigenvectors.column(m)));
            let bent = dot(&weights, &self.bent);
            self.spring(
                SpringKind::Bend,
                0..BEND_POINTS,
                Turns::of_triangle(weights),
                [eigenvalues[m] / self.area, bent],
            )
        })
    }

    /// A spring on each turn alone, of the constant `D_n l²/A` with `D_n = v·D·v` that of curvature across the edge. The springs of two triangles on one
    /// director are, where nothing holds it, a spring of the constant `D_n l²/(A₁ + A₂)` on the angle between both.
    fn hinges(&self, d: &Matrix3<f64>) -> [MeasureSpring; 3] {
        std::array::from_fn(|corner| {
            let (length, v) = self.edges[corner];
            let constant = v.dot(&(d * v)) * length * length / self.area;
            self.spring(SpringKind::Hinge, turn_points(corner), Turns::of_hinge(), [constant, self.bent[corner]])
        })
    }

    /// A spring of this constant on the turns of these points, which measures this more than at rest.
    fn spring(
        &self,
        kind: SpringKind,
        places: impl IntoIterator<Item = usize>,
        turns: Turns,
        [constant, bent]: [f64; 2],
    ) -> MeasureSpring {
        let places: SmallVec<[usize; BEND_POINTS]> = places.into_iter().collect();
        let x: Vec<f64> = places.iter().flat_map(|p| &self.positions[3 * p..3 * p + 3]).copied().collect();
        let points = places.iter().map(|&place| self.points[place]).collect();
        let spring = MeasureSpring::turning(kind, points, &x, turns, constant);
        MeasureSpring { rest: spring.rest - bent, ..spring }
    }
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
    // Networks have their lengths sorted by their points.
    all.sort_by_key(|spring| spring.points);
    all
}
