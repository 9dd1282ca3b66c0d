//! Sheets that are curved in the mesh and flat at rest.

use nalgebra::Vector3;
use springfit::export::target_named;
use springfit_report::report::{NetworkFile, Parts};
use springfit_studies::study::{Outcome, Scene, run};
use std::path::Path;
use tempfile::TempDir;

/// The angle of the arc, and the cells along it.
const ANGLE: f64 = 0.8;
const CELLS: usize = 8;

type Points = Vec<[f64; 3]>;

/// The corners of a strip that is bent to an arc of the length 1, and those of the strip that is unrolled: its cells are as long and in the plane of the first, at which it is
/// held. They have the width 0.25 and parallel diagonals.
fn strip() -> (Points, Points, Vec<[usize; 3]>) {
    let radius = 1.0 / ANGLE;
    let turn = ANGLE / CELLS as f64;
    let chord = 2.0 * radius * (turn / 2.0).sin();
    let first = [(turn / 2.0).cos(), (turn / 2.0).sin()];
    let (mut bent, mut flat, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=CELLS {
        for j in 0..=2 {
            let (angle, y, along) = (turn * i as f64, 0.125 * j as f64, chord * i as f64);
            bent.push([radius * angle.sin(), y, radius * (1.0 - angle.cos())]);
            flat.push([along * first[0], y, along * first[1]]);
        }
    }
    for (i, j) in (0..CELLS).flat_map(|i| (0..2).map(move |j| (i, j))) {
        let a = 3 * i + j;
        triangles.extend([[a, a + 3, a + 1], [a + 3, a + 4, a + 1]]);
    }
    (bent, flat, triangles)
}

fn written(
    folder: &Path,
    points: &[[f64; 3]],
    triangles: &[[usize; 3]],
    rest: &str,
) -> springfit_foundation::error::Result<Scene> {
    let mut text: String = points.iter().map(|x| format!("v {:?} {:?} {:?}\n", x[0], x[1], x[2])).collect();
    triangles.iter().for_each(|c| text += &format!("f {} {} {}\n", c[0] + 1, c[1] + 1, c[2] + 1));
    std::fs::write(folder.join("sheet.obj"), text).unwrap();
    Scene::parse(&format!("[mesh]\nfile = \"sheet.obj\"\n{rest}"), &folder.join("sheet.toml"))
}

fn outcome(points: &[[f64; 3]], triangles: &[[usize; 3]], rest: &str) -> springfit_foundation::error::Result<Outcome> {
    let folder = TempDir::new().unwrap();
    run(&written(folder.path(), points, triangles, rest)?, &mut |_| {})
}

const MATERIAL: &str = "[material]\nyoung = 1e6\npoisson = 0.3\nthickness = 0.02\ndensity = 1000\nbending = \"plate\"\nlaw = \"stable-neo-hookean\"\n";
const FITS: &str = "[[fit]]\nname = \"plate\"\nobjective = \"exact\"\n[[fit]]\nname = \"hinges\"\nobjective = \"exact\"\nbending = \"hinges\"\n";
const HELD: &str = "[[fix]]\nwhere = \"x < 1e-6\"\nclamp = true\n";
/// A load that is nothing, so that the sheet moves by its rest shape alone.
const NOTHING: &str = "[[load]]\nwhere = \"x > 0.5\"\nforce = [0, 0, 0]\n";

/// How far the points are from these places at most, m.
fn apart(points: &[[f64; 3]], u: &[f64], expected: &[[f64; 3]]) -> f64 {
    let at = |p: usize, k: usize| points[p][k] + u[3 * p + k] - expected[p][k];
    (0..3 * points.len()).map(|i| at(i / 3, i % 3).abs()).fold(0.0, f64::max)
}

/// An arc can be unrolled without stretch: it is straight at rest, to rounding, by directors and by hinges, and the finite elements are.
#[test]
fn a_strip_that_is_bent_to_an_arc_straightens() {
    let (bent, flat, triangles) = strip();
    let scene = format!("{MATERIAL}rest = \"flat\"\n{FITS}{HELD}{NOTHING}");
    let found = outcome(&bent, &triangles, &scene).unwrap();
    assert!(apart(&bent, &vec![0.0; 3 * bent.len()], &flat) > 0.3);
    for fit in &found.fits {
        let apart = apart(&bent, fit.loads[0].displacement.as_ref().unwrap(), &flat);
        assert!(apart < 1e-7, "{}: {apart}", fit.fit.name);
        assert!(fit.loads[0].error.unwrap().max < 1e-4, "{:?}", fit.loads[0].error);
    }
    // What is at rest as it is stays there.
    let scene = format!("{MATERIAL}rest = \"mesh\"\n{FITS}{HELD}{NOTHING}");
    let found = outcome(&bent, &triangles, &scene).unwrap();
    assert!(apart(&bent, found.fits[0].loads[0].displacement.as_ref().unwrap(), &bent) < 1e-12);
    // Hinges of other programs are at rest where they are flat.
    let fit = "[[fit]]\nobjective = \"offdiag\"\nnonnegative = true\nbending = \"hinges\"\n";
    let found = outcome(&bent, &triangles, &format!("{MATERIAL}rest = \"flat\"\n{fit}[[fix]]\nwhere = \"x < 1e-6\"\n"))
        .unwrap();
    let network = NetworkFile::of(&found, &found.fits[0]).record();
    let (hinged, _) = target_named("npz").unwrap().prepared(network, None).unwrap();
    let hinges = Parts::of(&hinged).unwrap().hinges;
    assert!(!hinges.is_empty() && hinges.iter().all(|hinge| hinge.rest.abs() < 1e-9));
}

/// The same strip moves from the arc, without a load, and comes to rest where it is straight.
#[test]
fn the_strip_swings_to_where_it_is_straight() {
    let (bent, flat, triangles) = strip();
    let motion = "[motion]\nduration = 25\nstep = 0.1\nintegrator = \"implicit-euler\"\nfinite_elements = false\n\
                  every = 20\nwatch = { where = \"x > 0.89\" }\ndamping = { rayleigh = [1.3, 0] }\n";
    let scene = format!("{MATERIAL}rest = \"flat\"\n{FITS}{HELD}{motion}");
    let found = outcome(&bent, &triangles, &scene).unwrap();
    let last = flat.len() - 1;
    for model in &found.motion.as_ref().unwrap().models {
        let record = model.records.last().unwrap();
        let expected: Vec<f64> = (0..3).map(|k| flat[last][k] - bent[last][k]).collect();
        for k in [0, 2] {
            assert!(
                (record.watched[k] - expected[k]).abs() < 1e-4,
                "{}: {:?} {expected:?}",
                model.name,
                record.watched
            );
        }
    }
}

/// A cap cannot be unrolled. Where bending is all, it is flat to rounding and its membrane is stretched in this plane; where it is thin, it gives way beside the plane.
#[test]
fn a_cap_springs_flat_where_it_is_thick() {
    let n = 6;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        let [x, y] = [i, j].map(|i| i as f64 / n as f64 - 0.5);
        // A sphere of radius 2.
        points.push([x, y, (4.0f64 - x * x - y * y).sqrt() - 2.0]);
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * (n + 1) + i;
        let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
        triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    // Nothing but its motions as a whole is held: its middle, and a point that keeps it from turning.
    let held = "[[fix]]\nwhere = \"abs(x) < 1e-6 && abs(y) < 1e-6\"\n[[fix]]\nwhere = \"abs(x - 0.5) < 1e-6 && abs(y) < 1e-6\"\naxes = [\"y\", \"z\"]\n\
                [[fix]]\nwhere = \"abs(x) < 1e-6 && abs(y - 0.5) < 1e-6\"\naxes = [\"z\"]\n";
    let none = "[[load]]\nwhere = \"x > 0.49\"\nforce = [0, 0, 0]\n";
    let off_the_plane = |thickness: f64| {
        let material = MATERIAL.replace("0.02", &thickness.to_string());
        let fit = "[[fit]]\nname = \"plate\"\nobjective = \"exact\"\n";
        let found = outcome(&points, &triangles, &format!("{material}rest = \"flat\"\n{fit}{held}{none}")).unwrap();
        let u = found.fits[0].loads[0].displacement.clone().unwrap();
        let at = |p: usize| Vector3::from_fn(|k, _| points[p][k] + u[3 * p + k]);
        // The plane of the three points that are held.
        let held = [n / 2 * (n + 1) + n / 2, n / 2 * (n + 1) + n, n * (n + 1) + n / 2].map(at);
        let normal = (held[1] - held[0]).cross(&(held[2] - held[0])).normalize();
        (0..points.len()).map(|p| (at(p) - held[0]).dot(&normal).abs()).fold(0.0, f64::max)
    };
    let heights = [0.005, 0.08].map(off_the_plane);
    assert!(heights[0] > 0.02 && heights[1] < 1e-9, "{heights:?}");
}

/// A rest shape needs a sheet at large deformation, and frequencies are those of another shape.
#[test]
fn flat_rest_is_refused_where_it_has_no_meaning() {
    let (bent, _, triangles) = strip();
    let refused = |rest: &str| outcome(&bent, &triangles, rest).unwrap_err().to_string();
    let law = "law = \"stable-neo-hookean\"\n";
    let linear = format!("{}rest = \"flat\"\n{FITS}{HELD}{NOTHING}", MATERIAL.replace(law, ""));
    let text = refused(&linear);
    assert!(text.contains("material.rest: expected a law beside it") && text.contains("linear theory"), "{text}");
    let membrane = format!("{}rest = \"flat\"\n{FITS}{HELD}{NOTHING}", MATERIAL.replace("bending = \"plate\"\n", ""));
    let text = refused(&membrane);
    assert!(text.contains("material.rest: expected bending = \"plate\" beside it"), "{text}");
    let modes = format!("{MATERIAL}rest = \"flat\"\n{FITS}{HELD}[output]\nfrequencies = 3\n");
    let text = refused(&modes);
    assert!(text.contains("output.frequencies: expected 0 of a sheet with rest = \"flat\""), "{text}");
    let unknown = format!("{MATERIAL}rest = \"round\"\n{FITS}{HELD}{NOTHING}");
    let text = refused(&unknown);
    assert!(["material.rest", "round", "mesh", "flat"].iter().all(|word| text.contains(word)), "{text}");
}
