//! Voxels that are divided into tetrahedra.

use crate::kit::{self, place, ran};
use crate::shapes::loaded;
use springfit_element::element::Element;
use springfit_mesh::mesh::{CellIndex, Mesh, Selection, VoxelMesh};
use std::fs;
use std::sync::Arc;
use tempfile::TempDir;

fn element(name: &str) -> Arc<Element> {
    loaded(name)
}

/// `(b − a)·((c − a) × (d − a))/6`, without its sign.
fn volume(mesh: &Mesh, cell: &CellIndex) -> f64 {
    let nodes = mesh.blocks[cell.block].cells().nth(cell.cell).unwrap();
    let x: Vec<&[f64]> = nodes.iter().map(|&p| mesh.point(p)).collect();
    let [a, b, c] = [1, 2, 3].map(|i| [0, 1, 2].map(|k| x[i][k] - x[0][k]));
    let det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    det.abs() / 6.0
}

/// Six tetrahedra of each voxel have its volume and its label, and agree with their neighbours: a side that did not would be an outer one.
#[test]
fn voxels_are_divided_into_tetrahedra_that_agree() {
    for file in ["labels.npy", "labels.vti", "labels_points.vtk"] {
        for is_mirrored in [false, true] {
            let mut source = kit::source(file);
            if is_mirrored {
                source.points.iter_mut().for_each(|x| x[0] = -x[0]);
            }
            let cubes = Mesh::resolve(&kit::source(file), &[], 1e-3).unwrap();
            let mesh = VoxelMesh { element: element("tet4") }.build(&source, 1e-3).unwrap();
            assert_eq!(mesh.cell_count(), 6 * cubes.cell_count(), "{file}");
            assert_eq!(
                (mesh.point_count(), mesh.reversed, mesh.quality.overlapping),
                (cubes.point_count(), 0, 0),
                "{file}"
            );
            assert_eq!(mesh.quality.pieces, cubes.quality.pieces, "{file}");
            let outer = |mesh: &Mesh| Selection::Everything.sides(mesh).unwrap().len();
            assert_eq!(outer(&mesh), 2 * outer(&cubes), "{file}");
            assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), cubes.groups.keys().collect::<Vec<_>>());
            let voxel = volume_of_a_voxel(&cubes);
            for (name, group) in &mesh.groups {
                let total: f64 = group.cells.iter().map(|cell| volume(&mesh, cell)).sum();
                let expected = voxel * cubes.groups[name].cells.len() as f64;
                assert!((total / expected - 1.0).abs() < 1e-9, "{file} {name}: {total} {expected}");
            }
        }
    }
}

/// The product of the edges of the first voxel: voxels of an image are boxes with edges along its steps.
fn volume_of_a_voxel(cubes: &Mesh) -> f64 {
    let nodes = cubes.blocks[0].cells().next().unwrap();
    let ends = |k: usize| {
        nodes.iter().map(|&p| cubes.point(p)[k]).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)))
    };
    (0..3).map(|k| ends(k).1 - ends(k).0).product()
}

#[test]
fn hexahedra_that_are_no_voxels_are_refused() {
    let mut source = kit::source("labels.npy");
    let node = source.blocks[0].connectivity[6];
    source.points[node][0] += 0.2;
    let message = VoxelMesh { element: element("tet4") }.build(&source, 1.0).unwrap_err().to_string();
    assert!(
        message.starts_with(
            "surface: expected a closed surface, or voxels of an image, found hexahedra of which cell 1 does not"
        ),
        "{message}"
    );
    let hexahedra = VoxelMesh { element: element("hex8") }.build(&kit::source("labels.npy"), 1.0).unwrap();
    assert_eq!(hexahedra.cell_count(), Mesh::resolve(&kit::source("labels.npy"), &[], 1.0).unwrap().cell_count());
}

#[test]
fn the_program_divides_voxels_and_writes_the_key_into_the_scene() {
    let folder = TempDir::new().unwrap();
    fs::copy(place("tests/meshes/labels.npy"), folder.path().join("labels.npy")).unwrap();
    let run = |words: &[&str]| {
        let (code, told) = ran(folder.path(), words);
        assert_eq!(code, Some(0), "{words:?}: {told}");
        told
    };
    run(&["new", "labels.npy", "--scale", "2 mm", "--fill-element", "tet4", "-o", "labels.toml"]);
    let scene = fs::read_to_string(folder.path().join("labels.toml")).unwrap();
    assert!(scene.contains("fill  = { surface = \"labels.npy\", element = \"tet4\" }\n"), "{scene}");
    let told = run(&["run", "labels.toml"]);
    assert!(told.contains(" tet4, ") && !told.contains("reversed"), "{told}");
}
