//! Closed surfaces of triangles.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::coincident::Coincident;
use crate::mesh::resolution::check_size;
use crate::mesh::source::{Format, MeshSource};
use crate::springs::{cross, dot, norm};
use std::collections::HashMap;

/// Triangles that close one or several volumes, with their normals outwards.
pub(super) struct Surface {
    /// The coordinates, m.
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
    /// The place among the faces of the file of each triangle, from 0.
    pub faces: Vec<u32>,
    /// The enclosed volume by the divergence theorem, `∫ x·n dA / 3`, m³.
    pub volume: f64,
    /// m².
    pub area: f64,
    pub low: [f64; 3],
    pub high: [f64; 3],
    /// Whether all normals were inwards and have been turned.
    pub is_turned: bool,
    /// Triangles without an area, which were left out.
    pub flat: usize,
    /// Edges with more than two triangles, and the middle of one.
    pub branched: Option<(usize, [f64; 3])>,
}

impl Surface {
    /// The surface in `source`, with `scale` metres per unit. Points at equal coordinates are one point.
    ///
    /// # Errors
    /// It has other cells than triangles and quadrangles, or is not closed, or its triangles are not turned alike.
    pub fn of(source: &MeshSource, scale: f64) -> Result<Surface> {
        let mut coincident = Coincident::default();
        let mut index = |node: usize| coincident.index(source.points[node].map(|x| x * scale));
        let (mut triangles, mut faces) = (Vec::new(), Vec::new());
        let (mut flat, mut face) = (0, 0);
        for block in source.blocks.iter().filter(|block| block.dimension > 1) {
            let is_known = match (source.format, block.cell_type) {
                (Format::Vtk, 5 | 9) | (Format::Gmsh, 2 | 3) => true,
                (Format::Vtk | Format::Gmsh, _) => false,
            };
            if !is_known {
                let found = format!("cells with {} nodes in {} dimensions", block.nodes_per_cell, block.dimension);
                return Err(
                    Error::expected("surface", "triangles or quadrangles", found).of_kind(ErrorKind::Unsupported)
                );
            }
            for cell in block.connectivity.chunks_exact(block.nodes_per_cell) {
                let nodes: Vec<usize> = cell.iter().map(|&node| index(node)).collect();
                for i in 2..nodes.len() {
                    let triangle = [nodes[0], nodes[i - 1], nodes[i]];
                    let [a, b, c] = triangle;
                    match a == b || b == c || c == a {
                        true => flat += 1,
                        false => {
                            triangles.push(triangle);
                            faces.push(face);
                        }
                    }
                }
                face += 1;
            }
        }
        if triangles.is_empty() {
            return Err(Error::expected("surface", "triangles or quadrangles", "none"));
        }
        let points = coincident.points;
        check_size(points.iter().flatten().copied())?;
        let branched = check_edges(&points, &triangles)?;
        let end = |k: usize, pick: fn(f64, f64) -> f64, start: f64| {
            triangles.iter().flatten().map(|&p| points[p][k]).fold(start, pick)
        };
        let low: [f64; 3] = std::array::from_fn(|k| end(k, f64::min, f64::INFINITY));
        let high: [f64; 3] = std::array::from_fn(|k| end(k, f64::max, f64::NEG_INFINITY));
        let from_low = |p: usize| std::array::from_fn::<f64, 3, _>(|k| points[p][k] - low[k]);
        let (mut volume, mut area) = (0.0, 0.0);
        for &[a, b, c] in &triangles {
            let [x, y, z] = [a, b, c].map(from_low);
            volume += dot(&x, &cross(y, z)) / 6.0;
            let along = |end: [f64; 3]| std::array::from_fn(|k| end[k] - x[k]);
            area += norm(&cross(along(y), along(z))) / 2.0;
        }
        let is_turned = volume < 0.0;
        if is_turned {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let volume = volume.abs();
        if !(volume > 0.0) {
            return Err(Error::expected("surface", "a surface that encloses a volume", format!("{volume} m³")));
        }
        Ok(Surface { points, triangles, faces, volume, area, low, high, is_turned, flat, branched })
    }
}

/// That each edge is passed as often in one direction as in the other. Returns how many edges have more than two
/// triangles, and where one is.
///
/// # Errors
/// An edge is not. The error counts such edges and gives the ends of one.
fn check_edges(points: &[[f64; 3]], triangles: &[[usize; 3]]) -> Result<Option<(usize, [f64; 3])>> {
    // How often an edge is passed from its lower to its higher point, and back.
    let mut passed: HashMap<[usize; 2], [u32; 2]> = HashMap::with_capacity(triangles.len() * 3 / 2);
    for triangle in triangles {
        for i in 0..3 {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            passed.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
        }
    }
    let fault = |what: &str, expected: &str, is_such: &dyn Fn(&[u32; 2]) -> bool| {
        let such = passed.iter().filter(|(_, count)| is_such(count)).map(|(edge, _)| *edge);
        let (mut count, mut one) = (0, None);
        for edge in such {
            count += 1;
            one = Some(one.map_or(edge, |other: [usize; 2]| other.min(edge)));
        }
        let [a, b] = one?;
        let found = format!("{count} {what}, one from {:?} to {:?} m", points[a], points[b]);
        Some(Error::expected("surface", expected, found))
    };
    let faults = [
        fault("edges of one triangle alone: holes", "a closed surface", &|&[a, b]| a + b == 1),
        fault("edges between triangles that are turned differently", "normals that all point outwards", &|&[a, b]| {
            a + b == 2 && a != b
        }),
        fault("edges of three or more triangles that do not close", "a closed surface", &|&[a, b]| a != b),
    ];
    if let Some(error) = faults.into_iter().flatten().next() {
        return Err(error.followed_by("; a modelling program closes holes and turns normals outwards"));
    }
    let branched = passed.iter().filter(|(_, count)| count[0] > 1).map(|(edge, _)| *edge);
    let (count, one) = branched.fold((0, None), |(count, one): (usize, Option<[usize; 2]>), edge| {
        (count + 1, Some(one.map_or(edge, |one| one.min(edge))))
    });
    Ok(one.map(|[a, b]| (count, std::array::from_fn(|k| (points[a][k] + points[b][k]) / 2.0))))
}
