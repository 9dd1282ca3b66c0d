//! Mesh files: their cells, damage to them, and files of another kind.

use super::inputs::{CUBE_NODES, FROM_FILES, TETRAHEDRON, UNIT_NODES, edited, msh, unit_mesh};
use super::refusals::Refusals;
use std::fs;

const WEDGE_NODES: [&str; 6] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1", "1 0 1", "0 1 1"];

/// The last is on the side of the others where the first is.
const FOLDED_NODES: [&str; 5] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1", "0.1 0.1 0.1"];

/// Without the element file.
fn scene_of(mesh: &str) -> String {
    edited(&edited(FROM_FILES, "mesh.msh", mesh), "elements = [\"own.toml\"]\n", "")
}

#[test]
fn meshes() {
    let tetrahedron = ["4 2 0 1 1 2 3 4"];
    let first_tetrahedron = "mesh.msh: tet4 cell 1 at [0.0, 0.0, 0.0] m";
    let first_brick = "mesh.msh: hex8 cell 1 at [0.0, 0.0, 0.0] m";
    let with_last = |at: &'static str| [&UNIT_NODES[..3], &[at]].concat();
    let mut refusals = Refusals::default();
    for (mesh, place, words) in [
        (
            msh(&WEDGE_NODES, &["14 2 0 1 1 2 3 4 5 6 1 2 3 4 5 6 1 2"]),
            "mesh.msh: cells",
            "found 1 cells of Gmsh type 14 with 14 nodes",
        ),
        (msh(&with_last("1 1 0"), &tetrahedron), first_tetrahedron, "no volume"),
        (msh(&UNIT_NODES, &["4 2 0 1 1 2 3 3"]), first_tetrahedron, "twice"),
        (
            msh(&CUBE_NODES, &["5 2 0 1 1 3 2 4 5 6 7 8"]),
            first_brick,
            "from 1.138e-1 down to -3.050e-2 at quadrature point 1",
        ),
        (msh(&with_last("0 0 nan"), &tetrahedron), "mesh.msh: node 4", "found (0, 0, NaN)"),
        (msh(&with_last("0 0 1e999"), &tetrahedron), "mesh.msh: node 4", "found (0, 0, inf)"),
        (msh(&UNIT_NODES, &["4 2 0 1 1 2 3 5"]), "mesh.msh:13: $Elements", "element 1 names node 5"),
        (
            msh(&UNIT_NODES, &["4 2 0 1 1 2 3 4", "4 2 0 2 4 2 1 3"]),
            "mesh.msh: cells",
            "found 1 of 2 that has the nodes of another, or nodes at the same places: tet4 cell 2",
        ),
        (
            msh(&FOLDED_NODES, &["4 2 0 1 1 2 3 4", "4 2 0 1 2 3 4 5"]),
            "mesh.msh: cells",
            "found 1 of 2 folded over their neighbours: tet4 cell",
        ),
        (msh(&UNIT_NODES, &["2 2 0 1 1 2 3", "2 2 0 1 1 2 4"]), "scene.toml: material.thickness", "found none"),
        (msh(&UNIT_NODES, &["1 2 0 1 1 2"]), "scene.toml: fix[0].where", "found the name \"z\" in \"z == 0\""),
        (msh(&UNIT_NODES, &[]), "mesh.msh: cells", "found none"),
        (msh(&[], &[]), "mesh.msh: cells", "found none"),
        (String::new(), "mesh.msh", "ends before $MeshFormat"),
        (
            edited(&unit_mesh(), "$Nodes\n4", "$Nodes\n99999999999999"),
            "mesh.msh:10: $Nodes",
            "99999999999999 nodes, found 4",
        ),
        (edited(&unit_mesh(), "2.2 0 8", "3.0 0 8"), "mesh.msh:2: $MeshFormat", "found \"3.0\""),
    ] {
        refusals.expect_of_files(TETRAHEDRON, &mesh, place, words);
    }
    let six_nodes = edited(TETRAHEDRON, "{ type = 4 }", "{ type = 6 }");
    let mesh = msh(&WEDGE_NODES, &["6 2 0 1 1 2 3 4 5 6"]);
    refusals.expect_of_files(&six_nodes, &mesh, "mesh.msh: cells", "as in tet4, found 6 nodes in 3");
    refusals.finish();
}

#[test]
fn elements_in_many_groups() {
    let groups: Vec<String> = (1..=1001).map(|group| format!("4 2 {group} 1 1 2 3 4")).collect();
    let mesh = msh(&UNIT_NODES, &groups.iter().map(String::as_str).collect::<Vec<_>>());
    let mut refusals = Refusals::default();
    refusals.expect_of_files(TETRAHEDRON, &mesh, "mesh.msh:1013: $Elements", "at most 1000 physical groups");
    refusals.finish();
}

#[test]
fn truncated_meshes() {
    let mut refusals = Refusals::default();
    for (file, place, words) in [
        ("bar_22_ascii.msh", "", "ends inside $Nodes: expected 20 nodes, found 19"),
        ("bar_22_binary.msh", "", "ends inside $Elements: expected 22 elements, found 2"),
        ("bar_41_ascii.msh", "", "ends inside $Entities: expected 54 entities, found 42"),
        ("bar_41_binary.msh", "", "ends inside $Entities: expected 54 entities, found 44"),
        ("bar_ascii.vtu", ":71: Cells", "found the end of the file"),
        ("bar_base64.vtu", ":12: DataArray", "found the end of the file"),
        ("bar_appended_zlib.vtu", ":27: Cells", "found the end of the file"),
        ("bar_42_ascii.vtk", "", "ends inside CELLS: expected 16 cells, found 7"),
        ("bar_binary.vtk", "", "ends inside CELLS: expected 66 numbers, found 19"),
    ] {
        let whole = fs::read(crate::kit::place("tests/meshes").join(file)).unwrap();
        let (scene, half) = (scene_of(file), &whole[..whole.len() / 2]);
        let files: [(&str, &[u8]); 2] = [("scene.toml", scene.as_bytes()), (file, half)];
        refusals.expect(&files, &["run", "scene.toml"], &format!("{file}{place}"), words);
    }
    refusals.finish();
}

/// Also where the mesh is a surface that is filled.
#[test]
fn bodies_of_a_hundred_kilometres_whose_unit_is_missing() {
    let mut refusals = Refusals::default();
    let brick = crate::fills::brick([0.0; 3], [1.2e5, 2e4, 2e4], false, 0);
    let scene = scene_of("mesh.obj");
    let filled = scene.replacen("file = \"mesh.obj\"", "fill = { surface = \"mesh.obj\", cell = 1e4 }", 1);
    assert_ne!(scene, filled);
    let words = "expected the length of a mesh unit, such as mm, for a body longer than 100 km, found 1 m, and a body of 120 km";
    for scene in [scene, filled] {
        refusals.expect_with(&scene, &[("mesh.obj", &brick)], "scene.toml: mesh.scale", words);
    }
    let files: [(&str, &[u8]); 1] = [("mesh.obj", brick.as_bytes())];
    refusals.expect(&files, &["groups", "mesh.obj"], "mesh.obj: --scale", words);
    refusals.expect(&files, &["new", "mesh.obj", "--fill", "1e4"], "mesh.obj: --scale", words);
    refusals.finish();
}

#[test]
fn contents_of_another_kind() {
    let mut refusals = Refusals::default();
    for (name, content, words) in [
        ("mesh.med", "", "found .med; what converts it: gmsh mesh.med"),
        ("mesh", "", "expected a mesh ending in .msh, .vtu, "),
        ("mesh.h5", "", "found .h5; Gmsh and meshio convert many others"),
        ("mesh.vtu", "", "found none"),
        ("mesh.vtu", "<svg/>\n", "found <svg>"),
    ] {
        let place = match content {
            "" if name == "mesh.vtu" => "mesh.vtu: VTKFile",
            "" => name,
            _ => "mesh.vtu:1: VTKFile",
        };
        refusals.expect_with(&scene_of(name), &[(name, content)], place, words);
    }
    let scene = edited(FROM_FILES, "mesh.msh", "mesh.vtk");
    let others = [("own.toml", TETRAHEDRON), ("mesh.vtk", "# vtk Data")];
    refusals.expect_with(&scene, &others, "mesh.vtk:1", "found \"# vtk Data\"");
    refusals.finish();
}

#[cfg(unix)]
#[test]
fn missing_files_and_folders() {
    let scene: (&str, &[u8]) = ("scene.toml", FROM_FILES.as_bytes());
    let element: (&str, &[u8]) = ("own.toml", TETRAHEDRON.as_bytes());
    let mut refusals = Refusals::default();
    for (files, place, words) in [
        (&[][..], "scene.toml", "cannot be read: No such file or directory"),
        (&[("scene.toml/", &b""[..])], "scene.toml", "cannot be read: Is a directory"),
        (&[scene], "own.toml", "cannot be read: No such file or directory"),
        (&[scene, element], "mesh.msh", "cannot be read: No such file or directory"),
        (&[scene, element, ("mesh.msh/", b"")], "mesh.msh", "cannot be read: Is a directory"),
        (&[scene, ("own.toml/", b"")], "own.toml", "cannot be read: Is a directory"),
    ] {
        refusals.expect(files, &["run", "scene.toml"], place, words);
    }
    refusals.finish();
}
