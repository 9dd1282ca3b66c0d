//! Figures and tables for a paper, from the folder of a run.

use springfit::report::{Columns, Figure, Markup, ResultTable, RunFolder, write_outputs};
use springfit::study::{Scene, run};
use std::path::Path;
use tempfile::TempDir;

/// The folder of a run.
fn folder(scene: &str) -> TempDir {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene)).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write_outputs(&outcome, scene.output(), folder.path()).unwrap();
    folder
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
    let cube = folder("cube_tet.toml");
    let run = RunFolder::at(cube.path());
    for (columns, width) in [(Columns::One, "width=\"85mm\""), (Columns::Two, "width=\"178mm\"")] {
        for figure in [Figure::WorkPrecision, Figure::Constants] {
            let svg = figure.chart(&run, None).unwrap().svg(columns).unwrap();
            assert!(svg.starts_with("<svg ") && svg.contains(width), "{figure:?}");
            assert!(svg.contains("<title>"), "{figure:?}");
        }
    }
    let chart = Figure::WorkPrecision.chart(&run, Some("shear")).unwrap();
    assert_eq!(chart.series.len(), 5);
    let svg = chart.svg(Columns::Two).unwrap();
    assert!(svg.contains("time to fit") && svg.contains("e_rms under shear"));
    // The marks of the chart, without those of the legend, reach over most of it in both directions.
    let tall: f64 = svg.split_once("viewBox=\"0 0 ").unwrap().1.split(['"', ' ']).nth(1).unwrap().parse().unwrap();
    let heights = numbers(&svg, "circle", "cy");
    assert!(heights.iter().any(|y| *y < 0.3 * tall), "{heights:?} of {tall}");
    let motion = folder("membrane.toml");
    let chart = Figure::Motion.chart(&RunFolder::at(motion.path()), None).unwrap();
    assert!(chart.series[0].points.len() > 10);
    assert!(chart.svg(Columns::One).unwrap().contains("time, s"));
}

#[test]
fn the_constants_of_a_network_are_all_counted() {
    let cube = folder("cube_tet.toml");
    let chart = Figure::Constants.chart(&RunFolder::at(cube.path()), Some("offdiag")).unwrap();
    let counted: f64 = chart.series.iter().flat_map(|series| &series.points).map(|(_, count)| count).sum();
    assert_eq!(counted, 690.0);
}

#[test]
fn tables_are_latex_and_markdown() {
    let cube = folder("cube_tet.toml");
    let tables = ResultTable::all(&RunFolder::at(cube.path()).report().unwrap());
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
    let cube = folder("cube_tet.toml");
    let run = RunFolder::at(cube.path());
    let error = Figure::Motion.chart(&run, None).unwrap_err().to_string();
    assert!(error.contains("no motion"), "{error}");
    let error = Figure::WorkPrecision.chart(&run, Some("zzz")).unwrap_err().to_string();
    assert!(error.contains("tension, shear"), "{error}");
    std::fs::remove_file(cube.path().join("offdiag.json")).unwrap();
    let error = Figure::Constants.chart(&run, Some("offdiag")).unwrap_err().to_string();
    assert!(error.contains("offdiag.json"), "{error}");
}
