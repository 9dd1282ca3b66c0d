//! The files of a run by a program that left no list of them.

use super::figure::RunFolder;
use super::names::{REPORT, Stems};
use std::path::Path;

/// The names of the files that the report in `folder` lists and that a run of its fits can have written. None without a report.
pub(super) fn former_names(folder: &Path) -> Vec<String> {
    let place = RunFolder::at(folder);
    if !place.file(REPORT).is_file() {
        return Vec::new();
    }
    // What is not a report of this program has none of its files.
    let Ok(report) = place.report() else { return Vec::new() };
    let moved = report.motion.iter().map(|motion| motion.name.as_str());
    let stems = Stems::of(report.fits.iter().map(|fit| fit.name.as_str()), moved);
    let mut names: Vec<String> = stems.names().filter(|name| report.files.contains(name)).collect();
    let moved = stems.motions.iter().filter(|stem| names.contains(&format!("{stem}.pvd")));
    let pictures: Vec<String> = moved.flat_map(|stem| pictures(&place, stem)).collect();
    names.extend(pictures);
    names
}

/// The pictures that the collection of a motion names, in the folder of its stem.
fn pictures(folder: &RunFolder, stem: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.file(&format!("{stem}.pvd"))).unwrap_or_default();
    let named = text.split(" file=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let is_picture = |name: &&str| {
        let number =
            name.strip_prefix(stem).and_then(|rest| rest.strip_prefix('/')).and_then(|rest| rest.strip_suffix(".vtu"));
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
    };
    named.filter(is_picture).map(String::from).collect()
}
