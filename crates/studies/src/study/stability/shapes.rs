//! The cases of one element: materials, sizes, positions and shapes, from ordinary to impossible ones.

use super::outcome::Family;
use crate::analysis::shapes::random_shapes;
use crate::element::{Cell, Element};
use crate::error::Result;
use crate::material::{Material, Plane};
use nalgebra::{Rotation3, Vector3};

/// The seed of the ordinary shape.
const SEED: u64 = 8;
/// Young's modulus of the ordinary case, Pa.
const YOUNG: f64 = 10e3;
/// Poisson's ratio of the ordinary case.
const POISSON: f64 = 0.3;
/// The size of the ordinary case, m.
const SIZE: f64 = 0.01;

/// Poisson's ratios, from nearly −1 to nearly incompressible.
const RATIOS: [f64; 10] = [-0.99, -0.9, -0.5, 0.0, 0.25, 0.4, 0.49, 0.499, 0.4999, 0.499999];
/// The powers of ten of Young's modulus relative to the ordinary case: least, largest and step.
const MODULI: [i32; 3] = [-12, 15, 3];
/// The powers of ten of the size in m: least, largest and step.
const SIZES: [i32; 3] = [-9, 7, 2];
/// The powers of ten of the distance from the origin, relative to the size: least, largest and step.
const PLACES: [i32; 3] = [0, 8, 2];
/// The powers of ten of the length of needles, relative to their width: least, largest and step.
const ASPECTS: [i32; 3] = [1, 8, 1];
/// The powers of ten of the height of flat elements, relative to their width: least, largest and step.
const FLATNESS: [i32; 3] = [-14, -2, 2];
/// The positions of nodes on edges: shares of the way from the middle to the first corner.
// In quadratic cells the node is a quarter of the edge from the corner at half of the way, where the Jacobian vanishes
// in the corner (Barsoum, Int. J. Numer. Methods Eng. 10, 1976); at 0.6 it is negative there.
const BENT: [f64; 7] = [0.1, 0.2, 0.3, 0.4, 0.45, 0.49, 0.6];
/// The position of a corner on its way to the middle of its neighbours; the last one is beyond it.
const CORNERS: [f64; 4] = [0.9, 0.99, 1.0, 1.1];

/// One shape of one material.
#[derive(Debug, Clone)]
pub struct ShapeCase {
    pub family: Family,
    /// What is varied, and its value, in words.
    pub name: String,
    /// The positions of the nodes, `[nodes × dimension]`, m.
    pub x: Vec<f64>,
    pub material: Material,
}

/// Every case of the element; those of one family in ascending order.
///
/// # Errors
/// No valid shape of the element is found.
pub fn shape_cases(element: &Element) -> Result<Vec<ShapeCase>> {
    let d = element.dimension();
    let plain: Vec<f64> = random_shapes(element, 1, SEED)?.iter().map(|x| SIZE * x).collect();
    let planes = if d == 2 { vec![Some(Plane::Stress), Some(Plane::Strain)] } else { vec![None] };
    let usual = |e: f64| Material::for_body(d, e, POISSON, None, None);
    let mut cases = Vec::new();
    let mut add = |family, name: String, x: Vec<f64>, material| cases.push(ShapeCase { family, name, x, material });
    for plane in planes {
        let state = match plane {
            Some(Plane::Stress) => ", plane stress",
            Some(Plane::Strain) => ", plane strain",
            None => "",
        };
        // The moduli of plane stress alone are finite at 1/2.
        let most = (plane == Some(Plane::Stress)).then_some(0.5);
        for nu in RATIOS.into_iter().chain(most) {
            let material = Material::for_body(d, YOUNG, nu, plane, None)?;
            add(Family::Poisson, format!("nu = {nu}{state}"), plain.clone(), material);
        }
    }
    for decade in decades(MODULI) {
        add(Family::Young, format!("E = 1e{decade} Pa"), plain.clone(), usual(10f64.powi(decade))?);
    }
    let usual = usual(YOUNG)?;
    for decade in decades(SIZES) {
        let x = plain.iter().map(|x| x / SIZE * 10f64.powi(decade)).collect();
        add(Family::Size, format!("1e{decade} m"), x, usual);
    }
    for decade in decades(PLACES) {
        let x = plain.iter().map(|x| x / SIZE + 10f64.powi(decade)).collect();
        add(Family::Place, format!("1 m at 1e{decade} m"), x, usual);
    }
    for decade in decades(ASPECTS) {
        let mut along = vec![0.0; d];
        along[0] = 1.0;
        let x = turned(&scaled(&plain, d, &along, 10f64.powi(decade)), d);
        add(Family::Needle, format!("1 : 1e{decade}"), x, usual);
    }
    for decade in decades(FLATNESS) {
        let mut along = vec![0.0; d];
        along[d - 1] = 1.0;
        let x = turned(&scaled(&plain, d, &along, 10f64.powi(decade)), d);
        add(Family::Cap, format!("1 : 1e{decade}"), x, usual);
    }
    for decade in decades(FLATNESS) {
        // A direction that is normal to no face of a box or a simplex.
        let along: Vec<f64> = (0..d).map(|k| if k + 1 == d { -1.0 } else { 1.0 }).collect();
        add(Family::Sliver, format!("1 : 1e{decade}"), scaled(&plain, d, &along, 10f64.powi(decade)), usual);
    }
    let nearest = element.springs.iter().find_map(|group| group.nodes.first().filter(|nodes| nodes.len() == 2));
    if let Some([a, b]) = nearest.map(|nodes| [nodes[0], nodes[1]]) {
        for decade in decades(FLATNESS) {
            let x = moved(&plain, d, b, &[a], 1.0 - 10f64.powi(decade));
            add(Family::Near, format!("two nodes 1e{decade} apart"), x, usual);
        }
    }
    let corners: Vec<usize> = (0..element.cell.corners().len()).filter_map(|i| element.corner_node(i)).collect();
    if let Some(between) = (0..element.nodes()).find(|a| !corners.contains(a)) {
        for share in BENT {
            let x = moved(&plain, d, between, &corners[..1], share);
            add(Family::Bent, format!("{share} of the way to a corner"), x, usual);
        }
    }
    if element.cell == Cell::Quadrilateral {
        for share in CORNERS {
            let x = moved(&plain, d, corners[1], &[corners[0], corners[2]], share);
            add(Family::Corner, format!("{share} of the way to 180 degrees"), x, usual);
        }
    }
    if let Some(order) = &element.reflection {
        let x = order.iter().flat_map(|&a| plain[a * d..(a + 1) * d].to_vec()).collect();
        add(Family::Reversed, "numbered the other way round".into(), x, usual);
    }
    Ok(cases)
}

fn decades([least, largest, step]: [i32; 3]) -> impl Iterator<Item = i32> {
    (least..=largest).step_by(step as usize)
}

/// The shape with lengths along a direction multiplied by `factor`.
fn scaled(x: &[f64], d: usize, direction: &[f64], factor: f64) -> Vec<f64> {
    let square: f64 = direction.iter().map(|v| v * v).sum();
    let image = |x: &[f64]| {
        let along = direction.iter().zip(x).map(|(v, x)| v * x).sum::<f64>() / square * (factor - 1.0);
        x.iter().zip(direction).map(|(x, v)| x + along * v).collect::<Vec<_>>()
    };
    x.chunks_exact(d).flat_map(image).collect()
}

/// The shape rotated by angles that align no axes.
fn turned(x: &[f64], d: usize) -> Vec<f64> {
    let turn = match d {
        // Angles without a pattern put the thin direction along no axis, so that all coordinates are rounded.
        3 => Rotation3::from_euler_angles(0.3, 0.7, 1.1),
        _ => Rotation3::from_axis_angle(&Vector3::z_axis(), 0.7),
    };
    let image = |x: &[f64]| {
        let image = turn * Vector3::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        image.as_slice()[..d].to_vec()
    };
    x.chunks_exact(d).flat_map(image).collect()
}

/// The shape with node `a` moved by this share of the way to the middle of the nodes `to`.
fn moved(x: &[f64], d: usize, a: usize, to: &[usize], share: f64) -> Vec<f64> {
    let mut moved = x.to_vec();
    for k in 0..d {
        let middle = to.iter().map(|b| x[b * d + k]).sum::<f64>() / to.len() as f64;
        // Computed from the middle, so that a small remaining distance has all digits.
        moved[a * d + k] = middle + (1.0 - share) * (x[a * d + k] - middle);
    }
    moved
}
