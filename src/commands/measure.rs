//! `springfit measure`.

use super::output::OutputOptions;
use super::state::State;
use crate::terminal::Terminal;
use clap::Args;
use serde::Serialize;
use springfit_bodies::model::Specimen;
use springfit_element::material::Plane;
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_foundation::quantity::Quantity;
use springfit_foundation::symbolic::Scope;
use springfit_report::report::{
    self, NetworkFile, NetworkFormat, SpecimenFile, SpecimenOptions, read_specimen, specimen_endings,
};
use springfit_studies::study::{EngineEntry, MeasureOptions, MeasuredNetwork, NamedLattice, load_elements, measure};
use std::path::{Path, PathBuf};

/// Measure a network as a material: its elasticity tensor, density, stability, frequencies, longest step
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Measure {
    #[arg(help = format!("The network: {}", specimen_endings()), required_unless_present = "lattice", conflicts_with = "lattice")]
    network: Option<PathBuf>,
    /// A lattice by name, whose formulas are printed as well: triangular, square, honeycomb, kagome, cubic, bcc, fcc, diamond
    #[arg(long, help_heading = "Lattices")]
    lattice: Option<String>,
    /// The constants of the shells of a lattice in N/m, nearest neighbours first [default: 1]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, requires = "lattice", help_heading = "Lattices")]
    constants: Vec<f64>,
    /// The spacing a of a lattice, such as 2mm [default: 1 m]
    #[arg(long, allow_hyphen_values = true, requires = "lattice", help_heading = "Lattices")]
    spacing: Option<String>,
    /// Cells along each vector of a lattice, or one number for all: a piece of it is measured, in place of the whole, and may be written
    #[arg(long, value_delimiter = ',', requires = "lattice", help_heading = "Lattices")]
    cells: Vec<usize>,
    /// Where the piece of a lattice is written: .json, .npz, .csv or .vtu
    #[arg(short, long, requires = "cells", help_heading = "Lattices")]
    output: Option<PathBuf>,
    /// A table of points (columns x, y, z) for a table of springs
    #[arg(long, help_heading = "Network")]
    points: Option<PathBuf>,
    /// The vectors of the cell with which the network repeats itself in m, such as "1 0 0, 0 1 0, 0 0 1"
    #[arg(long, allow_hyphen_values = true, help_heading = "Network")]
    cell: Option<String>,
    /// The network of a LAMMPS file repeats itself with its box [default: if bonds cross it]
    #[arg(long, conflicts_with_all = ["body", "cell"], help_heading = "Network")]
    periodic: bool,
    /// The network of a LAMMPS file is a body, whatever its box is
    #[arg(long, help_heading = "Network")]
    body: bool,
    /// An element file to look in before the shipped ones; may be repeated
    #[arg(long, help_heading = "Network")]
    element: Vec<String>,
    /// The volume of a network without cells in m^3, in the plane its area in m^2
    #[arg(long, allow_hyphen_values = true, conflicts_with = "hull", help_heading = "Material")]
    volume: Option<f64>,
    /// The volume is that of the convex hull of the points
    #[arg(long, help_heading = "Material")]
    hull: bool,
    /// Measure a part of the network as well: a name, and a condition of x, y and z, such as "core = x^2 + y^2 < 1e-4"; may be repeated
    #[arg(long, value_name = "NAME=CONDITION", help_heading = "Material")]
    region: Vec<String>,
    /// Plane network: stress or strain [default: what the file says, or stress]
    #[arg(long, help_heading = "Material")]
    plane: Option<State>,
    /// Plane network: thickness such as "0.5 mm" [default: what the file says, or 1 m]
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    thickness: Option<String>,
    /// Density such as "1060 kg/m^3" of a network without masses
    #[arg(long, allow_hyphen_values = true, help_heading = "Material")]
    density: Option<String>,
    /// So many frequencies are sought
    #[arg(long, default_value_t = 6, help_heading = "Motion")]
    frequencies: usize,
    /// An engine whose limit is sought: a name such as jolt, or its settings such as '{ method = "xpbd", substeps = 20 }'
    #[arg(long, help_heading = "Motion")]
    engine: Option<String>,
    #[command(flatten)]
    format: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit measure springs.json
  springfit measure phystwin.npz --hull
  springfit measure data.lattice --periodic
  springfit measure springs.csv --points points.csv --volume 8e-6
  springfit measure --lattice cubic --constants 100,50 --spacing 2mm
  springfit measure --lattice fcc --cells 4,4,4 -o fcc.json
  springfit measure organ.json --engine jolt --region \"left = x < 0\"";

/// What is printed as JSON.
#[derive(Serialize)]
struct Record<'a> {
    format: &'static str,
    notes_of_file: &'a [String],
    #[serde(flatten)]
    measured: &'a MeasuredNetwork,
}

impl Measure {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let mut written = Vec::new();
        let mut volume = self.volume;
        let (title, formulas, file) = match (&self.lattice, &self.network) {
            (Some(name), _) => {
                let lattice = NamedLattice::named(name).map_err(|e| e.at_key("--lattice"))?;
                let constants = if self.constants.is_empty() { vec![1.0] } else { self.constants.clone() };
                let spacing = self.length("--spacing", &self.spacing)?.unwrap_or(1.0);
                let closed = lattice.closed(constants.len().min(lattice.shells.len())).map_err(Error::of_option)?;
                let cells = match &self.cells[..] {
                    [all] => &vec![*all; lattice.dimension()],
                    cells => cells,
                };
                let specimen = if cells.is_empty() {
                    lattice.specimen(spacing, &constants)
                } else {
                    // A piece has the volume of its cells, unless another one is asked for.
                    let own = cells.iter().map(|n| *n as f64).product::<f64>() * lattice.content(spacing);
                    volume = volume.or((!self.hull).then_some(own));
                    lattice.piece(spacing, &constants, cells)
                };
                let specimen = specimen.map_err(Error::of_option)?;
                if let Some(path) = &self.output {
                    write(&specimen, path)?;
                    written.push(path.clone());
                }
                let file = SpecimenFile::of_lattice(specimen);
                (format!("{name} lattice, spacing {spacing} m"), report::lattice_text(lattice, &closed), file)
            }
            (None, Some(path)) => {
                let file = self.read(path)?;
                (format!("{} ({})", path.display(), file.format), String::new(), file)
            }
            (None, None) => unreachable!("the parser asks for one of both"),
        };
        let options = MeasureOptions { volume, ..self.options(&file)? };
        let of_file = |e: Error| match (&self.network, e.key()) {
            (_, Some("volume")) => e.followed_by(format!("; --volume or --hull says it{}", self.ranges())).of_option(),
            (Some(path), Some("springs")) if e.kind() == ErrorKind::Limit => {
                e.followed_by(self.ranges()).placed(|e| e.in_file(path))
            }
            (None, Some("springs")) if e.kind() == ErrorKind::Limit => e.followed_by(self.ranges()),
            (_, Some("density" | "plane" | "engine")) => e.of_option(),
            (Some(path), _) => e.placed(|e| e.in_file(path)),
            (None, _) => e,
        };
        let measured = measure(&file.specimen, &options).map_err(of_file)?;
        let record = Record { format: file.format, notes_of_file: &file.notes, measured: &measured };
        let text = || {
            let gap = if formulas.is_empty() { "" } else { "\n" };
            format!("{formulas}{gap}{}", report::measured_text(&title, &measured))
        };
        self.format.print(terminal, || &record, || report::measured_tables(&measured), text)?;
        if !self.format.json {
            file.notes.iter().for_each(|note| terminal.note(note));
        }
        terminal.written(&written)
    }

    fn read(&self, path: &Path) -> Result<SpecimenFile> {
        let options = SpecimenOptions {
            points: self.points.clone(),
            cell: self.cell.as_deref().map(vectors).transpose()?,
            is_periodic: match (self.periodic, self.body) {
                (true, _) => Some(true),
                (_, true) => Some(false),
                _ => None,
            },
            elements: load_elements(&self.element, Path::new("")).map_err(|e| e.placed(|e| e.at_key("--element")))?,
        };
        read_specimen(path, &options)
    }

    fn length(&self, key: &str, text: &Option<String>) -> Result<Option<f64>> {
        text.as_deref().map(|text| Quantity::Length.parse(text).map_err(|e| e.under(key))).transpose()
    }

    /// Names the given options whose numbers may make a stiffness or a volume overflow or vanish; empty if none is given.
    fn ranges(&self) -> String {
        let options = [
            ("--spacing", self.spacing.is_some()),
            ("--constants", !self.constants.is_empty()),
            ("--volume", self.volume.is_some()),
            ("--thickness", self.thickness.is_some()),
        ];
        let given: Vec<&str> = options.iter().filter_map(|(name, is_given)| is_given.then_some(*name)).collect();
        if given.is_empty() { String::new() } else { format!("; is {} in the right unit?", given.join(", ")) }
    }

    fn options(&self, file: &SpecimenFile) -> Result<MeasureOptions> {
        let d = file.specimen.network.dimension;
        let thickness = self.length("--thickness", &self.thickness)?;
        if let Some(thickness) = thickness.filter(|thickness| !(*thickness > 0.0 && thickness.is_finite())) {
            return Err(Error::expected("--thickness", "a length above zero", thickness));
        }
        if d != 2 && (self.plane.is_some() || thickness.is_some()) {
            let key = if thickness.is_some() { "--thickness" } else { "--plane" };
            return Err(Error::expected(key, "a plane network", format!("one of {d} dimensions")));
        }
        let state = MeasureOptions::plane_state(self.plane.map(Plane::from), thickness, file.state);
        let density =
            self.density.as_deref().map(|text| Quantity::Density.parse(text).map_err(|e| e.under("--density")));
        let engine = match &self.engine {
            Some(text) => Some(engine(text)?.setting().map_err(|e| e.under("--engine"))?),
            None => file.engine,
        };
        Ok(MeasureOptions {
            volume: self.volume,
            hull: self.hull,
            point_volumes: None,
            state: state.filter(|_| d == 2),
            regions: self.region.iter().map(|text| region(text, &file.specimen)).collect::<Result<_>>()?,
            frequencies: self.frequencies,
            engine,
            of_engine: file.engine,
            density: density.transpose()?,
        })
    }
}

/// Writes a network without cells, whose cells are its springs.
pub fn write(specimen: &Specimen, path: &Path) -> Result<()> {
    let format = NetworkFormat::of(path).map_err(|e| e.at_key("--output"))?;
    springfit_foundation::file::check_file(path)?;
    let mesh = specimen.bars()?;
    let file = NetworkFile::bare(&mesh, &specimen.network);
    format.write(path, &file)?;
    Ok(())
}

/// `1 0 0, 0 1 0, 0 0 1`.
fn vectors(text: &str) -> Result<nalgebra::DMatrix<f64>> {
    let wrong = || Error::expected("--cell", "vectors such as \"1 0 0, 0 1 0, 0 0 1\", m", format!("\"{text}\""));
    let row =
        |row: &str| row.split_whitespace().map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect();
    let rows: Vec<Vec<f64>> = text.split(',').map(row).collect::<Option<_>>().ok_or_else(wrong)?;
    if rows.iter().any(|row| row.len() != rows.len()) {
        return Err(wrong());
    }
    Ok(nalgebra::DMatrix::from_fn(rows.len(), rows.len(), |i, k| rows[i][k]))
}

/// A name, or a table of settings.
fn engine(text: &str) -> Result<EngineEntry> {
    let table = match text.trim_start().starts_with('{') {
        true => text.to_string(),
        false => format!("{{ method = {text:?} }}"),
    };
    let document = format!("engine = {table}");
    let mut read: std::collections::BTreeMap<String, EngineEntry> = toml::from_str(&document).map_err(|e| {
        let expected = "a name such as jolt, or settings such as { method = \"xpbd\", substeps = 20 }";
        Error::expected("--engine", expected, format!("\"{text}\"")).followed_by(format!(": {}", e.message()))
    })?;
    Ok(read.remove("engine").unwrap_or_default())
}

/// `NAME = CONDITION`: the own points where it holds.
fn region(text: &str, specimen: &Specimen) -> Result<(String, Vec<bool>)> {
    let expected = "a name and a condition, such as \"left = x < 0\"";
    let wrong = || Error::expected("--region", expected, format!("\"{text}\""));
    let (name, condition) = text.split_once('=').ok_or_else(wrong)?;
    let name = name.trim();
    if name.is_empty() || name.contains(['<', '>', '!']) || condition.starts_with('=') {
        return Err(wrong());
    }
    let condition = Scope::of_place(3).predicate(condition).map_err(|e| e.at_key("--region"))?;
    let d = specimen.network.dimension;
    let at = |p: usize| -> [f64; 3] { std::array::from_fn(|k| if k < d { specimen.points[p * d + k] } else { 0.0 }) };
    Ok((name.to_string(), (0..specimen.count()).map(|p| condition.holds(&at(p))).collect()))
}
