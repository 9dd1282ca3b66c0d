//! The laws of the regions of a scene.

use super::material::MaterialEntries;
use crate::error::Result;
use crate::material::{Energy, EnergyMap, MaterialMap, State};
use crate::study::fits::law_at;
use std::path::Path;

/// The energies of the laws of all regions, if there are laws; files are relative to `folder`.
///
/// # Errors
/// There is no such law, or its file is wrong.
pub fn laws_of_regions(entries: &MaterialEntries, material: &MaterialMap, folder: &Path) -> Result<Option<EnergyMap>> {
    let mut laws: Vec<(Energy, State)> = Vec::new();
    for (i, entry) in entries.all.iter().enumerate() {
        let Some(law) = &entry.law else { return Ok(None) };
        let own = material.region().position(|region| *region == i);
        let Some(own) = own.and_then(|(block, cell)| material.isotropic(block, cell)) else {
            // What is left of the body may be nothing.
            laws.extend(laws.first().cloned());
            continue;
        };
        let key = format!("{}.law", entries.key(i));
        let energy = Energy::load(&law_at(law, folder), own).map_err(|e| e.placed(|e| e.at_key(key)))?;
        laws.push((energy, own.state()));
    }
    Ok(EnergyMap::new(laws, material.region().clone()))
}
