//! Springs on the domains of edges. They carry μ, and λ where patches do not, with the mean deformation of the cells at
//! each edge, which is nearer to the truth than that of single cells.
//!
//! Each cell is shared equally among its edges. A domain does not cross from one region of a body to another, because
//! the strain may jump there.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::{LengthSpring, MeasureSpring, Network};
use super::shares::{LengthShare, SharedSpring};
use super::simplices::linear_simplices;
use super::system::each_cell;
use crate::element::{SpringKind, Tabulation};
use crate::error::Result;
use crate::fit::{DomainSprings, ExactDomains, ExactFit};
use crate::material::{CellMap, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::Measure;
use rayon::prelude::*;
use std::sync::Arc;

/// The springs of the domains of all edges: with `F = Σ_c s_c F_c/Σ_c s_c`, s_c the shares of the volumes of the cells at
/// the edge, they have the energy `Σ_c s_c W(F)`. With `volume = "patches"` they lack the part of λ, which
/// [`patch_springs`](super::patch_springs) add.
///
/// # Errors
/// The mesh has cells of several kinds, or cells other than triangles of three and tetrahedra of four nodes in a space
/// of their own dimension; or the network has no such form (kind `Unsupported`).
pub fn edge_springs(mesh: &Mesh, material: impl Into<MaterialMap>, fit: &ExactFit) -> Result<Network> {
    let material = material.into();
    let (block, domains) = parts(mesh, &material, fit)?;
    let (materials, element) = (material.materials()?, &block.element);
    let (d, n) = (mesh.dimension, element.nodes());
    let (mut gradients, mut volumes) = (Vec::with_capacity(block.connectivity.len() * d), Vec::new());
    each_cell(mesh, |_, _, geometry| {
        gradients.extend_from_slice(&geometry.gradients);
        volumes.push(geometry.volumes[0]);
    });
    let pairs = element.cell.edges();
    let share = 1.0 / pairs.len() as f64;
    let at_edges = |(cell, nodes): (usize, &[usize])| {
        let region = *material.region().at(0, cell);
        let edge = |&[a, b]: &[usize; 2]| ([nodes[a].min(nodes[b]), nodes[a].max(nodes[b])], region, cell);
        pairs.iter().map(edge).collect::<Vec<_>>()
    };
    let mut shares: Vec<([usize; 2], usize, usize)> = block.cells().enumerate().flat_map(at_edges).collect();
    shares.par_sort_unstable();
    let domain = |parts: &[([usize; 2], usize, usize)]| {
        let mut nodes: Vec<usize> = parts.iter().flat_map(|part| block.cell(part.2)).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let whole: f64 = parts.iter().map(|part| volumes[part.2]).sum();
        let mut mean = vec![0.0; nodes.len() * d];
        for &(_, _, cell) in parts {
            let own = gradients[cell * n * d..(cell + 1) * n * d].chunks_exact(d);
            for (node, own) in block.cell(cell).iter().zip(own) {
                let place = nodes.binary_search(node).expect("the nodes of the domain are those of its cells");
                let sums = &mut mean[place * d..(place + 1) * d];
                sums.iter_mut().zip(own).for_each(|(sum, g)| *sum += volumes[cell] / whole * g);
            }
        }
        let table = table(d, whole * share, mean);
        let shares = parts.iter().map(|part| match materials {
            CellMap::Uniform(_) => (0, volumes[part.2] / whole),
            CellMap::Each(_) => (part.2, volumes[part.2] / whole),
        });
        let springs = domains.springs(&table, &shares.collect::<Vec<_>>());
        Domain { nodes, table: Arc::new(table), springs }
    };
    let groups: Vec<&[([usize; 2], usize, usize)]> = shares.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
    let found: Vec<Domain> = groups.par_iter().map(|parts| domain(parts)).collect();
    let lengths = merged(found.iter().flat_map(Domain::pairs).collect());
    let others = found.into_iter().flat_map(|domain| domain.others(d, &domains)).collect();
    Ok(Network { dimension: d, lengths, others })
}

/// Whether a body has [`edge_springs`]; no spring is computed.
pub fn has_edge_springs(mesh: &Mesh, material: &MaterialMap, fit: &ExactFit) -> bool {
    parts(mesh, material, fit).is_ok()
}

/// The cells of the mesh, and what their domains have in common.
fn parts<'a>(mesh: &'a Mesh, material: &MaterialMap, fit: &ExactFit) -> Result<(&'a CellBlock, ExactDomains)> {
    let block = linear_simplices(mesh, "shear", "\"cells\": edges", fit.shear.name())?;
    let all = match material.materials()? {
        CellMap::Uniform(of_all) => std::slice::from_ref(of_all),
        CellMap::Each(blocks) => &blocks[0],
    };
    Ok((block, ExactDomains::new(fit, all)?))
}

/// A table with one point, whose reference coordinates are the positions at rest.
fn table(dimension: usize, content: f64, gradients: Vec<f64>) -> Tabulation {
    Tabulation {
        nodes: gradients.len() / dimension,
        dimension,
        space: dimension,
        weights: vec![content],
        volumetric: Vec::new(),
        values: Vec::new(),
        gradients,
    }
}

/// The springs between the same two points, added. Those that are rounding errors are left out.
fn merged(mut springs: Vec<([usize; 2], f64)>) -> Vec<LengthSpring> {
    // The order of equal springs is kept, so that their sum has the same bits in each run.
    springs.par_sort_by_key(|spring| spring.0);
    let sum = |springs: &[([usize; 2], f64)]| {
        let share = |&(points, constant): &([usize; 2], f64)| LengthShare {
            points,
            constant,
            size: constant.abs(),
            slack: 0.0,
        };
        let mut sum = share(&springs[0]);
        springs[1..].iter().for_each(|spring| sum.add(&share(spring)));
        match sum.spring(0.0, true) {
            SharedSpring::Length(spring) => Some(spring),
            // Without slack nothing pulls steadily.
            SharedSpring::None | SharedSpring::Steady(_) => None,
        }
    };
    springs.chunk_by(|a, b| a.0 == b.0).filter_map(sum).collect()
}

/// The domain of an edge.
struct Domain {
    /// Its points, in rising order.
    nodes: Vec<usize>,
    table: Arc<Tabulation>,
    springs: DomainSprings,
}

impl Domain {
    fn pairs(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        let n = self.nodes.len();
        let points = (0..n).flat_map(move |a| (a + 1..n).map(move |b| [self.nodes[a], self.nodes[b]]));
        points.zip(self.springs.pairs.iter().copied()).filter(|(_, constant)| *constant != 0.0)
    }

    /// The springs on areas, if the energy has some, and on the content.
    fn others(self, d: usize, domains: &ExactDomains) -> Vec<MeasureSpring> {
        let Domain { nodes, table, springs } = self;
        let axis = |k: usize| (0..3).map(|l| f64::from(u8::from(k % 3 == l))).collect::<Vec<f64>>();
        let area = |k: usize| {
            let unit = Tabulation { weights: vec![1.0], ..Tabulation::clone(&table) };
            MeasureSpring {
                kind: SpringKind::PointArea,
                points: nodes.clone(),
                constant: springs.areas,
                rest: 0.0,
                measure: Measure::Span(Arc::new(unit.along(&[axis(k + 1), axis(k + 2)]))),
                law: None,
                parameters: Vec::new(),
            }
        };
        let mut all: Vec<MeasureSpring> = if springs.areas == 0.0 { Vec::new() } else { (0..d).map(area).collect() };
        all.push(MeasureSpring {
            kind: SpringKind::PointContent,
            points: nodes,
            constant: springs.constant,
            rest: springs.rest,
            measure: Measure::Span(table),
            law: domains.law().cloned(),
            parameters: springs.parameters,
        });
        all
    }
}
