//! `[compare]` and `springfit compare`: which cases and fits there are, what files say of them, and what is refused.

use crate::kit::{self, holding, json, prints, said, springfit};
use crate::messages::reads;
use crate::shapes::loaded;
use serde_json::json;
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, element_errors, fit_cells};
use springfit_studies::study::{CaseRecord, Comparing, random_shapes};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const PULLED: &str = "[mesh]\nbox = { element = \"tri3\", size = [1, 1], cells = [3, 3] }\n[material]\nyoung = 1e4\npoisson = 0.3\n\
    [[fix]]\ngroup = \"ymin\"\n[[load]]\nname = \"pull\"\ngroup = \"ymax\"\ntraction = [0, 100]\n[[fit]]\nobjective = \"exact\"\n";

const NORMS: &str = r#"title = "Norms"
[compare]
elements = ["tri3", "quad4"]
poisson = [0.0, 0.4]
shapes = { count = 6, distortion = [0.05, 0.2] }
[[compare.fit]]
objective = ["frobenius", "spectral"]
springs = ["default", "all + volume"]
[[compare.fit]]
objective = "spectral"
nonnegative = [true]
"#;

fn comparing(text: &str) -> springfit_foundation::error::Result<Comparing> {
    Comparing::parse(text, Path::new("c.toml"))
}

fn folder_with(text: &str) -> TempDir {
    holding("c.toml", text)
}

fn cases(folder: &Path) -> Vec<CaseRecord> {
    let text = fs::read_to_string(folder.join("cases.jsonl")).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn cases_are_all_combinations_and_fits_too() {
    let found = comparing(NORMS).unwrap();
    assert_eq!(found.cases().len(), 2 * 2 * 2);
    let known = json!({ "element": "tri3", "plane": "stress", "poisson": 0.0, "family": "random", "distortion": 0.2, "aspect": 1.0,
        "seed": 2010, "count": 6 });
    assert_eq!(serde_json::to_value(&found.cases()[1].settings).unwrap(), known);
    let names = ["frobenius", "frobenius all + volume", "spectral", "spectral all + volume", "spectral k>=0"];
    assert_eq!(found.fit_names(), names);
    // A list of lists is a list of values of a key whose value is a list.
    let grouped = NORMS.replace("[\"default\", \"all + volume\"]", "[[\"edge\"], [\"edge\", \"bulk\"]]");
    let found = comparing(&grouped).unwrap();
    assert_eq!(found.fit_names()[..2], ["frobenius +edge", "frobenius +edge +bulk"]);
    // Fits that their settings do not tell apart by name are told apart by the keys that vary.
    let laws = "[compare]\nelements = [\"tri3\"]\nlaws = [\"neo-hookean\"]\nplane = \"strain\"\n[[compare.fit]]\nobjective = \"sampled\"\n\
                shapes = { count = [10, 20] }\nname = \"mine\"\n";
    assert_eq!(comparing(laws).unwrap().fit_names(), ["mine, count 10", "mine, count 20"]);
    // What the name tells already is not told again.
    let forces = laws.replace("name = \"mine\"", "force = [\"linear\", \"free-rest\"]");
    let names =
        ["sampled, count 10", "sampled, count 20", "sampled free rest, count 10", "sampled free rest, count 20"];
    let found = comparing(&forces).unwrap();
    let mut found = found.fit_names();
    found.sort_unstable_by_key(|name| name.contains("free"));
    assert_eq!(found, names);
    // Separate entries of one name have the keys in which they differ in their names and as columns. An entry without these keys keeps the plain
    // name.
    let norms = laws.replace("shapes = { count = [10, 20] }\nname = \"mine\"\n", "");
    let other = "[[compare.fit]]\nobjective = \"sampled\"\nnorm = \"1\"\nweight = \"none\"\n";
    let found = comparing(&format!("{norms}{other}{}", other.replace("\"1\"", "\"max\""))).unwrap();
    assert_eq!(found.fit_names(), ["sampled", "sampled, norm 1, weight none", "sampled, norm max, weight none"]);
    // The same fit twice is a mistake, and so is a name that two entries have.
    for twice in [format!("{norms}{other}{other}"), format!("{laws}{other}name = \"mine, count 10\"\n")] {
        let error = comparing(&twice).unwrap_err().to_string();
        assert!(error.contains("name") && error.contains("fit["), "{error}");
    }
}

/// The values of a case are those that the library finds for the same shapes, to the bit; and every pass has a time.
#[test]
fn values_are_those_of_the_fit() {
    let found = comparing(
        "[compare]\nelements = [\"tet4\"]\nshapes = { count = 8 }\n[[compare.fit]]\nobjective = \"offdiag\"\n",
    )
    .unwrap();
    let record = found.record(&found.cases()[0], &mut |_| {});
    let method = &record.methods[0];
    let element = loaded("tet4");
    let (points, cells) = (random_shapes(&element, 8, 2010).unwrap(), (0..32).collect::<Vec<usize>>());
    let material = Material::for_body(3, 1e4, 0.3, None, None).unwrap();
    let springs = Springs::select(&element, None).unwrap();
    let fit = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
    let fits = fit_cells(&element, &springs, &points, &cells, material.moduli(), &fit, &mut |_| {}).unwrap();
    let errors = element_errors(&element, &points, &cells, material.moduli(), &fits).unwrap();
    for (name, known) in [("frobenius", &errors.frobenius), ("spectral", &errors.spectral)] {
        let own: Vec<f64> = method.values[name].iter().map(|value| value.unwrap()).collect();
        assert_eq!(&own, known, "{name}");
    }
    let negative: f64 = method.values["negative"].iter().map(|count| count.unwrap()).sum();
    assert_eq!(negative, fits.constants.iter().filter(|k| **k < 0.0).count() as f64);
    assert!(method.fitted == 8 && method.copied == 0 && method.times["fit"].iter().all(|seconds| *seconds > 0.0));
}

/// Undistorted shapes of a regular cell are all alike, and an aspect makes them longer; every error is that of one shape.
#[test]
fn families_of_shapes_are_what_they_say() {
    let text = "[compare]\nelements = [\"quad4\"]\ntime = false\nshapes = { family = \"distorted\", distortion = 0, aspect = [1, 10], count = 3 }\n\
                [[compare.fit]]\nobjective = \"frobenius\"\n";
    let found = comparing(text).unwrap();
    let errors: Vec<Vec<f64>> = found
        .cases()
        .iter()
        .map(|case| {
            let record = found.record(case, &mut |_| {});
            assert!(record.methods[0].times.is_empty());
            record.methods[0].values["frobenius"].iter().map(|value| value.unwrap()).collect()
        })
        .collect();
    assert!(errors.iter().all(|list| list.windows(2).all(|pair| pair[0] == pair[1])));
    assert!(errors[1][0] > 1.2 * errors[0][0], "{errors:?}");
}

/// All files of a comparison, read back: the long table has each value with all digits, and the figures name each fit.
#[test]
fn a_file_has_its_files_and_goes_on() {
    let folder = folder_with(NORMS);
    let printed = prints(folder.path(), &["compare", "c.toml"]);
    assert!(printed.starts_with("Norms\n") && printed.contains("Mean ranks over the cases"), "{printed}");
    let out = folder.path().join("out/compare-c");
    let records = cases(&out);
    assert_eq!(records.len(), 8);
    let values = fs::read_to_string(out.join("values.csv")).unwrap();
    let header: Vec<&str> = values.lines().next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|own| *own == name).unwrap();
    let rows: Vec<Vec<&str>> = values.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let count: usize = records
        .iter()
        .flat_map(|record| &record.methods)
        .map(|m| m.values.len() * m.items.len() + m.figures.len() + m.times.values().map(Vec::len).sum::<usize>())
        .sum();
    assert_eq!(rows.len(), count);
    let known = records[3].methods[2].values["spectral"][4].unwrap();
    let row = rows.iter().find(|row| {
        let is = |name: &str, value: &str| row[place(name)] == value;
        is("case", "4.0") && is("fit", "spectral") && is("item", "5") && is("quantity", "spectral")
    });
    assert_eq!(row.unwrap()[place("value")].parse::<f64>().unwrap(), known);
    assert_eq!(&fs::read(out.join("values.parquet")).unwrap()[..4], b"PAR1");
    for name in ["precision.svg", "ecdf.svg", "poisson.svg", "distortion.svg", "norms.svg", "compare.html"] {
        let text = fs::read_to_string(out.join(name)).unwrap();
        assert!(text.contains("spectral all + volume"), "{name}");
    }
    let latex = fs::read_to_string(out.join("tables.tex")).unwrap();
    assert!(latex.contains("\\multicolumn{3}{c}{tri3}") && latex.contains("\\cmidrule") && latex.contains("\\textbf{"));
    let summary = json(&out.join("summary.json"));
    let pair = |first: &str, second: &str, quantity: &str| {
        let pairs = summary["pairs"].as_array().unwrap().clone();
        pairs.into_iter().find(|p| p["first"] == first && p["second"] == second && p["quantity"] == quantity).unwrap()
    };
    // The certified optimum of the 2-norm has no larger error in it than any other choice of the same springs.
    assert_eq!(pair("frobenius", "spectral", "spectral")["wins"], 0);
    assert_eq!(pair("frobenius", "spectral", "spectral")["verdict"], "second");
    assert_eq!(pair("frobenius", "spectral", "frobenius")["losses"], 0);
    assert_eq!(pair("spectral", "spectral k>=0", "spectral")["losses"], 0);
    // A comparison goes on with what is there, and with more cases; and not with that of another file.
    let more = NORMS.replace("[0.0, 0.4]", "[0.0, 0.3, 0.4]");
    fs::write(folder.path().join("c.toml"), &more).unwrap();
    prints(folder.path(), &["compare", "c.toml", "--resume"]);
    let now = cases(&out);
    assert_eq!(now.len(), 12);
    assert!(records.iter().all(|record| now.contains(record)));
    // With fewer cases the others stay in the file, and no figure has them.
    fs::write(folder.path().join("c.toml"), more.replace("elements = [\"tri3\", \"quad4\"]", "elements = [\"tri3\"]"))
        .unwrap();
    prints(folder.path(), &["compare", "c.toml", "--resume"]);
    assert_eq!(cases(&out).len(), 12);
    let output = springfit(folder.path(), &["plot", "out/compare-c", "--figure", "ecdf", "--of", "quad4"]);
    let refusal = said(&output);
    assert!(refusal.contains("--of: expected an element or a scene of the comparison: tri3, found"), "{refusal}");
    fs::write(folder.path().join("c.toml"), &more).unwrap();
    prints(folder.path(), &["compare", "c.toml", "--resume"]);
    fs::write(folder.path().join("c.toml"), more.replace("nonnegative = [true]", "tied = [true]")).unwrap();
    for (arguments, words) in [
        (
            &["compare", "c.toml", "--resume"][..],
            "cases.jsonl:1: expected a study of this file and those that it names",
        ),
        (&["compare", "c.toml"], "expected a file without studies, found 12: --resume goes on from them"),
    ] {
        let said = kit::refused(folder.path(), arguments);
        assert!(said.contains(words), "{said}");
    }
    assert_eq!(cases(&out), now);
    for (figure, of) in [("ecdf", Some("tri3")), ("work-precision", None), ("poisson", None), ("norms", Some("quad4"))]
    {
        let of: Vec<&str> = of.map_or(Vec::new(), |of| vec!["--of", of]);
        let arguments = [&["plot", "out/compare-c", "--figure", figure][..], &of].concat();
        assert!(prints(folder.path(), &arguments).starts_with("<svg"), "{figure}");
    }
}

/// Several jobs and one job have the same values.
#[test]
fn jobs_have_the_same_values() {
    let folder = folder_with(NORMS);
    prints(folder.path(), &["compare", "c.toml", "--jobs", "3", "--out", "many"]);
    prints(folder.path(), &["compare", "c.toml", "--out", "one"]);
    let values = |name: &str| {
        let mut records = cases(&folder.path().join(name));
        records.sort_by_key(|record| serde_json::to_string(&record.settings).unwrap());
        let methods = records.into_iter().flat_map(|record| record.methods);
        methods.map(|method| (method.fit, method.values, method.figures)).collect::<Vec<_>>()
    };
    assert_eq!(values("many"), values("one"));
}

/// The options of the command are the keys of the file.
#[test]
fn options_are_keys() {
    let folder = folder_with(NORMS);
    let fits = [
        "objective = ['frobenius', 'spectral'], springs = ['default', 'all + volume']",
        "objective = 'spectral', nonnegative = true",
    ];
    let arguments = [
        "compare",
        "tri3",
        "quad4",
        "--poisson",
        "0,0.4",
        "--shapes",
        "6",
        "--distortion",
        "0.05,0.2",
        "--out",
        "flags",
    ];
    prints(folder.path(), &[&arguments[..], &["--fit", fits[0], "--fit", fits[1]]].concat());
    prints(folder.path(), &["compare", "c.toml", "--out", "file"]);
    let found = ["flags", "file"].map(|name| {
        let records = cases(&folder.path().join(name));
        let values = |record: CaseRecord| {
            (record.settings, record.methods.into_iter().map(|m| (m.fit, m.values)).collect::<Vec<_>>())
        };
        records.into_iter().map(values).collect::<Vec<_>>()
    });
    assert_eq!(found[0], found[1]);
    // Again without --resume: a comparison by options is made anew.
    prints(folder.path(), &["compare", "tri3", "--shapes", "2", "--fit", "objective = 'offdiag'"]);
    prints(folder.path(), &["compare", "tri3", "--shapes", "3", "--fit", "objective = 'offdiag'"]);
    assert_eq!(cases(&folder.path().join("out/compare-tri3"))[0].methods[0].items.len(), 3);
    let planned = prints(folder.path(), &["compare", "c.toml", "--explain"]);
    assert!(planned.contains("8 cases") && planned.contains("spectral all + volume"), "{planned}");
}

/// Scenes have the errors of their loads, the finite elements among the models, and the costs of all; a box the errors by its stretch.
#[test]
fn scenes_and_laws_are_cases() {
    let folder = folder_with(
        "[compare]\nelements = [\"tri3\"]\nlaws = [\"neo-hookean\"]\nplane = \"strain\"\nscenes = [\"s.toml\"]\n\
         [[compare.fit]]\nobjective = [\"frobenius\", \"offdiag\"]\nnonnegative = true\n",
    );
    fs::write(folder.path().join("s.toml"), PULLED).unwrap();
    prints(folder.path(), &["compare", "c.toml"]);
    let found = cases(&folder.path().join("out/compare-c"));
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|case| case.error.is_none()), "{found:?}");
    let pulled = &found[0].methods[0];
    assert_eq!(pulled.items.first().unwrap(), "0.01");
    assert!(pulled.values["e_rms"].iter().all(Option::is_some));
    let scene = &found[1];
    let names: Vec<&str> = scene.methods.iter().map(|method| method.fit.as_str()).collect();
    assert_eq!(names, ["frobenius k>=0", "offdiag k>=0", "finite elements"]);
    assert_eq!(scene.methods[0].items, ["pull"]);
    let kinds: Vec<&str> = scene.methods[0].times.keys().map(String::as_str).collect();
    assert_eq!(kinds, ["assembly", "explicit-step", "fit", "implicit-step", "solve"]);
    assert!(scene.methods[2].times.contains_key("solve"));
    let svg = prints(folder.path(), &["plot", "out/compare-c", "--figure", "work-precision", "--cost", "solve"]);
    assert!(svg.starts_with("<svg"));
}

/// A setting is that of the scene; one pair of figures is too few to tell; and a key of one value has no figure.
#[test]
fn settings_few_pairs_and_single_values_are_told() {
    let folder = folder_with(NORMS);
    fs::write(folder.path().join("s.toml"), PULLED).unwrap();
    let fits = ["--fit", "objective = ['frobenius', 'offdiag']"];
    let errors = |poisson: &str| {
        let set = format!("material.poisson={poisson}");
        let out = format!("o{poisson}");
        prints(folder.path(), &[&["compare", "s.toml", "--set", &set, "--out", &out][..], &fits].concat());
        cases(&folder.path().join(out))[0].methods[0].values["e_rms"].clone()
    };
    assert_ne!(errors("0.1"), errors("0.4"));
    let pairs = fs::read_to_string(folder.path().join("o0.1/pairs.csv")).unwrap();
    assert!(pairs.lines().any(|line| line.starts_with("e_rms,") && line.ends_with(",too few pairs")), "{pairs}");
    for (figure, words) in [
        ("poisson", "expected cases with several values of poisson, found one"),
        ("norms", "has no errors in both norms"),
        ("samples", "has no fits with several numbers of shapes"),
    ] {
        let said = kit::refused(folder.path(), &["plot", "o0.1", "--figure", figure]);
        assert!(said.contains(words), "{said}");
    }
}

/// A published formula that has none for an element has no figures there, and the reason.
#[test]
fn what_does_not_serve_a_case_says_why() {
    let text = "[compare]\nelements = [\"tri3\", \"quad9\"]\nshapes = { count = 2 }\n[[compare.fit]]\nobjective = [\"delingette-quadratic\", \"frobenius\"]\n";
    let found = comparing(text).unwrap();
    let records: Vec<CaseRecord> = found.cases().iter().map(|case| found.record(case, &mut |_| {})).collect();
    assert!(records[0].methods[0].refused.is_none() && !records[0].methods[0].items.is_empty());
    let refused = records[1].methods[0].refused.as_ref().unwrap();
    assert!(refused.contains("expected"), "{refused}");
    assert!(records[1].methods[0].items.is_empty() && records[1].methods[1].refused.is_none());
}

#[test]
fn wrong_comparisons_are_refused() {
    let wrong = |from: &str, to: &str| comparing(&NORMS.replace(from, to)).unwrap_err().to_string();
    for (from, to, words) in [
        (
            "[\"tri3\", \"quad4\"]",
            "[]",
            "c.toml:3: compare.elements: expected elements or \"scenes\" to compare on, found none",
        ),
        ("\"quad4\"", "\"quad5\"", "compare.elements[1]: "),
        ("[0.0, 0.4]", "[]", "c.toml:4: compare.poisson: expected at least one value, found an empty list"),
        ("[0.0, 0.4]", "[0.7]", "compare.poisson: "),
        ("[0.0, 0.4]", "\"high\"", "compare.poisson: expected a number, or a list of numbers, found string"),
        ("[0.05, 0.2]", "2", "compare.shapes.distortion: expected numbers from 0 to 1, found 2"),
        ("count = 6", "count = 0", "compare.shapes.count: "),
        ("count = 6", "size = 6", "compare.shapes.size: unknown field \"size\", expected one of \"family\""),
        ("count = 6", "count = 6, family = \"odd\"", "compare.shapes.family: expected one of random, distorted"),
        ("\"quad4\"", "\"tri3\"", "expected each case once"),
        (
            "[\"frobenius\", \"spectral\"]",
            "[]",
            "compare.fit[0].objective: expected at least one value, found an empty list",
        ),
        ("[\"frobenius\", \"spectral\"]", "[\"frobenius\", \"spectrum\"]", "compare.fit[0].objective: expected one of"),
        (
            "[\"default\", \"all + volume\"]",
            "[[\"edge\"], [\"diagonal\"]]",
            "compare.fit[0].springs: expected groups of tri3",
        ),
        ("objective = \"spectral\"\n", "objective = \"whole\"\n", "compare.fit[1]"),
        ("nonnegative = [true]", "negative = [true]", "compare.fit[1].negative: unknown field"),
        ("shapes = {", "iterations = 0\nshapes = {", "compare.iterations: "),
        ("shapes = {", "laws = [\"neo-hookean\"]\nshapes = {", "compare.shapes: belongs to a comparison without laws"),
        ("shapes = {", "stretch = 0.2\nshapes = {", "compare.stretch: belongs to a comparison with laws"),
        ("shapes = {", "scenes = [\"nowhere.toml\"]\nshapes = {", "nowhere.toml"),
        (
            "shapes = {",
            "scenes = [\"\"]\nshapes = {",
            "c.toml:5: compare.scenes[0]: expected the path of a file, found \"\"",
        ),
        ("\"quad4\"", "\"own.toml\"", "c.toml:3: compare.elements[1]: expected the path of a file, found \"own.toml\""),
        (
            "count = 6, distortion = [0.05, 0.2]",
            "count = [1, 2], seed = [1], aspect = [1.0, 2.0, 2.0]",
            "expected each case once",
        ),
        ("title = \"Norms\"", "titel = \"Norms\"", "unknown field \"titel\""),
    ] {
        let found = wrong(from, to);
        assert!(found.contains(words) && !found.contains('\n'), "{to}: {found}");
    }
    // A grid that is too large is refused before it is made.
    let many = (0..1000).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    let grid = format!(
        "shapes = {{ count = 1, seed = [{many}], aspect = [{}] }}",
        (1..1000).map(|i| i.to_string()).collect::<Vec<_>>().join(", ")
    );
    let found = wrong("shapes = { count = 6, distortion = [0.05, 0.2] }", &grid);
    assert!(found.contains("compare.shapes: expected at most 100000 sets of shapes, found 999000"), "{found}");
    let law = "[compare]\nelements = [\"tri3\"]\nlaws = [\"hookean\"]\n";
    let found = comparing(law).unwrap_err().to_string();
    reads(&found, "c.toml:3: compare.laws[0]: expected one of…").unwrap();
    let bars =
        "[compare]\nelements = [\"bar2\"]\n[[compare.fit]]\nobjective = \"frobenius\"\nsprings = \"all + volume\"\n";
    let without_content =
        "compare.fit[0].springs: expected \"default\" or \"all\", for bar2 has no springs on its content";
    reads(&comparing(bars).unwrap_err().to_string(), &format!("…{without_content}…")).unwrap();
    let folder = folder_with(NORMS);
    for (arguments, words) in [
        (&["compare", "c.toml", "--poisson", "0.3"][..], "--poisson: belongs to an element"),
        (
            &["compare", "c.toml", "--set", "compare.poisson=0.3"],
            "--set: belongs to a scene, found compare.poisson=0.3 with a file",
        ),
        (&["compare", "c.toml", "tri3"], "found \"tri3\" beside a file with [compare]"),
        (&["compare", "tri3", "--resume"], "--resume: belongs to a file with [compare]"),
        (&["compare", "tri3", "--jobs", "0"], "--jobs: expected a number from 1 to 1024, found 0"),
        (&["compare", "tri3", "--fit", "objective"], "--fit: expected keys such as"),
        (&["compare", "tri3", "--fit", "objective = 'sampled'"], "--fit[0]: expected a fit of single elements"),
        (&["compare", "tri3", "--aspect", "0"], "--aspect: expected numbers from 0.001 to 1000, found 0"),
        (&["plot", "out/compare-x", "--figure", "ecdf"], "cases.jsonl"),
    ] {
        let said = kit::refused(folder.path(), arguments);
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}
