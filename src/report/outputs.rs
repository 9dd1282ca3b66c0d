//! The files that a command writes, known before its work.

use super::former::former_names;
use super::pictures::check_arrays;
use crate::error::Result;
use crate::file::Edition;
use crate::study::{BODY, NamedFit, Scene};
use std::path::{Path, PathBuf};

/// The table of the points, if all networks of a run have the same masses.
pub(super) const POINTS: &str = "points.csv";
/// The report.
pub(super) const REPORT: &str = "report.json";
/// The report as a page.
pub(super) const PAGE: &str = "report.html";

/// Opens `folder`, which need not exist yet, for these files, before the work whose results they have.
///
/// # Errors
/// Those of [`Edition::begin`].
pub fn open_outputs(folder: &Path, names: &[&str], inputs: &[PathBuf]) -> Result<Edition> {
    Edition::begin(folder, names, inputs, &former_names(folder))
}

/// The same for all that a run of the scene writes.
///
/// # Errors
/// As there; or two arrays of a file for ParaView would have the same name.
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
    let is_written = |name: &String| match name.rsplit_once('.') {
        _ if stems.motions.iter().any(|stem| *name == format!("{stem}.csv")) => true,
        _ if stems.points.iter().any(|stem| *name == format!("{stem}.csv")) => {
            output.csv && scene.fits().iter().any(has_masses)
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

    /// The names of all files that a run can write, but for the pictures of motions.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let with = |stems: &[String], endings: &'static [&'static str]| {
            let stems = stems.to_vec();
            stems.into_iter().flat_map(|stem| endings.iter().map(move |ending| format!("{stem}.{ending}")))
        };
        with(&self.fits, &["csv", "json", "vtu"])
            .chain(with(&self.motions, &["csv", "pvd"]))
            .chain(with(&self.points, &["csv"]))
            .chain(["mesh.vtu", POINTS, REPORT, PAGE].map(String::from))
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
