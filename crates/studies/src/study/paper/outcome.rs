//! What came out of a paper's experiments.

use super::index::{Column, RowEntry};
use crate::study::outcome::Outcome;
use serde::Serialize;

/// The tables that were run, and the scenes behind them.
#[derive(Debug)]
pub struct Paper {
    pub title: String,
    pub tables: Vec<PaperTable>,
    pub scenes: Vec<PaperScene>,
}

#[derive(Debug, Serialize)]
pub struct PaperTable {
    pub name: String,
    pub title: String,
    pub note: Option<String>,
    /// Of the scenes.
    pub load: Option<String>,
    pub columns: Vec<Column>,
    pub rows: Vec<PaperRow>,
    pub surfaces: Vec<Surface>,
}

/// A fit of an object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperRow {
    pub object: String,
    /// The stem of the scene's name, where it is from one.
    pub scene: Option<String>,
    pub fit: String,
    /// One figure for each column.
    pub printed: Option<Vec<f64>>,
    pub found: Vec<Option<f64>>,
    /// Whether it is a method of others.
    pub published: bool,
    /// Whether the network stands, or, at large deformation, was followed to the end.
    pub stands: bool,
    /// Why the figures differ, where they do.
    pub why: Option<String>,
}

/// A scene with the name of its file.
#[derive(Debug)]
pub struct PaperScene {
    pub stem: String,
    pub outcome: Outcome,
}

/// The moduli of a network over those that were asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    pub fit: String,
    /// Pa, and Poisson's ratios.
    pub young: Vec<f64>,
    pub poisson: Vec<f64>,
    /// `[young × poisson]`: Pa and Poisson's ratio, `None` where some strain meets no resistance.
    pub found: Vec<Option<[f64; 2]>>,
}

/// Figures that differ by less are the same.
const SAME: f64 = 0.02;

impl PaperRow {
    pub(super) fn new(row: &RowEntry, fit: &str, found: Vec<Option<f64>>, published: bool, stands: bool) -> PaperRow {
        let (object, fit, scene) = (row.object.clone(), fit.to_string(), row.stem());
        PaperRow { object, scene, fit, printed: None, found, published, stands, why: None }
    }

    /// Whether a figure is not the printed one, to two percent.
    pub fn differs(&self) -> bool {
        let far = |(printed, found): (&f64, &Option<f64>)| {
            found.is_none_or(|found| (found - printed).abs() > SAME * printed.abs().max(1e-300))
        };
        self.printed.as_ref().is_some_and(|printed| printed.iter().zip(&self.found).any(far))
    }
}

impl PaperTable {
    /// The objects in their order.
    pub fn objects(&self) -> Vec<&str> {
        let mut objects: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !objects.contains(&row.object.as_str()) {
                objects.push(&row.object);
            }
        }
        objects
    }

    /// Of an object, the fit whose printed %e_rms is least, and that of ours whose found one is, among those that stand.
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
