//! Figures and tables for a paper, from the folder of a run.

use crate::kit::{json, outcome_of, place, shipped, write_run};
use springfit_report::report::{
    Axis, CONVERGENCE_FILES, Chart, Columns, Deformation, Figure, Markup, Moduli, Picture, PictureFormat, RunFolder,
    Series, Shape, Table, open_outputs, write_convergence,
};
use springfit_studies::study::{Scene, converge, run};
use std::path::Path;
use tempfile::TempDir;

fn scene(name: &str, settings: &str) -> Scene {
    let path = place("scenes").join(name);
    Scene::parse(&(std::fs::read_to_string(&path).unwrap() + settings), &path).unwrap()
}

/// The folder of a run.
fn folder_of(scene: &Scene) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_run(scene, &run(scene, &mut |_| {}).unwrap(), folder.path());
    folder
}

/// The folder of a run of a shipped scene.
fn folder(name: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_run(&shipped(name), outcome_of(name), folder.path());
    folder
}

fn chart_of(figure: Figure, run: &RunFolder, of: Option<&str>) -> Chart {
    match figure.picture(run, of, None, None).unwrap() {
        Picture::Chart(chart) => chart,
        Picture::Moduli(_) | Picture::Deformation(_) => panic!("{figure:?} is no chart"),
    }
}

fn fault(figure: Figure, run: &RunFolder, of: Option<&str>, load: Option<&str>) -> String {
    figure.picture(run, of, load, None).unwrap_err().to_string()
}

/// The numbers of an attribute of all elements of a kind.
fn numbers(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
    let begin = format!("<{element} ");
    let value = |part: &str| {
        let (tag, _) = part.split_once('>')?;
        tag.split_once(&format!("{attribute}=\""))?.1.split_once('"')?.0.parse().ok()
    };
    svg.split(&begin).skip(1).filter_map(value).collect()
}

#[test]
fn figures_have_their_size_titles_and_fill_their_axes() {
    let cube = folder("cube_tet");
    let run = RunFolder::at(cube.path());
    for (columns, width) in [(Columns::One, "width=\"85mm\""), (Columns::Two, "width=\"178mm\"")] {
        for figure in [Figure::WorkPrecision, Figure::Constants, Figure::Moduli] {
            let svg = figure.picture(&run, None, None, None).unwrap().svg(columns).unwrap();
            assert!(svg.starts_with("<svg ") && svg.contains(width), "{figure:?}");
            assert!(svg.contains("<title>"), "{figure:?}");
        }
    }
    let chart = chart_of(Figure::WorkPrecision, &run, Some("shear"));
    assert_eq!(chart.series.len(), 5);
    let svg = chart.svg(Columns::Two).unwrap();
    assert!(svg.contains("time to fit") && svg.contains("e_rms under shear"));
    // The marks of the chart, without those of the legend, reach over most of it in both directions.
    let tall: f64 = svg.split_once("viewBox=\"0 0 ").unwrap().1.split(['"', ' ']).nth(1).unwrap().parse().unwrap();
    let squares = numbers(&svg, "rect", "y").into_iter().filter(|y| *y > 0.0);
    let heights: Vec<f64> = numbers(&svg, "circle", "cy").into_iter().chain(squares).collect();
    assert!(heights.iter().any(|y| *y < 0.3 * tall), "{heights:?} of {tall}");
    let motion = folder("membrane");
    let chart = chart_of(Figure::Motion, &RunFolder::at(motion.path()), None);
    assert!(chart.series[0].points.len() > 10);
    assert!(chart.svg(Columns::One).unwrap().contains("time, s"));
}

#[test]
fn the_constants_of_a_network_are_all_counted() {
    let cube = folder("cube_tet");
    let chart = chart_of(Figure::Constants, &RunFolder::at(cube.path()), Some("offdiag"));
    let counted: f64 = chart.series.iter().flat_map(|series| &series.points).map(|(_, count)| count).sum();
    assert_eq!(counted, 690.0);
}

#[test]
fn tables_are_latex_and_markdown() {
    let cube = folder("cube_tet");
    let tables = Table::all(&RunFolder::at(cube.path()).report().unwrap());
    for table in &tables {
        let markdown = Markup::Markdown.table(table);
        let rows: Vec<&str> = markdown.lines().filter(|line| line.starts_with('|')).collect();
        assert_eq!(rows.len(), table.rows.len() + 2);
        for row in rows {
            assert_eq!(row.replace("\\|", "").matches('|').count(), table.columns.len() + 1, "{row}");
        }
        let latex = Markup::Latex.table(table);
        for rule in ["\\toprule", "\\midrule", "\\bottomrule", "\\caption{", "\\label{tab:"] {
            assert!(latex.contains(rule), "{rule}");
        }
        let plain = latex.replace("\\{", "").replace("\\}", "");
        assert_eq!(plain.matches('{').count(), plain.matches('}').count());
        let lines: Vec<&str> = latex.lines().filter(|line| line.ends_with("\\\\")).collect();
        // A line above has the names of groups.
        let lines: Vec<&str> = lines.into_iter().filter(|line| !line.contains("\\multicolumn")).collect();
        assert_eq!(lines.len(), table.rows.len() + 1);
        for line in lines {
            assert_eq!(line.replace("\\&", "").matches('&').count(), table.columns.len() - 1, "{line}");
            // What LaTeX would read as the begin of a comment or of an index.
            let special =
                ["\\%", "\\_", "\\#"].iter().fold(line.to_string(), |line, escaped| line.replace(escaped, ""));
            assert!(!special.contains(['%', '_', '#']), "{line}");
            assert!(line.is_ascii(), "{line}");
        }
    }
}

#[test]
fn what_a_run_lacks_is_named() {
    let empty = tempfile::tempdir().unwrap();
    let error = RunFolder::at(empty.path()).report().unwrap_err().to_string();
    assert!(error.contains("report.json") && error.contains("[output] report"), "{error}");
    std::fs::write(empty.path().join("report.json"), "{\"version\": 1}").unwrap();
    let error = RunFolder::at(empty.path()).report().unwrap_err().to_string();
    assert!(
        error.contains("expected 2") && error.contains("found 1") && error.contains("run the scene again"),
        "{error}"
    );
    let cube = folder("cube_tet");
    let run = RunFolder::at(cube.path());
    std::fs::remove_file(cube.path().join("offdiag.json")).unwrap();
    for (figure, of, load, words) in [
        (Figure::Motion, None, None, &["report.json", "no motion", "[motion]"][..]),
        (Figure::WorkPrecision, Some("zzz"), None, &["tension, shear"]),
        (Figure::Constants, Some("offdiag"), None, &["offdiag.json", "[output] json"]),
        (Figure::Deformation, Some("exact"), None, &["mesh.vtu", "[output] vtu = true"]),
        (Figure::Deformation, Some("exact"), Some("zzz"), &["--load", "tension, shear"]),
        (Figure::Moduli, Some("zzz"), None, &["--of", "exact"]),
        (Figure::Moduli, None, Some("shear"), &["--load", "deformation"]),
        (Figure::Convergence, None, None, &["converge.csv", "springfit converge"]),
    ] {
        let error = fault(figure, &run, of, load);
        assert!(words.iter().all(|words| error.contains(words)), "{error}");
    }
    std::fs::write(cube.path().join("converge.csv"), "load,model\ntension,fem\n").unwrap();
    let error = fault(Figure::Convergence, &run, None, None);
    assert!(error.contains("converge.csv:2") && error.contains("h_m"), "{error}");
}

#[test]
fn damaged_parts_of_a_run_are_named() {
    let damaged = tempfile::tempdir().unwrap();
    let report = damaged.path().join("report.json");
    for (text, words) in [
        ("", "is not JSON"),
        ("{\"version\": 2", "is not JSON"),
        ("[]", "expected 2 to 3, those that this program reads, found none"),
        ("{\"version\": 4}", "found 4; run the scene again"),
        ("{\"version\": 2}", "missing field"),
        ("{\"version\": 2, \"scene\": 7}", "scene"),
    ] {
        std::fs::write(&report, text).unwrap();
        let error = RunFolder::at(damaged.path()).report().unwrap_err().to_string();
        assert!(error.contains("report.json") && error.contains(words) && !error.contains('\n'), "{text}: {error}");
    }
    std::fs::remove_file(&report).unwrap();
    std::fs::create_dir(&report).unwrap();
    let error = RunFolder::at(damaged.path()).report().unwrap_err().to_string();
    assert!(error.contains("report.json: cannot be read"), "{error}");
    let cube = folder("cube_tet");
    std::fs::write(cube.path().join("offdiag.json"), "{\"version\": 0}").unwrap();
    let error = fault(Figure::Constants, &RunFolder::at(cube.path()), Some("offdiag"), None);
    assert!(error.contains("offdiag.json") && error.contains("springfit network"), "{error}");
}

const FEW_STAGES: &str = r#"
[mesh]
box = { element = "quad4", size = [2, 1], cells = [2, 1] }
[material]
young = 10e3
poisson = 0.3
plane = "stress"
[[fit]]
objective = "whole"
[[fix]]
group = "xmin"
[[load]]
group = "xmax"
traction = [1.0, 0]
"#;

/// A report without keys that were added since has its figures all the same.
#[test]
fn a_report_without_objectives_of_steps_is_read() {
    let run = folder_of(&Scene::parse(FEW_STAGES, Path::new("scene.toml")).unwrap());
    let path = run.path().join("report.json");
    let mut report = json(&path);
    let stages = report["fits"][0]["whole"]["curve"].as_array_mut().unwrap();
    assert!(!stages.is_empty());
    for stage in stages {
        assert!(stage.as_object_mut().unwrap().remove("objective").is_some());
    }
    std::fs::write(&path, report.to_string()).unwrap();
    let read = RunFolder::at(run.path()).report().unwrap();
    assert!(read.fits[0].whole.as_ref().unwrap().curve.iter().all(|stage| stage.objective.is_empty()));
    assert!(Figure::WorkPrecision.picture(&RunFolder::at(run.path()), None, None, None).is_ok());
}

/// 1/E in a direction of a cube: that of the first axis is the first entry of the inverse.
#[test]
fn an_exact_network_has_the_modulus_of_the_material_in_all_directions() {
    let cube = folder("cube_tet");
    let run = RunFolder::at(cube.path());
    let young = run.report().unwrap().young.unwrap();
    let moduli = |of: Option<&str>| -> Moduli {
        match Figure::Moduli.picture(&run, of, None, None).unwrap() {
            Picture::Moduli(moduli) => moduli,
            Picture::Chart(_) | Picture::Deformation(_) => panic!("no moduli"),
        }
    };
    let exact = moduli(Some("exact"));
    assert_eq!((exact.planes.len(), exact.reference), (3, Some(young)));
    for modulus in exact.curves[0].moduli.iter().flatten() {
        assert!((modulus / young - 1.0).abs() < 1e-6, "{modulus}");
    }
    // Planes agree where they meet: x is the first direction of the planes xy and xz.
    for curve in &moduli(None).curves {
        let [xy, xz, yz] = &curve.moduli[..] else { panic!("three planes") };
        let quarter = xy.len() / 4;
        for (a, b) in [(xy[0], xz[0]), (xy[quarter], yz[0]), (xz[quarter], yz[quarter])] {
            assert!((a / b - 1.0).abs() < 1e-9, "{}: {a}, {b}", curve.name);
        }
    }
    assert!(moduli(None).curves.iter().any(|curve| curve.moduli[0].iter().any(|m| (m / young - 1.0).abs() > 0.1)));
    let square = folder("square_quad");
    let Picture::Moduli(plane) = Figure::Moduli.picture(&RunFolder::at(square.path()), None, None, None).unwrap()
    else {
        panic!("no moduli")
    };
    assert_eq!(plane.planes.len(), 1);
}

/// Storage and loss of each model and of the material; both are those of a standard linear solid, whose loss is largest at ω = 1/τ.
#[test]
fn moduli_over_frequency_are_curves_of_each_model() {
    let text = r#"
[mesh]
box = { element = "tet4", size = [0.02, 0.02, 0.04], cells = [1, 1, 2] }
[material]
young = 10e3
poisson = 0.3
relaxation = { terms = [{ shear = 0.6, bulk = 0.6, time = 1 }] }
[[fit]]
objective = "exact"
[output]
dynamic_moduli = { frequency = [0.01, 0.15915494309189535, 10] }
"#;
    let run = folder_of(&Scene::parse(text, Path::new("scene.toml")).unwrap());
    let chart = chart_of(Figure::DynamicModuli, &RunFolder::at(run.path()), None);
    let names: Vec<&str> = chart.series.iter().map(|series| &*series.name).collect();
    let expected =
        ["finite elements", "exact", "material"].map(|name| [format!("{name}, storage"), format!("{name}, loss")]);
    assert_eq!(names, expected.concat());
    for pair in chart.series.chunks(2) {
        for (i, frequency) in [0.01, 1.0 / std::f64::consts::TAU, 10.0].into_iter().enumerate() {
            let x = (std::f64::consts::TAU * frequency).powi(2);
            let [storage, loss] = [1.0 - 0.6 / (1.0 + x), 0.6 * x.sqrt() / (1.0 + x)].map(|share| 1e4 * share);
            assert!((pair[0].points[i].1 / storage - 1.0).abs() < 1e-9, "{}", pair[0].name);
            assert!((pair[1].points[i].1 / loss - 1.0).abs() < 1e-9, "{}", pair[1].name);
        }
    }
    assert!(chart.svg(Columns::One).unwrap().contains("exact, loss"));
}

fn deformation(run: &RunFolder, of: &str, load: &str) -> Deformation {
    match Figure::Deformation.picture(run, Some(of), Some(load), None).unwrap() {
        Picture::Deformation(deformation) => *deformation,
        Picture::Chart(_) | Picture::Moduli(_) => panic!("no deformation"),
    }
}

#[test]
fn a_deformation_shows_the_run_and_covers_what_is_behind() {
    for (name, load, solid) in [("cube_tet.toml", "shear", true), ("square_quad.toml", "tension", false)] {
        let scene = scene(name, "\n[output]\nvtu = true\n");
        let outcome = run(&scene, &mut |_| {}).unwrap();
        let folder = tempfile::tempdir().unwrap();
        write_run(&scene, &outcome, folder.path());
        let run = RunFolder::at(folder.path());
        let fit = &outcome.fits[1];
        let place = outcome.loads.iter().position(|known| known.name == load).unwrap();
        let shown = deformation(&run, &fit.fit.name, load);
        let springs = fit.loads[place].displacement.as_ref().unwrap();
        for (found, expected) in shown.displacements.iter().zip([&outcome.loads[place].fem, springs]) {
            let largest = expected.iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-9 * largest), "{name}");
        }
        assert_eq!(shown.springs.len(), fit.network.lengths.len());
        assert!(!shown.held.is_empty() && !shown.forces.is_empty());
        for (columns, width) in [(Columns::One, "85mm"), (Columns::Two, "178mm")] {
            let svg = shown.svg(columns);
            assert!(svg.contains(&format!("width=\"{width}\"")) && svg.contains("<title>"), "{name}");
            for words in ["(a) at rest", "(b) finite elements", "e_rms", "|u|", "k &lt; 0"] {
                let expected = words != "k &lt; 0" || shown.springs.iter().any(|(_, is_negative)| *is_negative);
                assert_eq!(svg.contains(words), expected, "{name}: {words}");
            }
            // Faces are closed and filled; those that look away are left out: of a convex body about half.
            let filled = svg.split("<path ").filter(|path| path.contains("stroke-linejoin")).count();
            let share = filled as f64 / (2 * shown.faces.len()) as f64;
            assert!(if solid { (0.3..0.7).contains(&share) } else { share == 1.0 }, "{name}: {share}");
        }
    }
}

#[test]
fn charts_of_convergence_are_those_of_the_study() {
    let scene = scene("square_quad.toml", "");
    let study = converge(&scene, Some(3), &mut |_| {}).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write_convergence(&study, open_outputs(folder.path(), &CONVERGENCE_FILES, &[]).unwrap()).unwrap();
    let chart = chart_of(Figure::Convergence, &RunFolder::at(folder.path()), None);
    let load = &study.loads[0];
    let guides = chart.series.iter().filter(|series| series.shape == Shape::Guide).count();
    assert_eq!((chart.series.len() - guides, guides), (load.models.len(), 2));
    for (series, model) in chart.series.iter().zip(&load.models) {
        assert!(series.name.starts_with(&model.name), "{}", series.name);
        let errors: Vec<f64> = load.of_truth(model).into_iter().flatten().map(f64::abs).collect();
        assert_eq!(series.points.iter().map(|(_, error)| *error).collect::<Vec<_>>(), errors);
        let sizes: Vec<f64> = study.levels.iter().map(|level| 1e3 * level.size).collect();
        assert_eq!(series.points.iter().map(|(h, _)| *h).collect::<Vec<_>>(), sizes);
    }
    // Slopes 1 and 2 through the coarsest error.
    for (order, guide) in [1, 2].into_iter().zip(&chart.series[load.models.len()..]) {
        let [(h, e), (h_end, e_end)] = guide.points[..] else { panic!("a line") };
        assert!(((e_end / e).ln() / (h_end / h).ln() - f64::from(order)).abs() < 1e-9);
    }
    assert!(chart.svg(Columns::One).unwrap().contains("cell size h, mm"));
    let whole = std::fs::read_to_string(folder.path().join("converge.svg")).unwrap();
    assert_eq!(whole.matches("cell size h, mm").count(), study.loads.len());
}

/// Luminance of colours as grey, Rec. 601: neighbours of the list and of the ramp differ.
#[test]
fn greys_are_distinct() {
    let cube = folder("cube_tet");
    let svg = Figure::Moduli.picture(&RunFolder::at(cube.path()), None, None, None).unwrap().svg(Columns::One).unwrap();
    let line = |tag: &str| -> Option<(f64, String)> {
        let value = |key: &str| Some(tag.split_once(&format!("{key}=\""))?.1.split_once('"')?.0.to_string());
        let color = value("stroke")?;
        let channel = |i: usize| f64::from(u8::from_str_radix(&color[2 * i + 1..2 * i + 3], 16).unwrap());
        let grey = 0.299 * channel(0) + 0.587 * channel(1) + 0.114 * channel(2);
        (value("stroke-width")? == "1.8").then(|| (grey, value("stroke-dasharray").unwrap_or_default()))
    };
    let mut lines: Vec<(f64, String)> = svg.split("<path ").filter_map(line).collect();
    lines.dedup();
    assert!(lines.len() >= 5);
    for (i, (grey, dashes)) in lines.iter().enumerate() {
        for (other, dashes_of_other) in &lines[..i] {
            let is_told_apart = (grey - other).abs() > 20.0 || dashes != dashes_of_other || grey == other;
            assert!(is_told_apart, "{grey} {dashes}, {other} {dashes_of_other}");
        }
    }
}

#[test]
fn formats_are_those_of_the_ending() {
    assert_eq!(PictureFormat::of(Path::new("a.svg")).unwrap(), PictureFormat::Svg);
    let error = PictureFormat::of(Path::new("a.jpg")).unwrap_err().to_string();
    assert!(error.contains(".svg, .pdf or .png"), "{error}");
    for (file, format, start) in
        [("a.pdf", PictureFormat::Pdf, &b"%PDF-"[..]), ("a.PNG", PictureFormat::Png, &b"\x89PNG"[..])]
    {
        match PictureFormat::of(Path::new(file)) {
            Ok(found) => {
                assert_eq!(found, format);
                let cube = folder("cube_tet");
                let picture = Figure::Moduli.picture(&RunFolder::at(cube.path()), None, None, None).unwrap();
                let bytes = format.bytes(picture.svg(Columns::One).unwrap()).unwrap();
                assert!(bytes.starts_with(start), "{file}");
                // Letters come from the font of the program: without one the file of lines alone is smaller.
                assert!(bytes.len() > 10_000, "{file}: {} bytes", bytes.len());
                let error = format.bytes("no figure".into()).unwrap_err().to_string();
                assert!(
                    error.contains("springfit-pictures") && error.contains("cannot be read"),
                    "{format:?}: {error}"
                );
            }
            Err(error) => {
                println!("{file} is not drawn: springfit-pictures is not on PATH");
                let error = error.to_string();
                assert!(error.contains("crates/pictures") && error.contains("rsvg-convert"), "{format:?}: {error}");
            }
        }
    }
}

/// What is drawn is of the run of the report: the files of a former one are removed, those of the user stay.
#[test]
fn a_run_leaves_no_file_of_the_former_one() {
    let folder = tempfile::tempdir().unwrap();
    let write = |settings: &str| {
        let scene = scene("square_quad.toml", settings);
        write_run(&scene, &run(&scene, &mut |_| {}).unwrap(), folder.path());
    };
    let has = |name: &str| folder.path().join(name).exists();
    std::fs::write(folder.path().join("mine.vtu"), "of the user").unwrap();
    write("\n[output]\nvtu = true\ncsv = true\nreport = true\n");
    let run = RunFolder::at(folder.path());
    let fit = run.report().unwrap().fits[0].name.clone();
    let load = run.report().unwrap().fits[0].loads[0].name.clone();
    deformation(&run, &fit, &load);
    assert!(has("mesh.vtu") && has("points.csv") && has("report.html"));
    write("\n[output]\njson = false\n");
    for name in ["mesh.vtu", "points.csv", "report.html", "frobenius.json", "frobenius.csv"] {
        assert!(!has(name), "{name}");
    }
    assert!(has("mine.vtu") && has("report.json"));
    let error = fault(Figure::Deformation, &run, Some(&fit), Some(&load));
    assert!(error.contains("mesh.vtu") && error.contains("is not there"), "{error}");
    // A run without a report is known to the next one as well.
    write("\n[output]\nvtu = true\nreport = false\n");
    assert!(!has("report.json") && has("mesh.vtu"));
    write("");
    assert!(!has("mesh.vtu"));
    std::fs::write(folder.path().join("mesh.vtu"), "of another run").unwrap();
    let error = fault(Figure::Deformation, &run, Some(&fit), Some(&load));
    assert!(error.contains("mesh.vtu") && error.contains("of another run"), "{error}");
}

/// An input of a run stays, even if the former run wrote it.
#[test]
fn a_run_removes_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let first = scene("square_quad.toml", "\n[output]\nvtu = true\n");
    write_run(&first, &run(&first, &mut |_| {}).unwrap(), folder.path());
    let text = "[mesh]\nfile = \"mesh.vtu\"\n[material]\nyoung = 1e4\npoisson = 0.3\nplane = \"stress\"\n[[fit]]\nobjective = \"exact\"\n";
    let second = Scene::parse(text, &folder.path().join("scene.toml")).unwrap();
    write_run(&second, &run(&second, &mut |_| {}).unwrap(), folder.path());
    assert!(folder.path().join("mesh.vtu").exists());
}

/// Squares of their edges alone are a mechanism, without an error.
#[test]
fn fits_without_an_error_are_named() {
    let fit = "\n[[fit]]\nname = \"edges\"\nobjective = \"offdiag\"\nsprings = [\"edge\"]\n";
    let square = folder_of(&scene("square_quad.toml", fit));
    let run = RunFolder::at(square.path());
    let left_out = Figure::WorkPrecision.left_out(&run, None).unwrap();
    assert_eq!(left_out.len(), 1);
    assert!(left_out[0].contains("edges") && left_out[0].contains("mechanism"), "{left_out:?}");
    assert!(Figure::Constants.left_out(&run, None).unwrap().is_empty());
}

/// A fit has one colour in all figures of a run, whatever others are left out; networks that do not stand are called so.
#[test]
fn a_fit_looks_the_same_in_all_figures() {
    let membrane = folder("membrane");
    let run = RunFolder::at(membrane.path());
    let report = run.report().unwrap();
    let place = |name: &str| {
        let known = report.fits.iter().position(|fit| name == fit.name || name.starts_with(&format!("{} (", fit.name)));
        known.unwrap_or(report.fits.len())
    };
    for figure in [Figure::WorkPrecision, Figure::Motion] {
        let Ok(Picture::Chart(chart)) = figure.picture(&run, None, None, None) else { continue };
        for series in &chart.series {
            assert_eq!(series.style, Some(place(&series.name)), "{figure:?} {}", series.name);
        }
    }
    let moduli = |of: Option<&str>| match Figure::Moduli.picture(&run, of, None, None).unwrap() {
        Picture::Moduli(moduli) => moduli,
        Picture::Chart(_) | Picture::Deformation(_) => panic!("no moduli"),
    };
    for curve in moduli(None).curves {
        assert_eq!(curve.place, place(&curve.name));
        // One alone looks as it does among the others.
        let name = &report.fits[curve.place].name;
        assert_eq!(moduli(Some(name)).curves[0].place, curve.place);
    }
}

/// Names and titles end within a figure of one column.
#[test]
fn long_names_end_within_their_figure() {
    let name = "a fit with a name that is much longer than a column of a paper is wide, in two of them";
    let series =
        |place: usize| Series::new(format!("{name} {place}"), vec![(1.0, 1.0), (2.0, 3.0)], Shape::Curve).styled(place);
    let chart = Chart {
        title: "names".into(),
        x: Axis::linear("a title of an axis that is much longer than the axis, which is as wide as a column"),
        y: Axis::linear("another title of an axis that is much longer than the axis is tall in one column"),
        series: vec![series(0), series(1)],
    };
    let svg = chart.svg(Columns::One).unwrap();
    let size: Vec<f64> =
        svg.split_once("viewBox=\"0 0 ").unwrap().1.split(['"', ' ']).take(2).map(|x| x.parse().unwrap()).collect();
    let mut found = 0;
    for text in svg.split("<text ").skip(1) {
        let attribute = |key: &str| {
            text.split_once(&format!("{key}=\"")).and_then(|(_, rest)| rest.split_once('"')?.0.parse::<f64>().ok())
        };
        let words = text.split_once('>').unwrap().1.split_once('<').unwrap().0.trim();
        if !words.contains("name") && !words.contains("title") {
            continue;
        }
        found += 1;
        assert!(words.ends_with('…') || words.chars().count() < 60, "{words}");
        // Letters are about 0.58 of their height wide; the library's sizes are 1.25 times that of the letters.
        let wide = 0.58 / 1.25 * attribute("font-size").unwrap() * 1.25 * words.chars().count() as f64;
        let is_turned = text.contains("rotate");
        assert!(wide < if is_turned { size[1] } else { size[0] }, "{words}: {wide} of {size:?}");
    }
    assert_eq!(found, 4);
}
