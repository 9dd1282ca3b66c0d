//! Two commands in one folder at once.

use super::{results, said, scenes, springfit};
use std::fs;
use std::process::{Command, Output, Stdio};

/// Pairs of runs.
const PAIRS: usize = 200;

fn ends(commands: [Command; 2]) -> [Output; 2] {
    let started = commands.map(|mut command| command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap());
    started.map(|program| program.wait_with_output().unwrap())
}

/// One writes, and the other says why it does not; or one comes after the other. All files are of one run.
#[test]
fn of_two_runs_in_one_folder_one_wins() {
    let folder = scenes();
    let folder = folder.path();
    let out = folder.join("out");
    let (mut refused, mut named) = (0, 0);
    for pair in 0..PAIRS {
        if pair % 2 == 0 {
            _ = fs::remove_dir_all(&out);
        }
        let titles = ["old", "new"];
        let outputs = ends(titles.map(|title| springfit(folder, &format!("run run-{title}.toml --out out --quiet"))));
        let mut won = Vec::new();
        for (title, output) in titles.iter().zip(&outputs) {
            if output.status.success() {
                won.push(title);
                continue;
            }
            refused += 1;
            let words = said(output);
            assert_eq!(output.status.code(), Some(2), "{words}");
            let is_named = words.contains("out/.springfit.lock: process ");
            named += usize::from(is_named);
            // One that has taken the lock just now has not written its name yet.
            assert!(is_named || words.contains("out/.springfit.lock: another process"), "{words}");
            assert!(words.contains("writes into this folder: wait for its end"), "{words}");
        }
        assert!(!won.is_empty(), "pair {pair}: {outputs:?}");
        let found = results(&out);
        let has = |name: &str, title: &str| String::from_utf8_lossy(&found[name]).contains(&format!("\"{title}\""));
        let of = titles.iter().filter(|title| ["report.json", "offdiag.json"].iter().all(|name| has(name, title)));
        assert_eq!(of.count(), 1, "pair {pair}");
    }
    assert!(
        refused > PAIRS / 10 && 2 * named > refused,
        "{refused} refused, {named} of them with the name of the other"
    );
}

/// The lock of a process that is gone is taken over.
#[test]
fn a_lock_without_a_process_does_not_stand_in_the_way() {
    let folder = scenes();
    let folder = folder.path();
    fs::create_dir(folder.join("out")).unwrap();
    fs::write(folder.join("out/.springfit.lock"), "process 1 (springfit run a.toml)\n").unwrap();
    let output = springfit(folder, "run run-new.toml --out out").output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert!(!folder.join("out/.springfit.lock").exists());
}
