//! What was modelled, and the tables of a run on the terminal.

use super::json::Report;
use super::linear_theory::distrust;
use super::motion::motion_distrust;
use super::quality::{changes, counted, quality_lines};
use super::table::{Table, run_text};
use crate::material::RegionMaterial;
use crate::study::{BodyLoad, Followed, Outcome, Reading, Standard};
use crate::text::printable;
use std::fmt::Write;

/// The mesh, the size of the body and the material.
pub(super) fn summary_line(outcome: &Outcome) -> String {
    let mesh = &outcome.mesh;
    let cells: Vec<_> = mesh.blocks.iter().map(|b| format!("{} {}", b.cells().len(), b.element.name)).collect();
    format!(
        "{} points, {}, {}; {}{}",
        mesh.node_count(),
        cells.join(", "),
        size(&mesh.extent()),
        material_words(outcome),
        outcome.law.as_ref().map_or(String::new(), |law| format!(", {law}"))
    )
}

/// The material, or the number of regions with their own.
fn material_words(outcome: &Outcome) -> String {
    match &outcome.material.by_region(outcome.mesh.cell_count())[..] {
        [one] => region_words(one),
        regions => format!("{} materials", regions.len()),
    }
}

/// The material of a region in words, such as `E = 1000 to 5000 Pa, nu = 0.3`.
fn region_words(region: &RegionMaterial) -> String {
    let words = |[least, largest]: [Option<f64>; 2]| match (least, largest) {
        (Some(least), Some(largest)) if least == largest => format!("{least}"),
        (Some(least), Some(largest)) => format!("{} to {}", short(least), short(largest)),
        _ => "-".into(),
    };
    match region.young {
        [None, None] => "anisotropic".into(),
        _ => format!("E = {} Pa, nu = {}", words(region.young), words(region.poisson)),
    }
}

/// Four digits: ends of a range are seldom round numbers.
fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    match value {
        0.0 => "0".into(),
        _ if (-3.0..6.0).contains(&exponent) => {
            let text = format!("{value:.*}", (3.0 - exponent).max(0.0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').into(),
                false => text,
            }
        }
        _ => format!("{value:.3e}"),
    }
}

/// What was modelled, in a few lines.
pub fn summary(outcome: &Outcome) -> String {
    let mesh = &outcome.mesh;
    let given =
        if outcome.settings.is_empty() { String::new() } else { format!(" with {}", outcome.settings.join(", ")) };
    let distrusted = distrust(outcome).into_iter().chain(motion_distrust(outcome));
    let mut text: String = distrusted.map(|words| format!("{}\n", printable(&words))).collect();
    text += &format!("{}\n{}\n", printable(&(outcome.scene.clone() + &given)), summary_line(outcome));
    for line in changes(mesh) {
        writeln!(text, "{line}").expect("a String grows");
    }
    if let Some(numbering) = mesh.numbering.as_ref().filter(|numbering| !numbering.is_contiguous()) {
        let title = numbering.title();
        writeln!(
            text,
            "in the output, \"points\" are indices from 0 and \"nodes\" are the numbers of the mesh file: {title}"
        )
        .expect("a String grows");
    }
    for region in outcome.material.by_region(mesh.cell_count()) {
        if let Some(name) = &region.region {
            let cells = counted(region.cells, "cell");
            writeln!(text, "material of {}: {}, {cells}", printable(name), region_words(&region))
                .expect("a String grows");
        }
    }
    for line in quality_lines(&mesh.quality) {
        writeln!(text, "{line}").expect("a String grows");
    }
    text
}

/// The sizes along the axes, such as `0.120 x 0.075 x 0.062 m`: the largest has three digits.
pub(super) fn size(extent: &[f64]) -> String {
    let largest = extent.iter().fold(0.0, |largest: f64, x| largest.max(*x));
    let decimals = (2.0 - largest.log10().floor()).clamp(0.0, 9.0) as usize;
    // A thin body keeps two digits of its thickness.
    let own = |x: f64| if x > 0.0 { (1.0 - x.log10().floor()).clamp(0.0, 9.0) as usize } else { 0 };
    let along = |x: &f64| match largest {
        1e-4..1e6 => format!("{x:.*}", if *x < 0.1 * largest { decimals.max(own(*x)) } else { decimals }),
        _ => format!("{x:.2e}"),
    };
    format!("{} m", extent.iter().map(along).collect::<Vec<_>>().join(" x "))
}

/// The tables of a run. Where a page has an overview alone, see [`set_page`](super::set_page), it is one row for each fit; then come the tables of
/// what else was asked for, such as natural frequencies and motions.
pub fn tables(outcome: &Outcome) -> String {
    let mut tables = Table::all(&Report::of(outcome));
    let mut sentences: Vec<String> =
        largest(outcome).into_iter().chain(pressures(outcome)).chain(gauge(outcome)).collect();
    if let Some(first) = tables.first_mut() {
        first.notes.append(&mut sentences);
    }
    run_text(&tables) + &sentences.iter().map(|sentence| sentence.clone() + "\n").collect::<String>()
}

/// The gauge's readings of the finite elements.
fn gauge(outcome: &Outcome) -> Vec<String> {
    let line = |load: &BodyLoad| {
        let Reading { young, poisson } = load.reading()?;
        Some(format!(
            "Gauge reading of the finite elements under {}: E = {young:.4e} Pa, nu = {poisson:.3}.",
            load.name
        ))
    };
    outcome.loads.iter().filter_map(line).collect()
}

/// The pressures in cavities that are filled to a given volume.
fn pressures(outcome: &Outcome) -> Vec<String> {
    let words = |followed: Option<Followed>, name: &str| {
        let followed = followed?;
        let passed = followed.pressure_passed.map_or(String::new(), |most| format!(", after {most:.4e}"));
        Some(format!("{:.4e} Pa{passed} ({name})", followed.pressure?))
    };
    let line = |(i, load): (usize, &BodyLoad)| {
        let fits = outcome.fits.iter().filter_map(|fit| words(fit.loads.get(i)?.followed, &fit.fit.name));
        let all: Vec<String> = words(load.followed, "finite elements").into_iter().chain(fits).collect();
        (!all.is_empty()).then(|| format!("Pressure in the cavity under {}: {}.", load.name, all.join("; ")))
    };
    outcome.loads.iter().enumerate().filter_map(line).collect()
}

/// How far the finite elements move under the loads that they reach, and what errors are relative to, which percentages hide.
fn largest(outcome: &Outcome) -> Option<String> {
    let size = outcome.mesh.longest_side();
    let moved = |load: &BodyLoad| {
        let most = load.largest_displacement(&outcome.mesh);
        let known = load.measured.as_ref().and_then(|measured| Some((measured.standard, measured.largest?)));
        let known = known.map_or(String::new(), |(standard, most)| {
            let of = if standard == Standard::Measurement { "measured" } else { standard.words() };
            format!("; {most:.3e} m {of}")
        });
        format!("{} {most:.3e} m ({:.2} % of the body{known})", load.name, 100.0 * most / size)
    };
    let loads: Vec<String> = outcome.loads.iter().filter(|load| load.is_reached()).map(moved).collect();
    (!loads.is_empty()).then(|| format!("Largest displacement of the finite elements: {}.", loads.join(", ")))
}
