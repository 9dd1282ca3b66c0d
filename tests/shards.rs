//! Cells that are fitted in ranges: the merged network is that of one fit, byte by byte, and wrong sets of shards are refused.

use crate::kit::{said, springfit};
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

fn mesh(name: &str) -> String {
    format!("{}/scenes/meshes/{name}", env!("CARGO_MANIFEST_DIR"))
}

const MATERIAL: [&str; 6] = ["--scale", "0.01", "--young", "10kPa", "--poisson", "0.3"];

/// Fits shard `number` of `count` into `name`.
fn fit(folder: &Path, mesh: &str, options: &[&str], (number, count): (usize, usize), name: &str) -> Output {
    let shard = format!("{number}/{count}");
    let own: Vec<&str> = ["fit", mesh].into_iter().chain(MATERIAL).chain(options.iter().copied()).collect();
    springfit(folder, &[&own[..], &["--shard", &shard, "-o", name]].concat())
}

fn error(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    said(output)
}

#[test]
fn merged_shards_are_the_network_of_one_fit() {
    let folder = TempDir::new().unwrap();
    // With free rest measures springs pull, and with springs on contents cells have springs of their own.
    let cases: [(&str, &[&str]); 6] = [
        ("cube_tet.msh", &[]),
        ("cube_tet.msh", &["--objective", "frobenius", "--springs", "edge,bulk", "--rest", "free"]),
        ("cube_tet.msh", &["--objective", "frobenius", "--springs", "edge,bulk", "--rest", "zero"]),
        ("cube_tet.msh", &["--objective", "divergence", "--nonnegative"]),
        ("cube_tet.msh", &["--objective", "van-gelder"]),
        ("cube_tet.msh", &["--volume", "cells"]),
    ];
    for (name, options) in cases {
        let mesh = mesh(name);
        let whole: Vec<&str> = ["fit", &mesh].into_iter().chain(MATERIAL).chain(options.iter().copied()).collect();
        let whole = springfit(folder.path(), &[&whole[..], &["-o", "whole.csv"]].concat());
        assert!(whole.status.success(), "{}", said(&whole));
        for count in [1, 2, 7] {
            let names: Vec<String> = (1..=count).map(|number| format!("{number}.shard")).collect();
            for (i, name) in names.iter().enumerate() {
                let made = fit(folder.path(), &mesh, options, (i + 1, count), name);
                assert!(made.status.success(), "{}", said(&made));
            }
            // In any order.
            let given: Vec<&str> = names.iter().rev().map(String::as_str).collect();
            let merged = springfit(folder.path(), &[&["merge"], &given[..], &["-o", "merged.csv"]].concat());
            assert!(merged.status.success(), "{}", said(&merged));
            let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
            assert!(read("merged.csv") == read("whole.csv"), "{options:?} in {count} shards");
        }
    }
}

#[test]
fn wrong_sets_of_shards_are_refused() {
    let folder = TempDir::new().unwrap();
    let cube = mesh("cube_tet.msh");
    for (number, options, name) in [
        (1, &[][..], "1.shard"),
        (2, &[], "2.shard"),
        (3, &[], "3.shard"),
        (2, &["--objective", "offdiag"], "offdiag.shard"),
        (2, &["--least", "1e-9", "--density", "1000"], "same.shard"),
    ] {
        assert!(fit(folder.path(), &cube, options, (number, 3), name).status.success());
    }
    assert!(fit(folder.path(), &cube, &[], (2, 4), "quarter.shard").status.success());
    let bytes = fs::read(folder.path().join("2.shard")).unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("short.shard", &bytes[..bytes.len() - 1]);
    write("empty.shard", b"");
    write("other.shard", b"kind,points\n");
    // The first record follows the first line.
    let line = bytes.iter().position(|byte| *byte == b'\n').unwrap();
    let mut damaged = bytes.clone();
    damaged[line + 1 + 7] = 0xff;
    write("damaged.shard", &damaged);
    let merge = |names: &[&str]| springfit(folder.path(), &[&["merge"], names, &["-o", "out.csv"]].concat());
    for place in (0..bytes.len()).step_by(bytes.len() / 40) {
        let mut flipped = bytes.clone();
        flipped[place] ^= 1 << (place % 8);
        write("flipped.shard", &flipped);
        assert_eq!(merge(&["1.shard", "flipped.shard", "3.shard"]).status.code(), Some(2), "byte {place}");
    }
    for (names, words) in [
        (&["1.shard", "3.shard"][..], "expected all 3 shards, found none of number 2"),
        (&["1.shard"], "none of number 2"),
        (&["1.shard", "2.shard", "3.shard", "1.shard"], "is shard 1 of 3, as is 1.shard"),
        (&["1.shard", "offdiag.shard", "3.shard"], "another fit or material"),
        (&["1.shard", "quarter.shard", "3.shard"], "one of 4 shards"),
        (&["1.shard", "short.shard", "3.shard"], "short.shard: expected a shard of version 3"),
        (&["empty.shard"], "empty.shard: expected a shard"),
        (&["other.shard"], "other.shard: expected a shard"),
        (&["1.shard", "damaged.shard", "3.shard"], "its checksum is not that of its contents"),
        (&["nowhere.shard"], "nowhere.shard"),
    ] {
        let found = error(&merge(names));
        assert!(found.contains(words), "{names:?}: {found}");
        assert!(!folder.path().join("out.csv").exists(), "{names:?}");
    }
    assert!(merge(&["1.shard", "same.shard", "3.shard"]).status.success());
}

#[test]
fn wrong_options_of_shards_are_refused() {
    let folder = TempDir::new().unwrap();
    let cube = mesh("cube_tet.msh");
    for (options, shard, name, words) in [
        (&[][..], (4, 3), "a.shard", "--shard"),
        (&[], (1, 413), "a.shard", "at most 412 shards"),
        (&[], (1, 2), "a.csv", ".shard"),
        (&["--volume", "patches"], (1, 2), "a.shard", "--objective"),
        (&["--nonnegative"], (1, 2), "a.shard", "--objective"),
        (&["--objective", "whole", "--fix", "fixed"], (1, 2), "a.shard", "--objective"),
    ] {
        let found = error(&fit(folder.path(), &cube, options, shard, name));
        assert!(found.contains(words), "{options:?} {name}: {found}");
        assert!(!folder.path().join(name).exists());
    }
    let merged = springfit(folder.path(), &["merge", "a.shard", "-o", "out.json"]);
    assert!(error(&merged).contains("a file ending in .csv"));
}
