//! The experiments of the paper, run again by one command, and the published methods and gauges that they need of scenes.

use crate::kit::place;
use crate::messages::reads;
use springfit_foundation::error::Error;
use springfit_report::report;
use springfit_studies::study::{Event, GaugeResult, Index, Paper, PaperRow, Scene, compare_scene, run, run_paper};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn root() -> PathBuf {
    place("scenes/paper")
}

fn quiet(_: Event) {}

/// A folder with a scene of this text.
fn written(text: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).unwrap();
    (folder, path)
}

fn of_table(name: &str) -> Paper {
    let path = root().join("index.toml");
    run_paper(&Index::load(&path).unwrap(), &[name.into()], &path, &mut quiet).unwrap()
}

fn row<'a>(paper: &'a Paper, object: &str, fit: &str) -> &'a PaperRow {
    let rows = paper.tables.iter().flat_map(|table| &table.rows);
    rows.clone().find(|row| row.object.starts_with(object) && row.fit == fit).unwrap()
}

/// Every scene of the paper loads, has the load of its table, and a fit for each printed figure.
#[test]
fn every_printed_figure_has_a_fit() {
    let index = Index::load(&root().join("index.toml")).unwrap();
    let mut figures = 0;
    for table in &index.table {
        for row in &table.row {
            let Some(file) = &row.scene else { continue };
            let scene = Scene::load(&root().join(file)).unwrap();
            if let Some(load) = &table.load {
                assert!(scene.loads().iter().any(|l| l.name == *load), "{}: {load}", file.display());
            }
            for fit in row.printed.keys() {
                assert!(scene.fits().iter().any(|f| f.name == *fit), "{}: {fit}", file.display());
                figures += 1;
            }
        }
    }
    // 14 of table 1, 4 of table 3, 8 of table 4, 10 of table 5, 10 of table 6, one of section 3.5.
    assert_eq!(figures, 47);
}

/// The square of figure 9: E follows what is asked for, ν does not, and with a spring on the area it does.
#[test]
fn the_moduli_of_a_square_follow_only_with_an_area_spring() {
    let paper = of_table("figure 9");
    let surfaces = &paper.tables[0].surfaces;
    assert_eq!(surfaces.len(), 4);
    for surface in surfaces {
        let n = surface.poisson.len();
        let at = |i: usize, j: usize| surface.found[i * n + j].unwrap();
        // Twice the modulus asked for is twice that found.
        for i in 0..surface.young.len() {
            for j in 0..n {
                let [e, nu] = at(i, j);
                let [first, same] = at(0, j);
                assert!((e / surface.young[i] - first / surface.young[0]).abs() < 1e-9 && (nu - same).abs() < 1e-9);
            }
        }
        let [_, soft] = at(0, 0);
        let [_, stiff] = at(0, n - 1);
        println!("{}: nu from {soft:.3} to {stiff:.3}", surface.fit);
        let follows = soft.abs() < 0.02 && (stiff - 0.5).abs() < 0.02;
        assert_eq!(follows, surface.fit == "modal + area", "{}: {soft} {stiff}", surface.fit);
    }
}

/// A uniform bar, free to contract: the gauge of the finite elements measures the material, that of the networks their own.
#[test]
fn a_gauge_measures_the_material() {
    let bar = |mesh: &str, material: &str, fix: &str, fits: &str| {
        format!(
            "[mesh]\nbox = {mesh}\n[material]\nyoung = 2e4\npoisson = 0.3\n{material}\n{fits}\n{fix}\n[[load]]\nname = \"pull\"\n\
             group = \"xmax\"\ntraction = [500{}]\n[[load]]\nname = \"aside\"\ngroup = \"xmax\"\ntraction = [0, 1{}]\n\
             [[load]]\nname = \"gravity\"\nbody = [1, 0{}]\n[gauge]\nwhere = \"x > 0.9 && x < 2.1\"\naxis = \"x\"\narea = 0.5\n",
            if material.is_empty() { ", 0, 0" } else { ", 0" },
            if material.is_empty() { ", 0" } else { "" },
            if material.is_empty() { ", 0" } else { "" },
        )
    };
    let plane = "[[fix]]\ngroup = \"xmin\"\naxes = [\"x\"]\n[[fix]]\nwhere = \"x < 1e-9 && y < 1e-9\"";
    let solid = "[[fix]]\ngroup = \"xmin\"\naxes = [\"x\"]\n[[fix]]\nwhere = \"x < 1e-9 && y < 1e-9 && z < 1e-9\"\n\
                 [[fix]]\nwhere = \"x < 1e-9 && z < 1e-9\"\naxes = [\"z\"]";
    let fit = "[[fit]]\nobjective = \"frobenius\"\n[[fit]]\nobjective = \"baudet-corrected\"";
    for text in [
        bar(
            "{ element = \"quad4\", size = [3, 1], cells = [6, 2] }",
            "plane = \"stress\"\nthickness = 0.5",
            plane,
            fit,
        ),
        bar("{ element = \"hex8\", size = [3, 1, 0.5], cells = [6, 2, 1] }", "", solid, fit),
    ] {
        let (_folder, path) = written(&text);
        let outcome = run(&Scene::load(&path).unwrap(), &mut quiet).unwrap();
        let body = outcome.loads[0].reading().unwrap();
        assert!((body.young / 2e4 - 1.0).abs() < 1e-10 && (body.poisson - 0.3).abs() < 1e-10, "{body:?}");
        // Neither pulls along the axis, the same force in the whole gauge.
        assert!(outcome.loads[1..].iter().all(|load| load.gauge == Some(GaugeResult::NoReading)));
        // Baudet's squares have the material's moduli; a bar of his cubes one cell thick has mechanisms.
        match outcome.fits[1].loads[0].gauge {
            Some(baudet) => {
                assert!((baudet.young / 2e4 - 1.0).abs() < 1e-9 && (baudet.poisson - 0.3).abs() < 1e-9, "{baudet:?}");
            }
            None => assert_eq!(outcome.mesh.dimension, 3),
        }
        let frobenius = outcome.fits[0].loads[0].gauge.unwrap();
        assert!((frobenius.young / 2e4 - 1.0).abs() > 0.05, "{frobenius:?}");
        assert!(
            report::tables(&outcome)
                .contains("Gauge reading of the finite elements under pull: E = 2.0000e4 Pa, nu = 0.300.")
        );
        assert!(report::report(&outcome).contains("\"gauge\""));
    }
}

const TRIANGLES: &str = "[mesh]\nbox = { element = \"tri3\", size = [1, 1], cells = [3, 3] }\n[material]\nyoung = 1\n\
                         poisson = 0.3\n[[fit]]\nobjective = \"lloyd\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\n\
                         group = \"xmax\"\ntraction = [1, 0]\n";

/// A published method is an objective; an assumption of it that a mesh does not meet is reported.
#[test]
fn published_methods_tell_what_they_take_for_granted() {
    let (_folder, path) = written(TRIANGLES);
    let outcome = run(&Scene::load(&path).unwrap(), &mut quiet).unwrap();
    let notes = report::notes(&outcome);
    let note = "lloyd: lloyd assumes Poisson's ratio 0.3333, and the material has 0.3; 18 of 18 elements do not have the shape that \
                lloyd assumes (lengths differ by up to 24 %)";
    assert!(notes.iter().any(|n| n == note), "{notes:?}");
    assert!(report::report(&outcome).contains("\"elements_of_other_shape\": 18"));
    let names = |path: &Path| -> Vec<String> {
        let outcome = compare_scene(&Scene::load(path).unwrap(), &mut quiet).unwrap();
        outcome.fits.iter().map(|fit| fit.fit.name.clone()).collect()
    };
    let all = names(&path);
    for name in ["van-gelder", "van-gelder-simple", "lloyd", "delingette-quadratic", "delingette-biquadratic"] {
        assert!(all.iter().any(|fit| fit == name), "{all:?}");
    }
    assert!(!all.iter().any(|fit| fit.starts_with("baudet") || fit == "lloyd-preserving"), "{all:?}");
}

/// Springs with an energy of their own, sampled in a scene that is linear, are those of a scene whose material has that energy.
#[test]
fn sampled_fits_have_a_law_where_the_material_has_none() {
    let fit = "objective = \"sampled\"\nsprings = [\"edge\", \"bulk\"]";
    let own = TRIANGLES.replace("objective = \"lloyd\"", &format!("{fit}\nlaw = \"neo-hookean\""));
    let of_material =
        TRIANGLES.replace("objective = \"lloyd\"", fit).replace("[[fit]]", "law = \"neo-hookean\"\n[[fit]]");
    let [linear, large] = [own, of_material].map(|text| {
        let (_folder, path) = written(&text);
        run(&Scene::load(&path).unwrap(), &mut quiet).unwrap()
    });
    assert_eq!(linear.fits[0].network.lengths, large.fits[0].network.lengths);
    assert!(linear.law.is_none() && large.law.is_some());
    assert!(linear.fits[0].stability.is_some() && linear.fits[0].loads[0].followed.is_none());
}

fn refusal(result: Result<impl Sized, Error>, file: &Path) -> String {
    let text = result.err().unwrap().to_string();
    // The line, where the file has one for the key.
    let rest = text.strip_prefix(&format!("{}:", file.display())).unwrap_or(&text);
    rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start_matches([':', ' ']).to_string()
}

#[test]
fn errors_of_scenes_say_what_was_expected_and_found() {
    let gauge = |text: &str| (String::from("[[fix]]"), format!("[gauge]\n{text}\n[[fix]]"));
    let fit = |text: &str| (String::from("objective = \"lloyd\""), text.to_string());
    let cases = [
        (fit("objective = \"lloyd\"\nhigher = 0.1"), "fit[0].higher: … \"lloyd\""),
        (fit("objective = \"lloyd\"\nnonnegative = true"), "fit[0].nonnegative: … \"lloyd\""),
        (fit("objective = \"lloyd\"\nweight = \"none\""), "fit[0].weight: … \"lloyd\""),
        (fit("objective = \"lloyd\"\nsolver = \"nelder-mead\""), "fit[0].solver: … \"lloyd\""),
        (fit("objective = \"baudet\""), "fit[0].objective: baudet: … found tri3, a triangle"),
        (fit("objective = \"lloyd-preserving\""), "fit[0].objective: poisson: … at least 0.3333 … found 0.3"),
        (fit("objective = \"lloyd\"\nsprings = [\"bulk\"]"), "fit[0].springs: … found \"bulk\""),
        (fit("objective = \"sampled\""), "material.law: … found none"),
        (fit("objective = \"lloyd\"\nlaw = \"neo-hookean\""), "fit[0].law: … found with \"lloyd\""),
        (
            fit("objective = \"sampled\"\nlaw = \"neo-hookean\"\nshapes = { loads = [\"pull\"] }"),
            "fit[0].shapes.loads: … \"law\"…",
        ),
        (fit("objective = \"lloyd\"\nname = \" \""), "fit[0].name: expected a name, found \" \""),
        (fit("objective = \"lloyd\"\nsprings = [\"edge\", \"bulk\"]"), "fit[0].springs: … found \"bulk\""),
        (
            fit("objective = \"frobenius\"\nsolver = \"nelder-mead\"\niterations = 9_000_000_000"),
            "fit[0].iterations: … from 1 to 1000000000, found 9000000000",
        ),
        (gauge("axis = \"x\"\narea = 1"), "gauge: … found neither"),
        (gauge("where = \"x > 0\"\naxis = \"r\"\narea = 1"), "gauge.axis: … found \"r\""),
        (gauge("where = \"x > 0\"\naxis = \"x\"\narea = 0"), "gauge.area: … found 0"),
        (gauge("where = \"x > 0\"\naxis = \"z\"\narea = 1"), "gauge.axis: … found \"z\""),
        (gauge("where = \"x > 0.9\"\naxis = \"x\"\narea = 1"), "gauge.where: … found 4 points …"),
        (gauge("group = \"middle\"\naxis = \"x\"\narea = 1"), "gauge.group: … found \"middle\""),
    ];
    for ((from, to), message) in cases {
        let (_folder, path) = written(&TRIANGLES.replace(&from, &to));
        let outcome = Scene::load(&path).and_then(|scene| run(&scene, &mut quiet));
        reads(&refusal(outcome, &path), message).unwrap();
    }
}

/// A table of one small scene, as anyone may write it.
const INDEX: &str = "title = \"own\"\n[[table]]\nname = \"A\"\ntitle = \"pulled\"\nkind = \"scenes\"\nload = \"pull\"\n\
                     columns = [\"e_rms\", \"e_max\"]\n[[table.row]]\nobject = \"square\"\nscene = \"scene.toml\"\n\
                     printed = { lloyd = [1, 2] }\nwhy = { lloyd = \"made up\" }\n[[table]]\nname = \"B\"\ntitle = \"timed\"\n\
                     kind = \"timing\"\ncolumns = [\"seconds\"]\n[[table.fit]]\nobjective = \"offdiag\"\n[[table.row]]\n\
                     object = \"triangle\"\nelement = \"tri3\"\n";

#[test]
fn an_index_of_ones_own_is_run_and_written() {
    let (folder, _) = written(TRIANGLES);
    let path = folder.path().join("index.toml");
    fs::write(&path, INDEX).unwrap();
    let paper = run_paper(&Index::load(&path).unwrap(), &[], &path, &mut quiet).unwrap();
    let lloyd = row(&paper, "square", "lloyd");
    assert_eq!((lloyd.printed.as_deref(), lloyd.why.as_deref()), (Some(&[1.0, 2.0][..]), Some("made up")));
    assert!(lloyd.differs() && lloyd.published);
    assert!(row(&paper, "triangle", "offdiag").found[0].unwrap() > 0.0);
    let text = report::paper_table(&paper.tables[0]).titled_text();
    assert!(text.contains("1.00 / 2.00") && text.contains("Differs from print, lloyd: made up"), "{text}");
    let out = folder.path().join("out");
    let written = report::write_paper(&paper, report::open_outputs(&out, &report::PAPER_FILES, &[]).unwrap()).unwrap();
    for name in ["a.csv", "b.csv", "paper.md", "scene.precision.svg"] {
        assert!(written.contains(&out.join(name)), "{written:?}");
    }
    let csv = fs::read_to_string(out.join("a.csv")).unwrap();
    let first = csv.lines().nth(1).unwrap();
    assert!(first.starts_with("square,lloyd,true,1,") && first.ends_with("made up"), "{csv}");
}

/// A table of errors in any order and number of columns.
#[test]
fn columns_come_as_they_are_asked_for() {
    for (columns, printed, best) in
        [("[\"e_rms\"]", "[1]", "with 1.00\n"), ("[\"e_max\", \"e_rms\"]", "[2, 1]", "with 2.00 / 1.00\n")]
    {
        let (folder, scene) = written(TRIANGLES);
        fs::write(&scene, TRIANGLES.replace("[[fix]]", "[[fit]]\nobjective = \"offdiag\"\n[[fix]]")).unwrap();
        let path = folder.path().join("index.toml");
        fs::write(&path, INDEX.replace("[\"e_rms\", \"e_max\"]", columns).replace("[1, 2]", printed)).unwrap();
        let paper = run_paper(&Index::load(&path).unwrap(), &["A".into()], &path, &mut quiet).unwrap();
        let text = report::paper_table(&paper.tables[0]).titled_text();
        assert!(text.contains("the best printed is lloyd") && text.contains(best), "{text}");
    }
}

#[test]
fn errors_of_an_index_say_what_was_expected_and_found() {
    for (from, to, message) in [
        ("name = \"B\"", "name = \"A\"", "table[1].name: … found \"A\" again"),
        ("load = \"pull\"\n", "", "table[0].load: is missing"),
        ("[\"seconds\"]", "[\"e_rms\"]", "table[1].columns: … found e_rms"),
        ("scene = \"scene.toml\"\n", "", "table[0].row[0].scene: is missing"),
        ("element = \"tri3\"\n", "element = \"tri3\"\nscene = \"a\"\n", "table[1].row[0].scene: … belong …"),
        ("[1, 2]", "[1]", "table[0].row[0].printed.lloyd: … 2 figures, … found 1"),
        ("lloyd = [1, 2]", "loyd = [1, 2]", "table[0].row[0].printed: … found \"loyd\""),
        ("\"pull\"", "\"push\"", "table[0].row[0].scene: … found those of pull"),
        ("\"offdiag\"", "\"whole\"", "table[1].row[0].recipe: … found whole from offdiag"),
        ("\"tri3\"", "\"tri33\"", "table[1].row[0]"),
        ("name = \"B\"", "name = \"a\"", "table[1].name: … found \"a\" …"),
        ("name = \"B\"", "name = \"-\"", "table[1].name: … found \"-\""),
        ("[1, 2]", "[1, inf]", "table[0].row[0].printed.lloyd: expected figures up to 1e30, found inf"),
        ("[\"e_rms\", \"e_max\"]", "[\"e_rms\", \"e_rms\"]", "table[0].columns: … found e_rms, e_rms"),
        (
            "[[table.row]]\nobject = \"triangle\"",
            "[[table.fit]]\nobjective = \"offdiag\"\n[[table.row]]\nobject = \"triangle\"",
            "table[1].fit[1].name: … found \"offdiag\" again",
        ),
        (
            "[[table]]\nname = \"B\"",
            "[[table.row]]\nobject = \"other\"\nscene = \"b/scene.toml\"\n[[table]]\nname = \"B\"",
            "table[0].row[1].scene: … found b/scene.toml",
        ),
        ("kind = \"timing\"", "kind = \"timed\"", "…unknown variant…"),
    ] {
        let (folder, _) = written(TRIANGLES);
        let path = folder.path().join("index.toml");
        assert_eq!(INDEX.matches(from).count(), 1, "{from}");
        fs::write(&path, INDEX.replace(from, to)).unwrap();
        let paper = Index::load(&path).and_then(|index| run_paper(&index, &[], &path, &mut quiet));
        let found = refusal(paper, &path);
        reads(&found, &format!("{message}…")).unwrap();
    }
    let path = root().join("index.toml");
    let unknown = run_paper(&Index::load(&path).unwrap(), &["7".into()], &path, &mut quiet);
    let text = unknown.err().unwrap().to_string();
    reads(&text, "table: … 1, 2, 3, 4, 5, 6, torsion, figure 9, section 3.5, found \"7\"").unwrap();
}
