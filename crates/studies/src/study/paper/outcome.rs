//! The results of a paper's experiments.

use super::index::{Column, RowEntry};
use crate::order::distinct;
use serde::Serialize;
use springfit_scenes::Outcome;

/// The tables that were run, and their scenes.
#[derive(Debug)]
pub struct Paper {
    /// The title of the paper.
    pub title: String,
    /// The tables.
    pub tables: Vec<PaperTable>,
    /// The scenes of the tables, each once.
    pub scenes: Vec<PaperScene>,
}

/// A table or figure of the paper, with the printed and the computed figures.
#[derive(Debug, Serialize)]
pub struct PaperTable {
    /// The name by which it is requested.
    pub name: String,
    /// Its title.
    pub title: String,
    /// A note that is printed under it.
    pub note: Option<String>,
    /// The load of the scenes.
    pub load: Option<String>,
    /// What the columns hold.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<PaperRow>,
    /// The surfaces of a figure of that kind.
    pub surfaces: Vec<Surface>,
}

/// The figures of one fit of an object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperRow {
    /// The object.
    pub object: String,
    /// The stem of the scene's name, if it is from one.
    pub scene: Option<String>,
    /// The name of the fit.
    pub fit: String,
    /// The printed figures, one per column, if there are any.
    pub printed: Option<Vec<f64>>,
    /// The computed figures, one per column.
    pub found: Vec<Option<f64>>,
    /// Whether the method is one published by other authors.
    pub published: bool,
    /// Whether the network is stable or, at large deformation, reached the whole load.
    pub stands: bool,
    /// The reason why the figures differ, if they do.
    pub why: Option<String>,
}

/// A scene with the name of its file.
#[derive(Debug)]
pub struct PaperScene {
    pub stem: String,
    pub outcome: Outcome,
}

/// The moduli of a network as functions of those of the material.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    /// The name of the fit.
    pub fit: String,
    /// Young's moduli of the material, Pa.
    pub young: Vec<f64>,
    /// Poisson's ratios of the material.
    pub poisson: Vec<f64>,
    /// Young's modulus, Pa, and Poisson's ratio of the network, `[young × poisson]`; `None` if some strain meets no
    /// resistance.
    pub found: Vec<Option<[f64; 2]>>,
}

/// Figures whose relative difference is smaller count as equal.
const SAME: f64 = 0.02;

impl PaperRow {
    pub(super) fn new(row: &RowEntry, fit: &str, found: Vec<Option<f64>>, published: bool, stands: bool) -> PaperRow {
        let (object, fit, scene) = (row.object.clone(), fit.to_string(), row.stem());
        PaperRow { object, scene, fit, printed: None, found, published, stands, why: None }
    }

    /// Whether a figure differs from the printed one by more than two percent.
    pub fn differs(&self) -> bool {
        let far = |(printed, found): (&f64, &Option<f64>)| {
            // A printed zero is met by zero alone.
            found.is_none_or(|found| (found - printed).abs() > SAME * printed.abs().max(1e-300))
        };
        self.printed.as_ref().is_some_and(|printed| printed.iter().zip(&self.found).any(far))
    }
}

impl PaperTable {
    /// The objects in their order.
    pub fn objects(&self) -> Vec<&str> {
        distinct(self.rows.iter().map(|row| row.object.as_str()))
    }

    /// For an object, the fit with the least printed e_rms, and the fit with the least computed one among stable
    /// networks.
    pub fn best(&self, object: &str) -> (Option<&PaperRow>, Option<&PaperRow>) {
        let Some(place) = self.columns.iter().position(|c| *c == Column::ERms) else { return (None, None) };
        let of = || self.rows.iter().filter(|row| row.object == object);
        let printed = |row: &&PaperRow| row.printed.as_ref().map(|printed| printed[place]);
        let found = |row: &&PaperRow| row.found[place].filter(|_| row.stands && !row.published);
        (least(of(), printed), least(of(), found))
    }
}

fn least<'a>(
    rows: impl Iterator<Item = &'a PaperRow>,
    value: impl Fn(&&PaperRow) -> Option<f64>,
) -> Option<&'a PaperRow> {
    rows.filter_map(|row| Some((value(&row)?, row))).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, row)| row)
}
