//! The materials of a body.

use super::{Anisotropy, CellMap, Hooke, Material, State};
use crate::error::{Error, ErrorKind, Result};
use std::sync::Arc;

/// The material of each cell of a body, and the regions of which the body consists. Copies share the values.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialMap {
    state: State,
    /// `None` if some cell is anisotropic.
    materials: Option<CellMap<Material>>,
    /// If some cell is anisotropic.
    linear: Option<CellMap<LinearMaterial>>,
    moduli: CellMap<Hooke>,
    thicknesses: CellMap<f64>,
    /// The name of each region; one if the body has no regions.
    regions: Arc<[String]>,
    region: CellMap<usize>,
    density: Option<CellMap<f64>>,
    /// What was left out of the files that state it, one sentence each.
    remarks: Arc<[String]>,
}

/// The linear material of a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum LinearMaterial {
    /// Isotropic.
    Isotropic(Material),
    /// Anisotropic, with its own state.
    Anisotropic(Arc<Anisotropy>, State),
}

impl LinearMaterial {
    fn state(&self) -> State {
        match self {
            LinearMaterial::Isotropic(material) => material.state(),
            LinearMaterial::Anisotropic(_, state) => *state,
        }
    }

    fn hooke(&self) -> Result<Hooke> {
        Ok(match self {
            LinearMaterial::Isotropic(material) => Hooke::Isotropic(material.moduli()),
            LinearMaterial::Anisotropic(anisotropy, state) => Hooke::Anisotropic(anisotropy.in_state(*state)?),
        })
    }

    fn isotropic(&self) -> Option<Material> {
        match self {
            LinearMaterial::Isotropic(material) => Some(*material),
            LinearMaterial::Anisotropic(..) => None,
        }
    }
}

impl From<Material> for LinearMaterial {
    fn from(material: Material) -> LinearMaterial {
        LinearMaterial::Isotropic(material)
    }
}

impl MaterialMap {
    /// A body of these materials without regions.
    ///
    /// # Errors
    /// Those of [`MaterialMap::of_regions`].
    pub fn of_cells(materials: CellMap<LinearMaterial>) -> Result<MaterialMap> {
        MaterialMap::of_regions(materials, vec![String::new()], CellMap::Uniform(0))
    }

    /// A body of these materials, the names of its regions, and the region of each cell.
    ///
    /// # Errors
    /// There is no cell, the cells of the body are not all in the same kind of state, a stiffness in that state is not positive definite, or a cell
    /// is in a region without a name.
    pub fn of_regions(
        materials: CellMap<LinearMaterial>,
        regions: Vec<String>,
        region: CellMap<usize>,
    ) -> Result<MaterialMap> {
        let Some(state) = materials.values().next().map(LinearMaterial::state) else {
            return Err(Error::expected("material", "that of at least one cell", "none"));
        };
        // Membranes and rods that are attached to a body have states of their own.
        let is_same = |other: State| {
            std::mem::discriminant(&other) == std::mem::discriminant(&state) || other.dimension() < state.dimension()
        };
        if !materials.values().all(|material| is_same(material.state())) {
            return Err(Error::expected("plane", "the same plane state in all cells", "both"));
        }
        if let Some(found) = region.values().find(|region| **region >= regions.len()) {
            return Err(Error::expected("region", format!("a number below {}", regions.len()), found));
        }
        let moduli = materials.try_map(LinearMaterial::hooke)?;
        let thicknesses = materials.map(|material| material.state().thickness());
        let none = || Error::new("some cell is anisotropic");
        let isotropic = materials.try_map(|material| material.isotropic().ok_or_else(none)).ok();
        let linear = isotropic.is_none().then_some(materials);
        Ok(MaterialMap {
            state,
            materials: isotropic,
            linear,
            moduli,
            thicknesses,
            regions: regions.into(),
            region,
            density: None,
            remarks: Arc::default(),
        })
    }

    /// A body of one region whose isotropic cells are in the state of `like`, with these constants E (Pa) and ν.
    ///
    /// # Errors
    /// A constant is out of its range: with the block and the index of the first such cell.
    pub fn of_constants(
        like: Material,
        young: &CellMap<f64>,
        poisson: &CellMap<f64>,
    ) -> std::result::Result<MaterialMap, ((usize, usize), Error)> {
        let state = like.state();
        let of = |cell: (usize, usize), young: f64, poisson: f64| {
            Material::new(young, poisson, state).map_err(|error| (cell, error))
        };
        let blocks = match (young, poisson) {
            (CellMap::Uniform(young), CellMap::Uniform(poisson)) => {
                return Ok(of((0, 0), *young, *poisson)?.into());
            }
            (CellMap::Each(blocks), _) | (_, CellMap::Each(blocks)) => blocks,
        };
        // Blocks may have millions of cells: their lists are made in one piece.
        let mut materials = Vec::with_capacity(blocks.len());
        for (block, values) in blocks.iter().enumerate() {
            let mut own = Vec::with_capacity(values.len());
            for cell in 0..values.len() {
                own.push(of((block, cell), *young.at(block, cell), *poisson.at(block, cell))?);
            }
            materials.push(own);
        }
        let materials = CellMap::of_blocks(materials);
        let moduli = materials.map(|material| Hooke::Isotropic(material.moduli()));
        Ok(MaterialMap { materials: Some(materials), moduli, ..MaterialMap::from(like) })
    }

    /// Gives the materials the density of each cell, kg/m³, or none.
    pub fn with_density(self, density: Option<CellMap<f64>>) -> MaterialMap {
        MaterialMap { density, ..self }
    }

    /// Says what was left out of the files that state the materials, one sentence each.
    pub fn with_remarks(self, remarks: Vec<String>) -> MaterialMap {
        MaterialMap { remarks: remarks.into(), ..self }
    }

    /// What was left out of the files that state the materials, one sentence each.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// The density of each cell, kg/m³, if it is given.
    pub fn density(&self) -> Option<&CellMap<f64>> {
        self.density.as_ref()
    }

    /// The density of each cell, kg/m³; zero if none is given.
    pub fn densities(&self) -> CellMap<f64> {
        self.density.clone().unwrap_or(CellMap::Uniform(0.0))
    }

    /// The material of all cells, if they have the same.
    pub fn uniform(&self) -> Option<Material> {
        self.materials.as_ref()?.uniform().copied()
    }

    /// The state of the body, whose cells come before those that are attached to it; its thickness is that of the first cell.
    pub fn state(&self) -> State {
        self.state
    }

    /// The material of each cell.
    ///
    /// # Errors
    /// Some cell is anisotropic; the kind is `Unsupported`.
    pub fn materials(&self) -> Result<&CellMap<Material>> {
        self.materials.as_ref().ok_or_else(|| {
            let others = "frobenius, offdiag, modal, spectral, divergence and whole serve every linear material";
            let expected = format!("isotropic materials: {others}");
            Error::expected("objective", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported)
        })
    }

    /// The isotropic material of a cell; `None` if it is anisotropic.
    pub fn isotropic(&self, block: usize, cell: usize) -> Option<Material> {
        match (&self.materials, &self.linear) {
            (Some(materials), _) => Some(*materials.at(block, cell)),
            (None, linear) => linear.as_ref().and_then(|linear| linear.at(block, cell).isotropic()),
        }
    }

    /// Young's modulus of each cell, Pa; it is not a number where a cell is anisotropic.
    pub fn young(&self) -> CellMap<f64> {
        self.of_each(Material::young)
    }

    /// Poisson's ratio of each cell; it is not a number where a cell is anisotropic.
    pub fn poisson(&self) -> CellMap<f64> {
        self.of_each(Material::poisson)
    }

    fn of_each(&self, value: fn(&Material) -> f64) -> CellMap<f64> {
        match (&self.materials, &self.linear) {
            (Some(materials), _) => materials.map(value),
            (None, Some(linear)) => linear.map(|material| material.isotropic().map_or(f64::NAN, |own| value(&own))),
            (None, None) => CellMap::Uniform(f64::NAN),
        }
    }

    /// The body with another material in each cell, in the same state.
    ///
    /// # Errors
    /// Some cell is anisotropic, or those of `of`.
    pub fn of_isotropic(&self, of: impl Fn(Material) -> Result<Material>) -> Result<MaterialMap> {
        let materials = self.materials()?.try_map(|material| of(*material))?;
        let moduli = materials.map(|material| Hooke::Isotropic(material.moduli()));
        Ok(MaterialMap { materials: Some(materials), moduli, ..self.clone() })
    }

    /// The body with another isotropic material in place of each, by its region.
    ///
    /// # Errors
    /// Some cell is anisotropic, or this returns the errors of `of`.
    pub fn of_isotropic_in(&self, of: impl Fn(usize, Material) -> Result<Material>) -> Result<MaterialMap> {
        let materials = self.materials()?.try_zip(&self.region, |material, region| of(*region, *material))?;
        let moduli = materials.map(|material| Hooke::Isotropic(material.moduli()));
        Ok(MaterialMap { materials: Some(materials), moduli, ..self.clone() })
    }

    /// The linear law of each cell, see [`Material::moduli`].
    pub fn moduli(&self) -> CellMap<Hooke> {
        self.moduli.clone()
    }

    /// The factor that makes the content of each cell a volume, see [`State::thickness`].
    pub fn thicknesses(&self) -> CellMap<f64> {
        self.thicknesses.clone()
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
            materials: self.materials.as_ref().map(|materials| materials.of_cells(cells)),
            linear: self.linear.as_ref().map(|linear| linear.of_cells(cells)),
            moduli: self.moduli.of_cells(cells),
            thicknesses: self.thicknesses.of_cells(cells),
            regions: self.regions.clone(),
            region: self.region.of_cells(cells),
            density: self.density.as_ref().map(|density| density.of_cells(cells)),
            remarks: self.remarks.clone(),
        }
    }

    /// Checks that every cell has a material; `cells` has the number of cells of each block.
    ///
    /// # Errors
    /// There is another number of blocks, or of materials of a block.
    pub fn check(&self, cells: &[usize]) -> Result<()> {
        self.moduli.check("material", cells)?;
        self.region.check("region", cells)
    }
}

impl From<Material> for MaterialMap {
    fn from(material: Material) -> MaterialMap {
        MaterialMap {
            state: material.state(),
            materials: Some(CellMap::Uniform(material)),
            linear: None,
            moduli: material.moduli().into(),
            thicknesses: CellMap::Uniform(material.thickness()),
            regions: [String::new()].into(),
            region: CellMap::Uniform(0),
            density: None,
            remarks: Arc::default(),
        }
    }
}

impl From<&MaterialMap> for MaterialMap {
    fn from(map: &MaterialMap) -> MaterialMap {
        map.clone()
    }
}
