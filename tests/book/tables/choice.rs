//! Tables behind the choice of a fit.

use super::{all_groups, fit, markdown, outcome, scene, signed};
use springfit_bodies::solve::Standing;
use springfit_studies::study::{Convergence, FitEntry, converge};
use std::process::Command;

/// By element: the geometric mean of e_rms over the loads of its scenes, from `examples/defaults.rs`.
pub fn elements() -> String {
    // Examples are built beside the tests.
    let own = std::env::current_exe().unwrap();
    let example = own.parent().unwrap().parent().unwrap().join("examples/defaults");
    let output = Command::new(example).current_dir(super::root()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    // Element, fit, mean, worst, unstable networks.
    let parsed = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let n = words.len();
        (words[0].to_string(), words[1..n - 3].join(" "), words[n - 3].to_string(), words[n - 1].to_string())
    };
    let all: Vec<_> = text.lines().skip(1).map(parsed).collect();
    let columns = [
        "frobenius",
        "offdiag k>=0",
        "spectral",
        "modal 0.316 k>=0 with bulk",
        "divergence 0.25",
        "divergence 0.25 with bulk",
    ];
    let mut rows = Vec::new();
    for element in ["hex8", "quad4", "tet4", "tri3"] {
        let own: Vec<_> = all.iter().filter(|(name, ..)| name == element).collect();
        let mut row = vec![element.to_string()];
        for column in columns {
            let (_, _, mean, unstable) = own.iter().find(|(_, fit, ..)| fit == column).unwrap();
            row.push(if unstable == "0" { mean.clone() } else { format!("{mean} †") });
        }
        let stable = own.iter().filter(|(.., unstable)| unstable == "0");
        let best = stable.min_by(|a, b| a.2.parse::<f64>().unwrap().total_cmp(&b.2.parse::<f64>().unwrap())).unwrap();
        row.push(format!("{}: `{}`", best.2, best.1));
        rows.push(row);
    }
    let header = [
        "element",
        "`frobenius`",
        "`offdiag`, k ≥ 0",
        "`spectral`",
        "`modal` + bulk, k ≥ 0",
        "`divergence`",
        "`divergence` + bulk",
        "best that is always stable",
    ];
    markdown(&header, &rows)
}

fn against_truth(convergence: &Convergence, load: usize, model: usize) -> Vec<String> {
    let load = &convergence.loads[load];
    load.of_truth(&load.models[model]).into_iter().map(|error| signed(error.unwrap(), 1)).collect()
}

/// The block of tetrahedra, halved twice.
pub fn block() -> String {
    let convergence = converge(&scene("converge/block_tet"), Some(3), &mut |_| {}).unwrap();
    let names: Vec<String> = convergence.loads[0].models.iter().map(|model| model.name.clone()).collect();
    let row = |(model, name): (usize, &String)| {
        let [tension, shear] = [0, 1].map(|load| against_truth(&convergence, load, model));
        let cells = tension.iter().zip(&shear).map(|(tension, shear)| format!("{tension} / {shear}"));
        std::iter::once(format!("`{name}`")).chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = names.iter().enumerate().map(row).collect();
    markdown(&["fit", "2³ cubes", "4³", "8³"], &rows)
}

/// Networks of the cylinder of hexahedra whose modal weight is too small, without and with a bound.
pub fn indefinite() -> String {
    let cylinder = scene("cylinder_hex");
    let groups = all_groups(&cylinder);
    let mut fits = Vec::new();
    for higher in [0.316, 0.1] {
        for bounded in [false, true] {
            let entry = FitEntry::new("modal").with_springs(groups.clone()).with("higher", Some(higher));
            fits.push(fit(entry.with("nonnegative", bounded.then_some(true))));
        }
    }
    let outcome = outcome(&cylinder.with_fits(fits));
    let row = |(i, fit): (usize, &springfit_studies::study::FitOutcome)| {
        let errors = fit.loads.iter().map(|load| load.error.unwrap()).map(|e| format!("{:.2} / {:.2}", e.rms, e.max));
        let settings = [["0.316", "0.1"][i / 2], ["any k", "k ≥ 0"][i % 2]].map(String::from);
        let state = match fit.stability.as_ref().unwrap().standing {
            Standing::Stable => "stable",
            Standing::Soft => "near-mechanism",
            Standing::Indefinite => "indefinite",
            Standing::Singular => "mechanism",
        };
        settings.into_iter().chain(errors).chain([state.to_string()]).collect()
    };
    let rows: Vec<Vec<String>> = outcome.fits.iter().enumerate().map(row).collect();
    markdown(&["`higher`", "constants", "tension", "shear", "network"], &rows)
}
