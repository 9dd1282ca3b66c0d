//! Errors for programs: their kind, their place and their source.

use crate::kit::place;
use springfit_element::element::Element;
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_foundation::symbolic::Scope;
use springfit_mesh::mesh::{BoxMesh, Field, Mesh, MeshSource, gmsh};
use springfit_studies::study::{Event, Scene, run};
use std::error::Error as _;
use std::io;
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// A brick that nothing holds.
const FREE: &str = "[mesh]\nbox = { element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] }\n[material]\nyoung = 1\n\
                    poisson = 0.3\n[[fit]]\nobjective = \"frobenius\"\n[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 1]\n";

#[track_caller]
fn failed<T>(result: Result<T>) -> Error {
    result.err().unwrap()
}

#[track_caller]
fn expression(text: &str) -> Error {
    failed(Scope::new(&["x"]).expression(text))
}

fn quiet(_: Event) {}

fn scene(text: &str) -> Result<Scene> {
    Scene::parse(text, Path::new("scene.toml"))
}

#[track_caller]
fn mesh(text: &str) -> Error {
    failed(gmsh::parse(text.as_bytes()))
}

#[test]
fn each_fault_has_its_kind() {
    let folder = TempDir::new().unwrap();
    let large = folder.path().join("large.msh");
    std::fs::File::create(&large).unwrap().set_len(5_000_000_000).unwrap();
    let cells = |n| BoxMesh {
        element: Arc::new(Element::load("hex8").unwrap()),
        size: vec![1.0; 3],
        cells: vec![n; 3],
        origin: vec![0.0; 3],
    };
    let element = std::fs::read_to_string(place("elements/tet4.toml")).unwrap();
    let named = |from: &str, to: &str| failed(Element::parse(&element.replace(from, to)));
    let unknown = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 999 0 1\n";
    for (kind, error) in [
        (ErrorKind::Io, failed(Scene::load(Path::new("none.toml")))),
        (ErrorKind::Io, failed(Element::load("none.toml"))),
        (ErrorKind::Io, failed(springfit_foundation::file::write_whole(folder.path(), b""))),
        (ErrorKind::Io, failed(springfit_foundation::file::check_folder(&large))),
        (ErrorKind::Syntax, failed(scene("[mesh"))),
        (ErrorKind::Syntax, named("\"xi\" }", "\"xi*\" }")),
        (ErrorKind::Syntax, expression("2 x")),
        (ErrorKind::Syntax, mesh("")),
        (ErrorKind::Syntax, mesh("$MeshFormat\nsolid\n")),
        (ErrorKind::Invalid, failed(scene(&FREE.replace("young = 1", "young = 0")).and_then(|s| run(&s, &mut quiet)))),
        (ErrorKind::Invalid, failed(scene(&FREE.replace("young", "yuong")))),
        (ErrorKind::Invalid, named("at = [0, 0, 1]", "at = [0, 1]")),
        (ErrorKind::Invalid, expression("y")),
        (ErrorKind::Invalid, expression("1/0")),
        (ErrorKind::Invalid, failed(cells(0).build())),
        (ErrorKind::Unsupported, failed(MeshSource::parse(b"", "med"))),
        (ErrorKind::Unsupported, failed(Field::read(Path::new("u.txt"), &cells(1).build().unwrap(), 1.0))),
        (ErrorKind::Unsupported, mesh("$MeshFormat\n3.0 0 8\n")),
        (ErrorKind::Unsupported, mesh(unknown)),
        (ErrorKind::Limit, failed(MeshSource::read(&large))),
        (ErrorKind::Limit, failed(scene(&" ".repeat(1_000_001)))),
        (ErrorKind::Limit, expression(&"1 + ".repeat(5000))),
        (ErrorKind::Limit, expression(&"(".repeat(101))),
        (ErrorKind::Limit, expression(&format!("x{}", " + x".repeat(1001)))),
        (ErrorKind::Limit, expression("(((2^256)^256)^256)^256*x")),
        (ErrorKind::Limit, failed(cells(1000).build())),
        (ErrorKind::Infeasible, failed(run(&scene(FREE).unwrap(), &mut quiet))),
    ] {
        assert_eq!(error.kind(), kind, "{error}");
    }
}

#[test]
fn the_kind_is_kept_where_the_place_is_added() {
    let error = Error::new("expected less").of_kind(ErrorKind::Limit);
    let placed = error.clone().at_key("shape").under("nodes[3]").on_line(7).in_file(Path::new("a.toml"));
    assert_eq!(placed.kind(), ErrorKind::Limit);
    assert_eq!((placed.file(), placed.line()), (Some(Path::new("a.toml")), Some(7)));
    assert_eq!((placed.key(), placed.problem()), (Some("nodes[3].shape"), "expected less"));
    assert_eq!(placed.to_string(), "a.toml:7: nodes[3].shape: expected less");
    assert_eq!(error.clone().at_key("young").of_option().to_string(), "--young: expected less");
    assert_eq!(error.clone().on_line(3).to_string(), "line 3: expected less");
    assert_ne!(error, error.clone().of_kind(ErrorKind::Invalid));
    assert_eq!(Error::expected("a", "b", "c").kind(), ErrorKind::Invalid);
    // A key that is read from a file is on one line.
    assert_eq!(error.at_key("a\nb").to_string(), "a\u{fffd}b: expected less");
}

#[test]
fn failures_of_the_system_are_kept_as_the_source() {
    let error = failed(MeshSource::read(Path::new("none.msh")));
    let source = |error: &Error| error.source().unwrap().downcast_ref::<io::Error>().unwrap().kind();
    assert_eq!(source(&error), io::ErrorKind::NotFound);
    assert_eq!(source(&error.clone().under("mesh")), io::ErrorKind::NotFound);
    let text = error.to_string();
    assert!(text.starts_with("none.msh: cannot be read: "), "{text}");
    // Equal without the source.
    let same = Error::new(error.problem()).of_kind(ErrorKind::Io).in_file(Path::new("none.msh"));
    assert!(same.source().is_none() && same == error);
    assert!(expression("y").source().is_none());
}

#[test]
fn a_line_is_that_of_the_file() {
    let error = failed(scene(&FREE.replace("poisson", "poison")));
    assert_eq!((error.line(), error.key()), (Some(5), Some("material.poison")));
    assert_eq!(failed(scene(FREE).and_then(|scene| run(&scene, &mut quiet))).line(), None);
    let table = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 zero 0\n$EndNodes\n";
    assert_eq!((mesh(table).line(), mesh(table).key()), (Some(6), Some("$Nodes")));
}

/// A cell type that no element serves.
#[test]
fn a_mesh_without_an_element_is_unsupported() {
    let nodes: String = (1..=14).map(|i| format!("{i} {i} {} {}\n", i * i, i % 3)).collect();
    let cell: String = (1..=14).map(|i| format!(" {i}")).collect();
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n14\n{nodes}$EndNodes\n$Elements\n1\n1 14 0{cell}\n$EndElements\n"
    );
    let error = failed(Mesh::resolve(&gmsh::parse(text.as_bytes()).unwrap(), &[], 1.0));
    assert_eq!((error.kind(), error.key()), (ErrorKind::Unsupported, Some("cells")));
}
