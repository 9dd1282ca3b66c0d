//! The files that a command writes, known before its work.

use super::pictures::check_arrays;
use crate::error::Result;
use crate::file::{check_apart, check_file, check_folder};
use crate::study::{BODY, NamedFit, Scene};
use std::path::{Path, PathBuf};

/// The table of the points, if all networks of a run have the same masses.
pub(super) const POINTS: &str = "points.csv";
/// The report.
pub(super) const REPORT: &str = "report.json";
/// The report as a page.
pub(super) const PAGE: &str = "report.html";

/// Checks that these files can be written into `folder`, which need not exist yet, and that no file is also an input.
///
/// # Errors
/// Names the file or the folder.
pub fn check_outputs(folder: &Path, names: &[&str], inputs: &[PathBuf]) -> Result<()> {
    check_folder(folder)?;
    let files: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    check_apart(&files, inputs)?;
    // A folder that is yet to come holds nothing that is in the way.
    files.iter().filter(|file| file.symlink_metadata().is_ok()).try_for_each(|file| check_file(file))
}

/// The same of all that a run of the scene writes.
///
/// # Errors
/// As there; or two arrays of a file for ParaView would have the same name.
pub fn check_scene_outputs(scene: &Scene, folder: &Path, more: &[PathBuf]) -> Result<()> {
    let output = scene.output();
    let fits: Vec<&str> = scene.fits().iter().map(|fit| fit.name.as_str()).collect();
    let recipe = scene.motion();
    let bodies = recipe.filter(|recipe| recipe.finite_elements).map(|_| BODY);
    let moved: Vec<&str> = recipe.map_or(Vec::new(), |_| bodies.into_iter().chain(fits.iter().copied()).collect());
    let Stems { fits, motions, points } = Stems::of(fits.iter().copied(), moved.iter().copied());
    let mut names: Vec<String> = motions.iter().map(|stem| format!("{stem}.csv")).collect();
    if output.csv {
        names.extend(fits.iter().map(|stem| format!("{stem}.csv")));
        names.push(POINTS.into());
        let has_masses = |fit: &NamedFit| fit.recipe.whole().is_some_and(|whole| whole.masses > 0);
        if scene.fits().iter().any(has_masses) {
            names.extend(points.iter().map(|stem| format!("{stem}.csv")));
        }
    }
    if output.json != Some(false) {
        names.extend(fits.iter().map(|stem| format!("{stem}.json")));
    }
    if output.vtu {
        check_arrays(scene)?;
        names.push("mesh.vtu".into());
        names.extend(fits.iter().map(|stem| format!("{stem}.vtu")));
        names.extend(motions.iter().map(|stem| format!("{stem}.pvd")));
        motions.iter().try_for_each(|stem| check_folder(&folder.join(stem)))?;
    }
    if output.report != Some(false) {
        names.push(REPORT.into());
    }
    if output.has_page() {
        names.push(PAGE.into());
    }
    let inputs: Vec<PathBuf> = scene.inputs().into_iter().chain(more.iter().cloned()).collect();
    check_outputs(folder, &names.iter().map(String::as_str).collect::<Vec<_>>(), &inputs)
}

/// The files' names without their endings.
pub(super) struct Stems {
    /// Files of the networks.
    pub fits: Vec<String>,
    /// Files of the motions.
    pub motions: Vec<String>,
    /// Files of the points of each network, where they are not the same.
    pub points: Vec<String>,
}

impl Stems {
    /// Of the fits, and of the models that move.
    pub fn of<'a>(fits: impl Iterator<Item = &'a str>, moved: impl Iterator<Item = &'a str>) -> Stems {
        let fits: Vec<&str> = fits.collect();
        let moved: Vec<String> = moved.map(|name| format!("motion {name}")).collect();
        let points: Vec<String> = fits.iter().map(|name| format!("points {name}")).collect();
        let own = moved.iter().chain(&points).map(String::as_str);
        let mut stems = file_stems(fits.iter().copied().chain(own));
        let points = stems.split_off(fits.len() + moved.len());
        let motions = stems.split_off(fits.len());
        Stems { fits: stems, motions, points }
    }
}

/// Characters of a stem, without the number that tells equal ones apart.
const LONGEST_STEM: usize = 40;

/// The stem of a name without letters or digits of ASCII.
const UNNAMED: &str = "fit";

/// Each name as the stem of a file of its own, also where files do not tell capitals from small letters: `modal 0.1 +bulk` is
/// `modal-0.1-bulk`.
pub(super) fn file_stems<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let reserved = ["mesh", "points", "report"];
    let mut stems: Vec<String> = reserved.map(String::from).into();
    for name in names {
        let kept = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        let dashed: String = name.chars().map(kept).collect();
        let mut stem = String::new();
        for part in dashed.split('-').filter(|part| !part.is_empty()) {
            if !stem.is_empty() && stem.len() + part.len() >= LONGEST_STEM {
                break;
            }
            stem += if stem.is_empty() { "" } else { "-" };
            stem += part;
        }
        stem.truncate(LONGEST_STEM);
        if stem.chars().all(|c| c == '.') {
            stem = UNNAMED.into();
        }
        let numbered = (2..).map(|i| format!("{stem}-{i}"));
        let is_free = |stem: &String| !stems.iter().any(|other| other.eq_ignore_ascii_case(stem));
        let free = std::iter::once(stem.clone()).chain(numbered).find(is_free);
        stems.extend(free);
    }
    stems.split_off(reserved.len())
}
