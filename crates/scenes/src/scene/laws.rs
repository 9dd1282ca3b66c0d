//! The laws of a scene at large deformation, with the numbers of each cell.

use super::anisotropic::Axis;
use super::in_memory::InMemory;
use super::material::{MaterialEntries, MaterialEntry};
use super::places::{Places, Values};
use crate::error::{Error, Result};
use crate::fits::law_at;
use crate::material::{CellMap, Energy, EnergyMap, Material, MaterialMap, State};
use crate::mesh::{CellIndex, Mesh};
use std::collections::HashMap;
use std::path::Path;

/// The energies of the laws of all cells, if there are laws; files are relative to `folder`. Cells with the same numbers share one.
///
/// # Errors
/// There is no such law, its file is wrong, a parameter is not one of the law, or the law has no fibres; or a value is wrong in some cell.
pub fn laws_of_cells(
    entries: &MaterialEntries,
    mesh: &Mesh,
    material: &MaterialMap,
    (folder, memory): (&Path, &InMemory),
) -> Result<Option<EnergyMap>> {
    if entries.all.iter().any(|entry| entry.law.is_none()) {
        return Ok(None);
    }
    let mut cells = vec![Vec::new(); entries.all.len()];
    let mut index: Vec<Vec<usize>> = mesh.blocks.iter().map(|block| vec![0; block.cells().len()]).collect();
    for (block, own) in index.iter().enumerate() {
        (0..own.len()).for_each(|cell| cells[*material.region().at(block, cell)].push(CellIndex { block, cell }));
    }
    let places = Places::new(mesh, (folder, memory));
    let mut laws: Vec<(Energy, State)> = Vec::new();
    for (i, (entry, cells)) in entries.all.iter().zip(&cells).enumerate() {
        // What is left of the body may be nothing.
        if let (Some(law), false) = (&entry.law, cells.is_empty()) {
            let under = |e: Error| e.placed(|e| e.under(entries.key(i)));
            let of_region = Region { entry, material, places: &places, cells, path: law_at(law, folder) };
            for (cell, law) in cells.iter().zip(of_region.laws(&mut laws).map_err(under)?) {
                index[cell.block][cell.cell] = law;
            }
        }
    }
    Ok(EnergyMap::new(laws, CellMap::of_blocks(index)))
}

/// The cells of one entry.
struct Region<'a> {
    entry: &'a MaterialEntry,
    material: &'a MaterialMap,
    places: &'a Places<'a>,
    cells: &'a [CellIndex],
    /// The path or name of the law.
    path: String,
}

impl Region<'_> {
    /// The index of the law of each cell; laws that are new are appended.
    fn laws(&self, laws: &mut Vec<(Energy, State)>) -> Result<Vec<usize>> {
        let of = |cell: CellIndex| {
            let expected = || Error::expected("law", "an isotropic material", "an anisotropic one");
            self.material.isotropic(cell.block, cell.cell).ok_or_else(expected)
        };
        // What the law is at rest depends on its parameters, which may be those of the scene.
        let first = match self.entry.parameters().next() {
            Some(_) => Energy::read(&self.path),
            None => Energy::load(&self.path, of(self.cells[0])?),
        };
        let first = first.map_err(|e| e.placed(|e| e.at_key("law")))?;
        self.entry.parameters().try_for_each(|(name, _)| first.check_parameter(name))?;
        let parameters = self.parameters()?;
        let fibres = self.fibres(&first)?;
        let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
        let law = |(i, cell): (usize, &CellIndex)| {
            let material = of(*cell)?;
            let values: Vec<(&str, f64)> = parameters.iter().map(|(name, values)| (*name, values.at(i))).collect();
            let fibre = fibres.as_ref().map(|fibres| *fibres.get(i).unwrap_or(&fibres[0]));
            let key = bits(material, &values, fibre);
            if let Some(law) = known.get(&key) {
                return Ok(*law);
            }
            let own = first.of(material, &values, fibre).map_err(|e| match e.key() {
                Some("energy") => self.places.named(e.at_key("law"), *cell),
                _ => self.places.named(e, *cell),
            })?;
            laws.push((own, material.state()));
            known.insert(key, laws.len() - 1);
            Ok(laws.len() - 1)
        };
        self.cells.iter().enumerate().map(law).collect()
    }

    fn parameters(&self) -> Result<Vec<(&str, Values)>> {
        let of = |(name, values): (&'_ String, _)| {
            self.places.values(values, self.cells).map_err(|e| e.placed(|e| e.under(format!("parameters.{name}"))))
        };
        self.entry.parameters().map(|(name, values)| Ok((name.as_str(), of((name, values))?))).collect()
    }

    /// The direction in each cell, one if all have the same; of the law if the entry has none.
    fn fibres(&self, law: &Energy) -> Result<Option<Vec<[f64; 3]>>> {
        let Some(fibre) = &self.entry.fibre else { return Ok(None) };
        if !law.has_fibres() {
            let expected = format!("a law with fibres: \"{}\" has none", law.name());
            return Err(Error::expected("fibre", expected, "a direction"));
        }
        let axis: Axis = fibre.check().map_err(|e| e.under("fibre"))?;
        self.places.vectors("fibre", &axis, self.cells).map(Some)
    }
}

/// Equal for equal numbers.
fn bits(material: Material, parameters: &[(&str, f64)], fibre: Option<[f64; 3]>) -> Vec<u64> {
    let own = [material.young(), material.poisson(), material.thickness()];
    let all = own.into_iter().chain(parameters.iter().map(|(_, value)| *value)).chain(fibre.into_iter().flatten());
    all.map(f64::to_bits).collect()
}
