//! Reads one bar of hexahedra and tetrahedra from every kind of mesh file, whole, cut short and damaged.

use crate::damage::{assert_sound, damaged};
use crate::kit::{files, place, source};
use crate::messages::reads;
use crate::shapes::Random;
use proptest::prelude::*;
use springfit_mesh::mesh::vtk::{Array, Grid, write};
use springfit_mesh::mesh::{Field, Format, Mesh, MeshSource, SourceBlock, gmsh, vtk};
use std::fs;
use std::path::{Path, PathBuf};

const GMSH_BARS: [&str; 5] =
    ["bar_41_ascii.msh", "bar_41_binary.msh", "bar_40_ascii.msh", "bar_22_ascii.msh", "bar_22_binary.msh"];
/// Written by meshio and VTK.
const VTK_BARS: [&str; 24] = [
    "bar_ascii.vtu",
    "bar_vtk_ascii.vtu",
    "bar_base64.vtu",
    "bar_wide_big_endian.vtu",
    "bar_zlib.vtu",
    "bar_lz4.vtu",
    "bar_xz.vtu",
    "bar_blocks.vtu",
    "bar_zlib_blocks_big_endian.vtu",
    "bar_appended.vtu",
    "bar_appended_big_endian.vtu",
    "bar_appended_zlib.vtu",
    "bar_appended_zlib_blocks_big_endian.vtu",
    "bar_appended_raw.vtu",
    "bar_appended_raw_narrow.vtu",
    "bar_appended_raw_big_endian.vtu",
    "bar_appended_raw_zlib.vtu",
    "bar_appended_raw_zlib_blocks.vtu",
    "bar_appended_raw_zlib_blocks_big_endian.vtu",
    "bar_ascii.vtk",
    "bar_binary.vtk",
    "bar_42_ascii.vtk",
    "bar_42_binary.vtk",
    "bar_metadata.vtk",
];
/// Two triangles with arrays of every type of numbers, written by VTK.
const TYPES: [&str; 3] = ["types_ascii.vtu", "types_inline_big_endian.vtu", "types_raw_zlib.vtu"];
/// The bar three times, each a piece, and grids without points, written by VTK.
const PIECES: [&str; 3] = ["pieces_raw_zlib.vtu", "empty_inline_zlib.vtu", "empty_raw_zlib.vtu"];
const PARAMETRIC_CUBES: [&str; 2] = ["cube_parametric_22.msh", "cube_parametric_41.msh"];

fn folder() -> PathBuf {
    place("tests/meshes")
}

fn all_files() -> impl Iterator<Item = &'static str> {
    GMSH_BARS.into_iter().chain(VTK_BARS).chain(TYPES).chain(PIECES).chain(PARAMETRIC_CUBES)
}

fn bytes_of(file: &str) -> Vec<u8> {
    fs::read(folder().join(file)).unwrap()
}

fn parse(file: &str, bytes: &[u8]) -> springfit_foundation::error::Result<MeshSource> {
    match file.rsplit('.').next().unwrap() {
        "msh" => gmsh::parse(bytes),
        "vtu" => vtk::parse_xml(bytes),
        _ => vtk::parse_legacy(bytes),
    }
}

fn gmsh_error(text: &str) -> String {
    gmsh::parse(text.as_bytes()).unwrap_err().to_string()
}

/// Dimension, nodes and groups of each cell, sorted.
fn sorted_cells(mesh: &MeshSource) -> Vec<(usize, Vec<usize>, Vec<String>)> {
    let cells_of = |block: &SourceBlock| {
        let cell = |nodes: &[usize]| (block.dimension, nodes.to_vec(), block.groups.clone());
        block.connectivity.chunks(block.nodes_per_cell).map(cell).collect::<Vec<_>>()
    };
    let mut cells: Vec<_> = mesh.blocks.iter().flat_map(cells_of).collect();
    cells.sort();
    cells
}

/// Whether the points are the same to the digits that every file has.
fn agree(some: &[[f64; 3]], others: &[[f64; 3]]) -> bool {
    let (some, others) = (some.as_flattened(), others.as_flattened());
    some.len() == others.len() && some.iter().zip(others).all(|(a, b)| (a - b).abs() < 1e-10)
}

#[test]
fn every_format_gives_the_same_bar() {
    let reference = source(GMSH_BARS[0]);
    assert_eq!(reference.points.len(), 20);
    assert_eq!(reference.points[9], [3.1, 0.0, 0.125]);
    let cells = sorted_cells(&reference);
    assert_eq!(cells.len(), 16);
    for file in GMSH_BARS {
        let mesh = source(file);
        assert_eq!(mesh.format, Format::Gmsh);
        assert!(agree(&mesh.points, &reference.points), "{file}");
        assert_eq!(sorted_cells(&mesh), cells, "{file}");
    }
    // Version 1 has the numbers of groups without their names.
    let mut first = source("bar_1_ascii.msh");
    assert!(agree(&first.points, &reference.points));
    for (number, name) in [("2:1", "fixed"), ("2:2", "load"), ("3:3", "body"), ("3:7", "soft part")] {
        let groups = first.blocks.iter_mut().flat_map(|block| &mut block.groups);
        groups.filter(|group| *group == number).for_each(|group| *group = name.into());
    }
    assert_eq!(sorted_cells(&first), cells);
    let hexahedra = sorted_cells(&source("hex20.msh"));
    for file in ["hex20_v1.msh", "hex20_v40.msh"] {
        let mut mesh = source(file);
        let groups = mesh.blocks.iter_mut().flat_map(|block| &mut block.groups);
        groups.filter(|group| *group == "3:1").for_each(|group| *group = "body".into());
        assert_eq!(sorted_cells(&mesh), hexahedra, "{file}");
    }
    let vtk_cells = sorted_cells(&source(VTK_BARS[0]));
    for file in VTK_BARS {
        let mesh = source(file);
        assert_eq!(mesh.format, Format::Vtk);
        assert!(agree(&mesh.points, &reference.points), "{file}");
        assert_eq!(sorted_cells(&mesh), vtk_cells, "{file}");
    }
    assert!(vtk_cells.iter().map(|c| (c.0, &c.1)).eq(cells.iter().map(|c| (c.0, &c.1))));
}

#[test]
fn gmsh_groups_come_from_physical_names() {
    let mesh = gmsh::parse(&bytes_of("bar_41_ascii.msh")).unwrap();
    let blocks: Vec<_> =
        mesh.blocks.iter().map(|b| (b.dimension, b.cell_type, b.connectivity.len() / b.nodes_per_cell)).collect();
    assert_eq!(blocks, [(1, 1, 2), (2, 3, 2), (2, 3, 2), (2, 2, 2), (3, 5, 2), (3, 4, 6)]);
    let groups: Vec<_> = mesh.blocks.iter().map(|b| b.groups.join("+")).collect();
    assert_eq!(groups, ["1:9", "fixed", "load", "load", "body", "body+soft part"]);
}

#[test]
fn vtk_groups_come_from_arrays_of_whole_numbers() {
    let mesh = vtk::parse_xml(&bytes_of("bar_zlib.vtu")).unwrap();
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.cell_type, b.groups.join("+"))).collect();
    let expected = [(3, 9), (5, 2), (9, 1), (9, 2), (10, 3), (12, 3)];
    assert_eq!(blocks, expected.map(|(cell_type, tag)| (cell_type, format!("gmsh:physical={tag}"))));
}

#[test]
fn parametric_coordinates_are_passed_over() {
    let meshes = PARAMETRIC_CUBES.map(|file| gmsh::parse(&bytes_of(file)).unwrap());
    assert_eq!(meshes[0], meshes[1]);
    assert_eq!(meshes[0].points.len(), 14);
    assert_eq!(meshes[0].points[13], [0.5, 0.5, 1.0]);
}

#[test]
fn every_mesh_of_the_scenes_reads() {
    let folder = place("scenes/meshes");
    let mut count = 0;
    for path in files(&folder) {
        let mesh = MeshSource::read(&path).unwrap();
        assert_sound(&mesh);
        let groups: Vec<_> = mesh.blocks.iter().flat_map(|b| &b.groups).collect();
        for name in ["fixed", "load", "body"] {
            assert!(groups.iter().any(|group| *group == name));
        }
        count += 1;
    }
    assert_eq!(count, 13);
}

/// A legacy file that ends just before data on its points or cells is a whole file without them.
fn ends_before_data(file: &str, rest: &[u8]) -> bool {
    let keywords: [&[u8]; 4] = [b"CELL_DATA", b"POINT_DATA", b"FIELD", b"METADATA"];
    file.ends_with(".vtk") && keywords.iter().any(|keyword| rest.trim_ascii_start().starts_with(keyword))
}

/// Nothing after the word METADATA is needed until a blank line.
fn ends_in_metadata(start: &[u8]) -> bool {
    let at = start.windows(8).rposition(|window| window == b"METADATA");
    at.is_some_and(|at| !start[at..].windows(2).any(|window| window == b"\n\n"))
}

#[test]
fn no_file_cut_short_is_read_without_a_word() {
    for file in all_files() {
        let bytes = bytes_of(file);
        for length in 0..bytes.len() {
            let (start, rest) = bytes.split_at(length);
            // What follows the cells may be cut, with a note.
            if let Ok(source) = parse(file, start) {
                let is_told = !source.annotations.remarks.is_empty();
                let is_whole = rest.trim_ascii().is_empty() || ends_before_data(file, rest) || ends_in_metadata(start);
                assert!(is_told || is_whole, "{file} cut to {length} bytes");
            }
        }
    }
}

#[test]
fn no_damaged_file_makes_the_reader_panic() {
    let mut random = Random(1);
    for file in all_files() {
        let whole = bytes_of(file);
        for round in 0..600 {
            let bytes = damaged(&whole, round, &mut random);
            if let Ok(mesh) = parse(file, &bytes) {
                assert_sound(&mesh);
            }
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_make_the_readers_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), header in 0..6_usize) {
        let headers = [
            "",
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n",
            "$MeshFormat\n4.1 1 8\n\u{1}\0\0\0\n$EndMeshFormat\n$Entities\n",
            "$MeshFormat\n2.2 1 8\n\u{1}\0\0\0\n$EndMeshFormat\n$Nodes\n9\n",
            "# vtk DataFile Version 3.0\n\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n",
            "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"><DataArray format=\"binary\">",
        ];
        let bytes = [headers[header].as_bytes(), &bytes].concat();
        for ending in ["x.msh", "x.vtk", "x.vtu"] {
            if let Ok(mesh) = parse(ending, &bytes) {
                assert_sound(&mesh);
            }
        }
    }
}

const FORMAT: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const NODES: &str = "$Nodes\n1 3 7 900000000000\n2 1 0 3\n900000000000\n7\n8\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n";
const ELEMENTS: &str = "$Elements\n1 1 1 1\n2 1 2 1\n1 900000000000 8 7\n$EndElements\n";

#[test]
fn node_tags_may_be_sparse_and_unordered() {
    let mesh = gmsh::parse(format!("{FORMAT}{NODES}{ELEMENTS}").as_bytes()).unwrap();
    assert_eq!(mesh.points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.blocks.len(), 1);
    assert_eq!(mesh.blocks[0].connectivity, [0, 2, 1]);
    assert!(mesh.blocks[0].groups.is_empty());
}

#[test]
fn unknown_sections_are_skipped_and_windows_lines_are_read() {
    let text = format!(
        "$Comments\n$Nodes here are none\n$EndComments\n{FORMAT}$Periodic\n0\n$EndPeriodic\n{NODES}{ELEMENTS}\
         $NodeData\n1\n\"a\"\n$EndNodeData\n"
    );
    let mesh = gmsh::parse(text.as_bytes()).unwrap();
    assert_eq!(gmsh::parse(text.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    let cut = gmsh::parse(text.trim_end_matches("$EndNodeData\n").as_bytes()).unwrap();
    assert_eq!(cut.annotations.notes(), ["the file ends inside $NodeData, which no mesh needs: it may be cut short"]);
}

#[test]
fn a_name_may_stand_for_groups_of_several_dimensions() {
    let names = "$PhysicalNames\n2\n1 4 \"all of it\"\n2 4 \"all of it\"\n$EndPhysicalNames\n";
    let nodes = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
    let elements = "$Elements\n4\n1 1 2 4 1 1 2\n2 2 2 4 1 1 2 3\n3 2 2 -5 1 1 2 3\n4 15 2 0 1 3\n$EndElements\n";
    let format = FORMAT.replace("4.1", "2.2");
    let mesh = gmsh::parse(format!("{format}{names}{nodes}{elements}").as_bytes()).unwrap();
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.dimension, b.groups.join("+"))).collect();
    let both = "all of it+2:5".to_string();
    assert_eq!(blocks, [(1, "all of it".to_string()), (2, both), (0, String::new())]);
}

#[test]
fn gmsh_errors_say_what_was_expected_and_found() {
    const FIRST: &str = "$NOD\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$ENDNOD\n";
    let with_nodes = |from: &str, to: &str| format!("{FORMAT}{}{ELEMENTS}", NODES.replace(from, to));
    let with_elements = |from: &str, to: &str| format!("{FORMAT}{NODES}{}", ELEMENTS.replace(from, to));
    let of_version_4 = |rest: &str| format!("$MeshFormat\n4 0 8\n$EndMeshFormat\n{rest}");
    let first = |elements: &str| format!("{FIRST}$ELM\n1\n{elements}\n$ENDELM\n");
    for (text, expected) in [
        (with_nodes("1 0 0\n0 1", "1 abc 0\n0 1"), "line 11: $Nodes: expected a number, found \"abc\""),
        (with_nodes("0 1 0\n$", "$"), "line 12: $Nodes: expected 3 nodes, found 2"),
        (with_nodes("$End", "4 4 4\n$End"), "line 13: $Nodes: expected $EndNodes, found \"4\""),
        (with_nodes("\n8\n", "\n7\n"), "$Nodes: node 7 occurs twice"),
        (format!("{FORMAT}{ELEMENTS}"), "line 4: $Elements: expected $Nodes before it"),
        (format!("{FORMAT}{}", &NODES[..NODES.len() - 16]), "the file ends inside $Nodes: expected 3 nodes, found 2"),
        (with_elements("8 7", "8 6"), "line 17: $Elements: element 1 names node 6, which $Nodes lacks"),
        (with_elements("2 1 2 1", "2 1 999 1"), "line 16: $Elements: element type 999 is unknown"),
        (format!("{FORMAT}{NODES}"), "the file ends before $Elements"),
        (String::new(), "the file ends before $MeshFormat"),
        ("solid a\n".into(), "line 1: expected a section such as $MeshFormat, found \"solid\""),
        (
            "$MeshFormat\n3 0 8\n$EndMeshFormat\n".into(),
            "line 2: $MeshFormat: expected version 4.1, 4.0 or 2.2, found \"3\"; \
             what converts it: gmsh old.msh -save -format msh41 -o new.msh",
        ),
        (first("1 2 5 1 4 1 2 3"), "line 9: $ELM: expected 3 nodes of element 1 with type 2, found 4"),
        (first("1 2 5 1 3 1 2 4"), "line 9: $ELM: element 1 names node 4, which $Nodes lacks"),
        ("$ELM\n".into(), "line 1: $ELM: expected $NOD before it"),
        (FIRST.repeat(2), "line 7: $NOD: stands in the file a second time"),
    ] {
        assert_eq!(gmsh_error(&text), expected);
    }
    for (text, expected) in [
        (
            "$MeshFormat\n4 1 8\n".into(),
            "…expected a file of version 4.0 in text, found a binary one; what converts it…",
        ),
        (
            of_version_4("$Nodes\n1 1\n1 1 1 1\n1 0 0 0 0.5\n$EndNodes\n"),
            "…$Nodes: expected nodes of version 4.0 without parameters, found 1…",
        ),
        (of_version_4("$Nodes\n1 2\n1 1 0 1\n1 0 0 0\n$EndNodes\n"), "…expected 2 nodes, found 1…"),
        (
            of_version_4("$PartitionedEntities\n"),
            "line 4: $PartitionedEntities: partitioned meshes of this version are not supported…",
        ),
    ] {
        reads(&gmsh_error(&text), expected).unwrap();
    }
}

#[test]
fn counts_beyond_the_file_are_errors() {
    let huge = u64::MAX.to_string();
    let nodes = format!("$Nodes\n1 {huge} 1 1\n0 1 0 {huge}\n1\n");
    let expected = format!("the file ends inside $Nodes: expected {huge} nodes, found 0");
    assert_eq!(gmsh_error(&format!("{FORMAT}{nodes}")), expected);
    let elements = format!("$Elements\n1 {huge} 1 1\n2 1 2 {huge}\n1 7 8");
    let expected = format!("the file ends inside $Elements: expected {huge} elements, found 0");
    assert_eq!(gmsh_error(&format!("{FORMAT}{NODES}{elements}")), expected);
    for section in [format!("POINTS {huge} double"), format!("CELLS {huge} {huge}"), format!("CELL_TYPES {huge}")] {
        for (encoding, data) in [("ASCII", "1 1\n"), ("BINARY", "\0\0\0\u{1}\0\0\0\u{1}")] {
            let head = format!("# vtk DataFile Version 3.0\n\n{encoding}\nDATASET UNSTRUCTURED_GRID\n");
            let error = vtk::parse_legacy(format!("{head}{section}\n{data}").as_bytes()).unwrap_err().to_string();
            assert!(error.contains(&format!(": expected {huge} ")), "{error}");
        }
    }
}

#[test]
fn coordinates_that_are_not_finite_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.msh");
    fs::write(&path, format!("{FORMAT}{NODES}{ELEMENTS}").replace("0 1 0\n$", "0 nan 0\n$")).unwrap();
    let expected = format!("{}: node 3: expected finite coordinates, found (0, NaN, 0)", path.display());
    assert_eq!(MeshSource::read(&path).unwrap_err().to_string(), expected);
}

#[test]
fn files_without_end_are_refused_unread() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.msh");
    fs::File::create(&path).unwrap().set_len(5_000_000_000).unwrap();
    let expected = format!("{}: expected a file of at most 4 GB, found 5000000000 bytes", path.display());
    assert_eq!(MeshSource::read(&path).unwrap_err().to_string(), expected);
}

#[test]
fn tags_and_data_without_bound_are_refused() {
    let error = |text: &str| vtk::parse_xml(text.as_bytes()).unwrap_err().to_string();
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let deep = text.replace("<Points>", &"<Points>".repeat(100_000));
    assert_eq!(error(&deep), "line 6: Points: expected at most 32 tags inside one another, found 33");
    let none = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>";
    let many = text.replace("<Piece ", &(none.repeat(4096) + "<Piece "));
    assert_eq!(error(&many), "line 5: Piece: expected at most 4096 pieces, found more");
    // 2000 arrays that share 300000 bytes, 4JMEAA in little-endian base64.
    let array = "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/>";
    let (arrays, data) = (array.repeat(2000), "A".repeat(400_000));
    let shared = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"0\" NumberOfCells=\"300000\"><Cells>{}</Cells><CellData>{arrays}</CellData></Piece>\
         </UnstructuredGrid><AppendedData encoding=\"base64\">_4JMEAAAA{data}</AppendedData></VTKFile>",
        ["types", "offsets"].map(|name| array.replace("Name=\"a\"", &format!("Name=\"{name}\""))).concat()
    );
    let most = (1 << 24) + 100 * shared.len();
    // 300004 bytes are 400008 characters
    let found = (most / 700_008 + 1) * 700_008;
    let length = shared.len();
    let expected = format!(
        "expected at most {most} bytes of data, stored and decoded, up to here in a file of {length}, found {found}"
    );
    assert_eq!(error(&shared), format!("line 1: CellData.a: {expected}"));
}

/// One tetrahedron.
fn binary_tetrahedron(version: &str, big_endian: bool) -> Vec<u8> {
    let mut bytes = format!("$MeshFormat\n{version} 1 8\n").into_bytes();
    let int = |i: i32| if big_endian { i.to_be_bytes() } else { i.to_le_bytes() };
    let size = |i: u64| if big_endian { i.to_be_bytes() } else { i.to_le_bytes() };
    let real = |x: f64| if big_endian { x.to_be_bytes() } else { x.to_le_bytes() };
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]];
    bytes.extend(int(1));
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n");
    if version == "4.1" {
        bytes.extend([1, 4, 1, 4].map(size).concat());
        bytes.extend([3, 1, 0].map(int).concat());
        bytes.extend([4, 1, 2, 3, 4].map(size).concat());
        bytes.extend(points.as_flattened().iter().flat_map(|&x| real(x)));
        bytes.extend(b"\n$EndNodes\n$Elements\n");
        bytes.extend([1, 1, 1, 1].map(size).concat());
        bytes.extend([3, 1, 4].map(int).concat());
        bytes.extend([1, 1, 1, 2, 3, 4].map(size).concat());
    } else {
        bytes.extend(b"4\n");
        for (tag, point) in (1..).zip(points) {
            bytes.extend(int(tag));
            bytes.extend(point.map(real).concat());
        }
        bytes.extend(b"\n$EndNodes\n$Elements\n1\n");
        bytes.extend([4, 1, 2, 1, 0, 1, 1, 2, 3, 4].map(int).concat());
    }
    bytes.extend(b"\n$EndElements\n");
    bytes
}

#[test]
fn both_byte_orders_are_read() {
    for version in ["4.1", "2.2"] {
        let meshes = [false, true].map(|big_endian| gmsh::parse(&binary_tetrahedron(version, big_endian)).unwrap());
        assert_eq!(meshes[0], meshes[1]);
        assert_eq!(meshes[0].points[3], [0.0, 0.0, 1.5]);
        assert_eq!(meshes[0].blocks[0].connectivity, [0, 1, 2, 3]);
    }
    let mut bytes = binary_tetrahedron("2.2", false);
    bytes.truncate(bytes.len() - 40);
    let error = gmsh::parse(&bytes).unwrap_err().to_string();
    assert_eq!(error, "the file ends inside $Elements: expected 1 elements, found 0");
}

const LEGACY: &str = "# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n\
                      0 0 0 1 0 0\n0 1 0 1 1 0\n";

#[test]
fn pixels_become_quadrangles_and_names_lose_their_escapes() {
    let text = format!(
        "{LEGACY}CELLS 2 9\n4 0 1 2 3\n3 0 1 2\nCELL_TYPES 2\n8\n5\nCELL_DATA 2\nSCALARS my%20part char\n\
         LOOKUP_TABLE default\n4 -5\nVECTORS v float\n1 2 3 4 5 6\nFIELD more 2\nnote 1 1 string\na b\n\
         both 2 2 int\n1 2 3 4\nPOINT_DATA 4\nSCALARS id int\n1 2 3 4\n"
    );
    let mesh = vtk::parse_legacy(text.as_bytes()).unwrap();
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.cell_type, &b.connectivity[..], b.groups.join("+"))).collect();
    let expected = [(9, &[0, 1, 3, 2][..], "my part=4".to_string()), (5, &[0, 1, 2][..], "my part=-5".to_string())];
    assert_eq!(blocks, expected);
}

#[test]
fn an_array_with_many_values_names_no_groups() {
    let count = 1001;
    let cells = "1 0\n".repeat(count);
    let types = "1\n".repeat(count);
    let numbers = |most: usize| (0..count).map(|i| format!("{}\n", i.min(most))).collect::<String>();
    let text = |most| {
        let data = format!("CELL_DATA {count}\nSCALARS a int\n{}", numbers(most));
        format!("{LEGACY}CELLS {count} {}\n{cells}CELL_TYPES {count}\n{types}{data}", 2 * count)
    };
    assert_eq!(vtk::parse_legacy(text(1000).as_bytes()).unwrap().blocks.len(), 1);
    assert_eq!(vtk::parse_legacy(text(999).as_bytes()).unwrap().blocks.len(), 1000);
}

#[test]
fn vtk_errors_say_what_was_expected_and_found() {
    let legacy = |text: &str| vtk::parse_legacy(format!("{LEGACY}{text}").as_bytes()).unwrap_err().to_string();
    assert_eq!(legacy("CELLS 1 4\n3 0 1 4\nCELL_TYPES 1\n5\n"), "cell 0: expected point indices below 4, found 4");
    let count = "cell 0: expected 4 nodes for VTK cell type 10, found 3";
    assert_eq!(legacy("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n"), count);
    let shape = "cell 0: VTK cell type 41 has no fixed shape or is unknown; ParaView's filter Tetrahedralize makes tetrahedra of all cells that VTK knows";
    assert_eq!(legacy("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n41\n"), shape);
    assert_eq!(legacy("CELLS 1 4\n3 0 x 2\n"), "line 9: CELLS: expected a whole number, found \"x\"");
    assert_eq!(legacy("CELLS 2 8\n3 0 1 2\n"), "the file ends inside CELLS: expected 2 cells, found 1");
    assert_eq!(legacy("CELLS 1 4\n3 0 1 2\n"), "the file ends before CELL_TYPES");
    let cut = vtk::parse_legacy(format!("{LEGACY}CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5").as_bytes()).unwrap();
    assert_eq!(cut.annotations.notes(), ["the file ends without a line end: its last number may be cut short"]);
}

/// The error for a file in which the first of some bytes have been replaced by others.
fn xml_error(file: &str, from: &str, to: &str) -> String {
    let bytes = bytes_of(file);
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect(from);
    let damaged = [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat();
    vtk::parse_xml(&damaged).unwrap_err().to_string()
}

#[test]
fn errors_of_the_structure_name_the_line() {
    let error = |from, to| xml_error("bar_ascii.vtu", from, to);
    assert_eq!(error("</VTKFile>", ""), "line 246: VTKFile: expected </VTKFile>, found the end of the file");
    let kind = "line 2: VTKFile.type: expected one of UnstructuredGrid, PolyData, ImageData, StructuredGrid, RectilinearGrid, found";
    assert_eq!(error("\"UnstructuredGrid\"", "\"Table\""), format!("{kind} \"Table\""));
    let none = "PolyData: expected at least one <Piece>, found none";
    assert_eq!(error("\"UnstructuredGrid\"", "\"PolyData\""), none);
    assert_eq!(error("\"UnstructuredGrid\"", "\"Poly\nData\""), format!("{kind} \"Poly\u{fffd}Data\""));
    assert_eq!(error("<VTKFile", "<svg"), "line 2: VTKFile: expected <VTKFile>, found <svg>");
    assert_eq!(error("</Points>", "</Cells>"), "line 70: Cells: expected </Points>, found </Cells>");
    assert_eq!(error("<Piece", "<Part"), "line 245: Piece: expected </Part>, found </Piece>");
    let order = "line 2: VTKFile.byte_order: expected LittleEndian or BigEndian, found \"Little\"";
    assert_eq!(error("LittleEndian", "Little"), order);
    let count = "line 5: Piece.NumberOfPoints: expected a whole number, found \"-20\"";
    assert_eq!(error("NumberOfPoints=\"20\"", "NumberOfPoints=\"-20\""), count);
    let none = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid/></VTKFile>";
    let error = vtk::parse_xml(none.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "UnstructuredGrid: expected at least one <Piece>, found none");
}

#[test]
fn other_compressors_headers_and_encodings_are_refused() {
    let other = xml_error("bar_zlib.vtu", "vtkZLibDataCompressor", "vtkOtherDataCompressor");
    let expected = "expected vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or none, found \"vtkOtherDataCompressor\"";
    assert_eq!(other, format!("line 2: VTKFile.compressor: {expected}"));
    for (name, title) in [("vtkLZ4DataCompressor", "LZ4"), ("vtkLZMADataCompressor", "XZ")] {
        let wrong = xml_error("bar_zlib.vtu", "vtkZLibDataCompressor", name);
        assert!(wrong.contains(&format!("Points: expected data in the format of {title}")), "{wrong}");
    }
    let header = "line 2: VTKFile.header_type: expected UInt32 or UInt64, found \"UInt16\"";
    assert_eq!(xml_error("bar_blocks.vtu", "UInt32", "UInt16"), header);
    let encoding = xml_error("bar_appended.vtu", "encoding=\"base64\"", "encoding=\"hex\"");
    assert!(encoding.ends_with(": AppendedData.encoding: expected base64 or raw, found \"hex\""), "{encoding}");
}

#[test]
fn errors_of_an_array_name_it() {
    let error = |from, to| xml_error("bar_ascii.vtu", from, to);
    // What no mesh needs is left out with a note.
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let twice = text.replacen("Name=\"gmsh:physical\"", "Name=\"gmsh:physical\" NumberOfComponents=\"2\"", 1);
    let notes = vtk::parse_xml(twice.as_bytes()).unwrap().annotations.notes();
    assert_eq!(
        notes,
        ["an array is left out, for it is damaged: line 206: CellData.gmsh:physical: expected 32 numbers, found 16"]
    );
    assert_eq!(
        error("NumberOfPoints=\"20\"", "NumberOfPoints=\"21\""),
        "line 7: Points: expected 63 numbers, found 60"
    );
    assert_eq!(error("Name=\"offsets\"", "Name=\"ends\""), "Cells: expected an array \"offsets\", found none");
    let kind = "expected one of Int8 to Int64, UInt8 to UInt64, Float32, Float64, found \"Int\"";
    assert_eq!(error("type=\"Int64\"", "type=\"Int\""), format!("line 160: Cells.types.type: {kind}"));
    let real = "line 160: Cells.types: expected a type of whole numbers, found Float64";
    assert_eq!(error("type=\"Int64\"", "type=\"Float64\""), real);
    assert_eq!(
        error("format=\"ascii\"", "format=\"text\""),
        "line 7: Points.format: expected ascii, binary or appended, found \"text\""
    );
    let number = "line 8: Points: expected a number, found \"0.z00000000000e+00\"";
    assert_eq!(error("\n0.", "\n0.z"), number);
}

#[test]
fn stored_arrays_that_do_not_fit_are_refused() {
    let bytes = xml_error("bar_base64.vtu", "NumberOfPoints=\"20\"", "NumberOfPoints=\"19\"");
    assert!(bytes.ends_with("Points: expected 57 numbers of 8 bytes, found 480 bytes"), "{bytes}");
    let blocks = xml_error("bar_zlib.vtu", "NumberOfPoints=\"20\"", "NumberOfPoints=\"19\"");
    assert!(blocks.ends_with("Points: expected 57 numbers of 8 bytes, found 480 bytes"), "{blocks}");
    let missing = xml_error("bar_appended_raw.vtu", "<AppendedData", "<Appended");
    assert!(missing.contains("expected </Appended>"), "{missing}");
    let mark = xml_error("bar_appended.vtu", "\n   _", "\n   ");
    assert!(mark.ends_with("expected <AppendedData> with an underscore before the data, found none"), "{mark}");
    // headers in base64: the bytes of an array; the number, size and last size of its blocks, and their compressed sizes
    let array = |attributes: &str, text: &str| {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\" {attributes}><UnstructuredGrid>\
             <Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"><Points>\
             <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">{text}</DataArray>\
             </Points></Piece></UnstructuredGrid></VTKFile>"
        );
        match vtk::parse_xml(text.as_bytes()) {
            Ok(mesh) => format!("{:?}", mesh.points),
            Err(error) => error.to_string().replace("line 1: Points: ", ""),
        }
    };
    assert_eq!(array("", "DAAAAAAAgD8AAABAAABAQA=="), "[[1.0, 2.0, 3.0]]");
    assert_eq!(array("", "DAAAAAAAgD8AAABAAABAQA==AAAA"), "expected 24 characters of base64, found 28");
    assert_eq!(array("", "DAAAAAAAgD8AAABAAABA"), "expected 12 bytes of data by the header, found 11");
    assert_eq!(array("", "DAAAAAAAgD8AAABA"), "expected 12 bytes of data by the header, found 8");
    assert_eq!(array("", "/////wAAgD8AAABAAABAQA=="), "expected 4294967295 bytes of data by the header, found 14");
    assert_eq!(array("", "DAAAAAAAgD8AA-BAAABAQA=="), "expected base64, found \"-\" as character 14");
    assert_eq!(array("", ""), "expected 8 characters of base64, found 0");
    let zlib = "compressor=\"vtkZLibDataCompressor\"";
    let data = "eJxjYGiwZ2BgcAAiBwAJQwGA";
    assert_eq!(array(zlib, &format!("AQAAAAwAAAAAAAAAEgAAAA=={data}")), "[[1.0, 2.0, 3.0]]");
    assert_eq!(array(zlib, &format!("AQAAAAwAAAAMAAAAEgAAAA=={data}")), "[[1.0, 2.0, 3.0]]");
    let plausible = "expected blocks that compress to 18 bytes in all, found 1 of";
    assert_eq!(
        array(zlib, &format!("AQAAAAwAAAANAAAAEgAAAA=={data}")),
        format!("{plausible} 12 bytes, the last of 13")
    );
    assert_eq!(array(zlib, &format!("AQAAAAAAAAAAAAAAEgAAAA=={data}")), format!("{plausible} 0 bytes, the last of 0"));
    let large = format!("{plausible} 4294967295 bytes, the last of 0");
    assert_eq!(array(zlib, &format!("AQAAAP////8AAAAAEgAAAA=={data}")), large);
    let sizes = array(zlib, &format!("/////wwAAAAMAAAAEgAAAA=={data}"));
    assert_eq!(sizes, "expected the sizes of 4294967295 compressed blocks, found 48 bytes");
    let short = array(zlib, &format!("AQAAAAwAAAAMAAAAEwAAAA=={}", &data[..20]));
    assert_eq!(short, "expected 19 bytes of compressed data, found 20 with their coding");
    let eleven = array(zlib, "AQAAAAwAAAAAAAAAEQAAAA==eJxjYGiwZ2BgcAAiAAfDAUA=");
    assert_eq!(eleven, "expected 12 bytes of data in compressed block 0, found 11");
    let thirteen = array(zlib, "AQAAAAwAAAAAAAAAEwAAAA==eJxjYGiwZ2BgcAAiBwYACsMBgA==");
    assert_eq!(thirteen, "expected the end of compressed block 0 after 12 bytes of data, found none");
    let size = array(zlib, &format!("AQAAAA0AAAAAAAAAEgAAAA=={data}"));
    assert_eq!(size, "expected 3 numbers of 4 bytes, found 13 bytes");
    let other = array(zlib, &format!("AQAAAAwAAAAMAAAAEgAAAA=={}", data.replace("YGiw", "YGix")));
    assert!(other.starts_with("expected data in the format of zlib, found other bytes after "), "{other}");
}

#[test]
fn numbers_of_every_type_are_read() {
    let meshes = TYPES.map(|file| vtk::parse_xml(&bytes_of(file)).unwrap());
    assert_eq!(meshes[0], meshes[1]);
    assert_eq!(meshes[0], meshes[2]);
    assert_eq!(meshes[0].points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.125]]);
    let groups: Vec<_> = meshes[0].blocks.iter().map(|b| b.groups.join(" ")).collect();
    let least =
        "int8=-128 uint8=0 int16=-32768 uint16=0 int32=-2147483648 uint32=0 int64=-9223372036854775808 uint64=0";
    let most = "int8=127 uint8=255 int16=32767 uint16=65535 int32=2147483647 uint32=4294967295 \
                int64=9223372036854775807 uint64=18446744073709551615";
    assert_eq!(groups, [least, most]);
}

#[test]
fn vectors_of_points_are_read_from_every_encoding() {
    for file in TYPES {
        let path = folder().join(file);
        let mesh = Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 1.0).unwrap();
        for name in ["float32", "float64"] {
            let field = Field::read_named(&path, &mesh, 1.0, Some(name)).unwrap();
            let expected: Vec<_> = (0..12).map(|i| Some(f64::from(i) / 8.0 - 0.75)).collect();
            assert_eq!(field.displacements, expected, "{file} {name}");
        }
        let field = Field::read(&path, &mesh, 1.0).unwrap();
        let along: Vec<_> = field.displacements.iter().step_by(3).copied().collect();
        assert_eq!(along, [0.0, 1.0, 2.0, 3.0].map(Some), "{file}");
        let plane = Field::read_named(&path, &mesh, 1.0, Some("whole")).unwrap_err();
        assert!(plane.problem().contains("not real"), "{plane}");
    }
}

#[test]
fn pieces_of_vtk_are_read() {
    let [pieces, inline, raw] = PIECES.map(|file| vtk::parse_xml(&bytes_of(file)).unwrap());
    let one = vtk::parse_xml(&bytes_of("bar_base64.vtu")).unwrap();
    assert_eq!(pieces.points, one.points.repeat(3));
    let moved = |nodes: &[usize], i: usize| nodes.iter().map(|node| node + 20 * i).collect::<Vec<_>>();
    for (thrice, once) in pieces.blocks.iter().zip(&one.blocks) {
        assert_eq!(thrice.connectivity, [0, 1, 2].map(|i| moved(&once.connectivity, i)).concat());
    }
    for empty in [inline, raw] {
        assert!(empty.points.is_empty() && empty.blocks.is_empty());
    }
}

#[test]
fn raw_data_may_look_like_tags() {
    let labels = b"</AppendedData>";
    let array = |kind: &str, name: &str, offset: usize| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>")
    };
    let points = array("Float32", "Points", 0).replace("/>", " NumberOfComponents=\"3\"/>");
    let cells =
        [array("UInt8", "types", 16), array("UInt8", "offsets", 35), array("UInt8", "connectivity", 54)].concat();
    let head = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"15\">\
         <Points>{points}</Points><Cells>{cells}</Cells><CellData>{}</CellData></Piece></UnstructuredGrid>\
         <AppendedData encoding=\"raw\">\n  _",
        array("UInt8", "a", 73)
    );
    let bytes_with_length = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    let ends: Vec<u8> = (1..=15).collect();
    let data: [&[u8]; 5] = [&[0; 12], &[1; 15], &ends, &[0; 15], labels];
    let file = [head.as_bytes(), &data.map(bytes_with_length).concat(), b"\n</AppendedData></VTKFile>"].concat();
    let mesh = vtk::parse_xml(&file).unwrap();
    let count: usize = mesh.blocks.iter().map(|block| block.connectivity.len()).sum();
    assert_eq!(count, 15);
    assert_eq!(mesh.blocks[0].groups, [format!("a={}", labels[0])]);
    for length in 0..file.len() {
        assert!(vtk::parse_xml(&file[..length]).is_err(), "cut to {length} bytes");
    }
}

#[test]
fn names_are_read_with_their_entities() {
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let named = text.replace("gmsh:physical", "&lt;&#963;&#x3C3;&gt; &amp; &quot;&apos; &no; &");
    let mesh = vtk::parse_xml(named.as_bytes()).unwrap();
    assert!(mesh.blocks[0].groups[0].starts_with("<σσ> & \"' &no; &="), "{:?}", mesh.blocks[0].groups);
}

#[test]
fn notes_inside_an_array_are_passed_over() {
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let note = "<InformationKey name=\"a\"><Value index=\"0\">7</Value></InformationKey>";
    let before = text.replace("format=\"ascii\">", &format!("format=\"ascii\">\n{note}{note}"));
    let after = text.replace("</DataArray>", &format!("{note}</DataArray>"));
    let mesh = vtk::parse_xml(text.as_bytes()).unwrap();
    assert_eq!(vtk::parse_xml(before.as_bytes()).unwrap(), mesh);
    assert_eq!(vtk::parse_xml(after.as_bytes()).unwrap(), mesh);
}

#[test]
fn pieces_follow_one_another() {
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let start = text.find("<Piece").unwrap();
    let end = text.find("</Piece>").unwrap() + "</Piece>".len();
    let piece = &text[start..end];
    let twice = format!("{}{piece}{}{}", &text[..start], piece.replace("gmsh:physical", "part"), &text[end..]);
    let (one, two) = (vtk::parse_xml(text.as_bytes()).unwrap(), vtk::parse_xml(twice.as_bytes()).unwrap());
    assert_eq!(two.points, [&one.points[..], &one.points[..]].concat());
    assert_eq!(two.blocks.len(), 2 * one.blocks.len());
    for (first, second) in one.blocks.iter().zip(&two.blocks[one.blocks.len()..]) {
        assert!(second.connectivity.iter().eq(first.connectivity.iter().map(|i| i + 20).collect::<Vec<_>>().iter()));
        assert_eq!(second.groups, [first.groups[0].replace("gmsh:physical", "part")]);
    }
}

#[test]
fn field_data_are_passed_over() {
    let text = String::from_utf8(bytes_of("bar_ascii.vtu")).unwrap();
    let field = "<FieldData><Array type=\"String\" Name=\"a\" format=\"ascii\">65 0</Array>\
                 <DataArray type=\"Int32\" Name=\"b\" NumberOfTuples=\"1\" format=\"ascii\">7</DataArray></FieldData>";
    let with_field = text.replace("<UnstructuredGrid>", &format!("<UnstructuredGrid>{field}"));
    assert_eq!(vtk::parse_xml(with_field.as_bytes()).unwrap(), vtk::parse_xml(text.as_bytes()).unwrap());
}

fn two_cells() -> Grid {
    let mut grid = Grid {
        points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0 / 3.0]],
        point_data: vec![Array { name: "shift".into(), components: 3, values: (0..12).map(f64::from).collect() }],
        cell_data: vec![Array { name: "stress <σ> & \"more\"".into(), components: 1, values: vec![0.1, f64::NAN] }],
        ..Grid::default()
    };
    grid.push_cell(10, &[0, 1, 2, 3]);
    grid.push_cell(3, &[3, 1]);
    grid
}

#[test]
fn a_written_grid_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    let grid = two_cells();
    write(&path, &grid).unwrap();
    let mesh = MeshSource::read(&path).unwrap();
    assert_eq!(mesh.points, grid.points);
    let blocks: Vec<_> = mesh.blocks.iter().map(|b| (b.cell_type, &b.connectivity[..], b.groups.len())).collect();
    assert_eq!(blocks, [(10, &[0, 1, 2, 3][..], 0), (3, &[3, 1][..], 0)]);
    let bytes = fs::read(&path).unwrap();
    for length in 0..bytes.trim_ascii_end().len() {
        assert!(vtk::parse_xml(&bytes[..length]).is_err(), "cut to {length} bytes");
    }
}

#[test]
fn a_grid_that_does_not_fit_together_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    let problem = |change: fn(&mut Grid)| {
        let mut grid = two_cells();
        change(&mut grid);
        write(&path, &grid).unwrap_err().in_file(Path::new("a")).problem().to_string()
    };
    assert_eq!(problem(|grid| grid.point_data[0].components = 2), "expected 1 or 3 components, found 2");
    assert_eq!(problem(|grid| grid.cell_data[0].values.truncate(1)), "expected 2 values, found 1");
    assert_eq!(problem(|grid| grid.connectivity[0] = 4), "expected point indices below 4, found 4");
    assert_eq!(problem(|grid| grid.ends[0] = 3), "expected 4 points for VTK cell type 10, found 3");
    assert_eq!(problem(|grid| grid.cell_data[0].name.clear()), "expected a name of its own for each array");
    assert_eq!(problem(|grid| *grid = Grid::default()), "a grid without points or cells cannot be written");
    assert_eq!(problem(|grid| grid.cell_types[0] = 255), "expected a VTK cell type, found 255");
    assert_eq!(problem(|grid| grid.ends[0] = 9), "expected 2 rising ends up to 6");
    assert!(!path.exists());
}

/// Cells of groups that take turns in a file stay in its order, so that values of cells from elsewhere are those of the same cells: of VTK, Gmsh 2.2 and
/// 4.1, and Abaqus.
#[test]
fn cells_stay_in_the_order_of_their_file() {
    use std::fmt::Write;
    let count = 9;
    let mark = |cell: usize| [1, 2, 1, 3, 2, 2, 1, 3, 1][cell];
    let lines = |of: &dyn Fn(usize) -> String| (0..count).map(of).collect::<String>();
    // A strip of squares; each begins at the corner with the least number.
    let corners = |cell: usize| [2 * cell, 2 * cell + 2, 2 * cell + 3, 2 * cell + 1];
    let nodes = |cell: usize, first: usize, between: &str| {
        corners(cell).map(|corner| (corner + first).to_string()).join(between)
    };
    let points = |begin: &dyn Fn(usize) -> String, between: &str, end: &str| {
        let place = |p: usize| format!("{}{}{between}{}{end}\n", begin(p), p / 2, p % 2);
        (0..2 * count + 2).map(place).collect::<String>()
    };
    let all = 2 * count + 2;
    let vtk = format!(
        "# vtk DataFile Version 3.0\nstrip\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {all} double\n{}CELLS {count} {}\n{}CELL_TYPES {count}\n{}\
         CELL_DATA {count}\nSCALARS part int 1\nLOOKUP_TABLE default\n{}",
        points(&|_| String::new(), " ", " 0"),
        5 * count,
        lines(&|cell| format!("4 {}\n", nodes(cell, 0, " "))),
        lines(&|_| "9\n".into()),
        lines(&|cell| format!("{}\n", mark(cell))),
    );
    let gmsh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{all}\n{}$EndNodes\n$Elements\n{count}\n{}$EndElements\n",
        points(&|p| format!("{} ", p + 1), " ", " 0"),
        lines(&|cell| format!("{} 3 2 {m} {m} {}\n", cell + 1, nodes(cell, 1, " "), m = mark(cell))),
    );
    let mut deck = format!("*NODE\n{}*ELEMENT, TYPE=CPS4\n", points(&|p| format!("{}, ", p + 1), ", ", ""));
    deck += &lines(&|cell| format!("{}, {}\n", cell + 1, nodes(cell, 1, ", ")));
    for part in 1..=3 {
        let own: Vec<String> =
            (0..count).filter(|cell| mark(*cell) == part).map(|cell| (cell + 1).to_string()).collect();
        writeln!(deck, "*ELSET, ELSET=P{part}\n{}", own.join(", ")).unwrap();
    }
    let folder = tempfile::TempDir::new().unwrap();
    for (name, text) in [("strip.vtk", vtk), ("strip.msh", gmsh), ("strip.inp", deck)] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let mesh = Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 1.0).unwrap();
        let firsts: Vec<usize> = mesh.blocks[0].cells().map(|nodes| *nodes.iter().min().unwrap()).collect();
        assert_eq!(firsts, (0..count).map(|cell| 2 * cell).collect::<Vec<usize>>(), "{name}");
        // The cells of each group are still those with its mark.
        let mut marks = vec![0; count];
        for (group, part) in mesh.groups.values().filter(|group| !group.cells.is_empty()).zip(1..) {
            assert!(group.cells.is_sorted_by_key(|at| at.cell), "{name}");
            group.cells.iter().for_each(|at| marks[at.cell] = part);
        }
        assert_eq!(marks, (0..count).map(mark).collect::<Vec<usize>>(), "{name}");
    }
}
