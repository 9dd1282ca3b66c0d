//! The fits and loads of a scene, each with a name of its own, and what fits require of the rest.

use super::bending::Bending;
use super::load::LoadCase;
use super::material::MaterialEntries;
use crate::error::{Error, ErrorKind, Result};
use crate::fits::{FitEntry, NamedFit, SceneFacts};
use crate::own_name::{BODY, QUADRATIC, expect_own_name};
use std::path::Path;

/// The fits of all `[[fit]]` entries; files are relative to `folder`.
pub fn read_fits(entries: &[FitEntry], folder: &Path) -> Result<Vec<NamedFit>> {
    let mut fits: Vec<NamedFit> = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        for fit in entry.fits(folder).map_err(|e| e.placed(|e| e.under(format!("fit[{i}]"))))? {
            let key = format!("fit[{i}].name");
            if fit.name.trim().is_empty() {
                return Err(Error::expected(key, "a name", format!("\"{}\"", fit.name)));
            }
            let reserved =
                [BODY, QUADRATIC].into_iter().filter(|name| fit.name.eq_ignore_ascii_case(name)).map(|_| &*fit.name);
            expect_own_name(&key, &fit.name, reserved.chain(fits.iter().map(|fit| fit.name.as_str())))?;
            fits.push(fit.of_entry(i));
        }
    }
    Ok(fits)
}

/// Checks that the material and the loads are those that the fits require.
pub fn check_fits(fits: &[NamedFit], material: &MaterialEntries, loads: &[LoadCase]) -> Result<()> {
    let names: Vec<&str> = loads.iter().map(|load| load.name.as_str()).collect();
    let has_law = material.first().law.is_some();
    let facts = SceneFacts { law: has_law, density: material.has_density(), loads: &names };
    for fit in fits {
        let place = fit.place();
        let lawless = fit.recipe.sampled().is_some_and(|recipe| recipe.law.is_none());
        if lawless && !has_law {
            let expected = format!("the energy whose forces {place} samples, such as \"neo-hookean\"");
            return Err(Error::expected("material.law", expected, "none"));
        }
        let needs_points_alone = fit.recipe.whole().is_some() || fit.engine.is_some();
        if needs_points_alone && material.first().bending != Bending::None {
            let expected = "fits to cells, without an engine, of a sheet or of rods that bend";
            return Err(Error::expected(place, expected, "another").of_kind(ErrorKind::Unsupported));
        }
        // What an engine needs of the scene is known before the fits, which may take long.
        if fit.engine.is_some() && has_law {
            let expected = "a material without a \"law\": constants for an engine are fitted at small deformation";
            return Err(Error::expected(format!("{place}.engine"), expected, "one with a law"));
        }
        if fit.engine.is_some() && !facts.density {
            let expected = "a density in [material]: what an engine reaches depends on the masses";
            return Err(Error::expected(format!("{place}.engine"), expected, "none"));
        }
        if fit.bending.is_some() && material.first().bending == Bending::None {
            let expected = "a sheet with bending = \"plate\" in its material, or rods with \"rod\"";
            return Err(Error::expected(format!("{place}.bending"), expected, "a body that does not bend as one"));
        }
        fit.recipe.kind().check(&facts).map_err(|e| e.under(place))?;
    }
    Ok(())
}
