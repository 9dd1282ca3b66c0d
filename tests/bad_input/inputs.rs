//! Inputs without a fault, which the cases change in one place.

use super::refusals::run;

pub const BRICK: &str = r#"[mesh]
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

pub const PLATE: &str = r#"[mesh]
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
pub const SOFT: &str = r#"[mesh]
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
pub const FROM_FILES: &str = r#"[mesh]
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

pub const TETRAHEDRON: &str = include_str!("../../elements/tet4.toml");
pub const UNIT_NODES: [&str; 4] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
pub const CUBE_NODES: [&str; 8] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "1 0 1", "1 1 1", "0 1 1"];

/// The text with a part changed that it has once.
pub fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from:?} in {text}");
    text.replace(from, to)
}

/// An MSH 2.2 file; a cell is its type, tags and nodes.
pub fn msh(nodes: &[&str], cells: &[&str]) -> String {
    let numbered = |lines: &[&str]| {
        let lines: String = lines.iter().enumerate().map(|(i, line)| format!("{} {line}\n", i + 1)).collect();
        format!("{}\n{lines}", lines.matches('\n').count())
    };
    let (nodes, cells) = (numbered(nodes), numbered(cells));
    format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n{cells}$EndElements\n")
}

pub fn unit_mesh() -> String {
    msh(&UNIT_NODES, &["4 2 0 1 1 2 3 4"])
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
    let soft = ["run", "soft.toml"];
    for arguments in [&["run", "brick.toml"][..], &["run", "plate.toml"], &["run", "files.toml"], &soft, &fit] {
        let seen = run(&files, arguments);
        assert_eq!(seen.code, Some(0), "{arguments:?}");
        assert!(seen.stderr.lines().all(|line| line.starts_with("note: ")), "{arguments:?}: {}", seen.stderr);
        assert!(seen.changed, "{arguments:?} has written nothing");
    }
}
