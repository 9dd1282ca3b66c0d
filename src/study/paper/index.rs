//! The index of a paper's experiments: what was printed, and the scenes and elements that run it again.

use crate::error::{Error, Result};
use crate::file;
use crate::study::scene::FitEntry;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Index {
    pub title: String,
    pub table: Vec<TableEntry>,
}

/// A table or figure of the paper.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableEntry {
    /// What it is asked for by, such as "1".
    pub name: String,
    pub title: String,
    pub kind: Kind,
    /// The load of the scenes that it is about.
    pub load: Option<String>,
    pub columns: Vec<Column>,
    /// The material's constants that a surface spans: Pa, and Poisson's ratios.
    pub young: Option<[f64; 2]>,
    pub poisson: Option<[f64; 2]>,
    /// What is told under the table.
    pub note: Option<String>,
    /// Why figures differ from the printed ones: by the name of the fit, or "all".
    #[serde(default)]
    pub why: BTreeMap<String, String>,
    /// Of single elements; scenes have their own.
    #[serde(default)]
    pub fit: Vec<FitEntry>,
    pub row: Vec<RowEntry>,
}

/// An object of a table, with all fits of its scene.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowEntry {
    pub object: String,
    /// Relative to the index.
    pub scene: Option<PathBuf>,
    /// A shipped element's name, or the path of a file relative to the index.
    pub element: Option<String>,
    /// Lengths of a box of it, m.
    pub size: Option<Vec<f64>>,
    /// By the name of the fit, a figure for each column.
    #[serde(default)]
    pub printed: BTreeMap<String, Vec<f64>>,
    #[serde(default)]
    pub why: BTreeMap<String, String>,
}

/// How the figures of a table come about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// From scenes under a load.
    Scenes,
    /// By fitting random shapes of elements.
    Timing,
    /// From the speed of a scene's motion.
    Motion,
    /// From the moduli of a box of one element, over Young's modulus and Poisson's ratio.
    Surface,
}

/// What a column of figures holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Column {
    /// Percent.
    ERms,
    EMax,
    /// Of a gauge, Pa.
    Young,
    Poisson,
    /// Per element.
    Seconds,
    /// Steps of a motion per second.
    Frames,
    /// Of a surface, where it is furthest from one.
    YoungRatio,
    /// `ν − ν_in` of a surface, where it is furthest from zero.
    PoissonShift,
}

impl Column {
    pub fn name(self) -> &'static str {
        match self {
            Column::ERms => "%e_rms",
            Column::EMax => "%e_max",
            Column::Young => "E Pa",
            Column::Poisson => "nu",
            Column::Seconds => "s/element",
            Column::Frames => "steps/s",
            Column::YoungRatio => "E/E_in furthest",
            Column::PoissonShift => "nu - nu_in furthest",
        }
    }
}

impl Index {
    /// # Errors
    /// The file is missing or wrong: names the file, the key, what was expected and what was found.
    pub fn load(path: &Path) -> Result<Index> {
        let index: Index = file::parse_toml(&file::read_text(path)?).map_err(|e| e.in_file(path))?;
        index.check().map_err(|e| e.in_file(path))?;
        Ok(index)
    }

    fn check(&self) -> Result<()> {
        for (i, table) in self.table.iter().enumerate() {
            if self.table[..i].iter().any(|other| other.name == table.name) {
                let found = format!("\"{}\" again", table.name);
                return Err(Error::expected(format!("table[{i}].name"), "a name of its own", found));
            }
            table.check().map_err(|e| e.under(format!("table[{i}]")))?;
        }
        Ok(())
    }
}

impl RowEntry {
    /// The scene's name without its ending.
    pub fn stem(&self) -> Option<String> {
        Some(self.scene.as_ref()?.file_stem()?.to_string_lossy().into_owned())
    }
}

impl TableEntry {
    fn check(&self) -> Result<()> {
        let loads = self.kind == Kind::Scenes;
        let scenes = loads || self.kind == Kind::Motion;
        let misplaced = |key: &str, wanted: bool, given: bool| match (wanted, given) {
            (true, false) => Err(Error::at(key, "is missing")),
            (false, true) => Err(Error::at(key, "does not belong to a table of this kind")),
            _ => Ok(()),
        };
        let surface = self.kind == Kind::Surface;
        misplaced("load", loads, self.load.is_some())?;
        misplaced("young", surface, self.young.is_some())?;
        misplaced("poisson", surface, self.poisson.is_some())?;
        misplaced("fit", !scenes, !self.fit.is_empty())?;
        for range in [self.young, self.poisson].into_iter().flatten() {
            if !(range[0] < range[1] && range.iter().all(|v| v.is_finite())) {
                return Err(Error::expected("young", "a range such as [1, 1e4]", format!("{range:?}")));
            }
        }
        let known: &[Column] = match self.kind {
            Kind::Scenes => &[Column::ERms, Column::EMax, Column::Young, Column::Poisson],
            Kind::Timing => &[Column::Seconds],
            Kind::Motion => &[Column::Frames],
            Kind::Surface => &[Column::YoungRatio, Column::PoissonShift],
        };
        if self.columns.is_empty() || self.columns.iter().any(|column| !known.contains(column)) {
            let names: Vec<&str> = known.iter().map(|column| column.name()).collect();
            let found: Vec<&str> = self.columns.iter().map(|column| column.name()).collect();
            return Err(Error::expected("columns", format!("some of {}", names.join(", ")), found.join(", ")));
        }
        for (j, row) in self.row.iter().enumerate() {
            let at = |e: Error| e.under(format!("row[{j}]"));
            misplaced("scene", scenes, row.scene.is_some()).map_err(at)?;
            misplaced("element", !scenes, row.element.is_some()).map_err(at)?;
            misplaced("size", surface, row.size.is_some()).map_err(at)?;
            if let Some((fit, printed)) = row.printed.iter().find(|(_, p)| p.len() != self.columns.len()) {
                let expected = format!("{} figures, one for each column", self.columns.len());
                return Err(at(Error::expected(format!("printed.{fit}"), expected, printed.len())));
            }
        }
        Ok(())
    }

    /// Why the figures of a fit differ from the printed ones.
    pub fn why(&self, row: &RowEntry, fit: &str) -> Option<String> {
        let of = |why: &BTreeMap<String, String>| why.get(fit).or_else(|| why.get("all")).cloned();
        of(&row.why).or_else(|| of(&self.why))
    }
}
