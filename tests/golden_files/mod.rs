//! Golden files: all that the program prints and writes for the scenes and studies of the book is what it was, at ten digits.
//!
//! `cases/AREA.toml` has the commands, `data/AREA/CASE/` what they print and write. [`mask`] has what is not compared, [`tolerance`] how far
//! numbers may be apart, and [`digest`] how long lists are kept. `SPRINGFIT_WRITE_GOLDEN=1 cargo test --release golden_files` writes all
//! files anew. `compare.sh` compares two commits to the bit: the other program is named by `SPRINGFIT_GOLDEN_PROGRAM`, its golden files by
//! `SPRINGFIT_GOLDEN_DATA`, and `SPRINGFIT_GOLDEN_EXACT` keeps and compares all numbers with all digits.

mod case;
mod compare;
mod digest;
mod form;
mod mask;
mod number;
mod store;
mod tolerance;

use case::{Case, cases, root};
use compare::{Comparison, compare};
use form::Form;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Differences of one file that are printed.
const SHOWN: usize = 4;

fn is_set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty())
}

/// Compares all outputs of the cases of an area with their golden files, or writes these.
fn check(area: &str) {
    let Some(data) = store::folder() else {
        println!("golden files of {area}: not run: the golden files are not part of a package");
        return;
    };
    let (mut files, mut numbers, mut wrong) = (0, 0, Vec::new());
    let is_exact = is_set("SPRINGFIT_GOLDEN_EXACT");
    let names: Vec<Case> = cases(area).into_iter().filter(|case| is_exact || case.exact_only.is_none()).collect();
    for case in &names {
        let folder = data.join(area).join(&case.name);
        let found = case.run();
        let mut expected = store::read(&folder);
        let mut forms = BTreeMap::new();
        for (name, bytes) in &found {
            match Form::of(name, bytes, is_exact) {
                Ok(form) => _ = forms.insert(name.clone(), form),
                Err(problem) => wrong.push(format!("{area}/{}/{problem}", case.name)),
            }
        }
        share(&mut forms);
        if is_set("SPRINGFIT_WRITE_GOLDEN") {
            write(&folder, &expected, &forms, is_exact);
            expected = store::read(&folder);
        }
        for name in expected.keys().chain(forms.keys().filter(|name| !expected.contains_key(*name))) {
            let place = format!("{area}/{}/{name}", case.name);
            match (expected.get(name), forms.get(name)) {
                (Some(expected), Some(found)) => {
                    let comparison = compare(name, expected, found, is_exact);
                    (files, numbers) = (files + 1, numbers + comparison.numbers);
                    wrong.extend(report(&place, &comparison));
                }
                (Some(_), None) => wrong.push(format!("{place}: is no longer written")),
                (None, _) => wrong.push(format!("{place}: has no golden file")),
            }
        }
    }
    println!("golden files of {area}: {} cases, {files} files, {numbers} numbers", names.len());
    let count = wrong.len();
    assert!(wrong.is_empty(), "{count} of {files} files of {area} differ\n{}", wrong.join("\n"));
    assert!(files > 0 && numbers > 0, "nothing of {area} was compared");
}

/// Networks of one run have the mesh, the supports and the loads in common: what is that of the first one is named and not written again.
fn share(forms: &mut BTreeMap<String, Form>) {
    let mut first: BTreeMap<String, (String, serde_json::Map<String, Value>)> = BTreeMap::new();
    for (name, form) in forms.iter_mut() {
        let Form::Tree(Value::Object(entries)) = form else { continue };
        if entries.get("format").and_then(Value::as_str) != Some("springfit network") {
            continue;
        }
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder).to_string();
        match first.get(&folder) {
            None => _ = first.insert(folder, (name.clone(), entries.clone())),
            Some((other, known)) => {
                let same =
                    entries.iter_mut().filter(|(key, value)| !value.is_null() && known.get(*key) == Some(&**value));
                same.filter(|(_, value)| value.is_array() || value.is_object())
                    .for_each(|(_, value)| *value = format!("that of {other}").into());
            }
        }
    }
}

/// Writes the files that differ from those that are there: digits beyond the tenth are left as they are.
fn write(folder: &Path, expected: &BTreeMap<String, Form>, found: &BTreeMap<String, Form>, is_exact: bool) {
    for (name, form) in found {
        let is_same = |known: &Form| compare(name, known, form, is_exact).differences.is_empty();
        if !expected.get(name).is_some_and(is_same) {
            store::remove(folder, name);
            store::write(folder, name, form, is_exact);
        }
    }
    expected.keys().filter(|name| !found.contains_key(*name)).for_each(|name| store::remove(folder, name));
}

/// The first differences of a file in words, and how many there are; `None` if there are none.
fn report(place: &str, comparison: &Comparison) -> Option<String> {
    let differences = &comparison.differences;
    if differences.is_empty() {
        return None;
    }
    let relative: Vec<f64> = differences.iter().filter_map(|difference| difference.relative).collect();
    let largest = relative.iter().copied().fold(0.0, f64::max);
    let mut lines = vec![format!(
        "{place}: {} differences; {} of {} numbers, by up to {largest:.1e} of the larger",
        differences.len(),
        relative.len(),
        comparison.numbers
    )];
    for difference in differences.iter().take(SHOWN) {
        lines.push(format!(
            "  {}\n    expected {}\n    found    {}",
            difference.place, difference.expected, difference.found
        ));
    }
    if differences.len() > SHOWN {
        lines.push(format!("  and {} more", differences.len() - SHOWN));
    }
    Some(lines.join("\n"))
}

const AREAS: [&str; 10] =
    ["solids", "planes", "whole", "paper", "studies", "fits", "tutorials", "exports", "texts", "refused_options"];

/// Files of the scenes that are no scenes.
const NO_SCENES: [&str; 1] = ["scenes/paper/index.toml"];

#[test]
fn every_scene_is_run_and_no_golden_file_is_without_a_case() {
    let commands: Vec<String> = AREAS.iter().flat_map(|area| cases(area)).flat_map(|case| case.commands).collect();
    for folder in ["scenes", "scenes/converge", "scenes/paper"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let name = format!("{folder}/{}", entry.unwrap().file_name().to_str().expect("names are text"));
            let is_run = |command: &String| command.contains(&format!("springfit run {name}"));
            let is_scene = name.ends_with(".toml") && !NO_SCENES.contains(&name.as_str());
            assert!(!is_scene || commands.iter().any(is_run), "no case runs {name}");
        }
    }
    let Some(data) = store::folder() else { return };
    for area in std::fs::read_dir(&data).unwrap() {
        let area = area.unwrap().file_name().to_str().expect("names are text").to_string();
        assert!(AREAS.contains(&area.as_str()), "{area} is no area");
        let names: Vec<String> = cases(&area).into_iter().map(|case| case.name).collect();
        for case in std::fs::read_dir(data.join(&area)).unwrap() {
            let case = case.unwrap().file_name().to_str().expect("names are text").to_string();
            assert!(names.contains(&case), "{area}/{case} is no case: remove its golden files");
        }
    }
}

#[test]
fn scenes_of_solids() {
    check("solids");
}

#[test]
fn scenes_in_the_plane_and_motions() {
    check("planes");
}

#[test]
fn whole_object_fits() {
    check("whole");
}

#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn scenes_of_the_paper() {
    check("paper");
}

#[test]
fn studies_of_many_runs() {
    check("studies");
}

#[test]
fn fits_without_a_scene() {
    check("fits");
}

#[test]
fn commands_of_the_tutorials() {
    check("tutorials");
}

#[test]
fn exports_and_figures() {
    check("exports");
}

#[test]
fn lists_schemas_code_and_help() {
    check("texts");
}

#[test]
fn refusals_of_options_and_files() {
    check("refused_options");
}
