//! Keys, types, materials and boxes of scenes.

use super::inputs::{BRICK, FROM_FILES, PLATE, edited};
use super::refusals::{Refusals, refuses_edits};

#[test]
fn keys_and_types() {
    refuses_edits(
        BRICK,
        &[
            ("poisson = 0.3", "poison = 0.3", "5: material.poison", "\"poisson\""),
            ("[material]", "[materials]", "3: materials", "\"material\""),
            ("group = \"zmax\"", "groop = \"zmax\"", "11: load[0].groop", "\"group\""),
            ("[material]\nyoung = 10e3\npoisson = 0.3\n", "", "1", "missing field \"material\""),
            ("young = 10e3\n", "", "3: material", "missing field \"young\""),
            ("objective = \"modal\"\n", "", "6: fit[0]", "missing field \"objective\""),
            ("[[fit]]\nobjective = \"modal\"\n", "", "fit", "found none"),
            ("young = 10e3", "young = true", "4: material.young", "boolean \"true\""),
            ("objective = \"modal\"", "objective = 3", "7: fit[0].objective", "expected a string"),
            ("objective = \"modal\"", "objective = \"modal\"\ntied = 1", "8: fit[0].tied", "expected a boolean"),
            ("young = 10e3", "young = 10e3\nyoung = 10e3", "5", "duplicate key"),
            ("[mesh]", "[mesh", "1", "expected TOML"),
        ],
    );
}

#[test]
fn material() {
    let mut refusals = Refusals::default();
    for (given, found) in
        [("0.5", "0.5"), ("0.6", "0.6"), ("-1", "-1"), ("-1.5", "-1.5"), ("nan", "NaN"), ("inf", "inf")]
    {
        for scene in [BRICK, PLATE] {
            let scene = edited(scene, "poisson = 0.3", &format!("poisson = {given}"));
            refusals.expect_of_scene(&scene, "material.poisson", &format!("found {found}"));
        }
    }
    for (given, found) in
        [("0", "0"), ("-1", "-1"), ("nan", "NaN"), ("inf", "inf"), ("\"-1 kPa\"", "-1000"), ("\"inf\"", "inf")]
    {
        let scene = edited(BRICK, "young = 10e3", &format!("young = {given}"));
        refusals.expect_of_scene(&scene, "material.young", &format!("Pa, found {found}"));
    }
    for (given, found) in [("0", "0"), ("-1", "-1"), ("nan", "NaN"), ("inf", "inf")] {
        let scene = edited(BRICK, "poisson = 0.3", &format!("poisson = 0.3\ndensity = {given}"));
        refusals.expect_of_scene(&scene, "material.density", &format!("kg/m³, found {found}"));
        let scene = edited(PLATE, "thickness = 0.1", &format!("thickness = {given}"));
        refusals.expect_of_scene(&scene, "material.thickness", &format!("m, found {found}"));
    }
    refusals.expect_of_edits(
        BRICK,
        &[
            ("young = 10e3", "young = \"10 lbf\"", "4: material.young", "found \"10 lbf\""),
            ("poisson = 0.3", "poisson = 0.3\nplane = \"stress\"", "material.plane", "solid"),
            ("poisson = 0.3", "poisson = 0.3\nthickness = 0.1", "material.thickness", "solid"),
        ],
    );
    refusals.expect_of_edits(PLATE, &[("\"strain\"", "\"bent\"", "6: material.plane", "\"bent\"")]);
    refusals.finish();
}

#[test]
fn quantities_out_of_range() {
    refuses_edits(
        BRICK,
        &[
            ("10e3", "1e-160", "material.young", "found 1e-160"),
            ("10e3", "1e160", "material.young", "found 1e160"),
            ("[mesh]", "[mesh]\nscale = 1e-100", "mesh.scale", "found 1e-100"),
        ],
    );
}

#[test]
fn boxes() {
    let size = "size = [1, 1, 1]";
    let cells = "cells = [1, 1, 1]";
    refuses_edits(
        BRICK,
        &[
            ("\"tet4\"", "\"tet5\"", "mesh.box.element", "found \"tet5\""),
            (size, "size = [0, 1, 1]", "mesh.box.size", "found 0"),
            (size, "size = [-1, 1, 1]", "mesh.box.size", "found -1"),
            (size, "size = [nan, 1, 1]", "mesh.box.size", "found NaN"),
            (size, "size = [1, 1]", "mesh.box.size", "3 entries for tet4, found 2"),
            (size, "size = [1e308, 1e308, 1e308]", "mesh.box.size", "found 1e308"),
            (cells, "cells = [0, 1, 1]", "mesh.box.cells", "found [0, 1, 1]"),
            (
                cells,
                "cells = [9223372036854775807, 9, 9]",
                "mesh.box.cells",
                "2000000 cells in all, found [9223372036854775807, 9, 9]",
            ),
            (cells, "cells = []", "mesh.box.cells", "3 entries for tet4, found 0"),
            (cells, "cells = [1, 1, 1], origin = [0, inf, 0]", "mesh.box.origin", "found inf"),
            (cells, "cells = [1, 1, 1], origin = [0]", "mesh.box.origin", "3 entries for tet4, found 1"),
            ("[mesh]", "[mesh]\nscale = -1", "mesh.scale", "found -1"),
            ("[mesh]", "[mesh]\nscale = nan", "mesh.scale", "found NaN"),
            ("[mesh]", "[mesh]\nscale = 1e300", "mesh.scale", "found 1e300"),
            ("[mesh]", "[mesh]\nfile = \"mesh.msh\"", "mesh", "found file and box"),
            ("box = { element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] }\n", "", "mesh", "found none"),
        ],
    );
}

#[test]
fn lengths_near_the_largest_number() {
    refuses_edits(BRICK, &[("size = [1, 1, 1]", "size = [1e308, 1, 1]", "mesh.box.size", "found 1e308")]);
}

#[test]
fn messages_in_the_words_of_the_file() {
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(
        BRICK,
        &[
            ("poisson = 0.3", "poisson = \"soft\"", "5: material.poisson", "\"soft\", expected a number"),
            ("cells = [1, 1, 1]", "cells = [1, 1, -1]", "2: mesh.box.cells[2]", "\"-1\", expected a whole number"),
            (
                "cells = [1, 1, 1]",
                "cells = [1, 1, 18446744073709551616]",
                "2: mesh.box.cells[2]",
                "expected a whole number",
            ),
            ("[[fit]]", "[fit]", "6: fit", "expected a list"),
            ("size = [1, 1, 1]", "size = [1e-8, 1, 1]", "mesh", "not positive definite"),
        ],
    );
    refusals.expect_of_scene(&edited(FROM_FILES, "own.toml", "tet9"), "mesh.elements[0]", "found \"tet9\"");
    refusals.finish();
}

#[test]
fn contents_that_are_not_scenes() {
    let mut refusals = Refusals::default();
    let latin: &[u8] = b"title = \"na\xefve\"";
    refusals.expect(&[("scene.toml", latin)], &["run", "scene.toml"], "scene.toml", "UTF-8");
    refusals.expect(&[("scene.toml", b"")], &["run", "scene.toml"], "scene.toml:1", "missing field \"mesh\"");
    let nested = "a = ".to_string() + &"[".repeat(100_000);
    refusals.expect_of_scene(&nested, "1", "expected TOML");
    let long = format!("{BRICK}# {}\n", "x".repeat(1_000_000));
    let words = format!("at most 1000000 bytes of TOML, found {}", long.len());
    refusals.expect_of_scene(&long, "", &words);
    refusals.finish();
}
