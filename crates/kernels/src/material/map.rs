//! The materials of a body.

use super::{CellMap, Material, Moduli, State};
use crate::error::{Error, Result};
use std::sync::Arc;

/// The material of each cell of a body, and the regions of which the body consists. Copies share the values.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialMap {
    state: State,
    materials: CellMap<Material>,
    moduli: CellMap<Moduli>,
    /// The name of each region; one if the body has no regions.
    regions: Arc<[String]>,
    region: CellMap<usize>,
    density: Option<CellMap<f64>>,
}

impl MaterialMap {
    /// A body of these materials without regions.
    ///
    /// # Errors
    /// Those of [`MaterialMap::of_regions`].
    pub fn of_cells(materials: CellMap<Material>) -> Result<MaterialMap> {
        MaterialMap::of_regions(materials, vec![String::new()], CellMap::Uniform(0))
    }

    /// A body of these materials, the names of its regions, and the region of each cell.
    ///
    /// # Errors
    /// There is no cell, the cells are not all in the same kind of state, or a cell is in a region without a name.
    pub fn of_regions(
        materials: CellMap<Material>,
        regions: Vec<String>,
        region: CellMap<usize>,
    ) -> Result<MaterialMap> {
        let Some(state) = materials.values().next().map(Material::state) else {
            return Err(Error::expected("material", "that of at least one cell", "none"));
        };
        let is_same = |other: State| std::mem::discriminant(&other) == std::mem::discriminant(&state);
        if !materials.values().all(|material| is_same(material.state())) {
            return Err(Error::expected("plane", "the same plane state in all cells", "both"));
        }
        if let Some(found) = region.values().find(|region| **region >= regions.len()) {
            return Err(Error::expected("region", format!("a number below {}", regions.len()), found));
        }
        let moduli = materials.map(Material::moduli);
        Ok(MaterialMap { state, materials, moduli, regions: regions.into(), region, density: None })
    }

    /// The same materials with the density of each cell, kg/m³, or without.
    pub fn with_density(self, density: Option<CellMap<f64>>) -> MaterialMap {
        MaterialMap { density, ..self }
    }

    /// The density of each cell, kg/m³, if it is given.
    pub fn density(&self) -> Option<&CellMap<f64>> {
        self.density.as_ref()
    }

    /// The material of all cells, if they have the same.
    pub fn uniform(&self) -> Option<Material> {
        self.materials.uniform().copied()
    }

    /// The state of the body; its thickness is that of the first cell.
    pub fn state(&self) -> State {
        self.state
    }

    /// The material of each cell.
    pub fn materials(&self) -> &CellMap<Material> {
        &self.materials
    }

    /// The moduli of each cell, see [`Material::moduli`].
    pub fn moduli(&self) -> CellMap<Moduli> {
        self.moduli.clone()
    }

    /// The factor that makes the content of each cell a volume, see [`State::thickness`].
    pub fn thicknesses(&self) -> CellMap<f64> {
        self.materials.map(Material::thickness)
    }

    /// The names of the regions; a single one without a name if the body has no regions.
    pub fn regions(&self) -> &[String] {
        &self.regions
    }

    /// The region of each cell, as an index into [`MaterialMap::regions`].
    pub fn region(&self) -> &CellMap<usize> {
        &self.region
    }

    /// The materials of some of the cells, which are given by block.
    pub fn of_some(&self, cells: &[Vec<usize>]) -> MaterialMap {
        MaterialMap {
            state: self.state,
            materials: self.materials.of_cells(cells),
            moduli: self.moduli.of_cells(cells),
            regions: self.regions.clone(),
            region: self.region.of_cells(cells),
            density: self.density.as_ref().map(|density| density.of_cells(cells)),
        }
    }

    /// Checks that every cell has a material; `cells` has the number of cells of each block.
    ///
    /// # Errors
    /// There is another number of blocks, or of materials of a block.
    pub fn check(&self, cells: &[usize]) -> Result<()> {
        self.materials.check("material", cells)?;
        self.region.check("region", cells)
    }
}

impl From<Material> for MaterialMap {
    fn from(material: Material) -> MaterialMap {
        MaterialMap {
            state: material.state(),
            materials: CellMap::Uniform(material),
            moduli: CellMap::Uniform(material.moduli()),
            regions: [String::new()].into(),
            region: CellMap::Uniform(0),
            density: None,
        }
    }
}

impl From<&MaterialMap> for MaterialMap {
    fn from(map: &MaterialMap) -> MaterialMap {
        map.clone()
    }
}
