//! The files that a command writes, known before its work.

use super::former::former_names;
use super::names::{REPORT, Stems};
use super::pictures::check_arrays;
use crate::error::Result;
use crate::file::Edition;
use crate::study::{BODY, NamedFit, Scene};
use std::path::{Path, PathBuf};

/// Opens `folder`, which need not exist yet, for these files, before the work whose results they have.
///
/// # Errors
/// Those of [`Edition::begin`].
pub fn open_outputs(folder: &Path, names: &[&str], inputs: &[PathBuf]) -> Result<Edition> {
    Edition::begin(folder, names, inputs, &former_names(folder))
}

/// Opens `folder`, which need not exist yet, for all files that a run of the scene writes, before the work.
///
/// # Errors
/// Those of [`Edition::begin`]; or two arrays of a file for ParaView would have the same name.
pub fn open_scene_outputs(scene: &Scene, folder: &Path) -> Result<Edition> {
    let output = scene.output();
    let fits: Vec<&str> = scene.fits().iter().map(|fit| fit.name.as_str()).collect();
    let recipe = scene.motion();
    let bodies = recipe.filter(|recipe| recipe.finite_elements).map(|_| BODY);
    let moved: Vec<&str> = recipe.map_or(Vec::new(), |_| bodies.into_iter().chain(fits.iter().copied()).collect());
    let stems = Stems::of(fits.iter().copied(), moved.iter().copied());
    if output.vtu {
        check_arrays(scene)?;
    }
    let has_masses = |fit: &NamedFit| fit.recipe.whole().is_some_and(|whole| whole.masses > 0);
    let has_data = |fit: &NamedFit| fit.recipe.sampled().is_some_and(|recipe| recipe.fit.data);
    let is_written = |name: &String| match name.rsplit_once('.') {
        _ if stems.motions.iter().any(|stem| *name == format!("{stem}.csv")) => true,
        _ if stems.points.iter().any(|stem| *name == format!("{stem}.csv")) => {
            output.csv && scene.fits().iter().any(has_masses)
        }
        Some((stem, "csv")) if stems.sampled.as_flattened().iter().any(|own| own == stem) => {
            let fit = stems.sampled.iter().position(|own| own.iter().any(|own| own == stem));
            fit.is_some_and(|fit| has_data(&scene.fits()[fit]))
        }
        Some((_, "csv")) => output.csv,
        Some((_, "html")) => output.has_page(),
        Some((_, "json")) if name == REPORT => output.report != Some(false),
        Some((_, "json")) => output.json != Some(false),
        _ => output.vtu,
    };
    let mut names: Vec<String> = stems.names().filter(is_written).collect();
    if output.vtu {
        // The first picture of each motion stands for all.
        names.extend(stems.motions.iter().map(|stem| format!("{stem}/0000.vtu")));
    }
    open_outputs(folder, &names.iter().map(String::as_str).collect::<Vec<_>>(), &scene.inputs())
}
