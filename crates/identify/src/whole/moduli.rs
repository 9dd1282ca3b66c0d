//! Exact networks whose unknowns are moduli: factors on μ and λ of the cells or of the domains of edges, and on λ of patches of cells.
//!
//! The stiffness is `Σ_e (c_μe K_μe + c_λe K_λe) + Σ_n c_n K_n`, with the tangents `K_μe`, `K_λe` of the springs of cell or domain e
//! that carry the moduli and `K_n` of patch n. Each of them is positive semidefinite, or their sum over μ and λ with
//! equal factors is, and positive factors keep the network in the exact form. At large deformation the energy is linear in the moduli in
//! the same way, `Σ_e (c_μe W_μe + c_λe W_λe) + Σ_n c_n W_n`, and the forces of the parts are its derivatives.
//!
//! Theory: page *Whole-object fits* of the book.

use super::carriers::{Carriers, DomainPart, Modulus, Part};
use super::regions::BodyRegions;
use super::unknowns::Unknowns;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::ExactFit;
use crate::material::{MaterialMap, State};
use crate::mesh::{CellIndex, Mesh};
use crate::model::{Elastic, Entries, MeasureSpring, Network, PartVectors, Places, dofs};
use faer::sparse::Triplet;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The cells that share a factor on each modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModuliSharing {
    /// All cells of the body; all patches.
    Body,
    /// The cells of the same region, see [`BodyRegions`]; all patches.
    Region,
    /// The cells of one region, see [`BodyRegions`], share one factor on both moduli, so that Poisson's ratio stays; all patches share one.
    RegionYoung,
    /// Each cell, or each domain of an edge, has factors of its own, and so has each patch.
    Element,
}

/// The parts of an exact network that carry a modulus each.
#[derive(Debug, Clone)]
pub struct ModuliParts<'a> {
    mesh: &'a Mesh,
    regions: Arc<BodyRegions>,
    carriers: Carriers,
    /// The springs of the patches.
    patches: Vec<MeasureSpring>,
    places: Arc<Places>,
    /// The tangents of the parts, one after another, each `[dofs × dofs]`.
    tangents: Arc<Vec<f64>>,
    /// The springs of each part on its own points, if deformations may be large.
    springs: Option<Arc<Vec<Network>>>,
    /// What the parts are, in their order.
    parts: Vec<Part>,
    /// The factors by which the parts differ from those of the material.
    factors: Vec<f64>,
}

impl<'a> ModuliParts<'a> {
    /// The parts of an exact network of a body. With springs for μ on cells and `volume = "patches"` one half
    /// of λ is carried by the patches, and the other by the cells. `held` says of each point whether it is held.
    ///
    /// # Errors
    /// The body has no such network, or its energy at large deformation is not linear in the moduli.
    pub fn new(
        mesh: &'a Mesh,
        material: impl Into<MaterialMap>,
        fit: &ExactFit,
        held: &[bool],
    ) -> Result<ModuliParts<'a>> {
        Self::of_map(mesh, material.into(), fit, held)
    }

    /// [`Self::new`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn of_map(mesh: &'a Mesh, material: MaterialMap, fit: &ExactFit, held: &[bool]) -> Result<ModuliParts<'a>> {
        material.check(&mesh.blocks.iter().map(|block| block.cells().len()).collect::<Vec<_>>())?;
        let curved = match material.state() {
            State::PlaneStress { .. } => Some("plane stress"),
            State::Rod { .. } => Some("rods"),
            State::PlaneStrain { .. } | State::Solid => None,
        };
        if let Some(state) = curved.filter(|_| fit.large) {
            let expected = "a solid or plane strain, where moduli are unknown at large deformation: without stress across a plane or rod the \
                            energy is not linear in them";
            return Err(Error::expected("unknowns", expected, state).of_kind(ErrorKind::Unsupported));
        }
        let regions = Arc::new(BodyRegions::of(mesh, &material));
        let (carriers, patches) = Carriers::new(mesh, (&material, &regions), fit, held)?;
        let (d, mut places, mut tangents, mut parts) = (mesh.dimension, Places::new(), Vec::new(), Vec::new());
        let mut springs = fit.large.then(Vec::new);
        for of_part in carriers.parts(mesh) {
            places.push(dofs(&of_part.nodes, d));
            tangents.extend(of_part.tangent);
            parts.push(of_part.part);
            springs.iter_mut().for_each(|springs| springs.push(of_part.springs.clone()));
        }
        for (index, patch) in patches.iter().enumerate() {
            let mut tangent = vec![0.0; (patch.points.len() * d).pow(2)];
            patch.tangent(&mesh.points, d, &mut tangent);
            places.push(dofs(&patch.points, d));
            tangents.extend(tangent);
            parts.push(Part::Patch(index));
            let own = || MeasureSpring { points: (0..patch.points.len()).collect(), ..patch.clone() };
            let network = || Network { dimension: d, lengths: Vec::new(), others: vec![own()] };
            springs.iter_mut().for_each(|springs| springs.push(network()));
        }
        let springs = springs.map(Arc::new);
        let (places, tangents, factors) = (Arc::new(places), Arc::new(tangents), vec![1.0; parts.len()]);
        Ok(ModuliParts { mesh, regions, carriers, patches, places, tangents, springs, parts, factors })
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
        let groups = |cell: CellIndex| self.regions.names(cell);
        let label = |owner: Option<(Modulus, CellIndex)>, place| match (sharing, owner) {
            (ModuliSharing::Element, _) => (owner.map(|(modulus, _)| modulus), &[][..], place),
            (_, None) => (None, &[][..], [0; 2]),
            (ModuliSharing::Body, Some((modulus, _))) => (Some(modulus), &[][..], [0; 2]),
            // One label for μ and λ, so that both have one factor and Poisson's ratio stays.
            (ModuliSharing::RegionYoung, Some((_, cell))) => (Some(Modulus::Shear), groups(cell), [0; 2]),
            (ModuliSharing::Region, Some((modulus, cell))) => (Some(modulus), groups(cell), [0; 2]),
        };
        let (mut known, mut names) = (BTreeMap::new(), Vec::new());
        let own = self.parts.iter().map(|part| {
            let (owner, place) = self.owner(*part);
            let (count, label) = (known.len(), label(owner, place));
            let modulus = match (sharing, owner) {
                (_, None) => "lambda",
                (ModuliSharing::RegionYoung, Some(_)) => "E",
                (_, Some((Modulus::Shear, _))) => "mu",
                (_, Some((Modulus::Volume, _))) => "lambda",
            };
            let name = match (sharing, owner) {
                (ModuliSharing::Element, _) => format!("{modulus} of {}", self.place_name(*part)),
                (_, None) => "lambda of patches".into(),
                (_, Some(_)) => in_region(modulus, label.1),
            };
            *known.entry(label).or_insert_with(|| {
                names.push(name);
                count
            })
        });
        let unknowns = Unknowns::one_for_each(own.collect());
        (unknowns, names)
    }

    /// The modulus of a part of cells, with a cell whose region is that of all of them; `None` for the patches, which carry λ and which all regions share.
    /// Two numbers beside it tell a cell, a domain or a patch from the others.
    fn owner(&self, part: Part) -> (Option<(Modulus, CellIndex)>, [usize; 2]) {
        match (part, &self.carriers) {
            (Part::Cell(modulus, cell), _) => (Some((modulus, cell)), [cell.block, cell.cell]),
            (Part::Domain(index), Carriers::Domains(_, parts, _)) => {
                let DomainPart { modulus, cell, domain, .. } = &parts[index];
                (Some((*modulus, CellIndex { block: 0, cell: *cell })), [0, *domain])
            }
            (Part::Domain(index), Carriers::Cells(_)) | (Part::Patch(index), _) => (None, [0, index]),
        }
    }

    /// The cell or the patch of a part, counted from 1, or the points of its edge.
    fn place_name(&self, part: Part) -> String {
        match (part, &self.carriers) {
            (Part::Domain(index), Carriers::Domains(domains, parts, _)) => {
                let [a, b] = domains[parts[index].domain].edge;
                format!("edge {}-{}", a, b)
            }
            (Part::Patch(index), _) => format!("patch {}", index + 1),
            (Part::Cell(..) | Part::Domain(_), _) => format!("cell {}", self.owner(part).1[1] + 1),
        }
    }

    /// The factors on μ and λ of the cells of each region, with these of the parts.
    pub(super) fn region_factors(&self, factors: &[f64]) -> BTreeMap<Vec<String>, [f64; 2]> {
        let mut found = BTreeMap::new();
        for ((part, own), factor) in self.parts.iter().zip(&self.factors).zip(factors) {
            let (Some((modulus, cell)), _) = self.owner(*part) else { continue };
            let region = self.regions.names(cell).to_vec();
            let place = match modulus {
                Modulus::Shear => 0,
                Modulus::Volume => 1,
            };
            found.entry(region).or_insert([1.0; 2])[place] = own * factor;
        }
        found
    }

    /// The parts, multiplied by factors, `[parts]`.
    #[must_use]
    pub fn scaled(&self, factors: &[f64]) -> ModuliParts<'a> {
        let mut scaled = self.clone();
        (scaled.carriers, scaled.patches) = self.scaled_springs(factors);
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
    fn scaled_springs(&self, factors: &[f64]) -> (Carriers, Vec<MeasureSpring>) {
        let (mut carriers, mut patches) = (self.carriers.clone(), self.patches.clone());
        for (part, factor) in self.parts.iter().zip(factors) {
            match *part {
                Part::Patch(index) => patches[index].scale(*factor),
                Part::Cell(..) | Part::Domain(_) => carriers.scale(self.mesh, *part, *factor),
            }
        }
        (carriers, patches)
    }

    /// The network of the parts, multiplied by factors, `[parts]`.
    pub fn network(&self, factors: &[f64]) -> Network {
        let (carriers, patches) = self.scaled_springs(factors);
        let mut network = carriers.network(self.mesh);
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
            // A part without points has no rows, and pieces of no numbers are a panic.
            values.extend(tangent.chunks_exact(dofs.len().max(1)).map(row));
        }
        PartVectors { places: self.places.clone(), values }
    }

    /// The forces of the parts at factor 1 with the points at x, `[points × dimension]`, m; `None` if only small deformations matter.
    pub(super) fn forces_at(&self, x: &[f64]) -> Option<PartVectors> {
        let springs = self.springs.as_ref()?;
        let (mut values, mut local, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for ((dofs, network), factor) in self.places.dofs().zip(&**springs).zip(&self.factors) {
            local.clear();
            local.extend(dofs.iter().map(|&i| x[i]));
            own.clear();
            own.resize(local.len(), 0.0);
            // Where a part has no force, the network has no equilibrium whose derivatives are asked for.
            network.forces(&local, &mut own);
            values.extend(own.iter().map(|f| factor * f));
        }
        Some(PartVectors { places: self.places.clone(), values })
    }

    /// Whether deformations may be large.
    pub(super) fn is_large(&self) -> bool {
        self.springs.is_some()
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
fn in_region(modulus: &str, groups: &[String]) -> String {
    if groups.is_empty() { modulus.into() } else { format!("{modulus} of {}", groups.join(", ")) }
}
