//! Closed surfaces that are filled with tetrahedra up to the surface.

use crate::kit::{place, source};
use crate::shapes::loaded;
use springfit_mesh::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Mesh, MeshSource};
use springfit_studies::study::{Scene, run};
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

fn fill(
    source: &MeshSource,
    name: &str,
    cell: f64,
    boundary: FillBoundary,
) -> springfit_foundation::error::Result<Mesh> {
    let element = loaded(name);
    let (spacing, layers) = (FillSpacing::Edge(cell), FillLayers::Refuse);
    FillMesh { element, spacing, boundary, layers, repair: false }.build(source, 1.0)
}

fn smooth(source: &MeshSource, cell: f64) -> Mesh {
    fill(source, "tet4", cell, FillBoundary::Smooth).unwrap()
}

fn filled(mesh: &Mesh) -> &Filled {
    mesh.quality.filled.as_ref().unwrap()
}

fn obj(points: &[[f64; 3]], triangles: &[[usize; 3]]) -> MeshSource {
    let mut text = String::new();
    points.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    triangles.iter().for_each(|[a, b, c]| text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    MeshSource::parse(text.as_bytes(), "obj").unwrap()
}

/// An octahedron whose triangles are divided in four, with its points at the radius of their direction.
pub(super) fn ball(times: usize, radius: impl Fn([f64; 3]) -> f64) -> MeshSource {
    let mut points: Vec<[f64; 3]> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[usize; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..times {
        let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
        let mut divided = Vec::new();
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[p, q]| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    let sum = [0, 1, 2].map(|k| points[p][k] + points[q][k]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    points.push(sum.map(|x| x / length));
                    points.len() - 1
                })
            });
            divided.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = divided;
    }
    let placed: Vec<[f64; 3]> = points.iter().map(|x| x.map(|k| k * radius(*x))).collect();
    obj(&placed, &triangles)
}

pub(super) fn torus(around: usize, across: usize) -> MeshSource {
    let angle = |i: usize, of: usize| 2.0 * PI * i as f64 / of as f64;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (angle(i, around), angle(j, across));
            let r = 1.0 + 0.4 * v.cos();
            points.push([r * u.cos(), r * u.sin(), 0.4 * v.sin()]);
            let at = |i: usize, j: usize| i % around * across + j % across;
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    obj(&points, &triangles)
}

/// A body with dents and bulges, as organs have.
fn organ() -> MeshSource {
    ball(5, |[x, y, z]| 1.0 + 0.25 * (3.0 * x + y).sin() * (2.0 * z).cos() - 0.1 * (4.0 * y).cos())
}

fn egg() -> MeshSource {
    source("egg.stl")
}

/// Points, edges and sides of the boundary; each edge has two sides.
fn boundary_counts(mesh: &Mesh) -> [usize; 3] {
    let sides = &mesh.groups["surface"].sides;
    let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
    for side in sides {
        for i in 0..3 {
            for j in 0..i {
                *edges.entry([side[j].min(side[i]), side[j].max(side[i])]).or_default() += 1;
            }
        }
    }
    assert!(edges.values().all(|count| *count == 2));
    let points: HashSet<usize> = sides.iter().flatten().copied().collect();
    [points.len(), edges.len(), sides.len()]
}

/// The content of a ball is `4 π r³/3`. Sides between points on a sphere are inside it by up to `h²/(8 r)`: the error is of second order,
/// where that of steps is of first order with a sign that varies.
#[test]
fn the_volume_of_a_ball_converges_with_the_square_of_the_cells() {
    let source = ball(6, |_| 1.0);
    let exact = 4.0 / 3.0 * PI;
    let error = |boundary: FillBoundary| {
        let of = |cell: f64| filled(&fill(&source, "tet4", cell, boundary).unwrap()).volume / exact - 1.0;
        let errors = [0.4, 0.2, 0.1].map(of);
        println!("volume of a ball beside 4 pi/3, {}, %: {:.2?}", boundary.name(), errors.map(|e| 100.0 * e));
        errors
    };
    error(FillBoundary::Stepped);
    let errors = error(FillBoundary::Smooth);
    assert!(errors.iter().all(|e| *e < 0.0));
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..6.0).contains(&ratio), "{errors:?}");
    }
    assert!(errors[2].abs() < 4e-3, "{errors:?}");
}

/// The points of the boundary are on the triangles, which are between the sphere and `s²/6` inside it, with sides s of 1/25.
#[test]
fn the_boundary_is_on_the_surface() {
    let mesh = smooth(&ball(6, |_| 1.0), 0.15);
    for &p in &mesh.groups["surface"].points {
        let r = mesh.point(p).iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(r < 1.0 + 1e-9 && r > 1.0 - 2.7e-4, "{r}");
    }
    // Every other point is inside.
    let outer: HashSet<usize> = mesh.groups["surface"].points.iter().copied().collect();
    let inner = (0..mesh.point_count()).filter(|p| !outer.contains(p));
    assert!(inner.map(|p| mesh.point(p).iter().map(|x| x * x).sum::<f64>().sqrt()).all(|r| r < 1.0));
}

/// 10.7843° and 164.7440° are the bounds that Labelle and Shewchuk (2007) prove for these shares, of cells that are fine enough for the
/// surface to cut an edge once.
#[test]
fn dihedral_angles_are_within_the_bounds_that_are_proved() {
    for (name, source, cells) in [
        ("ball", ball(5, |_| 1.0), [0.31, 0.17, 0.1]),
        ("torus", torus(120, 48), [0.22, 0.15, 0.09]),
        ("organ", organ(), [0.2, 0.13, 0.09]),
        ("egg", egg(), [0.3, 0.2, 0.11]),
    ] {
        for cell in cells {
            let mesh = smooth(&source, cell);
            let [least, largest] = filled(&mesh).angles.unwrap();
            println!("{name}, cells of {cell}: {} cells, {least:.2} to {largest:.2} degrees", mesh.cell_count());
            assert!(least > 10.78 && largest < 164.75, "{name} {cell}: {least} {largest}");
            assert_eq!((filled(&mesh).loose, mesh.quality.pieces), (0, Some(1)));
        }
    }
}

/// The characteristic of Euler is 2 of a sphere and 0 of a torus; the volume of a torus is `2 π² R r²`.
#[test]
fn boundaries_are_closed_and_have_the_topology_of_the_surface() {
    for (source, characteristic) in [(ball(5, |_| 1.0), 2), (organ(), 2), (egg(), 2), (torus(120, 48), 0)] {
        let [points, edges, sides] = boundary_counts(&smooth(&source, 0.15)).map(|count| count as i64);
        assert_eq!(points - edges + sides, characteristic);
    }
    let volume = filled(&smooth(&torus(240, 96), 0.06)).volume;
    assert!((volume / (2.0 * PI * PI * 0.16) - 1.0).abs() < 6e-3, "{volume}");
}

/// Nodes in the middle of edges belong to both cells: there are as many as edges.
#[test]
fn quadratic_tetrahedra_share_the_middles_of_their_edges() {
    let source = ball(4, |_| 1.0);
    let (linear, quadratic) = (smooth(&source, 0.4), fill(&source, "tet10", 0.4, FillBoundary::Smooth).unwrap());
    let mut edges = HashSet::new();
    for nodes in linear.blocks[0].cells() {
        (0..4).for_each(|a| edges.extend((0..a).map(|b| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])])));
    }
    assert_eq!(quadratic.cell_count(), linear.cell_count());
    assert_eq!(quadratic.point_count(), linear.point_count() + edges.len());
    assert_eq!(filled(&quadratic).volume, filled(&linear).volume);
}

#[test]
fn a_hollow_ball_keeps_its_cavity() {
    let outer = ball(5, |_| 1.0);
    let inner = ball(5, |_| 0.5);
    let shift = outer.points.len();
    let mut points: Vec<[f64; 3]> = outer.points.clone();
    points.extend(&inner.points);
    let triangles = |source: &MeshSource| -> Vec<[usize; 3]> {
        source.blocks[0].connectivity.chunks(3).map(|t| [t[0], t[1], t[2]]).collect()
    };
    let mut all = triangles(&outer);
    all.extend(triangles(&inner).iter().map(|[a, b, c]| [shift + a, shift + c, shift + b]));
    let mesh = smooth(&obj(&points, &all), 0.12);
    assert!((filled(&mesh).volume / (4.0 / 3.0 * PI * 0.875) - 1.0).abs() < 6e-3);
    let [points, edges, sides] = boundary_counts(&mesh).map(|count| count as i64);
    assert_eq!(points - edges + sides, 4);
}

#[test]
fn what_a_smooth_boundary_cannot_have_is_refused() {
    let source = ball(3, |_| 1.0);
    let cubes = fill(&source, "hex8", 0.3, FillBoundary::Smooth).unwrap_err().to_string();
    assert_eq!(cubes, "element: expected an element of tetrahedra, which a smooth boundary needs, found hex8");
    let mut open = ball(3, |_| 1.0);
    open.blocks[0].connectivity.truncate(3 * 100);
    let open = fill(&open, "tet4", 0.3, FillBoundary::Smooth).unwrap_err().to_string();
    assert!(open.starts_with("surface: expected a closed surface, found"), "{open}");
    let small = ball(2, |_| 0.1);
    let none = fill(&small, "tet4", 3.0, FillBoundary::Smooth);
    assert!(none.is_ok() || none.unwrap_err().to_string().starts_with("cell: expected a lattice with a point inside"));
    let many = fill(&source, "tet4", 0.001, FillBoundary::Smooth).unwrap_err().to_string();
    assert!(many.starts_with("cell: expected at most 2000000 cells"), "{many}");
}

/// A scene with such a body is solved, and its exact network is the finite element.
#[test]
fn a_scene_fills_a_surface_smoothly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::copy(place("tests/meshes/egg.stl"), folder.path().join("egg.stl")).unwrap();
    let text = |boundary: &str| {
        format!(
            "mesh = {{ fill = {{ surface = \"egg.stl\", cell = 0.5, element = \"tet4\", boundary = \"{boundary}\" }} }}\n\
             material = {{ young = 1e4, poisson = 0.3 }}\nfit = [{{ objective = \"exact\" }}]\n\
             fix = [{{ where = \"z < 0.3\" }}]\nload = [{{ name = \"pull\", group = \"surface\", traction = [1, 0, 0] }}]\n"
        )
    };
    std::fs::write(&path, text("smooth")).unwrap();
    let outcome = run(&Scene::load(&path).unwrap(), &mut |_| ()).unwrap();
    assert!(outcome.fits[0].loads[0].error.unwrap().max < 1e-8);
    std::fs::write(&path, text("smoth")).unwrap();
    let wrong = Scene::load(&path).and_then(|scene| scene.build_mesh()).unwrap_err().to_string();
    assert!(
        wrong.contains("mesh.fill.boundary: expected one of stepped, smooth, found \"smoth\"; did you mean"),
        "{wrong}"
    );
}
