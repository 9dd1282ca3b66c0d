//! The unknowns θ of a calibration: logarithms of factors on Young's modulus, and changes of Poisson's ratio.
//!
//! Poisson's ratio is `ν = (e^t − 1)/(1 + 2 e^t)`, with `t = ln((1 + ν)/(1 − 2ν)) = ln(3K/2μ)`, so that every t is a material.
//!
//! Theory: page *Calibration* of the book.

use crate::error::Result;
use crate::material::{CellMap, Hooke, LinearMaterial, Material, MaterialMap, Moduli};
use crate::mesh::{CellIndex, Mesh};

/// What is found of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Young's modulus of each region; Poisson's ratio is known.
    Young,
    /// Young's modulus and Poisson's ratio of each region.
    Moduli,
    /// Young's modulus of each cell of the first mesh; Poisson's ratio is known.
    Cells,
}

crate::named!(Asked { "young" => Young, "moduli" => Moduli, "cells" => Cells });

/// One unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// The logarithm of a factor on Young's modulus of a region.
    Young(usize),
    /// The change of t of a region.
    Poisson(usize),
    /// The logarithm of a factor on Young's modulus of a cell of the first mesh.
    Cell(usize),
}

/// The unknowns in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// Each has an entry of θ.
    pub all: Vec<Unknown>,
    /// By region, where its Young's modulus is in θ.
    young: Vec<Option<usize>>,
    /// By region, where its t is in θ.
    poisson: Vec<Option<usize>>,
    /// Whether each cell has an unknown.
    by_cell: bool,
}

/// The step of t over which moduli are differentiated.
// They are smooth in it: central differences err by its square, 1e-10, and by the rounding of moduli over it, 1e-11.
const STEP: f64 = 1e-5;

impl Unknowns {
    /// The unknowns of regions, of which some are known, or those of `cells` cells.
    pub fn new(asked: Asked, is_known: &[bool], cells: usize) -> Unknowns {
        let mut found = Unknowns {
            all: Vec::new(),
            young: vec![None; is_known.len()],
            poisson: vec![None; is_known.len()],
            by_cell: asked == Asked::Cells,
        };
        if found.by_cell {
            found.all = (0..cells).map(Unknown::Cell).collect();
            return found;
        }
        for region in (0..is_known.len()).filter(|&region| !is_known[region]) {
            found.young[region] = Some(found.all.len());
            found.all.push(Unknown::Young(region));
            if asked == Asked::Moduli {
                found.poisson[region] = Some(found.all.len());
                found.all.push(Unknown::Poisson(region));
            }
        }
        found
    }

    /// The number of unknowns.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Where Young's modulus of a region, or of an owner among the cells of the first mesh, is in θ.
    fn young_at(&self, region: usize, owner: usize) -> Option<usize> {
        if self.by_cell { Some(owner) } else { self.young[region] }
    }

    /// The material of a cell whose first guess is `base`.
    ///
    /// # Errors
    /// The constants are beyond their ranges.
    fn material(&self, base: &Material, region: usize, owner: usize, theta: &[f64]) -> Result<Material> {
        let young = self.young_at(region, owner).map_or(1.0, |place| theta[place].exp()) * base.young();
        let poisson = match self.poisson[region] {
            Some(place) => poisson_of(ratio_of(base.poisson()) + theta[place]),
            None => base.poisson(),
        };
        Material::new(young, poisson, base.state())
    }

    /// The moduli by whose stiffnesses the forces of a cell change with its unknowns, and where these are in θ.
    pub(super) fn changes(&self, now: &Material, region: usize, owner: usize) -> Vec<(usize, Hooke)> {
        let own = now.moduli();
        // Moduli are proportional to `E = E₀ e^θ`, so that their derivative in θ is what they are.
        let young = self.young_at(region, owner).map(|place| (place, own.into()));
        let poisson = self.poisson[region].and_then(|place| {
            let beside = |t: f64| Material::new(now.young(), poisson_of(ratio_of(now.poisson()) + t), now.state());
            let (more, less) = (beside(STEP).ok()?.moduli(), beside(-STEP).ok()?.moduli());
            // The central difference errs by the square of the step, 1e-10, and rounding over the step by 1e-11.
            let rate = |a: f64, b: f64| (a - b) / (2.0 * STEP);
            let moduli = Moduli { lambda: rate(more.lambda, less.lambda), mu: rate(more.mu, less.mu) };
            Some((place, moduli.into()))
        });
        young.into_iter().chain(poisson).collect()
    }

    /// The materials of a mesh at θ; `owners` has the cell of the first mesh that has each cell, by block.
    ///
    /// # Errors
    /// Some cell is anisotropic, or constants are beyond their ranges.
    pub(super) fn materials(
        &self,
        mesh: &Mesh,
        base: &MaterialMap,
        owners: &[Vec<usize>],
        theta: &[f64],
    ) -> Result<MaterialMap> {
        let (materials, region) = (base.materials()?, base.region());
        let of_cell = |CellIndex { block, cell }: CellIndex| {
            let owner = owners.get(block).map_or(0, |own| own[cell]);
            let material = self.material(materials.at(block, cell), *region.at(block, cell), owner, theta);
            material.map(LinearMaterial::from)
        };
        let block = |block: usize| {
            (0..mesh.blocks[block].cells().len()).map(|cell| of_cell(CellIndex { block, cell })).collect::<Result<_>>()
        };
        let all = (0..mesh.blocks.len()).map(block).collect::<Result<_>>()?;
        let map = MaterialMap::of_regions(CellMap::of_blocks(all), base.regions().to_vec(), region.clone())?;
        Ok(map.with_density(base.density().cloned()))
    }
}

/// Poisson's ratio of t.
pub fn poisson_of(t: f64) -> f64 {
    // Without overflow on either side.
    if t > 0.0 { (1.0 - (-t).exp()) / ((-t).exp() + 2.0) } else { (t.exp() - 1.0) / (1.0 + 2.0 * t.exp()) }
}

/// t of Poisson's ratio, `ln((1 + ν)/(1 − 2ν))`.
pub fn ratio_of(poisson: f64) -> f64 {
    // The quotient is 3 K/(2 μ): t is a logarithm of a ratio of moduli, which takes every real number while Poisson's
    // ratio stays between −1 and 1/2.
    ((1.0 + poisson) / (1.0 - 2.0 * poisson)).ln()
}
