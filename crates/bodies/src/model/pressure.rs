//! The pressure in a network with volume springs on patches.

use super::network::{MeasureSpring, Network};
use crate::material::{Material, State};
use crate::mesh::Mesh;
use crate::springs::{Content, Measure, Patch};
use crate::stiffness::gather;
use std::collections::HashMap;

/// The mean pressure `−(σ₁ + σ₂ + σ₃)/3` under the displacements u, `[points]`, Pa; `None` of networks without patches.
///
/// That of the patches alternates from point to point: displacements and pressures of this pair are not stable in the sense of
/// Babuška and Brezzi. It is averaged twice, from patches to cells and from cells to their points, which takes the alternating part
/// away. With `linear`, changes of volume are those of the linear theory.
pub fn smoothed_pressure(
    mesh: &Mesh,
    network: &Network,
    material: Material,
    u: &[f64],
    linear: bool,
) -> Option<Vec<f64>> {
    let bulk = bulk_modulus(material);
    let mut cells: HashMap<Vec<usize>, (f64, f64)> = HashMap::new();
    for spring in &network.others {
        let Measure::Patch(patch) = &spring.measure else { continue };
        let pressure = -bulk * dilatation(mesh, spring, u, linear);
        for (nodes, share, content) in contents(mesh, spring, patch) {
            let cell = cells.entry(nodes).or_insert((content, 0.0));
            cell.1 += share * pressure;
        }
    }
    if cells.is_empty() {
        return None;
    }
    let (mut sums, mut weights) = (vec![0.0; mesh.point_count()], vec![0.0; mesh.point_count()]);
    for (nodes, (content, pressure)) in &cells {
        for &point in nodes {
            sums[point] += content * pressure;
            weights[point] += content;
        }
    }
    Some(sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect())
}

/// K in `p = −K (J − 1)`, J the change of volume, or of the area in a plane.
fn bulk_modulus(material: Material) -> f64 {
    let t = material.thickness();
    let moduli = material.moduli();
    let (lambda, mu) = (moduli.lambda / t, moduli.mu / t);
    match material.state() {
        State::PlaneStress { .. } => 2.0 * (lambda + mu) / 3.0,
        State::Rod { .. } => (lambda + 2.0 * mu) / 3.0,
        State::Solid | State::PlaneStrain { .. } => lambda + 2.0 * mu / 3.0,
    }
}

/// `J − 1` of the patch.
fn dilatation(mesh: &Mesh, spring: &MeasureSpring, u: &[f64], linear: bool) -> f64 {
    let d = mesh.dimension;
    let local = |values: &[f64]| {
        let mut local = vec![0.0; spring.points.len() * d];
        gather(values, d, &spring.points, &mut local);
        local
    };
    let (x, u) = (local(&mesh.points), local(u));
    if linear {
        let gradient = spring.measure.gradient(&x, d);
        return gradient.iter().zip(&u).map(|(g, u)| g * u).sum::<f64>() / spring.rest;
    }
    let now: Vec<f64> = x.iter().zip(&u).map(|(x, u)| x + u).collect();
    spring.measure.value(&now, d) / spring.rest - 1.0
}

/// The points, the share and the content at rest of each cell of the patch.
fn contents(mesh: &Mesh, spring: &MeasureSpring, patch: &Patch) -> Vec<(Vec<usize>, f64, f64)> {
    let d = mesh.dimension;
    let mut x = vec![0.0; patch.element.nodes() * d];
    let of_cell = |(places, share): &(Vec<usize>, f64)| {
        let nodes: Vec<usize> = places.iter().map(|&place| spring.points[place]).collect();
        gather(&mesh.points, d, &nodes, &mut x);
        let content = Content::of_cell(&patch.element.tabulation, &x).value();
        (nodes, *share, content)
    };
    patch.cells.iter().map(of_cell).collect()
}
