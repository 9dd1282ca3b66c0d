//! The report as a page: it holds what it shows, asks for nothing, and reads no text as HTML.

use crate::kit::{files_of, outcome, outcome_of, place};
use springfit_bodies::model::LengthSpring;
use springfit_report::report::page::{PageRecord, page_html};
use springfit_report::report::{Report, open_scene_outputs, write_outputs};
use springfit_studies::study::{Outcome, Scene, run};
use std::path::Path;

fn page(outcome: &Outcome) -> String {
    let mut text = Vec::new();
    page_html(outcome, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

/// The record that the scripts of a page read.
fn record(page: &str) -> serde_json::Value {
    let begin = page.split_once("<script type=\"application/json\" id=\"record\">").unwrap().1;
    serde_json::from_str(begin.split_once("</script>").unwrap().0).unwrap()
}

/// All of a page but the compressed library.
fn own(page: &str) -> String {
    let (before, rest) = page.split_once("id=\"library\">").unwrap();
    format!("{before}{}", rest.split_once("</script>").unwrap().1)
}

const PLANE: &str = r#"
[mesh]
box = { element = "quad4", size = [2, 1], cells = [2, 1] }
[material]
young = 10e3
poisson = 0.3
plane = "stress"
"#;
const FIT: &str = "[[fit]]\nobjective = \"frobenius\"\n";
const LOAD: &str = "[[fix]]\ngroup = \"xmin\"\n[[load]]\ngroup = \"xmax\"\ntraction = [1.0, 0]\n";

#[test]
fn the_page_of_a_cube_is_below_5_mb_and_holds_its_report() {
    let outcome = outcome_of("cube_tet");
    let page = page(outcome);
    assert!(page.len() < 5_000_000, "{} bytes", page.len());
    let record = record(&page);
    assert_eq!(record["report"], serde_json::to_value(Report::of(outcome)).unwrap());
    let view = PageRecord::of(outcome).view;
    assert_eq!(view.points.0.len(), 3 * 147);
    assert_eq!(view.networks.len(), outcome.fits.len());
    for (network, fit) in view.networks.iter().zip(&outcome.fits) {
        let constants: Vec<f32> = fit.network.lengths.iter().map(|spring| spring.constant as f32).collect();
        assert_eq!(network.constants.0, constants, "{}", network.name);
        let counted: usize = network.histograms.iter().flat_map(|h| h.counts.iter().chain(&h.outside)).sum();
        assert_eq!(counted, fit.network.len(), "{}", network.name);
    }
    // The springs of a mesh are written once, whatever the number of networks.
    assert!(view.meshes.len() < view.networks.len());
}

#[test]
fn a_page_asks_for_nothing() {
    let page = own(&page(&outcome(&[PLANE, FIT, LOAD].concat())));
    assert!(page.contains("default-src 'none'"));
    for source in ["src=\"http", "href=\"http", "url(", "@import", "src=\"//", "fetch(", "XMLHttpRequest", "import("] {
        assert!(!page.contains(source), "{source}");
    }
}

#[test]
fn no_text_of_a_file_is_read_as_html() {
    let evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>";
    let title = format!("title = {evil:?}\n");
    let fit = FIT.to_string() + &format!("name = {:?}\n", "<b onclick='alert(3)'>&amp;");
    let load = LOAD.replace("[[load]]\n", &format!("[[load]]\nname = {:?}\n", "</title><svg onload=alert(4)>"));
    let mut outcome = outcome(&[&title, PLANE, &fit, &load].concat());
    // No file says this; a program may.
    outcome.scene += "\u{1b}[31m";
    let page = page(&outcome);
    for markup in ["<script>alert", "<img src", "<b onclick", "<svg"] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("<title>&lt;/script&gt;"), "the title is shown as it is");
    assert!(!page.contains('\u{1b}'), "a terminal that prints the page is left alone");
    assert_eq!(record(&page)["report"]["fits"][0]["name"], outcome.fits[0].fit.name);
}

/// The script sets texts of nodes alone: nothing that reads HTML.
#[test]
fn no_script_writes_html() {
    let folder = place("crates/page/assets");
    // A published package has no other packages in its folder.
    if !folder.is_dir() {
        return;
    }
    for file in files_of(&folder, "js") {
        let text = std::fs::read_to_string(&file).unwrap();
        for word in ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("] {
            assert!(!text.contains(word), "{} has {word}", file.display());
        }
        assert!(text.lines().count() <= 400, "{}", file.display());
    }
}

#[test]
fn a_run_without_loads_and_one_of_a_single_spring_have_pages() {
    let bare = record(&page(&outcome(&[PLANE, FIT].concat())));
    assert_eq!(bare["view"]["loads"].as_array().unwrap().len(), 0);
    let folder = tempfile::tempdir().unwrap();
    let nodes = "$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n$Elements\n1\n1 1 2 1 1 1 2\n$EndElements\n";
    let mesh = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{nodes}");
    std::fs::write(folder.path().join("rod.msh"), mesh).unwrap();
    let rod = "[mesh]\nfile = \"rod.msh\"\n[material]\nyoung = 1\npoisson = 0\n";
    let scene = Scene::parse(&[rod, FIT].concat(), &folder.path().join("scene.toml")).unwrap();
    let single = record(&page(&run(&scene, &mut |_| {}).unwrap()));
    assert_eq!(single["report"]["fits"][0]["springs"], 1);
    // One edge of one cell: two places of 32 bits in base64.
    assert_eq!(single["view"]["edges"], "AAAAAAEAAAA=");
}

#[test]
fn a_run_without_fits_has_a_page_and_a_scene_without_them_an_error() {
    let error = Scene::parse(&[PLANE, LOAD].concat(), Path::new("scene.toml")).unwrap_err().to_string();
    assert_eq!(error, "scene.toml: fit: expected at least one [[fit]], or [calibrate], found none");
    let mut without = outcome(&[PLANE, FIT, LOAD].concat());
    without.fits.clear();
    let record = record(&page(&without));
    assert_eq!((without.fits.len(), record["view"]["networks"].as_array().unwrap().len()), (0, 0));
    assert_eq!(record["view"]["loads"].as_array().unwrap().len(), 1);
}

/// A spring of a network of ten million adds nothing to the page, which has some of them and says how many.
#[test]
fn a_network_of_ten_million_springs_is_thinned() {
    let boxed = PLANE.replace("cells = [2, 1]", "cells = [60, 60]");
    let mut large = outcome(&[&boxed, FIT, LOAD].concat());
    let points = large.mesh.point_count();
    let spring = large.fits[0].network.lengths[0];
    let one = |s: usize| LengthSpring { points: [s % (points - 1), points - 1], constant: s as f64, ..spring };
    large.fits[0].network.lengths = (0..10_000_000).map(one).collect();
    let start = std::time::Instant::now();
    let page = page(&large);
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 60.0, "{seconds} s");
    assert!(page.len() < 10_000_000, "{} bytes", page.len());
    let view = PageRecord::of(&large).view;
    let drawn = &view.meshes[0].numbers.0;
    assert_eq!((drawn.len(), view.networks[0].constants.0.len()), (100_000, 100_000));
    assert!(drawn.windows(2).all(|pair| (100..=101).contains(&(pair[1] - pair[0]))), "the steps are even");
    let counted: usize = view.networks[0].histograms.iter().flat_map(|h| h.counts.iter().chain(&h.outside)).sum();
    assert_eq!(counted, 10_000_000);
    let words = "drawn are 100000 of 10000000 springs";
    assert!(view.left_out.iter().any(|line| line.contains(words)), "{:?}", view.left_out);
    assert!(page.contains(words), "the page says so");
}

#[test]
fn only_who_asks_has_a_page() {
    for (given, expected) in
        [("", vec!["report.json"]), ("true", vec!["report.json", "report.html"]), ("false", vec![])]
    {
        let output = if given.is_empty() { String::new() } else { format!("report = {given}\n") };
        let text = [PLANE, FIT, "[output]\njson = false\n", &output].concat();
        let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let written =
            write_outputs(&outcome(&text), scene.output(), open_scene_outputs(&scene, folder.path()).unwrap()).unwrap();
        let names: Vec<&str> = written.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, expected);
    }
}

/// Relative luminance and contrast of two colours, WCAG 2.2; 4.5 is asked of text, 3 of lines.
fn contrast(a: &str, b: &str) -> f64 {
    let luminance = |color: &str| {
        let channel = |i: usize| {
            let value = f64::from(u8::from_str_radix(&color[2 * i + 1..2 * i + 3], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(1) + 0.0722 * channel(2)
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn text_and_lines_stand_out_in_light_and_dark() {
    let page = page(&outcome(&[PLANE, FIT].concat()));
    let style = page.split_once("<style>").unwrap().1.split_once("</style>").unwrap().0;
    let screens: Vec<&str> = style.split_once("@media print").unwrap().0.split("--paper:").skip(1).collect();
    assert_eq!(screens.len(), 3, "light, dark by the system, dark by the button");
    for screen in screens {
        let screen = format!("--paper:{screen}");
        let color = |name: &str| {
            let value = screen.split_once(&format!("--{name}:")).unwrap().1.trim_start();
            value[..7].to_string()
        };
        for paper in ["paper", "card"] {
            for ink in ["ink", "soft", "link"] {
                let found = contrast(&color(ink), &color(paper));
                assert!(found >= 4.5, "--{ink} on --{paper}: {found:.2}");
            }
            for line in ["rest", "fem", "accent"] {
                let found = contrast(&color(line), &color(paper));
                assert!(found >= 3.0, "--{line} on --{paper}: {found:.2}");
            }
        }
        assert!(contrast(&color("warn"), &color("warn-paper")) >= 4.5);
    }
}
