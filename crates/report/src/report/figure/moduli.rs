//! Young's modulus of networks by direction, from their elasticity tensors.

use super::axis::{prefix, rings};
use super::palette::{COLORS, DASHES, REFERENCE, faded};
use super::run_folder::RunFolder;
use super::sheet::{Columns, cut, line, sheet, width, words};
use crate::error::{Error, Result};
use crate::report::fit_record::FitRecord;
use crate::report::json::Report;
use nalgebra::{DMatrix, DVector};
use plotters::style::RGBColor;
use svg::node::element::Circle;

/// Directions around a circle.
const DIRECTIONS: usize = 180;
/// Pixels around a panel and of a line of the legend.
const MARGIN: f64 = 16.0;
const LINE: f64 = 15.0;
const GRID: RGBColor = RGBColor(205, 205, 205);

/// Young's moduli by direction: a curve for each network in each of the coordinate planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Moduli {
    /// For readers of screens.
    pub title: String,
    /// The axes of each plane: one of plane bodies, three of solids.
    pub planes: Vec<[usize; 2]>,
    /// The networks.
    pub curves: Vec<ModulusCurve>,
    /// The modulus of the material, Pa; `None` if it differs from cell to cell or with the direction.
    pub reference: Option<f64>,
}

/// The moduli of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct ModulusCurve {
    /// The name of the fit.
    pub name: String,
    /// The place of the fit in the run, by which its colour and its dashes are those of the other figures.
    pub place: usize,
    /// `[planes][directions]`, Pa, in even steps from the first axis of the plane.
    pub moduli: Vec<Vec<f64>>,
}

/// A line of the legend.
struct Entry {
    name: String,
    color: RGBColor,
    thick: f64,
    dashes: &'static [i32],
}

impl Moduli {
    /// Reads the moduli of all networks of a run, or of the one that is named.
    ///
    /// # Errors
    /// No network has a tensor whose inverse exists, or there is no network with the name.
    pub fn of(run: &RunFolder, fit: Option<&str>) -> Result<Moduli> {
        let report = run.report()?;
        let chosen = fit.map(|_| RunFolder::place(&report, fit)).transpose()?;
        let is_drawn = |(place, _): &(usize, &FitRecord)| chosen.is_none_or(|chosen| *place == chosen);
        let fits: Vec<(usize, &FitRecord)> = report.fits.iter().enumerate().filter(is_drawn).collect();
        let size = fits.first().map_or(0, |(_, fit)| fit.as_material.stiffness.nrows());
        let planes: Vec<[usize; 2]> = match size {
            6 => vec![[0, 1], [0, 2], [1, 2]],
            3 => vec![[0, 1]],
            1 => return Err(Error::new("the body consists of rods, whose modulus has one direction")),
            _ => return Err(Error::new("the run has no fit, so there are no moduli to draw")),
        };
        let thickness = thickness(&report)?;
        let curves: Vec<ModulusCurve> =
            fits.iter().filter_map(|&(place, fit)| curve(place, fit, &planes, thickness)).collect();
        if curves.is_empty() {
            let why = "some strain of each network meets no resistance or releases energy";
            return Err(Error::new(format!("there are no moduli to draw: {why}")));
        }
        let title = format!("{}: Young's modulus of the networks by direction", report.scene);
        Ok(Moduli { title, planes, curves, reference: reference(run, &report) })
    }

    /// Draws the text of an SVG file: a panel for each plane, in which the radius is the modulus.
    pub fn svg(&self, columns: Columns) -> String {
        let all = self.curves.iter().flat_map(|curve| curve.moduli.iter().flatten()).chain(&self.reference);
        let largest = all.copied().fold(0.0, f64::max);
        let width = f64::from(columns.pixels());
        // In one column the legend has the place of a fourth panel.
        let (across, beside) = match (self.planes.len(), columns) {
            (3, Columns::One) => (2, true),
            (3, Columns::Two) => (3, false),
            (_, Columns::One) => (2, true),
            (_, Columns::Two) => (3, true),
        };
        let side = width / f64::from(across);
        let rows = if self.planes.len() == 3 && across == 2 { 2.0 } else { 1.0 };
        let (corner, right) = match (beside, rows == 1.0) {
            (true, true) => ([side + 8.0, MARGIN], width),
            (true, false) => ([side + 8.0, side + MARGIN], width),
            (false, _) => ([MARGIN, side + 2.0], width - MARGIN),
        };
        let names = self.names(largest, corner, right, beside);
        let bottom = names.last().map_or(0.0, |(at, _)| at[1] + LINE + 4.0);
        let height = if beside { bottom.max(rows * side) } else { bottom };
        let mut document = sheet(columns, height, &self.title);
        for (i, plane) in self.planes.iter().enumerate() {
            let at = [(i % across as usize) as f64 * side, (i / across as usize) as f64 * side];
            document = self.panel(document, i, *plane, at, side, largest);
        }
        for ([left, top], Entry { name, color, thick, dashes }) in names {
            document = document
                .add(line(&[[left, top + 6.0], [left + 20.0, top + 6.0]], color, thick, dashes))
                .add(words(&name, [left + 26.0, top + 10.0], "start"));
        }
        document.to_string()
    }

    /// The names of all lines with their places: one below the other beside the panels, otherwise in rows.
    fn names(&self, largest: f64, corner: [f64; 2], right: f64, beside: bool) -> Vec<([f64; 2], Entry)> {
        let reference =
            self.reference.map(|_| Entry { name: "material".into(), color: REFERENCE, thick: 4.0, dashes: &[] });
        let curve = |curve: &ModulusCurve| Entry {
            name: cut(&curve.name, right - corner[0] - 30.0),
            color: COLORS[curve.place % COLORS.len()],
            thick: 1.8,
            dashes: DASHES[curve.place % DASHES.len()],
        };
        let ring = rings(largest).first().map(|ring| {
            let (factor, unit) = prefix(*ring);
            Entry { name: format!("every {} {unit}Pa", ring / factor), color: GRID, thick: 0.8, dashes: &[] }
        });
        let entries = reference.into_iter().chain(self.curves.iter().map(curve)).chain(ring);
        let mut at = corner;
        let place = |entry: Entry| {
            let own = 26.0 + width(&entry.name) + 14.0;
            if at[0] > corner[0] && (beside || at[0] + own > right) {
                at = [corner[0], at[1] + LINE];
            }
            let found = at;
            at[0] += own;
            (found, entry)
        };
        entries.map(place).collect()
    }

    /// A plane with its rings, the curves in it and the names of its axes.
    fn panel(
        &self,
        document: svg::Document,
        place: usize,
        plane: [usize; 2],
        [left, top]: [f64; 2],
        side: f64,
        largest: f64,
    ) -> svg::Document {
        let (centre, radius) = ([left + side / 2.0, top + side / 2.0], side / 2.0 - MARGIN);
        let scale = radius / largest;
        let at = |angle: f64, modulus: f64| {
            [centre[0] + scale * modulus * angle.cos(), centre[1] - scale * modulus * angle.sin()]
        };
        let mut document = document;
        for ring in rings(largest) {
            let circle = Circle::new().set("cx", centre[0]).set("cy", centre[1]).set("r", scale * ring);
            document =
                document.add(circle.set("fill", "none").set("stroke", faded(GRID, 0.0)).set("stroke-width", 0.8));
        }
        for angle in [0.0, std::f64::consts::FRAC_PI_2] {
            document = document.add(line(&[at(angle, -largest), at(angle, largest)], GRID, 0.8, &[]));
        }
        if let Some(young) = self.reference {
            document = document.add(line(&around(&vec![young; DIRECTIONS], at), REFERENCE, 4.0, &[]));
        }
        for curve in &self.curves {
            let i = curve.place;
            let points = around(&curve.moduli[place], at);
            document = document.add(line(&points, COLORS[i % COLORS.len()], 1.8, DASHES[i % DASHES.len()]));
        }
        let names = ["x", "y", "z"];
        document.add(words(names[plane[0]], [centre[0] + radius + 7.0, centre[1] + 4.0], "middle")).add(words(
            names[plane[1]],
            [centre[0], centre[1] - radius - 5.0],
            "middle",
        ))
    }
}

/// A closed line.
fn around(moduli: &[f64], at: impl Fn(f64, f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / moduli.len() as f64;
    // The first point again at the end closes the line.
    (0..=moduli.len()).map(|i| at(angle(i), moduli[i % moduli.len()])).collect()
}

/// `None` if the tensor is not known, or some strain has no modulus.
fn curve(place: usize, fit: &FitRecord, planes: &[[usize; 2]], thickness: f64) -> Option<ModulusCurve> {
    let stiffness = Some(&fit.as_material.stiffness).filter(|c| c.is_square() && c.iter().all(|c| c.is_finite()))?;
    // A tensor without a Cholesky factor has a strain that releases energy, and no modulus.
    let (size, compliance) = (stiffness.nrows(), stiffness.clone().cholesky()?.inverse());
    let moduli = |plane: &[usize; 2]| -> Vec<f64> {
        let direction = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / DIRECTIONS as f64;
            let mut n = vec![0.0; if size == 6 { 3 } else { 2 }];
            (n[plane[0]], n[plane[1]]) = (angle.cos(), angle.sin());
            n
        };
        (0..DIRECTIONS).map(|i| modulus(&compliance, &direction(i)) / thickness).collect()
    };
    let moduli: Vec<Vec<f64>> = planes.iter().map(moduli).collect();
    let is_known = moduli.iter().flatten().all(|modulus| modulus.is_finite() && *modulus > 0.0);
    is_known.then(|| ModulusCurve { name: fit.marked(), place, moduli })
}

/// `1/E(n) = (n ⊗ n) : S : (n ⊗ n)`, in Kelvin's notation.
fn modulus(compliance: &DMatrix<f64>, n: &[f64]) -> f64 {
    let pairs = (0..n.len()).flat_map(|i| (i + 1..n.len()).map(move |j| (i, j)));
    let own = n.iter().map(|x| x * x);
    let m: Vec<f64> = own.chain(pairs.map(|(i, j)| std::f64::consts::SQRT_2 * n[i] * n[j])).collect();
    let m = DVector::from_vec(m);
    1.0 / m.dot(&(compliance * &m))
}

/// By which tensors of plane bodies are multiplied, m; 1 of solids.
fn thickness(report: &Report) -> Result<f64> {
    let thicknesses: Vec<f64> =
        report.materials.iter().filter_map(|region| region.thickness).flatten().flatten().collect();
    match thicknesses.first() {
        None => Ok(1.0),
        Some(first) if thicknesses.iter().all(|other| other == first) => Ok(*first),
        Some(_) => Err(Error::new("the thickness differs from cell to cell, so tensors have no moduli in Pa")),
    }
}

/// The modulus of the isotropic material in a plane or in space.
fn reference(run: &RunFolder, report: &Report) -> Option<f64> {
    let (young, poisson) = (report.young?, report.poisson?);
    let state = run.network(None).ok().and_then(|network| Some(network.provenance.material?.state));
    match state.as_deref() {
        // A direction in the plane, with the strain across the plane held: E/(1 − ν²).
        Some("plane strain") => Some(young / (1.0 - poisson * poisson)),
        Some(_) => Some(young),
        // Of a plane body whose state is not known there is no reference.
        None => report.materials.iter().all(|region| region.thickness.is_none()).then_some(young),
    }
}
