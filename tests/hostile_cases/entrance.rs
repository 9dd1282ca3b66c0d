//! Files as people have them: a name stands for what it names, nothing vanishes without a word, and what nobody needs is no reason to refuse.

use super::springfit;
use crate::kit::outcome_in;
use crate::shapes::bodies::vtk_text;
use springfit_mesh::mesh::{Mesh, MeshSource, Selection};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A bar of cubes of 1 m along x: its nodes, with numbers from 1, plane by plane, and its cubes in the order of Abaqus.
fn bar(cubes: usize) -> (Vec<[f64; 3]>, Vec<[usize; 8]>) {
    let corner = |i: usize, a: usize| [i as f64, [0.0, 1.0, 1.0, 0.0][a], [0.0, 0.0, 1.0, 1.0][a]];
    let nodes = (0..=cubes).flat_map(|i| (0..4).map(move |a| corner(i, a))).collect();
    let cube = |i: usize| {
        let at = |plane: usize, a: usize| 4 * (i + plane) + a + 1;
        [at(0, 0), at(1, 0), at(1, 1), at(0, 1), at(0, 3), at(1, 3), at(1, 2), at(0, 2)]
    };
    (nodes, (0..cubes).map(cube).collect())
}

/// The bar as the lines of nodes and elements of a deck.
fn deck(cubes: usize) -> String {
    let (nodes, cells) = bar(cubes);
    let mut text = String::from("*NODE\n");
    nodes.iter().enumerate().for_each(|(i, [x, y, z])| writeln!(text, "{}, {x}, {y}, {z}", i + 1).unwrap());
    text += "*ELEMENT, TYPE=C3D8, ELSET=BODY\n";
    for (i, nodes) in cells.iter().enumerate() {
        let listed: Vec<String> = nodes.iter().map(usize::to_string).collect();
        writeln!(text, "{}, {}", i + 1, listed.join(", ")).unwrap();
    }
    text
}

/// The bar as a file of Gmsh, with quadrangles at its ends: the physical tags of these and of the cubes.
fn gmsh(cubes: usize, ends: [u32; 2], tags: &[u32], names: &str) -> String {
    let (nodes, cells) = bar(cubes);
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n{}\n", nodes.len());
    nodes.iter().enumerate().for_each(|(i, [x, y, z])| writeln!(text, "{} {x} {y} {z}", i + 1).unwrap());
    writeln!(text, "$EndNodes\n$Elements\n{}", 2 + cubes).unwrap();
    let last = 4 * cubes;
    writeln!(text, "1 3 2 {} 1 1 2 3 4", ends[0]).unwrap();
    writeln!(text, "2 3 2 {} 2 {} {} {} {}", ends[1], last + 1, last + 2, last + 3, last + 4).unwrap();
    for (i, nodes) in cells.iter().enumerate() {
        let listed: Vec<String> = nodes.iter().map(usize::to_string).collect();
        writeln!(text, "{} 5 2 {} 1 {}", i + 3, tags[i], listed.join(" ")).unwrap();
    }
    text + "$EndElements\n"
}

/// The largest displacement under a scene with E = 1 kPa and ν = 0, m, and the notes.
fn largest(folder: &Path, file: &str, text: &str, conditions: &str) -> (f64, Vec<String>) {
    fs::write(folder.join(file), text).unwrap();
    let scene = format!(
        "[mesh]\nfile = \"{file}\"\n[material]\nyoung = 1000\npoisson = 0\n[[fit]]\nobjective = \"exact\"\n{conditions}"
    );
    let outcome = outcome_in(folder, &scene).unwrap();
    let u = &outcome.loads[0].fem;
    let d = outcome.mesh.dimension;
    let size = |u: &[f64]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
    (u.chunks_exact(d).map(size).fold(0.0, f64::max), springfit_report::report::notes(&outcome))
}

fn assert_length(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} and {expected}");
}

/// u = F L/(E A): the force at the end of a bar of so many metres that is held at the other end.
#[test]
fn a_support_means_the_points_of_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let picked = "*NSET, NSET=Fixed\n1, 2, 3, 4\n*ELSET, ELSET=Fixed\n1\n*NSET, NSET=Pulled\n17, 18, 19, 20\n*ELSET, ELSET=Pulled\n4\n";
    let conditions = "[[fix]]\ngroup = \"Fixed\"\n[[load]]\ngroup = \"Pulled\"\nforce = [1, 0, 0]\n";
    let (found, notes) = largest(folder.path(), "pair.inp", &(deck(4) + picked), conditions);
    assert_length(found, 4e-3);
    let said = "the name \"Fixed\" stands for 4 points and 1 cell, which are different parts of the body";
    assert!(notes.iter().any(|note| note.contains(said)), "{notes:?}");
    // Names of a part and of the assembly are different things.
    let body: String =
        deck(4).replace("*NODE", "*PART, NAME=P\n*NODE") + "*NSET, NSET=Set-1, GENERATE\n1, 20\n*END PART\n";
    let assembly = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*NSET, NSET=Set-1, INSTANCE=P-1\n1, 2, 3, 4\n\
                    *NSET, NSET=End, INSTANCE=P-1\n17, 18, 19, 20\n*END ASSEMBLY\n";
    let conditions = "[[fix]]\ngroup = \"Set-1\"\n[[load]]\ngroup = \"End\"\nforce = [1, 0, 0]\n";
    let (found, _) = largest(folder.path(), "assembly.inp", &(body + assembly), conditions);
    assert_length(found, 4e-3);
    // A surface and a set of elements.
    let surface =
        "*ELSET, ELSET=LEFT\n1\n*SURFACE, NAME=LEFT, TYPE=ELEMENT\nLEFT, S6\n*NSET, NSET=TIP\n33, 34, 35, 36\n";
    let conditions = "[[fix]]\ngroup = \"LEFT\"\n[[load]]\ngroup = \"TIP\"\nforce = [1, 0, 0]\n";
    let (found, _) = largest(folder.path(), "surface.inp", &(deck(8) + surface), conditions);
    assert_length(found, 8e-3);
    // A name of surfaces and of volumes.
    let names = "$PhysicalNames\n4\n2 1 \"steel\"\n2 2 \"end\"\n3 1 \"steel\"\n3 2 \"foam\"\n$EndPhysicalNames\n";
    let conditions = "[[fix]]\ngroup = \"steel\"\n[[load]]\ngroup = \"end\"\nforce = [1, 0, 0]\n";
    let (found, notes) = largest(folder.path(), "pair.msh", &gmsh(3, [1, 2], &[1, 2, 2], names), conditions);
    assert_length(found, 3e-3);
    assert!(notes.iter().any(|note| note.contains("\"steel\" stands for 1 side and 1 cell")), "{notes:?}");
    // The same on halved cells and on cells with more points.
    let conditions = format!("{conditions}[reference]\nfrom = \"quadratic\"\nrefine = 1\n");
    let (found, _) = largest(folder.path(), "again.msh", &gmsh(3, [1, 2], &[1, 2, 2], names), &conditions);
    assert_length(found, 3e-3);
}

/// One tag in two dimensions of a grid, as converters write those of Gmsh.
#[test]
fn a_tag_of_surfaces_and_of_volumes_means_the_surface() {
    let folder = tempfile::tempdir().unwrap();
    let (nodes, cells) = bar(4);
    let sides = [(9, (0..4).collect()), (9, (16..20).collect())].into_iter();
    let cubes = cells.iter().map(|nodes| (12, nodes.iter().map(|n| n - 1).collect()));
    let text = vtk_text(nodes.as_flattened(), &sides.chain(cubes).collect::<Vec<_>>())
        + "CELL_DATA 6\nSCALARS gmsh:physical KIND 1\nLOOKUP_TABLE default\n1 2 1 1 2 2\n";
    for kind in ["int", "double"] {
        let conditions =
            "[[fix]]\ngroup = \"gmsh:physical=1\"\n[[load]]\nwhere = \"x > 4 - 1e-9\"\nforce = [1, 0, 0]\n";
        let (found, _) = largest(folder.path(), "tags.vtk", &text.replace("KIND", kind), conditions);
        assert_length(found, 4e-3);
    }
}

/// A traction means sides, also those that a program writes as a set of nodes.
#[test]
fn a_traction_on_points_acts_on_the_sides_between_them() {
    let folder = tempfile::tempdir().unwrap();
    let sets = "*NSET, NSET=Fixed\n1, 2, 3, 4\n*NSET, NSET=Face\n17, 18, 19, 20\n";
    let conditions = "[[fix]]\ngroup = \"Fixed\"\n[[load]]\nname = \"pull\"\ngroup = \"Face\"\ntraction = [1, 0, 0]\n";
    let (found, notes) = largest(folder.path(), "face.inp", &(deck(4) + sets), conditions);
    assert_length(found, 4e-3);
    let said = "the group \"Face\" lists points and no sides: the traction pull acts on the 1 outer sides all of whose points it has";
    assert!(notes.iter().any(|note| note.contains(said)), "{notes:?}");
}

fn parsed(text: &str, ending: &str) -> Result<Mesh, String> {
    let source = MeshSource::parse(text.as_bytes(), ending).map_err(|e| e.to_string())?;
    Mesh::resolve(&source, &[], 1.0).map_err(|e| e.to_string())
}

fn read(text: &str, ending: &str) -> Mesh {
    parsed(text, ending).unwrap_or_else(|e| panic!("{ending}: {e}\n{text}"))
}

fn volume(mesh: &Mesh) -> f64 {
    springfit_bodies::model::masses(mesh, 1.0, 1.0).iter().sum()
}

#[test]
fn cells_that_are_no_part_of_the_body_are_counted() {
    let more = "*ELEMENT, TYPE=T3D2, ELSET=REBAR\n10, 1, 5\n11, 2, 6\n*ELEMENT, TYPE=M3D4, ELSET=SKIN\n12, 1, 2, 3, 4\n\
                *ELEMENT, TYPE=MASS, ELSET=M\n13, 1\n*BOUNDARY\nBODY, 1, 3\n1, 1\n*CLOAD\n5, 1, 2.0\n";
    let mesh = read(&(deck(1) + more), "inp");
    let notes = mesh.annotations.notes().join("\n");
    assert!(notes.contains("that they make: MASS (1), 2 lines of REBAR, 1 quadrangle of SKIN"), "{notes}");
    assert!(notes.contains("not taken from it: *BOUNDARY (2), *CLOAD (1)"), "{notes}");
    // Polygons are no sides of cells, also where they have a label.
    let grid = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n\
                CELLS 3 20\n8 0 1 2 3 4 5 6 7\n4 0 1 2 3\n5 0 1 2 3 4\nCELL_TYPES 3\n12\n9\n7\nCELL_DATA 3\nSCALARS part int 1\nLOOKUP_TABLE default\n1 2 3\n";
    let notes = read(grid, "vtk").annotations.notes().join("\n");
    assert!(notes.contains("that they make: 1 polygon of part=3") && !notes.contains("quadrangle"), "{notes}");
    let (folder, deck_file) = (tempfile::tempdir().unwrap(), "rebar.inp");
    fs::write(folder.path().join(deck_file), deck(1) + more).unwrap();
    let scene = "mesh = { file = \"rebar.inp\" }\nfit = [{ objective = \"exact\" }]\n[[material]]\nyoung = 1e9\npoisson = 0.2\n\
                 [[material]]\ngroup = \"REBAR\"\nyoung = 2e11\npoisson = 0.3\n";
    fs::write(folder.path().join("s.toml"), scene).unwrap();
    let (output, said) = springfit(folder.path(), "run s.toml");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("material[1].area: expected the cross-section of the rods"), "{said}");
    fs::write(folder.path().join("s.toml"), scene.to_string() + "area = 1e-4\n").unwrap();
    let (output, said) = springfit(folder.path(), "run s.toml");
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(printed.contains("that they make: MASS (1), 1 quadrangle of SKIN"), "{printed}");
    assert!(printed.contains("1 hex8, 2 bar2"), "{printed}");
    let shells = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n*ELEMENT, TYPE=S4, ELSET=PLATE\n1, 1,2,3,4\n*SHELL SECTION, ELSET=PLATE, MATERIAL=S\n0.002\n";
    let mesh = read(shells, "inp");
    assert_eq!(mesh.annotations.notes(), ["1 S4 element is membranes, without bending stiffness here"]);
    assert_eq!(mesh.annotations.sections[0].thickness, Some(0.002));
    // A strip and a polygon on a cube, a cell that another piece has, and one that nobody sees.
    let grid = "# vtk DataFile Version 3.0\ns\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n\
                0 0 2 1 0 2 1 1 2 0 1 2\nCELLS 4 28\n8 0 1 2 3 4 5 6 7\n4 4 5 7 6\n4 0 1 2 3\n8 4 5 6 7 8 9 10 11\nCELL_TYPES 4\n12\n6\n7\n12\n\
                CELL_DATA 4\nSCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n0 0 0 32\n";
    let mesh = read(grid, "vtk");
    assert_eq!((mesh.cell_count(), volume(&mesh)), (1, 1.0));
    assert_eq!(mesh.annotations.left_out_words(), "1 hidden or repeated cell, 1 quadrangle, 2 triangles");
}

#[test]
fn what_the_reader_does_not_know_is_an_error_with_its_line() {
    let grid = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nGRID,5,,1.,1.,1.\nCTETRA,1,1,1,2,3,4\n";
    for (card, said) in [
        ("CTETRA4,2,1,2,3,4,5\n", "line 7: CTETRA4: expected one of the elements CTETRA"),
        ("=,*1,=,*1,==\n", "line 7: =: expected each card in full"),
        ("GRID,6,7,0.,0.,0.\n", "line 7: system 7: is named by a grid point"),
    ] {
        assert!(parsed(&(grid.to_string() + card), "bdf").unwrap_err().contains(said), "{card}");
    }
    let springs = read(
        &(grid.to_string()
            + "CELAS2,9,100.,1,1,2,1\nSPC,1,1,123\nSPC,1,2,123\nCORD2R,5,,0.,0.,0.,0.,0.,1.,+C1,\n+C1,0.,1.,1.\n"),
        "bdf",
    );
    let notes = springs.annotations.notes().join("\n");
    assert!(notes.contains("CELAS2 (1)") && notes.contains("SPC (2)"), "{notes}");
    for label in ["P2", "S 3", "S10", "TOP"] {
        let text = format!("{}*SURFACE, NAME=A, TYPE=ELEMENT\n1, S1\n1, {label}\n", deck(1));
        let lines = text.lines().count();
        let said = parsed(&text, "inp").unwrap_err();
        assert!(said.starts_with(&format!("line {lines}: *SURFACE: expected a side S1 to S6")), "{label}: {said}");
    }
}

/// S1 and S2 of a shell are its faces, and S3 its first edge; of a plane element S1 is the first edge.
#[test]
fn sides_of_shells_are_those_of_their_program() {
    let text = |kind: &str| {
        format!(
            "*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n*ELEMENT, TYPE={kind}, ELSET=B\n1,1,2,3,4\n*SURFACE, NAME=low, TYPE=ELEMENT\n1, S3\n\
             *SURFACE, NAME=one, TYPE=ELEMENT\n1, S1\n*SURFACE, NAME=edge, TYPE=ELEMENT\n1, E2\n"
        )
    };
    let shell = read(&text("S4"), "inp");
    assert_eq!(shell.groups["low"].sides, [[0, 1]]);
    assert_eq!((shell.groups["one"].cells.len(), shell.groups["one"].sides.len()), (1, 0));
    assert_eq!(shell.groups["edge"].sides, [[1, 2]]);
    let plane = read(&text("CPS4"), "inp");
    assert_eq!((&plane.groups["low"].sides[0], &plane.groups["one"].sides[0]), (&vec![2, 3], &vec![0, 1]));
}

#[test]
fn decks_are_read_with_what_they_include() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    let (nodes, elements) = deck(2).split_at(deck(2).find("*ELEMENT").unwrap()).into_owned_pair();
    write("parts/nodes.inc", nodes.trim_start_matches("*NODE\n"));
    write("parts/cells.inc", &elements);
    write(
        "all.inp",
        "*HEADING\ntwo cubes\n*NODE, INPUT=parts/nodes.inc\n*include, input=parts/cells.inc\n*NSET, NSET=A\n1\n",
    );
    let path = folder.path().join("all.inp");
    let source = MeshSource::read(&path).unwrap();
    assert_eq!(volume(&Mesh::resolve(&source, &[], 1.0).unwrap()), 2.0);
    let files: Vec<String> =
        MeshSource::files(&path).iter().map(|f| f.file_name().unwrap().to_string_lossy().into_owned()).collect();
    assert_eq!(files, ["all.inp", "nodes.inc", "cells.inc"]);
    // A fault is in the file that has it, on its own line.
    write("parts/cells.inc", &(elements.clone() + "3, 1, 2, x\n"));
    let said = MeshSource::read(&path).unwrap_err().to_string();
    assert!(said.contains("cells.inc:4: *ELEMENT: expected the number"), "{said}");
    write("parts/cells.inc", "*INCLUDE, INPUT=../all.inp\n");
    let said = MeshSource::read(&path).unwrap_err().to_string();
    assert!(said.contains("cells.inc:1: includes \"../all.inp\", which includes this file"), "{said}");
    write("parts/cells.inc", "*INCLUDE, INPUT=none.inc\n");
    let said = MeshSource::read(&path).unwrap_err().to_string();
    assert!(said.contains("cells.inc:1: includes \"none.inc\", which cannot be read"), "{said}");
    write("a.bdf", "BEGIN BULK\nINCLUDE 'gr\nid.inc'\nCTETRA,1,1,1,2,3,4\nENDDATA\n");
    write("grid.inc", "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n");
    let source = MeshSource::read(&folder.path().join("a.bdf")).unwrap();
    assert!((volume(&Mesh::resolve(&source, &[], 1.0).unwrap()) - 1.0 / 6.0).abs() < 1e-15);
}

/// The two parts of a text, each its own.
trait Owned {
    fn into_owned_pair(self) -> (String, String);
}

impl Owned for (&str, &str) {
    fn into_owned_pair(self) -> (String, String) {
        (self.0.to_string(), self.1.to_string())
    }
}

/// Points of other systems, by their definitions: a cylinder of radius 2 about the axis through (1, 0, 0) along y, a sphere, and systems of others.
#[test]
fn grid_points_are_where_their_systems_put_them() {
    let text = "CORD2C,1,,1.,0.,0.,1.,1.,0.\n,2.,0.,0.\nCORD2S,2,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD1R,3,11,12,13\nCORD2R,4,3,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\n\
                GRID,1,1,2.,0.,0.\nGRID,2,1,2.,90.,0.5\nGRID,3,2,2.,90.,0.\nGRID,4,2,2.,60.,90.\nGRID,5,3,1.,2.,3.\nGRID,6,4,1.,2.,3.\n\
                GRID,11,,5.,0.,0.\nGRID,12,,5.,0.,1.\nGRID,13,,5.,1.,0.\nCTETRA,1,1,1,2,3,4\nCTETRA,2,1,1,2,5,6\nCTETRA,3,1,1,11,12,13\n";
    let source = MeshSource::parse(text.as_bytes(), "bdf").unwrap();
    let at = |number: u64| source.points[source.numbers.iter().position(|n| *n == number).unwrap()];
    let s = 3f64.sqrt();
    for (number, expected) in [
        (1, [3.0, 0.0, 0.0]),
        (2, [1.0, 0.5, -2.0]),
        (3, [2.0, 0.0, 0.0]),
        (4, [0.0, s, 1.0]),
        // System 3 has z along z and x along y, and so y along −x; system 4 has the x of system 3 for z, and y for x.
        (5, [5.0 - 2.0, 1.0, 3.0]),
        (6, [5.0 - 1.0, 3.0, 2.0]),
    ] {
        for (found, expected) in at(number).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{number}: {:?} and {expected:?}", at(number));
        }
    }
    let system = "*SYSTEM\n1, 2, 3, 1, 3, 3\n0, 2, 3\n*NODE\n1, 0,0,0\n2, 1,0,0\n*NODE, SYSTEM=C\n3, 1, 90, 0\n*SYSTEM\n*NODE\n4, 0,0,0\n*ELEMENT, TYPE=C3D4\n1, 1,2,3,4\n";
    let source = MeshSource::parse(system.as_bytes(), "inp").unwrap();
    assert_eq!(source.points[0], [1.0, 2.0, 3.0]);
    for (found, expected) in source.points[1].iter().chain(&source.points[2]).zip([1.0, 3.0, 3.0, 0.0, 2.0, 3.0]) {
        assert!((found - expected).abs() < 1e-12, "{:?}", source.points);
    }
    assert_eq!(source.points[3], [0.0; 3]);
}

/// Two instances of a part, one of them turned and moved, and sets of the assembly on each.
#[test]
fn instances_of_a_part_are_pieces_with_groups_of_their_own() {
    let part = deck(1).replace("*NODE", "*PART, NAME=Cube\n*NODE") + "*NSET, NSET=Left\n1, 2, 3, 4\n*END PART\n";
    let assembly = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=one, PART=Cube\n*END INSTANCE\n*INSTANCE, NAME=two, PART=Cube\n5., 0., 0.\n\
                    5., 0., 0., 5., 0., 1., 90.\n*END INSTANCE\n*NODE\n1, 9., 9., 9.\n*NSET, NSET=ends, INSTANCE=one\n5\n*NSET, NSET=ends, INSTANCE=two\n5\n\
                    *NSET, NSET=lefts\none.Left, two.Left\n*NSET, NSET=reference\n1\n*ELSET, ELSET=both, INSTANCE=two\n1\n*SURFACE, NAME=top, TYPE=ELEMENT\n\
                    both, S1\n*ELSET, ELSET=whole, INSTANCE=one\n1\n*SURFACE, NAME=Base\nwhole, \n*SURFACE, NAME=union, COMBINE=UNION\ntop, Base\n*END ASSEMBLY\n";
    let combined = |way: &str| parsed(&(part.clone() + &assembly.replace("UNION\ntop, Base", way)), "inp").unwrap_err();
    assert!(combined("UNION\ntop, Bases").contains("expected a surface that is listed before, found \"Bases\""));
    assert!(
        combined("DIFFERENCE\ntop, Base")
            .contains("*SURFACE: expected COMBINE=UNION, found COMBINE=DIFFERENCE: list the sides")
    );
    let mesh = read(&(part + assembly), "inp");
    assert_eq!((mesh.cell_count(), mesh.point_count(), mesh.quality.pieces), (2, 16, Some(2)));
    let points = |name: &str| -> Vec<Vec<f64>> {
        let selected = Selection::Group(name.into()).points(&mesh).unwrap();
        selected.iter().map(|&p| mesh.point(p).iter().map(|x| x.round()).collect()).collect()
    };
    assert_eq!(points("ends"), [[1.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    assert_eq!((points("lefts").len(), points("one.Left").len(), points("two.Left").len()), (8, 4, 4));
    assert!(!mesh.groups.contains_key("reference") && !mesh.groups.contains_key("Left"));
    assert_eq!((mesh.groups["both"].cells.len(), mesh.groups["top"].sides.len()), (1, 1));
    assert_eq!((mesh.groups["Base"].sides.len(), mesh.groups["union"].sides.len()), (6, 7));
}

/// Parts of files that no mesh needs, damaged or cut, and what other programs write otherwise.
#[test]
fn what_nobody_needs_is_no_reason_to_refuse() {
    let nodes = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
    let elements = "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
    let cut = read(&format!("{nodes}{elements}$NodeData\n1\n\"u\"\n1\n0\n3\n0\n1\n4\n1 0\n2 0\n"), "msh");
    assert!(cut.annotations.notes()[0].contains("ends inside $NodeData"), "{:?}", cut.annotations);
    let named = read(&format!("{nodes}{elements}$PhysicalNames\n1\n3 1 poly1\n$EndPhysicalNames\n"), "msh");
    assert!(named.groups.contains_key("poly1"));
    read(&format!("{nodes}{elements}").replace("2.2 0 8", "2.200000 0 8"), "msh");
    let grid = "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 2 4\n\
                OFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\nFIELD FieldData 1\nid 1 1 int\n7";
    let metadata = read(&format!("{grid}\nMETADATA\nINFORMATION 0"), "vtk");
    assert!(
        metadata.groups.contains_key("id=7") && metadata.annotations.notes().is_empty(),
        "{:?}",
        metadata.annotations
    );
    assert!(read(grid, "vtk").annotations.notes()[0].contains("may be cut short"));
    let xml = |types: &str, points: &str, connectivity: &str, data: &str| {
        let (count, nodes) = (points.split_whitespace().count() / 3, connectivity.split_whitespace().count());
        format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"{count}\" \
             NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points><Cells>\
             <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">{connectivity}</DataArray><DataArray type=\"Int32\" Name=\"offsets\" \
             format=\"ascii\">{nodes}</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{types}</DataArray></Cells>{data}</Piece>\
             </UnstructuredGrid></VTKFile>"
        )
    };
    let tet = "0 0 0 1 0 0 0 1 0 0 0 1";
    let wrong = "<CellData><DataArray type=\"Float32\" Name=\"uv\" NumberOfComponents=\"3\" format=\"ascii\">0 0</DataArray></CellData>";
    let left_out = read(&xml("10", tet, "0 1 2 3", wrong), "vtu").annotations.notes().join("");
    assert!(
        left_out.contains("an array is left out") && left_out.contains("CellData.uv: expected 3 numbers, found 2"),
        "{left_out}"
    );
    assert!((volume(&read(&xml("71", tet, "0 1 2 3", ""), "vtu")) - 1.0 / 6.0).abs() < 1e-15);
    // A hexahedron of Lagrange's of degree 2, moved by a polynomial of degree 2, in both orders that programs write.
    let edges = [[0, 1], [1, 2], [3, 2], [0, 3], [4, 5], [5, 6], [7, 6], [4, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
    let corners: [[f64; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|c| c.map(f64::from));
    let mut reference: Vec<[f64; 3]> = corners.to_vec();
    reference.extend(edges.map(|[a, b]| std::array::from_fn(|k| 0.5 * (corners[a][k] + corners[b][k]))));
    reference.extend([
        [0.0, 0.5, 0.5],
        [1.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [0.5, 1.0, 0.5],
        [0.5, 0.5, 0.0],
        [0.5, 0.5, 1.0],
        [0.5, 0.5, 0.5],
    ]);
    // x + 0.1 y², y, z + 0.2 x y: its Jacobian determinant is 1.
    let moved: Vec<[f64; 3]> = reference.iter().map(|[x, y, z]| [x + 0.1 * y * y, *y, z + 0.2 * x * y]).collect();
    let points = moved.iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let order: Vec<usize> = (0..27).collect();
    for (swapped, order) in [(false, order.clone()), (true, [&order[..18], &[19, 18], &order[20..]].concat())] {
        let nodes = order.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
        let mesh = read(&xml("72", &points, &nodes, ""), "vtu");
        assert!((volume(&mesh) - 1.0).abs() < 1e-12, "{swapped}: {}", volume(&mesh));
    }
}

/// The content of a file says what it is, whatever its ending.
#[test]
fn content_decides_and_not_the_ending() {
    assert_eq!(volume(&read(&deck(2), "msh")), 2.0);
    assert_eq!(volume(&read(&gmsh(2, [1, 2], &[1, 1], ""), "inp")), 2.0);
    let grid = "NASTRAN FILES=UMF\nSOL 1,0\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,1,1,1,2,3,4\nENDDATA\n";
    for ending in ["inp", "fem", "dat", "txt", ""] {
        assert!((volume(&read(grid, ending)) - 1.0 / 6.0).abs() < 1e-15, "{ending}");
    }
    for (text, name, way) in [
        ("8 1 0 0 0\n1 0 0 0\n2 1 0 0\n", "AVS (UCD)", "meshio convert --input-format avsucd"),
        ("<mujoco>\n</mujoco>\n", "MuJoCo", "name the mesh file"),
        ("(0 \"Fluent\")\n(2 3)\n", "Fluent", "--input-format ansys"),
        ("MESH dimension 3 ElemType Tetrahedra Nnode 4\n", "GiD", "GiD's export"),
        ("*KEYWORD\n*NODE\n", "LS-DYNA", "LS-PrePost"),
        (
            "<?xml version=\"1.0\"?>\n<VTKFile version=\"0.1\" type=\"Collection\">\n",
            "a list of files",
            "name one of the files",
        ),
        ("<VTKFile type='PUnstructuredGrid'>\n", "a list of files", "name one of the files"),
        ("<VTKFile type=\"vtkMultiBlockDataSet\">\n", "a list of files", "name one of the files"),
    ] {
        for ending in ["inp", "msh", "bdf", "txt"] {
            let said = parsed(text, ending).unwrap_err();
            assert!(said.contains(name) && said.contains(way), "{ending}: {said}");
        }
    }
}

/// Pieces that share no node and lie in each other are told, and pieces that touch are not.
#[test]
fn pieces_inside_each_other_are_told() {
    let (nodes, cubes) = bar(1);
    let cube = cubes[0].map(|node| nodes[node - 1]);
    let two = |kind: u8, shift: f64| {
        let corners = if kind == 12 { &cube[..] } else { &[cube[0], cube[1], cube[3], cube[4]] };
        let (n, moved) = (corners.len(), corners.iter().map(|[x, y, z]| [x + shift, *y, *z]));
        let points: Vec<[f64; 3]> = corners.iter().copied().chain(moved).collect();
        let text = vtk_text(points.as_flattened(), &[(kind, (0..n).collect()), (kind, (n..2 * n).collect())]);
        springfit_report::report::mesh_notes(&read(&text, "vtk")).join("\n")
    };
    let words = "have parts of another piece of the mesh inside: the body is there twice";
    for kind in [10, 12] {
        assert!(
            two(kind, 0.3).contains(&format!("2 cells {words}")) || two(kind, 0.3).contains("1 cell has parts"),
            "{}",
            two(kind, 0.3)
        );
        for apart in [1.0, 1.5] {
            assert!(!two(kind, apart).contains("of another piece"), "{kind}: {}", two(kind, apart));
        }
    }
}

/// What is beyond the counts of a header is told.
#[test]
fn lines_beyond_the_header_are_counted() {
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n3 0 2 1\n";
    assert_eq!(read(off, "off").annotations.notes(), ["2 lines after the faces that the header counts were left out"]);
    let (node, ele) = (b"4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n", b"1 4 0\n1 1 2 3 4\n");
    let source = MeshSource::parse_tetgen(node, ele, None).unwrap();
    assert_eq!(source.annotations.notes(), ["1 line after the points of .node that the header counts were left out"]);
}

/// A flat sheet is a surface in space if its format is one of surfaces, whatever axis it is across; and a plane mesh where the scene says so.
#[test]
fn sheets_of_surface_formats_are_in_space() {
    let obj = |across: usize| {
        let at = |x: f64, y: f64| match across {
            2 => format!("v {x} {y} 0\n"),
            _ => format!("v {x} 0 {y}\n"),
        };
        [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)].concat() + "f 1 2 3\nf 1 3 4\n"
    };
    for across in [1, 2] {
        assert_eq!(read(&obj(across), "obj").dimension, 3);
    }
    let mut source = MeshSource::parse(obj(2).as_bytes(), "obj").unwrap();
    source.space = Some(2);
    assert_eq!(Mesh::resolve(&source, &[], 1.0).unwrap().dimension, 2);
    source.points[0][2] = 0.1;
    assert!(Mesh::resolve(&source, &[], 1.0).unwrap_err().to_string().contains("space: expected points with one z"));
    let rope = "v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n";
    assert_eq!((read(rope, "obj").dimension, read(rope, "obj").cell_dimension()), (3, 1));
}
