//! What a comparison says, found again from its raw values by other means.

use crate::kit::{holding, json, prints, refused, said, springfit};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const NORMS: &str = "[compare]\nelements = [\"tet4\", \"hex8\"]\npoisson = [0.1, 0.4]\nshapes = { count = 100, seed = 77 }\ntime = false\n\
                     [[compare.fit]]\nobjective = [\"frobenius\", \"offdiag\", \"spectral\"]\n";

/// The errors of each shape, by element, fit, quantity and Poisson's ratio.
type Raw = BTreeMap<(String, String, String, String), BTreeMap<usize, f64>>;

fn raw(folder: &Path) -> Raw {
    let text = fs::read_to_string(folder.join("values.csv")).unwrap();
    let mut rows = text.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|own| *own == name).unwrap();
    let mut raw = Raw::new();
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let cell = |name: &str| cells[place(name)].to_string();
        if let Ok(shape) = cell("item").parse() {
            let key = (cell("element"), cell("fit"), cell("quantity"), cell("poisson"));
            raw.entry(key).or_default().insert(shape, cell("value").parse().unwrap());
        }
    }
    raw
}

/// The figures of each shape, over Poisson's ratios their geometric mean, by the product and not by logarithms.
fn of_shapes(raw: &Raw, element: &str, fit: &str, quantity: &str) -> Vec<f64> {
    let own: Vec<_> = raw.iter().filter(|((e, f, q, _), _)| (&**e, &**f, &**q) == (element, fit, quantity)).collect();
    assert_eq!(own.len(), 2);
    (1..=100).map(|shape| own.iter().map(|(_, list)| list[&shape]).product::<f64>().sqrt()).collect()
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// The middle of 100 or 200 sorted figures.
fn middle(values: &[f64]) -> f64 {
    f64::midpoint(values[values.len() / 2 - 1], values[values.len() / 2])
}

/// The probability of the signs alone: as many wins or more of either side, if both were as likely.
fn sign_test(wins: usize, count: usize) -> f64 {
    let log = |n: usize| (1..=n).map(|k| (k as f64).ln()).sum::<f64>();
    let share = |k: usize| (log(count) - log(k) - log(count - k) - count as f64 * 2f64.ln()).exp();
    let least = wins.min(count - wins);
    (2.0 * (0..=least).map(share).sum::<f64>()).min(1.0)
}

/// Medians, their intervals, wins, ratios, verdicts and ranks of each error are those of the raw values. The interval of a median is
/// told apart from the bootstrap by order statistics: of 100 figures the 40th and the 61st hold the median in 95 % of samples.
#[test]
fn every_error_has_the_figures_of_its_raw_values() {
    let folder = holding("c.toml", NORMS);
    let printed = prints(folder.path(), &["compare", "c.toml"]);
    let out = folder.path().join("out/compare-c");
    let raw = raw(&out);
    let summary = json(&out.join("summary.json"));
    let fits = ["frobenius", "offdiag", "spectral"];
    for quantity in ["frobenius", "spectral"] {
        for (element, fit) in ["tet4", "hex8"].into_iter().flat_map(|e| fits.map(|f| (e, f))) {
            let all = sorted(of_shapes(&raw, element, fit, quantity));
            let objects = summary["objects"].as_array().unwrap();
            let is_own = |o: &&Value| o["name"] == element && o["fit"] == fit && o["quantity"] == quantity;
            let told = &objects.iter().find(is_own).unwrap()["error"];
            assert!(
                (told["median"].as_f64().unwrap() / middle(&all) - 1.0).abs() < 1e-12,
                "{element} {fit} {quantity}"
            );
            let [low, high] = ["low", "high"].map(|end| told["interval"][end].as_f64().unwrap());
            assert!(
                (all[36]..=all[42]).contains(&low) && (all[57]..=all[63]).contains(&high),
                "{element} {fit} {quantity}"
            );
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let both = [fits[i], fits[j]].map(|fit| {
                ["tet4", "hex8"].into_iter().flat_map(|e| of_shapes(&raw, e, fit, quantity)).collect::<Vec<f64>>()
            });
            let ratios: Vec<f64> = both[0].iter().zip(&both[1]).map(|(a, b)| a / b).collect();
            let wins = ratios.iter().filter(|ratio| **ratio < 1.0 - 1e-9).count();
            let losses = ratios.iter().filter(|ratio| **ratio > 1.0 + 1e-9).count();
            let pairs = summary["pairs"].as_array().unwrap();
            let is_own = |p: &&Value| p["quantity"] == quantity && p["first"] == fits[i] && p["second"] == fits[j];
            let pair = pairs.iter().find(is_own).unwrap();
            assert_eq!((pair["wins"].as_u64(), pair["losses"].as_u64()), (Some(wins as u64), Some(losses as u64)));
            // The middle of an even number of ratios is a geometric mean.
            let ratio = middle(&sorted(ratios.iter().map(|ratio| ratio.ln()).collect())).exp();
            assert!((pair["ratio"].as_f64().unwrap() / ratio - 1.0).abs() < 1e-12);
            // Three pairs: after the correction the probability is at most three times as large, and at least as large. Where nearly all differences
            // have one sign, that test and the one by ranks agree.
            let [p, adjusted] = ["p", "adjusted"].map(|key| pair[key].as_f64().unwrap());
            assert!(p <= adjusted && adjusted <= 3.0 * p.max(1e-300) * (1.0 + 1e-12));
            let signs = sign_test(wins, wins + losses);
            let better = if ratio < 1.0 { "first" } else { "second" };
            if 3.0 * signs < 1e-6 {
                assert_eq!(pair["verdict"], better, "{quantity} {} {}", fits[i], fits[j]);
            }
        }
        // Ranks of medians, over the four cases.
        let middles = |fit: &str| -> Vec<f64> {
            let own = raw.iter().filter(|((_, f, q, _), _)| f == fit && q == quantity);
            own.map(|(_, list)| middle(&sorted(list.values().copied().collect()))).collect()
        };
        let middles = fits.map(middles);
        for (i, fit) in fits.iter().enumerate() {
            let rank = |case: usize| 1 + (0..3).filter(|j| middles[*j][case] < middles[i][case]).count();
            let mean = (0..4).map(rank).sum::<usize>() as f64 / 4.0;
            let ranks = summary["ranks"].as_array().unwrap();
            let told = ranks.iter().find(|r| r["quantity"] == quantity && r["fit"] == *fit).unwrap();
            assert_eq!(told["rank"].as_f64(), Some(mean), "{quantity} {fit}");
        }
    }
    // Each error has its interval in every form of the tables.
    let object = |quantity: &str| {
        let objects = summary["objects"].as_array().unwrap();
        let own = objects.iter().find(|o| o["name"] == "hex8" && o["fit"] == "offdiag" && o["quantity"] == quantity);
        ["low", "high"].map(|end| format!("{:.4}", own.unwrap()["error"]["interval"][end].as_f64().unwrap()))
    };
    for (quantity, table) in [("spectral", "objects.csv"), ("frobenius", "objects-frobenius.csv")] {
        let files =
            [table, "tables.tex", "tables.md", "compare.html"].map(|name| fs::read_to_string(out.join(name)).unwrap());
        for end in object(quantity) {
            assert!(files.iter().chain([&printed]).all(|text| text.contains(&end)), "{quantity} {end}");
        }
    }
    let cases = fs::read_to_string(out.join("comparison.csv")).unwrap();
    assert!(cases.contains("|R-K|/|R| Frobenius: from") && cases.contains("2-norm: to"), "{cases}");
}

const BAR: &str = r#"[mesh]
box = { element = "tri3", size = [2, 1], cells = [6, 3] }
[material]
young = 1000
poisson = 0.3
density = 1000
thickness = 0.01
[[fit]]
objective = "exact"
[[fix]]
group = "xmin"
[[load]]
name = "pull"
group = "xmax"
traction = [1, 0]
"#;

/// A network for an engine is a method of a comparison: its errors are those in the engine, and a simulated second is that of its steps.
#[test]
fn a_network_for_an_engine_is_a_method() {
    let folder = holding("bar.toml", BAR);
    let fit = "[[compare.fit]]\nobjective = \"offdiag\"\nsprings = \"all + volume\"\nnonnegative = true\n";
    let engine =
        "name = \"moved\"\nengine = [{ method = \"xpbd\", substeps = 40 }, { method = \"xpbd\", substeps = 400 }]\n";
    let text = format!("[compare]\nscenes = [\"bar.toml\"]\n{fit}{fit}{engine}");
    fs::write(folder.path().join("c.toml"), &text).unwrap();
    prints(folder.path(), &["compare", "c.toml"]);
    let out = folder.path().join("out/compare-c");
    let summary = json(&out.join("summary.json"));
    let methods = summary["cases"][0]["methods"].as_array().unwrap();
    assert_eq!(methods.len(), 4);
    let second = |place: usize| methods[place]["times"]["simulated-second"]["median"].as_f64().unwrap();
    assert!(second(2) > 5.0 * second(1) && second(0) > 0.0 && second(3) > 0.0, "{methods:?}");
    let figure = fs::read_to_string(out.join("precision-simulated-second.svg")).unwrap();
    assert!(figure.contains("processor time of a simulated second, s"), "{figure}");
    let drawn = prints(folder.path(), &["plot", "out/compare-c", "--figure", "work-precision", "--cost", "second"]);
    assert!(drawn.starts_with("<svg"));
    // What is wrong with a fit is said of the file that has it, not of the scene.
    fs::write(folder.path().join("bar.toml"), BAR.replace("young = 1000", "young = 1e12")).unwrap();
    let said = refused(folder.path(), &["compare", "c.toml", "--out", "other"]);
    assert!(said.contains("c.toml:") && said.contains("compare.fit[1].engine.substeps"), "{said}");
}

/// A learning curve is one command: a curve for each family of fits that differ in the number of shapes alone, named by the rest.
#[test]
fn learning_curves_are_named_by_what_they_share() {
    let folder = TempDir::new().unwrap();
    let shapes =
        "shapes = { families = [[\"uniaxial\"], [\"uniaxial\", \"simple-shear\"]], count = [4, 40], held_out = 20 }";
    let fit = format!("[[compare.fit]]\nobjective = \"sampled\"\n{shapes}\n");
    let text = format!("[compare]\nelements = [\"tet4\"]\nlaws = [\"neo-hookean\"]\ntime = false\n{fit}");
    fs::write(folder.path().join("c.toml"), text).unwrap();
    prints(folder.path(), &["compare", "c.toml"]);
    let drawn = prints(folder.path(), &["plot", "out/compare-c", "--figure", "samples", "--columns", "two"]);
    let names: Vec<&str> = drawn.lines().filter(|line| line.starts_with("sampled")).collect();
    assert_eq!(names, ["sampled, families uniaxial", "sampled, families uniaxial + simple-shear"], "{drawn}");
}

/// A comparison that finds nothing is no success: a sampler whose shapes are flat or inverted is one line.
#[test]
fn shapes_that_are_flat_or_inverted_are_one_line() {
    let folder = TempDir::new().unwrap();
    for (last, content) in [("0", "0.0000"), ("-1", "-1.0000")] {
        let shapes = format!("shapes = {{ gradients = [[[1, 0, 0], [0, 1, 0], [0, 0, {last}]]] }}");
        let text = format!(
            "[compare]\nelements = [\"tet4\"]\nlaws = [\"neo-hookean\"]\n[[compare.fit]]\nobjective = \"sampled\"\n{shapes}\n"
        );
        fs::write(folder.path().join("c.toml"), text).unwrap();
        let output = springfit(folder.path(), &["compare", "c.toml", "--out", &format!("out{last}")]);
        let said = said(&output);
        let words = "sampled: shapes.gradients[0]: expected a shape that is neither flat nor inverted";
        assert!(output.status.code() == Some(2) && said.contains(words) && said.contains(content), "{said}");
        assert_eq!(said.lines().filter(|line| line.starts_with("error")).count(), 1, "{said}");
    }
}
