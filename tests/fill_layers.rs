//! Surfaces that cross themselves, and parts inside others or inside out: what is refused, and what a union fills.

use crate::fills::brick;
use crate::kit::{said, springfit};
use crate::shapes::loaded;
use crate::smooth_fills::ball;
use springfit_mesh::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Mesh, MeshSource, SourceBlock};
use std::fs;
use tempfile::TempDir;

const BOUNDARIES: [FillBoundary; 2] = [FillBoundary::Stepped, FillBoundary::Smooth];

fn fill(
    source: &MeshSource,
    cell: f64,
    boundary: FillBoundary,
    layers: FillLayers,
) -> springfit_foundation::error::Result<(Mesh, Filled)> {
    let element = loaded("tet4");
    let mesh =
        FillMesh { element, spacing: FillSpacing::Edge(cell), boundary, layers, repair: false }.build(source, 1.0)?;
    let filled = mesh.quality.filled.clone().unwrap();
    Ok((mesh, filled))
}

fn refusal(source: &MeshSource, cell: f64, boundary: FillBoundary) -> String {
    fill(source, cell, boundary, FillLayers::Refuse).unwrap_err().to_string()
}

fn obj(text: &str) -> MeshSource {
    MeshSource::parse(text.as_bytes(), "obj").unwrap()
}

/// Surfaces as one.
fn together(parts: &[MeshSource]) -> MeshSource {
    let mut all = parts[0].clone();
    for part in &parts[1..] {
        let shift = all.points.len();
        all.points.extend(&part.points);
        all.numbers.extend(part.numbers.iter().map(|number| number + shift as u64));
        let moved = part.blocks[0].connectivity.iter().map(|p| p + shift);
        all.blocks[0].connectivity.extend(moved);
    }
    all
}

fn moved(mut source: MeshSource, place: impl Fn([f64; 3]) -> [f64; 3]) -> MeshSource {
    source.points.iter_mut().for_each(|x| *x = place(*x));
    source
}

fn turned(mut source: MeshSource) -> MeshSource {
    source.blocks[0].connectivity.chunks_mut(3).for_each(|triangle| triangle.swap(1, 2));
    source
}

/// Two balls of radius 1, turned against each other, whose centres are 1.2 apart.
fn two_balls() -> MeshSource {
    let turn = |[x, y, z]: [f64; 3]| {
        let (s, c) = 0.7_f64.sin_cos();
        let [x, y] = [c * x - s * y, s * x + c * y];
        [1.2 + c * x - s * z, y + 0.01, s * x + c * z]
    };
    together(&[ball(3, |_| 1.0), moved(ball(3, |_| 1.0), turn)])
}

fn corners(block: &SourceBlock, points: &[[f64; 3]], triangle: usize) -> [[f64; 3]; 3] {
    std::array::from_fn(|a| points[block.connectivity[3 * triangle + a]])
}

/// The place on the line from p to q and its weights in the triangle, by Cramer's rule: `p + t (q − p) = a + u (b − a) + v (c − a)`.
fn meeting(p: [f64; 3], q: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let less = |x: [f64; 3], y: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k] - y[k]) };
    let det = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let (u, v, w, right) = (less(b, a), less(c, a), less(p, q), less(p, a));
    let all = det([u, v, w]);
    [det([u, v, right]) / all, det([right, v, w]) / all, det([u, right, w]) / all]
}

/// The pairs of triangles of which an edge of one passes through the other, by all pairs.
fn pairs_that_cross(source: &MeshSource) -> Vec<[usize; 2]> {
    let block = &source.blocks[0];
    let nodes = |i: usize| &block.connectivity[3 * i..3 * i + 3];
    let passes = |i: usize, j: usize| {
        let triangle = corners(block, &source.points, j);
        (0..3).map(|k| [nodes(i)[k], nodes(i)[(k + 1) % 3]]).any(|edge| {
            let [t, u, v] = meeting(source.points[edge[0]], source.points[edge[1]], triangle);
            edge.iter().all(|p| !nodes(j).contains(p)) && t > 0.0 && t < 1.0 && u > 0.0 && v > 0.0 && u + v < 1.0
        })
    };
    let shared = |i: usize, j: usize| nodes(i).iter().filter(|p| nodes(j).contains(p)).count();
    let count = block.connectivity.len() / 3;
    let pairs = (0..count).flat_map(|j| (0..j).map(move |i| [i, j]));
    pairs.filter(|&[i, j]| shared(i, j) < 2 && (passes(i, j) || passes(j, i))).collect()
}

/// Both faces of the message are read back from it, and pass through each other at the place that it names.
#[test]
fn a_surface_that_crosses_itself_is_refused_with_two_faces_and_a_place() {
    let source = two_balls();
    let pairs = pairs_that_cross(&source);
    assert!(pairs.len() > 40);
    for boundary in BOUNDARIES {
        let message = refusal(&source, 0.2, boundary);
        let start =
            format!("surface: expected a surface that does not cross itself, found {} pairs of faces", pairs.len());
        assert!(message.starts_with(&start), "{message}");
        for words in ["are inside several layers", "a modelling program unites", "layers = \"union\""] {
            assert!(message.contains(words), "{words}: {message}");
        }
        let numbers = message.split("triangle ").skip(1).map(|rest| rest.split(' ').next().unwrap());
        let named: Vec<usize> = numbers.map(|number| number.parse::<usize>().unwrap() - 1).collect();
        assert!(pairs.contains(&[named[0], named[1]]), "{named:?}");
        let place = message.split_once(" at (").unwrap().1.split_once(") m").unwrap().0;
        let place: Vec<f64> = place.split(", ").map(|x| x.parse().unwrap()).collect();
        // The place is on both planes; it has five digits.
        for triangle in named {
            let [a, b, c] = corners(&source.blocks[0], &source.points, triangle);
            let beside: [f64; 3] = std::array::from_fn(|k| place[k] + [0.1, 0.2, 0.3][k]);
            let [t, u, v] = meeting([place[0], place[1], place[2]], beside, [a, b, c]);
            assert!(t.abs() < 1e-3 && u > -1e-3 && v > -1e-3 && u + v < 1.0 + 1e-3, "{t} {u} {v}");
        }
    }
}

/// The volume of both is `8 π/3` less the lens `π (4 r + d) (2 r − d)²/12`.
#[test]
fn a_union_fills_what_any_layer_encloses() {
    let exact = 8.0 / 3.0 * std::f64::consts::PI - std::f64::consts::PI * 5.2 * 0.8_f64.powi(2) / 12.0;
    for boundary in BOUNDARIES {
        let (_, filled) = fill(&two_balls(), 0.1, boundary, FillLayers::Union).unwrap();
        // The triangles are inside the balls by two percent of the volume.
        assert!((filled.volume / exact - 1.0).abs() < 0.04, "{}", filled.volume / exact);
        assert!(filled.overlaps.is_some() && filled.inverted.is_none());
        let lines = filled.lines().join("\n");
        assert!(lines.contains("pairs of faces cross") && lines.contains("each is filled once"), "{lines}");
    }
}

/// Edges along the axes meet the diagonals of the sides of other boxes, so that none passes through the inside of a triangle.
#[test]
fn boxes_along_the_axes_are_told_apart_by_their_places() {
    let crossed = brick([0.0; 3], [4.0; 3], false, 0) + &brick([2.0; 3], [6.0; 3], false, 8);
    let message = refusal(&obj(&crossed), 1.0, FillBoundary::Stepped);
    assert!(message.contains("pairs of faces cross, such as quadrangle") && message.contains(" at ("), "{message}");
    let (mesh, filled) = fill(&obj(&crossed), 1.0, FillBoundary::Stepped, FillLayers::Union).unwrap();
    assert_eq!((mesh.cell_count(), filled.overlaps.unwrap().0), (12 * 120, 12 * 8));
    // Boxes whose sides lie on each other do not cross.
    let touching = brick([0.0; 3], [2.0, 2.0, 1.0], false, 0) + &brick([1.0, 2.0, 0.0], [3.0, 4.0, 1.0], false, 8);
    let (mesh, filled) = fill(&obj(&touching), 0.5, FillBoundary::Stepped, FillLayers::Refuse).unwrap();
    assert_eq!((filled.crossings, filled.overlaps, mesh.cell_count()), (None, None, 12 * 64));
}

/// A point of the ball that is moved over its neighbours makes a fold that is smaller than a cell.
#[test]
fn a_fold_that_no_place_of_the_lattice_sees_is_a_note() {
    let mut source = ball(4, |_| 1.0);
    let last = source.points.len() - 1;
    let x = source.points[last];
    source.points[last] = [x[0] + 0.2 * x[1], x[1] - 0.2 * x[0], x[2] + 0.03];
    let pairs = pairs_that_cross(&source);
    assert!(!pairs.is_empty());
    for boundary in BOUNDARIES {
        let (_, filled) = fill(&source, 0.4, boundary, FillLayers::Refuse).unwrap();
        assert_eq!(filled.crossings.as_ref().unwrap().pairs, pairs.len());
        let lines = filled.lines().join("\n");
        assert!(lines.contains(": no place of the lattice is inside several layers"), "{lines}");
    }
}

#[test]
fn parts_inside_others_and_parts_inside_out_are_refused_unless_a_union_is_asked_for() {
    let inner = |source: MeshSource| together(&[ball(3, |_| 1.0), moved(source, |x| x.map(|x| 0.5 * x))]);
    let beside = |source: MeshSource| {
        together(&[ball(3, |_| 1.0), moved(source, |[x, y, z]| [0.5 * x + 2.0, 0.5 * y, 0.5 * z])])
    };
    for boundary in BOUNDARIES {
        let nested = inner(ball(3, |_| 1.0));
        let message = refusal(&nested, 0.2, boundary);
        let expected = "surface: expected one layer around each place, found ";
        assert!(message.starts_with(expected) && message.contains("normals inwards make"), "{message}");
        let alone = fill(&ball(3, |_| 1.0), 0.2, boundary, FillLayers::Refuse).unwrap().1.volume;
        let union = fill(&nested, 0.2, boundary, FillLayers::Union).unwrap().1.volume;
        assert!((union / alone - 1.0).abs() < 1e-12);
        let cavity = fill(&inner(turned(ball(3, |_| 1.0))), 0.2, boundary, FillLayers::Refuse).unwrap().1;
        assert!(cavity.volume < 0.9 * alone && cavity.crossings.is_none());
        let inside_out = beside(turned(ball(3, |_| 1.0)));
        let message = refusal(&inside_out, 0.2, boundary);
        let expected = "surface: expected normals that all point outwards, found ";
        assert!(message.starts_with(expected) && message.contains("a modelling program turns it"), "{message}");
        let (_, filled) = fill(&inside_out, 0.2, boundary, FillLayers::Union).unwrap();
        assert!(filled.inverted.is_some() && (filled.volume / alone - 1.0).abs() < 0.03);
    }
}

#[test]
fn the_program_refuses_with_one_line_and_takes_the_option_into_the_scene() {
    let folder = TempDir::new().unwrap();
    let crossed = brick([0.0; 3], [4.0; 3], false, 0) + &brick([2.0; 3], [6.0; 3], false, 8);
    fs::write(folder.path().join("two.obj"), crossed).unwrap();
    let new = ["new", "two.obj", "--fill", "1", "-o", "two.toml"];
    let refused = springfit(folder.path(), &new);
    let message = String::from_utf8(refused.stderr).unwrap();
    assert_eq!((refused.status.code(), message.lines().count()), (Some(2), 1), "{message}");
    assert!(message.starts_with("error: two.obj: surface: expected a surface that does not cross itself"), "{message}");
    assert!(!folder.path().join("two.toml").exists());
    let union = springfit(folder.path(), &[&new[..], &["--fill-layers", "union"]].concat());
    assert!(union.status.success());
    let scene = fs::read_to_string(folder.path().join("two.toml")).unwrap();
    assert!(scene.contains("layers = \"union\""), "{scene}");
    let run = springfit(folder.path(), &["run", "two.toml"]);
    assert!(run.status.success(), "{}", said(&run));
    for (words, key) in [
        (&["run", "two.toml", "--set", "mesh.fill.layers=uinon"][..], "mesh.fill.layers"),
        (&["new", "two.obj", "--fill", "1", "--fill-layers", "uinon"], "--fill-layers"),
    ] {
        let wrong = String::from_utf8(springfit(folder.path(), words).stderr).unwrap();
        let expected = format!("{key}: expected one of refuse, union, found \"uinon\"; did you mean \"union\"?");
        assert!(wrong.contains(&expected), "{wrong}");
    }
    let negative = String::from_utf8(springfit(folder.path(), &["new", "two.obj", "--fill", "-1"]).stderr).unwrap();
    assert!(negative.starts_with("error: --fill: expected") && negative.contains("found -1"), "{negative}");
}
