//! Supports and loads of scenes, and the parts of the mesh that they select.

use super::inputs::{BRICK, PLATE, TETRAHEDRON, UNIT_NODES, edited, msh};
use super::refusals::Refusals;

#[test]
fn supports() {
    let zmin = "group = \"zmin\"";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            ("[[fix]]\ngroup = \"zmin\"\n", "", "fix", "6 rigid motions"),
            (zmin, "group = \"zmin\"\naxes = [\"z\"]", "fix", "3 rigid motions"),
            (zmin, "group = \"zmin\"\naxes = [\"z\", \"z\"]", "fix", "3 rigid motions"),
            (zmin, "where = \"x + y + z == 0\"", "fix", "3 rigid motions"),
            (zmin, "where = \"x + y == 0\"", "fix", "1 rigid motion"),
            (zmin, "where = \"z > 5\"", "fix[0]", "no points"),
            (zmin, "group = \"bottom\"", "fix[0].group", "found \"bottom\""),
            (zmin, "group = \"zmin\"\nwhere = \"z == 0\"", "fix[0]", "found both"),
            (zmin, "", "fix[0]", "found neither"),
            (zmin, "group = \"zmin\"\naxes = [\"w\"]", "fix[0].axes", "found [\"w\"]"),
            (zmin, "group = \"zmin\"\naxes = []", "fix[0].axes", "found []"),
            (zmin, "where = \"z\"", "fix[0].where", "expected a condition"),
            (zmin, "where = \"z <\"", "fix[0].where", "column 4"),
            (zmin, "where = \"r < 1\"", "fix[0].where", "\"r\" in \"r < 1\""),
            (zmin, "where = \"z < 1/0\"", "fix[0].where", "division by zero"),
        ],
    );
    refusals.expect_of_edits(
        PLATE,
        &[
            ("group = \"ymin\"", "group = \"ymin\"\naxes = [\"z\"]", "fix[0].axes", "found \"z\""),
            ("group = \"ymin\"", "where = \"z < 1\"", "fix[0].where", "\"z\" in \"z < 1\""),
        ],
    );
    let apart = [&UNIT_NODES[..], &["5 5 5", "6 5 5", "5 6 5", "5 5 6"]].concat();
    refusals.expect_of_files(
        TETRAHEDRON,
        &msh(&apart, &["4 2 0 1 1 2 3 4", "4 2 0 1 5 6 7 8"]),
        "scene.toml: fix",
        "4 points at [5.0, 5.0, 5.0] m",
    );
    refusals.finish();
}

#[test]
fn chains_of_operators() {
    let mut refusals = Refusals::default();
    for chain in ["!", "0+", "0-", "1*", "1/"] {
        let condition = format!("{}z < 1", chain.repeat(9_990 / chain.len()));
        let found = 9_990 / chain.len() + 1;
        refusals.expect_of_scene(
            &edited(BRICK, "group = \"zmin\"", &format!("where = \"{condition}\"")),
            "fix[0].where",
            &format!("1000 operators, found {found}"),
        );
    }
    refusals.finish();
}

#[test]
fn loads() {
    let (zmax, traction) = ("group = \"zmax\"", "traction = [0, 0, 1]");
    let load = "group = \"zmax\"\ntraction = [0, 0, 1]";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            ("\"zmax\"", "\"top\"", "load[0].group", "found \"top\""),
            (zmax, "where = \"z > 5\"", "load[0]", "no sides"),
            (zmax, "where = \"x == y && y == z\"", "load[0]", "no sides"),
            (load, "where = \"z > 5\"\nforce = [0, 0, 1]", "load[0]", "no points"),
            (load, "group = \"zmax\"\nbody = [0, 0, 1]", "load[0]", "no cells"),
            (load, "where = \"z > 5\"\ndisplacement = [0, 0, 1]", "load[0]", "no points"),
            ("[0, 0, 1]", "[0, 1]", "load[0].traction", "3 entries for a mesh of dimension 3, found 2"),
            ("[0, 0, 1]", "[]", "load[0].traction", "found 0"),
            (traction, "displacement = [0, 0, 0, 1]", "load[0].displacement", "found 4"),
            ("[0, 0, 1]", "[0, 0, nan]", "load[0].traction", "found NaN"),
            (traction, "displacement = [0, 0, \"held\"]", "12: load[0].displacement[2]", "\"held\""),
            (traction, "traction = [0, 0, 1]\nforce = [0, 0, 1]", "load[0]", "found 2"),
            (traction, "", "load[0]", "found 0"),
            (zmax, "group = \"zmax\"\nwhere = \"z > 0\"", "load[0]", "found both"),
            ("group = \"zmax\"\n", "", "load[0]", "found neither"),
            (
                "[[load]]",
                "[[load]]\nname = \"load 2\"\ngroup = \"zmax\"\nforce = [0, 0, 1]\n[[load]]",
                "load[1].name",
                "found \"load 2\" again",
            ),
        ],
    );
    refusals.expect_of_edits(PLATE, &[("[0, 1]\n", "[0, 1, 0]\n", "load[0].traction", "found 3")]);
    refusals.finish();
}

#[test]
fn loads_that_vary_and_measurements() {
    let load = "traction = [0, 0, 1]";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            (load, "traction = [0, 0, \"x*\"]", "load[0].traction[2]", "column 3"),
            (load, "traction = [0, 0, \"w\"]", "load[0].traction[2]", "name \"w\" in \"w\""),
            (load, "traction = [0, 0, \"1/(z - 1)\"]", "load[0]", "not finite"),
            // Finite at every quadrature point, and without bound at a node.
            (load, "traction = [0, 0, \"1/x\"]", "load[0]", "found inf along z at [0.0, 0.0, 1.0] m"),
            (load, "traction = [\"sqrt(x - 1e-9)\", 0, 0]", "load[0]", "found NaN along x at [0.0, 0.0, 1.0] m"),
            ("group = \"zmax\"\ntraction = [0, 0, 1]", "body = [0, \"1/x\", 0]", "load[0]", "found inf along y"),
            (load, "displacement = [0, \"1/x\", 0]", "load[0]", "found inf along y at [0.0, 1.0, 1.0] m"),
            (load, "displacement = [0, \"1e40*x\", 0]", "load[0]", "at most 1e30 in size, found 1e40"),
            (load, "displacement = [0, 1e40, \"x\"]", "load[0].displacement", "at most 1e30 m in size"),
            (load, "displacement = [0, \"x*\", \"free\"]", "load[0].displacement[1]", "column 3"),
            (load, "displacement = [0, \"0.1*w\", 0]", "load[0].displacement[1]", "name \"w\""),
        ],
    );
    refusals.expect_of_edits(
        PLATE,
        &[
            ("traction = [0, 1]", "traction = [0, \"z\"]", "load[0].traction[1]", "found z"),
            ("traction = [0, 1]", "displacement = [\"free\", \"z\"]", "load[0].displacement[1]", "found z"),
        ],
    );
    let measured = edited(BRICK, load, "traction = [0, 0, 1]\nmeasured = { file = \"u.csv\" }");
    refusals.expect_with(&measured, &[], "u.csv", "cannot be read");
    refusals.finish();
}

/// What a support holds is not moved, and no force acts on it alone.
#[test]
fn loads_that_contradict_supports() {
    let load = "group = \"zmax\"\ntraction = [0, 0, 1]";
    let all = "group = \"zmin\"\n[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 1]";
    let held = "which [[fix]] holds";
    let moved = "group = \"zmin\"\ndisplacement = [0, \"free\", 1e-3]";
    let edge = "where = \"x == 0\"\ndisplacement = [1e-3, 0, 0]";
    let still = "nothing that can move";
    let free = "group = \"zmax\"\ndisplacement = [\"free\", \"free\", \"free\"]";
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            (load, moved, "load[0].displacement[2]", held),
            (load, edge, "load[0].displacement[0]", "moves point 0 at [0.0, 0.0, 0.0] m along x by 0.001 m"),
            (
                load,
                "where = \"x == 0\"\ndisplacement = [\"0.1*(z - 1)\", \"free\", \"free\"]",
                "load[0].displacement[0]",
                "moves point 0 at [0.0, 0.0, 0.0] m along x by -0.1 m",
            ),
            (load, "group = \"zmin\"\ntraction = [0, 0, 1]", "load[0].traction", still),
            (load, free, "load[0].displacement", "a direction that is moved"),
            (load, "group = \"zmin\"\nforce = [1, 0, 0]", "load[0].force", still),
            (all, "where = \"z >= 0\"\n[[load]]\nbody = [1, 0, 0]", "load[0].body", still),
        ],
    );
    refusals.finish();
}
