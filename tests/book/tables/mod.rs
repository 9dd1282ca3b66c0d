//! Tables of figures on the pages, measured again.
//!
//! A page has a table between `<!-- table NAME -->` and `<!-- end -->`. `SPRINGFIT_WRITE_BOOK=1 cargo test --release book -- --include-ignored`
//! writes all tables anew, and `SPRINGFIT_TABLE=NAME` besides one alone.

mod angles;
mod bodies;
mod cantilevers;
mod choice;
mod coarse;
mod creep;
mod forgetful;
mod large;
mod lattices;
mod motion;
mod norms;
mod paper;
mod readme;
mod related;
mod shells;
mod stability;
mod tensile;
mod truths;
mod whole;

use super::markdown::{page, pages, root};
use super::printed::compare;
use springfit_studies::study::{FitEntry, NamedFit, Outcome, Scene, run};
use std::path::Path;

/// How much a table may differ from a fresh run.
#[derive(Clone, Copy)]
enum Kept {
    /// To rounding: two units of the second decimal, or 0.2 %.
    ToRounding,
    /// Numbers to a fifth: iterations that end at other points on other machines.
    Roughly,
    /// Errors of rounding, to a factor of ten; whole numbers exactly.
    Magnitude,
}

impl Kept {
    fn share(self) -> f64 {
        match self {
            Kept::ToRounding => 0.0,
            Kept::Roughly => 0.2,
            Kept::Magnitude => 9.0,
        }
    }
}

/// What makes a table anew, whether that takes long, and how well it must agree.
type Maker = (&'static str, fn() -> String, bool, Kept);

const MAKERS: [Maker; 29] = [
    ("creep bar", creep::bar, false, Kept::Roughly),
    ("creep yield", creep::yielding, false, Kept::Roughly),
    ("creep kidney", creep::kidney_let_go, true, Kept::ToRounding),
    ("forgetful", forgetful::table, false, Kept::Roughly),
    ("norms", norms::table, false, Kept::ToRounding),
    ("readme", readme::table, false, Kept::ToRounding),
    ("bodies", bodies::table, false, Kept::ToRounding),
    ("elements", choice::elements, true, Kept::ToRounding),
    ("block", choice::block, false, Kept::ToRounding),
    ("indefinite", choice::indefinite, false, Kept::ToRounding),
    ("cantilevers", cantilevers::table, true, Kept::ToRounding),
    ("lattices", lattices::table, false, Kept::ToRounding),
    ("large-tet", large::tetrahedra, true, Kept::Roughly),
    ("large-hex", large::hexahedra, true, Kept::Roughly),
    ("whole", whole::table, true, Kept::Roughly),
    ("coarse", coarse::supports, true, Kept::Roughly),
    ("programs", coarse::programs, true, Kept::Roughly),
    ("frequencies", motion::frequencies, false, Kept::ToRounding),
    ("membrane", motion::membrane, false, Kept::ToRounding),
    ("paper-1", paper::first, true, Kept::Roughly),
    ("paper-meshes", paper::meshes, false, Kept::ToRounding),
    ("shells", shells::table, false, Kept::ToRounding),
    ("stability", stability::table, true, Kept::Magnitude),
    ("tensile", tensile::table, false, Kept::ToRounding),
    ("truths", truths::table, true, Kept::ToRounding),
    ("angles", angles::table, true, Kept::ToRounding),
    ("angles on bodies", angles::bodies, false, Kept::ToRounding),
    ("related", related::table, false, Kept::Roughly),
    ("sparsity", related::sparsity, false, Kept::Roughly),
];

/// A scene of the folder `scenes`.
fn scene(name: &str) -> Scene {
    Scene::load(&root().join(format!("scenes/{name}.toml"))).unwrap()
}

fn outcome(scene: &Scene) -> Outcome {
    run(scene, &mut |_| {}).unwrap()
}

fn fit(entry: FitEntry) -> NamedFit {
    entry.fits(Path::new("")).unwrap().remove(0)
}

/// All groups of springs of the scene's element.
fn all_groups(scene: &Scene) -> Option<Vec<String>> {
    let mesh = scene.build_mesh().unwrap();
    Some(mesh.blocks[0].element.springs.iter().map(|group| group.name.clone()).collect())
}

/// A number with a minus sign as it is printed in books.
fn signed(value: f64, decimals: usize) -> String {
    let value = if value.abs() < 0.5 * 0.1f64.powi(decimals as i32) { 0.0 } else { value };
    format!("{}{:.decimals$}", if value < 0.0 { "−" } else { "" }, value.abs())
}

/// A table in Markdown.
fn markdown(header: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let rule = format!("|{}\n", "---|".repeat(header.len()));
    let rows: String = rows.iter().map(|row| line(row.iter().map(String::as_str).collect())).collect();
    line(header.to_vec()) + &rule + &rows
}

fn check(is_slow: bool) {
    let writes = std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some();
    // One table alone, by its name.
    let only = std::env::var("SPRINGFIT_TABLE").ok();
    let mut wrong = Vec::new();
    for page in pages() {
        for (name, text) in page.tables() {
            let maker = MAKERS.iter().find(|(known, ..)| *known == name);
            let (_, make, slow, kept) = maker.unwrap_or_else(|| panic!("{}: nothing makes {name}", page.name()));
            if *slow != is_slow || only.as_ref().is_some_and(|only| *only != name) {
                continue;
            }
            let made = make();
            if writes {
                super::markdown::page(page.path.to_str().unwrap()).write_table(&name, &made);
            } else if let Err(problem) = compare(&text, made.trim(), kept.share()) {
                wrong.push(format!("{}: table {name}: {problem}", page.name()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_tables_are_those_of_a_fresh_run() {
    check(false);
}

/// Some minutes in an optimised build.
#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn the_long_tables_are_those_of_a_fresh_run() {
    check(true);
}

#[test]
fn every_table_is_on_a_page() {
    let there: Vec<String> = pages().iter().flat_map(|page| page.tables()).map(|(name, _)| name).collect();
    for (name, ..) in MAKERS {
        assert_eq!(there.iter().filter(|other| *other == name).count(), 1, "{name}");
    }
    assert!(page("README.md").tables().len() == 1);
}
