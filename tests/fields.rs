//! Reads displacements of a mesh's points from tables and grids: whole, in part, cut short and wrong.

use crate::damage::damaged;
use crate::kit::place;
use crate::messages::reads;
use crate::shapes::Random;
use proptest::prelude::*;
use springfit_foundation::error::ErrorKind;
use springfit_mesh::mesh::vtk::{Array, Grid, write};
use springfit_mesh::mesh::{Annotations, Field, Format, Mesh, MeshSource, NumberOrigin, SourceBlock};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const MESHES: [&str; 3] = ["cube_tet", "specimen_hex", "tissue_quad"];
const AXES: [&str; 3] = ["x", "y", "z"];

fn scene_mesh(name: &str) -> Mesh {
    let path = place(format!("scenes/meshes/{name}.msh"));
    Mesh::resolve(&MeshSource::read(&path).unwrap(), &[], 1.0).unwrap()
}

/// The unit tetrahedron and, each with nodes of its own, others turned half about its last edge, with which they share two places.
fn tetrahedra(count: usize) -> Mesh {
    let block = SourceBlock {
        dimension: 3,
        cell_type: 4,
        nodes_per_cell: 4,
        connectivity: (0..4 * count).collect(),
        groups: Vec::new(),
        is_marker: true,
        runs: Vec::new(),
    };
    let corners = |side: f64| [[0.0; 3], [side, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, 1.0]];
    let points = (0..count).flat_map(|i| corners(if i == 0 { 1.0 } else { -1.0 })).collect();
    let source = MeshSource {
        format: Format::Gmsh,
        origin: NumberOrigin::GmshTag,
        points,
        numbers: Vec::new(),
        blocks: vec![block],
        space: None,
        annotations: Annotations::default(),
    };
    Mesh::resolve(&source, &[], 1.0).unwrap()
}

/// A folder of files to read.
struct Files(TempDir);

impl Files {
    fn new() -> Files {
        Files(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// What is read of a file with this content on the unit tetrahedron.
    fn read(&self, name: &str, content: impl AsRef<[u8]>) -> Vec<Option<f64>> {
        fs::write(self.path(name), content).unwrap();
        Field::read(&self.path(name), &tetrahedra(1), 1.0).unwrap().displacements
    }

    /// The message, without the folder.
    fn fault_on(&self, mesh: &Mesh, name: &str, content: impl AsRef<[u8]>, array: Option<&str>) -> String {
        fs::write(self.path(name), content).unwrap();
        let error = Field::read_named(&self.path(name), mesh, 1.0, array).unwrap_err();
        error.to_string().replace(&format!("{}/", self.0.path().display()), "")
    }

    fn fault(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        self.fault_on(&tetrahedra(1), name, content, None)
    }
}

fn numbers(count: usize) -> impl Strategy<Value = Vec<Option<f64>>> {
    prop::collection::vec(prop::option::weighted(0.8, -1e-2..1e-2), count)
}

/// A mesh, displacements of its points and an order of its points.
fn measured() -> impl Strategy<Value = (Mesh, Vec<Option<f64>>, Vec<usize>)> {
    (0..MESHES.len()).prop_map(|i| scene_mesh(MESHES[i])).prop_flat_map(|mesh| {
        let order: Vec<usize> = (0..mesh.point_count()).collect();
        let values = numbers(mesh.points.len());
        (Just(mesh), values, Just(order).prop_shuffle())
    })
}

fn cell(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}

/// A table of these points; by their numbers unless by their positions.
fn table(mesh: &Mesh, values: &[Option<f64>], order: &[usize], by_position: bool, mark: &str, prefix: &str) -> String {
    let d = mesh.dimension;
    let names = |prefix: &str| AXES[..d].iter().map(|axis| format!("{prefix}{axis}")).collect::<Vec<_>>();
    let place = if by_position { names("") } else { vec!["Point".to_string()] };
    let mut text = [names(prefix), vec!["force (N)".into()], place].concat().join(mark) + "\n";
    for &p in order {
        let mut cells: Vec<String> = values[p * d..(p + 1) * d].iter().map(|&u| cell(u)).collect();
        cells.push("n/a".into());
        match by_position {
            true => cells.extend(mesh.point(p).iter().map(|&x| cell(Some(x)))),
            false => cells.push(p.to_string()),
        }
        text += &(cells.join(mark) + "\n");
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_table_reads_back((mesh, values, order) in measured(), by_position: bool, mark in 0..4_usize) {
        let files = Files::new();
        let text = table(&mesh, &values, &order, by_position, [",", ";", "\t", " ; "][mark], "U");
        fs::write(files.path("u.csv"), &text).unwrap();
        prop_assert_eq!(&Field::read(&files.path("u.csv"), &mesh, 1.0).unwrap().displacements, &values);
        let windows = format!("\u{feff}# made by hand, in m\n\n{}", text.replace('\n', "\r\n\r\n"));
        fs::write(files.path("u.CSV"), windows).unwrap();
        prop_assert_eq!(&Field::read(&files.path("u.CSV"), &mesh, 1.0).unwrap().displacements, &values);
    }

    #[test]
    fn a_grid_reads_back((mesh, values, order) in measured(), name in 0..4_usize) {
        let files = Files::new();
        let grid = grid(&mesh, &values, &order, ["Displacement", "u", "DISP", "u fem pull (m)"][name]);
        write(&files.path("u.vtu"), &grid).unwrap();
        prop_assert_eq!(&Field::read(&files.path("u.vtu"), &mesh, 1.0).unwrap().displacements, &values);
        fs::write(files.path("u.vtk"), legacy(&grid)).unwrap();
        prop_assert_eq!(Field::read(&files.path("u.vtk"), &mesh, 1.0).unwrap().displacements, values);
    }

    #[test]
    fn lengths_are_scaled((mesh, values, order) in measured(), scale in 1e-4..1e4_f64) {
        let files = Files::new();
        let mut scaled = mesh.clone();
        scaled.points.iter_mut().for_each(|x| *x *= scale);
        fs::write(files.path("u.csv"), table(&mesh, &values, &order, true, ",", "u")).unwrap();
        let found = Field::read(&files.path("u.csv"), &scaled, scale).unwrap().displacements;
        prop_assert_eq!(found, values.iter().map(|u| u.map(|u| u * scale)).collect::<Vec<_>>());
    }
}

/// The cells of the mesh and this array, the points in `order`; nan for what is not measured.
fn grid(mesh: &Mesh, values: &[Option<f64>], order: &[usize], name: &str) -> Grid {
    let d = mesh.dimension;
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(i, &p)| place[p] = i);
    let mut grid = Grid::default();
    let mut vectors = Vec::new();
    for &p in order {
        let x = mesh.point(p);
        grid.points.push(std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0)));
        vectors.extend((0..3).map(|k| if k < d { values[p * d + k].unwrap_or(f64::NAN) } else { 9.0 }));
    }
    for block in &mesh.blocks {
        let cell_type = block.element.formats.vtk.as_ref().unwrap().cell_type as u8;
        block.cells().for_each(|nodes| grid.push_cell(cell_type, &nodes.iter().map(|&n| place[n]).collect::<Vec<_>>()));
    }
    let mass = vec![1.0; order.len()];
    grid.point_data = vec![
        Array { name: "mass (kg)".into(), components: 1, values: mass },
        Array { name: name.into(), components: 3, values: vectors },
        Array { name: "Normals".into(), components: 3, values: vec![1.0; 3 * order.len()] },
    ];
    grid
}

/// The grid as a legacy file in binary.
fn legacy(grid: &Grid) -> Vec<u8> {
    let (points, cells) = (grid.points.len(), grid.cell_types.len());
    let header = "# vtk DataFile Version 3.0\n\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    let mut file = format!("{header}POINTS {points} double\n").into_bytes();
    grid.points.as_flattened().iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(format!("\nCELLS {cells} {}\n", cells + grid.connectivity.len()).bytes());
    let mut start = 0;
    for &end in &grid.ends {
        file.extend(((end - start) as u32).to_be_bytes());
        grid.connectivity[start..end].iter().for_each(|&node| file.extend((node as u32).to_be_bytes()));
        start = end;
    }
    file.extend(format!("\nCELL_TYPES {cells}\n").bytes());
    grid.cell_types.iter().for_each(|&kind| file.extend(u32::from(kind).to_be_bytes()));
    file.extend(format!("\nPOINT_DATA {points}\n").bytes());
    for array in &grid.point_data {
        let name = array.name.replace(' ', "%20");
        let header = match array.components {
            1 => format!("SCALARS {name} double\nLOOKUP_TABLE default\n"),
            _ => format!("VECTORS {name} double\n"),
        };
        file.extend(header.bytes());
        array.values.iter().for_each(|value| file.extend(value.to_be_bytes()));
        file.push(b'\n');
    }
    file
}

#[test]
fn what_a_table_leaves_out_is_not_measured() {
    let files = Files::new();
    let text = "x,y,z,UZ,uy\n0,0,0,0.25,\n\n# the left one\n0,1e-7,1,nan,-NaN\n 1 ,0,0, -1e-3 , 0\n,,,,\n";
    let some = |values: [Option<f64>; 12]| values.to_vec();
    let (n, one) = (None, [None, Some(0.0), Some(-1e-3)]);
    assert_eq!(files.read("u.csv", text), some([n, n, Some(0.25), one[0], one[1], one[2], n, n, n, n, n, n]));
    let deformed = "point;x_deformed;Z_Deformed;note\n1;1.25;;\"a;\n b\"\n3;;0.5;\n";
    let expected = some([n, n, n, Some(0.25), n, n, n, n, n, n, n, Some(-0.5)]);
    assert_eq!(files.read("u.csv", deformed), expected);
    let both = "point,x,y,z,ux\n1,1,0,0,0.25\n2,0,1,0,0.5\n";
    assert_eq!(files.read("u.csv", both), some([n, n, n, Some(0.25), n, n, Some(0.5), n, n, n, n, n]));
}

#[test]
fn a_name_chooses_among_several() {
    let files = Files::new();
    let (path, mesh) = (files.path("u.csv"), tetrahedra(1));
    fs::write(&path, "point,Left_x,left_y,right_x,ux\n0,1,2,3,4\n").unwrap();
    let first = |array| Field::read_named(&path, &mesh, 0.5, array).unwrap().displacements[..2].to_vec();
    assert_eq!(first(Some("left")), [Some(0.5), Some(1.0)]);
    assert_eq!(first(Some("RIGHT")), [Some(1.5), None]);
    assert_eq!(first(None), [Some(2.0), None]);
    let path = files.path("u.vtu");
    let order: Vec<usize> = (0..4).collect();
    let mut two = grid(&mesh, &[Some(1.0); 12], &order, "u fem pull (m)");
    two.point_data.push(Array { name: "u modal pull (m)".into(), components: 3, values: vec![2.0; 12] });
    write(&path, &two).unwrap();
    for (name, value) in [("u fem pull (m)", 1.0), ("U MODAL pull (m)", 2.0)] {
        assert_eq!(Field::read_named(&path, &mesh, 1.0, Some(name)).unwrap().displacements, [Some(value); 12]);
    }
    let found = "\"mass (kg)\" (components: 1), \"u fem pull (m)\" (components: 3), \"Normals\" (components: 3), \
                 \"u modal pull (m)\" (components: 3)";
    let bytes = fs::read(&path).unwrap();
    let message = files.fault("u.vtu", &bytes);
    reads(&message, &format!("u.vtu: point data: … \"u\", \"disp\", … found {found}")).unwrap();
    let message = files.fault_on(&mesh, "u.vtu", &bytes, Some("mass (kg)"));
    reads(&message, &format!("u.vtu: point data: … \"mass (kg)\" … found {found}")).unwrap();
    let message = files.fault_on(&mesh, "u.csv", "point,ux\n1,1\n", Some("Left"));
    reads(&message, "u.csv:1: header: … left_x, left_y, left_z, found \"point\", \"ux\"").unwrap();
}

#[test]
fn points_in_one_place_need_their_numbers() {
    let (files, mesh) = (Files::new(), tetrahedra(2));
    let order: Vec<usize> = (0..8).collect();
    let values: Vec<Option<f64>> = (0..24).map(|i| Some(f64::from(i))).collect();
    write(&files.path("u.vtu"), &grid(&mesh, &values, &order, "u")).unwrap();
    assert_eq!(Field::read(&files.path("u.vtu"), &mesh, 1.0).unwrap().displacements, values);
    fs::write(files.path("u.csv"), table(&mesh, &values, &order, false, ",", "u")).unwrap();
    assert_eq!(Field::read(&files.path("u.csv"), &mesh, 1.0).unwrap().displacements, values);
    let message = files.fault_on(&mesh, "u.csv", table(&mesh, &values, &order, true, ",", "u"), None);
    reads(&message, "u.csv:2: position: … found points 0 and 4, both at (0.0, 0.0, 0.0) m").unwrap();
}

#[test]
fn table_errors_say_what_was_expected_and_found() {
    let files = Files::new();
    let fault = |text: &str| files.fault("u.csv", text);
    reads(
        &fault("# by hand\r\n\r\nx,y,z,ux\r\n0,0,0,1\r\n\r\n# far\r\n2,0,0,1\r\n"),
        "u.csv:7: position: … found (2.0, 0.0, 0.0) m, 1.0 m … point 1; … scale 1.0 m …",
    )
    .unwrap();
    let near = "u.csv:2: position: … found (0.0, 2e-6, 0.0) m, 2e-6 m …";
    reads(&fault("x,y,z,ux\n0,2e-6,0,1\n"), near).unwrap();
    for mark in ["", "\u{feff}"] {
        let repeated = format!("{mark}x,y,z,ux\n1,0,0,1\n0,0,0,1\n\n1,0,0,2\n");
        reads(&fault(&repeated), "u.csv:5: point 1: … line 2").unwrap();
    }
    for (header, cells, message) in [
        ("point,ux", "1,inf", "ux: … found inf …"),
        ("point,ux", "1,-1e999", "ux: … found -inf …"),
        ("point,ux", "1,left", "ux: expected a number, found \"left\""),
        ("point,ux", "-1,1", "point: … 0 to 3, found \"-1\""),
        ("point,ux", "4,1", "point: … 0 to 3, found \"4\""),
        ("point,ux", "1.5,1", "point: … 0 to 3, found \"1.5\""),
        ("point,ux", ",1", "point: … 0 to 3, found \"\""),
        ("x,y,z,ux", "0,nan,0,1", "y: expected a number, found \"nan\""),
        ("x,y,z,ux", "0,,0,1", "y: expected a number, found \"\""),
        ("x,y,z,ux", "0,-inf,0,1", "y: … found -inf …"),
        ("point,ux", "1,0,5", "expected 2 cells as in the header, found 3"),
        ("point;ux;uy", "1;0,5", "expected 3 cells as in the header, found 2"),
        ("point;ux", "1;0,5", "ux: expected a number, found \"0,5\""),
        ("point,ux", "1,\"0", "ux: expected a number, found \"0\u{fffd}3,1\""),
        ("x,y,z,point,ux", "0,0,1,2,5", "point: … (0.0, 0.0, 1.0) m, found 2, 1.4142135623730951 m …"),
    ] {
        reads(&fault(&format!("{header}\n{cells}\n3,1\n")), &format!("u.csv:2: {message}")).unwrap();
    }
    for (header, message) in [
        ("x,y,ux", "header: … found \"x\", \"y\", \"ux\""),
        ("X,Y,Z,x,ux", "x: … found two"),
        ("point,Point", "point: … found two"),
        ("point,ux,x_deformed", "header: … ux or x_deformed, found both"),
        ("x;y;z; N ", "header: … ux, uy, uz or x_deformed, y_deformed, z_deformed, found \"x\", \"y\", \"z\", \"n\""),
    ] {
        reads(&fault(&format!("\n{header}\n")), &format!("u.csv:2: {message}")).unwrap();
    }
    reads(&fault("# no\n\n"), "u.csv: … header … found none").unwrap();
    let nothing = "u.csv: … no displacement …";
    reads(&fault("point,ux\n"), nothing).unwrap();
    reads(&fault("point,ux\n1,nan\n2,\n"), nothing).unwrap();
    reads(&files.fault("u.csv", b"point,ux\n\xff"), "u.csv: … UTF-8 …").unwrap();
    reads(&files.fault("u.txt", ""), "u.txt: … .csv, .vtu or .vtk").unwrap();
    let missing = Field::read(&files.path("none.csv"), &tetrahedra(1), 1.0).unwrap_err();
    assert_eq!((missing.kind(), missing.file()), (ErrorKind::Io, Some(files.path("none.csv").as_path())));
    for (scale, found) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let error = Field::read(&files.path("u.csv"), &tetrahedra(1), scale).unwrap_err();
        reads(&error.to_string(), &format!("scale: … found {found}")).unwrap();
    }
}

/// A legacy file of the unit tetrahedron, with `more` points and this data on all.
fn ascii(more: &[[f64; 3]], data: &str) -> String {
    let points: String = more.iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}\n")).collect();
    let count = 4 + more.len();
    format!(
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {count} double\n0 0 0\n1 0 0\n0 1 0\n\
         0 0 1\n{points}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA {count}\n{data}"
    )
}

#[test]
fn points_of_no_cell_may_lie_anywhere() {
    let files = Files::new();
    let data = "FIELD all 2\nid 1 5 int\n1 2 3 4 5\ndisp 2 5 float\n1 2 3 4 5 6 7 nan 9 10\n";
    let found = files.read("u.vtk", ascii(&[[7.0; 3]], data));
    let values = [1.0, 2.0, f64::NAN, 3.0, 4.0, f64::NAN, 5.0, 6.0, f64::NAN, 7.0, f64::NAN, f64::NAN];
    assert_eq!(found, values.map(|v: f64| (!v.is_nan()).then_some(v)));
}

#[test]
fn grid_errors_say_what_was_expected_and_found() {
    let files = Files::new();
    let fault = |more: &[[f64; 3]], data: &str| files.fault("u.vtk", ascii(more, data));
    reads(&fault(&[], ""), "u.vtk: point data: … \"u\", \"disp\", … found none").unwrap();
    let data = "FIELD all 2\nid 3 4 int\n1 2 3 4 5 6 7 8 9 10 11 12\nT 1 4 float\n1 2 3 4\n";
    let found = "\"id\" (components: 3, not real), \"T\" (components: 1)";
    reads(&fault(&[], data), &format!("u.vtk: point data: … found {found}")).unwrap();
    let data = "VECTORS u float\n0 0 0 1 1 1 2 2 2 3 3 3\n";
    let two = format!("{data}VECTORS Disp double\n0 0 0 1 1 1 2 2 2 3 3 3\n");
    let found = "\"u\" (components: 3), \"Disp\" (components: 3)";
    reads(&fault(&[], &two), &format!("u.vtk: point data: … found {found}")).unwrap();
    let inf = data.replace("2 2 2", "2 inf 2");
    reads(&fault(&[], &inf), "u.vtk: points[2]: … found inf …").unwrap();
    let nothing = data.replace(['0', '1', '2', '3'], "nan");
    reads(&fault(&[], &nothing), "u.vtk: … no displacement …").unwrap();
    let one_more = data.replace("3 3 3", "3 3 3 9 0 0");
    let message = fault(&[[1.0, 0.0, 0.0]], &one_more);
    reads(&message, "u.vtk: points[4].displacement: … points[1], …").unwrap();
    let moved = ascii(&[], data).replace("1 0 0\n", "1 0 0.5\n");
    let message = files.fault("u.vtk", moved);
    reads(&message, "u.vtk: points[1].position: … found (1.0, 0.0, 0.5) m, 0.5 m … point 1; …").unwrap();
    let astray = ascii(&[], data).replace("1 0 0\n", "1 nan 0\n");
    reads(&files.fault("u.vtk", astray), "u.vtk: points[1].position: … found (1.0, NaN, 0.0)").unwrap();
    reads(&files.fault("u.vtk", ""), "u.vtk:1: … found \"\"").unwrap();
}

#[test]
fn pieces_may_share_points() {
    let piece = |array: &str, last: f64| {
        let vectors = format!("0 0 0 1 1 1 2 2 2 {last} 3 3");
        format!(
            "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData><DataArray type=\"Float32\" Name=\"{array}\" \
             NumberOfComponents=\"3\" format=\"ascii\">{vectors}</DataArray></PointData><CellData></CellData><Points>\
             <DataArray type=\"Float64\" Name=\"p\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1\
             </DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3\
             </DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray \
             type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>"
        )
    };
    let file = |pieces: &str| {
        let root = "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
                    byte_order=\"LittleEndian\">";
        format!("{root}<UnstructuredGrid>{pieces}</UnstructuredGrid></VTKFile>")
    };
    let files = Files::new();
    let both = file(&(piece("U", 3.0) + &piece("U", 3.0)));
    let expected: Vec<_> = [0.0, 1.0, 2.0, 3.0].iter().flat_map(|&v| [Some(v); 3]).collect();
    assert_eq!(files.read("u.vtu", both), expected);
    let message = files.fault("u.vtu", file(&(piece("U", 3.0) + &piece("U", 4.0))));
    reads(&message, "u.vtu: points[7].displacement: … points[3], …").unwrap();
    let message = files.fault("u.vtu", file(&(piece("U", 3.0) + &piece("v", 3.0))));
    reads(&message, "u.vtu: pieces: … \"U\" … 4 points …").unwrap();
}

#[test]
fn no_file_cut_short_or_damaged_makes_the_reader_panic() {
    let files = Files::new();
    let mesh = scene_mesh("cube_tet");
    let order: Vec<usize> = (0..mesh.point_count()).collect();
    let values: Vec<Option<f64>> = (0..mesh.points.len()).map(|i| Some(1.0 / (i as f64 + 3.0))).collect();
    let grid = grid(&mesh, &values, &order, "u");
    write(&files.path("u.vtu"), &grid).unwrap();
    fs::write(files.path("u.vtk"), legacy(&grid)).unwrap();
    fs::write(files.path("u.csv"), table(&mesh, &values, &order, true, ",", "u")).unwrap();
    let mut random = Random(1);
    for name in ["u.vtu", "u.vtk", "u.csv"] {
        let whole = fs::read(files.path(name)).unwrap();
        assert_eq!(Field::read(&files.path(name), &mesh, 1.0).unwrap().displacements, values);
        let path = files.path(&format!("cut.{name}"));
        for length in (0..whole.len()).step_by(50) {
            fs::write(&path, &whole[..length]).unwrap();
            let read = Field::read(&path, &mesh, 1.0);
            assert!(name != "u.vtu" || read.is_err(), "cut to {length} bytes");
        }
        for round in 0..300 {
            let bytes = damaged(&whole, round, &mut random);
            fs::write(&path, bytes).unwrap();
            if let Ok(field) = Field::read(&path, &mesh, 1.0) {
                assert_eq!(field.displacements.len(), mesh.points.len());
                assert!(field.displacements.iter().flatten().all(|u| u.is_finite()));
            }
        }
    }
}
