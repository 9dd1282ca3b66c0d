//! Closed surfaces that are filled with cells.

use crate::kit::{outcome, place};
use crate::shapes::loaded;
use springfit_bodies::model::{Action, nodal_forces};
use springfit_element::element::Element;
use springfit_mesh::mesh::{FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Mesh, MeshSource, Selection};
use springfit_report::report::{Report, notes_beside_summary};
use std::sync::Arc;

fn element(name: &str) -> Arc<Element> {
    loaded(name)
}

fn fill(source: &MeshSource, name: &str, cell: f64) -> springfit_foundation::error::Result<Mesh> {
    let (boundary, layers) = (FillBoundary::Stepped, FillLayers::Refuse);
    FillMesh { element: element(name), spacing: FillSpacing::Edge(cell), boundary, layers, repair: false }
        .build(source, 1.0)
}

fn filled(mesh: &Mesh) -> &Filled {
    mesh.quality.filled.as_ref().unwrap()
}

fn egg() -> MeshSource {
    MeshSource::read(&place("tests/meshes/egg.stl")).unwrap()
}

/// The sides of a box as quadrangles of an OBJ file with normals outwards, or inwards; `before` points are before it.
pub(super) fn brick(low: [f64; 3], high: [f64; 3], is_inwards: bool, before: usize) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let at = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        text += &format!("v {} {} {}\n", at(0), at(1), at(2));
    }
    for mut side in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        if is_inwards {
            side.reverse();
        }
        let [a, b, c, d] = side.map(|i| before + i + 1);
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

fn obj(text: &str) -> MeshSource {
    MeshSource::parse(text.as_bytes(), "obj").unwrap()
}

fn unit(is_inwards: bool) -> String {
    brick([0.0; 3], [2.0, 1.0, 1.0], is_inwards, 0)
}

#[test]
fn a_brick_is_filled_to_its_sides() {
    let mesh = fill(&obj(&unit(false)), "hex8", 0.25).unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count()), (128, 9 * 5 * 5));
    let found = filled(&mesh);
    assert_eq!((found.volume, found.loose), (2.0, 0));
    assert!((found.surface_volume - 2.0).abs() < 1e-12);
    assert_eq!(mesh.groups["surface"].sides.len(), 2 * (8 * 4 + 8 * 4 + 4 * 4));
    assert_eq!(mesh.groups["surface"].points.len(), 9 * 5 * 5 - 7 * 3 * 3);
    assert_eq!(mesh.groups["body"].cells.len(), 128);
    let quadratic = fill(&obj(&unit(false)), "hex20", 0.5).unwrap();
    assert_eq!(quadratic.cell_count(), 16);
}

/// The solid angle of a triangle by Van Oosterom and Strackee (1983), summed: 4π inside, 0 outside.
fn winding(source: &MeshSource, at: [f64; 3]) -> f64 {
    let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut total = 0.0;
    for block in &source.blocks {
        for nodes in block.connectivity.chunks(block.nodes_per_cell) {
            for i in 2..nodes.len() {
                let from = |n: usize| [0, 1, 2].map(|k| source.points[n][k] - at[k]);
                let [a, b, c] = [nodes[0], nodes[i - 1], nodes[i]].map(from);
                let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
                let [x, y, z] = [&a, &b, &c].map(|v| dot(v, v).sqrt());
                let below = x * y * z + dot(&a, &b) * z + dot(&b, &c) * x + dot(&c, &a) * y;
                total += 2.0 * dot(&a, &cross).atan2(below);
            }
        }
    }
    total / (4.0 * std::f64::consts::PI)
}

fn centres(mesh: &Mesh) -> Vec<[f64; 3]> {
    let block = &mesh.blocks[0];
    let mean =
        |nodes: &[usize]| [0, 1, 2].map(|k| nodes.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / nodes.len() as f64);
    block.cells().map(mean).collect()
}

/// The solid angles are another way to the same answer; the number of cells inside is that of the lattice.
#[test]
fn cells_are_those_whose_centres_the_surface_winds_around() {
    let source = egg();
    for (name, cell) in [("hex8", 0.17), ("tet4", 0.3)] {
        let mesh = fill(&source, name, cell).unwrap();
        assert!(centres(&mesh).into_iter().all(|at| (winding(&source, at) - 1.0).abs() < 1e-9), "{name}");
        if name == "hex8" {
            // Every centre of the lattice, which is symmetric about the middle of the egg's box.
            let first = centres(&mesh)[0];
            let mut inside = 0;
            for i in -9..9 {
                for j in -9..9 {
                    for k in -2..18 {
                        let at = [i, j, k].map(f64::from);
                        inside += usize::from(winding(&source, [0, 1, 2].map(|k| first[k] + cell * at[k])) > 0.5);
                    }
                }
            }
            assert_eq!(inside, mesh.cell_count() + filled(&mesh).loose);
        }
    }
}

/// The volume of the egg is that of trimesh 5.2; the error of the fill falls with the size of the cells.
#[test]
fn volumes_approach_that_of_the_surface() {
    for name in ["hex8", "tet4"] {
        let mesh = fill(&egg(), name, 0.1).unwrap();
        let found = filled(&mesh);
        assert!((found.surface_volume - VOLUME).abs() < 1e-6);
        assert!((found.volume / VOLUME - 1.0).abs() < 0.01, "{name}: {}", found.volume);
        assert_eq!(mesh.quality.pieces, Some(1));
    }
}

const VOLUME: f64 = 3.805_060_582_550_73;

/// `det J / Π ‖J_l‖` of each tetrahedron.
#[test]
fn tetrahedra_of_a_fill_are_congruent() {
    let mesh = fill(&egg(), "tet4", 0.2).unwrap();
    for nodes in mesh.blocks[0].cells() {
        let x: Vec<&[f64]> = nodes.iter().map(|&p| mesh.point(p)).collect();
        let [a, b, c] = [1, 2, 3].map(|i| [0, 1, 2].map(|k| x[i][k] - x[0][k]));
        let det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        let lengths: f64 = [a, b, c].iter().map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt()).product();
        assert!((det / lengths - 2.0 / 3.0).abs() < 1e-9, "{}", det / lengths);
        assert!((det / 6.0 - 0.2f64.powi(3) / 12.0).abs() < 1e-12);
    }
}

#[test]
fn open_and_turned_surfaces_are_refused_with_a_place() {
    let message = |text: &str| fill(&obj(text), "hex8", 0.25).unwrap_err().to_string();
    let open = unit(false).rsplit_once("f ").unwrap().0.to_string();
    let expected = "surface: expected a closed surface, found 4 edges of one triangle alone: holes, one from \
                    (2, 1, 0) m to (2, 0, 0) m; repair = true (--repair)";
    assert!(message(&open).starts_with(expected), "{}", message(&open));
    let turned = open + "f 6 8 4 2\n";
    assert!(message(&turned).contains("4 edges between triangles that are turned differently"), "{}", message(&turned));
    let inwards = fill(&obj(&unit(true)), "hex8", 0.25).unwrap();
    assert!(filled(&inwards).turned && inwards.cell_count() == 128);
}

#[test]
fn cavities_are_left_free_and_hinges_left_out() {
    let outer = brick([0.0; 3], [4.0; 3], false, 0);
    let hollow = fill(&obj(&(outer + &brick([1.0; 3], [3.0; 3], true, 8))), "hex8", 1.0).unwrap();
    assert_eq!((hollow.cell_count(), filled(&hollow).volume), (56, 56.0));
    assert!((filled(&hollow).surface_volume - 56.0).abs() < 1e-12);
    // Two cubes that touch at an edge: one hangs on the other as on a hinge.
    let hinge = brick([0.0; 3], [2.0; 3], false, 0) + &brick([2.0, 2.0, 0.0], [3.0, 3.0, 2.0], false, 8);
    let mesh = fill(&obj(&hinge), "hex8", 1.0).unwrap();
    assert_eq!((mesh.cell_count(), filled(&mesh).loose), (8, 2));
}

#[test]
fn cells_are_bounded_before_they_are_made() {
    let message = |cell: f64| fill(&obj(&unit(false)), "tet4", cell).unwrap_err().to_string();
    let expected = "cell: expected at most 2000000 cells, which edges of 2.4e-2 m give, found about 24000000";
    assert_eq!(message(0.01), expected);
    assert!(message(1e-12).contains("expected at most 2000000 cells"));
    let flat = brick([0.0; 3], [1.0, 1.0, 0.01], false, 0);
    assert_eq!(fill(&obj(&flat), "hex8", 0.01).unwrap().cell_count(), 10_000);
    let needle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let coarse = fill(&obj(needle), "hex8", 2.0).unwrap_err().to_string();
    assert!(
        coarse.starts_with("cell: expected cells whose centres are inside the surface: a smaller cell"),
        "{coarse}"
    );
    let wrong = fill(&obj(needle), "tri3", 0.1).unwrap_err().to_string();
    assert_eq!(wrong, "element: expected an element of hexahedra or tetrahedra, found tri3");
}

/// Corners, edges and sides of the surface in line with the centres of cells: each is decided, and both halves are alike.
#[test]
fn centres_on_the_surface_are_decided_alike() {
    let octahedron = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nf 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\n\
                      f 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    for cell in [0.5, 0.4, 0.25, 2.0 / 7.0] {
        for name in ["hex8", "tet4"] {
            let mesh = fill(&obj(octahedron), name, cell).unwrap();
            let found = filled(&mesh);
            assert_eq!((found.overlaps, found.inverted), (None, None), "{name} {cell}");
            let outside = centres(&mesh).into_iter().filter(|at| at.iter().map(|x| x.abs()).sum::<f64>() > 1.0 + 1e-12);
            assert_eq!(outside.count(), 0, "{name} {cell}");
        }
    }
}

/// The area of steps is larger than that of an egg whatever the size of cells; what a fill found is in the notes of the report.
#[test]
fn tractions_on_steps_and_what_a_fill_found_are_notes() {
    let egg = place("tests/meshes/egg.stl");
    let scene = |rest: &str| {
        outcome(&format!(
            "[mesh]\nfill = {{ surface = {egg:?}, {rest} }}\n[material]\nyoung = 1e4\npoisson = 0.3\n[[fit]]\nobjective = \"exact\"\n\
             [[fix]]\nwhere = \"z < 0\"\n[[load]]\nname = \"wind\"\ngroup = \"surface\"\ntraction = [0, 0, 1]\n"
        ))
    };
    for (rest, is_stepped) in [
        ("cell = 0.4", true),
        ("cell = 0.3, element = \"tet4\"", true),
        ("cell = 0.4, element = \"tet4\", boundary = \"smooth\"", false),
    ] {
        let outcome = scene(rest);
        let notes = Report::of(&outcome).notes;
        assert!(notes.iter().any(|note| note.contains("fill a surface")), "{rest}: {notes:?}");
        assert!(!notes_beside_summary(&outcome).iter().any(|note| note.contains("fill a surface")), "{rest}");
        let stepped = notes.iter().any(|note| note.starts_with("the traction wind acts on a stepped boundary"));
        assert_eq!(stepped, is_stepped, "{rest}: {notes:?}");
        let filled = filled(&outcome.mesh);
        if let Some(area) = filled.stepped_area {
            // By the forces: a traction of 1 Pa on all sides.
            let along = nodal_forces(
                &outcome.mesh,
                &Selection::Group("surface".into()),
                &Action::traction(&[1.0, 0.0, 0.0]),
                1.0,
            );
            let total: f64 = along.unwrap().iter().sum();
            assert!(
                (total / area - 1.0).abs() < 1e-9 && area > 1.1 * filled.surface_area,
                "{rest}: {total} {filled:?}"
            );
        }
    }
}

/// A coarse fill is far from the volume of its surface; layers have no volume to compare with.
#[test]
fn volumes_far_off_and_volumes_of_layers_are_told() {
    let fill = |text: &str, cell: f64| {
        let (boundary, layers) = (FillBoundary::Stepped, FillLayers::Union);
        let mesh =
            FillMesh { element: element("hex8"), spacing: FillSpacing::Edge(cell), boundary, layers, repair: false }
                .build(&obj(text), 1.0)
                .unwrap();
        filled(&mesh).clone()
    };
    // Cells of another size than the body make another body.
    for (cell, size) in [(4.0, [1.0; 3]), (0.3, [1.0, 1.0, 0.1])] {
        let (boundary, layers) = (FillBoundary::Stepped, FillLayers::Union);
        let spacing = FillSpacing::Edge(cell);
        let fill = FillMesh { element: element("hex8"), spacing, boundary, layers, repair: false };
        let said = fill.build(&obj(&brick([0.0; 3], size, false, 0)), 1.0).unwrap_err().to_string();
        assert!(
            said.contains(
                "cell: expected cells with the volume of the surface within a factor of two, such as edges of at most"
            ),
            "{said}"
        );
    }
    let coarse = fill(&brick([0.0; 3], [1.0, 1.0, 1.25], false, 0), 1.0);
    assert!(coarse.excess().unwrap().abs() > 10.0 && coarse.far_off().is_some(), "{coarse:?}");
    let fine = fill(&brick([0.0; 3], [1.0, 1.0, 1.25], false, 0), 0.25);
    assert!(fine.far_off().is_none() && fine.lines()[0].ends_with("+0.00 %"), "{fine:?}");
    assert!(fine.steps().is_none(), "{fine:?}");
    let two = brick([0.0; 3], [10.0; 3], false, 0) + &brick([5.0; 3], [15.0; 3], false, 8);
    let two = fill(&two, 1.25);
    assert!(two.excess().is_none() && two.far_off().is_none(), "{two:?}");
    assert!(two.lines()[0].contains("cannot be compared") && !two.lines()[0].contains('%'), "{:?}", two.lines());
    let one = Filled { cells: 1, flat: 1, loose: 1, branched: Some((1, [0.0; 3])), ..fine };
    for words in ["1 cell fills", "1 triangle without an area was", "1 edge of the surface has", "1 cell that hung"] {
        assert!(one.lines().iter().any(|line| line.starts_with(words)), "{words}: {:?}", one.lines());
    }
}
