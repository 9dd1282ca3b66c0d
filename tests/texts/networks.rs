//! Texts of networks: refused where they are read, and in no file that is exported.

use super::hostile::{every, others, printable_lines};
use super::readers::parsed_by_python;
use crate::kit::outcome;
use springfit::export::{Content, TARGETS};
use springfit_foundation::text::printable;
use springfit_mesh::mesh::vtk::{self, Array, Grid};
use springfit_report::report::{NetworkFile, NetworkRecord, read_network};
use std::collections::BTreeSet;
use std::fs;
use tempfile::TempDir;

fn network() -> NetworkRecord {
    let text = "mesh = { box = { element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1] } }\n\
                material = { young = 1e4, poisson = 0.3, density = 1e3 }\n\
                fit = [{ objective = \"offdiag\", nonnegative = true }]\nfix = [{ group = \"zmin\" }]\n";
    let outcome = outcome(text);
    NetworkFile::of(&outcome, &outcome.fits[0]).record()
}

/// The network with this text in place of each of its own.
fn with(network: &NetworkRecord, text: &str) -> NetworkRecord {
    let mut network = network.clone();
    let own = || text.to_string();
    let from = &mut network.provenance;
    (from.program, from.command, from.scene) = (own(), Some(own()), Some(own()));
    (from.mesh, from.settings) = (Some(own()), vec![own()]);
    if let Some(fit) = &mut from.fit {
        (fit.name, fit.objective) = (own(), own());
    }
    if let Some(material) = &mut from.material {
        material.law = Some(own());
    }
    network.notes.push(own());
    network.groups.iter_mut().for_each(|origin| (origin.element, origin.group) = (own(), own()));
    network.cells.iter_mut().for_each(|block| block.element = own());
    network
}

#[test]
fn no_text_of_a_network_is_in_an_export() {
    let plain = network();
    let files = |network: &NetworkRecord| -> Vec<Vec<u8>> {
        let bytes = |content: Content| match content {
            Content::Bytes(bytes) => bytes,
            Content::Grid(grid) => format!("{grid:?}").into_bytes(),
        };
        let of = |target: &springfit::export::Target| target.files(network, None).map_err(|e| e.to_string());
        let taken = TARGETS.iter().filter(|target| target.name != "phystwin" && target.name != "mujoco");
        taken.flat_map(|target| of(target).unwrap()).map(|(_, content)| bytes(content)).collect()
    };
    let expected = files(&plain);
    for text in every() {
        assert!(files(&with(&plain, &text)) == expected, "{:?}", text.get(..40));
    }
}

#[test]
fn texts_of_networks_in_json_are_printable_lines() {
    let folder = TempDir::new().unwrap();
    let (plain, path) = (network(), folder.path().join("n.json"));
    let read = |json: &str| {
        fs::write(&path, json).unwrap();
        read_network(&path)
    };
    for text in printable_lines() {
        let expected = with(&plain, &text);
        assert_eq!(read(&serde_json::to_string(&expected).unwrap()).unwrap(), expected);
    }
    for text in others() {
        let json = serde_json::to_string_pretty(&with(&plain, &text)).unwrap();
        let line = 1 + json.lines().position(|line| line.contains("\"program\"")).unwrap();
        let error = read(&json).unwrap_err();
        assert_eq!((error.line(), error.key()), (Some(line), Some("provenance.program")), "{error}");
        assert!(error.problem().starts_with("expected one line of printable characters, found "), "{error}");
        assert!(!error.to_string().contains(char::is_control));
    }
}

/// The attributes of XML hold any text, read by a reader of another program.
#[test]
fn arrays_of_vtk_have_any_name() {
    let folder = TempDir::new().unwrap();
    let mut grid = Grid { points: vec![[0.0; 3], [1.0, 0.0, 0.0]], ..Grid::default() };
    grid.push_cell(3, &[0, 1]);
    let mut known = BTreeSet::new();
    let is_new = |text: &String| !text.is_empty() && known.insert(printable(text).into_owned());
    let texts: Vec<String> = every().into_iter().filter(is_new).collect();
    let array = |text: &String| Array { name: text.clone(), components: 1, values: vec![1.0, 2.0] };
    grid.point_data = texts.iter().map(array).collect();
    vtk::write(&folder.path().join("grid.vtu"), &grid).unwrap();
    let shown: Vec<String> = texts.iter().map(|text| printable(text).into_owned()).collect();
    fs::write(folder.path().join("names.json"), serde_json::to_string(&shown).unwrap()).unwrap();
    parsed_by_python(
        folder.path(),
        "import json, xml.etree.ElementTree as tree\nfound = [a.get('Name') for a in tree.parse('grid.vtu').find('.//PointData')]\n\
         expected = json.load(open('names.json'))\nassert found == expected, [p for p in zip(found, expected) if p[0] != p[1]][:2]",
    );
}
