//! Springs on the domains of edges. They carry μ, and λ where patches do not, with the mean deformation of the cells at
//! each edge, which is nearer to the truth than that of single cells.
//!
//! Each cell is shared equally among its edges. A domain does not cross from one region of a body to another, because
//! the strain may jump there.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::{LengthSpring, MeasureSpring, Network, SpringLaw};
use super::shares::{LengthShare, SharedSpring};
use super::simplices::linear_simplices;
use super::strains::{check_strains, has_strains, strain_springs};
use super::system::each_cell;
use crate::element::{SpringKind, Tabulation};
use crate::error::Result;
use crate::fit::{DomainSprings, ExactDomains, ExactFit};
use crate::material::{CellMap, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Law, Measure};
use rayon::prelude::*;
use std::sync::Arc;

/// The springs of the domains of all edges: with `F = Σ_c s_c F_c/Σ_c s_c`, s_c the shares of the volumes of the cells at
/// the edge, they have the energy `Σ_c s_c W(F)`. With `volume = "patches"` they lack the part of λ, which
/// [`patch_springs`](super::patch_springs) add. Surfaces of triangles in space have springs on the strains of the domains.
///
/// # Errors
/// The mesh has cells of several kinds, or cells other than triangles of three and tetrahedra of four nodes in a space
/// of their own dimension and triangles of three in space; or the network has no such form (kind `Unsupported`).
pub fn edge_springs(mesh: &Mesh, material: impl Into<MaterialMap>, fit: &ExactFit) -> Result<Network> {
    springs_of_edges(mesh, material.into(), fit)
}

/// [`edge_springs`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn springs_of_edges(mesh: &Mesh, material: MaterialMap, fit: &ExactFit) -> Result<Network> {
    if has_strains(mesh) {
        return strain_springs(mesh, &material, fit);
    }
    let (block, springs) = parts(mesh, &material, fit)?;
    let is_uniform = matches!(material.materials()?, CellMap::Uniform(_));
    let domains = edge_domains(mesh, block, &material);
    let of_domain = |domain: &EdgeDomain| springs.springs(&domain.table, &domain.shares(is_uniform));
    // Domains do not depend on each other, and the list keeps their order.
    let found: Vec<DomainSprings> = domains.par_iter().map(of_domain).collect();
    Ok(network_of(mesh.dimension, domains.iter().zip(&found), springs.law()))
}

/// The domains of all edges of linear simplices, one in each region of the material that meets at the edge.
pub fn edge_domains(mesh: &Mesh, block: &CellBlock, material: &MaterialMap) -> Vec<EdgeDomain> {
    let (d, n) = (mesh.dimension, block.element.nodes());
    let (mut gradients, mut volumes) = (Vec::with_capacity(block.connectivity.len() * d), Vec::new());
    each_cell(mesh, |_, _, geometry| {
        gradients.extend_from_slice(&geometry.gradients);
        volumes.push(geometry.volumes[0]);
    });
    let pairs = block.element.cell.edges();
    let share = 1.0 / pairs.len() as f64;
    let at_edges = |(cell, nodes): (usize, &[usize])| {
        let region = *material.region().at(0, cell);
        let edge = |&[a, b]: &[usize; 2]| ([nodes[a].min(nodes[b]), nodes[a].max(nodes[b])], region, cell);
        pairs.iter().map(edge).collect::<Vec<_>>()
    };
    let mut shares: Vec<([usize; 2], usize, usize)> = block.cells().enumerate().flat_map(at_edges).collect();
    // No two are equal, since each has its cell: the order is the same however it is sorted.
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
        let table = Arc::new(table(d, whole * share, mean));
        let cells = parts.iter().map(|part| (part.2, volumes[part.2] / whole)).collect();
        EdgeDomain { edge: parts[0].0, nodes, cells, table }
    };
    let groups: Vec<&[([usize; 2], usize, usize)]> = shares.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
    // In the order of the edges, on any number of threads.
    groups.par_iter().map(|parts| domain(parts)).collect()
}

/// The network of the springs of domains; `law` is that of their springs on content.
pub fn network_of<'a>(
    dimension: usize,
    domains: impl Iterator<Item = (&'a EdgeDomain, &'a DomainSprings)> + Clone,
    law: Option<&Arc<Law>>,
) -> Network {
    let lengths = merged(domains.clone().flat_map(|(domain, springs)| domain.pairs(springs)).collect());
    let others = domains.flat_map(|(domain, springs)| domain.others(dimension, springs, law)).collect();
    Network { dimension, lengths, others }
}

/// Whether a body has [`edge_springs`]; no spring is computed.
pub fn has_edge_springs(mesh: &Mesh, material: &MaterialMap, fit: &ExactFit) -> bool {
    if has_strains(mesh) { check_strains(fit).is_ok() } else { parts(mesh, material, fit).is_ok() }
}

/// The cells of the mesh, and what their domains have in common.
pub fn parts<'a>(mesh: &'a Mesh, material: &MaterialMap, fit: &ExactFit) -> Result<(&'a CellBlock, ExactDomains)> {
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
        modes: None,
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
        match sum.spring(|| 0.0, true) {
            SharedSpring::Length(spring) => Some(spring),
            // Without slack nothing pulls steadily.
            SharedSpring::None | SharedSpring::Steady(_) => None,
        }
    };
    springs.chunk_by(|a, b| a.0 == b.0).filter_map(sum).collect()
}

/// The domain of an edge within one region.
#[derive(Debug, Clone)]
pub struct EdgeDomain {
    /// The ends of the edge.
    pub edge: [usize; 2],
    /// Its points, in rising order.
    pub nodes: Vec<usize>,
    /// Its cells with their shares of its content, which add up to one.
    pub cells: Vec<(usize, f64)>,
    /// The mean gradients of its cells.
    pub table: Arc<Tabulation>,
}

impl EdgeDomain {
    /// The shares of its cells, by the index of their material.
    fn shares(&self, is_uniform: bool) -> Vec<(usize, f64)> {
        self.cells.iter().map(|(cell, share)| (if is_uniform { 0 } else { *cell }, *share)).collect()
    }

    fn pairs<'a>(&'a self, springs: &'a DomainSprings) -> impl Iterator<Item = ([usize; 2], f64)> + 'a {
        let n = self.nodes.len();
        let points = (0..n).flat_map(move |a| (a + 1..n).map(move |b| [self.nodes[a], self.nodes[b]]));
        points.zip(springs.pairs.iter().copied()).filter(|(_, constant)| *constant != 0.0)
    }

    /// The springs on areas, if the energy has some, and on the content.
    fn others(&self, d: usize, springs: &DomainSprings, law: Option<&Arc<Law>>) -> Vec<MeasureSpring> {
        let axis = |k: usize| (0..3).map(|l| f64::from(u8::from(k % 3 == l))).collect::<Vec<f64>>();
        let area = |k: usize| {
            // The constant has the content of the domain; the measure is an area for each unit of it.
            let unit = Tabulation { weights: vec![1.0], ..Tabulation::clone(&self.table) };
            MeasureSpring {
                kind: SpringKind::PointArea,
                points: self.nodes[..].into(),
                constant: springs.areas,
                rest: 0.0,
                measure: Measure::Span(Arc::new(unit.along(&[axis(k + 1), axis(k + 2)]))),
                law: None,
            }
        };
        let mut all: Vec<MeasureSpring> = if springs.areas == 0.0 { Vec::new() } else { (0..d).map(area).collect() };
        all.push(MeasureSpring {
            kind: SpringKind::PointContent,
            points: self.nodes[..].into(),
            constant: springs.constant,
            rest: springs.rest,
            measure: Measure::Span(self.table.clone()),
            law: law.map(|law| Box::new(SpringLaw::new(law.clone(), &springs.parameters))),
        });
        all
    }
}
