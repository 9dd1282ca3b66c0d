//! The numbers of the command line.

use super::verdict::not_finite;
use crate::kit::files;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// What the options go with: runs that succeed without them, so that each numeric option is taken by one of them at least.
const RUNS: [&[&str]; 29] = [
    &["fit", "mesh.msh", "--young=1e4", "--poisson=0.3", "-o", "springs.json"],
    &["fit", "mesh.msh", "--young=1e4", "--poisson=0.3", "-o", "springs.csv", "--objective", "modal", "--density=1000"],
    &["fit", "mesh.msh", "--young=1e4", "--poisson=0.3", "-o", "springs.csv", "--objective", "divergence"],
    &[
        "fit",
        "mesh.msh",
        "--young=1e4",
        "--poisson=0.3",
        "-o",
        "s.csv",
        "--objective",
        "sampled",
        "--law",
        "neo-hookean",
        "--shapes=20",
    ],
    &[
        "fit",
        "mesh.msh",
        "--young=1e4",
        "--poisson=0.3",
        "-o",
        "springs.csv",
        "--objective",
        "spectral",
        "--springs=edge",
    ],
    &["fit", "plate.msh", "--young=1e4", "--poisson=0.3", "-o", "springs.vtu", "--objective", "offdiag"],
    &["fit", "rods.msh", "--young=1e4", "--poisson=0.3", "-o", "springs.json", "--objective", "frobenius"],
    &["compare", "tri3", "--shapes=1", "--iterations=5", "--fit=objective='offdiag'"],
    &["converge", "scene.toml", "--levels=2"],
    &["measure", "--lattice", "cubic", "--constants=100,50"],
    &["measure", "--lattice", "cubic", "--constants=100,50", "--cells=2", "--hull"],
    &["measure", "--lattice", "triangular", "--constants=100"],
    &["measure", "triangle.csv", "--points=corners.csv", "--volume=0.45"],
    &["matrix", "bar.mtx", "--points=ends.csv", "--output=springs.json"],
    &["run", "scene.toml"],
    &["sweep", "scene.toml", "--set=sweep.over={material.poisson=[0.1,0.2]}"],
    &["derive", "bar2"],
    &["check", "tri3"],
    &["generate", "quad4", "--objective", "modal"],
    &["new", "mesh.msh"],
    &["new", "plate.msh"],
    &["groups", "mesh.msh"],
    &["groups", "plate.msh"],
    &["groups", "octahedron.off", "--fill=0.2"],
    &["new", "octahedron.off", "--fill=0.2"],
    &["fit", "octahedron.off", "--fill=0.2", "--young=10kPa", "--poisson=0.3", "--output=springs.json"],
    &["groups", "octahedron.off", "--points=90", "--repair"],
    &["new", "octahedron.off", "--points=90"],
    &["fit", "octahedron.off", "--points=90", "--young=10kPa", "--poisson=0.3", "--output=springs.json"],
];

const EXTREMES: [&str; 12] =
    ["0", "-1", "1e-308", "1e-160", "1e160", "1e308", "nan", "inf", "1e-30", "1e30", "5e-324", "1e-31"];

const FILES: [(&str, &str); 9] = [
    ("triangle.csv", "a,b,k\n0,1,10\n1,2,10\n2,0,10\n"),
    ("corners.csv", "x,y\n0,0\n1,0\n0.5,0.9\n"),
    ("bar.mtx", "%%MatrixMarket matrix coordinate real symmetric\n6 6 3\n1 1 200\n4 1 -200\n4 4 200\n"),
    ("ends.csv", "x,y,z\n0,0,0\n1,0,0\n"),
    (
        "mesh.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n\
         1 4 2 0 1 1 2 3 4\n$EndElements\n",
    ),
    (
        "plate.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n\
         1 2 2 0 1 1 2 3\n$EndElements\n",
    ),
    super::samples::FILES[0],
    super::samples::FILES[2],
    (
        "scene.toml",
        "mesh = { box = { element = \"tri3\", size = [1, 1], cells = [1, 1] } }\nmaterial = { young = 1e4, poisson = 0.3 }\n\
         fit = [{ objective = \"frobenius\" }]\nfix = [{ group = \"ymin\" }]\nload = [{ group = \"ymax\", traction = [0, 1] }]\n",
    ),
];

fn springfit(arguments: &[String]) -> (Output, TempDir) {
    let folder = TempDir::new().unwrap();
    FILES.iter().for_each(|(name, content)| std::fs::write(folder.path().join(name), content).unwrap());
    let output = Command::new(env!("CARGO_BIN_EXE_springfit")).args(arguments).current_dir(folder.path()).output();
    (output.unwrap(), folder)
}

/// The run with this option, whatever it had of it.
fn with(run: &[&str], option: &str, value: &str) -> Vec<String> {
    let own = format!("{option}=");
    let kept = run.iter().filter(|argument| !argument.starts_with(&own)).map(|argument| argument.to_string());
    kept.chain([format!("{option}={value}")]).collect()
}

/// The options of a command that take a value, as its help lists them.
fn options(command: &str) -> Vec<String> {
    let (output, _) = springfit(&[command.into(), "--help".into()]);
    let help = String::from_utf8(output.stdout).unwrap();
    let option = |line: &str| {
        let (name, rest) = line.trim_start().trim_start_matches("-o, ").split_once(' ')?;
        (name.starts_with("--") && rest.trim_start().starts_with('<')).then(|| name.to_string())
    };
    help.lines().filter_map(option).collect()
}

/// Whether the option takes a number: a word is refused as none.
fn is_numeric(run: &[&str], option: &str) -> bool {
    let (output, _) = springfit(&with(run, option, "word"));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    ["invalid float", "invalid digit", "(units: "].iter().any(|words| said.contains(words))
}

#[test]
fn every_number_of_the_command_line_may_be_extreme() {
    try_numbers(3);
}

#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn every_number_of_every_run_may_be_extreme() {
    try_numbers(1);
}

/// Gives every extreme to each option in the first run that takes it. Each further run gives it every `share`-th extreme, from another start.
fn try_numbers(share: usize) {
    let (mut numeric, mut taken, mut wrong, mut cases) = (BTreeSet::new(), BTreeSet::new(), Vec::new(), 0);
    let mut runs = BTreeMap::<String, usize>::new();
    // Whether an option takes a number is asked of one run of each command: they have the same parser.
    let mut commands = BTreeMap::<&str, Vec<String>>::new();
    for run in RUNS {
        let ask = || options(run[0]).into_iter().filter(|option| is_numeric(run, option)).collect();
        let of_command = commands.entry(run[0]).or_insert_with(ask).clone();
        let arguments: Vec<String> = run.iter().map(|argument| argument.to_string()).collect();
        assert_eq!(springfit(&arguments).0.status.code(), Some(0), "{run:?}");
        for option in of_command {
            let name = format!("{} {option}", run[0]);
            numeric.insert(name.clone());
            if !["0.5", "2", "1e-9", "90"].iter().any(|value| springfit(&with(run, &option, value)).0.status.success())
            {
                continue;
            }
            let before = *runs.entry(name.clone()).and_modify(|before| *before += 1).or_insert(0);
            let (first, step) = if before == 0 { (0, 1) } else { (before % share, share) };
            taken.insert(name);
            for value in EXTREMES.into_iter().skip(first).step_by(step) {
                cases += 1;
                let (output, folder) = springfit(&with(run, &option, value));
                if let Err(problem) = verdict(&output, folder.path(), &option) {
                    wrong.push(format!("{run:?} {option}={value}: {problem}"));
                }
            }
        }
    }
    println!("{cases} cases of {numeric:?}");
    // Every command is looked at, those whose options are no numbers by their help alone.
    let (output, _) = springfit(&["--help".into()]);
    let help = String::from_utf8(output.stdout).unwrap();
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    for command in listed.filter_map(|line| line.split_whitespace().next()).filter(|command| *command != "help") {
        // An option that is unknown keeps the command from running.
        let is_number = |option: &String| {
            let (output, _) = springfit(&[command.into(), format!("{option}=word"), "--zzz".into()]);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            said.contains("invalid value") && !said.contains("possible values")
        };
        // The referee needs a simulator: the range of its Poisson's ratio is tested with it.
        let is_run = commands.contains_key(command) || command == "referee";
        let unseen = !is_run && options(command).iter().any(is_number);
        assert!(!unseen, "{command} has numeric options and no run");
    }
    // The study of stretches takes minutes; its range is that of every number, 0 to 2.
    let missing: Vec<_> = numeric.difference(&taken).filter(|name| *name != "compare --stretch").collect();
    assert!(numeric.len() > 12 && missing.is_empty(), "no run takes {missing:?} of {numeric:?}");
    assert!(wrong.is_empty(), "{} of {cases} cases:\n{}", wrong.len(), wrong.join("\n"));
}

/// One line that names the option and nothing written, or files of finite numbers alone.
fn verdict(output: &Output, folder: &Path, option: &str) -> Result<(), String> {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    match output.status.code() {
        Some(0) => {
            let mut texts = vec![String::from_utf8_lossy(&output.stdout).into_owned()];
            texts.extend(written(folder));
            match texts.iter().find_map(|text| not_finite(text)) {
                Some(word) => Err(format!("not finite: {word} in {texts:?}")),
                None => Ok(()),
            }
        }
        Some(2) => {
            let first = said.lines().next().unwrap_or_default();
            // A value of another kind is refused by the command line's parser, in a paragraph.
            let named = said.lines().count() == 1 || first.contains("invalid value");
            let left = written(folder).len();
            // An option may be about the mesh, whose cells are named then.
            let is_mesh = [".msh: ", ".off: "].iter().any(|file| first.contains(file));
            let of_mesh = ["--scale", "--least"].contains(&option) && is_mesh;
            match first.contains(option) || of_mesh {
                true if named && left == 0 => Ok(()),
                _ => Err(format!("{left} files written, and: {said}")),
            }
        }
        code => Err(format!("code {code:?}: {said}")),
    }
}

/// The texts of the files that were written.
fn written(folder: &Path) -> Vec<String> {
    let is_given = |path: &PathBuf| FILES.iter().any(|(name, _)| path.ends_with(name));
    let of_text = |path: &PathBuf| !is_given(path) && path.extension().is_none_or(|e| e != "svg");
    files(folder).iter().filter(|path| of_text(path)).filter_map(|path| std::fs::read_to_string(path).ok()).collect()
}
