//! Exact networks whose unknowns are moduli: factors on μ and λ of the cells, and on λ of patches of cells.
//!
//! The stiffness is `Σ_e (c_μe K_μe + c_λe K_λe) + Σ_n c_n K_n`, with the tangents `K_μe`, `K_λe` of the springs of cell e
//! that carry the moduli and `K_n` of patch n. Each of them is positive semidefinite, or their sum over μ and λ with
//! equal factors is, and positive factors keep the network in the exact form.
//!
//! Theory: page *Whole-object fits* of the book.

use super::parts::{PartVectors, Places};
use super::unknowns::Unknowns;
use crate::error::Result;
use crate::fit::{CellFits, ExactFit, VolumeSprings, fit_exact};
use crate::material::{CellMap, Material, MaterialMap};
use crate::mesh::{CellIndex, Mesh};
use crate::model::{Entries, MeasureSpring, Network, dofs, patch_springs};
use faer::sparse::Triplet;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The cells that share a factor on each modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModuliSharing {
    /// All cells of the body; all patches.
    Body,
    /// The cells that belong to the same physical groups; all patches.
    Region,
    /// The same with one factor on both moduli, so that Poisson's ratio stays; all patches.
    RegionYoung,
    /// Each cell has factors of its own, and so has each patch.
    Element,
}

/// The springs of an exact network by the modulus that they carry.
#[derive(Debug, Clone)]
pub struct ModuliParts<'a> {
    mesh: &'a Mesh,
    /// For each block the springs with μ alone and with λ alone.
    fits: Vec<[CellFits; 2]>,
    /// The springs of the patches.
    patches: Vec<MeasureSpring>,
    places: Arc<Places>,
    /// The tangents of the parts, one after another, each `[dofs × dofs]`.
    tangents: Arc<Vec<f64>>,
    /// What the parts are, in their order.
    parts: Vec<Part>,
    /// The factors by which the parts differ from those of the material.
    factors: Vec<f64>,
}

/// A part of the stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Shear(usize, usize),
    Volume(usize, usize),
    Patch(usize),
}

/// The share of λ that cells keep at the start if patches carry the rest.
const HALF: f64 = 0.5;

impl<'a> ModuliParts<'a> {
    /// The parts of the exact network of a body at small deformation. With `volume = "patches"` one half of λ is carried by
    /// the patches, and the other by the cells. `held` says of each point whether it is held.
    ///
    /// # Errors
    /// The body has no such network.
    pub fn new(
        mesh: &'a Mesh,
        material: impl Into<MaterialMap>,
        volume: VolumeSprings,
        held: &[bool],
    ) -> Result<ModuliParts<'a>> {
        let material = material.into();
        material.check(&mesh.blocks.iter().map(|block| block.cells().len()).collect::<Vec<_>>())?;
        let fit = ExactFit { volume, ..ExactFit::default() };
        let patched = volume == VolumeSprings::Patches;
        let mut patches = if patched { patch_springs(mesh, material.clone(), &fit, held)? } else { Vec::new() };
        patches.iter_mut().for_each(|patch| patch.constant *= HALF);
        // Where patches carry λ, cells that carry it too are those with a spring for each cell.
        let fit = ExactFit { volume: if patched { VolumeSprings::Cells } else { volume }, ..fit };
        let share = if patched { HALF } else { 1.0 };
        // λ vanishes where ν does, so that what remains is μ.
        let materials = material.materials()?;
        let shear = materials
            .try_map(|material| Material::new(material.young() / (1.0 + material.poisson()), 0.0, material.state()))?;
        let mut fits = Vec::new();
        for (index, block) in mesh.blocks.iter().enumerate() {
            let of = |materials: &CellMap<Material>| {
                let cells = &block.connectivity;
                fit_exact(&block.element, &mesh.points, cells, materials.block(index), &fit, &mut |_| {})
            };
            let (all, shear) = (of(materials)?, of(&shear)?);
            let rest = |all: &[f64], own: &[f64]| all.iter().zip(own).map(|(a, b)| share * (a - b)).collect();
            let volume = CellFits {
                constants: rest(&all.constants, &shear.constants),
                parameters: rest(&all.parameters, &shear.parameters),
                ..all
            };
            fits.push([shear, volume]);
        }
        let (places, tangents, parts, factors) = Default::default();
        let mut parts = ModuliParts { mesh, fits, patches, places, tangents, parts, factors };
        parts.tabulate();
        Ok(parts)
    }

    /// The tangent of every part. A part without stiffness is left out.
    fn tabulate(&mut self) {
        let (mesh, d) = (self.mesh, self.mesh.dimension);
        let cells: Vec<CellIndex> = mesh.cell_indices().collect();
        let of_cell = |index: &CellIndex| -> [Vec<f64>; 2] {
            let alone = mesh.of_cell(*index);
            [0, 1].map(|modulus| {
                let own = self.fits[index.block][modulus].of_cells(&[index.cell]);
                dense(&Network::assemble(&alone, &[own]).stiffness(&alone.points), alone.points.len())
            })
        };
        let tangents: Vec<[Vec<f64>; 2]> = cells.par_iter().map(of_cell).collect();
        let (mut places, mut all, mut parts) = (Places::new(), Vec::new(), Vec::new());
        for (index, [shear, volume]) in cells.iter().zip(tangents) {
            let nodes = mesh.cell_nodes(*index);
            let (block, cell) = (index.block, index.cell);
            for (part, tangent) in [(Part::Shear(block, cell), shear), (Part::Volume(block, cell), volume)] {
                if tangent.iter().any(|k| *k != 0.0) {
                    places.push(dofs(nodes, d));
                    all.extend(tangent);
                    parts.push(part);
                }
            }
        }
        for (index, patch) in self.patches.iter().enumerate() {
            let mut tangent = vec![0.0; (patch.points.len() * d).pow(2)];
            patch.tangent(&mesh.points, d, &mut tangent);
            places.push(dofs(&patch.points, d));
            all.extend(tangent);
            parts.push(Part::Patch(index));
        }
        self.factors = vec![1.0; parts.len()];
        (self.places, self.tangents, self.parts) = (Arc::new(places), Arc::new(all), parts);
    }

    /// The unknowns that cells share in this way.
    pub fn unknowns(&self, sharing: ModuliSharing) -> Unknowns {
        self.shared(sharing).0
    }

    /// The names of the unknowns, such as `mu of tumour`; cells are counted from 1.
    pub fn names(&self, sharing: ModuliSharing) -> Vec<String> {
        self.shared(sharing).1
    }

    fn shared(&self, sharing: ModuliSharing) -> (Unknowns, Vec<String>) {
        let regions = self.mesh.regions();
        let label = |part: &Part| match (sharing, *part) {
            (ModuliSharing::Element, part) => (part, Vec::new()),
            (_, Part::Patch(_)) => (Part::Patch(0), Vec::new()),
            (ModuliSharing::Body, Part::Shear(..)) => (Part::Shear(0, 0), Vec::new()),
            (ModuliSharing::Body, Part::Volume(..)) => (Part::Volume(0, 0), Vec::new()),
            (ModuliSharing::Region, Part::Shear(b, c))
            | (ModuliSharing::RegionYoung, Part::Shear(b, c) | Part::Volume(b, c)) => {
                (Part::Shear(0, 0), regions[b][c].clone())
            }
            (ModuliSharing::Region, Part::Volume(b, c)) => (Part::Volume(0, 0), regions[b][c].clone()),
        };
        let (mut known, mut names): (BTreeMap<(Part, Vec<&str>), usize>, _) = (BTreeMap::new(), Vec::new());
        let own = self.parts.iter().map(|part| {
            let (count, label) = (known.len(), label(part));
            let name = match (sharing, *part) {
                (ModuliSharing::Element, Part::Shear(_, cell)) => format!("mu of cell {}", cell + 1),
                (ModuliSharing::Element, Part::Volume(_, cell)) => format!("lambda of cell {}", cell + 1),
                (ModuliSharing::Element, Part::Patch(patch)) => format!("lambda of patch {}", patch + 1),
                (_, Part::Patch(_)) => "lambda of patches".into(),
                (ModuliSharing::RegionYoung, Part::Shear(..) | Part::Volume(..)) => in_region("E", &label.1),
                (_, Part::Shear(..)) => in_region("mu", &label.1),
                (_, Part::Volume(..)) => in_region("lambda", &label.1),
            };
            *known.entry(label).or_insert_with(|| {
                names.push(name);
                count
            })
        });
        let unknowns = Unknowns::one_for_each(own.collect());
        (unknowns, names)
    }

    /// The factors on μ and λ of the cells that belong to the same groups, with these of the parts.
    pub(super) fn region_factors(&self, factors: &[f64]) -> BTreeMap<Vec<String>, [f64; 2]> {
        let regions = self.mesh.regions();
        let mut found = BTreeMap::new();
        for ((part, own), factor) in self.parts.iter().zip(&self.factors).zip(factors) {
            let (block, cell, modulus) = match *part {
                Part::Shear(block, cell) => (block, cell, 0),
                Part::Volume(block, cell) => (block, cell, 1),
                Part::Patch(_) => continue,
            };
            let groups = regions[block][cell].iter().map(|name| name.to_string()).collect();
            found.entry(groups).or_insert([1.0; 2])[modulus] = own * factor;
        }
        found
    }

    /// The parts, multiplied by factors, `[parts]`.
    #[must_use]
    pub fn scaled(&self, factors: &[f64]) -> ModuliParts<'a> {
        let mut scaled = self.clone();
        (scaled.fits, scaled.patches) = self.scaled_springs(factors);
        scaled.factors.iter_mut().zip(factors).for_each(|(own, factor)| *own *= factor);
        let mut tangents = self.tangents.to_vec();
        let mut rest = &mut tangents[..];
        for (dofs, factor) in self.places.dofs().zip(factors) {
            let (own, others) = rest.split_at_mut(dofs.len().pow(2));
            own.iter_mut().for_each(|k| *k *= factor);
            rest = others;
        }
        scaled.tangents = Arc::new(tangents);
        scaled
    }

    /// The springs of the parts, multiplied by factors, `[parts]`.
    fn scaled_springs(&self, factors: &[f64]) -> (Vec<[CellFits; 2]>, Vec<MeasureSpring>) {
        let (mut fits, mut patches) = (self.fits.clone(), self.patches.clone());
        for (part, factor) in self.parts.iter().zip(factors) {
            let (modulus, block, cell) = match *part {
                Part::Shear(block, cell) => (0, block, cell),
                Part::Volume(block, cell) => (1, block, cell),
                Part::Patch(index) => {
                    patches[index].constant *= factor;
                    continue;
                }
            };
            let fit = &mut fits[block][modulus];
            let (m, cells) = (fit.springs.len(), self.mesh.blocks[block].cells().len());
            let p = fit.parameters.len() / cells.max(1);
            fit.constants[cell * m..(cell + 1) * m].iter_mut().for_each(|k| *k *= factor);
            fit.parameters[cell * p..(cell + 1) * p].iter_mut().for_each(|k| *k *= factor);
        }
        (fits, patches)
    }

    /// The network of the parts, multiplied by factors, `[parts]`.
    pub fn network(&self, factors: &[f64]) -> Network {
        let (fits, patches) = self.scaled_springs(factors);
        let sum = |[shear, volume]: &[CellFits; 2]| {
            let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
            CellFits {
                constants: add(&shear.constants, &volume.constants),
                parameters: add(&shear.parameters, &volume.parameters),
                ..shear.clone()
            }
        };
        let fits: Vec<CellFits> = fits.iter().map(sum).collect();
        let mut network = Network::assemble(self.mesh, &fits);
        network.others.extend(patches);
        network
    }

    /// The stiffness with these factors, `[parts]`, N/m.
    pub(super) fn stiffness(&self, factors: &[f64]) -> Entries {
        let mut entries = Entries::new();
        for ((dofs, tangent), factor) in self.each().zip(factors) {
            for (i, &row) in dofs.iter().enumerate() {
                for (j, &column) in dofs.iter().enumerate().filter(|(_, column)| row >= **column) {
                    entries.push(Triplet::new(row, column, factor * tangent[i * dofs.len() + j]));
                }
            }
        }
        entries
    }

    /// The forces `K_s u` of the parts at factor 1.
    pub(super) fn forces(&self, u: &[f64]) -> PartVectors {
        let mut values = Vec::new();
        for (dofs, tangent) in self.each() {
            let row = |row: &[f64]| row.iter().zip(dofs).map(|(k, &i)| k * u[i]).sum::<f64>();
            values.extend(tangent.chunks_exact(dofs.len().max(1)).map(row));
        }
        PartVectors { places: self.places.clone(), values }
    }

    /// The mesh of the body.
    pub(super) fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The factors by which the parts differ from those of the material.
    pub(super) fn factors(&self) -> &[f64] {
        &self.factors
    }

    /// The number of parts.
    pub(super) fn len(&self) -> usize {
        self.parts.len()
    }

    fn each(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        let mut first = 0;
        self.places.dofs().map(move |dofs| {
            let from = first;
            first += dofs.len().pow(2);
            (dofs, &self.tangents[from..first])
        })
    }
}

/// `mu of tumour`, or `mu` of cells in no group.
fn in_region(modulus: &str, groups: &[&str]) -> String {
    if groups.is_empty() { modulus.into() } else { format!("{modulus} of {}", groups.join(", ")) }
}

/// A matrix with these entries of its lower triangle, `[size × size]`.
fn dense(entries: &Entries, size: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; size * size];
    for entry in entries {
        matrix[entry.row * size + entry.col] += entry.val;
        if entry.row != entry.col {
            matrix[entry.col * size + entry.row] += entry.val;
        }
    }
    matrix
}
