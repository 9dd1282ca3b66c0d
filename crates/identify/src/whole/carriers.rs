//! The springs of an exact network by the modulus that they carry, and by the cell, the domain or the patch to which they belong.
//!
//! Theory: page *Whole-object fits* of the book.

use super::regions::BodyRegions;
use crate::error::Result;
use crate::fit::{CellFits, DomainSprings, ExactDomains, ExactFit, ShearSprings, VolumeSprings, fit_exact};
use crate::material::{CellMap, Material, MaterialMap};
use crate::mesh::{CellIndex, Mesh};
use crate::model::{EdgeDomain, MeasureSpring, Network, domain_parts, edge_domains, network_of, patch_springs};
use crate::springs::Law;
use crate::stiffness::gathered;
use rayon::prelude::*;
use std::sync::Arc;

/// A Lamé modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Modulus {
    /// μ.
    Shear,
    /// λ.
    Volume,
}

/// A part of the stiffness that has one factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// The springs of a cell.
    Cell(Modulus, CellIndex),
    /// The springs of cells of the same groups in the domain of an edge, by their index.
    Domain(usize),
    /// The spring of a patch, by its index.
    Patch(usize),
}

/// The springs that carry the moduli, without those of patches.
#[derive(Debug, Clone)]
pub(super) enum Carriers {
    /// For each block of cells those of μ and of λ.
    Cells(Vec<[CellFits; 2]>),
    /// Those of the domains of edges, and the law of their springs on content, if these are not linear.
    Domains(Arc<Vec<EdgeDomain>>, Vec<DomainPart>, Option<Arc<Law>>),
}

/// What cells of the same groups give to the springs of a domain.
#[derive(Debug, Clone)]
pub(super) struct DomainPart {
    pub domain: usize,
    pub modulus: Modulus,
    /// One of these cells.
    pub cell: usize,
    pub springs: DomainSprings,
}

/// The springs of a part, on its own points.
pub(super) struct PartSprings {
    pub part: Part,
    /// Its points in the mesh.
    pub nodes: Vec<usize>,
    pub springs: Network,
    /// Their tangent at rest, `[dofs × dofs]`.
    pub tangent: Vec<f64>,
}

/// The share of λ that cells keep at the start if patches carry the rest.
// Both halves add up to λ, and neither begins at zero, from which a factor could not take it away.
const HALF: f64 = 0.5;

impl Carriers {
    /// The springs of the body and those of its patches.
    ///
    /// # Errors
    /// The body has no such network.
    pub fn new(
        mesh: &Mesh,
        (material, regions): (&MaterialMap, &BodyRegions),
        fit: &ExactFit,
        held: &[bool],
    ) -> Result<(Carriers, Vec<MeasureSpring>)> {
        fit.shear.check(fit.volume)?;
        let materials = material.materials()?;
        // λ vanishes where ν does, so that what remains is μ.
        let shear = materials
            .try_map(|material| Material::new(material.young() / (1.0 + material.poisson()), 0.0, material.state()))?;
        let patched = fit.volume == VolumeSprings::Patches;
        let mut patches = if patched { patch_springs(mesh, material.clone(), fit, held)? } else { Vec::new() };
        let carriers = match fit.shear {
            ShearSprings::Cells => {
                patches.iter_mut().for_each(|patch| patch.scale(HALF));
                // Where patches carry λ, cells that carry it too are those with a spring for each cell.
                let volume = if patched { VolumeSprings::Cells } else { fit.volume };
                let share = if patched { HALF } else { 1.0 };
                Carriers::cells(mesh, (materials, &shear), &ExactFit { volume, ..*fit }, share)?
            }
            ShearSprings::Edges => Carriers::domains(mesh, (material, regions), &shear, fit)?,
        };
        Ok((carriers, patches))
    }

    fn cells(
        mesh: &Mesh,
        (materials, shear): (&CellMap<Material>, &CellMap<Material>),
        fit: &ExactFit,
        share: f64,
    ) -> Result<Carriers> {
        let mut fits = Vec::new();
        for (index, block) in mesh.blocks.iter().enumerate() {
            let of = |materials: &CellMap<Material>| {
                let cells = &block.connectivity;
                fit_exact(&block.element, &mesh.points, cells, materials.block(index), fit, &mut |_| {})
            };
            let (all, shear) = (of(materials)?, of(shear)?);
            // Constants are linear in the moduli: what is left without those of μ is λ alone.
            let rest = |all: &[f64], own: &[f64]| all.iter().zip(own).map(|(a, b)| share * (a - b)).collect();
            let volume = CellFits {
                constants: rest(&all.constants, &shear.constants),
                parameters: rest(&all.parameters, &shear.parameters),
                ..all
            };
            fits.push([shear, volume]);
        }
        Ok(Carriers::Cells(fits))
    }

    fn domains(
        mesh: &Mesh,
        (material, regions): (&MaterialMap, &BodyRegions),
        shear: &CellMap<Material>,
        fit: &ExactFit,
    ) -> Result<Carriers> {
        let (block, springs) = domain_parts(mesh, material, fit)?;
        let of_shear = ExactDomains::new(fit, shear.block(0).values())?;
        let law = springs.law().cloned();
        let is_uniform = matches!(shear, CellMap::Uniform(_));
        let region = |cell: usize| regions.names(CellIndex { block: 0, cell });
        let domains = edge_domains(mesh, block, material);
        let of_domain = |(index, domain): (usize, &EdgeDomain)| {
            let mut cells = domain.cells.clone();
            // A stable sort keeps cells of one region in the order of the domain, so that sums have the same bits in
            // each run.
            cells.sort_by_key(|(cell, _)| region(*cell));
            let mut parts = Vec::new();
            for own in cells.chunk_by(|a, b| region(a.0) == region(b.0)) {
                let cell = own[0].0;
                let shares: Vec<(usize, f64)> =
                    // A uniform material has one entry, whatever the cell is.
                    own.iter().map(|(cell, share)| (if is_uniform { 0 } else { *cell }, *share)).collect();
                let mu = of_shear.springs(&domain.table, &shares);
                let lambda = springs.springs(&domain.table, &shares).sum(&mu, -1.0);
                let part = |modulus, springs| DomainPart { domain: index, modulus, cell, springs };
                // Patches carry λ, or it vanishes with ν.
                let is_rest = lambda.constant.abs() > ROUNDING * mu.constant.abs();
                parts.push(part(Modulus::Shear, mu));
                parts.extend(is_rest.then(|| part(Modulus::Volume, lambda)));
            }
            parts
        };
        // Collected in the order of the domains: the numbers of parts, and so of unknowns, do not depend on threads.
        let parts: Vec<Vec<DomainPart>> = domains.par_iter().enumerate().map(of_domain).collect();
        Ok(Carriers::Domains(Arc::new(domains), parts.concat(), law))
    }

    /// The springs of all parts that have a stiffness at rest.
    pub fn parts(&self, mesh: &Mesh) -> Vec<PartSprings> {
        let found: Vec<Vec<PartSprings>> = match self {
            Carriers::Cells(fits) => {
                let cells: Vec<CellIndex> = mesh.cell_indices().collect();
                let of_cell = |index: &CellIndex| {
                    let alone = mesh.of_cell(*index);
                    let fits = fits[index.block].iter().zip([Modulus::Shear, Modulus::Volume]);
                    let part = |(fit, modulus): (&CellFits, Modulus)| {
                        let springs = Network::assemble(&alone, &[fit.of_cells(&[index.cell])]);
                        PartSprings {
                            part: Part::Cell(modulus, *index),
                            nodes: mesh.cell_nodes(*index).to_vec(),
                            tangent: dense(&springs, &alone.points),
                            springs,
                        }
                    };
                    fits.map(part).collect()
                };
                // Cells are independent of each other, and are collected in their order.
                cells.par_iter().map(of_cell).collect()
            }
            Carriers::Domains(domains, parts, law) => {
                let of_part = |(index, part): (usize, &DomainPart)| {
                    let own = &domains[part.domain];
                    let points = gathered(&mesh.points, mesh.dimension, &own.nodes);
                    let alone = EdgeDomain { nodes: (0..own.nodes.len()).collect(), ..own.clone() };
                    let springs = network_of(mesh.dimension, std::iter::once((&alone, &part.springs)), law.as_ref());
                    let tangent = dense(&springs, &points);
                    vec![PartSprings { part: Part::Domain(index), nodes: own.nodes.clone(), springs, tangent }]
                };
                parts.par_iter().enumerate().map(of_part).collect()
            }
        };
        // A modulus that no motion feels has no derivative, as λ has none where ν is zero: its unknown would be free.
        found.into_iter().flatten().filter(|of| of.tangent.iter().any(|k| *k != 0.0)).collect()
    }

    /// Multiplies the springs of a part.
    pub fn scale(&mut self, mesh: &Mesh, part: Part, factor: f64) {
        match (self, part) {
            (Carriers::Cells(fits), Part::Cell(modulus, CellIndex { block, cell })) => {
                let [shear, volume] = &mut fits[block];
                let fit = match modulus {
                    Modulus::Shear => shear,
                    Modulus::Volume => volume,
                };
                let (m, cells) = (fit.springs.len(), mesh.blocks[block].cells().len());
                let p = fit.parameters.len() / cells.max(1);
                fit.constants[cell * m..(cell + 1) * m].iter_mut().for_each(|k| *k *= factor);
                fit.parameters[cell * p..(cell + 1) * p].iter_mut().for_each(|k| *k *= factor);
            }
            (Carriers::Domains(_, parts, _), Part::Domain(index)) => {
                parts[index].springs = parts[index].springs.scaled(factor);
            }
            // A part of the other kind is not one of these.
            (Carriers::Cells(_), Part::Domain(_) | Part::Patch(_))
            | (Carriers::Domains(..), Part::Cell(..) | Part::Patch(_)) => {}
        }
    }

    /// The network of the springs.
    pub fn network(&self, mesh: &Mesh) -> Network {
        match self {
            Carriers::Cells(fits) => {
                let sum = |[shear, volume]: &[CellFits; 2]| {
                    let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
                    CellFits {
                        constants: add(&shear.constants, &volume.constants),
                        parameters: add(&shear.parameters, &volume.parameters),
                        ..shear.clone()
                    }
                };
                Network::assemble(mesh, &fits.iter().map(sum).collect::<Vec<_>>())
            }
            Carriers::Domains(domains, parts, law) => {
                // The parts of a domain follow each other.
                let of_domains = parts.chunk_by(|a, b| a.domain == b.domain);
                let sum = |parts: &[DomainPart]| {
                    let sum = parts[1..].iter().fold(parts[0].springs.clone(), |sum, part| sum.sum(&part.springs, 1.0));
                    (&domains[parts[0].domain], sum)
                };
                let found: Vec<(&EdgeDomain, DomainSprings)> = of_domains.map(sum).collect();
                network_of(mesh.dimension, found.iter().map(|(domain, springs)| (*domain, springs)), law.as_ref())
            }
        }
    }
}

/// A constant for λ below this share of that for μ is a rounding error.
// It is the difference of two constants of that size, each a sum of some products rounded by 1.1e-16.
const ROUNDING: f64 = 1e-12;

/// The stiffness of a small network, `[size × size]`.
fn dense(network: &Network, points: &[f64]) -> Vec<f64> {
    let size = points.len();
    let mut matrix = vec![0.0; size * size];
    for entry in &network.stiffness(points) {
        matrix[entry.row * size + entry.col] += entry.val;
        if entry.row != entry.col {
            matrix[entry.col * size + entry.row] += entry.val;
        }
    }
    matrix
}
