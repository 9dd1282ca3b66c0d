//! The materials of a scene on its mesh: the region of each cell, and the material there.

use super::distribution::Distribution;
use super::material::{MaterialEntries, MaterialEntry};
use super::part::Part;
use super::places::{Accepted, Places, Values};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Anisotropy, CellMap, LinearMaterial, MaterialMap};
use crate::mesh::{CellIndex, Mesh};
use crate::range;
use crate::study::body_material::BodyConstants;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The materials of the cells of a mesh; the keys of errors are those of the scene. `own` is the file of the mesh, if it is one, and its scale.
///
/// # Errors
/// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
/// its range in some cell.
pub fn material_map(
    entries: &MaterialEntries,
    mesh: &Mesh,
    folder: &Path,
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
    let places = Places::new(mesh, folder).beside(own);
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
