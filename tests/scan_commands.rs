//! Scans on the command line and in scenes: what is refused, what is told, and the number of points.

use crate::fills::brick;
use crate::kit::{said, springfit, told};
use crate::scans::{Triangle, blob, box_with_dent, ring, source, sphere, unwelded};
use crate::shapes::{Random, loaded};
use springfit_mesh::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing};
use std::f64::consts::PI;
use std::fs;
use tempfile::TempDir;

fn off(triangles: &[Triangle]) -> String {
    let mut text = format!("OFF\n{} {} 0\n", 3 * triangles.len(), triangles.len());
    triangles.iter().flatten().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    (0..triangles.len()).for_each(|i| text += &format!("3 {} {} {}\n", 3 * i, 3 * i + 1, 3 * i + 2));
    text
}

/// A strip of twelve squares that is turned over once.
fn moebius() -> Vec<Triangle> {
    let at = |i: usize, side: f64| {
        let (u, v) = (2.0 * PI * i as f64 / 12.0, 0.3 * side);
        let (r, w) = if i == 12 { (1.0 - v, 0.0) } else { (1.0 + v * (u / 2.0).cos(), v * (u / 2.0).sin()) };
        if i == 12 { [r, 0.0, w] } else { [r * u.cos(), r * u.sin(), w] }
    };
    let square = |i: usize| {
        let [a, b, c, d] = [at(i, -1.0), at(i + 1, -1.0), at(i + 1, 1.0), at(i, 1.0)];
        [[a, b, c], [a, c, d]]
    };
    (0..12).flat_map(square).collect()
}

#[test]
fn what_cannot_be_repaired_is_one_line_with_a_place() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let whole = sphere();
    write(
        "dome.off",
        &off(&whole.iter().filter(|t| t.iter().map(|x| x[2]).sum::<f64>() > 0.0).copied().collect::<Vec<_>>()),
    );
    write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    write("strip.off", &off(&moebius()));
    write("unwelded.off", &off(&unwelded(&whole, 2e-7, &mut Random(1))));
    write("ball.off", &off(&whole));
    let image = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n\
                 CELL_DATA 2\nSCALARS label int 1\nLOOKUP_TABLE default\n1 2\n";
    write("image.vtk", image);
    let scene = "[material]\nyoung = 1e4\npoisson = 0.3\n[[fit]]\nobjective = \"exact\"\n";
    write("both.toml", &format!("[mesh]\nfill = {{ surface = \"ball.off\", cell = 1, points = 90 }}\n{scene}"));
    write("image.toml", &format!("[mesh]\nfill = {{ surface = \"image.vtk\", repair = true }}\n{scene}"));
    for (words, expected) in [
        (
            &["groups", "sheet.obj", "--points", "90", "--repair", "--scale", "mm"][..],
            "sheet.obj: surface: expected holes of at most 5 % of the surface, which a repair closes, found 1 of 50 %, the largest with 4 edges and 4 mm around, at (0, 0, 0) mm",
        ),
        (&["groups", "dome.off", "--points", "90", "--repair"], "dome.off: surface: expected holes of at most 5 %"),
        (
            &["groups", "line.obj", "--points", "90", "--repair"],
            "line.obj: surface: expected triangles with an area, found 1 without",
        ),
        (
            &["groups", "flat.obj", "--points", "90", "--repair"],
            "flat.obj: surface: expected a surface that encloses a volume, found 0 m³",
        ),
        (
            &["groups", "strip.off", "--points", "90", "--repair"],
            "strip.off: surface: expected a surface with an inside and an outside, found one with one side alone",
        ),
        (
            &["groups", "unwelded.off", "--points", "90", "--scale", "cm"],
            "unwelded.off: surface: expected triangles that share their corners, found 24576 edges of one triangle alone, of which 24576 meet another one within ",
        ),
        (
            &["groups", "ball.off", "--points", "90", "--fill", "1"],
            "--points: expected the number of points or the edge of a cube, which gives it, found both",
        ),
        (
            &["groups", "ball.off", "--repair"],
            "--fill: expected the edge of a cube in mesh units, or the number of points, for a surface, found neither",
        ),
        (&["groups", "ball.off", "--points", "7"], "--points: expected 8 to 2000000 points, found 7"),
        (
            &["groups", "image.vtk", "--repair"],
            "--repair: belongs to a surface, found it with image.vtk, whose cells are solid",
        ),
        (&["groups", "image.vtk", "--fill-element", "tet4", "--points", "90"], "--points: belongs to a surface"),
        (
            &["groups", "image.vtk", "--fill-element", "tet10"],
            "--fill-element: expected an element of tetrahedra or hexahedra with corners alone",
        ),
        (&["run", "both.toml"], "both.toml:2: mesh.fill.points: expected the number of points or the edge of a cube"),
        (&["run", "image.toml"], "image.toml:2: mesh.fill.repair: belongs to a surface"),
        (&["groups", "both.toml", "--repair"], "--repair: belongs to a mesh file, found it with a scene"),
    ] {
        let output = springfit(folder.path(), words);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), message.lines().count()), (Some(2), 1), "{words:?}: {message}");
        assert!(message.starts_with(&format!("error: {expected}")), "{words:?}: {message}");
        assert!(
            !message.contains("unwelded")
                || message.contains("cm: their corners are not welded; repair = true (--repair)"),
            "{message}"
        );
    }
}

/// `fit` and `run` say that a body has several pieces, whatever they print.
#[test]
fn pieces_of_a_body_are_told_by_all_commands() {
    let folder = TempDir::new().unwrap();
    let two = brick([0.0; 3], [40.0; 3], false, 0) + &brick([60.0, 0.0, 0.0], [70.0, 10.0, 10.0], false, 8);
    fs::write(folder.path().join("two.obj"), two).unwrap();
    let fill = ["two.obj", "--fill", "10", "--scale", "mm"];
    let fit = [&["fit"], &fill[..], &["--young", "1kPa", "--poisson", "0.3", "-o", "springs.json"]].concat();
    assert!(springfit(folder.path(), &[&["new"], &fill[..], &["-o", "two.toml"]].concat()).status.success());
    for words in [fit.clone(), vec!["run", "two.toml"]] {
        for more in [&[][..], &["--table", "markdown"]] {
            let output = springfit(folder.path(), &[&words[..], more].concat());
            let told = [output.stdout, output.stderr].concat();
            let told = String::from_utf8(told).unwrap();
            assert_eq!(
                told.matches("the mesh has 2 pieces that share no node").count(),
                1,
                "{words:?} {more:?}: {told}"
            );
        }
    }
}

/// The number of points is about the one that was asked for, with all cells and boundaries.
#[test]
fn points_are_about_as_many_as_asked_for() {
    for (scan, wanted) in [(ring(), 1000), (blob(), 300), (box_with_dent(0.7, 0.2), 5000)] {
        for (name, boundary) in [
            ("hex8", FillBoundary::Stepped),
            ("tet4", FillBoundary::Stepped),
            ("tet4", FillBoundary::Smooth),
            ("tet10", FillBoundary::Stepped),
        ] {
            let element = loaded(name);
            let (spacing, layers) = (FillSpacing::Points(wanted), FillLayers::Refuse);
            let mesh =
                FillMesh { element, spacing, boundary, layers, repair: false }.build(&source(&scan), 1.0).unwrap();
            let found = mesh.point_count() as f64 / wanted as f64;
            assert!((found - 1.0).abs() < 0.1, "{name} {boundary:?}: {found}");
            let told = format!("chosen for about {wanted} points: there are {}", mesh.point_count());
            assert!(mesh.quality.filled.unwrap().lines().iter().any(|line| line.contains(&told)));
        }
    }
}

/// A surface whose triangles share no corner is told as one that is not welded, and the first scene of a surface that encloses a volume offers to fill it.
#[test]
fn a_surface_that_is_not_welded_is_told() {
    let folder = TempDir::new().unwrap();
    let whole = sphere();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("loose.off", &off(&unwelded(&whole, 1e-7, &mut Random(1))));
    write("apart.off", &off(&whole));
    write("brick.obj", &brick([0.0; 3], [1.0; 3], false, 0));
    write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let said = |words: &[&str]| {
        let output = springfit(folder.path(), words);
        assert!(output.status.success(), "{}", said(&output));
        told(&output)
    };
    let fit =
        |name: &str| said(&["fit", name, "--young", "1", "--poisson", "0.3", "--thickness", "1mm", "-o", "x.json"]);
    for (name, is_loose, offer) in [
        ("loose.off", true, Some("points = 1000, element = \"hex8\", repair = true }")),
        ("apart.off", true, Some("repair = true }")),
        ("brick.obj", false, Some("points = 1000, element = \"hex8\" }")),
        ("sheet.obj", false, None),
    ] {
        assert_eq!(
            fit(name).contains("the surface is not welded: most of its cells share no corner"),
            is_loose,
            "{name}: {}",
            fit(name)
        );
        let scene = said(&["new", name]);
        let offered = scene.lines().find(|line| line.starts_with("# fill = "));
        assert_eq!(offered.is_some(), offer.is_some(), "{name}: {scene}");
        let Some((line, expected)) = offered.zip(offer) else { continue };
        assert!(line.contains(expected), "{name}: {line}");
        // What is offered is read, and fills.
        let filled = scene
            .replace("# fill", "fill")
            .lines()
            .filter(|line| !line.starts_with("file ") && !line.contains("thickness") && !line.contains("plane "))
            .collect::<Vec<_>>()
            .join("\n");
        write("filled.toml", &filled);
        assert!(said(&["run", "filled.toml", "--explain"]).contains("hex8"), "{name}");
    }
}
