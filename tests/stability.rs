//! What is promised in stiff and extreme cases, and the gate for poor cells.

use crate::kit::{holding, prints, said, springfit};
use crate::messages::reads;
use crate::shapes::{elements, with_angles};
use springfit_element::element::Element;
use springfit_report::report;
use springfit_studies::study::{Family, Scene, StabilityRow, Verdict, stability, stability_of_scene};
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

fn swept(name: &str) -> Vec<StabilityRow> {
    stability(Some(Element::load(name).unwrap()), &mut |_| {}).unwrap().rows
}

/// Nothing is lost, every case has a verdict with its figure or its reason, and what must be refused is.
#[test]
fn every_case_ends_accurate_or_with_its_reason() {
    for name in ["tri3", "quad4", "tet4", "tri6"] {
        let rows = swept(name);
        for row in &rows {
            let told = format!("{name}, {}, {}: {:?} {:?}", row.case, row.method, row.verdict, row.error);
            assert!(row.verdict != Verdict::Lost, "{told}");
            assert_eq!(row.verdict.words().is_empty(), !matches!(row.verdict, Verdict::Refused(_) | Verdict::Told(_)));
            let finite = [row.error, row.allowed, row.single, row.condition, row.softest, row.step];
            assert!(finite.into_iter().flatten().all(f64::is_finite), "{told}");
            if matches!(row.verdict, Verdict::Accurate | Verdict::InputLimited) {
                assert!(row.error.unwrap() <= row.allowed.unwrap(), "{told}");
            }
            if row.verdict == Verdict::Accurate {
                // Beside an optimum of zero the rounding of the constants counts.
                assert!(row.allowed.unwrap() <= 1.2e-6, "{told}");
                assert!(row.allowed.unwrap() <= 1.1e-8 || row.method.starts_with("spectral"), "{told}");
            }
        }
        let all = |family| rows.iter().filter(move |row| row.family == family);
        for family in [Family::Young, Family::Size, Family::Place] {
            assert!(all(family).all(|row| row.verdict == Verdict::Accurate), "{name} {family:?}");
        }
        assert!(all(Family::Reversed).all(|row| row.verdict.words().contains("numbered the other way round")));
        // Single precision loses what it must: the figure is a measured one.
        let plain = all(Family::Poisson).filter(|row| row.method == "frobenius").filter_map(|row| row.single);
        assert!(plain.clone().count() > 5 && plain.clone().all(|error| error > 1e-9 && error < 1e-4));
    }
}

/// Springs on the angles between the edges of every corner: angles near 0 and π, constants of two units, and the weight of blocks, which has
/// a reference in twice the digits as the others have.
#[test]
fn no_case_of_an_element_with_springs_on_angles_is_lost() {
    WITH_ANGLES.iter().for_each(|name| expect_none_lost(name));
}

/// All other shipped elements of up to 15 nodes.
#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn no_case_of_a_large_element_with_springs_on_angles_is_lost() {
    let others = elements().into_iter().filter(|element| element.dimension() > 1 && element.nodes() <= 15);
    let others: Vec<String> = others.map(|e| e.name).filter(|name| !WITH_ANGLES.contains(&&**name)).collect();
    assert_eq!(others.len(), 10);
    others.iter().for_each(|name| expect_none_lost(name));
}

/// The elements of 20 nodes have 214 springs then, that of 27 nodes 376.
#[test]
#[ignore = "takes an hour of a processor; .ci/long has it"]
fn no_case_of_the_largest_elements_with_springs_on_angles_is_lost() {
    let names: Vec<String> = elements().into_iter().filter(|e| e.nodes() > 15).map(|e| e.name).collect();
    assert_eq!(names.len(), 3);
    names.iter().for_each(|name| expect_none_lost(name));
}

/// Elements whose sweep takes some seconds.
const WITH_ANGLES: [&str; 5] = ["tri3", "quad4", "pentagon5", "tri6", "tet4"];

fn expect_none_lost(name: &str) {
    let rows = stability(Some(with_angles(name)), &mut |_| {}).unwrap().rows;
    let lost: Vec<&StabilityRow> = rows.iter().filter(|row| row.verdict == Verdict::Lost).collect();
    assert!(lost.is_empty(), "{name}: {lost:?}");
    assert!(!rows.iter().any(|row| matches!(row.verdict, Verdict::Told(_))), "{name}");
    let accurate = rows.iter().filter(|row| row.verdict == Verdict::Accurate).count();
    assert!(accurate > 300, "{name}: {accurate}");
}

/// The printed text lists trouble apart from remarks, and each trouble has its way out.
#[test]
fn trouble_names_its_way_out_and_what_is_stable_is_no_trouble() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("square.toml");
    let text = "[mesh]\nbox = { element = \"quad4\", size = [1, 1], cells = [3, 3] }\n[material]\nyoung = 10e3\npoisson = 0.3\n\
                [[fit]]\nobjective = \"offdiag\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\ngroup = \"xmax\"\ntraction = [10, 0]\n";
    fs::write(&path, text).unwrap();
    let outcome = stability_of_scene(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap();
    let text = report::stability_text(&outcome);
    assert!(!text.contains("Trouble") && text.contains("Remarks that are no trouble"), "{text}");
    let swept = stability(Some(Element::load("quad4").unwrap()), &mut |_| {}).unwrap();
    let text = report::stability_text(&swept);
    let (trouble, ways) = (text.split("Trouble, and the way out").nth(1).unwrap(), swept.rows.iter());
    assert!(trouble.contains("-> list the nodes in the opposite order"), "{text}");
    for row in ways.filter(|row| matches!(row.verdict, Verdict::Refused(_))) {
        assert!(row.is_trouble() && row.way_out.is_some(), "{row:?}");
        // No cell is slender or misshapen where the material alone is varied.
        let mends_cells = row.way_out.unwrap().contains("mesh anew");
        assert!(!mends_cells || !matches!(row.family, Family::Poisson | Family::Young | Family::Size), "{row:?}");
    }
}

#[test]
fn the_program_writes_its_table_and_maps() {
    let folder = TempDir::new().unwrap();
    let text = prints(folder.path(), &["stability", "tri3"]);
    assert!(text.contains("Poisson's ratio") && text.contains(", 0 lost"), "{text}");
    let out = folder.path().join("out/stability-tri3");
    let table = fs::read_to_string(out.join("stability.csv")).unwrap();
    assert!(table.starts_with("of,family,case,method,status,words,error,allowed"), "{table}");
    assert!(table.lines().count() > 200);
    assert!(fs::read_to_string(out.join("tri3.svg")).unwrap().contains("<title>"));
    let output = springfit(folder.path(), &["stability", "tri33"]);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.starts_with("error: element: expected one of bar2, "), "{error}");
}

/// Errors of displacements do not depend on units.
#[test]
fn a_scene_gives_the_same_errors_in_all_units() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("box.toml");
    let text = "[mesh]\nbox = { element = \"tet4\", size = [1, 1, 1], cells = [2, 2, 2] }\n[material]\nyoung = 10e3\n\
                poisson = 0.3\n[[fit]]\nobjective = \"offdiag\"\n[[fit]]\nobjective = \"frobenius\"\n[[fix]]\n\
                group = \"zmin\"\n[[load]]\ngroup = \"zmax\"\ntraction = [10, 0, 10]\n";
    fs::write(&path, text).unwrap();
    let outcome = stability_of_scene(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap();
    assert_eq!(outcome.lost().count(), 0, "{}", report::stability_text(&outcome));
    let same = outcome.rows.iter().filter(|row| matches!(row.family, Family::Young | Family::Size));
    assert_eq!(same.clone().count(), 22);
    assert!(same.clone().all(|row| row.error.is_some_and(|error| error < 1e-9)), "{:?}", same.collect::<Vec<_>>());
}

/// Two good tetrahedra and, after them, as many as are asked for whose fourth node is `height` above the others.
fn mesh(flat: &[f64]) -> String {
    let mut nodes =
        vec!["1 0 0 0".to_string(), "2 1 0 0".into(), "3 0 1 0".into(), "4 0 0 1".into(), "5 0 0 -1".into()];
    let mut cells = vec!["1 4 2 1 1 1 2 3 4".to_string(), "2 4 2 1 1 1 3 2 5".into()];
    for (i, height) in flat.iter().enumerate() {
        nodes.push(format!("{} 1 1 {height:e}", 6 + i));
        cells.push(format!("{} 4 2 1 1 1 2 3 {}", 3 + i, 6 + i));
    }
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n{}\n$EndElements\n",
        nodes.len(),
        nodes.join("\n"),
        cells.len(),
        cells.join("\n")
    )
}

fn fitted(folder: &Path, arguments: &[&str]) -> Output {
    let plain = ["fit", "m.msh", "--young", "10kPa", "--poisson", "0.3", "-o", "k.csv"];
    springfit(folder, &[&plain, arguments].concat())
}

#[test]
fn poor_cells_are_told_refused_or_skipped() {
    let folder = TempDir::new().unwrap();
    let place = folder.path();
    fs::write(place.join("m.msh"), mesh(&[1e-7])).unwrap();
    let springs = || fs::read_to_string(place.join("k.csv")).unwrap().lines().count() - 1;
    let output = fitted(place, &[]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{output:?}");
    assert!(
        text.contains("1 cell with a quality below 1e-4, the worst 7.1e-8 (tet4 cell 3 at [0.0, 0.0, 0.0] m)"),
        "{text}"
    );
    let all = springs();
    let output = fitted(place, &["--below", "skip"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("1 cell that is flat, tangled or of poor quality was left out"), "{text}");
    assert!(text.contains("5 points") && !text.contains("belong to no element") && springs() < all, "{text}");
    let errors = [
        (
            ["--below", "refuse"],
            "error: m.msh: quality: … at least 1e-4, found 1 cell … 7.07e-8 of tet4 cell 3 at [0.0, 0.0, 0.0] m\n",
        ),
        (["--below", "drop"], "error: --below: … found \"drop\"\n"),
        (["--least", "2"], "error: --least: … from 0 to 1, found 2.0\n"),
    ];
    for (arguments, error) in errors {
        let output = fitted(place, &arguments);
        assert_eq!(output.status.code(), Some(2));
        reads(&said(&output), error).unwrap();
    }
    // A flat cell is an error, unless it may be skipped.
    fs::write(place.join("m.msh"), mesh(&[0.0, 0.5])).unwrap();
    let output = fitted(place, &[]);
    assert!(said(&output).contains("tet4 cell 3 at [0.0, 0.0, 0.0] m: the element has no volume"));
    let output = fitted(place, &["--below", "skip"]);
    assert!(
        output.status.success() && String::from_utf8_lossy(&output.stdout).contains("6 points, 3 tet4"),
        "{output:?}"
    );
}

/// A quadrilateral of which two nodes are one has a Jacobian at every quadrature point, and a spring of no length.
#[test]
fn a_node_that_is_there_twice_is_told() {
    let folder = TempDir::new().unwrap();
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 2 0 0\n5 2 1 0\n$EndNodes\n\
                $Elements\n2\n1 3 2 1 1 1 2 3 3\n2 3 2 1 1 2 4 5 3\n$EndElements\n";
    fs::write(folder.path().join("m.msh"), text).unwrap();
    let output = fitted(folder.path(), &["--objective", "frobenius"]);
    let error = said(&output);
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("quad4 cell 1 at [0.0, 0.0] m: one of its nodes is there twice"), "{error}");
    assert!(!folder.path().join("k.csv").exists());
    let output = fitted(folder.path(), &["--objective", "frobenius", "--below", "skip"]);
    assert!(output.status.success(), "{output:?}");
    assert!(!fs::read_to_string(folder.path().join("k.csv")).unwrap().contains("NaN"));
}

/// Points that coincide or hang in the middle of an edge are counted once each, whatever else is in the mesh.
#[test]
fn misfits_are_counted() {
    let folder = TempDir::new().unwrap();
    let mesh = |far: f64, extra: &str, cells: &str| {
        let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.5], [2.0, 0.5]];
        let lines = nodes.iter().enumerate().map(|(i, [x, y])| format!("{} {} {} 0", i + 1, x + far, y));
        let lines = lines.chain(extra.lines().map(String::from)).collect::<Vec<_>>();
        let cells: Vec<&str> = cells.lines().collect();
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n{}\n$EndElements\n",
            lines.len(),
            lines.join("\n"),
            cells.len(),
            cells.join("\n")
        )
    };
    let hanging = "1 3 2 1 1 1 2 3 4\n2 3 2 1 1 2 5 8 7\n3 3 2 1 1 7 8 6 3";
    let tiny = "9 0 0 0\n10 -1e-9 0 0\n11 0 -1e-9 0";
    let cases = [
        (mesh(0.0, "", hanging), "1 points lie on edges or faces", true),
        (mesh(1e7, "", hanging), "1 points lie on edges or faces", true),
        (mesh(0.0, tiny, &format!("{hanging}\n4 2 2 1 1 9 11 10")), "1 points lie on edges or faces", true),
        (mesh(0.0, "", "1 3 2 1 1 1 2 3 4\n2 3 2 1 1 2 5 6 3"), "hanging nodes", false),
        (mesh(0.0, tiny, &format!("{hanging}\n4 2 2 1 1 9 11 10")), "1 points coincide with another point", true),
    ];
    for (text, words, told) in cases {
        fs::write(folder.path().join("m.msh"), text).unwrap();
        let output = fitted(folder.path(), &["--objective", "offdiag", "--below", "warn"]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains(words) == told, "{output:?}");
    }
}

#[test]
fn a_scene_names_its_gate() {
    let folder = holding("m.msh", mesh(&[1e-7]));
    let scene = |quality: &str| {
        let text = format!(
            "[mesh]\nfile = \"m.msh\"\n{quality}\n[material]\nyoung = 10e3\npoisson = 0.3\n[[fit]]\nobjective = \"offdiag\"\n"
        );
        fs::write(folder.path().join("s.toml"), text).unwrap();
        springfit(folder.path(), &["run", "s.toml"])
    };
    let output = scene("quality = { below = \"skip\", least = 1e-3 }");
    assert!(String::from_utf8_lossy(&output.stdout).contains("was left out"), "{output:?}");
    let report = fs::read_to_string(folder.path().join("out/s/report.json")).unwrap();
    assert!(report.contains("\"skipped_elements\": 1"), "{report}");
    for (quality, error) in [
        ("quality = { below = \"never\" }", "mesh.quality.below: … found \"never\""),
        ("quality = { least = -1 }", "mesh.quality.least: … from 0 to 1, found -1.0"),
    ] {
        let output = scene(quality);
        assert_eq!(output.status.code(), Some(2));
        reads(&said(&output), &format!("error: s.toml:3: {error}\n")).unwrap();
    }
}
