//! What is measured of a network, as tables and as text.

use super::table::Priority::Always;
use super::table::{Cell, Column, Digits, Table};
use crate::study::{Elasticity, MeasuredNetwork, strain_names};
use crate::text::{printable, printable_lines, rounded};
use std::fmt::Write;

/// Digits of moduli: those that single precision keeps.
const DIGITS: usize = 6;
/// An entry of a tensor below this share of the largest is rounding.
const ROUNDING: f64 = 1e-12;

/// The materials of a network, and the tensor of the last of them that is of the whole.
pub fn measured_tables(measured: &MeasuredNetwork) -> Vec<Table> {
    vec![materials(measured), tensor(measured)]
}

fn materials(measured: &MeasuredNetwork) -> Table {
    let unit = "Pa";
    let axes = &["x", "y", "z"][..measured.dimension];
    let mut columns = vec![
        Column::words("material"),
        Column::numbers("volume"),
        Column::numbers("E").unit(unit).priority(Always),
        Column::numbers("ν").priority(Always),
    ];
    columns.extend(axes.iter().map(|axis| Column::numbers(format!("E along {axis}")).unit(unit).priority(Always)));
    columns.push(Column::numbers("Zener").priority(Always));
    columns.push(Column::numbers("anisotropy").unit("%").priority(Always));
    let row = |name: String, volume: f64, found: &Elasticity| {
        let number = |value: Option<f64>| Cell::number(value, Digits::Significant(DIGITS));
        let mut cells = vec![Cell::from(name), number(Some(volume)), number(found.young), number(found.poisson)];
        let along = |k: usize| found.young_along.as_ref().map(|along| along[k]);
        cells.extend((0..axes.len()).map(|k| number(along(k))));
        cells.push(number(found.zener));
        cells.push(Cell::percent(Some(found.anisotropy), Digits::Fixed(2)));
        cells
    };
    let mut rows = vec![row("affine".into(), measured.volume, &measured.affine)];
    rows.extend(measured.relaxed.as_ref().map(|found| row("relaxed".into(), measured.volume, found)));
    rows.extend(
        measured.regions.iter().map(|region| row(format!("affine, {}", region.name), region.volume, &region.affine)),
    );
    Table::new("materials", "The network as a material", columns, rows)
}

fn tensor(measured: &MeasuredNetwork) -> Table {
    let (name, found) = match &measured.relaxed {
        Some(found) => ("relaxed", found),
        None => ("affine", &measured.affine),
    };
    let names = strain_names(measured.dimension);
    // Kelvin's shears have a root of two.
    let names: Vec<String> = names
        .into_iter()
        .map(|name| if name.as_bytes()[0] == name.as_bytes()[1] { name } else { format!("√2 {name}") })
        .collect();
    let mut columns = vec![Column::words("C")];
    columns.extend(names.iter().map(|name| Column::numbers(name.clone()).unit("Pa")));
    let largest = found.stiffness.iter().flatten().fold(0.0f64, |largest, c| largest.max(c.abs()));
    let number = |c: &f64| {
        let c = if c.abs() <= ROUNDING * largest { 0.0 } else { *c };
        Cell::number(Some(c), Digits::Significant(DIGITS))
    };
    let rows = found.stiffness.iter().zip(&names).map(|(row, name)| {
        std::iter::once(Cell::from(name.clone())).chain(row.iter().map(number)).collect::<Vec<Cell>>()
    });
    Table::new("tensor", format!("The elasticity tensor, {name}, in Kelvin's notation"), columns, rows)
}

/// What is measured of a network that `title` names.
pub fn measured_text(title: &str, measured: &MeasuredNetwork) -> String {
    let mut text = String::new();
    let mut line = |words: String| writeln!(text, "{}", printable(&words)).expect("a String grows");
    let negative = match measured.negative_springs {
        0 => "none negative".into(),
        count => format!("{count} negative"),
    };
    line(format!("{title}: {} points, {} springs, {negative}", measured.points, measured.springs));
    // What spoils all that follows stands first.
    if measured.tension.as_ref().is_some_and(|tension| tension.springs > 0) {
        measured.notes.iter().filter(|note| is_of_tension(note)).for_each(|note| line(note.clone()));
    }
    let number = |value: f64| rounded(value, DIGITS);
    let of = match measured.volume_of.as_str() {
        "given" => "given".to_string(),
        "hull" => "of the convex hull".to_string(),
        of => format!("of the {of}"),
    };
    let mass = measured.mass.map_or(String::new(), |mass| format!(", mass {} kg", number(mass)));
    let density = measured.density.map_or(String::new(), |density| format!(", density {} kg/m^3", number(density)));
    line(format!("volume {} m^3, {of}{mass}{density}", number(measured.volume)));
    text += &format!("\n{}\n{}\n", materials(measured).text(), tensor(measured).titled_text());
    let mut line = |words: String| writeln!(text, "{}", printable_lines(&words)).expect("a String grows");
    line(stability(measured));
    if let Some(frequencies) = &measured.frequencies {
        let all: Vec<String> = frequencies.iter().map(|f| rounded(*f, 5)).collect();
        line(format!("lowest frequencies: {} Hz", all.join(", ")));
    }
    if let Some(step) = measured.longest_step {
        line(format!("longest stable explicit step: {step:.4e} s, without damping"));
    }
    measured.notes.iter().filter(|note| !is_of_tension(note)).for_each(|note| line(note.clone()));
    text
}

/// Notes of springs that pull at rest.
fn is_of_tension(note: &str) -> bool {
    note.contains("pull at rest")
}

fn stability(measured: &MeasuredNetwork) -> String {
    let found = &measured.stability;
    let count = |n: usize, one: &str, more: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {more}") };
    let rigid = match found.rigid {
        0 => "no rigid motion is left free".to_string(),
        n => count(n, "rigid motion is left free", "rigid motions are left free"),
    };
    let least = if found.is_complete { "" } else { "at least " };
    let motion = if measured.volume_of == "period" { "motion in its period" } else { "motion that deforms it" };
    let motions = if measured.volume_of == "period" { "motions in its period" } else { "motions that deform it" };
    let nothing = |n: usize| count(n, &format!("{motion} meets"), &format!("{motions} meet"));
    let releases = |n: usize| count(n, &format!("{motion} releases"), &format!("{motions} release"));
    let verdict = match (found.releasing, found.mechanisms) {
        (0, 0) => format!("stable: every {motion} meets resistance; {rigid}"),
        (0, n) => format!("not stiff: {least}{} no resistance; {rigid}", nothing(n)),
        (n, 0) => format!("unstable: {least}{} energy; {rigid}", releases(n)),
        (n, m) => format!("unstable: {least}{} energy, and {} no resistance; {rigid}", releases(n), nothing(m)),
    };
    let material = measured.relaxed.as_ref().unwrap_or(&measured.affine);
    let releasing = material.releasing_strains();
    let nothing = material.soft_strains.saturating_sub(releasing);
    let strains = |n: usize, one: &str, more: &str| {
        count(n, &format!("uniform strain {one}"), &format!("uniform strains {more}"))
    };
    // A network whose cells give way together is not stable, whatever each of them does.
    let verdict = if material.soft_strains > 0 { verdict.trim_start_matches("stable: ") } else { &verdict };
    let mut lines = vec![verdict.to_string()];
    if releasing > 0 {
        lines.push(format!("unstable: {} energy", strains(releasing, "releases", "release")));
    }
    if nothing > 0 {
        lines.push(format!("not stiff: {} no resistance", strains(nothing, "meets", "meet")));
    }
    lines.join("\n")
}
