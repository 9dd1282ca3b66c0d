//! The numbers that a file gives its nodes, in every export of a network, and what a report says of what was not looked for.

use crate::kit;
use crate::kit::place;
use crate::shapes::Random;
use serde_json::Value;
use springfit_bodies::model::Network;
use springfit_mesh::mesh::{Mesh, MeshSource};
use springfit_report::report::{NetworkFile, Report, network_csv, network_grid, network_json, report, summary};
use springfit_studies::study::Outcome;
use std::collections::BTreeMap;
use std::fs;
use tempfile::TempDir;

/// A square of two triangles with a node between that no cell has.
const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n12 0 0 0\n7 5 5 0\n30 2 0 0\n41 2 3 0\n8 0 3 0\n$EndNodes\n\
                    $Elements\n2\n1 2 2 1 1 12 30 41\n2 2 2 1 1 12 41 8\n$EndElements\n";
const VTK: &str = "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n5 5 0\n2 0 0\n2 3 0\n0 3 0\n\
                   CELLS 2 8\n3 0 2 3\n3 0 3 4\nCELL_TYPES 2\n5 5\n";

fn outcome(mesh: &str) -> Outcome {
    kit::outcome(&format!(
        "[mesh]\n{mesh}\n[material]\nyoung = 1e4\npoisson = 0.3\nplane = \"stress\"\n[[fit]]\nobjective = \"offdiag\"\n"
    ))
}

fn csv(mesh: &Mesh, network: &Network) -> String {
    let mut text = Vec::new();
    network_csv(mesh, network, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn json(mesh: &Mesh, network: &Network) -> Value {
    let mut text = Vec::new();
    network_json(&NetworkFile::bare(mesh, network), &mut text).unwrap();
    serde_json::from_slice(&text).unwrap()
}

/// The constants of the springs by the numbers of their points.
fn springs(csv: &str) -> BTreeMap<Vec<u64>, String> {
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["kind", "points", "constant", "rest", "unit", "nodes"]);
    let row = |row: &Vec<&str>| {
        let mut nodes: Vec<u64> = row[5].split(' ').map(|n| n.parse().unwrap()).collect();
        nodes.sort_unstable();
        (nodes, row[2].to_string())
    };
    rows[1..].iter().map(row).collect()
}

#[test]
fn exports_have_the_numbers_of_the_file() {
    let folder = TempDir::new().unwrap();
    // The lengths of the springs by the numbers of the file, from the coordinates above.
    let diagonal = 13f64.sqrt();
    for (file, content, title, numbers) in [
        ("m.msh", GMSH, "Gmsh node tags", [12, 30, 41, 8]),
        ("m.vtk", VTK, "places in the VTK file, from 0", [0, 2, 3, 4]),
    ] {
        let path = folder.path().join(file);
        fs::write(&path, content).unwrap();
        let outcome = outcome(&format!("file = \"{}\"", path.display()));
        let [a, b, c, d] = numbers;
        let lengths = BTreeMap::from([([a, b], 2.0), ([b, c], 3.0), ([c, d], 2.0), ([a, d], 3.0), ([a, c], diagonal)]);
        let lengths: BTreeMap<Vec<u64>, f64> = lengths
            .into_iter()
            .map(|(mut ends, length)| {
                ends.sort_unstable();
                (ends.to_vec(), length)
            })
            .collect();
        let (mesh, network) = (&outcome.mesh, &outcome.fits[0].network);
        let csv = csv(mesh, network);
        assert!(springs(&csv).keys().eq(lengths.keys()), "{csv}");
        for line in csv.lines().skip(1) {
            let row: Vec<&str> = line.split(',').collect();
            let mut nodes: Vec<u64> = row[5].split(' ').map(|n| n.parse().unwrap()).collect();
            nodes.sort_unstable();
            assert!((row[3].parse::<f64>().unwrap() - lengths[&nodes]).abs() < 1e-12, "{line}");
        }
        let json = json(mesh, network);
        assert_eq!(json["nodes"], serde_json::json!(numbers));
        assert_eq!(json["numbering"], title);
        assert_eq!(json["points"].as_array().unwrap().len(), 4);
        let grid = network_grid(&NetworkFile::of(&outcome, &outcome.fits[0]));
        let array = grid.point_data.iter().find(|array| array.name == "node").unwrap();
        assert!(array.values.iter().map(|n| *n as u64).eq(numbers), "{:?}", array.values);
        let words = summary(&outcome);
        assert!(
            words.contains("1 points of the file belong to no cell of the body") && words.contains(title),
            "{words}"
        );
    }
    // What is generated has no numbers of a file.
    let outcome = outcome("box = { element = \"tri3\", size = [1, 1], cells = [1, 1] }");
    let csv = csv(&outcome.mesh, &outcome.fits[0].network);
    assert!(csv.starts_with("kind,points,constant,rest,unit\n"), "{csv}");
    let json = json(&outcome.mesh, &outcome.fits[0].network);
    assert!(json["nodes"].is_null() && json["numbering"].is_null());
}

/// A spring keeps its numbers and its constant when nodes that no cell has are put between the others.
#[test]
fn nodes_without_a_cell_do_not_renumber_springs() {
    let folder = TempDir::new().unwrap();
    let original = place("scenes/meshes/square_tri.msh");
    let source = MeshSource::read(&original).unwrap();
    let mut random = Random(6);
    let of_nodes = |extra: bool, random: &mut Random| {
        let mut nodes = Vec::new();
        for (number, [x, y, z]) in source.numbers.iter().zip(&source.points) {
            if extra && random.next() > 0.5 {
                nodes.push(format!("{} 7 {} 0", 1_000_000 + nodes.len(), random.next()));
            }
            nodes.push(format!("{number} {x:?} {y:?} {z:?}"));
        }
        let triangles = source.blocks.iter().filter(|block| block.cell_type == 2);
        let cells: Vec<String> = triangles
            .flat_map(|block| block.connectivity.chunks_exact(3))
            .enumerate()
            .map(|(i, c)| {
                let [a, b, c] = [c[0], c[1], c[2]].map(|p| source.numbers[p]);
                format!("{} 2 2 1 1 {a} {b} {c}", i + 1)
            })
            .collect();
        let path = folder.path().join("m.msh");
        let [nodes, cells] = [nodes, cells].map(|lines| format!("{}\n{}", lines.len(), lines.join("\n")));
        let head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat";
        fs::write(&path, format!("{head}\n$Nodes\n{nodes}\n$EndNodes\n$Elements\n{cells}\n$EndElements\n")).unwrap();
        let outcome = outcome(&format!("file = \"{}\"", path.display()));
        (outcome.mesh.unused_points, springs(&csv(&outcome.mesh, &outcome.fits[0].network)))
    };
    let (none, plain) = of_nodes(false, &mut random);
    let (some, spread) = of_nodes(true, &mut random);
    assert!(none == 0 && some > 5 && plain.len() > 50);
    assert_eq!(plain, spread);
}

/// Null is no count: 0 says that something was looked for and not found.
#[test]
fn reports_say_null_of_what_was_not_looked_for() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("m.msh");
    fs::write(&path, GMSH).unwrap();
    let file = format!("file = \"{}\"", path.display());
    let quality = |mesh: &str| serde_json::from_str::<Report>(&report(&outcome(mesh))).unwrap().quality;
    let plain = quality(&file);
    assert_eq!((plain.poor, plain.coincident, plain.hanging), (Some(0), Some(0), Some(0)));
    assert_eq!(plain.pieces, Some(1));
    let generated = quality("box = { element = \"tri3\", size = [1, 1], cells = [1, 1] }");
    assert_eq!((generated.poor, generated.coincident, generated.hanging), (None, Some(0), None));
}

/// Springs along the sides of squares leave shears free: the loosest points are named as in the files, by the numbers of the mesh file or from 0.
#[test]
fn points_of_notes_are_those_of_files() {
    let folder = TempDir::new().unwrap();
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n12 0 0 0\n30 1 0 0\n41 1 1 0\n8 0 1 0\n$EndNodes\n$Elements\n1\n\
                1 3 2 1 1 12 30 41 8\n$EndElements\n";
    fs::write(folder.path().join("m.msh"), text).unwrap();
    let file = format!("file = {:?}", folder.path().join("m.msh"));
    let box_mesh = "box = { element = \"quad4\", size = [1, 1], cells = [1, 1] }";
    for (mesh, word, names) in [(box_mesh, "point", ["2", "3"]), (&file[..], "node", ["41", "8"])] {
        let outcome = kit::outcome(&format!(
            "[mesh]\n{mesh}\n[material]\nyoung = 1e4\npoisson = 0.3\nthickness = 1\n[[fit]]\nobjective = \"frobenius\"\n\
             springs = [\"edge\"]\n[[fix]]\nwhere = \"y < 1e-9\"\n[[load]]\nwhere = \"y > 0.9\"\nforce = [1, 0]\n"
        ));
        assert_eq!(Report::of(&outcome).fits[0].loose_nodes, [2, 3]);
        let notes = springfit_report::report::notes(&outcome).join("\n");
        let [a, b] = names;
        for part in [format!("Moving freely: {word}s {a} ("), format!("), {b} (")] {
            assert!(notes.contains(&part), "{part}: {notes}");
        }
    }
}
