//! Bodies that tests share, and a writer of their meshes.

use super::{Random, loaded};
use springfit_element::element::Element;
use springfit_foundation::error::Result;
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Write;
use std::sync::Arc;

/// A box of cells of one element at the origin.
pub fn boxed(element: &Arc<Element>, size: &[f64], cells: &[usize]) -> Result<Mesh> {
    let origin = vec![0.0; cells.len()];
    BoxMesh { element: element.clone(), size: size.to_vec(), cells: cells.to_vec(), origin }.build()
}

/// A box of cells at the origin.
pub fn grid(name: &str, size: &[f64], cells: &[usize]) -> Mesh {
    boxed(&loaded(name), size, cells).unwrap()
}

/// A body whose points are moved by a map.
pub fn mapped(mut mesh: Mesh, map: impl Fn(&[f64]) -> Vec<f64>) -> Mesh {
    mesh.points = mesh.points.chunks_exact(mesh.dimension).flat_map(map).collect();
    mesh
}

/// The unit cube onto the sixth of a thick sphere around the z axis.
pub fn patch(inner: f64, outer: f64) -> impl Fn(&[f64]) -> Vec<f64> {
    move |x| {
        let (a, b) = ((FRAC_PI_4 * (2.0 * x[0] - 1.0)).tan(), (FRAC_PI_4 * (2.0 * x[1] - 1.0)).tan());
        let r = (inner + (outer - inner) * x[2]) / (a * a + b * b + 1.0).sqrt();
        vec![r * a, r * b, r]
    }
}

/// A thick sphere of six patches of hexahedra.
pub fn sphere(name: &str, inner: f64, outer: f64, [across, through]: [usize; 2]) -> Mesh {
    let one = mapped(grid(name, &[1.0, 1.0, 1.0], &[across, across, through]), patch(inner, outer));
    // Proper rotations, by rows, that take the z axis to each of the six half axes.
    let turns: [[[f64; 3]; 3]; 6] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]],
    ];
    let (mut points, mut connectivity, mut known) = (Vec::new(), Vec::new(), HashMap::new());
    for turn in turns {
        for &p in &one.blocks[0].connectivity {
            let x = one.point(p);
            let x = turn.map(|row| row.iter().zip(x).map(|(t, x)| t * x).sum::<f64>());
            let place = *known.entry(x.map(|x| (x * 1e8).round() as i64)).or_insert_with(|| {
                points.extend(x);
                points.len() / 3 - 1
            });
            connectivity.push(place);
        }
    }
    Mesh::of_cells(3, points, vec![CellBlock { element: one.blocks[0].element.clone(), connectivity }])
}

/// Points, `[points × dimension]`, and groups of linear cells, each with its name and its dimension, as a file of Gmsh, version 2.2.
pub fn gmsh_text(dimension: usize, points: &[f64], groups: &[(&str, usize, Vec<Vec<usize>>)]) -> String {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", groups.len());
    for (tag, (name, dimension, _)) in groups.iter().enumerate() {
        writeln!(text, "{dimension} {} \"{name}\"", tag + 1).unwrap();
    }
    writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", points.len() / dimension).unwrap();
    for (p, x) in points.chunks_exact(dimension).enumerate() {
        writeln!(text, "{} {:?} {:?} {:?}", p + 1, x[0], x[1], x.get(2).unwrap_or(&0.0)).unwrap();
    }
    writeln!(text, "$EndNodes\n$Elements\n{}", groups.iter().map(|(.., cells)| cells.len()).sum::<usize>()).unwrap();
    let mut number = 0;
    for (tag, (_, dimension, cells)) in groups.iter().enumerate() {
        for nodes in cells {
            let kind = match (dimension, nodes.len()) {
                (1, 2) => 1,
                (2, 3) => 2,
                (2, 4) => 3,
                (3, 4) => 4,
                (3, 8) => 5,
                other => panic!("no linear cell: {other:?}"),
            };
            number += 1;
            let nodes = nodes.iter().map(|node| (node + 1).to_string()).collect::<Vec<_>>().join(" ");
            writeln!(text, "{number} {kind} 2 {0} {0} {nodes}", tag + 1).unwrap();
        }
    }
    text + "$EndElements\n"
}

/// The unit square as squares of two triangles, whose inner points are moved by up to a share of a side; whether the diagonal of a square leads from its
/// first point to the third.
pub fn triangles(
    [nx, ny]: [usize; 2],
    share: f64,
    leans: impl Fn(usize, usize) -> bool,
) -> (Vec<[f64; 2]>, Vec<usize>) {
    let mut random = Random(7);
    let mut points = Vec::new();
    for (i, j) in (0..=ny).flat_map(|j| (0..=nx).map(move |i| (i, j))) {
        let is_inner = i > 0 && i < nx && j > 0 && j < ny;
        let mut shift = || if share > 0.0 && is_inner { share * random.next() } else { 0.0 };
        points.push([(i as f64 + shift()) / nx as f64, (j as f64 + shift()) / ny as f64]);
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let a = j * (nx + 1) + i;
        let [b, c, d] = [a + 1, a + nx + 2, a + nx + 1];
        triangles.extend(if leans(i, j) { [a, b, c, a, c, d] } else { [a, b, d, b, c, d] });
    }
    (points, triangles)
}

/// A surface in space of these triangles.
pub fn of_triangles(points: Vec<f64>, connectivity: Vec<usize>) -> Mesh {
    let element = Arc::new(Element::load("tri3").unwrap().in_space(3));
    Mesh::of_cells(3, points, vec![CellBlock { element, connectivity }])
}

/// A surface with directors, of thickness t.
pub fn bending(mesh: Mesh, t: f64) -> Mesh {
    let count = mesh.cell_count();
    mesh.with_directors(vec![t * t / 12.0; count]).unwrap()
}

/// Points, `[points × 3]`, and cells, each with its type, as a legacy file of VTK.
pub fn vtk_text(points: &[f64], cells: &[(u8, Vec<usize>)]) -> String {
    let lines = |lines: &mut dyn Iterator<Item = String>| lines.map(|line| line + "\n").collect::<String>();
    let listed = |nodes: &[usize]| nodes.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    let (count, size) = (cells.len(), cells.iter().map(|(_, nodes)| nodes.len() + 1).sum::<usize>());
    format!(
        "# vtk DataFile Version 3.0\nbody\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n{}CELLS {count} {size}\n{}\
         CELL_TYPES {count}\n{}",
        points.len() / 3,
        lines(&mut points.chunks_exact(3).map(|x| format!("{:?} {:?} {:?}", x[0], x[1], x[2]))),
        lines(&mut cells.iter().map(|(_, nodes)| format!("{} {}", nodes.len(), listed(nodes)))),
        lines(&mut cells.iter().map(|(kind, _)| kind.to_string()))
    )
}
