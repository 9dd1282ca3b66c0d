//! Files of others in the folder of a command stay as they are.

use super::{files, said, scenes, springfit};
use crate::shapes::Random;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Folders that are tried, and those of the long test.
const FOLDERS: usize = 250;
const MANY_FOLDERS: usize = 2000;
/// What others may have written.
const CONTENTS: [&str; 6] = [
    "of the user",
    "{\"tool\":\"lint\",\"version\":2,\"files\":[\"main.c\",\"offdiag.csv\",\"mine.txt\"]}",
    "{\"settings\": 1}",
    "i,j,k\n0,1,2\n",
    "process of something else",
    "\0\0\u{1}",
];

/// A file, a link or a folder of another program.
fn put(path: &Path, draw: &mut Random) {
    if path.symlink_metadata().is_ok() || path.ancestors().skip(1).any(|above| above.is_symlink() || above.is_file()) {
        return;
    }
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    match draw.below(8) {
        0 => std::os::unix::fs::symlink("../kept.txt", path).unwrap(),
        1 => std::os::unix::fs::symlink("nowhere", path).unwrap(),
        2 => {
            fs::create_dir(path).unwrap();
            fs::write(path.join("inside.txt"), "of the user").unwrap();
        }
        _ => fs::write(path, CONTENTS[draw.below(CONTENTS.len())]).unwrap(),
    }
}

/// Of every name that a command writes, and of others: nothing of others changes, whether the command ends well or not.
#[test]
fn files_of_others_stay() {
    files_of_others_stay_in(FOLDERS, 7);
}

#[test]
#[ignore = "takes a minute; .ci/long has it"]
fn files_of_others_stay_in_many_folders() {
    files_of_others_stay_in(MANY_FOLDERS, 8);
}

fn files_of_others_stay_in(count: usize, seed: u64) {
    let folder = scenes();
    let folder = folder.path();
    let commands = [
        "run run-new.toml --out out",
        "sweep swept-new.toml --out out",
        "converge swept-new.toml --levels 2 --out out",
        "export run-new.toml --to npz --out out",
        "export run-new.toml --to vtu --out out",
        "compare tri3 --shapes 2 --fit objective='offdiag' --out out",
    ];
    let out = folder.join("out");
    let names: Vec<Vec<String>> = commands
        .iter()
        .map(|command| {
            _ = fs::remove_dir_all(&out);
            assert!(springfit(folder, command).output().unwrap().status.success(), "{command}");
            let hidden = [".springfit.lock", ".springfit.next", ".springfit.files"].map(String::from);
            files(&out).into_keys().chain(hidden).filter(|name| name != ".springfit.files").collect()
        })
        .collect();
    fs::write(folder.join("kept.txt"), "beyond a link").unwrap();
    let (mut draw, mut refused, mut done) = (Random(seed), 0, 0);
    for number in 0..count {
        let which = number % commands.len();
        _ = fs::remove_dir_all(&out);
        fs::create_dir(&out).unwrap();
        // A former run, which is replaced, or none.
        if number % 3 == 0 {
            springfit(folder, commands[which]).output().unwrap();
        }
        let own = files(&out);
        for _ in 0..=draw.below(3) {
            let name = match draw.below(4) {
                0 => ["main.c", "Makefile", "mine.txt", "notes/today.txt"][draw.below(4)].to_string(),
                _ => names[which][draw.below(names[which].len())].clone(),
            };
            put(&out.join(name), &mut draw);
        }
        let before: BTreeMap<String, Vec<u8>> =
            files(&out).into_iter().filter(|(name, _)| !own.contains_key(name)).collect();
        let output = springfit(folder, commands[which]).output().unwrap();
        let told = format!("folder {number}, {}: {}", commands[which], said(&output));
        let after = files(&out);
        for (name, bytes) in &before {
            assert_eq!(after.get(name), Some(bytes), "{told}: {name}");
        }
        assert_eq!(fs::read(folder.join("kept.txt")).unwrap(), b"beyond a link", "{told}");
        match output.status.code() {
            Some(0) => done += 1,
            Some(2) => {
                refused += 1;
                assert!(said(&output).contains("out/"), "{told}");
                // The former run is there, too.
                assert!(own.iter().all(|(name, bytes)| after.get(name) == Some(bytes)), "{told}");
            }
            code => panic!("{told}: {code:?}"),
        }
    }
    assert!(refused > 3 * count / 10 && done > count / 20, "{refused} refused, {done} done");
}

/// A name that reads as a path of the former run elsewhere is a name.
#[test]
fn a_backslash_is_part_of_a_name() {
    let folder = scenes();
    let folder = folder.path();
    let run = || springfit(folder, "run run-new.toml --out out").output().unwrap();
    assert!(run().status.success());
    let mine = folder.join("out/motion-offdiag\\0000.vtu");
    fs::write(&mine, "of the user").unwrap();
    assert!(folder.join("out/motion-offdiag/0000.vtu").exists() && run().status.success());
    assert_eq!(fs::read_to_string(&mine).unwrap(), "of the user");
}

/// A file of a run that a user has changed since is the user's.
#[test]
fn what_was_changed_since_is_not_replaced() {
    let folder = scenes();
    let folder = folder.path();
    let run = || springfit(folder, "run run-new.toml --out out").output().unwrap();
    assert!(run().status.success() && run().status.success());
    let table = folder.join("out/offdiag.csv");
    let changed = fs::read_to_string(&table).unwrap() + "my,own,line\n";
    fs::write(&table, &changed).unwrap();
    let output = run();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said(&output).contains("out/offdiag.csv: would be replaced, and was changed since it was written"),
        "{}",
        said(&output)
    );
    assert_eq!(fs::read_to_string(&table).unwrap(), changed);
    // One that the next run does not write stays, too.
    let without = "run run-new.toml --out out --set output.csv=false";
    assert!(springfit(folder, without).output().unwrap().status.success());
    assert_eq!(fs::read_to_string(&table).unwrap(), changed);
    assert!(!folder.join("out/points.csv").exists());
}

/// An output that is an input, also one that no key names.
#[test]
fn no_input_is_replaced() {
    let folder = scenes();
    let folder = folder.path();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("m.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    write("m.ele", "1 4 0\n1 1 2 3 4\n");
    std::os::unix::fs::symlink("m.ele", folder.join("x.csv")).unwrap();
    let output = springfit(folder, "fit m.node --young 1e4 --poisson 0.3 -o x.csv").output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("x.csv: would replace m.ele, which is an input"), "{}", said(&output));
    assert_eq!(fs::read_to_string(folder.join("m.ele")).unwrap(), "1 4 0\n1 1 2 3 4\n");
}

/// The figures of a sweep are of the files that are read, named or not.
#[test]
fn a_sweep_does_not_go_on_from_other_inputs() {
    let folder = scenes();
    let folder = folder.path();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("m.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n");
    write("m.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n");
    write(
        "s.toml",
        "mesh = { file = \"m.node\" }\nmaterial = { young = 1e4, poisson = 0.3 }\nfit = [{ objective = \"offdiag\" }]\n\
         fix = [{ where = \"z<1e-9\" }]\nload = [{ body = [0, 0, 1] }]\nsweep.over = { material.poisson = [0.1, 0.2] }\n",
    );
    let sweep = |more: &str| springfit(folder, &format!("sweep s.toml --out out{more}")).output().unwrap();
    assert!(sweep("").status.success() && sweep(" --resume").status.success());
    for (name, text) in [("m.ele", "1 4 0\n1 1 2 3 4\n"), ("m.face", "1 1\n1 1 2 3 5\n")] {
        let before = fs::read(folder.join(name)).ok();
        write(name, text);
        let output = sweep(" --resume");
        assert_eq!(output.status.code(), Some(2), "{name}: {}", said(&output));
        let words =
            format!("of this file and those that it names, found one with another {name}: choose another folder");
        assert!(said(&output).contains(&words), "{}", said(&output));
        match before {
            Some(bytes) => fs::write(folder.join(name), bytes).unwrap(),
            None => fs::remove_file(folder.join(name)).unwrap(),
        }
        assert!(sweep(" --resume").status.success());
    }
    let output = sweep(" --resume --set material.young=2e4");
    assert!(said(&output).contains("found one with another --set: choose"), "{}", said(&output));
    let text = fs::read_to_string(folder.join("s.toml")).unwrap();
    write("s.toml", &text.replace("1e4", "3e4"));
    assert!(
        said(&sweep(" --resume")).contains("found one with another scene: choose"),
        "{}",
        said(&sweep(" --resume"))
    );
    // More values of the sweep are another sweep of the same studies, also from another folder.
    write("s.toml", &text.replace("0.2]", "0.2, 0.3]"));
    let more = springfit(Path::new("/"), &format!("sweep {0}/s.toml --out {0}/out --resume", folder.display()))
        .output()
        .unwrap();
    assert!(more.status.success(), "{}", said(&more));
}
