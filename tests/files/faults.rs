//! A kill, an error of the disk and a full disk at every operation on files.

use super::{copy, files, results, said, scenes, springfit};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// What comes between.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    Kill,
    /// One operation fails.
    Once,
    /// There is no more room from then on.
    Full,
}

const FAULTS: [Fault; 3] = [Fault::Kill, Fault::Once, Fault::Full];

/// Which operations have a fault.
#[derive(Clone, Copy, PartialEq)]
enum At {
    /// A kill is at each operation. Operations of odd numbers fail once; from those of even numbers on the disk is full.
    Turns,
    /// Each fault is at each operation.
    Each,
}

impl At {
    /// The numbers of operations, from 1.
    fn numbers(self, fault: Fault) -> impl Iterator<Item = usize> {
        let (first, step) = match fault {
            Fault::Once if self == At::Turns => (1, 2),
            Fault::Full if self == At::Turns => (2, 2),
            _ => (1, 1),
        };
        (first..).step_by(step)
    }
}

/// Compiles the library that makes operations fail.
fn library(folder: &Path) -> PathBuf {
    let (source, library) =
        (Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/faults.c"), folder.join("faults.so"));
    let compiled =
        Command::new("cc").args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(source).arg("-ldl").output();
    let compiled = compiled.unwrap();
    assert!(compiled.status.success(), "{}", said(&compiled));
    library
}

/// Runs the command with a fault at these of its operations in turn, from a folder `out` with the files `former`, and checks what it
/// leaves; returns how many operations there are at most.
fn at_each(
    folder: &Path,
    arguments: &str,
    (fault, at): (Fault, At),
    former: &BTreeMap<String, Vec<u8>>,
    check: &dyn Fn(&Output, &str),
) -> usize {
    let library = library(folder);
    let out = folder.join("out");
    for number in at.numbers(fault) {
        _ = fs::remove_dir_all(&out);
        copy(former, &out);
        let mut command = springfit(folder, arguments);
        command.env("LD_PRELOAD", &library).env("FAULT_AT", number.to_string());
        match fault {
            Fault::Kill => command.env("FAULT_KIND", "kill"),
            Fault::Once => command.env("FAULT_KIND", libc_error("EIO")),
            Fault::Full => command.env("FAULT_KIND", libc_error("ENOSPC")).env("FAULT_STAYS", "1"),
        };
        let output = command.output().unwrap();
        let told = format!("{arguments}, {fault:?} at operation {number}: {}", said(&output));
        if !said(&output).contains("fault") {
            assert!(output.status.success(), "{told}");
            return number - 1;
        }
        assert!(fault == Fault::Kill || matches!(output.status.code(), Some(0 | 2)), "{told}");
        check(&output, &told);
    }
    unreachable!()
}

/// The numbers are the same on all systems that the test runs on.
fn libc_error(name: &str) -> &'static str {
    if name == "EIO" { "5" } else { "28" }
}

/// Whether all files are those of one run: byte for byte the former one, or the new one.
fn whole(
    found: &BTreeMap<String, Vec<u8>>,
    former: &BTreeMap<String, Vec<u8>>,
    new: &BTreeMap<String, Vec<u8>>,
) -> bool {
    let is_new = |(name, bytes): (&String, &Vec<u8>)| match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        // They have times.
        "json" | "html" => former.get(name) != Some(bytes) && contains(bytes, b"\"new\""),
        _ => new.get(name) == Some(bytes),
    };
    found == former || found.keys().eq(new.keys()) && found.iter().all(is_new)
}

fn contains(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|part| part == word)
}

/// The files of a command, with the list of them, and those that users look for.
fn outputs(folder: &Path, arguments: &str) -> (BTreeMap<String, Vec<u8>>, BTreeMap<String, Vec<u8>>) {
    let out = folder.join("out");
    _ = fs::remove_dir_all(&out);
    let output = springfit(folder, arguments).output().unwrap();
    assert!(output.status.success(), "{arguments}: {}", said(&output));
    (files(&out), results(&out))
}

fn begun(folder: &Path) -> Vec<String> {
    let is_begun = |name: &String| name.starts_with(".springfit.") && !name.starts_with(".springfit.files");
    files(folder).into_keys().filter(|name| is_begun(name) || name.contains(".partial")).collect()
}

/// A command that writes a folder, whose files the next command of the same kind replaces.
fn replaced(command: &str, most: usize, at: At) {
    let folder = scenes();
    let folder = folder.path();
    let [old, new] = ["old", "new"].map(|title| command.replace("NAME", title));
    let (former, shown) = outputs(folder, &old);
    let (_, expected) = outputs(folder, &new);
    assert!(!whole(&expected, &shown, &shown), "the two runs differ");
    let out = folder.join("out");
    // With a file of the user the folder cannot be exchanged.
    for (alone, fault) in
        FAULTS.map(|fault| (true, fault)).into_iter().chain([(false, Fault::Kill), (false, Fault::Once)])
    {
        let mine = BTreeMap::from([("mine.txt".to_string(), b"of the user".to_vec())]);
        let mut start = former.clone();
        start.extend(mine.clone().into_iter().filter(|_| !alone));
        let check = |output: &Output, told: &str| {
            if !alone {
                // The next command that reads the folder goes on, whatever comes of it.
                springfit(folder, "plot out --table markdown").output().unwrap();
            }
            let mut found = results(&out);
            assert_eq!(found.remove("mine.txt").is_none(), alone, "{told}");
            assert!(whole(&found, &shown, &expected), "{told}: {:?}", found.keys());
            assert!(!output.status.success() || found != shown, "{told}: says that it is done");
            // A file whose removal fails is left to the next run.
            if fault == Fault::Full && alone {
                assert_eq!(begun(folder), [""; 0], "{told}");
            }
            if fault == Fault::Full {
                return;
            }
            let again = springfit(folder, &new).output().unwrap();
            assert!(again.status.success(), "{told}: and again: {}", said(&again));
            assert_eq!(begun(folder), [""; 0], "{told}, and again");
        };
        let count = at_each(folder, &new, (fault, at), &start, &check);
        assert!((10..most).contains(&count), "{command}: {count} operations");
    }
}

#[test]
fn a_run_is_the_former_or_the_new_one_after_any_fault() {
    replaced("run run-NAME.toml --out out", 400, At::Turns);
}

#[test]
#[ignore = "takes half a minute; .ci/long has it"]
fn a_run_is_the_former_or_the_new_one_after_each_fault_at_each_operation() {
    replaced("run run-NAME.toml --out out", 400, At::Each);
}

#[test]
fn an_export_is_the_former_or_the_new_one_after_any_fault() {
    replaced("export run-NAME.toml --to npz --out out", 200, At::Each);
}

/// A level is whole, table and plot; and a fault leaves the levels that are done.
#[test]
fn convergence_has_whole_levels_after_any_fault() {
    let folder = scenes();
    let folder = folder.path();
    let command = "converge swept-new.toml --levels 3 --out out";
    let (former, shown) = outputs(folder, &command.replace("new", "old"));
    let (_, expected) = outputs(folder, command);
    let out = folder.join("out");
    for fault in FAULTS {
        let check = |output: &Output, told: &str| {
            let found = results(&out);
            if found == shown {
                return;
            }
            let is_table = |name: &&String| name.ends_with(".csv");
            let table = String::from_utf8(found[found.keys().find(is_table).unwrap()].clone()).unwrap();
            let last = String::from_utf8(expected[expected.keys().find(is_table).unwrap()].clone()).unwrap();
            // Limits and rates come with more levels; the first columns of the rows are there.
            assert!(table.ends_with('\n') && table.lines().count() <= last.lines().count(), "{told}: {table}");
            assert!(found.keys().all(|name| expected.contains_key(name)), "{told}");
            let svg = found.get("plot.svg").or(found.get("convergence.svg")).map_or(&b"</svg>"[..], |bytes| bytes);
            assert!(contains(svg, b"</svg>"), "{told}");
            assert!(!output.status.success() || found == expected, "{told}");
        };
        let count = at_each(folder, command, (fault, At::Turns), &former, &check);
        assert!((10..400).contains(&count), "{count} operations");
    }
}

/// What a sweep leaves is gone on from, to the same table.
#[test]
fn a_sweep_goes_on_after_any_fault() {
    let folder = scenes();
    let folder = folder.path();
    let command = "sweep swept-new.toml --out out";
    let (_, expected) = outputs(folder, command);
    let out = folder.join("out");
    for fault in FAULTS {
        let check = |_: &Output, told: &str| {
            for (name, bytes) in results(&out) {
                let is_whole =
                    bytes.is_empty() || bytes.starts_with(b"study,") || bytes.starts_with(b"{\"settings\":{");
                assert!(is_whole || b"{\"settings\":{".starts_with(&bytes), "{told}: {name}");
            }
            let again = springfit(folder, &format!("{command} --resume")).output().unwrap();
            assert!(again.status.success(), "{told}: and again: {}", said(&again));
            assert_eq!(results(&out).get("table.csv"), expected.get("table.csv"), "{told}");
            assert_eq!(begun(folder), [""; 0], "{told}, and again");
        };
        let count = at_each(folder, command, (fault, At::Each), &BTreeMap::new(), &check);
        assert!((5..200).contains(&count), "{count} operations");
    }
}
