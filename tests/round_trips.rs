//! Random networks in each format of networks, read again by readers of this file that know the formats alone, to the last bit.

use crate::kit;
use crate::shapes::Random;
use proptest::prelude::*;
use springfit_report::report::{MeasureKind, NETWORK_FORMATS, NetworkFile, NetworkFormat, NetworkRecord, read_network};
use springfit_studies::study::Outcome;
use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A body of random size and stiffness whose springs have random constants of both signs over twelve decades.
fn outcome(element: &str, objective: &str, seed: u64) -> Outcome {
    let mut random = Random(seed);
    let d = if element.starts_with("tri") || element.starts_with("quad") { 2 } else { 3 };
    let mut size = || 10f64.powf(random.next());
    let sizes: Vec<f64> = (0..d).map(|_| size()).collect();
    let counts: Vec<usize> = (0..d).map(|_| 1 + (size() as usize) % 2).collect();
    let plane = if d == 2 { ", thickness = 0.01" } else { "" };
    let text = format!(
        "mesh = {{ box = {{ element = \"{element}\", size = {sizes:?}, cells = {counts:?} }} }}\n\
         material = {{ young = {:e}, poisson = 0.3, density = {:e}{plane} }}\nfit = [{{ {objective} }}]\nfix = [{{ group = \"xmin\" }}]\n",
        1e4 * size(),
        1e3 * size()
    );
    let mut outcome = kit::outcome(&text);
    let mut random = Random(seed ^ 0x9e37);
    let factors: Vec<f64> =
        (0..outcome.fits[0].network.len()).map(|_| random.next() * 10f64.powf(6.0 * random.next())).collect();
    outcome.fits[0].network = outcome.fits[0].network.scaled(&factors);
    outcome
}

struct Written {
    folder: TempDir,
    record: NetworkRecord,
}

impl Written {
    fn new(outcome: &Outcome) -> Written {
        let folder = TempDir::new().unwrap();
        let file = NetworkFile::of(outcome, &outcome.fits[0]);
        for format in &NETWORK_FORMATS {
            let path = folder.path().join(format!("network.{}", format.ending));
            NetworkFormat::of(&path).unwrap().write(&path, &file).unwrap();
        }
        Written { folder, record: file.record() }
    }

    fn path(&self, ending: &str) -> PathBuf {
        self.folder.path().join(format!("network.{ending}"))
    }

    /// Points, constant and rest of each spring.
    fn springs(&self) -> Vec<(Vec<usize>, f64, f64)> {
        self.record.springs.iter().map(|s| (s.points.to_vec(), s.constant, s.rest)).collect()
    }
}

/// Columns of numbers of a table, by their headings.
fn table(path: &Path) -> HashMap<String, Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == names.len()));
    names
        .iter()
        .enumerate()
        .map(|(i, name)| (name.to_string(), rows.iter().map(|row| row[i].to_string()).collect()))
        .collect()
}

/// The bytes of an array of a ZIP file of NumPy, behind its header, and the header.
fn array(path: &Path, name: &str) -> (String, Vec<u8>) {
    let mut archive = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
    let length = 10 + u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    (String::from_utf8(bytes[10..length].to_vec()).unwrap(), bytes[length..].to_vec())
}

fn reals(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

fn integers(bytes: &[u8]) -> Vec<usize> {
    bytes.chunks_exact(4).map(|b| i32::from_le_bytes(b.try_into().unwrap()) as usize).collect()
}

/// The bytes of an array of a VTK file: base64 of a length in 64 bits and the numbers.
fn data(text: &str, name: &str) -> Vec<u8> {
    let tag = text.find(&format!("Name=\"{name}\"")).unwrap_or_else(|| panic!("{name} in {text}"));
    let start = tag + text[tag..].find('>').unwrap() + 1;
    let stored = text[start..start + text[start..].find('<').unwrap()].trim();
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => panic!("{c} in base64"),
    };
    let mut bytes = Vec::new();
    // Length and numbers may be two texts in base64, each with an end of its own.
    for part in stored.split_inclusive('=').filter(|part| *part != "=") {
        let digits: Vec<u32> = part.bytes().filter(|c| *c != b'=').map(|c| digit(c).into()).collect();
        for group in digits.chunks(4) {
            let value = group.iter().fold(0, |all, digit| all << 6 | digit) << (6 * (4 - group.len()));
            bytes.extend_from_slice(&value.to_be_bytes()[1..group.len()]);
        }
    }
    assert_eq!(u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize, bytes.len() - 8, "{name}");
    bytes[8..].to_vec()
}

const ELEMENTS: [&str; 6] = ["tri3", "quad4", "tet4", "hex8", "tet10", "hex20"];
const OBJECTIVES: [&str; 3] =
    ["objective = \"exact\"", "objective = \"offdiag\"", "objective = \"offdiag\", springs = [\"edge\", \"bulk\"]"];

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn networks_are_read_as_they_were(element in 0..4usize, objective in 0..3usize, seed in any::<u64>()) {
        let outcome = outcome(ELEMENTS[element], OBJECTIVES[objective], seed);
        let is_simplices = ELEMENTS[element].starts_with('t');
        // Contents of quadrangles and hexahedra are in no array.
        prop_assume!(is_simplices || outcome.fits[0].network.others.is_empty());
        let written = Written::new(&outcome);
        let springs = written.springs();

        // JSON has all.
        prop_assert_eq!(&read_network(&written.path("json")).unwrap(), &written.record);

        // CSV has kinds, points, constants and rest measures.
        let columns = table(&written.path("csv"));
        let numbers = |name: &str| -> Vec<f64> { columns[name].iter().map(|text| text.parse().unwrap()).collect() };
        let points = |text: &String| -> Vec<usize> { text.split(' ').map(|p| p.parse().unwrap()).collect() };
        let found: Vec<_> = columns["points"].iter().map(points).zip(numbers("constant")).zip(numbers("rest")).map(|((p, k), r)| (p, k, r)).collect();
        prop_assert_eq!(&found, &springs);
        let kinds: Vec<&str> = written.record.springs.iter().map(|spring| &spring.kind[..]).collect();
        prop_assert_eq!(&columns["kind"], &kinds);

        // Arrays of NumPy have springs on lengths and on simplices, and points, masses and supports.
        let npz = written.path("npz");
        let real = |name: &str| reals(&array(&npz, name).1);
        let whole = |name: &str| integers(&array(&npz, name).1);
        let d = written.record.dimension;
        let is_length = |spring: &&springfit_report::report::SpringRecord| written.record.measures[spring.measure].kind == MeasureKind::Length;
        let of = |value: fn(&springfit_report::report::SpringRecord) -> f64, lengths: bool| -> Vec<f64> {
            written.record.springs.iter().filter(|s| is_length(s) == lengths).map(value).collect()
        };
        prop_assert_eq!(real("k"), of(|s| s.constant, true));
        prop_assert_eq!(real("rest"), of(|s| s.rest, true));
        let ends: Vec<usize> = written.record.springs.iter().filter(is_length).flat_map(|s| s.points.to_vec()).collect();
        prop_assert_eq!(whole("springs"), ends);
        let places: Vec<f64> = written.record.points.iter().flat_map(|x| [0, 1, 2].map(|k| if k < d { x[k] } else { 0.0 })).collect();
        prop_assert_eq!(real("points"), places.clone());
        prop_assert_eq!(Some(real("masses")), written.record.masses.clone());
        let fixed: Vec<usize> = written.record.held.iter().map(|held| held.point).collect();
        prop_assert_eq!(whole("fixed"), fixed);
        let all = of(|s| s.constant, false);
        let shares = real("k_volume");
        // Contents are those of a simplex up to a factor, which is squared in constants: equal up to rounding.
        prop_assert_eq!(shares.len(), all.len());
        prop_assert!(shares.iter().zip(&all).all(|(found, k)| (found - k).abs() <= 1e-14 * k.abs()));

        // VTU has points, springs as cells, constants and rest measures.
        let vtu = fs::read_to_string(written.path("vtu")).unwrap();
        prop_assert_eq!(reals(&data(&vtu, "k")), springs.iter().map(|s| s.1).collect::<Vec<_>>());
        prop_assert_eq!(reals(&data(&vtu, "rest")), springs.iter().map(|s| s.2).collect::<Vec<_>>());
        let cells: Vec<u64> = data(&vtu, "connectivity").chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap())).collect();
        prop_assert_eq!(cells, springs.iter().flat_map(|s| s.0.iter().map(|p| *p as u64)).collect::<Vec<_>>());
        prop_assert_eq!(reals(&data(&vtu, "Points")), places);
    }
}

/// What the arrays do not hold is an error that names it, and nothing is written.
#[test]
fn springs_that_a_format_does_not_hold_are_refused() {
    let outcome = outcome("hex8", OBJECTIVES[2], 7);
    assert!(!outcome.fits[0].network.others.is_empty());
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("network.npz");
    let file = NetworkFile::of(&outcome, &outcome.fits[0]);
    let error = NetworkFormat::of(&path).unwrap().write(&path, &file).unwrap_err().to_string();
    assert!(error.contains("network.npz") && error.contains("springs"), "{error}");
    assert!(!path.exists());
    for format in NETWORK_FORMATS.iter().filter(|format| format.ending != "npz") {
        let path = folder.path().join(format!("network.{}", format.ending));
        format.write(&path, &file).unwrap();
    }
}
