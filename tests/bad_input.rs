//! Every fault of an input ends with exit code 2 and one line that names it; nothing is printed or written besides.

use std::fs::{self, File};
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const BRICK: &str = r#"[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
[[fit]]
objective = "modal"
[[fix]]
group = "zmin"
[[load]]
group = "zmax"
traction = [0, 0, 1]
"#;

const PLATE: &str = r#"[mesh]
box = { element = "tri3", size = [1, 1], cells = [1, 1] }
[material]
young = 10e3
poisson = 0.3
plane = "strain"
thickness = 0.1
[[fit]]
objective = "frobenius"
[[fix]]
group = "ymin"
[[load]]
group = "ymax"
traction = [0, 1]
"#;

/// At large deformation, fitted to sampled forces.
const SOFT: &str = r#"[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
law = "neo-hookean"
[[fit]]
objective = "sampled"
force = "k*(exp(a*s) - 1)"
bounds = { a = [0, 10] }
starts = 2
shapes = { families = ["uniaxial"], count = 30, held_out = 10, stretch = 0.2 }
[newton]
steps = 2
[[fix]]
group = "zmin"
[[load]]
name = "pull"
group = "zmax"
traction = [0, 0, 1]
"#;

/// Reads `mesh.msh` and looks in `own.toml` first.
const FROM_FILES: &str = r#"[mesh]
file = "mesh.msh"
elements = ["own.toml"]
[material]
young = 10e3
poisson = 0.3
[[fit]]
objective = "frobenius"
[[fix]]
where = "z == 0"
[[load]]
where = "z > 0.5"
force = [0, 0, 1]
"#;

const TETRAHEDRON: &str = include_str!("../elements/tet4.toml");
const UNIT_NODES: [&str; 4] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
const CUBE_NODES: [&str; 8] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"];

/// The scene or element with one text changed, and the message.
type Edit<'a> = (&'a str, &'a str, &'a str);

fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from:?} in {text}");
    text.replace(from, to)
}

/// An MSH 2.2 file; a cell is its type, tags and nodes.
fn msh(nodes: &[&str], cells: &[&str]) -> String {
    let numbered = |lines: &[&str]| {
        let lines: String = lines.iter().enumerate().map(|(i, line)| format!("{} {line}\n", i + 1)).collect();
        format!("{}\n{lines}", lines.matches('\n').count())
    };
    let (nodes, cells) = (numbered(nodes), numbered(cells));
    format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n{cells}$EndElements\n")
}

fn unit_mesh() -> String {
    msh(&UNIT_NODES, &["4 2 0 1 1 2 3 4"])
}

/// What a run left behind.
struct Seen {
    code: Option<i32>,
    stdout: String,
    stderr: String,
    changed: bool,
}

/// Runs the program in a folder with these files; one that ends in `/` is a folder.
fn run(files: &[(&str, &[u8])], arguments: &[&str]) -> Seen {
    let (folder, streams) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    for (name, content) in files {
        let path = folder.path().join(name);
        if name.ends_with('/') {
            fs::create_dir(path).unwrap();
        } else {
            fs::write(path, content).unwrap();
        }
    }
    let before = names(folder.path());
    let (out, err) = (streams.path().join("out"), streams.path().join("err"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_springfit"))
        .args(arguments)
        .current_dir(folder.path())
        .stdout(File::create(&out).unwrap())
        .stderr(File::create(&err).unwrap())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let mut code = None;
    loop {
        match program.try_wait().unwrap() {
            Some(status) => {
                code = status.code();
                break;
            }
            None if start.elapsed() > Duration::from_secs(20) => {
                program.kill().unwrap();
                program.wait().unwrap();
                break;
            }
            None => sleep(Duration::from_millis(2)),
        }
    }
    let text = |path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned();
    Seen { code, stdout: text(out), stderr: text(err), changed: names(folder.path()) != before }
}

/// Paths of all files and folders below, sorted.
fn names(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(names(&path));
        }
        found.push(path.display().to_string());
    }
    found.sort();
    found
}

/// Collects what differs from an orderly refusal, so that one run shows all cases.
#[derive(Default)]
struct Refusals {
    cases: usize,
    wrong: Vec<String>,
}

impl Refusals {
    fn expect(&mut self, files: &[(&str, &[u8])], arguments: &[&str], message: &str) {
        self.cases += 1;
        let seen = run(files, arguments);
        let expected = format!("error: {message}\n");
        if seen.code != Some(2) || !seen.stdout.is_empty() || seen.stderr != expected || seen.changed {
            let Seen { code, stdout, stderr, changed } = seen;
            let stderr: String = stderr.chars().take(500).collect();
            self.wrong.push(format!(
                "expected {expected:?}\n found   {stderr:?}\n {arguments:?}: code {code:?}, files changed: {changed}, \
                 stdout {stdout:?}"
            ));
        }
    }

    fn expect_of_scene(&mut self, scene: &str, message: &str) {
        self.expect(&[("scene.toml", scene.as_bytes())], &["run", "scene.toml"], message);
    }

    fn expect_of_files(&mut self, element: &str, mesh: &str, message: &str) {
        let files: [(&str, &[u8]); 3] =
            [("scene.toml", FROM_FILES.as_bytes()), ("own.toml", element.as_bytes()), ("mesh.msh", mesh.as_bytes())];
        self.expect(&files, &["run", "scene.toml"], message);
    }

    fn expect_of_edits(&mut self, scene: &str, edits: &[Edit]) {
        for (from, to, message) in edits {
            self.expect_of_scene(&edited(scene, from, to), message);
        }
    }

    fn expect_of_elements(&mut self, edits: &[Edit]) {
        for (from, to, message) in edits {
            self.expect_of_files(&edited(TETRAHEDRON, from, to), &unit_mesh(), message);
        }
    }

    fn finish(self) {
        assert!(self.wrong.is_empty(), "{} of {} cases:\n{}", self.wrong.len(), self.cases, self.wrong.join("\n\n"));
    }
}

fn refuses_edits(scene: &str, edits: &[Edit]) {
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(scene, edits);
    refusals.finish();
}

fn refuses_elements(edits: &[Edit]) {
    let mut refusals = Refusals::default();
    refusals.expect_of_elements(edits);
    refusals.finish();
}

#[test]
fn the_inputs_are_right_before_they_are_changed() {
    let mesh = unit_mesh();
    let files: [(&str, &[u8]); 6] = [
        ("brick.toml", BRICK.as_bytes()),
        ("soft.toml", SOFT.as_bytes()),
        ("plate.toml", PLATE.as_bytes()),
        ("files.toml", FROM_FILES.as_bytes()),
        ("own.toml", TETRAHEDRON.as_bytes()),
        ("mesh.msh", mesh.as_bytes()),
    ];
    let fit = ["fit", "mesh.msh", "--young", "10kPa", "--poisson", "0.3", "-o", "springs.csv"];
    for arguments in [&["run", "brick.toml"][..], &["run", "plate.toml"], &["run", "files.toml"], &fit] {
        let seen = run(&files, arguments);
        assert_eq!((seen.code, seen.stderr.as_str()), (Some(0), ""), "{arguments:?}");
        assert!(seen.changed, "{arguments:?} has written nothing");
    }
}

#[test]
fn keys_and_types() {
    refuses_edits(
        BRICK,
        &[
            (
                "poisson = 0.3",
                "poison = 0.3",
                "scene.toml:5: material.poison: unknown field \"poison\", expected one of \"young\", \"poisson\", \
                 \"plane\", \"thickness\", \"area\", \"density\", \"law\"",
            ),
            (
                "[material]",
                "[materials]",
                "scene.toml:3: materials: unknown field \"materials\", expected one of \"title\", \"mesh\", \
                 \"material\", \"fit\", \"newton\", \"fix\", \"load\", \"gauge\", \"motion\", \"output\"",
            ),
            (
                "group = \"zmax\"",
                "groop = \"zmax\"",
                "scene.toml:11: load[0].groop: unknown field \"groop\", expected one of \"name\", \"group\", \
                 \"where\", \"traction\", \"force\", \"body\", \"displacement\", \"measured\"",
            ),
            ("[material]\nyoung = 10e3\npoisson = 0.3\n", "", "scene.toml:1: missing field \"material\""),
            ("young = 10e3\n", "", "scene.toml:3: material: missing field \"young\""),
            ("objective = \"modal\"\n", "", "scene.toml:6: fit[0]: missing field \"objective\""),
            ("[[fit]]\nobjective = \"modal\"\n", "", "scene.toml: fit: expected at least one [[fit]], found none"),
            (
                "young = 10e3",
                "young = true",
                "scene.toml:4: material.young: invalid type: boolean \"true\", expected a number of Pa or a text \
                 such as \"10kPa\"",
            ),
            (
                "objective = \"modal\"",
                "objective = 3",
                "scene.toml:7: fit[0].objective: invalid type: integer \"3\", expected a string",
            ),
            (
                "objective = \"modal\"",
                "objective = \"modal\"\ntied = 1",
                "scene.toml:8: fit[0].tied: invalid type: integer \"1\", expected a boolean",
            ),
            ("young = 10e3", "young = 10e3\nyoung = 10e3", "scene.toml:5: expected TOML: duplicate key"),
            ("[mesh]", "[mesh", "scene.toml:1: expected TOML: unclosed table, expected \"]\""),
        ],
    );
}

#[test]
fn material() {
    let outside =
        |found: &str| format!("scene.toml: material.poisson: expected a ratio above -1 and below 0.5, found {found}");
    let positive = |key: &str, unit: &str, found: &str| {
        format!("scene.toml: material.{key}: expected a positive number of {unit}, found {found}")
    };
    let mut refusals = Refusals::default();
    for (given, found) in
        [("0.5", "0.5"), ("0.6", "0.6"), ("-1", "-1"), ("-1.5", "-1.5"), ("nan", "NaN"), ("inf", "inf")]
    {
        refusals.expect_of_scene(&edited(BRICK, "poisson = 0.3", &format!("poisson = {given}")), &outside(found));
        refusals.expect_of_scene(&edited(PLATE, "poisson = 0.3", &format!("poisson = {given}")), &outside(found));
    }
    for (given, found) in
        [("0", "0"), ("-1", "-1"), ("nan", "NaN"), ("inf", "inf"), ("\"-1 kPa\"", "-1000"), ("\"inf\"", "inf")]
    {
        let scene = edited(BRICK, "young = 10e3", &format!("young = {given}"));
        refusals.expect_of_scene(&scene, &positive("young", "Pa", found));
    }
    for (given, found) in [("0", "0"), ("-1", "-1"), ("nan", "NaN"), ("inf", "inf")] {
        let scene = edited(BRICK, "poisson = 0.3", &format!("poisson = 0.3\ndensity = {given}"));
        refusals.expect_of_scene(&scene, &positive("density", "kg/m³", found));
        let scene = edited(PLATE, "thickness = 0.1", &format!("thickness = {given}"));
        refusals.expect_of_scene(&scene, &positive("thickness", "m", found));
    }
    refusals.expect_of_edits(
        BRICK,
        &[
            (
                "young = 10e3",
                "young = \"10 psi\"",
                "scene.toml:4: material.young: expected a pressure such as 10000, 10kPa or 0.01MPa, found \"10 psi\"",
            ),
            (
                "poisson = 0.3",
                "poisson = 0.3\nplane = \"stress\"",
                "scene.toml: material.plane: expected a plane mesh, found a solid one",
            ),
            (
                "poisson = 0.3",
                "poisson = 0.3\nthickness = 0.1",
                "scene.toml: material.thickness: expected a plane mesh, found a solid one",
            ),
        ],
    );
    refusals.expect_of_edits(
        PLATE,
        &[(
            "\"strain\"",
            "\"bent\"",
            "scene.toml:6: material.plane: unknown variant \"bent\", expected \"stress\" or \"strain\"",
        )],
    );
    refusals.finish();
}

#[test]
fn fits() {
    refuses_edits(
        BRICK,
        &[
            (
                "\"modal\"",
                "\"modular\"",
                "scene.toml: fit[0].objective: expected one of frobenius, offdiag, modal, spectral, divergence, sampled, whole, van-gelder, van-gelder-simple, lloyd, lloyd-preserving, baudet, baudet-corrected, delingette-quadratic, delingette-biquadratic, maciel-uniform, found \"modular\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\nhigher = 0",
                "scene.toml: fit[0].higher: expected a scale above 0 and at most 1, found 0",
            ),
            (
                "\"modal\"",
                "\"modal\"\nhigher = 1.5",
                "scene.toml: fit[0].higher: expected a scale above 0 and at most 1, found 1.5",
            ),
            (
                "\"modal\"",
                "\"modal\"\nhigher = nan",
                "scene.toml: fit[0].higher: expected a scale above 0 and at most 1, found NaN",
            ),
            (
                "\"modal\"",
                "\"spectral\"\nweight = \"offdiag\"",
                "scene.toml: fit[0].weight: expected one of none, modal, relative: the largest eigenvalue has no blocks, \
                 found \"offdiag\"",
            ),
            (
                "\"modal\"",
                "\"spectral\"\nweight = \"heavy\"",
                "scene.toml: fit[0].weight: expected one of none, offdiag, modal, relative, found \"heavy\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\nweight = \"none\"",
                "scene.toml: fit[0].weight: belongs to \"frobenius\" and \"spectral\", found \"none\" with \"modal\"",
            ),
            (
                "\"modal\"",
                "\"divergence\"\nweight = \"modal\"",
                "scene.toml: fit[0].weight: does not go with \"divergence\": no weight changes it",
            ),
            (
                "\"modal\"",
                "\"divergence\"\nbalance = 2",
                "scene.toml: fit[0].balance: expected a number from 0 to 1, found 2",
            ),
            (
                "\"modal\"",
                "\"spectral\"\nbalance = 0.5",
                "scene.toml: fit[0].balance: belongs to the objective \"divergence\", found with \"spectral\"",
            ),
            (
                "\"modal\"",
                "\"frobenius\"\nhigher = 0.1",
                "scene.toml: fit[0].higher: belongs to the objective \"modal\", found with \"frobenius\"",
            ),
            (
                "\"modal\"",
                "\"offdiag\"\nhigher = 0.1",
                "scene.toml: fit[0].higher: belongs to the objective \"modal\", found with \"offdiag\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\ntopology = true",
                "scene.toml: fit[0].topology: belongs to a general solver, found with \"native\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\niterations = 10\ntopology = true",
                "scene.toml: fit[0].iterations: belongs to a general solver, found with \"native\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\nsolver = \"nelder-mead\"\ntopology = true",
                "scene.toml: fit[0].topology: does not go with \"nelder-mead\", which cannot switch springs off",
            ),
            (
                "\"modal\"",
                "\"modal\"\nsolver = \"particle-swarm\"\nsparsity = 0.1",
                "scene.toml: fit[0].sparsity: belongs to topology = true",
            ),
            (
                "\"modal\"",
                "\"modal\"\nsolver = \"particle-swarm\"\ntopology = true\nsparsity = 2",
                "scene.toml: fit[0].sparsity: expected a share from 0 to 1, found 2",
            ),
            (
                "\"modal\"",
                "\"modal\"\nsprings = [\"edge\", \"diagonal\"]",
                "scene.toml: fit[0].springs: expected groups of tet4: \"edge\", \"bulk\", found \"diagonal\"",
            ),
            (
                "\"modal\"",
                "\"modal\"\nsprings = \"edge\"",
                "scene.toml:8: fit[0].springs: invalid type: string \"edge\", expected a list",
            ),
            (
                "[[fix]]",
                "[[fit]]\nobjective = \"modal\"\n[[fix]]",
                "scene.toml: fit[1].name: expected a name of its own, found \"modal 0.316\" again",
            ),
            (
                "[[fix]]",
                "[[fit]]\nname = \"modal 0.316\"\nobjective = \"offdiag\"\n[[fix]]",
                "scene.toml: fit[1].name: expected a name of its own, found \"modal 0.316\" again",
            ),
        ],
    );
}

#[test]
fn supports() {
    let left = |motions: &str| {
        format!(
            "scene.toml: fix: expected supports that hold every body, found {motions} left to the body of 8 points \
             at [0.0, 0.0, 0.0] m under load \"load 1\""
        )
    };
    let zmin = "group = \"zmin\"";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            ("[[fix]]\ngroup = \"zmin\"\n", "", &left("6 rigid motions")),
            (zmin, "group = \"zmin\"\naxes = [\"z\"]", &left("3 rigid motions")),
            (zmin, "group = \"zmin\"\naxes = [\"z\", \"z\"]", &left("3 rigid motions")),
            (zmin, "where = \"x + y + z == 0\"", &left("3 rigid motions")),
            (zmin, "where = \"x + y == 0\"", &left("1 rigid motion")),
            (zmin, "where = \"z > 5\"", "scene.toml: fix[0]: holds nothing: the selected part has no points"),
            (
                zmin,
                "group = \"bottom\"",
                "scene.toml: fix[0].group: expected a group of the mesh: \"body\", \"xmax\", \"xmin\", \"ymax\", \
                 \"ymin\", \"zmax\", \"zmin\", found \"bottom\"",
            ),
            (
                zmin,
                "group = \"zmin\"\nwhere = \"z == 0\"",
                "scene.toml: fix[0]: expected \"group\" or \"where\", found both",
            ),
            (zmin, "", "scene.toml: fix[0]: expected \"group\" or \"where\", found neither"),
            (
                zmin,
                "group = \"zmin\"\naxes = [\"w\"]",
                "scene.toml: fix[0].axes: expected some of \"x\", \"y\", \"z\", found [\"w\"]",
            ),
            (
                zmin,
                "group = \"zmin\"\naxes = []",
                "scene.toml: fix[0].axes: expected some of \"x\", \"y\", \"z\", found []",
            ),
            (zmin, "where = \"z\"", "scene.toml: fix[0].where: expected a condition such as \"z < 0.1\", found \"z\""),
            (
                zmin,
                "where = \"z <\"",
                "scene.toml: fix[0].where: column 4: expected a number, a name or '(', found the end in \"z <\"",
            ),
            (
                zmin,
                "where = \"r < 1\"",
                "scene.toml: fix[0].where: expected one of x, y, z, found the name \"r\" in \"r < 1\"",
            ),
            (zmin, "where = \"z < 1/0\"", "scene.toml: fix[0].where: division by zero in \"z < 1/0\""),
        ],
    );
    refusals.expect_of_edits(
        PLATE,
        &[
            (
                "group = \"ymin\"",
                "group = \"ymin\"\naxes = [\"z\"]",
                "scene.toml: fix[0].axes: expected \"x\" and \"y\" in a plane mesh, found \"z\"",
            ),
            (
                "group = \"ymin\"",
                "where = \"z < 1\"",
                "scene.toml: fix[0].where: expected one of x, y, found the name \"z\" in \"z < 1\"",
            ),
        ],
    );
    let apart = [&UNIT_NODES[..], &["5 5 5", "6 5 5", "5 6 5", "5 5 6"]].concat();
    refusals.expect_of_files(
        TETRAHEDRON,
        &msh(&apart, &["4 2 0 1 1 2 3 4", "4 2 0 1 5 6 7 8"]),
        "scene.toml: fix: expected supports that hold every body, found 6 rigid motions left to the body of 4 points \
         at [5.0, 5.0, 5.0] m under load \"load 1\"",
    );
    refusals.finish();
}

#[test]
fn loads() {
    let load = "group = \"zmax\"\ntraction = [0, 0, 1]";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            (
                "\"zmax\"",
                "\"top\"",
                "scene.toml: load[0].group: expected a group of the mesh: \"body\", \"xmax\", \"xmin\", \"ymax\", \
                 \"ymin\", \"zmax\", \"zmin\", found \"top\"",
            ),
            (
                "group = \"zmax\"",
                "where = \"z > 5\"",
                "scene.toml: load[0]: acts on nothing: the selected part has no sides",
            ),
            (
                "group = \"zmax\"",
                "where = \"x == y && y == z\"",
                "scene.toml: load[0]: acts on nothing: the selected part has no sides",
            ),
            (
                "group = \"zmax\"",
                "group = \"body\"",
                "scene.toml: load[0]: acts on nothing: the selected part has no sides",
            ),
            (
                load,
                "where = \"z > 5\"\nforce = [0, 0, 1]",
                "scene.toml: load[0]: acts on nothing: the selected part has no points",
            ),
            (
                load,
                "group = \"zmax\"\nbody = [0, 0, 1]",
                "scene.toml: load[0]: acts on nothing: the selected part has no cells",
            ),
            (
                load,
                "where = \"z > 5\"\ndisplacement = [0, 0, 1]",
                "scene.toml: load[0]: acts on nothing: the selected part has no points",
            ),
            (
                "[0, 0, 1]",
                "[0, 1]",
                "scene.toml: load[0].traction: expected 3 entries for a mesh of dimension 3, found 2",
            ),
            ("[0, 0, 1]", "[]", "scene.toml: load[0].traction: expected 3 entries for a mesh of dimension 3, found 0"),
            (
                "traction = [0, 0, 1]",
                "displacement = [0, 0, 0, 1]",
                "scene.toml: load[0].displacement: expected 3 entries for a mesh of dimension 3, found 4",
            ),
            ("[0, 0, 1]", "[0, 0, nan]", "scene.toml: load[0].traction: expected finite numbers, found NaN"),
            (
                "traction = [0, 0, 1]",
                "displacement = [0, 0, \"held\"]",
                "scene.toml:12: load[0].displacement[2]: invalid value: string \"held\", expected a finite number of \
                 metres or \"free\"",
            ),
            (
                "traction = [0, 0, 1]",
                "traction = [0, 0, 1]\nforce = [0, 0, 1]",
                "scene.toml: load[0]: expected one of \"traction\", \"force\", \"body\", \"displacement\", found 2",
            ),
            (
                "traction = [0, 0, 1]",
                "",
                "scene.toml: load[0]: expected one of \"traction\", \"force\", \"body\", \"displacement\", found 0",
            ),
            (
                "group = \"zmax\"",
                "group = \"zmax\"\nwhere = \"z > 0\"",
                "scene.toml: load[0]: expected \"group\" or \"where\", found both",
            ),
            ("group = \"zmax\"\n", "", "scene.toml: load[0]: expected \"group\" or \"where\", found neither"),
            (
                "[[load]]",
                "[[load]]\nname = \"load 2\"\ngroup = \"zmax\"\nforce = [0, 0, 1]\n[[load]]",
                "scene.toml: load[1].name: expected a name of its own, found \"load 2\" again",
            ),
        ],
    );
    refusals.expect_of_edits(
        PLATE,
        &[(
            "[0, 1]\n",
            "[0, 1, 0]\n",
            "scene.toml: load[0].traction: expected 2 entries for a mesh of dimension 2, found 3",
        )],
    );
    refusals.finish();
}

#[test]
fn boxes() {
    let size = "size = [1, 1, 1]";
    let cells = "cells = [1, 1, 1]";
    refuses_edits(
        BRICK,
        &[
            (
                "\"tet4\"",
                "\"tet5\"",
                "scene.toml: mesh.box.element: expected one of bar2, bar3, hex20, hex27, hex8, \
             pentagon5, pyramid13, pyramid5, quad12, quad4, quad8, quad9, tet10, tet20, tet4, tri10, tri3, tri6, wedge15, wedge6, \
             or a path that ends in .toml, \
                 found \"tet5\"",
            ),
            (size, "size = [0, 1, 1]", "scene.toml: mesh.box.size: expected positive lengths in m, found 0"),
            (size, "size = [-1, 1, 1]", "scene.toml: mesh.box.size: expected positive lengths in m, found -1"),
            (size, "size = [nan, 1, 1]", "scene.toml: mesh.box.size: expected positive lengths in m, found NaN"),
            (size, "size = [1, 1]", "scene.toml: mesh.box.size: expected 3 entries for tet4, found 2"),
            (
                size,
                "size = [1e308, 1e308, 1e308]",
                "scene.toml: mesh.box.size: expected lengths from 1e-30 to 1e30 m, found 1e308",
            ),
            (
                cells,
                "cells = [0, 1, 1]",
                "scene.toml: mesh.box.cells: expected 1 to 2000000 cells in all, found [0, 1, 1]",
            ),
            (
                cells,
                "cells = [9223372036854775807, 9, 9]",
                "scene.toml: mesh.box.cells: expected 1 to 2000000 cells in all, found [9223372036854775807, 9, 9]",
            ),
            (cells, "cells = []", "scene.toml: mesh.box.cells: expected 3 entries for tet4, found 0"),
            (
                cells,
                "cells = [1, 1, 1], origin = [0, inf, 0]",
                "scene.toml: mesh.box.origin: expected finite coordinates in m, found inf",
            ),
            (
                cells,
                "cells = [1, 1, 1], origin = [0]",
                "scene.toml: mesh.box.origin: expected 3 entries for tet4, found 1",
            ),
            (
                "[mesh]",
                "[mesh]\nscale = -1",
                "scene.toml: mesh.scale: expected a positive number of metres per mesh unit, found -1",
            ),
            (
                "[mesh]",
                "[mesh]\nscale = nan",
                "scene.toml: mesh.scale: expected a positive number of metres per mesh unit, found NaN",
            ),
            (
                "[mesh]",
                "[mesh]\nscale = 1e300",
                "scene.toml: mesh.box.size: expected lengths from 1e-30 to 1e30 m, found 1e300",
            ),
            (
                "[mesh]",
                "[mesh]\nfile = \"mesh.msh\"",
                "scene.toml: mesh: expected one of \"file\", \"box\", \"disc\", found file and box",
            ),
            (
                "box = { element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] }\n",
                "",
                "scene.toml: mesh: expected one of \"file\", \"box\", \"disc\", found none",
            ),
        ],
    );
}

#[test]
fn shape_functions() {
    let first = "\"1 - xi - eta - zeta\"";
    let mut refusals = Refusals::default();
    refusals.expect_of_elements(&[
        ("\"xi\" }", "\"2*xi\" }", "own.toml: nodes[1].shape: is 2 at nodes[1], expected 1"),
        ("\"xi\" }", "\"xi - eta\" }", "own.toml: nodes[1].shape: is -1 at nodes[2], expected 0"),
        ("\"xi\" }", "\"sin(xi)\" }", "own.toml: nodes[1].shape: is 0.8414709848078965 at nodes[1], expected 1"),
        ("\"xi\" }", "\"xi/(xi*eta)\" }", "own.toml: nodes[1].shape: is NaN at nodes[0], expected 0"),
        (
            "\"xi\" }",
            "\"xi^2\" }",
            "own.toml: nodes: expected shape functions that sum to 1, found 1 -2.500e-1 at [0.500, 0.335, 0.154]",
        ),
        ("at = [0, 0, 1]", "at = [0, 1, 0]", "own.toml: nodes[2].shape: is 1 at nodes[3], expected 0"),
        ("at = [0, 0, 1]", "at = [0, 1]", "own.toml: nodes[3].at: expected 3 coordinates, found 2"),
        (
            "[\"xi\", \"eta\", \"zeta\"]",
            "[\"xi\", \"eta\"]",
            "own.toml: coordinates: expected 3 names for a cell of dimension 3, found 2",
        ),
        (
            "\"tetrahedron\" ",
            "\"prism\" ",
            "own.toml:4: cell: unknown variant \"prism\", expected one of \"interval\", \"triangle\", \
             \"quadrilateral\", \"pentagon\", \"tetrahedron\", \"hexahedron\", \"wedge\", \"pyramid\"",
        ),
    ]);
    // The sum is still one, but ξ is not reproduced.
    let incomplete = edited(&edited(TETRAHEDRON, "\"xi\" }", "\"xi^2\" }"), first, "\"1 - xi^2 - eta - zeta\"");
    refusals.expect_of_files(
        &incomplete,
        &unit_mesh(),
        "own.toml: nodes: expected shape functions that reproduce xi, found xi -2.500e-1 at [0.500, 0.465, 0.032]",
    );
    let open = "(".repeat(101);
    let deep = edited(TETRAHEDRON, "\"xi\" }", &format!("\"{open}xi{}\" }}", ")".repeat(101)));
    let shown = format!("{}...", &open[..57]);
    refusals.expect_of_files(
        &deep,
        &unit_mesh(),
        &format!(
            "own.toml: nodes[1].shape: column 101: expected at most 100 open parentheses, found '(' in \"{shown}\""
        ),
    );
    let long = edited(TETRAHEDRON, "\"xi\" }", &format!("\"{}0\" }}", "1 + ".repeat(200_000)));
    let shown = format!("{}...", &"1 + ".repeat(15)[..57]);
    refusals.expect_of_files(
        &long,
        &unit_mesh(),
        &format!("own.toml: nodes[1].shape: expected at most 10000 characters, found 800001 in \"{shown}\""),
    );
    refusals.expect_of_files("", &unit_mesh(), "own.toml:1: missing field \"name\"");
    refusals.finish();
}

#[test]
fn expressions() {
    let mut refusals = Refusals::default();
    for (text, problem) in [
        ("xi**2", "column 4: expected a number, a name or '(', found '*'"),
        ("xi eta", "column 4: expected an operator, found 'e'"),
        ("(1-xi)//4", "column 8: expected a number, a name or '(', found '/'"),
        ("(1-xi", "column 6: expected ')', found the end"),
        ("1-xi)", "column 5: expected an operator or the end, found ')'"),
        ("()", "column 2: expected a number, a name or '(', found ')'"),
        ("", "column 1: expected a number, a name or '(', found the end"),
        ("xi^", "column 4: expected a number, a name or '(', found the end"),
        ("+xi", "column 1: expected a number, a name or '(', found '+'"),
        ("--xi", "column 2: expected parentheses around a negative term, found '-'"),
        ("2xi", "column 2: expected an operator, found 'x'"),
        ("2(xi)", "column 2: expected an operator, found '('"),
        ("xi^2^2", "expected parentheses in a power of a power"),
        ("xii", "expected one of xi, eta, zeta, found the name \"xii\""),
        ("sin", "column 4: expected '(' after sin, found the end"),
        (
            "sinh(xi)",
            "expected an operator, or a function of sqrt, ramp, exp, ln, sin, cos, tan, asin, acos, atan, abs, step, found \"sinh(\"",
        ),
        ("ξ", "column 1: expected a number, a name or '(', found 'ξ'"),
        ("xi = 1", "column 4: expected one of <, <=, >, >=, ==, !=, &&, ||, found '='"),
        ("xi; 1", "column 3: expected an operator, found ';'"),
        ("1.2.3", "column 1: expected a decimal number, found '1'"),
        ("1e999999", "column 1: expected a decimal number, found '1'"),
        ("xi/(1-1)", "division by zero"),
    ] {
        let element = edited(TETRAHEDRON, "\"xi\" }", &format!("\"{text}\" }}"));
        refusals.expect_of_files(&element, &unit_mesh(), &format!("own.toml: nodes[1].shape: {problem} in \"{text}\""));
    }
    refusals.expect_of_elements(&[
        ("\"xi\" }", "\"xi < 1\" }", "own.toml: nodes[1].shape: expected a number, found the condition \"xi < 1\""),
        (
            "nodes = [\n",
            "let = { xi = \"1\" }\nnodes = [\n",
            "own.toml: let.xi: expected a new name of letters, digits and _, found \"xi\"",
        ),
        (
            "nodes = [\n",
            "let = { a = \"a\" }\nnodes = [\n",
            "own.toml: let.a: expected one of xi, eta, zeta, found the name \"a\" in \"a\"",
        ),
        (
            "nodes = [\n",
            "let = { a = 1 }\nnodes = [\n",
            "own.toml: let.a: expected an expression in quotes, found integer",
        ),
    ]);
    refusals.finish();
}

#[test]
fn quadrature() {
    let rule = "rule   = \"simplex\"\ndegree = 1";
    refuses_elements(&[
        (
            rule,
            "rule = \"explicit\"\npoints = [[\"1/4\", \"1/4\", \"1/4\"]]\nweights = [0.2]",
            "own.toml: quadrature.weights: expected weights that sum to the cell's content 0.16666666666666666, \
             found 0.2",
        ),
        (
            rule,
            "rule = \"explicit\"\npoints = [[\"1/4\", \"1/4\", \"1/4\"]]\nweights = [\"1/12\", \"1/12\"]",
            "own.toml: quadrature.weights: expected one weight for each of the 1 points, found 2",
        ),
        (
            rule,
            "rule = \"explicit\"\npoints = [[\"1/4\", \"1/4\"]]\nweights = [\"1/6\"]",
            "own.toml: quadrature.points[0]: expected 3 coordinates, found 2",
        ),
        ("degree = 1", "degree = 0", "own.toml: quadrature.degree: expected 1 to 32, found 0"),
        ("degree = 1", "degree = 33", "own.toml: quadrature.degree: expected 1 to 32, found 33"),
        (
            rule,
            "rule = \"gauss-legendre\"\npoints = 2",
            "own.toml: quadrature.rule: expected \"simplex\", \"degree\" or \"explicit\" on a simplex, found \"gauss-legendre\"",
        ),
        (
            "\"simplex\"",
            "\"simpson\"",
            "own.toml:15: quadrature.rule: unknown variant \"simpson\", expected one of \"gauss-legendre\", \
             \"simplex\", \"degree\", \"explicit\"",
        ),
    ]);
}

#[test]
fn springs_and_formats() {
    refuses_elements(&[
        ("[2, 3]]", "[2, 4]]", "own.toml: springs[0].nodes[5]: expected two different nodes below 4, found [2, 4]"),
        ("[2, 3]]", "[2, 2]]", "own.toml: springs[0].nodes[5]: expected two different nodes below 4, found [2, 2]"),
        ("[2, 3]]", "[1, 0]]", "own.toml: springs[0].nodes[5]: the pair [1, 0] has a spring already"),
        ("[2, 3]]", "[2]]", "own.toml: springs[0].nodes[5]: expected two nodes, found 1"),
        (
            "nodes = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]]\n",
            "",
            "own.toml: springs[0].nodes: expected pairs of nodes, found none",
        ),
        ("\"bulk\"", "\"edge\"", "own.toml: springs[1].group: expected a name used once, found \"edge\" again"),
        (
            "\"volume\"",
            "\"area\"",
            "own.toml: springs[1].kind: expected \"volume\" for the content of a solid, \"area\" with nodes or in a plane \
             cell, found \"area\"",
        ),
        (
            "\"volume\"",
            "\"mass\"",
            "own.toml:25: springs[1].kind: unknown variant \"mass\", expected one of \"length\", \"angle\", \"area\", \
             \"volume\", \"coupling\", \"measure\"",
        ),
        ("\"volume\"", "\"angle\"", "own.toml: springs[1].nodes: expected lists of nodes, found none"),
        (
            "kind  = \"length\"",
            "kind = \"length\"\nmeasure = \"x0\"",
            "own.toml: springs[0].measure: belongs to the kind \"measure\", found with \"length\"",
        ),
        (
            "kind  = \"length\"",
            "kind = \"measure\"",
            "own.toml: springs[0].measure: expected an expression of x0, y0, x1, …, found none",
        ),
        (
            "kind  = \"length\"",
            "kind = \"measure\"\nmeasure = \"x0 - x2\"",
            "own.toml: springs[0].measure: expected one of x0, y0, z0, x1, y1, z1, found the name \"x2\" in \"x0 - x2\"",
        ),
        ("kind  = \"length\"", "kind = \"angle\"", "own.toml: springs[0].nodes[0]: expected three nodes, found 2"),
        (
            "kind  = \"length\"",
            "kind = \"area\"",
            "own.toml: springs[0].nodes[0]: expected three to eight nodes, found 2",
        ),
        (
            "kind  = \"length\"",
            "kind = \"length\"\nclass = \"all\"",
            "own.toml:21: springs[0].class: unknown variant \"all\", expected \"auto\"",
        ),
        (
            "kind     = \"volume\"",
            "kind = \"coupling\"\nnodes = [[0, 1, 1, 0]]",
            "own.toml: springs[1].nodes[0]: expected two different pairs of different nodes below 4, found [0, 1, 1, 0]",
        ),
        (
            "kind     = \"volume\"",
            "kind = \"angle\"\nnodes = [[0, 1, 2], [2, 1, 0]]",
            "own.toml: springs[1].nodes[1]: the list [2, 1, 0] has a spring already",
        ),
        (
            "kind     = \"volume\"",
            "kind = \"length\"\nnodes = \"complete\"",
            "own.toml: springs[1].nodes: expected pairs that have no spring yet, found none",
        ),
        (
            "kind     = \"volume\"",
            "kind = \"angle\"\nnodes = \"complete\"",
            "own.toml: springs[1].nodes: expected lists of nodes, or \"complete\" with the kind \"length\", found \
             \"complete\"",
        ),
        (
            "{ type = 4 }",
            "{ type = 4, order = [0, 1, 2, 4] }",
            "own.toml: formats.gmsh.order: expected each of 0 to 3 once, found [0, 1, 2, 4]",
        ),
    ]);
}

#[test]
fn meshes() {
    let tetrahedron = ["4 2 0 1 1 2 3 4"];
    let wedge = ["0 0 0", "1 0 0", "0 1 0", "0 0 1", "1 0 1", "0 1 1"];
    let with_last = |at: &'static str| [&UNIT_NODES[..3], &[at]].concat();
    let mut refusals = Refusals::default();
    for (mesh, message) in [
        (
            msh(&wedge, &["14 2 0 1 1 2 3 4 5 6 1 2 3 4 5 6 1 2"]),
            "mesh.msh: cells: expected cells of bar2, bar3, hex20, hex27, hex8, pentagon5, \
             pyramid13, pyramid5, quad12, quad4, quad8, quad9, tet10, tet20, tet4, tri10, tri3, tri6, wedge15, wedge6 or of an element file you name, found 1 cells \
             of Gmsh type 14 with 14 nodes",
        ),
        (
            msh(&with_last("1 1 0"), &tetrahedron),
            "mesh.msh: tet4 cell 1 at [0.0, 0.0, 0.0] m: the element has no volume (its Jacobian vanishes)",
        ),
        (
            msh(&UNIT_NODES, &["4 2 0 1 1 2 3 3"]),
            "mesh.msh: tet4 cell 1 at [0.0, 0.0, 0.0] m: one of its nodes is there twice: springs between them would have no length",
        ),
        (
            msh(&CUBE_NODES, &["5 2 0 1 1 3 2 4 5 6 7 8"]),
            "mesh.msh: hex8 cell 1 at [0.0, 0.0, 0.0] m: the element is tangled: its Jacobian determinant goes from \
             1.138e-1 down to -3.050e-2 at quadrature point 1",
        ),
        (msh(&with_last("0 0 nan"), &tetrahedron), "mesh.msh: node 4: expected finite coordinates, found (0, 0, NaN)"),
        (
            msh(&with_last("0 0 1e999"), &tetrahedron),
            "mesh.msh: node 4: expected finite coordinates, found (0, 0, inf)",
        ),
        (msh(&UNIT_NODES, &["4 2 0 1 1 2 3 5"]), "mesh.msh:13: $Elements: element 1 names node 5, which $Nodes lacks"),
        (
            msh(&UNIT_NODES, &["2 2 0 1 1 2 3", "2 2 0 1 1 2 4"]),
            "scene.toml: mesh: the finite element stiffness is not positive definite: some motion has no stiffness; surfaces \
             and curves resist no bending, so hold their points across them",
        ),
        (
            msh(&UNIT_NODES, &["1 2 0 1 1 2"]),
            "scene.toml: fix[0].where: expected one of x, y, found the name \"z\" in \"z == 0\"",
        ),
        (msh(&UNIT_NODES, &[]), "mesh.msh: cells: expected lines, surface or solid cells, found none"),
        (msh(&[], &[]), "mesh.msh: cells: expected lines, surface or solid cells, found none"),
        (String::new(), "mesh.msh: the file ends before $MeshFormat"),
        (
            edited(&unit_mesh(), "$Nodes\n4", "$Nodes\n99999999999999"),
            "mesh.msh:10: $Nodes: expected 99999999999999 nodes, found 4",
        ),
        (
            edited(&unit_mesh(), "2.2 0 8", "3.0 0 8"),
            "mesh.msh:2: $MeshFormat: expected version 4.1 or 2.2, found \"3.0\"",
        ),
    ] {
        refusals.expect_of_files(TETRAHEDRON, &mesh, message);
    }
    let six_nodes = edited(TETRAHEDRON, "{ type = 4 }", "{ type = 6 }");
    refusals.expect_of_files(
        &six_nodes,
        &msh(&wedge, &["6 2 0 1 1 2 3 4 5 6"]),
        "mesh.msh: cells: expected 4 nodes in 3 dimensions as in tet4, found 6 nodes in 3",
    );
    refusals.finish();
}

#[test]
fn truncated_meshes() {
    let mut refusals = Refusals::default();
    for (file, problem) in [
        ("bar_22_ascii.msh", "the file ends inside $Nodes: expected 20 nodes, found 19"),
        ("bar_22_binary.msh", "the file ends inside $Elements: expected 22 elements, found 2"),
        ("bar_41_ascii.msh", "the file ends inside $Entities: expected 54 entities, found 42"),
        ("bar_41_binary.msh", "the file ends inside $Entities: expected 54 entities, found 44"),
        ("bar_ascii.vtu", "the file ends before </VTKFile>"),
        ("bar_base64.vtu", "the file ends before </VTKFile>"),
        ("bar_appended_zlib.vtu", "the file ends before </VTKFile>"),
        ("bar_42_ascii.vtk", "the file ends inside CELLS: expected 16 cells, found 7"),
        ("bar_binary.vtk", "the file ends inside CELLS: expected 66 numbers, found 19"),
    ] {
        let whole = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(file)).unwrap();
        let scene = edited(&edited(FROM_FILES, "mesh.msh", file), "elements = [\"own.toml\"]\n", "");
        let half = &whole[..whole.len() / 2];
        let files: [(&str, &[u8]); 2] = [("scene.toml", scene.as_bytes()), (file, half)];
        refusals.expect(&files, &["run", "scene.toml"], &format!("{file}: {problem}"));
    }
    refusals.finish();
}

#[test]
fn contents_of_another_kind() {
    let mut refusals = Refusals::default();
    let latin: &[u8] = b"title = \"na\xefve\"";
    refusals.expect(
        &[("scene.toml", latin)],
        &["run", "scene.toml"],
        "scene.toml: expected UTF-8 text, found other bytes",
    );
    refusals.expect(
        &[("scene.toml", FROM_FILES.as_bytes()), ("own.toml", latin)],
        &["run", "scene.toml"],
        "own.toml: expected UTF-8 text, found other bytes",
    );
    refusals.expect(&[("scene.toml", b"")], &["run", "scene.toml"], "scene.toml:1: missing field \"mesh\"");
    let nested = "a = ".to_string() + &"[".repeat(100_000);
    refusals.expect_of_scene(&nested, "scene.toml:1: expected TOML: cannot recurse further; max recursion depth met");
    for (name, content, problem) in [
        ("mesh.stl", "solid\n", "expected a mesh ending in .msh, .vtu or .vtk"),
        ("mesh", "", "expected a mesh ending in .msh, .vtu or .vtk"),
        ("mesh.vtu", "", "expected <VTKFile>, found none"),
        ("mesh.vtu", "$MeshFormat\n", "expected <VTKFile>, found none"),
    ] {
        let scene = edited(&edited(FROM_FILES, "mesh.msh", name), "elements = [\"own.toml\"]\n", "");
        let files: [(&str, &[u8]); 2] = [("scene.toml", scene.as_bytes()), (name, content.as_bytes())];
        refusals.expect(&files, &["run", "scene.toml"], &format!("{name}: {problem}"));
    }
    let scene = edited(FROM_FILES, "mesh.msh", "mesh.vtk");
    refusals.expect(
        &[("scene.toml", scene.as_bytes()), ("own.toml", TETRAHEDRON.as_bytes()), ("mesh.vtk", b"# vtk Data")],
        &["run", "scene.toml"],
        "mesh.vtk:1: expected \"# vtk DataFile Version\" and a number, found \"# vtk Data\"",
    );
    refusals.finish();
}

#[cfg(unix)]
#[test]
fn missing_files_and_folders() {
    let mut refusals = Refusals::default();
    let scene: (&str, &[u8]) = ("scene.toml", FROM_FILES.as_bytes());
    let element: (&str, &[u8]) = ("own.toml", TETRAHEDRON.as_bytes());
    let arguments = ["run", "scene.toml"];
    refusals.expect(&[], &arguments, "scene.toml: cannot be read: No such file or directory (os error 2)");
    refusals.expect(&[("scene.toml/", b"")], &arguments, "scene.toml: cannot be read: Is a directory (os error 21)");
    refusals.expect(&[scene], &arguments, "own.toml: cannot be read: No such file or directory (os error 2)");
    refusals.expect(&[scene, element], &arguments, "mesh.msh: cannot be read: No such file or directory (os error 2)");
    refusals.expect(
        &[scene, element, ("mesh.msh/", b"")],
        &arguments,
        "mesh.msh: cannot be read: Is a directory (os error 21)",
    );
    refusals.expect(&[scene, ("own.toml/", b"")], &arguments, "own.toml: cannot be read: Is a directory (os error 21)");
    refusals.finish();
}

#[test]
fn arguments_of_fit() {
    let mesh = unit_mesh();
    let given = [("--young", "10kPa"), ("--poisson", "0.3"), ("--output", "springs.csv")];
    let pressure = "--young: expected a pressure such as 10000, 10kPa or 0.01MPa, found";
    let ending = "--output: expected a file ending in .vtu, .json or .csv, found";
    let positive = "--scale: expected a positive number of metres per mesh unit, found";
    let mut refusals = Refusals::default();
    for (key, value, message) in [
        ("--young", "10 psi", format!("{pressure} \"10 psi\"")),
        ("--young", "kPa", format!("{pressure} \"kPa\"")),
        ("--young", "", format!("{pressure} \"\"")),
        ("--output", "springs.txt", format!("{ending} springs.txt")),
        ("--output", "springs", format!("{ending} springs")),
        ("--output", ".csv", format!("{ending} .csv")),
        ("--scale", "-1", format!("{positive} -1")),
        ("--scale", "0", format!("{positive} 0")),
        ("--scale", "inf", format!("{positive} inf")),
        ("--density", "0", "--density: expected a positive number of kg/m³, found 0".into()),
        (
            "--springs",
            "edge,diagonal",
            "springs: expected groups of tet4: \"edge\", \"bulk\", found \"diagonal\"".into(),
        ),
    ] {
        let mut arguments = vec!["fit".to_string(), "mesh.msh".to_string()];
        let others = given.iter().filter(|(other, _)| *other != key);
        arguments.extend(others.chain([&(key, value)]).map(|(key, value)| format!("{key}={value}")));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        refusals.expect(&[("mesh.msh", mesh.as_bytes())], &arguments, &message);
    }
    refusals.finish();
}

#[cfg(unix)]
#[test]
fn springs_that_cannot_be_written() {
    let mesh = unit_mesh();
    let files: [(&str, &[u8]); 3] = [("mesh.msh", mesh.as_bytes()), ("file", b""), ("folder.csv/", b"")];
    let mut refusals = Refusals::default();
    for (output, problem) in [
        ("missing/springs.csv", "cannot be written: its folder does not exist"),
        ("file/springs.json", "cannot be written: its folder does not exist"),
        ("folder.csv", "expected the name of a file to write, found a folder"),
    ] {
        let arguments = ["fit", "mesh.msh", "--young", "10kPa", "--poisson", "0.3", "-o", output];
        refusals.expect(&files, &arguments, &format!("{output}: {problem}"));
    }
    refusals.finish();
}

#[cfg(unix)]
#[test]

fn report_folders_that_cannot_be_made() {
    let mut refusals = Refusals::default();
    for (out, problem) in [("file", "a file stands in the way"), ("file/report", "a file stands in the way")] {
        refusals.expect(
            &[("scene.toml", BRICK.as_bytes()), ("file", b"")],
            &["run", "scene.toml", "--out", out],
            &format!("{out}: the folder cannot be created: {problem}"),
        );
    }
    refusals.expect(
        &[("scene.toml", BRICK.as_bytes()), ("out", b"")],
        &["run", "scene.toml"],
        "out/scene: the folder cannot be created: a file stands in the way",
    );
    refusals.finish();
}

#[test]

fn chains_of_operators() {
    let mut refusals = Refusals::default();
    for chain in ["!", "0+", "0-", "1*", "1/"] {
        let condition = format!("{}z < 1", chain.repeat(9_990 / chain.len()));
        let shown: String = condition.chars().take(57).collect();
        let found = 9_990 / chain.len() + 1;
        refusals.expect_of_scene(
            &edited(BRICK, "group = \"zmin\"", &format!("where = \"{condition}\"")),
            &format!("scene.toml: fix[0].where: expected at most 1000 operators, found {found} in \"{shown}...\""),
        );
    }
    refusals.finish();
}

#[test]

fn numbers_without_bound() {
    let squares: Vec<_> = (1..30).map(|i| format!("a{i} = \"a{}*a{}\"", i - 1, i - 1)).collect();
    let squares = format!("let = {{ a0 = \"1234567890\", {} }}\nnodes = [\n", squares.join(", "));
    let mut refusals = Refusals::default();
    refusals.expect_of_elements(&[
        (
            "\"xi\" }",
            "\"(((2^256)^256)^256)^256*xi\" }",
            "own.toml: nodes[1].shape: expected numbers of at most 1000 digits in \"(((2^256)^256)^256)^256*xi\"",
        ),
        ("nodes = [\n", &squares, "own.toml: let.a7: expected numbers of at most 1000 digits in \"a6*a6\""),
    ]);
    refusals.finish();
}

#[test]

fn expressions_without_bound() {
    let sums: Vec<_> = (1..8).map(|i| format!("a{i} = \"{}0\"", format!("a{} + ", i - 1).repeat(100))).collect();
    let sums = format!("let = {{ a0 = \"xi\", {} }}\nnodes = [\n", sums.join(", "));
    let shown: String = "a1 + ".repeat(12).chars().take(57).collect();
    refuses_elements(&[(
        "nodes = [\n",
        &sums,
        &format!("own.toml: let.a2: expected at most 2000 terms and factors in all in \"{shown}...\""),
    )]);
}

/// A tetrahedron whose first shape function is another, of so many nodes.
fn with_shape(definition: &str, shape: &str, nodes: usize) -> String {
    let node = format!("    {{ at = [0, 0, 0], shape = \"{shape}\" }},\n");
    let first = "    { at = [0, 0, 0], shape = \"1 - xi - eta - zeta\" },\n";
    let element = edited(TETRAHEDRON, first, &node.repeat(nodes));
    edited(&element, "nodes = [\n    { at", &format!("let = {{ a = \"{definition}\" }}\nnodes = [\n    {{ at"))
}

#[test]
fn inputs_without_bound() {
    let mut refusals = Refusals::default();
    let ramps = format!("{}xi{}", "ramp(".repeat(40), ")".repeat(40));
    let shown = "ramp(".repeat(12).chars().take(57).collect::<String>();
    refusals.expect_of_elements(&[(
        "\"xi\" }",
        &format!("\"{ramps}\" }}"),
        &format!("own.toml: nodes[1].shape: expected at most 2000 terms and factors in all in \"{shown}...\""),
    )]);
    for (element, message) in [
        (
            with_shape(&format!("xi{}", " + xi".repeat(990)), "a + a", 80),
            "own.toml: nodes: expected shape functions of at most 80000 numbers, names and operations in all, found 158643",
        ),
        (
            with_shape(&format!("xi{}", "*xi".repeat(990)), "a + a", 1),
            "own.toml: nodes: expected gradients of at most 5000000 numbers, names and operations in all, found 5904396",
        ),
        (
            edited(
                &with_shape(&format!("xi{}", "*xi".repeat(249)), "1 - xi - eta - zeta + a - a + a - a", 1),
                "degree = 1",
                "degree = 32",
            ),
            "own.toml: quadrature: expected a rule at whose points the shape functions take at most 1000000000 steps to \
             evaluate, found 1308474666 at 5202 points",
        ),
    ] {
        refusals.expect_of_files(&element, &unit_mesh(), message);
    }
    let long = format!("{BRICK}# {}\n", "x".repeat(1_000_000));
    let message = format!("scene.toml: expected at most 1000000 bytes of TOML, found {}", long.len());
    refusals.expect_of_scene(&long, &message);
    let groups: Vec<String> = (1..=1001).map(|group| format!("4 2 {group} 1 1 2 3 4")).collect();
    let mesh = msh(&UNIT_NODES, &groups.iter().map(String::as_str).collect::<Vec<_>>());
    let message = "mesh.msh:1013: $Elements: expected element 1001 in at most 1000 physical groups, found more";
    refusals.expect_of_files(TETRAHEDRON, &mesh, message);
    refusals.finish();
}

#[test]

fn lengths_near_the_largest_number() {
    refuses_edits(
        BRICK,
        &[(
            "size = [1, 1, 1]",
            "size = [1e308, 1, 1]",
            "scene.toml: mesh.box.size: expected lengths from 1e-30 to 1e30 m, found 1e308",
        )],
    );
}

#[test]

fn quantities_out_of_range() {
    refuses_edits(
        BRICK,
        &[
            ("10e3", "1e-160", "scene.toml: material.young: expected a number from 1e-30 to 1e30 Pa, found 1e-160"),
            ("10e3", "1e160", "scene.toml: material.young: expected a number from 1e-30 to 1e30 Pa, found 1e160"),
            (
                "[mesh]",
                "[mesh]\nscale = 1e-100",
                "scene.toml: mesh.box.size: expected lengths from 1e-30 to 1e30 m, found 1e-100",
            ),
        ],
    );
}

#[test]

fn springs_of_three_nodes() {
    refuses_elements(&[("[2, 3]]", "[2, 3, 1]]", "own.toml: springs[0].nodes[5]: expected two nodes, found 3")]);
}

#[test]

fn messages_in_the_words_of_the_file() {
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            (
                "poisson = 0.3",
                "poisson = \"soft\"",
                "scene.toml:5: material.poisson: invalid type: string \"soft\", expected a number",
            ),
            (
                "cells = [1, 1, 1]",
                "cells = [1, 1, -1]",
                "scene.toml:2: mesh.box.cells[2]: invalid value: integer \"-1\", expected a whole number",
            ),
            (
                "cells = [1, 1, 1]",
                "cells = [1, 1, 18446744073709551616]",
                "scene.toml:2: mesh.box.cells[2]: invalid type: integer \"18446744073709551616\" as i128, \
                 expected a whole number",
            ),
            ("[[fit]]", "[fit]", "scene.toml:6: fit: invalid type: map, expected a list"),
            (
                "size = [1, 1, 1]",
                "size = [1e-8, 1, 1]",
                "scene.toml: mesh: the finite element stiffness is not positive definite: some motion has no stiffness",
            ),
        ],
    );
    let rule = "rule   = \"simplex\"\ndegree = 1";
    refusals.expect_of_elements(&[
        (
            rule,
            "rule = \"explicit\"\npoints = []\nweights = []",
            "own.toml: quadrature.points: expected at least one point, found none",
        ),
        ("at = [0, 0, 1]", "at = [0, 0, nan]", "own.toml:11: nodes[3].at[2]: expected a finite number, found nan"),
        (
            "\"xi\" }",
            "\"true\" }",
            "own.toml: nodes[1].shape: expected one of xi, eta, zeta, found the name \"true\" in \"true\"",
        ),
        (
            "[\"xi\", \"eta\", \"zeta\"]",
            "[\"xi\", \"eta\", \"xi\"]",
            "own.toml: coordinates[2]: expected a new name of letters, digits and _, found \"xi\"",
        ),
        (
            "[\"xi\", \"eta\", \"zeta\"]",
            "[\"xi\", \"eta\", \"1\"]",
            "own.toml: coordinates[2]: expected a new name of letters, digits and _, found \"1\"",
        ),
    ]);
    refusals.expect_of_scene(
        &edited(FROM_FILES, "own.toml", "tet9"),
        "scene.toml: mesh.elements[0]: expected one of bar2, bar3, hex20, hex27, hex8, \
             pentagon5, pyramid13, pyramid5, quad12, quad4, quad8, quad9, tet10, tet20, tet4, tri10, tri3, tri6, wedge15, wedge6, \
             or a path that ends in .toml, found \
         \"tet9\"",
    );
    refusals.finish();
}

#[test]

fn options_by_their_names() {
    let mesh = unit_mesh();
    let mut refusals = Refusals::default();
    let ratio = "--poisson: expected a ratio above -1 and below 0.5, found";
    for (young, poisson, more, message) in [
        ("0", "0.3", &[][..], "--young: expected a positive number of Pa, found 0".to_string()),
        ("-1kPa", "0.3", &[], "--young: expected a positive number of Pa, found -1000".into()),
        ("1kPa", "0.5", &[], format!("{ratio} 0.5")),
        ("1kPa", "-1", &[], format!("{ratio} -1")),
        ("1kPa", "0.3", &["--plane", "stress"], "--plane: expected a plane mesh, found a solid one".into()),
        ("1kPa", "0.3", &["--thickness", "1"], "--thickness: expected a plane mesh, found a solid one".into()),
        (
            "1kPa",
            "0.3",
            &["--objective", "least"],
            "--objective: expected one of frobenius, offdiag, modal, spectral, divergence, sampled, whole, van-gelder, van-gelder-simple, lloyd, lloyd-preserving, baudet, baudet-corrected, delingette-quadratic, delingette-biquadratic, maciel-uniform, found \"least\"".into(),
        ),
        (
            "1kPa",
            "0.3",
            &["--scale", "-1"],
            "--scale: expected a positive number of metres per mesh unit, found -1".into(),
        ),
        ("1kPa", "0.3", &["--density", "-1"], "--density: expected a positive number of kg/m³, found -1".into()),
        (
            "1kPa",
            "0.3",
            &["--element", "tet9"],
            "--element: expected one of bar2, bar3, hex20, hex27, hex8, \
             pentagon5, pyramid13, pyramid5, quad12, quad4, quad8, quad9, tet10, tet20, tet4, tri10, tri3, tri6, wedge15, wedge6, \
             or a path that ends in .toml, found \"tet9\"".into(),
        ),
    ] {
        let arguments = ["fit", "mesh.msh", "--young", young, "--poisson", poisson, "-o", "springs.csv"];
        let arguments = [&arguments[..], more].concat();
        refusals.expect(&[("mesh.msh", mesh.as_bytes())], &arguments, &message);
    }
    refusals.finish();
}

#[test]
fn comparisons() {
    let mut refusals = Refusals::default();
    let unloaded = BRICK.split("[[load]]").next().unwrap();
    for (file, arguments, message) in [
        (
            BRICK,
            &["tet9"][..],
            "element: expected one of bar2, bar3, hex20, hex27, hex8, \
             pentagon5, pyramid13, pyramid5, quad12, quad4, quad8, quad9, tet10, tet20, tet4, tri10, tri3, tri6, wedge15, wedge6, \
             or a path that ends in .toml, found \"tet9\"",
        ),
        (BRICK, &["tet4", "--shapes", "0"], "--shapes: expected a number from 1 to 1000000, found 0"),
        (BRICK, &["tet4", "--iterations", "0"], "--iterations: expected a number above 0, found 0"),
        (BRICK, &["tet4", "--poisson", "0.5"], "--poisson: expected a ratio above -1 and below 0.5, found 0.5"),
        (unloaded, &["scene.toml"], "scene.toml: load: expected at least one [[load]] to compare under, found none"),
    ] {
        let arguments = [&["compare"], arguments].concat();
        refusals.expect(&[("scene.toml", file.as_bytes())], &arguments, message);
    }
    refusals.finish();
}

#[test]
fn sampled_fits_and_laws() {
    let shapes = "shapes = { families = [\"uniaxial\"], count = 30, held_out = 10, stretch = 0.2 }";
    let in_fit = |problem: &str| format!("scene.toml: fit[0].{problem}");
    let edits: Vec<(&str, String, String)> = [
        ("law = \"neo-hookean\"\n", "", "newton: belongs to a material with a \"law\", found one without"),
        ("steps = 2", "steps = 0", "newton.steps: expected a number from 1 to 100000, found 0"),
        ("steps = 2", "iterations = 0", "newton.iterations: expected a number above 0, found 0"),
        ("steps = 2", "tolerance = 2", "newton.tolerance: expected a share above 0 and below 1, found 2"),
        (
            "law = \"neo-hookean\"",
            "law = \"rubber\"",
            "material.law: expected one of corotational, fibre, fung, mooney-rivlin, neo-hookean-isochoric, neo-hookean, \
             ogden, st-venant-kirchhoff, yeoh, or a path that ends in .toml, found \"rubber\"",
        ),
    ]
    .map(|(from, to, problem)| (from, to.to_string(), format!("scene.toml: {problem}")))
    .into_iter()
    .chain(
        [
            ("starts = 2", "starts = 0", "starts: expected at least one start, found 0"),
            ("starts = 2", "balance = 0.5", "balance: does not go with the objective \"sampled\""),
            ("starts = 2", "solver = \"nelder-mead\"", "solver: does not go with the objective \"sampled\""),
            ("starts = 2", "topology = true", "topology: does not go with the objective \"sampled\""),
            (
                "starts = 2",
                "weight = \"modal\"",
                "weight: expected \"relative\" or \"none\" with the objective \"sampled\", found \"modal\"",
            ),
            ("starts = 2", "higher = -1", "higher: expected a scale from 0 to 1, found -1"),
            (
                "starts = 2",
                "norm = \"3\"",
                "norm: expected one of \"2\", \"1\", \"max\", \"huber\", found \"3\"",
            ),
            ("starts = 2", "nonnegative = true\nhuber = 0.5", "huber: belongs to the norm \"huber\""),
            (
                "bounds = { a = [0, 10] }\nstarts = 2",
                "bounds = { a = [-2, -1] }\nnonnegative = true",
                "bounds.a: expected a lower and an upper bound that is not below zero, found -2 to -1",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "\"Linear\"",
                "force: expected a law of s or c, such as \"k1*s + k3*s^3\", found \"Linear\"",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "{ edge = \"free-rest\" }",
                "force.edge: \"free-rest\" is for all groups alike: force = \"free-rest\"",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "\"k*s\"",
                "starts: belongs to a law of force that is not linear in its parameters",
            ),
            (
                "objective = \"sampled\"",
                "objective = \"sampled\"\nsprings = []",
                "springs: expected at least one spring to fit, found none",
            ),
            (
                shapes,
                "shapes = { loads = [\"pull\"], stretch = 0.1 }",
                "shapes.stretch: belongs to \"families\": shapes of a list have their own",
            ),
            (shapes, "shapes = { count = 100000000000 }", "shapes: expected at most 1000000000 shapes, found 100000000000"),
            ("starts = 2", "huber = 0.5", "huber: belongs to the norm \"huber\""),
            (
                "starts = 2",
                "norm = \"1\"",
                "norm: expected the 2-norm for a law with bounds or that is not linear in its parameters, found One",
            ),
            (
                "a = [0, 10]",
                "a = [10, 0]",
                "bounds.a: expected a lower and an upper bound, found 10 to 0",
            ),
            ("a = [0, 10]", "a = 3", "bounds.a: expected two numbers such as [0, 10], found 3"),
            ("a = [0, 10]", "b = [0, 1]", "bounds: expected parameters of the law, k, a, found \"b\""),
            (
                "\"k*(exp(a*s) - 1)\"",
                "\"3*s\"",
                "force: expected a law with parameters to fit, such as \"k1*s + k3*s^3\", found 3*s",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "3",
                "force: expected \"linear\", \"free-rest\", a law in quotes, or a table of laws by group, found integer",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "{ edge = \"k*exp(a*s)\", bulk = \"a*s\" }",
                "force: expected groups of the fit's springs, edge, found \"bulk\"",
            ),
            (
                "\"k*(exp(a*s) - 1)\"",
                "{ edge = \"k*s*\" }",
                "force.edge: column 5: expected a number, a name or '(', found the end in \"k*s*\"",
            ),
            (
                shapes,
                "shapes = { families = [\"uniaxal\"] }",
                "shapes.families: expected some of uniaxial, equibiaxial, simple-shear, volumetric, torsion, bending, \
                 gradients, found \"uniaxal\"",
            ),
            (
                shapes,
                "shapes = { families = [\"uniaxial\"], loads = [\"pull\"] }",
                "shapes: expected one of \"families\", \"gradients\", \"loads\", found more",
            ),
            (shapes, "shapes = { count = 0 }", "shapes: expected at least one shape, found 0"),
            (
                shapes,
                "shapes = { stretch = \"much\" }",
                "shapes.stretch: expected a share such as 0.3, or a range such as [-0.1, 0.4], found \"much\"",
            ),
            (shapes, "shapes = { stretch = [0.5, 0] }", "stretch: expected a range within -2 to 2, found 0.5 to 0"),
            (shapes, "shapes = { perturbation = 9 }", "perturbation: expected a share from 0 to 2, found 9"),
            (shapes, "shapes = { loads = [\"push\"] }", "shapes.loads: expected loads of the scene (pull), found \"push\""),
        ]
        .map(|(from, to, problem)| (from, to.to_string(), in_fit(problem))),
    )
    .collect();
    let edits: Vec<Edit> = edits.iter().map(|(from, to, message)| (*from, to.as_str(), message.as_str())).collect();
    refuses_edits(SOFT, &edits);
    let mut refusals = Refusals::default();
    let list = edited(SOFT, shapes, "shapes = { gradients = \"list.csv\" }");
    refusals.expect_of_scene(&list, "list.csv: cannot be read: No such file or directory (os error 2)");
    for (text, message) in [
        (
            "1 0 0 0 1 0 0 0\n",
            "scene.toml: fit[0].gradients: expected deformation gradients of 9 numbers, found 8 numbers in all",
        ),
        ("1 0 0\n0 one 0 0 0 1\n", "list.csv:2: expected finite numbers, found one"),
    ] {
        let files: [(&str, &[u8]); 2] = [("scene.toml", list.as_bytes()), ("list.csv", text.as_bytes())];
        refusals.expect(&files, &["run", "scene.toml"], message);
    }
    let plain = edited(BRICK, "objective = \"modal\"", "objective = \"modal\"\nforce = \"k*s\"");
    refusals.expect_of_scene(
        &plain,
        "scene.toml: fit[0].force: belongs to the objective \"sampled\", found with \"modal\"",
    );
    let lawless = edited(BRICK, "objective = \"modal\"", "objective = \"sampled\"");
    refusals.expect_of_scene(
        &lawless,
        "scene.toml: material.law: expected the energy whose forces fit[0] samples, such as \"neo-hookean\", found none",
    );
    refusals.finish();
}

#[test]
fn whole_object_fits() {
    let fit = "objective = \"modal\"";
    let edits = [
        (
            "objective = \"whole\"\nloads = []",
            "fit[0].loads: expected names of loads of the scene to fit, or \"made\", found none",
        ),
        (
            "objective = \"whole\"\nloads = [\"push\"]",
            "fit[0].loads: expected loads of the scene (load 1), found \"push\"",
        ),
        (
            "objective = \"whole\"\nvalidate = [\"push\"]",
            "fit[0].validate: expected loads of the scene (load 1), found \"push\"",
        ),
        (
            "objective = \"whole\"\nvalidate = []",
            "fit[0].validate: expected names of loads of the scene, \"made\", or \"leave-one-out\" alone, found none",
        ),
        (
            "objective = \"whole\"\nloads = [\"load 1\"]\nvalidate = [\"load 1\"]",
            "fit[0].validate: expected loads that are not fitted, found \"load 1\"",
        ),
        (
            "objective = \"whole\"\nloads = [\"load 1\"]\nvalidate = [\"leave-one-out\"]",
            "fit[0].validate: expected at least two loads to leave one out, found 1",
        ),
        (
            "objective = \"whole\"\nvalidate = [\"made\"]\nregularization = 1e-3",
            "fit[0].regularization: is chosen by \"validate\" or given, found both",
        ),
        (
            "objective = \"whole\"\nregularization = -1",
            "fit[0].regularization: expected a number of at least 0, found -1",
        ),
        (
            "objective = \"whole\"\nstart = \"rest\"",
            "fit[0].start: expected one of frobenius, offdiag, modal, spectral, divergence, sampled, equal, found \"rest\"",
        ),
        (
            "objective = \"whole\"\nstart = [\"offdiag\", \"offdiag\"]",
            "fit[0].start: expected an objective or \"equal\", or a list of them, each once",
        ),
        (
            "objective = \"whole\"\nstart = 3",
            "fit[0].start: expected an objective or \"equal\", or a list of them, each once",
        ),
        (
            "objective = \"whole\"\nrange = 0.5",
            "fit[0].range: expected a factor of at least 1 between constants, found 0.5",
        ),
        ("objective = \"whole\"\niterations = 0", "fit[0].iterations: expected a number above 0, found 0"),
        (
            "objective = \"whole\"\nsolver = \"native\"",
            "fit[0].solver: expected \"gauss-newton\" or \"l-bfgs\" with the objective \"whole\", found \"native\"",
        ),
        (
            "objective = \"whole\"\nresidual = \"energy\"",
            "fit[0].residual: expected \"displacements\", \"forces\" or \"forces-first\", found \"energy\"",
        ),
        (
            "objective = \"whole\"\nunknowns = \"cell\"",
            "fit[0].unknowns: expected one of spring, group, region, element, found \"cell\"",
        ),
        ("objective = \"whole\"\nfrequencies = 3", "fit[0].frequencies: expected a density in [material], found none"),
        ("objective = \"whole\"\ntied = true", "fit[0].tied: does not go with the objective \"whole\""),
        ("objective = \"whole\"\ntopology = true", "fit[0].topology: does not go with the objective \"whole\""),
        ("objective = \"whole\"\nsparsity = 0.1", "fit[0].sparsity: does not go with the objective \"whole\""),
        ("objective = \"whole\"\nnonnegative = true", "fit[0].nonnegative: does not go with the objective \"whole\""),
        (
            "objective = \"whole\"\nloads = [\"load 1\", \"load 1\"]",
            "fit[0].loads: expected each load once, found \"load 1\" again",
        ),
        (
            "objective = \"whole\"\nstart = \"equal\"\nhigher = 0.1",
            "fit[0].higher: belongs to an objective, found with the start \"equal\"",
        ),
        (
            "objective = \"whole\"\nresidual = \"forces\"\nfrequencies = 2",
            "fit[0].frequencies: does not go with residual = \"forces\", which has no displacements",
        ),
        (
            "objective = \"whole\"\nrange = 10\nregularization = 1",
            "fit[0].range: limits what \"validate\" may choose, found with a regularization that is given",
        ),
        (
            "objective = \"modal\"\nfrequencies = 3",
            "fit[0].frequencies: belongs to the objective \"whole\", found with \"modal\"",
        ),
        (
            "objective = \"modal\"\nloads = [\"load 1\"]",
            "fit[0].loads: belongs to the objective \"whole\", found with \"modal\"",
        ),
    ];
    let messages = edits.map(|(_, message)| format!("scene.toml: {message}"));
    let edits: Vec<Edit> = edits.iter().zip(&messages).map(|((to, _), message)| (fit, *to, message.as_str())).collect();
    refuses_edits(BRICK, &edits);
    let mut refusals = Refusals::default();
    let whole = edited(BRICK, fit, "objective = \"whole\"");
    let expect = |refusals: &mut Refusals, scene: &str, message: &str| {
        refusals.expect_of_scene(scene, &format!("scene.toml: fit[0].{message}"));
    };
    expect(
        &mut refusals,
        &edited(&whole, "poisson = 0.3", "poisson = 0.3\nlaw = \"neo-hookean\""),
        "loads: expected loads of the scene, where the material has a law, found \"made\"",
    );
    let free = edited(&whole, "[[fix]]\ngroup = \"zmin\"\n", "");
    let held = "[[load]]\nwhere = \"z < 0.1\"\ndisplacement = [0, 0, 0]";
    let by_load = edited(&free, "[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 1]", held);
    expect(
        &mut refusals,
        &by_load,
        "loads: expected supports in [[fix]] that hold every body, whatever the loads hold, found 6 rigid motions left \
         to one of 8 points",
    );
    let still = edited(&whole, "traction = [0, 0, 1]", "traction = [0, 0, 0]");
    expect(
        &mut refusals,
        &edited(&still, "objective = \"whole\"", "objective = \"whole\"\nloads = [\"load 1\"]"),
        "loads: expected loads under which free points are known to move, found \"load 1\"",
    );
    refusals.expect_of_scene(
        &edited(&whole, "traction = [0, 0, 1]", "traction = [0, 0, 1]\nname = \"made\""),
        "scene.toml: load[0].name: expected a name other than made, leave-one-out, found \"made\"",
    );
    let counted = edited(&whole, "poisson = 0.3", "poisson = 0.3\ndensity = 1000");
    expect(
        &mut refusals,
        &edited(&counted, "objective = \"whole\"", "objective = \"whole\"\nfrequencies = 13"),
        "frequencies: expected at most 12, the free degrees of freedom, found 13",
    );
    refusals.finish();
}

#[test]
fn loads_that_vary_and_measurements() {
    let load = "traction = [0, 0, 1]";
    let edits = [
        (
            "traction = [0, 0, \"x*\"]",
            "load[0].traction[2]: column 3: expected a number, a name or '(', found the end in \"x*\"",
        ),
        ("traction = [0, 0, \"w\"]", "load[0].traction[2]: expected one of x, y, z, found the name \"w\" in \"w\""),
        ("traction = [0, 0, \"1/(z - 1)\"]", "load[0]: is not finite everywhere on the selected part"),
    ];
    let mut refusals = Refusals::default();
    for (to, message) in edits {
        refusals.expect_of_scene(&edited(BRICK, load, to), &format!("scene.toml: {message}"));
    }
    let measured = edited(BRICK, load, "traction = [0, 0, 1]\nmeasured = { file = \"u.csv\" }");
    refusals.expect_of_scene(&measured, "u.csv: cannot be read: No such file or directory (os error 2)");
    refusals.expect_of_scene(
        &edited(PLATE, "traction = [0, 1]", "traction = [0, \"z\"]"),
        "scene.toml: load[0].traction[1]: expected an expression of x and y in a plane mesh, found z",
    );
    refusals.finish();
}
