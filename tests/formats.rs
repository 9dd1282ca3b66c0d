//! Meshes that Gmsh, meshio, trimesh, VTK and TetGen have written (`meshes/formats.py`), in the formats of other programs,
//! beside the same meshes in the formats of Gmsh; and damage to them.

use crate::damage::{assert_sound, damaged};
use crate::kit::{mesh, place};
use crate::shapes::Random;
use springfit_bodies::model::content;
use springfit_element::element::{Quadrature, Tabulation};
use springfit_element::stiffness::each_cell;
use springfit_mesh::mesh::{MESH_FORMATS, Mesh, MeshSource, NumberOrigin, listed_endings};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

const SOLIDS: [&str; 18] = [
    "bar.inp",
    "bar_free.bdf",
    "bar_small.bdf",
    "bar_large.bdf",
    "hex20.inp",
    "hex20.bdf",
    "hex20_meshio.inp",
    "hex20_meshio.bdf",
    "wedge15.inp",
    "wedge15.bdf",
    "tet10.inp",
    "tet10.bdf",
    "tri6.inp",
    "tri6.bdf",
    "quad8.inp",
    "quad8.bdf",
    "pyramid13.inp",
    "curve3.inp",
];
const EGGS: [&str; 7] =
    ["egg.off", "egg.obj", "egg.ply", "egg_ascii.ply", "egg_big_endian.ply", "egg.stl", "egg_ascii.stl"];

fn path(file: &str) -> PathBuf {
    place("tests/meshes").join(file)
}

fn parse(bytes: &[u8], ending: &str) -> springfit_foundation::error::Result<MeshSource> {
    MeshSource::parse(bytes, ending)
}

fn error(text: &str, ending: &str) -> String {
    parse(text.as_bytes(), ending).unwrap_err().to_string()
}

/// The element and the positions of the nodes of each cell, sorted.
fn cells(mesh: &Mesh) -> Vec<(String, Vec<f64>)> {
    let of = |block: &springfit_mesh::mesh::CellBlock| {
        let name = block.element.name.clone();
        block
            .cells()
            .map(|nodes| (name.clone(), nodes.iter().flat_map(|&p| mesh.point(p).to_vec()).collect()))
            .collect::<Vec<_>>()
    };
    let mut cells: Vec<(String, Vec<f64>)> = mesh.blocks.iter().flat_map(of).collect();
    // Places of different cells differ by far more than a thousandth; no coordinate is near the middle of two.
    cells.sort_by_key(|(name, x)| {
        (name.clone(), x.iter().map(|x| (x * 1e3 + 0.137).round() as i64).collect::<Vec<_>>())
    });
    cells
}

fn assert_same_cells(found: &Mesh, expected: &Mesh, tolerance: f64, file: &str) {
    let (found, expected) = (cells(found), cells(expected));
    assert_eq!(found.len(), expected.len(), "{file}");
    for ((name, x), (expected_name, y)) in found.iter().zip(&expected) {
        assert_eq!((name, x.len()), (expected_name, y.len()), "{file}");
        assert!(x.iter().zip(y).all(|(x, y)| (x - y).abs() <= tolerance), "{file}: {name} {x:?}, expected {y:?}");
    }
}

/// The points of each group by the numbers of the file.
fn groups(mesh: &Mesh) -> BTreeMap<String, BTreeSet<u64>> {
    let numbers = |points: &[usize]| points.iter().map(|&p| mesh.point_number(p)).collect();
    mesh.groups.iter().map(|(name, group)| (name.clone(), numbers(&group.points))).collect()
}

/// Cells have their nodes at the same places in the same order, so that every middle node is on its edge.
#[test]
fn cells_are_those_that_gmsh_writes_in_its_own_format() {
    for file in SOLIDS {
        let stem = file.split(['.', '_']).next().unwrap();
        let reference = mesh(&if stem == "bar" { "bar_41_ascii.msh".into() } else { format!("{stem}.msh") });
        let found = mesh(file);
        // Gmsh writes 6 digits into narrow cards, 9 into wide ones.
        let digit = if file.contains("small") || file.contains("free") { 1e-6 } else { 2e-8 };
        assert_same_cells(&found, &reference, digit, file);
        assert_eq!(found.reversed, reference.reversed, "{file}");
        assert_eq!(found.numbering.as_ref().unwrap().origin, NumberOrigin::NodeNumber);
        if !file.contains("meshio") {
            assert_eq!(found.numbering.unwrap().nodes, reference.numbering.unwrap().nodes, "{file}");
        }
    }
}

#[test]
fn sets_of_elements_and_nodes_are_groups() {
    let (found, reference) = (mesh("bar.inp"), mesh("bar_41_ascii.msh"));
    let (all, expected) = (groups(&found), groups(&reference));
    for (name, points) in &expected {
        let name = match name.as_str() {
            "1:9" => "PhysicalLine9".into(),
            other => other.replace(' ', "_"),
        };
        assert_eq!(&all[&name], points, "{name}");
    }
    assert_eq!(found.groups["load"].sides.len(), reference.groups["load"].sides.len());
    assert_eq!(found.groups["body"].cells.len(), 8);
    let small = mesh("bar_small.bdf");
    let listed: Vec<_> = small.groups.iter().map(|(name, group)| (name.as_str(), group.cells.len())).collect();
    assert_eq!(listed, [("pid=1", 2), ("pid=2", 6), ("pid=26", 0), ("pid=49", 0)]);
}

/// The volume of the egg is that which trimesh computes.
#[test]
fn a_surface_is_the_same_in_every_format() {
    let reference = mesh("egg.ply");
    assert_eq!((reference.point_count(), reference.cell_count()), (42, 80));
    for file in EGGS {
        let found = mesh(file);
        assert_eq!((found.point_count(), found.cell_count()), (42, 80), "{file}");
        assert_same_cells(&found, &reference, 1e-6, file);
    }
}

#[test]
fn tetrahedra_of_tetgen_fill_their_brick() {
    for file in ["brick10.ele", "brick10.node", "brick4.node"] {
        let mesh = mesh(file);
        let element = &mesh.blocks[0].element;
        let rule = Quadrature::of_degree(element.cell, 12);
        let table = Tabulation::new(&element.functions, &rule, None);
        let mut content = 0.0;
        each_cell(&table, &mesh.points, &mesh.blocks[0].connectivity, |_, _, g| content += g.content()).unwrap();
        assert!((content - 2.0).abs() < 1e-12, "{file}: {content}");
        assert_eq!(mesh.reversed, if file == "brick4.node" { mesh.reversed } else { 0 });
    }
    let mesh = mesh("brick10.ele");
    let middles = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
    for nodes in mesh.blocks[0].cells() {
        for (node, [a, b]) in nodes[4..].iter().zip(middles) {
            let (a, b) = (mesh.point(nodes[a]), mesh.point(nodes[b]));
            let middle = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
            assert!(mesh.point(*node).iter().zip(middle).all(|(x, y)| (x - y).abs() < 1e-12));
        }
    }
}

#[test]
fn marks_and_regions_of_tetgen_are_groups() {
    let node = b"# points\n4 3 1 1\n1 0 0 0 9.5 0\n2 1 0 0 9.5 7\n3 0 1 0 9.5 -3\n4 0 0 1 9.5 7\n";
    let ele = b"1 4 1\n1 1 2 3 4 12\n";
    let face = b"2 1\n1 1 2 3 5\n2 1 2 4 0\n";
    let mesh = Mesh::resolve(&MeshSource::parse_tetgen(node, ele, Some(face)).unwrap(), &[], 1.0).unwrap();
    let listed: Vec<_> =
        mesh.groups.iter().map(|(n, g)| (n.as_str(), g.points.len(), g.sides.len(), g.cells.len())).collect();
    assert_eq!(listed, [("mark=-3", 1, 0, 0), ("mark=5", 3, 1, 0), ("mark=7", 2, 0, 0), ("region=12", 4, 0, 1)]);
    let wrong = MeshSource::parse_tetgen(node, b"1 4 0\n1 1 2 3 5\n", None).unwrap_err().to_string();
    assert_eq!(wrong, "line 2: .ele: cell 1: names node 5, which the file lacks");
    let cut = MeshSource::parse_tetgen(node, b"2 4 0\n1 1 2 3 4\n", None).unwrap_err().to_string();
    assert_eq!(cut, "the file ends inside .ele: expected 2 cells, found 1");
}

const PART: &str = "*Heading\n ** not a comment\n*Part, name=P\n*Node\n1, 0, 0\n2, 1., 0., 0.\n3, 0., 1.D0, 0\n4, 0, 0, 1\n5, 1, 1, 1\n\
    *Element, type=C3D4R, elset=lower\n7, 1, 2, 3,\n4\n*Element, type=C3D4\n8, 2, 3, 5, 4\n\
    *Nset, nset=Base, generate\n1, 3\n*Elset, elset=ALL, generate\n1, 100, 1\n*Elset, elset=both\nlower, 8\n*End Part\n";
const ASSEMBLY: &str = "*Assembly, name=A\n*Instance, name=P-1, part=P\n10, 0, 0\n10, 0, 0, 10, 0, 1, 90\n*End Instance\n\
    *Node\n1, 5, 5, 5\n*Nset, nset=pilot\n1,\n*Nset, nset=tip, instance=P-1\n5,\n*Nset, nset=named\nP-1.4, tip\n\
    *Elset, elset=_s1, internal, instance=P-1\n7,\n*Surface, type=ELEMENT, name=Under\n_s1, S1\n\
    *Surface, type=ELEMENT, name=skin\nP-1.all,\n*End Assembly\n*Material, name=m\n*Elastic\n1e6, 0.3\n";

#[test]
fn one_part_and_its_instance_are_a_mesh() {
    let mesh = Mesh::resolve(&parse(format!("{PART}{ASSEMBLY}").as_bytes(), "inp").unwrap(), &[], 1.0).unwrap();
    let listed: Vec<_> =
        mesh.groups.iter().map(|(n, g)| (n.as_str(), g.points.len(), g.sides.len(), g.cells.len())).collect();
    let expected = [
        ("ALL", 5, 0, 2),
        ("Base", 3, 0, 0),
        ("Under", 3, 1, 0),
        ("_s1", 4, 0, 1),
        ("both", 5, 0, 2),
        ("lower", 4, 0, 1),
        ("named", 2, 0, 0),
        ("skin", 5, 6, 0),
        ("tip", 1, 0, 0),
    ];
    assert_eq!(listed, expected);
    // Moved by 10 along x, then turned by 90° about an axis along z through (10, 0, 0): (1, 0, 0) comes to (10, 1, 0).
    let turned = mesh.point(1);
    assert!(turned.iter().zip([10.0, 1.0, 0.0]).all(|(x, y)| (x - y).abs() < 1e-12), "{turned:?}");
}

#[test]
fn decks_that_are_not_read_are_refused_with_a_way_out() {
    let include = "*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=more.inp\n";
    assert_eq!(
        error(include, "inp"),
        "line 3: *INCLUDE: expected its lines in this text, found INPUT=more.inp: a deck that is read by its path is read with what it includes"
    );
    let kind = "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=CAX4\n1, 1, 1, 1, 1\n";
    assert!(error(kind, "inp").starts_with("line 3: *ELEMENT: expected one of the types C3D4, C3D10, C3D8, "));
    assert!(error(kind, "inp").ends_with(", found CAX4; elements that are no part of the body may be deleted"));
    let short = "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1\n*END STEP\n";
    assert_eq!(error(short, "inp"), "line 5: *ELEMENT: expected 4 nodes of element 1, found 3 before this line");
    let node = "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=T3D2\n1, 1,\n2\n";
    assert_eq!(error(node, "inp"), "line 5: element 1: names node 2, which the file lacks");
    let number = "*NODE\n1, 0, o, 0\n";
    assert_eq!(error(number, "inp"), "line 2: *NODE: expected a coordinate, found \"o\"");
}

#[test]
fn cards_of_every_layout_are_read() {
    let text = "SOL 101\nCEND\nBEGIN BULK\n$ a comment\nGRID,1,,0.,0.,0.\nGRID    2               1.0     0.0     0.0\n\
        GRID*                  3                             0.0           1.0+0\n*                  0.0-3\n\
        GRID\t4\t0\t.0\t.0\t1.-0\nCTETRA,12,5,1,2,+a\n+a\nCROD,9,,1,2\nPSOLID,5,1\nENDDATA\nCTETRA,x\n";
    let text = text.replace("CTETRA,12,5,1,2,+a\n+a\n", "CTETRA  12      5       1       2       3       4\n");
    let mesh = Mesh::resolve(&parse(text.as_bytes(), "nas").unwrap(), &[], 1.0).unwrap();
    assert_eq!(mesh.points, [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.]);
    let names: Vec<_> = mesh.groups.keys().map(String::as_str).collect();
    assert_eq!(names, ["pid=5", "pid=9"]);
    let system = "GRID,1,3,0.,0.,0.\n";
    assert!(
        error(system, "bdf")
            .starts_with("line 1: system 3: is named by a grid point or a system, and is not in the file")
    );
    let nodes: Vec<String> = (1..=27).map(|node| node.to_string()).collect();
    let full = format!(
        "CHEXA,1,1,{},\n,{},\n,{},\n,{}\n",
        nodes[..6].join(","),
        nodes[6..14].join(","),
        nodes[14..22].join(","),
        nodes[22..].join(",")
    );
    assert_eq!(error(&full, "bdf"), "line 1: CHEXA: expected 8 or 20 grid points, found 27 in element 1");
    let blank = "GRID,1,,0.,0.,0.\nCQUAD4,1,1,1,2,3\n";
    assert_eq!(error(blank, "bdf"), "line 2: CQUAD4: expected the number of a grid point, found a blank field");
    let long = "GRID,1,,0.,0.,0.,,,,,,7\n";
    assert_eq!(error(long, "bdf"), "line 1: expected at most 8 fields after the name, found 11");
}

/// Grid points 1 to 8 and properties 1 to 3.
#[test]
fn sets_of_nastran_are_lists_and_ranges_of_numbers() {
    let grid: String = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .iter()
        .enumerate()
        .map(|(i, [x, y, z])| format!("GRID,{},,{x}.,{y}.,{z}.\n", i + 1))
        .collect();
    let cells = "CTETRA,1,1,1,2,4,5\nCTETRA,2,2,2,3,4,7\nCTETRA,3,3,5,7,8,4\nCTETRA,4,3,2,6,7,5\nCTETRA,5,3,2,7,4,5\n";
    let sets = "SET1,1,1,THRU,7,BY,3\nSET1,2,8,2,THRU,3\nSET3,3,PROP,1,THRU,3,BY,2\nSET3,4,ELEM,2,THRU,9\n";
    let mesh = Mesh::resolve(&parse(format!("{grid}{cells}{sets}").as_bytes(), "bdf").unwrap(), &[], 1.0).unwrap();
    let points = |name: &str| mesh.groups[name].points.iter().map(|p| p + 1).collect::<Vec<_>>();
    assert_eq!((points("set=1"), points("set=2")), (vec![1, 4, 7], vec![2, 3, 8]));
    assert_eq!((mesh.groups["set=3"].cells.len(), mesh.groups["set=4"].cells.len()), (4, 4));
    let one = |set: &str| error(&format!("{grid}{cells}{set}\n"), "bdf");
    for (set, found) in [
        ("SET1,7,1,THRU,5,EXCEPT,3", "EXCEPT in set 7: list the members"),
        ("SET1,7,ALL", "ALL in set 7: list the members"),
        ("SET3,7,ELEM,1,THRU,5,EXCLUDE,2", "EXCLUDE in set 7: list the members"),
        ("SET1,7,1,BY,2", "BY in set 7: list the members"),
    ] {
        let expected =
            format!("expected the numbers of the members, or ranges of them with THRU and BY, found {found}");
        assert_eq!(one(set), format!("line 14: {}: {expected}", &set[..4]));
    }
    assert_eq!(
        one("SET1,7,5,THRU,2"),
        "line 14: SET1: expected a number of at least 5 after THRU in set 7, found \"2\""
    );
    assert_eq!(
        one("SET1,7,5,THRU"),
        "line 14: SET1: expected a number of at least 5 after THRU in set 7, found a blank field"
    );
}

/// A wedge of a set that also has a hexahedron has no sixth side.
#[test]
fn sides_of_abaqus_are_those_of_the_elements() {
    let body = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,0,1\n6,0,1,1\n7,0,-1,0\n8,1,-1,0\n9,0,-1,1\n10,1,-1,1\n\
        *ELEMENT,TYPE=C3D6,ELSET=W\n1,1,2,3,4,5,6\n*ELEMENT,TYPE=C3D8,ELSET=B\n2,7,8,2,1,9,10,5,4\n*ELSET,ELSET=ALL\nW,B\n";
    let mesh = |patch: &str| parse(format!("{body}*SURFACE,NAME=top\n{patch}\n").as_bytes(), "inp");
    let found = Mesh::resolve(&mesh("ALL,S6").unwrap(), &[], 1.0).unwrap();
    assert_eq!(found.groups["top"].sides.len(), 1);
    for (patch, problem) in
        [("W,S6", "names side 6 of elements with 5 sides"), ("1,S6", "names side 6 of elements with 5 sides")]
    {
        let found = mesh(patch).unwrap_err().to_string();
        assert!(found.starts_with("line ") && found.ends_with(&format!("surface \"top\": {problem}")), "{found}");
    }
}

#[test]
fn faults_of_surfaces_name_the_line() {
    assert_eq!(
        error("solid a\nfacet\nouter loop\nvertex 0 0 x\n", "stl"),
        "line 4: solid: expected a coordinate, found \"x\""
    );
    assert_eq!(error("solid a\nfacet\n", "stl"), "the file ends inside solid");
    let header = [&[0_u8; 80][..], &9_u32.to_le_bytes(), &[0; 60]].concat();
    let cut = parse(&header, "stl").unwrap_err().to_string();
    assert_eq!(
        cut,
        "header: expected the word \"solid\", or 9 facets of 50 bytes after the header, found 1 facets and 10 bytes"
    );
    assert_eq!(
        error("v 0 0 0\nf 1 1 2\n", "obj"),
        "line 2: expected the number of one of 1 points before it, found \"2\""
    );
    // A star, and one of five corners that are not in one plane.
    for corner in ["0.5 -1 0", "0 1 3"] {
        let five = format!("OFF\n5 1 0\n0 0 0\n1 0 0\n1 1 0\n0 2 0\n{corner}\n5 0 1 2 3 4\n");
        assert!(error(&five, "off").starts_with("line 8: expected flat faces of three corners or more"));
    }
    assert_eq!(error("OFF\n3 1 0\n0 0 0\n", "off"), "the file ends too early: expected 3 points, found 1");
    let counts = "ply\nformat ascii 1.0\nelement vertex 99999999999999\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0\n";
    assert!(error(counts, "ply").contains("expected 99999999999999"), "{}", error(counts, "ply"));
}

/// Each row of the table of formats is asked for by its endings.
#[test]
fn endings_are_those_of_the_table() {
    let endings: BTreeSet<&str> = MESH_FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    assert_eq!(endings.len(), MESH_FORMATS.iter().map(|format| format.endings.len()).sum::<usize>());
    let page = fs::read_to_string(place("docs/src/reference/meshes.md")).unwrap();
    for ending in endings {
        assert!(listed_endings().contains(&format!(".{ending}")));
        assert!(page.contains(&format!("`.{ending}`")), "{ending} is not on the page of meshes");
    }
    for (ending, command) in [("step", "gmsh mesh.step -3"), ("xdmf", "meshio convert"), ("glb", "Blender")] {
        assert!(error("", ending).contains(command));
    }
}

#[test]
fn no_damaged_file_makes_a_reader_panic() {
    let mut random = Random(7);
    let whole = |file: &&str| (fs::read(path(file)).unwrap(), file.rsplit('.').next().unwrap().to_string());
    let mut files: Vec<_> = SOLIDS.iter().chain(&EGGS).map(whole).collect();
    files.push((format!("{PART}{ASSEMBLY}").into_bytes(), "inp".into()));
    files.retain(|(bytes, _)| bytes.len() < 9000);
    for (whole, ending) in &files {
        for round in 0..400 {
            let bytes = damaged(whole, round, &mut random);
            match parse(&bytes, ending) {
                Ok(mesh) => assert_sound(&mesh),
                Err(error) => assert_eq!(error.to_string().lines().count(), 1),
            }
        }
    }
}

/// Formats that count or close what they hold are not read if they are cut.
#[test]
fn no_surface_cut_short_is_read() {
    for file in EGGS.into_iter().filter(|file| !file.ends_with(".obj")) {
        let bytes = fs::read(path(file)).unwrap();
        for length in (0..bytes.len()).step_by(7) {
            let (start, rest) = bytes.split_at(length);
            if parse(start, file.rsplit('.').next().unwrap()).is_ok() {
                assert!(rest.trim_ascii().len() < 12, "{file} cut to {length} bytes");
            }
        }
    }
}

/// Polygons of more than four corners are triangles with the same area, whichever side their corners turn to; and what has no area or is there
/// again is no part of a surface.
#[test]
fn polygons_are_cut_and_idle_faces_left_out() {
    // An L with a corner in the middle of a side, a comb, and a regular polygon of 40 corners, each tilted in space.
    let round: Vec<[f64; 2]> =
        (0..40).map(|k| (f64::from(k) * std::f64::consts::TAU / 40.0).sin_cos().into()).collect();
    let bent = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let comb = vec![
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 3.0],
        [4.0, 3.0],
        [4.0, 1.0],
        [3.0, 1.0],
        [3.0, 3.0],
        [2.0, 3.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [0.0, 3.0],
    ];
    for (corners, expected) in [(bent, 4.0), (comb, 11.0), (round, 20.0 * (std::f64::consts::TAU / 40.0).sin())] {
        for turned in [false, true] {
            let n = corners.len();
            let place = |[x, y]: &[f64; 2]| format!("{} {} {}\n", 0.6 * x, y, 0.8 * x);
            let places: String = corners.iter().map(place).collect();
            let order: Vec<usize> = if turned { (0..n).rev().collect() } else { (0..n).collect() };
            let listed = |first: usize| order.iter().map(|k| (k + first).to_string()).collect::<Vec<_>>().join(" ");
            let off = format!("OFF\n{n} 1 0\n{places}{n} {}\n", listed(0));
            let obj =
                format!("{}f {}\n", places.lines().map(|line| format!("v {line}\n")).collect::<String>(), listed(1));
            let ply = format!(
                "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                 property list uchar int vertex_indices\nend_header\n{places}{n} {}\n",
                listed(0)
            );
            let vtk = format!(
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS {n} double\n{places}POLYGONS 1 {}\n{n} {}\n",
                n + 1,
                listed(0)
            );
            for (text, ending) in [(off, "off"), (obj, "obj"), (ply, "ply"), (vtk, "vtk")] {
                let source = parse(text.as_bytes(), ending).unwrap();
                let mesh = Mesh::resolve(&source, &[], 1.0).unwrap();
                assert_eq!((mesh.cell_count(), mesh.point_count()), (n - 2, n), "{ending}");
                assert!((content(&mesh) - expected).abs() < 1e-12, "{ending}: {}, {expected}", content(&mesh));
                assert!(
                    source.annotations.remarks.iter().any(|said| said.starts_with("1 ")),
                    "{:?}",
                    source.annotations
                );
            }
        }
    }
    let idle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 2 3 1\nf 1 2 2\nf 1 2 4\nf 2 4 3\n";
    let source = parse(idle.as_bytes(), "obj").unwrap();
    let said =
        ["2 faces without area left out", "1 face with the corners of an earlier one in the same order left out"];
    let mesh = Mesh::resolve(&source, &[], 1.0).unwrap();
    assert_eq!(mesh.annotations.remarks, said);
    assert!((content(&mesh) - 1.0).abs() < 1e-15);
    let both = parse(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n", "obj").unwrap();
    assert!(Mesh::resolve(&both, &[], 1.0).unwrap_err().to_string().contains("expected each cell once"));
}

/// Prisms over pentagons and hexagons are hexahedra and wedges whose shared bases are divided alike.
#[test]
fn prisms_of_vtk_are_divided_alike() {
    for (n, cell_type, remark) in [
        (5, 15, "3 prisms over a pentagon are a hexahedron and a wedge each here"),
        (6, 16, "3 prisms over a hexagon are two hexahedra each here"),
    ] {
        let layers = 4;
        let points: String = (0..layers)
            .flat_map(|z| (0..n).map(move |k| (z, (f64::from(k) * std::f64::consts::TAU / f64::from(n)).sin_cos())))
            .map(|(z, (sine, cosine))| format!("{cosine} {sine} {z}\n"))
            .collect();
        // The bases of the second prism begin at another corner, and the last is listed before it.
        let prism = |layer: i32, first: i32| {
            let base =
                |layer: i32| (0..n).map(|k| (layer * n + (k + first) % n).to_string()).collect::<Vec<_>>().join(" ");
            format!("{} {} {}\n", 2 * n, base(layer), base(layer + 1))
        };
        let cells = prism(0, 0) + &prism(1, 2) + &prism(2, 1);
        let text = format!(
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n{points}CELLS 3 {}\n{cells}\
             CELL_TYPES 3\n{cell_type}\n{cell_type}\n{cell_type}\n",
            layers * n,
            3 * (2 * n + 1)
        );
        let source = parse(text.as_bytes(), "vtk").unwrap();
        assert_eq!(source.annotations.remarks, [remark]);
        let mesh = Mesh::resolve(&source, &[], 1.0).unwrap();
        assert_eq!((mesh.cell_count(), mesh.quality.pieces, mesh.reversed), (6, Some(1), 0));
        assert_eq!(mesh.quality.hanging.unwrap_or(0), 0);
        let volume = content(&mesh);
        let expected = 3.0 * 0.5 * f64::from(n) * (std::f64::consts::TAU / f64::from(n)).sin();
        assert!((volume - expected).abs() < 1e-12, "{volume}, {expected}");
    }
}

/// Middle nodes that a card leaves out are those of a neighbour on the same edge, or are made halfway along it, once for two elements.
#[test]
fn middle_nodes_that_cards_of_nastran_leave_out_are_made() {
    let points = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,2.,0.,0.\nGRID,6,,2.,1.,0.\nGRID,7,,3.,0.,0.\nGRID,8,,3.,1.,0.\n\
                  GRID,11,,.5,0.,0.\nGRID,12,,1.,.6,0.\nGRID,13,,1.5,0.,0.\n";
    let cells = "CQUAD8,1,1,1,2,3,4,11,12\nCQUAD8,2,1,2,5,6,3,13\nCQUAD8,3,1,5,7,8,6,,9\nGRID,9,,3.,.5,0.\n";
    let source = parse(format!("{points}{cells}").as_bytes(), "bdf").unwrap();
    let said = "3 elements lack some of the middle nodes: 6 were made halfway between the ends of their edges, and 2 are those of other elements";
    assert!(source.annotations.remarks.iter().any(|remark| remark == said), "{:?}", source.annotations.remarks);
    let mesh = Mesh::resolve(&source, &[], 1.0).unwrap();
    assert_eq!((mesh.cell_count(), mesh.point_count(), mesh.quality.pieces), (3, 18, Some(1)));
    let of = |cell: usize| mesh.blocks[0].cell(cell).iter().map(|&p| mesh.point(p).to_vec()).collect::<Vec<_>>();
    assert_eq!(of(0)[4..], [[0.5, 0.0], [1.0, 0.6], [0.5, 1.0], [0.0, 0.5]]);
    assert_eq!(of(1)[4..], [[1.5, 0.0], [2.0, 0.5], [1.5, 1.0], [1.0, 0.6]]);
    let solid = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nGRID,5,,.5,0.,0.\nCTETRA,1,1,1,2,3,4,5\n";
    let mesh = Mesh::resolve(&parse(solid.as_bytes(), "bdf").unwrap(), &[], 1.0).unwrap();
    assert_eq!((mesh.blocks[0].element.name.as_str(), mesh.point_count()), ("tet10", 10));
}
