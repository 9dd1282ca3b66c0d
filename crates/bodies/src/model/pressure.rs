//! The pressure in a network with volume springs on patches.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::{MeasureSpring, Network};
use crate::material::{Material, MaterialMap, State};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Content, Measure, Patch};
use crate::stiffness::{gather, gathered};
use std::collections::{BTreeMap, HashMap};

/// The mean pressure `−(σ₁ + σ₂ + σ₃)/3` under the displacements u, `[points]`, Pa; `None` for networks without
/// patches.
///
/// The pressure of the patches oscillates from point to point, because this pair of displacements and pressures is not
/// inf-sup stable (Babuška and Brezzi). It is averaged twice from points to cells and back, which removes the
/// oscillation. With `linear`, changes of volume are those of the linear theory.
pub fn smoothed_pressure(
    mesh: &Mesh,
    network: &Network,
    material: &MaterialMap,
    u: &[f64],
    linear: bool,
) -> Option<Vec<f64>> {
    let bulk = Bulk::of(mesh, material)?;
    // Patches know their cells by their nodes. Sorted, so that sums have the same bits in each run.
    let mut cells: BTreeMap<Vec<usize>, [f64; 2]> = BTreeMap::new();
    for spring in &network.others {
        let Measure::Patch(patch) = &spring.measure else { continue };
        let dilatation = dilatation(mesh, spring, u, linear);
        for (nodes, share, content) in contents(mesh, spring, patch) {
            let pressure = -bulk.at(&nodes) * dilatation;
            cells.entry(nodes).or_insert([content, 0.0])[1] += share * pressure;
        }
    }
    if cells.is_empty() {
        return None;
    }
    let cells: Vec<(Vec<usize>, [f64; 2])> = cells.into_iter().collect();
    let once = of_points(mesh, cells.iter().map(|(nodes, [content, pressure])| (&nodes[..], *content, *pressure)));
    let mean = |nodes: &[usize]| nodes.iter().map(|&point| once[point]).sum::<f64>() / nodes.len() as f64;
    Some(of_points(mesh, cells.iter().map(|(nodes, [content, _])| (&nodes[..], *content, mean(nodes)))))
}

/// The mean over the cells around each point, weighted by their contents; each cell has nodes, content and value.
fn of_points<'a>(mesh: &Mesh, cells: impl Iterator<Item = (&'a [usize], f64, f64)>) -> Vec<f64> {
    let (mut sums, mut weights) = (vec![0.0; mesh.point_count()], vec![0.0; mesh.point_count()]);
    for (nodes, content, value) in cells {
        for &point in nodes {
            sums[point] += content * value;
            weights[point] += content;
        }
    }
    sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect()
}

/// The bulk modulus of each cell.
enum Bulk {
    Uniform(f64),
    Each(HashMap<Vec<usize>, f64>),
}

impl Bulk {
    /// `None` of anisotropic materials, whose pressure is not that of the content alone.
    fn of(mesh: &Mesh, material: &MaterialMap) -> Option<Bulk> {
        if let Some(material) = material.uniform() {
            return Some(Bulk::Uniform(bulk_modulus(material)));
        }
        let materials = material.materials().ok()?;
        let of_block = |(index, block): (usize, &CellBlock)| -> Vec<(Vec<usize>, f64)> {
            let of_cell = |(cell, nodes): (usize, &[usize])| (nodes.to_vec(), bulk_modulus(*materials.at(index, cell)));
            block.cells().enumerate().map(of_cell).collect()
        };
        Some(Bulk::Each(mesh.blocks.iter().enumerate().flat_map(of_block).collect()))
    }

    /// That of the cell with these nodes.
    fn at(&self, nodes: &[usize]) -> f64 {
        match self {
            Bulk::Uniform(bulk) => *bulk,
            // The mesh has no such cell, so that its pressure is not known: NaN.
            Bulk::Each(all) => all.get(nodes).copied().unwrap_or(f64::NAN),
        }
    }
}

/// K in `p = −K (J − 1)`, with J the ratio of the volume, or of the area in a plane, to that at rest.
fn bulk_modulus(material: Material) -> f64 {
    let t = material.thickness();
    let moduli = material.moduli();
    let (lambda, mu) = (moduli.lambda / t, moduli.mu / t);
    match material.state() {
        // Nothing pulls across a plane or rod, so that the mean is a third of the sum of the other stresses.
        State::PlaneStress { .. } => 2.0 * (lambda + mu) / 3.0,
        State::Rod { .. } => (lambda + 2.0 * mu) / 3.0,
        State::Solid | State::PlaneStrain { .. } => lambda + 2.0 * mu / 3.0,
    }
}

/// `J − 1` of the patch.
fn dilatation(mesh: &Mesh, spring: &MeasureSpring, u: &[f64], linear: bool) -> f64 {
    let d = mesh.dimension;
    let local = |values: &[f64]| gathered(values, d, &spring.points);
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
