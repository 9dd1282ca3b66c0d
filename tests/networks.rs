//! Network files: what is written is read again, explains itself, and is refused in one line where it is wrong.

use crate::kit::outcome;
use crate::report::{LARGE, LINEAR};
use crate::shapes::loaded;
use springfit_bodies::model::{Elastic, MeasureSpring, displaced};
use springfit_element::element::SHIPPED;
use springfit_element::springs::Law;
use springfit_foundation::symbolic::Scope;
use springfit_report::report::{
    FORMAT, MeasureKind, NETWORK_VERSION, NetworkFile, NetworkFormat, NetworkRecord, SpringRecord, network_json,
    network_schema, points_csv, read_network,
};
use springfit_studies::study::{Scene, run};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const TETRAHEDRA: &str = "
[mesh]
box = { element = \"tet4\", size = [1, 1, 1], cells = [2, 2, 2] }
[material]
young = 1e4
poisson = 0.3
density = 1000
[[fit]]
objective = \"exact\"
[[fit]]
objective = \"exact\"
volume = \"patches\"
[[fix]]
group = \"zmin\"
[[load]]
group = \"zmax\"
traction = [0, 0, 10]
[motion]
duration = 1e-3
step = 1e-4
gravity = [0, 0, -9.81]
damping = { ratio = 0.1 }
finite_elements = false
[[motion.force]]
group = \"zmax\"
force = [\"0.1*sin(3*t)\", 0, 0]
";

fn json(file: &NetworkFile) -> Vec<u8> {
    let mut text = Vec::new();
    network_json(file, &mut text).unwrap();
    text
}

/// What a spring measures, from the words of the reference alone.
fn measure(network: &NetworkRecord, spring: &SpringRecord, x: &[f64]) -> f64 {
    let (d, measure) = (network.dimension, &network.measures[spring.measure]);
    let at = |p: usize| &x[p * d..(p + 1) * d];
    match measure.kind {
        MeasureKind::Length => {
            let [a, b] = [0, 1].map(|i| at(spring.points[i]));
            a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        }
        MeasureKind::Expression => {
            let axes = &["x", "y", "z"][..d];
            let names: Vec<String> =
                (0..spring.points.len()).flat_map(|a| axes.iter().map(move |axis| format!("{axis}{a}"))).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let values: Vec<f64> = spring.points.iter().flat_map(|p| at(*p)).copied().collect();
            Scope::new(&names).expression(measure.expression.as_ref().unwrap()).unwrap().evaluate(&values)
        }
        MeasureKind::Squares => {
            let square = |cell: &springfit_report::report::ShareRecord| {
                let [a, b] = [0, 1].map(|i| at(spring.points[cell.nodes[i]]));
                cell.share * a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
            };
            measure.cells.iter().map(square).sum()
        }
        MeasureKind::Turn => {
            let turn = |cell: &springfit_report::report::ShareRecord| {
                let [apex, a, b, director] =
                    [0, 1, 2, 3].map(|i| nalgebra::Vector3::from_column_slice(at(spring.points[cell.nodes[i]])));
                let edge = (b - a).normalize();
                let normal = edge.cross(&(apex - a)).normalize();
                cell.share * (director - a).dot(&normal).atan2((director - a).dot(&edge.cross(&normal)))
            };
            measure.cells.iter().map(turn).sum()
        }
        MeasureKind::Content => {
            let mut sum = 0.0;
            for (cell, term) in measure.cells.iter().flat_map(|cell| measure.terms.iter().map(move |term| (cell, term)))
            {
                let columns = term.gradients[0].len();
                let entry = |k: usize, l: usize| -> f64 {
                    cell.nodes.iter().zip(&term.gradients).map(|(a, g)| at(spring.points[*a])[k] * g[l]).sum()
                };
                let f = nalgebra::DMatrix::from_fn(d, columns, entry);
                let content = if columns == d { f.determinant() } else { (f.transpose() * &f).determinant().sqrt() };
                sum += cell.share * term.weight * content;
            }
            sum
        }
    }
}

fn energy(network: &NetworkRecord, x: &[f64]) -> f64 {
    let of = |spring: &SpringRecord| {
        let c = measure(network, spring, x);
        match &spring.law {
            None => spring.constant * (c - spring.rest).powi(2) / 2.0,
            Some(law) => {
                let law = Law::parse(law).unwrap();
                let parameters: Vec<f64> = law.parameters.iter().map(|name| spring.parameters[name]).collect();
                law.energy(c, spring.rest, &parameters)
            }
        }
    };
    network.springs.iter().map(of).sum()
}

#[test]
fn a_network_is_read_as_it_was_and_has_the_energy_that_it_states() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("network.json");
    let mut random = crate::shapes::Random(5);
    // Only these networks have springs on areas in space that belong to a cell.
    let cubes = TETRAHEDRA.replace("tet4", "hex8").replace("volume = \"patches\"", "energy = \"stable-mooney-rivlin\"");
    for text in [LINEAR, LARGE, TETRAHEDRA, &cubes] {
        let outcome = outcome(text);
        for fit in &outcome.fits {
            let file = NetworkFile::of(&outcome, fit);
            NetworkFormat::of(&path).unwrap().write(&path, &file).unwrap();
            let network = read_network(&path).unwrap();
            assert_eq!(network, file.record(), "{}", fit.fit.name);
            assert_eq!((network.format.as_str(), network.version), (FORMAT, NETWORK_VERSION));
            assert_eq!(network.springs.len(), fit.network.len());
            let u: Vec<f64> = outcome.mesh.points.iter().map(|_| 0.02 * random.next()).collect();
            let x = displaced(&outcome.mesh.points, &u);
            let expected = Elastic::energy(&fit.network, &x).unwrap();
            let found = energy(&network, &x);
            assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{}: {found} {expected}", fit.fit.name);
            // As a model again it answers as it did, to the last bit.
            let model = network.model(&[]).unwrap();
            assert_eq!(Elastic::energy(&model, &x).unwrap().to_bits(), expected.to_bits(), "{}", fit.fit.name);
            let (mut forces, mut known) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            assert!(model.forces(&x, &mut forces) && fit.network.forces(&x, &mut known));
            assert_eq!(forces, known, "{}", fit.fit.name);
            let mesh = network.mesh(&[]).unwrap();
            assert_eq!(mesh.blocks[0].connectivity, outcome.mesh.blocks[0].connectivity);
            // Every spring of a cell says where it comes from.
            let alone = network.springs.iter().filter(|s| s.groups.is_empty() && s.kind != "patch").count();
            assert_eq!(alone, 0, "{}", fit.fit.name);
        }
    }
}

/// Keys do not depend on the fit, at any depth that the schema states.
#[test]
fn networks_of_all_fits_have_the_same_keys() {
    let keys = |value: &serde_json::Value| -> Vec<String> {
        let table = |name: &str, value: &serde_json::Value| -> Vec<String> {
            value.as_object().unwrap().keys().map(|key| format!("{name}.{key}")).collect()
        };
        let mut all = table("", value);
        all.extend(table("provenance", &value["provenance"]));
        for list in ["springs", "measures", "cells"] {
            for entry in value[list].as_array().unwrap() {
                all.extend(table(list, entry));
            }
        }
        all.sort();
        all.dedup();
        all
    };
    let mut found = Vec::new();
    for text in [LINEAR, LARGE, TETRAHEDRA] {
        let outcome = outcome(text);
        let of = |fit| keys(&serde_json::from_slice(&json(&NetworkFile::of(&outcome, fit))).unwrap());
        found.extend(outcome.fits.iter().map(of));
    }
    found.dedup();
    assert_eq!(found.len(), 1, "{found:?}");
    let schema = network_schema();
    let stated = schema["properties"].as_object().unwrap();
    let own: Vec<&str> = found[0].iter().filter_map(|key| key.strip_prefix('.')).collect();
    assert!(own.iter().all(|key| stated.contains_key(*key)) && stated.len() == own.len(), "{own:?}");
}

#[test]
fn a_network_says_how_it_is_held_loaded_and_moved() {
    let outcome = outcome(TETRAHEDRA);
    let network = NetworkFile::of(&outcome, &outcome.fits[0]).record();
    assert_eq!(network.held.len(), 9);
    let total: f64 = network.loads[0].forces.iter().map(|f| f.force[2]).sum();
    assert!((total - 10.0).abs() < 1e-12, "{total}");
    let masses: f64 = network.masses.iter().flatten().sum();
    assert!((masses - 1000.0).abs() < 1e-9);
    let motion = network.motion.unwrap();
    assert_eq!(motion.forces[0].force, "1/10*sin(3*t)");
    assert!((motion.forces[0].shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert_eq!(network.gravity, Some(vec![0.0, 0.0, -9.81]));
    assert!(network.damping.ratio == 0.1 && network.springs.iter().any(|spring| spring.damper > 0.0));
    // A body of 48 tetrahedra has 24 sides of 2 triangles, which enclose it.
    assert_eq!(network.surface.len(), 48);
    let corner = |t: &[usize; 3], i: usize| nalgebra::Vector3::from_column_slice(&network.points[t[i]]);
    let volume = |t: &[usize; 3]| corner(t, 0).dot(&corner(t, 1).cross(&corner(t, 2))) / 6.0;
    assert!((network.surface.iter().map(volume).sum::<f64>() - 1.0).abs() < 1e-12);
    // Symplectic Euler with a step that is longer is refused.
    let step = network.largest_step.unwrap();
    assert!(step > 1e-3 && step < 1.0, "{step}");
    let mut table = Vec::new();
    points_csv(&NetworkFile::of(&outcome, &outcome.fits[0]), &mut table).unwrap();
    let table = String::from_utf8(table).unwrap();
    assert!(table.starts_with("point,node,x (m),y (m),z (m),mass (kg),held\n0,,0e0,0e0,0e0,"), "{table}");
    assert!(table.lines().nth(1).unwrap().ends_with(",x y z"), "{table}");
}

#[test]
fn a_network_that_is_wrong_is_refused_in_one_line_that_says_where() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("network.json");
    let outcome = outcome(TETRAHEDRA);
    let record = NetworkFile::of(&outcome, &outcome.fits[0]).record();
    let text = serde_json::to_string_pretty(&record).unwrap();
    let line = |needle: &str| text.lines().position(|line| line.contains(needle)).unwrap() + 1;
    let spring = text.find("\"springs\"").unwrap();
    let in_springs = |from: &str, to: &str| text[..spring].to_string() + &text[spring..].replacen(from, to, 1);
    let cases: Vec<(String, String)> = vec![
        ("{}".into(), "format: expected \"springfit network\"".into()),
        (text.replacen("\"version\": 1", "\"version\": 7", 1), "version: expected 1".into()),
        (text[..text.len() / 2].into(), "cut short".into()),
        (
            text.replacen("\"dimension\": 3", "\"dimension\": NaN", 1),
            format!(":{}: expected JSON", line("\"dimension\"")),
        ),
        (text.replacen("\"dimension\": 3", "\"dimension\": 3, \"zzz\": 1", 1), "zzz".into()),
        (text.replacen("\"dimension\": 3,", "", 1), "dimension".into()),
        (in_springs("\"constant\": ", "\"constant\": null, \"x\": "), "springs[0].constant".into()),
        (
            in_springs("\"points\": [\n        0", "\"points\": [\n        99"),
            "springs[0].points: expected the place of one of 27 points".into(),
        ),
        (in_springs("\"measure\": 0", "\"measure\": 9"), "springs[0].measure".into()),
        (text.replacen("\"gravity\": [", "\"gravity\": [1, ", 1), "gravity: expected 3 numbers, found 4".into()),
    ];
    for (text, expected) in cases {
        fs::write(&path, &text).unwrap();
        let error = read_network(&path).unwrap_err().to_string();
        assert!(
            error.contains(&expected) && error.contains("network.json") && !error.contains('\n'),
            "{expected}: {error}"
        );
    }
}

#[test]
fn arrays_are_those_that_numpy_reads() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("network.npz");
    let outcome = outcome(TETRAHEDRA);
    let format = NetworkFormat::of(&path).unwrap();
    format.write(&path, &NetworkFile::of(&outcome, &outcome.fits[0])).unwrap();
    let mut archive = zip::ZipArchive::new(fs::File::open(&path).unwrap()).unwrap();
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut archive.by_name("k.npy").unwrap(), &mut bytes).unwrap();
    let length = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00") && (10 + length).is_multiple_of(64));
    let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
    let lengths = &outcome.fits[0].network.lengths;
    assert!(
        header.contains(&format!("'descr': '<f8', 'fortran_order': False, 'shape': ({},)", lengths.len())),
        "{header}"
    );
    let values = bytes[10 + length..].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()));
    assert!(values.eq(lengths.iter().map(|spring| spring.constant)));
    // Patches are not in these arrays.
    let error = format.write(&path, &NetworkFile::of(&outcome, &outcome.fits[1])).unwrap_err().to_string();
    assert!(error.contains("patch") && error.contains("volume = \"points\""), "{error}");
}

/// Of length springs those of all cells that have one there, of others that of its own.
#[test]
fn springs_name_the_groups_that_they_come_from() {
    let mut others = 0;
    for shipped in SHIPPED.iter() {
        let element = loaded(shipped.name);
        let d = element.dimension();
        let [sizes, cells] = [vec!["1"; d].join(", "), vec!["2"; d].join(", ")];
        let mesh = format!("box = {{ element = \"{}\", size = [{sizes}], cells = [{cells}] }}", shipped.name);
        let fits = "[[fit]]\nobjective = \"exact\"\n[[fit]]\nobjective = \"frobenius\"\nnonnegative = true\n";
        let law = "[[fit]]\nobjective = \"sampled\"\nlaw = \"neo-hookean\"\nforce = \"k1*s + k3*s^3\"\nshapes = { count = 20 }\n";
        let law = if d == 3 && element.nodes() < 9 { law } else { "" };
        let scene = format!("[mesh]\n{mesh}\n[material]\nyoung = 1e4\npoisson = 0.3\n{fits}{law}");
        let Ok(scene) = Scene::parse(&scene, Path::new("scene.toml")) else { continue };
        // Not every element fills a box.
        let Ok(outcome) = run(&scene, &mut |_| {}) else { continue };
        for fit in &outcome.fits {
            let [block] = &outcome.mesh.blocks[..] else { panic!("one element") };
            let (springs, network) = (&fit.springs[0], NetworkFile::of(&outcome, fit).record());
            let every: Vec<usize> = (0..springs.nodes()).collect();
            let pairs = springs.pairs().iter().map(|pair| pair.to_vec());
            let functions = springs.functions().iter().map(|function| function.nodes.clone());
            let own: Vec<Vec<usize>> = pairs.chain(functions).collect();
            let mut expected: BTreeMap<(bool, Vec<usize>), BTreeSet<&str>> = BTreeMap::new();
            for nodes in block.cells() {
                for s in 0..springs.len() {
                    let is_length = s < springs.pairs().len();
                    let mut points: Vec<usize> = own.get(s).unwrap_or(&every).iter().map(|&a| nodes[a]).collect();
                    points.sort_unstable();
                    let name = &springs.names()[springs.groups()[s]];
                    expected.entry((is_length, points)).or_default().insert(name);
                }
            }
            for spring in &network.springs {
                let mut points = spring.points.to_vec();
                points.sort_unstable();
                let is_length = spring.kind == "length";
                others += usize::from(!is_length);
                let found: BTreeSet<&str> = spring.groups.iter().map(|&g| &network.groups[g].group[..]).collect();
                let known = &expected[&(is_length, points)];
                let is_right = if is_length { found == *known } else { found.len() == 1 && found.is_subset(known) };
                assert!(is_right, "{} {}: {found:?} of {known:?}", shipped.name, fit.fit.name);
            }
        }
    }
    assert!(others > 100, "{others}");
}

/// A body has about as many springs on contents as cells, and their size decides the memory of a fit: five words for the points, two for
/// the measure, and one each for constant, rest, law and kind, with words of eight bytes.
#[test]
fn a_spring_on_a_tetrahedron_has_88_bytes_and_nothing_on_the_heap() {
    assert!(size_of::<MeasureSpring>() <= 88);
    let outcome = outcome(TETRAHEDRA);
    let springs = &outcome.fits[0].network.others;
    assert!(springs.len() == outcome.mesh.cell_count());
    assert!(springs.iter().all(|spring| !spring.points.spilled() && spring.law.is_none()));
}

/// A ZIP file has sizes before its contents, which a pipe cannot get afterwards.
#[cfg(unix)]
#[test]
fn arrays_go_through_a_pipe_as_they_go_to_a_file() {
    let folder = TempDir::new().unwrap();
    let [path, pipe] = ["network.npz", "pipe.npz"].map(|name| folder.path().join(name));
    let outcome = outcome(TETRAHEDRA);
    let format = NetworkFormat::of(&path).unwrap();
    let file = NetworkFile::of(&outcome, &outcome.fits[0]);
    format.write(&path, &file).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let read = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    format.write(&pipe, &file).unwrap();
    assert!(read.join().unwrap() == fs::read(&path).unwrap());
}

/// `c(x + t) = c(x)` for every t: otherwise a body that is moved would have forces.
#[test]
fn a_measure_that_a_translation_changes_is_refused_with_its_spring() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("n.json");
    let read = |network: &NetworkRecord| {
        fs::write(&path, serde_json::to_string(network).unwrap()).unwrap();
        read_network(&path)
    };
    let outcome = outcome(TETRAHEDRA);
    for fit in &outcome.fits {
        let network = NetworkFile::of(&outcome, fit).record();
        let spring = network.springs.iter().position(|s| network.measures[s.measure].kind == MeasureKind::Content);
        let (spring, mut wrong) = (spring.unwrap(), network.clone());
        let measure = network.springs[spring].measure;
        let expected = format!(
            "springs[{spring}].measure: expected gradients of measures[{measure}] that add up to zero, so that a body that is moved has no forces, found a sum of "
        );
        for (size, is_refused) in [(1e-3, true), (1e-5, true), (1e-8, false)] {
            wrong.measures = network.measures.clone();
            wrong.measures[measure].terms[0].gradients[1][0] += size;
            match read(&wrong) {
                Ok(_) => assert!(!is_refused, "{size}"),
                Err(error) => assert!(is_refused && error.to_string().contains(&expected), "{error}"),
            }
        }
        for (text, words) in [
            ("x1 - x0 + y2 - y1", None),
            ("x1 - 0.5*x0", Some(&expected[..])),
            ("x1*y0", Some(&expected[..])),
            ("x1 - q", Some("springs[")),
            ("import os", Some("springs[")),
        ] {
            wrong.measures = network.measures.clone();
            let own = &mut wrong.measures[measure];
            (own.kind, own.expression) = (MeasureKind::Expression, Some(text.into()));
            match (read(&wrong), words) {
                (Ok(_), None) => {}
                (Err(error), Some(words)) => assert!(error.to_string().contains(words), "{error}"),
                (found, _) => panic!("{text}: {:?}", found.map(|_| "read")),
            }
        }
    }
}
