//! The files of a former run in a folder.

use super::outputs::REPORT;
use crate::error::{Error, Result};
use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// Removes the files that the report in `folder` lists, the report too, but no file of `inputs`. The pictures that a collection of a
/// motion names belong to it. Without a report, and where it lists no files, nothing is removed.
///
/// # Errors
/// A file cannot be removed.
pub(super) fn remove_former(folder: &Path, inputs: &[PathBuf]) -> Result<()> {
    let inputs: HashSet<PathBuf> = inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let Some(files) = listed(&folder.join(REPORT)) else { return Ok(()) };
    for file in &files {
        let pictures = pictures(folder, file);
        pictures.iter().chain([file]).try_for_each(|name| remove(&folder.join(name), &inputs))?;
        // The folder of the pictures stays if it has other files.
        if !pictures.is_empty() {
            _ = std::fs::remove_dir(folder.join(file.with_extension("")));
        }
    }
    Ok(())
}

/// The files that a report lists, the report last. Names that lead out of the folder are not those of a run.
fn listed(report: &Path) -> Option<Vec<PathBuf>> {
    let value: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(report).ok()?).ok()?;
    let names = value.get("files")?.as_array()?.iter().filter_map(|name| name.as_str().map(PathBuf::from));
    let is_own = |name: &PathBuf| is_within(name) && name.components().count() == 1 && *name != Path::new(REPORT);
    Some(names.filter(is_own).chain([REPORT.into()]).collect())
}

/// The pictures that a collection names, in the folder with its stem.
fn pictures(folder: &Path, collection: &Path) -> Vec<PathBuf> {
    if collection.extension() != Some(OsStr::new("pvd")) {
        return Vec::new();
    }
    let Ok(text) = std::fs::read_to_string(folder.join(collection)) else { return Vec::new() };
    let names = text.split(" file=\"").skip(1).filter_map(|rest| rest.split('"').next().map(PathBuf::from));
    let stem = collection.with_extension("");
    names.filter(|name| is_within(name) && name.parent() == Some(&stem)).collect()
}

fn is_within(name: &Path) -> bool {
    name.components().all(|part| matches!(part, Component::Normal(_)))
}

fn remove(path: &Path, inputs: &HashSet<PathBuf>) -> Result<()> {
    let is_input = path.canonicalize().is_ok_and(|path| inputs.contains(&path));
    if is_input || !path.is_file() {
        return Ok(());
    }
    std::fs::remove_file(path)
        .map_err(|e| Error::io("is of the former run in this folder, and cannot be removed", e).in_file(path))
}
