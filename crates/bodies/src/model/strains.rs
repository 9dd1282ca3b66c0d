//! Springs on the strains of surfaces in space, on the domains of edges.
//!
//! The domain of an edge is a third of each of its triangles. Both triangles are laid into one plane, turned about the edge, so that neither a curved rest shape nor a
//! rotation is a strain. There Green's strain of the domain is the mean of theirs by area. It is linear in the squared lengths of the five edges.
//!
//! Theory: page *Sheets that bend* of the book.

use super::network::{MeasureSpring, Network};
use crate::element::SpringKind;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit, VolumeSprings};
use crate::material::{Hooke, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Measure, Squares, distance, dot, norm};
use nalgebra::{Matrix3, SymmetricEigen, Vector2, Vector3};
use rayon::prelude::*;
use smallvec::SmallVec;

/// The cosine of the angle between two triangles from which on the edge is a crease, across which strains jump.
// The angle is 60°: the sides of a cylinder that has seven or more are turned by 51° or less to each other, and those
// of a box by 90°.
const CREASE: f64 = 0.5;

/// Whether a mesh is a surface of linear triangles in space, whose domains of edges have springs on strains.
pub fn has_strains(mesh: &Mesh) -> bool {
    triangles(mesh).is_some()
}

/// The triangles, and which block they are.
fn triangles(mesh: &Mesh) -> Option<(usize, &CellBlock)> {
    let blocks: Vec<(usize, &CellBlock)> = mesh.body_blocks().collect();
    let [(index, block)] = blocks[..] else { return None };
    (mesh.dimension == 3 && mesh.cell_dimension() == 2 && block.element.nodes() == 3).then_some((index, block))
}

/// Checks that a surface in space has these springs.
///
/// # Errors
/// The energy is another one, or springs for λ are on cells or patches; the kind is `Unsupported`.
pub(super) fn check_strains(fit: &ExactFit) -> Result<()> {
    if fit.volume != VolumeSprings::Points {
        let expected = "\"points\" with shear = \"edges\" on a surface in space: its springs on strains carry λ too";
        let found = format!("\"{}\"", fit.volume.name());
        return Err(Error::expected("volume", expected, found).of_kind(ErrorKind::Unsupported));
    }
    if fit.energy != ExactEnergy::StVenantKirchhoff {
        let expected = "\"st-venant-kirchhoff\" with shear = \"edges\" on a surface in space: its springs on strains have this energy";
        let found = format!("\"{}\"", fit.energy.name());
        return Err(Error::expected("energy", expected, found).of_kind(ErrorKind::Unsupported));
    }
    Ok(())
}

/// The springs of the domains of all edges of a surface, three of each: with the mean Green's strain E of the domain, in the edge's own axes, they have the energy
/// `½ A E·C·E`, A the area of the domain and C the stiffness of the membrane, N/m.
///
/// Triangles keep strains of their own where the material is that of two regions, at edges of three and more triangles, and at creases of 60° and more.
///
/// # Errors
/// Those of [`check_strains`].
pub(super) fn strain_springs(mesh: &Mesh, material: &MaterialMap, fit: &ExactFit) -> Result<Network> {
    check_strains(fit)?;
    let mut network = Network { dimension: mesh.dimension, ..Network::default() };
    let Some((index, block)) = triangles(mesh) else { return Ok(network) };
    let region = |cell: usize| *material.region().at(index, cell);
    let moduli = material.moduli();
    let mut sides: Vec<([usize; 2], usize)> = Vec::with_capacity(block.connectivity.len());
    for (cell, nodes) in block.cells().enumerate() {
        let edges = [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|corner| nodes[corner]));
        sides.extend(edges.map(|[a, b]| ([a.min(b), a.max(b)], cell)));
    }
    // No two are equal, since each has its triangle: the order is the same however it is sorted.
    sides.par_sort_unstable();
    let of_edge = |parts: &[([usize; 2], usize)]| -> Vec<MeasureSpring> {
        let mut domain: SmallVec<[Share; 2]> =
            parts.iter().map(|&(edge, cell)| Share::of(mesh, block.cell(cell), edge, moduli.at(index, cell))).collect();
        match &mut domain[..] {
            [one, other]
                if region(parts[0].1) == region(parts[1].1) && is_smooth(mesh, block, [parts[0].1, parts[1].1]) =>
            {
                // Both are laid out above the edge; the second belongs below it.
                other.turn_over();
                springs(mesh, &[&*one, &*other]).into()
            }
            all => all.iter().flat_map(|own| springs(mesh, &[own])).collect(),
        }
    };
    let groups: Vec<&[([usize; 2], usize)]> = sides.chunk_by(|a, b| a.0 == b.0).collect();
    // Edges do not depend on each other, and the list keeps their order on any number of threads.
    network.others = groups.into_par_iter().flat_map_iter(of_edge).collect();
    Ok(network)
}

/// Whether a surface goes on from one triangle to another without a crease.
fn is_smooth(mesh: &Mesh, block: &CellBlock, cells: [usize; 2]) -> bool {
    let corners = cells.map(|cell| block.cell(cell));
    // Two triangles at an edge have one corner each that the other lacks. Triangles on the same three points lie on
    // each other.
    if corners[1].iter().filter(|p| !corners[0].contains(p)).count() != 1 {
        return false;
    }
    let [a, b] = corners.map(|nodes| mesh.area_vector(nodes));
    let cosine = dot(&a, &b) / (norm(&a) * norm(&b));
    // Triangles of one sheet may run through their edge alike, so that one of their normals is turned.
    let runs = corners.map(|nodes| {
        let at = |p: &usize| corners[0].contains(p) && corners[1].contains(p);
        let first = nodes.iter().position(&at).unwrap_or(0);
        if at(&nodes[(first + 1) % 3]) { nodes[first] } else { nodes[(first + 2) % 3] }
    });
    let cosine = if runs[0] == runs[1] { -cosine } else { cosine };
    cosine > CREASE
}

/// The share that an edge has in one of its triangles, laid into the plane of the axes along the edge and across it.
struct Share {
    /// The corners, and where they are in the plane, m.
    corners: [(usize, Vector2<f64>); 3],
    /// A third of the area of the triangle, m².
    area: f64,
    /// The stiffness in the axes of the edge, N/m.
    stiffness: Matrix3<f64>,
}

impl Share {
    fn of(mesh: &Mesh, nodes: &[usize], [a, b]: [usize; 2], hooke: &Hooke) -> Share {
        let (from, length) = (mesh.point(a), distance(mesh.point(a), mesh.point(b)));
        let area = norm(&mesh.area_vector(nodes));
        let place = |p: usize| {
            let along: f64 =
                (0..3).map(|k| (mesh.point(p)[k] - from[k]) * (mesh.point(b)[k] - from[k])).sum::<f64>() / length;
            match p {
                _ if p == a => Vector2::zeros(),
                _ if p == b => Vector2::new(length, 0.0),
                _ => Vector2::new(along, 2.0 * area / length),
            }
        };
        let corners = [0, 1, 2].map(|i| (nodes[i], place(nodes[i])));
        // The axes of the triangle, in which its membrane has its moduli: along its first edge, and across it towards the third corner.
        let first = (corners[1].1 - corners[0].1).normalize();
        let to_third = corners[2].1 - corners[0].1;
        let second = (to_third - first * first.dot(&to_third)).normalize();
        let turn = strain_in([first, second]);
        let stiffness = turn.transpose() * Matrix3::from_row_slice(&hooke.entries(2).0) * turn;
        // Each of the three edges has a third of the triangle.
        Share { corners, area: area / 3.0, stiffness }
    }

    /// Turns the triangle over to the other side of the edge.
    fn turn_over(&mut self) {
        self.corners.iter_mut().for_each(|(_, x)| x.y = -x.y);
        // Seen from the other side shear has the other sign.
        let turn = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
        self.stiffness = turn * self.stiffness * turn;
    }

    /// What the square of each edge's length gives to the strain: `−½ sym(∇N_a ⊗ ∇N_b)`, in the order along, across, shear 2 ε.
    fn squares(&self) -> [([usize; 2], Vector3<f64>); 3] {
        let x = self.corners.map(|(_, x)| x);
        let twice = (x[1] - x[0]).perp(&(x[2] - x[0]));
        let slope = [0, 1, 2].map(|i| {
            let opposite = x[(i + 2) % 3] - x[(i + 1) % 3];
            Vector2::new(-opposite.y, opposite.x) / twice
        });
        [[0, 1], [1, 2], [2, 0]].map(|[i, j]| {
            let (g, h) = (slope[i], slope[j]);
            let strain = Vector3::new(g.x * h.x, g.y * h.y, g.x * h.y + g.y * h.x) * -0.5;
            let [a, b] = [self.corners[i].0, self.corners[j].0];
            ([a.min(b), a.max(b)], strain)
        })
    }
}

/// The strains along two directions p, q and their shear 2 ε, from those along the axes.
fn strain_in([p, q]: [Vector2<f64>; 2]) -> Matrix3<f64> {
    Matrix3::new(
        p.x * p.x,
        p.y * p.y,
        p.x * p.y,
        q.x * q.x,
        q.y * q.y,
        q.x * q.y,
        2.0 * p.x * q.x,
        2.0 * p.y * q.y,
        p.x * q.y + p.y * q.x,
    )
}

/// The springs of a domain. With the eigenvectors d_m of its stiffness and their eigenvalues λ_m its energy `½ A E·C·E` is that of three springs
/// `½ (A λ_m) (d_m·E)²`.
fn springs(mesh: &Mesh, shares: &[&Share]) -> [MeasureSpring; 3] {
    let area: f64 = shares.iter().map(|share| share.area).sum();
    let mut stiffness = Matrix3::zeros();
    let mut points: SmallVec<[usize; 4]> = SmallVec::new();
    let mut squares: SmallVec<[([usize; 2], Vector3<f64>); 6]> = SmallVec::new();
    for share in shares {
        stiffness += share.stiffness * (share.area / area);
        for (point, _) in share.corners {
            if !points.contains(&point) {
                points.push(point);
            }
        }
        for (pair, strain) in share.squares() {
            let strain = strain * (share.area / area);
            match squares.iter_mut().find(|(known, _)| *known == pair) {
                Some((_, sum)) => *sum += strain,
                None => squares.push((pair, strain)),
            }
        }
    }
    // Springs of one domain follow each other with the same points, which prepared networks rely on.
    points.sort_unstable();
    let place = |point: usize| points.iter().position(|p| *p == point).unwrap_or_default();
    let places: SmallVec<[[usize; 2]; 6]> = squares.iter().map(|(pair, _)| pair.map(place)).collect();
    let x: Vec<f64> = points.iter().flat_map(|&p| mesh.point(p)).copied().collect();
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(stiffness);
    std::array::from_fn(|m| {
        let direction = eigenvectors.column(m);
        let weights = squares.iter().map(|(_, strain)| direction.dot(strain));
        let own = Squares::new(places.iter().map(|places| &places[..]).zip(weights), points.len());
        let measure = Measure::Squares(Box::new(own.expect("two corners of a triangle are two points of the domain")));
        MeasureSpring {
            kind: SpringKind::Strain,
            points: points[..].into(),
            constant: eigenvalues[m] * area,
            rest: measure.value(&x, 3),
            measure,
            law: None,
        }
    })
}
