//! Voxels, lattices of points and polygons: files that NumPy and VTK have written (`meshes/grids.py`), arrays of any shape, and faults.

use crate::damage::damaged;
use crate::kit::{place, source};
use crate::shapes::Random;
use proptest::prelude::*;
use springfit_mesh::mesh::{Mesh, MeshSource};
use std::collections::BTreeMap;

fn mesh(source: &MeshSource) -> Mesh {
    Mesh::resolve(source, &[], 1.0).unwrap()
}

fn read_text(text: &str) -> MeshSource {
    MeshSource::parse(text.as_bytes(), "vtk").unwrap()
}

pub(super) fn error(bytes: &[u8], ending: &str) -> String {
    MeshSource::parse(bytes, ending).unwrap_err().to_string()
}

/// The element, the groups and the positions of the nodes of each cell in the order of the element, sorted. Positions are in 2⁻²⁰.
pub(super) fn cells(source: &MeshSource) -> Vec<(String, Vec<String>, Vec<i64>)> {
    let mesh = mesh(source);
    let mut all = Vec::new();
    for (number, block) in mesh.blocks.iter().enumerate() {
        for (cell, nodes) in block.cells().enumerate() {
            let has = |group: &springfit_mesh::mesh::Group| {
                group.cells.iter().any(|at| (at.block, at.cell) == (number, cell))
            };
            let groups = mesh.groups.iter().filter(|(_, group)| has(group)).map(|(name, _)| name.clone()).collect();
            let x = nodes.iter().flat_map(|&p| mesh.point(p)).map(|x| (x * 1048576.0).round() as i64).collect();
            all.push((block.element.name.clone(), groups, x));
        }
    }
    all.sort();
    all
}

/// Labels with the first index fastest.
pub(super) fn label([i, j, k]: [usize; 3]) -> usize {
    (i + 2 * j + 3 * k) % 4
}

/// The boxes of a lattice by their least corners, with the edges of each.
fn boxes(
    counts: [usize; 3],
    name: &str,
    corner: impl Fn([usize; 3]) -> [f64; 3],
) -> Vec<(String, Vec<String>, Vec<i64>)> {
    let mut all = Vec::new();
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let label = label([i, j, k]);
                if label == 0 {
                    continue;
                }
                // The order of a hexahedron in VTK, by the definition of that format.
                let order = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
                let x = order.iter().flat_map(|[a, b, c]| corner([i + a, j + b, k + c]));
                let x = x.map(|x| (x * 1048576.0).round() as i64).collect();
                all.push(("hex8".to_string(), vec![format!("{name}={label}")], x));
            }
        }
    }
    all.sort();
    all
}

#[test]
fn voxels_with_a_label_are_hexahedra_in_a_group_of_the_label() {
    let expected = boxes([4, 3, 2], "label", |at| at.map(|x| x as f64));
    assert_eq!(expected.len(), 18);
    for file in ["labels.npy", "labels_fortran.npy"] {
        assert_eq!(cells(&source(file)), expected, "{file}");
    }
    // Steps of 0.5, 0.25 and 2 from (1, 2, 3).
    let place = |at: [usize; 3]| [1.0 + 0.5 * at[0] as f64, 2.0 + 0.25 * at[1] as f64, 3.0 + 2.0 * at[2] as f64];
    let expected = boxes([4, 3, 2], "tissue", place);
    for file in ["labels.vti", "labels_image.vtk", "labels_points.vti", "labels_points.vtk"] {
        assert_eq!(cells(&source(file)), expected, "{file}");
    }
}

#[test]
fn a_plane_image_is_a_mesh_of_squares() {
    let found = mesh(&source("labels_plane.npy"));
    let expected = (0..12).filter(|at| label([at / 3, at % 3, 1]) > 0).count();
    assert_eq!((found.dimension, found.cell_count(), &*found.blocks[0].element.name), (2, expected, "quad4"));
    assert_eq!(found.groups.keys().collect::<Vec<_>>(), ["label=1"]);
}

/// All files of a grid give the same cells, each a part that varies fastest along x.
#[test]
fn cells_between_the_points_of_a_lattice_are_hexahedra() {
    let steps = [[0.0, 1.0, 1.5, 4.0].as_slice(), &[0.0, 2.0, 3.0], &[-1.0, 0.0, 0.5]];
    for (files, shear) in [(["steps.vtr", "steps.vtk"], 0.0), (["sheared.vts", "sheared.vtk"], 0.5)] {
        for file in files {
            let source = source(file);
            let found = mesh(&source);
            assert_eq!((found.point_count(), found.cell_count()), (36, 12), "{file}");
            // Points keep the order of the file.
            let point = |n: usize| [steps[0][n % 4], steps[1][n / 4 % 3], steps[2][n / 12]];
            for (n, x) in source.points.iter().enumerate() {
                let [a, b, c] = point(n);
                assert_eq!(*x, [a + shear * c, b, c], "{file}");
            }
            let volume: f64 = found.blocks[0]
                .cells()
                .map(|nodes| {
                    let x = |node: usize, axis: usize| found.point(nodes[node])[axis];
                    (x(1, 0) - x(0, 0)) * (x(3, 1) - x(0, 1)) * (x(4, 2) - x(0, 2))
                })
                .sum();
            assert!((volume - 4.0 * 3.0 * 1.5).abs() < 1e-12, "{file}: {volume}");
            let parts: Vec<_> = found.groups.iter().map(|(name, group)| (name.as_str(), group.cells.len())).collect();
            assert_eq!(parts, [("part=0", 4), ("part=1", 4), ("part=2", 4)], "{file}");
            let of_part = &found.groups["part=1"];
            assert!(
                of_part.points.iter().all(|&p| (1.0..=1.5).contains(&(found.point(p)[0] - shear * found.point(p)[2])))
            );
        }
    }
}

/// The strip of triangles turns every other one round, so that all have their normals to the same side.
#[test]
fn polygons_strips_and_lines_are_cells_with_the_numbers_of_the_whole() {
    let reference = source("polygons.vtp");
    let found = mesh(&reference);
    // Polygonal data are surfaces in space.
    assert_eq!((found.dimension, found.cell_count(), found.reversed), (3, 5, 0));
    let sizes: BTreeMap<_, _> =
        found.groups.iter().map(|(name, g)| (name.as_str(), (g.cells.len(), g.points.len()))).collect();
    // The triangle, the quadrangle, three triangles of the strip; a point and a chain of three points.
    let expected = [("part=1", (1, 3)), ("part=2", (1, 4)), ("part=3", (3, 5)), ("part=7", (0, 1)), ("part=8", (0, 3))];
    assert_eq!(sizes, BTreeMap::from(expected));
    for file in ["polygons.vtk", "polygons_binary.vtk"] {
        assert_eq!(source(file), reference, "{file}");
    }
}

/// An array as NumPy writes it: version 1, 2 or 3, of any type of whole numbers, by rows or by columns.
fn npy(shape: &[usize], values: &[u8], version: u8, kind: &str, is_fortran: bool) -> Vec<u8> {
    let counts: Vec<String> = shape.iter().map(usize::to_string).collect();
    let order = if is_fortran { "True" } else { "False" };
    let shape = counts.join(", ");
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}");
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut file = b"\x93NUMPY".to_vec();
    file.extend([version, 0]);
    match version {
        1 => file.extend((header.len() as u16).to_le_bytes()),
        _ => file.extend((header.len() as u32).to_le_bytes()),
    }
    file.extend(header.bytes());
    let size: usize = kind[2..].parse().unwrap();
    for value in values {
        let mut number = vec![0; size];
        number[if kind.starts_with('>') { size - 1 } else { 0 }] = *value;
        file.extend(number);
    }
    file
}

proptest! {
    /// Voxel by voxel: the cells are those with a label, each in its place and its group, whatever the type and the order.
    #[test]
    fn every_array_of_labels_is_a_mesh_of_its_voxels(
        shape in prop::collection::vec(1_usize..5, 2..4),
        seed in any::<u64>(),
        version in 1_u8..4,
        kind in prop::sample::select(vec!["|b1", "|u1", "|i1", "<i2", ">u2", "<i4", ">i4", "<u8", ">i8"]),
        is_fortran in any::<bool>(),
    ) {
        let count: usize = shape.iter().product();
        let most = if kind == "|b1" { 2 } else { 4 };
        let values: Vec<u8> = (0..count).map(|at| ((seed >> (at % 60)) ^ (at as u64 / 7)) as u8 % most).collect();
        let file = npy(&shape, &values, version, kind, is_fortran);
        let mut expected = Vec::new();
        for at in 0..count {
            let mut index = vec![0; shape.len()];
            let mut rest = at;
            let axes: Vec<usize> = if is_fortran { (0..shape.len()).collect() } else { (0..shape.len()).rev().collect() };
            for k in axes {
                index[k] = rest % shape[k];
                rest /= shape[k];
            }
            if values[at] > 0 {
                expected.push((index, values[at]));
            }
        }
        match MeshSource::parse(&file, "npy") {
            Err(error) => {
                prop_assert!(expected.is_empty(), "{error}");
                prop_assert_eq!(error.to_string(), "label: expected a label other than zero, which is background, found zeros alone");
            }
            Ok(source) => {
                let mut found = Vec::new();
                for block in &source.blocks {
                    prop_assert_eq!(block.nodes_per_cell, 1 << shape.len());
                    for nodes in block.connectivity.chunks(block.nodes_per_cell) {
                        let least = |k: usize| nodes.iter().map(|&p| source.points[p][k]).fold(f64::MAX, f64::min) as usize;
                        let label = block.groups[0].strip_prefix("label=").unwrap().parse().unwrap();
                        found.push(((0..shape.len()).map(least).collect::<Vec<_>>(), label));
                    }
                }
                found.sort();
                expected.sort();
                prop_assert_eq!(found, expected);
                let mut points = source.points.clone();
                points.sort_by(|a, b| a.partial_cmp(b).unwrap());
                points.dedup();
                prop_assert_eq!(points.len(), source.points.len(), "neighbours share their corners");
            }
        }
    }
}

/// Cut, changed and lengthened: a fault is one line, and what is accepted is sound.
#[test]
fn no_damaged_file_of_any_format_makes_a_reader_panic() {
    let mut random = Random(11);
    let folder = place("fuzz/corpus/formats");
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for path in files {
        let whole = std::fs::read(&path).unwrap();
        for round in 0..60 {
            let bytes = damaged(&whole, round, &mut random);
            let found = std::panic::catch_unwind(|| crate::corpora::formats::check(&bytes));
            assert!(found.is_ok(), "{}: {bytes:?}", path.display());
        }
    }
}

#[test]
fn faults_of_an_array_name_what_is_expected() {
    let whole = npy(&[2, 2], &[1; 4], 1, "|u1", false);
    assert_eq!(error(b"PK", "npy"), "header: expected an array of NumPy, which begins with \\x93NUMPY, found \"PK\"");
    assert_eq!(error(&whole[..40], "npy"), "the file ends inside header");
    assert_eq!(error(&whole[..whole.len() - 1], "npy"), "data: expected (2, 2) numbers of 1 bytes, found 3 bytes");
    let real = npy(&[2, 2], &[1; 4], 1, "<f8", false);
    let expected = "descr: expected whole numbers or bool, such as '<i4' or '|b1', found \"'<f8'\"; labels.astype(\"int32\") makes them";
    assert_eq!(error(&real, "npy"), expected);
    let line = npy(&[4], &[1; 4], 1, "|u1", false);
    assert_eq!(error(&line, "npy"), "shape: expected an array of 2 or 3 dimensions, found (4)");
    let none = npy(&[0, 3], &[], 1, "|u1", false);
    assert_eq!(error(&none, "npy"), "shape: expected at least one voxel, found (0, 3)");
    let mut wrong = whole.clone();
    wrong[6] = 9;
    assert_eq!(error(&wrong, "npy"), "header: expected version 1, 2 or 3, found 9");
    let grey: Vec<u8> = (0..2048_u16).flat_map(u16::to_le_bytes).collect();
    let mut file = npy(&[64, 32], &[], 1, "<u2", false);
    file.extend(grey);
    let expected = "label: expected at most 1000 different labels, found more: is it an image of grey values?";
    assert_eq!(error(&file, "npy"), expected);
}

#[test]
fn faults_of_images_and_lattices_name_what_is_expected() {
    let image = |arrays: &str| {
        let head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n";
        error(format!("{head}{arrays}").as_bytes(), "vtk")
    };
    let expected = "image: expected one array of whole numbers of cells or points, whose zeros are background, found ";
    let whole = read_text(
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n",
    );
    assert_eq!(mesh(&whole).cell_count(), 2);
    assert!(whole.annotations.notes()[0].contains("the image has no labels"));
    let two = "CELL_DATA 2\nFIELD f 2\na 1 2 int\n1 1\nb 1 2 int\n0 1\n";
    assert_eq!(image(two), format!("{expected}\"a\", \"b\""));
    assert_eq!(image("CELL_DATA 3\n"), "line 8: CELL_DATA: expected 2 cells, found 3");
    let grid = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 2 double\n0 0 0 1 1 1\n";
    assert_eq!(error(grid.as_bytes(), "vtk"), "POINTS: expected 8 by the dimensions, found 2");
    let lattice = grid.replace("2 2 2", "2 0 2");
    let expected = "line 5: DIMENSIONS: expected three counts of points above zero, found [2, 0, 2]";
    assert_eq!(error(lattice.as_bytes(), "vtk"), expected);
    let huge = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 9000 9000 1\nX_COORDINATES 1 int\n0\n\
                Y_COORDINATES 1 int\n0\nZ_COORDINATES 1 int\n0\n";
    assert_eq!(error(huge.as_bytes(), "vtk"), "X_COORDINATES: expected 9000 by the dimensions, found 1");
    let xml = |kind: &str, piece: &str| {
        error(format!("<VTKFile type=\"{kind}\"><{kind}>{piece}</{kind}></VTKFile>").as_bytes(), "vti")
    };
    assert!(xml("Table", "").contains("VTKFile.type: expected one of UnstructuredGrid, PolyData, ImageData"));
    assert!(xml("ImageData", "<Piece Extent=\"0 1 0 1\"/>").contains("Extent: expected six whole numbers"));
    let twice = "<Piece Extent=\"0 1 0 1 0 1\"/>".repeat(2);
    for kind in ["ImageData", "StructuredGrid", "RectilinearGrid"] {
        let overlapping = xml(kind, &twice);
        let expected =
            "Piece.Extent: expected pieces whose cells fill [0, 0, 0] to [1, 1, 1], which are 1, found 2 cells";
        assert!(overlapping.contains(expected), "{overlapping}");
    }
    let apart = "<Piece Extent=\"0 1 0 1 0 1\"/><Piece Extent=\"9 10 0 1 0 1\"/>";
    assert!(xml("ImageData", apart).contains("which are 10, found 2 cells"));
    let huge = "<Piece Extent=\"0 4000 0 4000 0 1\"/><Piece Extent=\"0 4000 0 4000 1 2\"/>";
    assert!(xml("ImageData", huge).contains("expected at most 8388608 points, found up to"));
    let far = format!("<Piece Extent=\"{0} {0} 0 1 0 1\"/><Piece Extent=\"{1} {1} 0 1 0 1\"/>", i64::MIN, i64::MAX);
    assert!(xml("ImageData", &far).contains("Piece.Extent"));
}
