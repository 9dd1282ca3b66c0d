//! The norms on random shapes: `benches/norms.toml`, without times.

use super::{markdown, root};
use springfit_report::report::summarized;
use springfit_studies::study::{CaseRecord, Comparing};

/// The median error of each fit on each element, with its interval.
pub fn table() -> String {
    let path = root().join("benches/norms.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("[compare]\n", "[compare]\ntime = false\n");
    let comparing = Comparing::parse(&text, &path).unwrap();
    let records: Vec<CaseRecord> = comparing.cases().iter().map(|case| comparing.record(case, &mut |_| {})).collect();
    let summary = summarized("norms", &records);
    let names = ["tri3", "quad4", "tet4", "hex8"];
    let cell = |fit: &str, name: &str| {
        let object = summary.objects.iter().find(|object| object.fit == fit && object.name == name).unwrap();
        let told = object.error.unwrap();
        let interval = told.interval.unwrap();
        format!("{:.3} ({:.3} to {:.3})", told.quantiles.median, interval.low, interval.high)
    };
    let row = |fit: &&str| {
        let cells = names.iter().map(|name| cell(fit, name));
        std::iter::once(format!("`{fit}`")).chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = comparing.fit_names().iter().map(row).collect();
    markdown(&[&["fit"], &names[..]].concat(), &rows)
}
