//! The materials of a scene on its mesh: the region of each cell, and the material there.

use super::distribution::Distribution;
use super::in_memory::InMemory;
use super::material::{MaterialEntries, MaterialEntry};
use super::part::Part;
use super::places::{Accepted, Places, Values};
use crate::body_material::{BodyConstants, Stated, assumed};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Anisotropy, CellMap, LinearMaterial, MaterialMap};
use crate::mesh::{CellIndex, Mesh};
use crate::range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl MaterialEntries {
    /// A sentence about what is assumed of the cells of entries that do not give it, if anything is.
    pub fn assumption(&self, mesh: &Mesh) -> Option<String> {
        let stated = |has: fn(&MaterialEntry) -> bool| match self.all.iter().filter(|entry| has(entry)).count() {
            0 => Stated::Nowhere,
            some if some < self.all.len() => Stated::Partly,
            _ => Stated::Everywhere,
        };
        // A region of rods in a plane body has a cross-section.
        let thickness = stated(|entry| entry.thickness.is_some() || entry.area.is_some());
        assumed(mesh, thickness, stated(|entry| entry.area.is_some()))
    }

    /// The materials of a body, with their density if the entries give one; `own` is the file of the mesh, if it is one, and its scale, and
    /// `memory` has what names of files mean before files.
    ///
    /// # Errors
    /// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
    /// its range; or a surface in space has no thickness.
    pub fn on(
        &self,
        mesh: &Mesh,
        folder: &Path,
        own: Option<(PathBuf, f64)>,
        memory: &InMemory,
    ) -> Result<MaterialMap> {
        let entry = self.first();
        if !self.is_uniform() || entry.part()? != Part::Everything {
            return match arrays_map(self, mesh, (folder, memory))? {
                Some(map) => Ok(map),
                None => material_map(self, mesh, (folder, memory), own),
            };
        }
        let material = self.constants().and_then(|constants| constants.material(mesh));
        let material = MaterialMap::from(material.map_err(|e| e.under(self.key(0)))?);
        let density = entry.density.as_ref().and_then(Distribution::number);
        Ok(material.with_density(density.map(CellMap::Uniform)))
    }

    /// The constants of a material that is the same in all cells.
    ///
    /// # Errors
    /// It differs from cell to cell.
    pub fn constants(&self) -> Result<BodyConstants> {
        let entry = self.first();
        let several = || Error::new("expected one isotropic material for all cells, found several or another");
        let number = |values: &Option<Distribution>| values.as_ref().and_then(Distribution::number);
        let (Some(young), Some(poisson), true) = (number(&entry.young), number(&entry.poisson), self.is_uniform())
        else {
            return Err(several());
        };
        let thickness = entry.thickness.as_ref().and_then(Distribution::number);
        Ok(BodyConstants { young, poisson, plane: entry.plane, thickness, area: entry.area })
    }
}

/// The materials of a body of one isotropic region whose constants are numbers and arrays in memory, of which there may be one for each of
/// millions of cells; `None` where they are others.
fn arrays_map(entries: &MaterialEntries, mesh: &Mesh, from: (&Path, &InMemory)) -> Result<Option<MaterialMap>> {
    let [entry] = &entries.all[..] else { return Ok(None) };
    let thickness = entry.thickness.as_ref().map(Distribution::number);
    if entry.part()? != Part::Everything || entry.anisotropy()?.is_some() || thickness == Some(None) {
        return Ok(None);
    }
    let of = |values: &Distribution| match values.number() {
        Some(value) => Some(CellMap::Uniform(value)),
        None => from.1.values(values.file()?)?.of_mesh(mesh),
    };
    let (Some(young), Some(poisson)) = (entry.young.as_ref().and_then(of), entry.poisson.as_ref().and_then(of)) else {
        return Ok(None);
    };
    let density = entry.density.as_ref().map(of);
    if density == Some(None) {
        return Ok(None);
    }
    let under = |e: Error| e.placed(|e| e.under(entries.key(0)));
    let named = |(block, cell), e| under(Places::new(mesh, from).named(e, CellIndex { block, cell }));
    let constants = BodyConstants {
        young: 1.0,
        poisson: 0.0,
        plane: entry.plane,
        thickness: thickness.flatten(),
        area: entry.area,
    };
    let like = constants.material(mesh).map_err(under)?;
    let map = MaterialMap::of_constants(like, &young, &poisson).map_err(|(cell, e)| named(cell, e))?;
    let density = density.flatten();
    let wrong = |density: &CellMap<f64>| {
        let cell = density.position(|value| !(*value > 0.0 && value.is_finite()))?;
        Some((cell, range::positive("density", *density.at(cell.0, cell.1), "kg/m³").err()?))
    };
    if let Some((cell, error)) = density.as_ref().and_then(wrong) {
        return Err(named(cell, error));
    }
    Ok(Some(map.with_density(density)))
}

/// The materials of the cells of a mesh; the keys of errors are those of the scene. `own` is the file of the mesh, if it is one, and its scale.
///
/// # Errors
/// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
/// its range in some cell.
fn material_map(
    entries: &MaterialEntries,
    mesh: &Mesh,
    from: (&Path, &InMemory),
    own: Option<(PathBuf, f64)>,
) -> Result<MaterialMap> {
    let region = region_of_cells(entries, mesh)?;
    let names = entries.all.iter().map(|entry| if entries.is_list { entry.name() } else { String::new() }).collect();
    let sizes: Vec<usize> = mesh.blocks.iter().map(|block| block.cells().len()).collect();
    let mut cells = vec![Vec::new(); entries.all.len()];
    for (block, own) in region.iter().enumerate() {
        own.iter().enumerate().for_each(|(cell, &region)| cells[region].push(CellIndex { block, cell }));
    }
    let mut materials: Vec<Vec<Option<LinearMaterial>>> = sizes.iter().map(|count| vec![None; *count]).collect();
    let mut densities: Vec<Vec<f64>> = sizes.iter().map(|count| vec![0.0; *count]).collect();
    let places = Places::new(mesh, from).beside(own);
    for (i, (entry, cells)) in entries.all.iter().zip(&cells).enumerate() {
        let under = |e: Error| e.placed(|e| e.under(entries.key(i)));
        let values = RegionValues::of(entry, &places, cells).map_err(under)?;
        for (own, &index) in cells.iter().enumerate() {
            let material = values.material(entry, mesh, own, index.block).map_err(|e| under(places.named(e, index)))?;
            materials[index.block][index.cell] = Some(material);
            if let Some(density) = &values.density {
                let density = range::positive("density", density.at(own), "kg/m³");
                densities[index.block][index.cell] = density.map_err(|e| under(places.named(e, index)))?;
            }
        }
    }
    let known = |own: Vec<Option<LinearMaterial>>| own.into_iter().flatten().collect();
    let materials = CellMap::of_blocks(materials.into_iter().map(known).collect());
    let density = entries.has_density().then(|| CellMap::of_blocks(densities));
    Ok(MaterialMap::of_regions(materials, names, CellMap::of_blocks(region))?
        .with_density(density)
        .with_remarks(places.remarks()))
}

/// The index of the entry of each cell, by block.
fn region_of_cells(entries: &MaterialEntries, mesh: &Mesh) -> Result<Vec<Vec<usize>>> {
    let mut region: Vec<Vec<Option<usize>>> = mesh.blocks.iter().map(|b| vec![None; b.cells().len()]).collect();
    let (mut rest, mut shared) = (None, Vec::new());
    for (i, entry) in entries.all.iter().enumerate() {
        let under = |e: Error| e.under(entries.key(i));
        let part = entry.part().map_err(under)?;
        if part == Part::Everything {
            rest = Some(i);
            continue;
        }
        let mut chosen = part.selection(mesh.dimension).and_then(|s| s.cells(mesh)).map_err(under)?;
        // What is attached to the body has the material that names its group.
        if matches!(part, Part::Where(_)) {
            chosen.retain(|cell| mesh.is_of_body(*cell));
        }
        if chosen.is_empty() {
            let problem = match (&part, mesh.annotations.left_out.is_empty()) {
                (Part::Group(name), false) if mesh.groups.contains_key(name) => {
                    let left_out = mesh.annotations.left_out_words();
                    format!(
                        "has no cells: group \"{name}\" has none of the body, which is without what has fewer dimensions: {left_out}"
                    )
                }
                (Part::Group(name), _) if mesh.groups.get(name).is_some_and(|group| group.is_of_points()) => {
                    format!(
                        "has no cells: the group \"{name}\" has points alone, of which no membranes or rods can be made"
                    )
                }
                _ => "has no cells: the selected part of the mesh has none".into(),
            };
            return Err(under(part.without_members(&problem, mesh)));
        }
        for cell in chosen {
            match region[cell.block][cell.cell].replace(i) {
                // A file may list a cell of a group twice.
                Some(other) if other != i => shared.push((other, i)),
                _ => {}
            }
        }
    }
    if let Some(&(a, b)) = shared.first() {
        let found = format!("{} in two, such as those of {} and {}", shared.len(), entries.key(a), entries.key(b));
        return Err(Error::expected("material", "every cell in one region", found));
    }
    let left = region.iter().flatten().filter(|region| region.is_none()).count();
    if let (Some(rest), 0) = (rest, left) {
        let problem = "has no cells: the regions with \"group\" or \"where\" have them all";
        return Err(Error::new(problem).under(entries.key(rest)));
    }
    let Some(rest) = rest.or((left == 0).then_some(0)) else {
        let expected = "every cell in a region, or one [[material]] without \"group\" and \"where\" for the rest";
        return Err(Error::expected("material", expected, format!("{left} cells in none")));
    };
    Ok(region.into_iter().map(|own| own.into_iter().map(|region| region.unwrap_or(rest)).collect()).collect())
}

/// The values of the quantities of one entry in its cells.
struct RegionValues {
    /// Young's modulus and Poisson's ratio of isotropic materials.
    isotropic: Option<[Values; 2]>,
    /// The law of each cell in its axes; one if all have the same.
    anisotropic: Option<Vec<Arc<Anisotropy>>>,
    thickness: Option<Values>,
    density: Option<Values>,
}

impl RegionValues {
    fn of(entry: &MaterialEntry, places: &Places, cells: &[CellIndex]) -> Result<RegionValues> {
        let of = |key: &str, values: &Distribution| {
            places.accepted_values(values, cells, Accepted::of(key)).map_err(|e| e.placed(|e| e.under(key)))
        };
        let optional = |key: &str, values: &Option<Distribution>| values.as_ref().map(|v| of(key, v)).transpose();
        let anisotropic = entry.anisotropy()?.map(|law| places.laws(&law, &entry.axes()?, cells)).transpose()?;
        let isotropic = match (&entry.young, &entry.poisson) {
            (Some(young), Some(poisson)) => Some([of("young", young)?, of("poisson", poisson)?]),
            _ => None,
        };
        Ok(RegionValues {
            isotropic,
            anisotropic,
            thickness: optional("thickness", &entry.thickness)?,
            density: optional("density", &entry.density)?,
        })
    }

    /// The material of a cell of a block, by its index in the region.
    fn material(&self, entry: &MaterialEntry, mesh: &Mesh, cell: usize, block: usize) -> Result<LinearMaterial> {
        // The state of an anisotropic material is that of any other.
        let [young, poisson] =
            self.isotropic.as_ref().map_or([1.0, 0.0], |[young, poisson]| [young.at(cell), poisson.at(cell)]);
        let constants = BodyConstants {
            young,
            poisson,
            plane: entry.plane,
            thickness: self.thickness.as_ref().map(|thickness| thickness.at(cell)),
            area: entry.area,
        };
        let material = constants.of_block(mesh, block)?;
        let Some(laws) = &self.anisotropic else { return Ok(material.into()) };
        if mesh.blocks[block].element.dimension() != mesh.dimension || mesh.dimension == 1 {
            let expected = "an isotropic material on surfaces and curves in space and on rods";
            return Err(Error::expected("young", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported));
        }
        let law = laws.get(cell).unwrap_or(&laws[0]).clone();
        Ok(LinearMaterial::Anisotropic(law, material.state()))
    }
}
