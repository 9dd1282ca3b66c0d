//! Networks as data files of LAMMPS: atoms, and harmonic bonds.

use super::file::{SpecimenFile, SpecimenOptions};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, Network, Specimen};
use nalgebra::DMatrix;
use std::collections::HashMap;

/// The sections of a data file that are read; those of others are left out.
const SECTIONS: [&str; 4] = ["Masses", "Bond Coeffs", "Atoms", "Bonds"];
/// The sections of a data file that are known.
const OTHERS: [&str; 18] = [
    "Velocities",
    "Angles",
    "Dihedrals",
    "Impropers",
    "Pair Coeffs",
    "PairIJ Coeffs",
    "Angle Coeffs",
    "Dihedral Coeffs",
    "Improper Coeffs",
    "Ellipsoids",
    "Lines",
    "Triangles",
    "Bodies",
    "Atom Type Labels",
    "Bond Type Labels",
    "BondBond Coeffs",
    "BondAngle Coeffs",
    "MiddleBondTorsion Coeffs",
];
/// Where the coordinates of an atom stand after its number, by the style of the atoms: type and molecule come before them.
const STYLES: [(&str, usize, usize); 5] =
    [("atomic", 1, 2), ("bond", 2, 3), ("molecular", 2, 3), ("angle", 2, 3), ("full", 2, 4)];
/// A bond is shorter by an image if it is by more than this share. In a box of two cells a bond and its image are
/// equally long, and rounding must not choose between them.
const SHORTER: f64 = 1e-9;

/// The sections of [`OTHERS`] that hold forces, which the network has not.
const FORCES: [&str; 5] = ["Angles", "Dihedrals", "Impropers", "Pair Coeffs", "PairIJ Coeffs"];
/// A mole has this number of particles, exactly.
const MOLE: f64 = 6.022_140_76e23;
/// J in an electron volt, exactly.
const ELECTRON_VOLT: f64 = 1.602_176_634e-19;
/// The units of LAMMPS, as a header names them: a length in m, an energy in J and a mass in kg.
const UNITS: [(&str, [f64; 3]); 8] = [
    // Reduced ones have no size.
    ("lj", [1.0, 1.0, 1.0]),
    ("si", [1.0, 1.0, 1.0]),
    ("cgs", [1e-2, 1e-7, 1e-3]),
    // Ångström, kilocalories and grams for each mole; a calorie is 4.184 J.
    ("real", [1e-10, 4184.0 / MOLE, 1e-3 / MOLE]),
    ("metal", [1e-10, ELECTRON_VOLT, 1e-3 / MOLE]),
    // Bohr radii, hartrees and atomic mass units (CODATA 2018).
    ("electron", [5.291_772_109_03e-11, 4.359_744_722_207_1e-18, 1.660_539_066_60e-27]),
    ("micro", [1e-6, 1e-15, 1e-15]),
    ("nano", [1e-9, 1e-21, 1e-21]),
];
/// A line with its number.
type Line<'a> = (usize, Vec<&'a str>);

/// The file in parts.
#[derive(Default)]
struct Parts<'a> {
    /// Low and high of each axis.
    bounds: [Option<[f64; 2]>; 3],
    /// xy, xz, yz.
    tilt: [f64; 3],
    sections: HashMap<&'static str, Vec<Line<'a>>>,
    /// How many atoms and bonds the header promises, and on which line.
    promised: HashMap<&'static str, (usize, usize)>,
    /// The sections that hold forces and are left out, and how many lines they have.
    left_out: Vec<(&'static str, usize)>,
    /// What is said of a section after `#`.
    styles: HashMap<&'static str, &'a str>,
}

pub fn read(bytes: &[u8], options: &SpecimenOptions) -> Result<SpecimenFile> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::new("expected a text").of_kind(ErrorKind::Syntax))?;
    let parts = parse(text)?;
    let (units, [length, energy, mass]) = units(text)?;
    let ids = |lines: &[Line]| -> Result<HashMap<i64, usize>> {
        let mut ids = HashMap::new();
        for (at, line) in lines.iter().enumerate() {
            let number = integer(line, 0, "number")?;
            if ids.insert(number, at).is_some() {
                return Err(Error::expected("Atoms", "a number of its own for each atom", number).on_line(line.0));
            }
        }
        Ok(ids)
    };
    let section = |name: &'static str| parts.sections.get(name).map(Vec::as_slice).unwrap_or_default();
    let (atoms, bonds) = (section("Atoms"), section("Bonds"));
    if atoms.is_empty() || bonds.is_empty() {
        let expected = "sections Atoms and Bonds, as read_data of LAMMPS reads them";
        let found = format!("{} atoms and {} bonds", atoms.len(), bonds.len());
        return Err(Error::expected("data file", expected, found).of_kind(ErrorKind::Syntax));
    }
    for (name, lines) in [("Atoms", atoms), ("Bonds", bonds)] {
        if let Some(&(count, line)) = parts.promised.get(name).filter(|(count, _)| *count != lines.len()) {
            let expected = format!("{count} lines, as line {line} says");
            return Err(Error::expected(name, expected, lines.len()).of_kind(ErrorKind::Syntax));
        }
    }
    let (kind_at, x_at) = style(&parts, atoms)?;
    let mut positions = Vec::with_capacity(3 * atoms.len());
    let mut moved = Vec::with_capacity(3 * atoms.len());
    for line in atoms {
        for k in 0..3 {
            positions.push(real(line, x_at + k, "Atoms")?);
        }
        // Image flags stand after the coordinates: the box in which the atom is.
        for k in 0..3 {
            let has_flags = line.1.len() >= x_at + 6;
            moved.push(if has_flags { integer(line, x_at + 3 + k, "Atoms")? } else { 0 });
        }
    }
    let masses = masses(&parts, atoms, kind_at)?;
    let places = ids(atoms)?;
    let coefficients: HashMap<i64, [f64; 2]> = section("Bond Coeffs")
        .iter()
        .map(|line| {
            // With hybrid styles the name of the style stands first.
            let first = if line.1.get(1).is_some_and(|word| word.parse::<f64>().is_err()) { 2 } else { 1 };
            if first == 2 && line.1[1] != "harmonic" {
                let expected = "bonds of the style harmonic";
                return Err(Error::expected("Bond Coeffs", expected, line.1[1])
                    .on_line(line.0)
                    .of_kind(ErrorKind::Unsupported));
            }
            Ok((
                integer(line, 0, "Bond Coeffs")?,
                [real(line, first, "Bond Coeffs")?, real(line, first + 1, "Bond Coeffs")?],
            ))
        })
        .collect::<Result<_>>()?;
    if let Some(name) = parts.styles.get("Bond Coeffs").filter(|name| !matches!(**name, "harmonic" | "hybrid")) {
        return Err(Error::expected("Bond Coeffs", "bonds of the style harmonic", name).of_kind(ErrorKind::Unsupported));
    }
    let is_plane = positions.iter().skip(2).step_by(3).all(|z| *z == positions[2]);
    let d = if is_plane { 2 } else { 3 };
    let cell = cell(&parts, d);
    let is_unwrapped = moved.iter().any(|n| *n != 0);
    let mut points = Vec::with_capacity(d * atoms.len());
    for (x, n) in positions.chunks_exact(3).zip(moved.chunks_exact(3)) {
        let shift = |k: usize| cell.as_ref().map_or(0.0, |cell| (0..d).map(|l| n[l] as f64 * cell[(l, k)]).sum());
        points.extend((0..d).map(|k| length * (x[k] + shift(k))));
    }
    let mut network = Network { dimension: d, ..Network::default() };
    for line in bonds {
        let kind = integer(line, 1, "Bonds")?;
        let ends = [integer(line, 2, "Bonds")?, integer(line, 3, "Bonds")?];
        let missing = |what: &str, number: i64| Error::expected("Bonds", what, number).on_line(line.0);
        let [stiffness, rest] = *coefficients.get(&kind).ok_or_else(|| missing("a type with Bond Coeffs", kind))?;
        let [i, j] =
            ends.map(|number| places.get(&number).copied().ok_or_else(|| missing("the number of an atom", number)));
        let (i, j) = (i?, j?);
        if i == j {
            return Err(missing("two atoms", ends[0]));
        }
        // U = K (r − r₀)².
        let constant = 2.0 * stiffness * energy / (length * length);
        network.lengths.push(LengthSpring { points: [i.min(j), i.max(j)], constant, rest: length * rest });
    }
    let cell = cell.map(|cell| cell * length);
    let masses = masses.map(|masses| masses.into_iter().map(|own| mass * own).collect());
    let specimen = Specimen { masses, ..Specimen::new(network, points) };
    let mut notes = vec![match units {
        None => "the first line of the file names no units: they are taken as si, m, N and kg".to_string(),
        Some("lj") => {
            "the units of the file are reduced ones (lj): figures are in them, whatever unit is printed".to_string()
        }
        Some("si") => "the units of the file are si".to_string(),
        Some(units) => {
            format!("the units of the file are {units}: lengths, energies and masses are turned into m, J and kg")
        }
    }];
    if !parts.left_out.is_empty() {
        let one = |(name, lines): &(&str, usize)| format!("{name} ({lines} lines)");
        let names: Vec<String> = parts.left_out.iter().map(one).collect();
        notes.push(format!("the network has the bonds alone; left out with their forces: {}", names.join(", ")));
    }
    // Image flags have already put the atoms where bonds are whole.
    let crosses = !is_unwrapped && cell.as_ref().is_some_and(|cell| has_shorter_images(&specimen, cell));
    let is_periodic = options.is_periodic.unwrap_or(crosses) && options.cell.is_none();
    let specimen = match cell {
        Some(cell) if is_periodic => {
            notes.push("the network repeats itself with the box of the file".to_string());
            specimen.repeated(cell)?
        }
        None if options.is_periodic == Some(true) => {
            return Err(Error::expected(
                "box",
                "bounds xlo xhi, ylo yhi, zlo zhi of a network that repeats itself",
                "none",
            ));
        }
        _ if crosses => {
            notes.push("bonds cross the box of the file, with which the network does not repeat itself".to_string());
            specimen
        }
        _ => {
            notes.push("no bond crosses the box of the file: the network is a body".to_string());
            specimen
        }
    };
    Ok(SpecimenFile { notes, ..SpecimenFile::plain(specimen, "LAMMPS, a data file") })
}

/// Whether a bond is shorter through a side of the box.
fn has_shorter_images(specimen: &Specimen, cell: &DMatrix<f64>) -> bool {
    let d = specimen.network.dimension;
    let Some(inverse) = cell.clone().try_inverse() else { return false };
    specimen.network.lengths.iter().any(|spring| {
        let [a, b] = spring.points.map(|p| &specimen.points[p * d..(p + 1) * d]);
        let between = DMatrix::from_fn(1, d, |_, k| b[k] - a[k]);
        let shift = (&between * &inverse).map(|n| -n.round());
        (&between + shift * cell).norm() < (1.0 - SHORTER) * between.norm()
    })
}

fn parse(text: &str) -> Result<Parts<'_>> {
    let mut parts = Parts::default();
    let mut section: Option<&'static str> = None;
    // The first line is a title.
    for (at, line) in text.lines().enumerate().skip(1) {
        let (content, comment) = line.split_once('#').unwrap_or((line, ""));
        let words: Vec<&str> = content.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let name = content.trim();
        if let Some(own) = SECTIONS.iter().find(|own| **own == name) {
            section = Some(own);
            parts.styles.extend(comment.split_whitespace().next().map(|style| (*own, style)));
            parts.sections.entry(own).or_default();
            continue;
        }
        if let Some(own) = OTHERS.iter().find(|own| **own == name) {
            section = Some(own);
            if FORCES.contains(own) {
                parts.left_out.push((own, 0));
            }
            continue;
        }
        match section {
            Some(own) if OTHERS.contains(&own) => {
                parts.left_out.iter_mut().filter(|(name, _)| *name == own).for_each(|(_, lines)| *lines += 1);
            }
            Some(own) => parts.sections.entry(own).or_default().push((at + 1, words)),
            None => header(&mut parts, &(at + 1, words))?,
        }
    }
    Ok(parts)
}

/// The units that the first line of a file names as `units = real` or `units real`, with their length in m, energy in J and mass in kg.
fn units(text: &str) -> Result<(Option<&'static str>, [f64; 3])> {
    let title = text.lines().next().unwrap_or_default();
    let words: Vec<&str> =
        title.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty()).collect();
    let Some(named) = words.iter().position(|word| *word == "units").and_then(|at| words.get(at + 1)) else {
        return Ok((None, [1.0; 3]));
    };
    match UNITS.iter().find(|(name, _)| name == named) {
        Some((name, factors)) => Ok((Some(name), *factors)),
        None => {
            let names: Vec<&str> = UNITS.iter().map(|(name, _)| *name).collect();
            let expected = format!("one of {}", names.join(", "));
            Err(Error::expected("units", expected, named).on_line(1).of_kind(ErrorKind::Unsupported))
        }
    }
}

fn header(parts: &mut Parts, line: &Line) -> Result<()> {
    let words = &line.1;
    let axis = ["xlo", "ylo", "zlo"].iter().position(|name| words.get(2) == Some(name));
    if let Some(axis) = axis {
        parts.bounds[axis] = Some([real(line, 0, "box")?, real(line, 1, "box")?]);
    }
    if let [count, what @ ("atoms" | "bonds")] = words[..] {
        let name = if what == "atoms" { "Atoms" } else { "Bonds" };
        let wrong = || Error::expected(what, "a whole number", format!("\"{count}\"")).on_line(line.0);
        parts.promised.insert(name, (count.parse().map_err(|_| wrong())?, line.0));
    }
    if words.get(3) == Some(&"xy") {
        for k in 0..3 {
            parts.tilt[k] = real(line, k, "tilt")?;
        }
    }
    if words.contains(&"avec") {
        let error = Error::expected("box", "a box with xlo xhi, and xy xz yz of a tilted one", "a general one");
        return Err(error.on_line(line.0).of_kind(ErrorKind::Unsupported));
    }
    Ok(())
}

/// The vectors of the box: (lx, 0, 0), (xy, ly, 0), (xz, yz, lz).
fn cell(parts: &Parts, d: usize) -> Option<DMatrix<f64>> {
    let mut cell = DMatrix::zeros(3, 3);
    for k in 0..d {
        let [low, high] = parts.bounds[k]?;
        cell[(k, k)] = high - low;
    }
    [(1, 0), (2, 0), (2, 1)].into_iter().zip(parts.tilt).for_each(|(at, tilt)| cell[at] = tilt);
    let cell = cell.view((0, 0), (d, d)).into_owned();
    (0..d).all(|k| cell[(k, k)] > 0.0).then_some(cell)
}

/// Where the type and the coordinates of an atom stand on its line.
fn style(parts: &Parts, atoms: &[Line]) -> Result<(usize, usize)> {
    let named = parts.styles.get("Atoms").copied();
    // Without a name, molecular files of six words are of the style bond, or with nine of the same with image flags.
    let guessed = match atoms[0].1.len() {
        5 | 8 => "atomic",
        6 | 9 => "bond",
        7 | 10 => "full",
        _ => "",
    };
    let wanted = named.unwrap_or(guessed);
    STYLES.iter().find(|(name, ..)| *name == wanted).map(|(_, kind, x)| (*kind, *x)).ok_or_else(|| {
        let names: Vec<&str> = STYLES.iter().map(|(name, ..)| *name).collect();
        let expected = format!("atoms of one of the styles {}, named as in \"Atoms # bond\"", names.join(", "));
        let found = if wanted.is_empty() { format!("{} words", atoms[0].1.len()) } else { wanted.to_string() };
        Error::expected("Atoms", expected, found).on_line(atoms[0].0).of_kind(ErrorKind::Unsupported)
    })
}

fn masses(parts: &Parts, atoms: &[Line], kind_at: usize) -> Result<Option<Vec<f64>>> {
    let Some(lines) = parts.sections.get("Masses").filter(|lines| !lines.is_empty()) else { return Ok(None) };
    let of_kinds: HashMap<i64, f64> =
        lines.iter().map(|line| Ok((integer(line, 0, "Masses")?, real(line, 1, "Masses")?))).collect::<Result<_>>()?;
    let mass = |line: &Line| {
        let kind = integer(line, kind_at, "Atoms")?;
        let missing = || Error::expected("Atoms", "a type with a mass", kind).on_line(line.0);
        of_kinds.get(&kind).copied().ok_or_else(missing)
    };
    atoms.iter().map(mass).collect::<Result<Vec<f64>>>().map(Some)
}

fn real(line: &Line, at: usize, key: &str) -> Result<f64> {
    let text = line.1.get(at).copied().unwrap_or_default();
    let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
    number.ok_or_else(|| Error::expected(key, "a number", format!("\"{text}\"")).on_line(line.0))
}

fn integer(line: &Line, at: usize, key: &str) -> Result<i64> {
    let text = line.1.get(at).copied().unwrap_or_default();
    text.parse().map_err(|_| Error::expected(key, "a whole number", format!("\"{text}\"")).on_line(line.0))
}
