//! A dozen lines to the letter, one of each sort.

use super::inputs::{BRICK, FROM_FILES, TETRAHEDRON, UNIT_NODES, edited, msh, unit_mesh};
use super::refusals::run;

#[cfg(unix)]
#[test]
fn whole_messages_read_well() {
    let scene = |from: &str, to: &str| [edited(BRICK, from, to), TETRAHEDRON.into(), unit_mesh()];
    let element = |from: &str, to: &str| [FROM_FILES.into(), edited(TETRAHEDRON, from, to), unit_mesh()];
    let mesh = |mesh: String| [FROM_FILES.into(), TETRAHEDRON.into(), mesh];
    let flat = [&UNIT_NODES[..3], &["1 1 0"]].concat();
    let mut wrong = Vec::new();
    for ([scene, element, mesh], line) in [
        (
            scene("poisson = 0.3", "poison = 0.3"),
            "scene.toml:5: material.poison: unknown field \"poison\", expected one of \"name\", \"group\", \"where\", \
             \"young\", \"poisson\", \"shear_modulus\", \"bulk_modulus\", \"lambda\", \"orthotropic\", \"transversely-isotropic\", \"cubic\", \"stiffness\", \"axes\", \"plane\", \
             \"thickness\", \"bending\", \"rest\", \"flexural\", \"torsional\", \"area\", \"density\", \"relaxation\", \"law\", \"parameters\", \"fibre\"; did you mean \"poisson\"?",
        ),
        (scene("young = 10e3\n", ""), "scene.toml:3: material: missing field \"young\""),
        (scene("[mesh]", "[mesh"), "scene.toml:1: expected TOML: unclosed table, expected \"]\""),
        (
            scene("\"modal\"", "\"modal\"\nhigher = 0"),
            "scene.toml:8: fit[0].higher: expected a scale above 0 and at most 1, found 0",
        ),
        (
            scene("\"modal\"", "\"frobenius\"\nhigher = 0.1"),
            "scene.toml:8: fit[0].higher: belongs to the objective \"modal\", found with \"frobenius\"",
        ),
        (
            scene("group = \"zmin\"", "where = \"z <\""),
            "scene.toml:9: fix[0].where: column 4: expected a number, a name or '(', found the end in \"z <\"",
        ),
        (
            scene("[[fix]]\ngroup = \"zmin\"\n", ""),
            "scene.toml: fix: expected supports that hold every body, found 6 rigid motions left to the body of 8 \
             points at [0.0, 0.0, 0.0] m under load \"load 1\"",
        ),
        (
            scene("[0, 0, 1]", "[0, 1]"),
            "scene.toml:12: load[0].traction: expected 3 entries for a mesh of dimension 3, found 2",
        ),
        (
            scene("traction = [0, 0, 1]", "traction = [0, 0, 1]\nmeasured = { file = \"u.csv\" }"),
            "u.csv: cannot be read: No such file or directory (os error 2)",
        ),
        (element("\"xi\" }", "\"2*xi\" }"), "own.toml:9: nodes[1].shape: is 2 at nodes[1], expected 1"),
        (
            mesh(msh(&flat, &["4 2 0 1 1 2 3 4"])),
            "mesh.msh: tet4 cell 1 at [0.0, 0.0, 0.0] m: the element has no volume (its Jacobian vanishes); below = \"skip\" leaves the cell out",
        ),
        (
            mesh(msh(&UNIT_NODES, &["4 2 0 1 1 2 3 5"])),
            "mesh.msh:13: $Elements: element 1 names node 5, which $Nodes lacks",
        ),
    ] {
        let files: [(&str, &[u8]); 3] =
            [("scene.toml", scene.as_bytes()), ("own.toml", element.as_bytes()), ("mesh.msh", mesh.as_bytes())];
        let seen = run(&files, &["run", "scene.toml"]);
        if (seen.code, seen.stderr.as_str()) != (Some(2), format!("error: {line}\n").as_str()) {
            wrong.push(format!("expected {line:?}\n found   {:?}, code {:?}", seen.stderr, seen.code));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
