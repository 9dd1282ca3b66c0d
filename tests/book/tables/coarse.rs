//! Networks of an organ, the surface of the page *A coarse network for a fine body*: fitted as a whole under several supports, and cell by cell.

use super::markdown;
use crate::book::markdown::page;
use springfit_studies::study::{FitOutcome, Outcome, Scene, run};
use std::path::Path;
use std::process::Command;

/// The supports of the tables, by their names.
const SUPPORTS: [(&str, &str); 4] =
    [("left", "x < -0.045"), ("right", "x > 0.045"), ("front", "y < -0.045"), ("below", "z < -0.02")];

/// The scene of the page with other fits, run in a folder that has its surface; `changes` are pairs of texts.
fn outcome(changes: &[(&str, &str)], fits: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let blocks = page("docs/src/start/coarse.md").blocks();
    let file = |name: &str| {
        let mark = format!("file: {name}");
        blocks.iter().find(|block| block.mark.as_deref() == Some(&mark)).unwrap().text.clone()
    };
    std::fs::write(folder.path().join("organ.awk"), file("organ.awk")).unwrap();
    let made = Command::new("awk").args(["-f", "organ.awk"]).current_dir(folder.path()).output().unwrap();
    std::fs::write(folder.path().join("organ.stl"), made.stdout).unwrap();
    let text = file("coarse.toml");
    let mut text = text[..text.find("[[fit]]").unwrap()].to_string() + fits;
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let scene = Scene::parse(&text, &Path::new(folder.path()).join("coarse.toml")).unwrap();
    run(&scene, &mut |_| {}).unwrap()
}

fn list(names: &[&str]) -> String {
    let condition = |name: &&str| SUPPORTS.iter().find(|(own, _)| own == name).unwrap().1;
    names.iter().map(|name| format!("[\"{}\"]", condition(name))).collect::<Vec<_>>().join(", ")
}

/// Median and largest error of a model under each support, percent.
fn errors(fit: &FitOutcome, model: &str) -> Vec<String> {
    let of = |(_, condition): &(&str, &str)| {
        let held = fit.kind.whole().unwrap().held_out.iter().find(|held| held.support == *condition).unwrap();
        let found = held.models.iter().find(|own| own.model == model).unwrap();
        format!("{:.2} ({:.2})", 100.0 * found.median.unwrap(), 100.0 * found.worst.unwrap())
    };
    SUPPORTS.iter().map(of).collect()
}

/// Coarse networks under supports that they know, and others.
pub fn supports() -> String {
    let starts = [
        ("exact form", "start = \"exact\"\nshear = \"edges\"\nvolume = \"patches\""),
        ("positive", "start = \"divergence\"\nsprings = [\"edge\", \"bulk\"]"),
    ];
    let sets: [(&[&str], &[&str], &[&str]); 3] = [
        (&["left"], &["left"], &["right", "front", "below"]),
        (&["left", "right"], &["left", "right", "front"], &["below"]),
        (&["left", "right", "front"], &["left", "right", "front"], &["below"]),
    ];
    let fits: String = starts
        .iter()
        .flat_map(|(name, start)| {
            sets.iter().enumerate().map(move |(i, (fitted, chosen, others))| {
                format!(
                    "[[fit]]\nname = \"{name} {i}\"\nobjective = \"whole\"\n{start}\nsupports = [{}]\nvalidate_supports = [{}]\nother_supports = [{}]\n",
                    list(fitted),
                    list(chosen),
                    list(others)
                )
            })
        })
        .collect();
    let outcome = outcome(&[], &fits);
    let first = &outcome.fits[0];
    let mut rows = Vec::new();
    for (name, model) in
        [("finite elements", "finite elements"), ("springs on edges and patches", "exact edges patches")]
    {
        rows.push([vec![name.to_string(), "–".into()], errors(first, model)].concat());
    }
    for (fit, (name, (fitted, ..))) in
        outcome.fits.iter().zip(starts.iter().flat_map(|(name, _)| sets.iter().map(move |set| (name, set))))
    {
        rows.push([vec![name.to_string(), fitted.join(", ")], errors(fit, "fitted")].concat());
    }
    markdown(&["network", "fitted under", "left", "right", "front", "below"], &rows)
}

/// A fit of a table: what a program must hold, and the keys of its fits on tetrahedra and on hexahedra.
const PROGRAMS: [(&str, [&str; 2]); 5] = [
    ("springs and volume springs, of any sign", ["objective = \"exact\"", "objective = \"exact\"\nvolume = \"cells\""]),
    ("the same, and springs on several cells", ["objective = \"exact\"\nshear = \"edges\"\nvolume = \"patches\"", ""]),
    (
        "springs with the lengths of the mesh and volume springs, k ≥ 0",
        [
            "objective = \"divergence\"\nsprings = [\"all + volume\"]\nnonnegative = true",
            "objective = \"modal\"\nsprings = [\"all + volume\"]\nnonnegative = true",
        ],
    ),
    ("springs with the lengths of the mesh alone, k ≥ 0", ["objective = \"offdiag\"\nnonnegative = true"; 2]),
    (
        "the last but one, fitted as a whole to one object under one support",
        [
            "objective = \"whole\"\nstart = \"divergence\"\nsprings = [\"all + volume\"]",
            "objective = \"whole\"\nstart = \"modal\"\nsprings = [\"all + volume\"]",
        ],
    ),
];

/// Loads in place of the scene's, none of which a fit has seen: pushes at the other end, a twist, and a body force that grows along the body.
const GRAVITY: &str = "[[load]]\nname = \"gravity\"\nbody = [0, -10, 0]";
const LOADS: &str = "[[load]]\nname = \"push\"\nwhere = \"x > 0.045\"\nforce = [0, 0.01, 0]\n\
                     [[load]]\nname = \"lift\"\nwhere = \"x > 0.045\"\nforce = [0, 0, 0.01]\n\
                     [[load]]\nname = \"twist\"\nwhere = \"x > 0.045\"\ntraction = [0, \"-1e3*z\", \"1e3*y\"]\n\
                     [[load]]\nname = \"field\"\nbody = [0, \"1e3*x\", \"-1e3*x\"]\n";

/// Fits of single cells and of the whole, by what a program holds: the geometric mean of e_rms under four loads, beside quadratic elements on halved cells.
pub fn programs() -> String {
    let mut columns: Vec<Vec<String>> = Vec::new();
    for element in ["tet4", "hex8"] {
        let fits: Vec<&str> = PROGRAMS.iter().map(|(_, fits)| fits[usize::from(element == "hex8")]).collect();
        for poisson in ["0.3", "0.45"] {
            let text: String = fits
                .iter()
                .enumerate()
                .filter(|(_, keys)| !keys.is_empty())
                .map(|(i, keys)| format!("[[fit]]\nname = \"{i}\"\n{keys}\n"))
                .collect();
            let mesh =
                if element == "tet4" { "element = \"tet4\", boundary = \"smooth\"" } else { "element = \"hex8\"" };
            let changes = [
                (GRAVITY, LOADS),
                ("points = 1000", "points = 300"),
                ("element = \"tet4\", boundary = \"smooth\"", mesh),
                ("poisson = 0.45", &format!("poisson = {poisson}")),
                ("from = \"quadratic\"", "from = \"quadratic\"\nrefine = 1"),
            ];
            let found = outcome(&changes, &text);
            let mean = |errors: Vec<f64>| {
                let logarithms: f64 = errors.iter().map(|error| error.ln()).sum();
                format!("{:.2}", (logarithms / errors.len() as f64).exp())
            };
            let body = found.loads.iter().map(|load| load.measured.as_ref().unwrap().fem_e_rms.unwrap()).collect();
            let mut column = vec![mean(body)];
            for i in 0..PROGRAMS.len() {
                let fit = found.fits.iter().find(|fit| fit.fit.name == i.to_string());
                column.push(
                    fit.map_or("–".into(), |fit| {
                        mean(fit.loads.iter().map(|load| load.error.unwrap().rms).collect())
                    }),
                );
            }
            columns.push(column);
        }
    }
    let names = std::iter::once("finite elements of the mesh").chain(PROGRAMS.iter().map(|(name, _)| *name));
    let row = |(i, name): (usize, &str)| {
        std::iter::once(name.to_string()).chain(columns.iter().map(|column| column[i].clone())).collect()
    };
    let rows: Vec<Vec<String>> = names.enumerate().map(row).collect();
    let header =
        ["your program holds", "tetrahedra, ν 0.3", "tetrahedra, ν 0.45", "hexahedra, ν 0.3", "hexahedra, ν 0.45"];
    markdown(&header, &rows)
}
