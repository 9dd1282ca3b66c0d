//! Springs on the content of patches of cells. They carry λ for nearly incompressible materials, where single cells
//! would lock.
//!
//! Each cell is shared among its points that are not held, because patches of held points lock as cells do. A cell
//! whose points are all held is a patch of its own. A point where regions of a body meet has a patch in each of them, because the
//! pressure may jump there.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::{MeasureSpring, SpringLaw};
use super::simplices::linear_simplices;
use crate::element::{Element, SpringKind};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit};
use crate::material::{CellMap, Material, MaterialMap, Moduli, State};
use crate::mesh::Mesh;
use crate::springs::{Content, Law, Measure, Patch};
use crate::stiffness::{gather, gathered};
use std::sync::Arc;

/// `T = λ ln J/(J V₀/b)`, from the energy `λ/2 ln² J`.
const NEO_HOOKEAN: &str = "b*ln(c/c0)*c0/c";

/// One spring per patch with the energy `V_n λ/2 (J_n − 1)²`, or that of the fit, `J_n = Σ_c s_c V_c/Σ_c s_c V_c0`,
/// with s_c the share of cell c, and λ the mean over the shares. `held` says of each point whether it is held, or is empty.
///
/// # Errors
/// The mesh has cells of several kinds, or cells other than triangles of three and tetrahedra of four nodes in a space
/// of their own dimension; or the material is one in which no cell locks at large deformation (kind `Unsupported`).
pub fn patch_springs(
    mesh: &Mesh,
    material: impl Into<MaterialMap>,
    fit: &ExactFit,
    held: &[bool],
) -> Result<Vec<MeasureSpring>> {
    springs_of_patches(mesh, material.into(), fit, held)
}

/// [`patch_springs`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn springs_of_patches(mesh: &Mesh, material: MaterialMap, fit: &ExactFit, held: &[bool]) -> Result<Vec<MeasureSpring>> {
    let others = "\"points\" or \"cells\": patches";
    let block = linear_simplices(mesh, "volume", others, "patches")?;
    let element = &block.element;
    let d = mesh.dimension;
    if fit.large && matches!(material.state(), State::PlaneStress { .. }) {
        let expected = format!("{others} are for bodies that lock");
        let found = "\"patches\" with a law in plane stress, where no cell locks";
        return Err(Error::expected("volume", expected, found).of_kind(ErrorKind::Unsupported));
    }
    let (mut shares, mut alone) = (vec![Vec::new(); mesh.point_count()], Vec::new());
    for (cell, nodes) in block.cells().enumerate() {
        let free: Vec<usize> = nodes.iter().copied().filter(|&p| !held.get(p).is_some_and(|held| *held)).collect();
        // The share of a cell without free points is infinite here, and is replaced below.
        let part = Part { nodes, share: 1.0 / free.len() as f64, cell };
        free.iter().for_each(|&point| shares[point].push(part));
        if free.is_empty() {
            alone.push(vec![Part { share: 1.0, ..part }]);
        }
    }
    let region = |part: &Part| *material.region().at(0, part.cell);
    // A sort that keeps the order of the cells of a region, in which sums are rounded.
    shares.iter_mut().for_each(|parts| parts.sort_by_key(region));
    let in_regions = shares.iter().flat_map(|parts| parts.chunk_by(|a, b| region(a) == region(b)));
    let moduli = &material.materials()?.map(Material::moduli);
    let law = match fit.energy {
        ExactEnergy::StableNeoHookean | ExactEnergy::StableMooneyRivlin { .. } => None,
        ExactEnergy::StVenantKirchhoff => return Err(fit.energy.contents_alone()),
        ExactEnergy::NeoHookean => Some(Arc::new(Law::parse(NEO_HOOKEAN)?)),
    };
    let spring = |parts: &[Part]| {
        let mut points: Vec<usize> = parts.iter().flat_map(|part| part.nodes).copied().collect();
        // Cells of a patch share points, and the binary search below asks for an ascending list.
        points.sort_unstable();
        points.dedup();
        let place = |node: &usize| points.binary_search(node).expect("the points of the patch are those of its cells");
        let cells = parts.iter().map(|part| (part.nodes.iter().map(place).collect(), part.share)).collect();
        let measure = Measure::Patch(Arc::new(Patch { element: element.clone(), cells }));
        let x = gathered(&mesh.points, d, &points);
        let rest = measure.value(&x, d);
        let lambda = mean_lambda(mesh, element, moduli, parts);
        MeasureSpring {
            kind: SpringKind::Patch,
            points: points.into(),
            // V λ/2 (J − 1)² with J = V/V₀ is λ/(2 V₀) (V − V₀)².
            constant: lambda / rest,
            rest,
            measure,
            law: law.as_ref().map(|law| Box::new(SpringLaw::new(law.clone(), &[lambda]))),
        }
    };
    let patches = in_regions.chain(alone.iter().map(|parts| &parts[..])).filter(|parts| !parts.is_empty());
    // At a Poisson's ratio of zero λ is zero, and nothing is to be carried.
    Ok(patches.map(spring).filter(|spring| spring.constant != 0.0).collect())
}

/// A cell in a patch.
#[derive(Clone, Copy)]
struct Part<'a> {
    nodes: &'a [usize],
    share: f64,
    cell: usize,
}

/// `Σ_c s_c V_c λ_c/Σ_c s_c V_c`.
fn mean_lambda(mesh: &Mesh, element: &Element, moduli: &CellMap<Moduli>, parts: &[Part]) -> f64 {
    if let CellMap::Uniform(moduli) = moduli {
        return moduli.lambda;
    }
    let mut x = vec![0.0; element.nodes() * mesh.dimension];
    let (mut sum, mut whole) = (0.0, 0.0);
    for part in parts {
        gather(&mesh.points, mesh.dimension, part.nodes, &mut x);
        let content = part.share * Content::of_cell(&element.tabulation, &x).value();
        sum += content * moduli.at(0, part.cell).lambda;
        whole += content;
    }
    sum / whole
}
