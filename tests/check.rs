//! Every shipped element and example passes its proof; files that are wrong in one way fail in that one.

use crate::kit::{place, springfit};
use springfit_element::element::Element;
use springfit_studies::study::{Mark, inspect};

fn folder(name: &str) -> Vec<String> {
    let folder = place(name);
    springfit_foundation::file::files_in(&folder, "toml")
        .unwrap()
        .iter()
        .map(|file| file.display().to_string())
        .collect()
}

/// A new file is tested by being there.
#[test]
fn all_elements_pass() {
    let files = [folder("elements"), folder("examples/elements")].concat();
    assert!(files.len() >= 23);
    for file in files {
        let inspection = inspect(&file, Element::load(&file));
        for property in &inspection.properties {
            assert!(property.mark != Mark::Fails, "{file}: {}: {}", property.name, property.finding);
        }
        assert!(inspection.properties.len() > 10, "{file}");
    }
}

/// Elements of one dimension with many nodes, whose springs are more than the equations of their nodes, are fitted as those of the plane are.
#[test]
fn rods_of_many_nodes_pass() {
    for count in [4, 5, 6_i32] {
        let (last, at) = (count - 1, |i: i32| 2 * i - (count - 1));
        let node = |i: i32| {
            let others = (0..count).filter(|j| *j != i);
            let shape: Vec<String> =
                others.map(|j| format!("(s - ({}/{last}))*({last}/({}))", at(j), at(i) - at(j))).collect();
            format!("    {{ at = [\"{}/{last}\"], shape = \"{}\" }},\n", at(i), shape.join("*"))
        };
        // Ends come first.
        let order = [0, count - 1].into_iter().chain(1..count - 1);
        let text = format!(
            "name = \"bar\"\ntitle = \"Bar\"\ncell = \"interval\"\ncoordinates = [\"s\"]\nnodes = [\n{}]\n[quadrature]\nrule = \"gauss-legendre\"\npoints = {count}\n\
             [[springs]]\ngroup = \"all\"\nkind = \"length\"\nnodes = \"complete\"\n",
            order.map(node).collect::<String>()
        );
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bar.toml");
        std::fs::write(&file, text).unwrap();
        let file = file.to_str().unwrap();
        let inspection = inspect(file, Element::load(file));
        for property in &inspection.properties {
            assert!(property.mark != Mark::Fails, "{count}: {}: {}", property.name, property.finding);
        }
        assert!(inspection.properties.len() > 10, "{count}");
    }
}

/// What fails in each file of `tests/wrong`.
const WRONG: [(&str, &str, &str); 19] = [
    (
        "centroid",
        "loads",
        "quadrature.points: expected a rule whose integrals of the coordinates are [0.041666666666666664, 0.041666666666666664, \
         0.041666666666666664], found [0.016666666666666666, 0.03333333333333333, 0.049999999999999996]",
    ),
    (
        "completeness",
        "loads",
        "nodes: expected shape functions that reproduce xi, found xi -1.769e-1 at [0.340, 0.861]",
    ),
    ("corners", "Gmsh order", "corners come as [1, 0, 2, 3], which goes back and forth in the cell"),
    ("expression", "loads", "nodes[0].shape: column 9: expected an operator, found '(' in \"(1 - xi)(1 - eta)/4\""),
    ("gmsh", "Gmsh order", "type 5: line 14: $Elements: expected 1 elements, found 0"),
    ("group", "loads", "springs[2].group: expected a name used once, found \"edge\" again"),
    (
        "key",
        "loads",
        "titel: unknown field \"titel\", expected one of \"name\", \"title\", \"cell\", \"coordinates\", \"source\", \"let\", \
         \"nodes\", \"quadrature\", \"volumetric_quadrature\", \"springs\", \"formats\"; did you mean \"title\"?",
    ),
    ("kronecker", "loads", "nodes[1].shape: is 2 at nodes[1], expected 1"),
    ("mechanism", "rank of the springs", "4 of 5, 1 mechanisms"),
    ("negative", "quadrature rule", "0 points outside the cell, 1 negative weights"),
    ("order", "loads", "formats.vtk.order: expected each of 0 to 3 once, found [0, 0, 2, 3]"),
    ("outside", "loads", "quadrature.points[4]: expected a point in the cell, found [1.1, 0.0]"),
    ("patch", "patch test", "uniform stress against tractions of sides, defect"),
    ("singular", "loads", "nodes[0].shape: is NaN at nodes[0], expected 1"),
    ("spring", "loads", "springs[0].nodes[0]: expected two different nodes below 4, found [0, 4]"),
    ("spurious", "rank of R", "3 of 5, 2 spurious modes"),
    ("toml", "loads", "expected TOML: unclosed table, expected \"]\""),
    ("unity", "loads", "nodes: expected shape functions that sum to 1, found 1 +7.822e-1 at [-0.340, -0.340]"),
    ("weights", "loads", "quadrature.weights: expected weights that sum to the cell's content 4, found 3"),
];

#[test]
fn wrong_files_fail_in_what_is_wrong() {
    let files = folder("tests/wrong");
    assert_eq!(files.len(), WRONG.len());
    for (file, (name, property, finding)) in files.iter().zip(WRONG) {
        assert!(file.ends_with(&format!("{name}.toml")), "{file} {name}");
        let inspection = inspect(file, Element::load(file));
        let failed: Vec<_> = inspection.properties.iter().filter(|p| p.mark == Mark::Fails).collect();
        // A rule that is not exact shows in more than one way.
        assert!(failed.len() == 1 || name == "patch", "{name}: {failed:?}");
        assert_eq!(failed[0].name, property, "{name}");
        // Without the place of a fault of the file.
        let found = match failed[0].finding.strip_prefix(file.as_str()) {
            Some(fault) => fault.trim_start_matches(|c: char| c == ':' || c.is_ascii_digit()).trim_start(),
            None => &failed[0].finding,
        };
        assert!(found == finding || name == "patch" && found.starts_with(finding), "{name}: {found}");
    }
}

fn check(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = springfit(&place(""), &[&["check"], arguments].concat());
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_tells_by_its_exit_code() {
    let (code, text, _) = check(&["quad4", "elements/tri6.toml"]);
    assert_eq!(code, Some(0));
    assert!(text.ends_with("2 of 2 files pass\n") && text.contains("  ok    rank of R "), "{text}");
    let (code, text, _) = check(&["tests/wrong"]);
    assert_eq!(code, Some(1));
    assert!(text.ends_with("0 of 19 files pass\n"), "{text}");
    let (code, text, _) = check(&["--json", "tests/wrong/spurious.toml"]);
    assert_eq!(code, Some(1));
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let properties = value[0]["properties"].as_array().unwrap();
    let rank = properties.iter().find(|p| p["property"] == "rank of R").unwrap();
    assert_eq!((rank["mark"].as_str(), rank["value"].as_f64()), (Some("FAIL"), Some(2.0)));
    for (what, problem) in [("tests/wrong/none.toml", "cannot be read: "), ("src", "expected element files ")] {
        let (code, printed, error) = check(&[what]);
        assert_eq!((code, printed.as_str(), error.lines().count()), (Some(2), "", 1));
        assert!(error.starts_with(&format!("error: {what}: {problem}")), "{error}");
    }
}
