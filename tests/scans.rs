//! Damaged scans of bodies whose volumes are known: what a repair makes of them, and what it says of it.

use crate::shapes::{Random, loaded};
use crate::smooth_fills::{ball, torus};
use springfit_foundation::error::Result;
use springfit_mesh::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Mesh, MeshSource, Repair};
use std::f64::consts::PI;

type Place = [f64; 3];
pub(super) type Triangle = [Place; 3];

fn triangles(source: &MeshSource) -> Vec<Triangle> {
    let block = &source.blocks[0];
    block.connectivity.chunks(3).map(|nodes| [0, 1, 2].map(|a| source.points[nodes[a]])).collect()
}

/// The triangles as a source whose corners at equal coordinates are one point, as in STL.
pub(super) fn source(triangles: &[Triangle]) -> MeshSource {
    let mut text = String::from("solid scan\n");
    for corners in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        corners.iter().for_each(|[x, y, z]| text += &format!("vertex {x} {y} {z}\n"));
        text += "endloop\nendfacet\n";
    }
    MeshSource::parse((text + "endsolid\n").as_bytes(), "stl").unwrap()
}

/// `∫ x·n dA / 3`, from the origin.
fn volume(triangles: &[Triangle]) -> f64 {
    let det = |[a, b, c]: &Triangle| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    triangles.iter().map(det).sum::<f64>() / 6.0
}

fn fill(scan: &[Triangle], spacing: FillSpacing, boundary: FillBoundary) -> Result<(Mesh, Filled)> {
    let element = loaded("tet4");
    let layers = FillLayers::Union;
    let mesh = FillMesh { element, spacing, boundary, layers, repair: true }.build(&source(scan), 1.0)?;
    let filled = mesh.quality.filled.clone().unwrap();
    Ok((mesh, filled))
}

/// Fills a scan with tetrahedra of about a thousand points, and proves that the volume of the repaired surface is within 1 % of that of the
/// undamaged one, which the given share may exceed.
fn repaired(scan: &[Triangle], exact: f64) -> (Repair, String) {
    let (mesh, filled) = fill(scan, FillSpacing::Points(1000), FillBoundary::Smooth).unwrap();
    let lines = filled.lines().join("\n");
    let repair = filled.repair.unwrap();
    assert!((repair.volume / exact - 1.0).abs() < 0.01, "{} of {exact}\n{lines}", repair.volume);
    assert!((mesh.point_count() as f64 / 1000.0 - 1.0).abs() < 0.1, "{lines}");
    // Flat sides between points on a curved surface with a thousand points inside take up to 4 % of a body.
    assert!((filled.volume / exact - 1.0).abs() < 0.04, "{} of {exact}\n{lines}", filled.volume);
    assert!((repair.given_volume - volume(scan)).abs() < 0.2 * exact, "{lines}");
    for (count, words) in [
        (repair.welded.0, "of open edges"),
        (repair.doubles, "with the corners of another"),
        (repair.flat, "without an area"),
        (repair.turned, "turned round"),
        (repair.holes, "closed by"),
        (repair.fragments.count, "apart from the body"),
    ] {
        let is_told = lines.lines().any(|line| line.starts_with(&count.to_string()) && line.contains(words));
        assert_eq!(is_told, count > 0, "{count} {words}:\n{lines}");
    }
    (repair, lines)
}

/// A ball of `4 π/3`, which the triangles are inside of by less than a half percent.
pub(super) fn sphere() -> Vec<Triangle> {
    let ball = triangles(&ball(5, |_| 1.0));
    assert!((volume(&ball) / (4.0 / 3.0 * PI) - 1.0).abs() < 5e-3);
    ball
}

/// A ring of `2 π² R r²` with R = 1 and r = 0.4.
pub(super) fn ring() -> Vec<Triangle> {
    let ring = triangles(&torus(90, 45));
    assert!((volume(&ring).abs() / (2.0 * PI * PI * 0.16) - 1.0).abs() < 5e-3);
    if volume(&ring) > 0.0 { ring } else { turned(ring, |_| true).0 }
}

/// A body of the radius `1 + d` in the direction n, with `d = 0.3 n_x + 0.2 n_y n_z`: its volume is `4 π/3` times the mean of `(1 + d)³`, in which the means of
/// d and d³ are 0 and that of d² is `0.09/3 + 0.04/15`.
pub(super) fn blob() -> Vec<Triangle> {
    let blob = triangles(&ball(5, |[x, y, z]| 1.0 + 0.3 * x + 0.2 * y * z));
    assert!((volume(&blob) / (4.0 / 3.0 * PI * (1.0 + 3.0 * (0.03 + 0.04 / 15.0))) - 1.0).abs() < 5e-3);
    blob
}

/// A box of 1 × 1 × `height` of n × n squares a side with a dent `depth sin²(π x) sin²(π y)` in its upper side, of a quarter of its depth.
pub(super) fn box_with_dent(height: f64, depth: f64) -> Vec<Triangle> {
    const N: usize = 40;
    let mut all = Vec::new();
    let dent = |x: f64, y: f64| depth * ((PI * x).sin() * (PI * y).sin()).powi(2);
    let mut side = |place: &dyn Fn(f64, f64) -> Place| {
        let at = |i: usize, j: usize| place(i as f64 / N as f64, j as f64 / N as f64);
        for i in 0..N {
            for j in 0..N {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                all.extend([[a, b, c], [a, c, d]]);
            }
        }
    };
    side(&|u, v| [v, u, 0.0]);
    side(&|u, v| [u, v, height - dent(u, v)]);
    side(&|u, v| [u, 0.0, v * height]);
    side(&|u, v| [v, 1.0, u * height]);
    side(&|u, v| [0.0, v, u * height]);
    side(&|u, v| [1.0, u, v * height]);
    let exact = height - depth / 4.0;
    assert!((volume(&all) / exact - 1.0).abs() < 1e-3, "{}", volume(&all));
    all
}

/// Each corner moved by up to `by`, each time it is named, as programs write that round each triangle by itself.
pub(super) fn unwelded(scan: &[Triangle], by: f64, random: &mut Random) -> Vec<Triangle> {
    scan.iter().map(|corners| corners.map(|x| x.map(|x| x + by * random.next()))).collect()
}

/// The triangles that are picked turned round, and their number.
fn turned(mut scan: Vec<Triangle>, pick: impl Fn(usize) -> bool) -> (Vec<Triangle>, usize) {
    let mut count = 0;
    for (_, corners) in scan.iter_mut().enumerate().filter(|(i, _)| pick(*i)) {
        corners.swap(1, 2);
        count += 1;
    }
    (scan, count)
}

fn moved(scan: &[Triangle], factor: f64, by: Place) -> Vec<Triangle> {
    let place = |x: Place| [0, 1, 2].map(|k| factor * x[k] + by[k]);
    scan.iter().map(|corners| corners.map(place)).collect()
}

/// Triangles without an area: on the edges of some of a scan, and with a corner twice.
fn splinters(scan: &[Triangle]) -> Vec<Triangle> {
    let on_edge = |[a, b, _]: &Triangle| [*a, *b, [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))];
    let some = || scan.iter().step_by(97);
    some().map(on_edge).chain(some().map(|[a, b, _]| [*a, *a, *b])).collect()
}

#[test]
fn corners_of_a_scan_are_welded() {
    let whole = sphere();
    let scan = unwelded(&whole, 2e-7, &mut Random(1));
    let (repair, lines) = repaired(&scan, volume(&whole));
    // Each triangle has three corners of its own, of which Euler's V = T/2 + 2 are left.
    assert_eq!(repair.welded.0, 3 * whole.len() - (whole.len() / 2 + 2), "{lines}");
    assert!(repair.welded.1 < 1e-6 && repair.holes == 0 && repair.turned == 0, "{lines}");
}

#[test]
fn triangles_of_a_scan_are_turned_like_their_neighbours_and_outwards() {
    let whole = ring();
    let (scan, count) = turned(whole.clone(), |i| i % 7 == 3);
    let (repair, lines) = repaired(&scan, volume(&whole));
    assert_eq!(repair.turned, count, "{lines}");
    let (repair, _) = repaired(&turned(scan, |_| true).0, volume(&whole));
    assert_eq!(repair.turned, whole.len() - count);
}

#[test]
fn double_triangles_of_a_scan_are_left_out() {
    let whole = blob();
    let again: Vec<Triangle> = whole.iter().step_by(50).copied().collect();
    let (half, _) = turned(again.clone(), |i| i % 2 == 0);
    let (repair, _) = repaired(&[&whole[..], &half].concat(), volume(&whole));
    assert_eq!((repair.doubles, repair.holes), (again.len(), 0));
}

#[test]
fn small_holes_of_a_scan_are_closed() {
    let whole = box_with_dent(1.0, 0.3);
    let mut scan = whole.clone();
    // A slit along a whole row of the lower side, and twelve single triangles of the upper one.
    scan.drain(3200..3200 + 80);
    for i in (0..12).rev() {
        scan.remove(400 + 37 * i);
    }
    let (repair, lines) = repaired(&scan, volume(&whole));
    assert_eq!(repair.holes, 13, "{lines}");
    assert_eq!(repair.largest_hole.unwrap().0, 82, "{lines}");
    assert!(repair.closed < 0.01, "{lines}");
}

#[test]
fn fragments_of_a_scan_are_left_out() {
    let whole = ring();
    let crumb = moved(&triangles(&ball(2, |_| 1.0)), 0.05, [0.0; 3]);
    let crumbs: Vec<Triangle> =
        (0..12).flat_map(|i| moved(&crumb, 1.0, [2.0 + 0.2 * f64::from(i), 0.0, 0.0])).collect();
    let (repair, lines) = repaired(&[&crumbs[..], &whole].concat(), volume(&whole));
    assert_eq!((repair.fragments.count, repair.fragments.triangles), (12, crumbs.len()), "{lines}");
    assert!(repair.fragments.at[0] > 1.9, "{lines}");
}

#[test]
fn noise_of_a_scan_is_no_fault() {
    let mut random = Random(7);
    let whole = sphere();
    // Noise of a tenth of an edge along the radius, equal wherever a corner is named.
    let noise = |x: Place| {
        let by = 1.0 + 3e-3 * (1e4 * (x[0] + 3.0 * x[1] + 7.0 * x[2])).sin();
        x.map(|x| by * x)
    };
    let noisy: Vec<Triangle> = whole.iter().map(|corners| corners.map(noise)).collect();
    let (repair, _) = repaired(&unwelded(&noisy, 2e-7, &mut random), volume(&whole));
    assert_eq!((repair.holes, repair.turned, repair.fragments.count), (0, 0, 0));
}

/// A second pass of a scanner over a part of the body is an open sheet through its surface.
#[test]
fn a_part_that_was_scanned_twice_is_left_out() {
    let whole = sphere();
    let part: Vec<Triangle> = whole.iter().filter(|corners| corners[0][2] > 0.6).copied().collect();
    let again = moved(&part, 1.001, [3e-3, -2e-3, 0.0]);
    let (repair, lines) = repaired(&[&whole[..], &again].concat(), volume(&whole));
    let left_out = repair.fragments.triangles + repair.inner.triangles;
    assert_eq!(left_out, again.len(), "{lines}");
}

/// The volume of two balls of radius 1 at the distance d is `8 π/3` less the lens `π (4 + d) (2 − d)²/12`.
#[test]
fn pieces_of_a_scan_that_pass_through_each_other_are_one_body() {
    let one = sphere();
    let two = moved(&one, 1.0, [1.2, 0.013, 0.007]);
    let scan = [one, turned(two, |_| true).0].concat();
    let exact = 8.0 / 3.0 * PI - PI * 5.2 * 0.8_f64.powi(2) / 12.0;
    let (_, filled) = fill(&scan, FillSpacing::Points(20_000), FillBoundary::Smooth).unwrap();
    let lines = filled.lines().join("\n");
    assert!((filled.volume / exact - 1.0).abs() < 0.01, "{} of {exact}\n{lines}", filled.volume);
    assert_eq!(filled.repair.as_ref().unwrap().layers, 2);
    assert!(lines.contains("the body has 2 pieces that pass through each other"), "{lines}");
}

#[test]
fn flat_triangles_of_a_scan_are_left_out() {
    let whole = box_with_dent(1.0, 0.3);
    let flat = splinters(&whole);
    let (repair, lines) = repaired(&[&whole[..], &flat].concat(), volume(&whole));
    assert_eq!((repair.flat, repair.sheets, repair.holes), (flat.len(), 0, 0), "{lines}");
}

#[test]
fn a_scan_with_all_faults_at_once_is_mended() {
    let whole = blob();
    let mut scan: Vec<Triangle> = whole.iter().enumerate().filter(|(i, _)| i % 997 != 5).map(|(_, t)| *t).collect();
    let missing = whole.len() - scan.len();
    let crumb = moved(&triangles(&ball(2, |_| 1.0)), 0.05, [2.0, 2.0, 2.0]);
    let (flat, twice) = (splinters(&whole), whole.iter().step_by(211).copied().collect::<Vec<_>>());
    scan.extend(flat.iter().chain(&crumb));
    let scan = unwelded(&scan, 2e-7, &mut Random(3));
    let again: Vec<Triangle> = twice.iter().map(|_| scan[0]).collect();
    let (scan, _) = turned([scan, again.clone()].concat(), |i| i % 61 == 7);
    let (repair, lines) = repaired(&scan, volume(&whole));
    assert_eq!((repair.holes, repair.fragments.count, repair.doubles), (missing, 1, again.len()), "{lines}");
    assert_eq!(repair.flat, flat.len(), "{lines}");
    assert!(repair.welded.0 > 20_000 && repair.turned > 100, "{lines}");
}

/// The distance between both sides is below the largest tolerance of welding, and one side has a hole; a cavity is kept.
#[test]
fn thin_walls_of_a_scan_stay() {
    let plate = box_with_dent(1e-4, 0.0);
    let mut scan = plate.clone();
    scan.remove(1600 + 40);
    // No cubes of this size are the plate. Welded to one side or open it would enclose nothing.
    assert!((volume(&plate) / 1e-4 - 1.0).abs() < 1e-3);
    let said = fill(&scan, FillSpacing::Edge(0.05), FillBoundary::Stepped).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("within a factor of two") && said.ends_with("m³ of 1.000e-4 m³"), "{said}");
    let shell = sphere();
    let hollow = [shell.clone(), turned(moved(&shell, 0.97, [0.0; 3]), |_| true).0].concat();
    let (_, filled) =
        fill(&unwelded(&hollow, 2e-7, &mut Random(5)), FillSpacing::Edge(0.05), FillBoundary::Stepped).unwrap();
    let repair = filled.repair.unwrap();
    assert!((repair.volume / volume(&hollow) - 1.0).abs() < 0.01, "{repair:?}");
    assert_eq!(repair.cavities, 1);
}

/// A wall across a body, fins on it and a flap end at edges of three triangles.
#[test]
fn sheets_that_hang_on_a_scan_are_left_out() {
    let whole = sphere();
    let fin = |[a, b, _]: &Triangle| [*a, *b, [0, 1, 2].map(|k| 1.1 * a[k] + 0.1 * b[k])];
    let fins: Vec<Triangle> = whole.iter().step_by(301).map(fin).collect();
    let (repair, lines) = repaired(&[&whole[..], &fins].concat(), volume(&whole));
    assert_eq!((repair.sheets, repair.holes, repair.fragments.count), (fins.len(), 0, 0), "{lines}");
}

/// Triangles between a few points, of which many share edges in ways that no body has: each is an error, or encloses what is filled.
#[test]
fn no_triangles_make_a_repair_panic() {
    let mut random = Random(11);
    let (mut filled, mut refused) = (0, 0);
    for round in 0..400 {
        let points: Vec<Place> =
            (0..4 + round % 9).map(|_| [0; 3].map(|_| (4.0 * random.next()).round() / 4.0)).collect();
        let mut pick = || points[(points.len() as f64 * 0.5 * (random.next() + 1.0)) as usize % points.len()];
        let mut scan: Vec<Triangle> = (0..2 + round % 40).map(|_| [pick(), pick(), pick()]).collect();
        if round % 2 == 0 {
            scan.extend(moved(&triangles(&ball(2, |_| 1.0)), 0.7, [0.1, 0.2, 0.3]));
        }
        match fill(&scan, FillSpacing::Edge(0.3), FillBoundary::Smooth) {
            Ok((_, found)) => {
                assert!(found.volume > 0.0 && found.surface_volume > 0.0);
                filled += 1;
            }
            Err(error) => {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
                refused += 1;
            }
        }
    }
    assert!(filled > 50 && refused > 50, "{filled} {refused}");
}
