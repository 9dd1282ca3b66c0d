//! The index of a paper's experiments: the printed figures, and the scenes and elements that repeat them.

use crate::error::{Error, Result};
use crate::file;
use crate::named::unknown;
use crate::range::LARGEST;
use serde::{Deserialize, Serialize};
use springfit_scenes::FitEntry;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The index of a paper's experiments.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Index {
    /// The title of the paper.
    pub title: String,
    /// Its tables and figures.
    pub table: Vec<TableEntry>,
}

/// A table or figure of the paper.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableEntry {
    /// The name by which it is requested, such as "1".
    pub name: String,
    pub title: String,
    pub kind: Kind,
    /// The load of the scenes to which it belongs.
    pub load: Option<String>,
    pub columns: Vec<Column>,
    /// The ranges that a surface covers: of Young's modulus, Pa, and of Poisson's ratio.
    pub young: Option<[f64; 2]>,
    pub poisson: Option<[f64; 2]>,
    /// A note that is printed under the table.
    pub note: Option<String>,
    /// Reasons why figures differ from the printed ones, by the name of the fit, or "all".
    #[serde(default)]
    pub why: BTreeMap<String, String>,
    /// The fits of single elements; scenes have their own.
    #[serde(default)]
    pub fit: Vec<FitEntry>,
    pub row: Vec<RowEntry>,
}

/// An object of a table, with all fits of its scene.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowEntry {
    pub object: String,
    /// The path of the scene, relative to the index.
    pub scene: Option<PathBuf>,
    /// The name of a shipped element, or the path of a file relative to the index.
    pub element: Option<String>,
    /// The side lengths of a box of the element, m.
    pub size: Option<Vec<f64>>,
    /// The printed figures by the name of the fit, one per column.
    #[serde(default)]
    pub printed: BTreeMap<String, Vec<f64>>,
    #[serde(default)]
    pub why: BTreeMap<String, String>,
}

/// How the figures of a table are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// From scenes under a load.
    Scenes,
    /// From the fits of random shapes of elements.
    Timing,
    /// From the speed of the motion of a scene.
    Motion,
    /// From the moduli of a box of one element, as functions of Young's modulus and Poisson's ratio.
    Surface,
}

/// What a column of figures holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Column {
    /// The root mean square error of the displacements, in percent.
    ERms,
    /// The largest error of the displacements, in percent.
    EMax,
    /// Young's modulus of a gauge, Pa.
    Young,
    /// Poisson's ratio of a gauge.
    Poisson,
    /// The time per element, s.
    Seconds,
    /// The number of steps of a motion per second.
    Frames,
    /// `E/E_in` of a surface, where it is farthest from one.
    YoungRatio,
    /// `ν − ν_in` of a surface, where it is farthest from zero.
    PoissonShift,
}

impl Column {
    /// The heading of the column.
    pub fn name(self) -> &'static str {
        match self {
            Column::ERms => "e_rms",
            Column::EMax => "e_max",
            Column::Young => "E",
            Column::Poisson => "ν",
            Column::Seconds => "time",
            Column::Frames => "speed",
            Column::YoungRatio => "E/E_in furthest",
            Column::PoissonShift => "ν − ν_in furthest",
        }
    }

    /// The unit of the column; a ratio has none.
    pub fn unit(self) -> &'static str {
        match self {
            Column::ERms | Column::EMax => "%",
            Column::Young => "Pa",
            Column::Seconds => "s/element",
            Column::Frames => "steps/s",
            Column::Poisson | Column::YoungRatio | Column::PoissonShift => "",
        }
    }
}

impl Index {
    /// Reads an index.
    ///
    /// # Errors
    /// The file is missing or wrong. The error names the file and the key, what was expected and what was found.
    pub fn load(path: &Path) -> Result<Index> {
        Index::parse(&file::read_text(path)?).map_err(|e| e.in_file(path))
    }

    /// Parses the text of an index.
    ///
    /// # Errors
    /// Those of [`Index::load`], without the file.
    pub fn parse(text: &str) -> Result<Index> {
        Index::checked(text).map_err(|e| file::on_line_of_key(e, text))
    }

    fn checked(text: &str) -> Result<Index> {
        let index: Index = file::parse_toml(text)?;
        for (i, table) in index.table.iter().enumerate() {
            for (j, fit) in table.fit.iter().enumerate() {
                fit.check().map_err(|e| e.under(format!("table[{i}].fit[{j}]")))?;
            }
        }
        index.check()?;
        Ok(index)
    }

    /// Checks that there are tables with these names.
    ///
    /// # Errors
    /// There is none with one of them.
    pub fn expect(&self, names: &[String]) -> Result<()> {
        match names.iter().find(|name| self.table.iter().all(|table| table.name != **name)) {
            Some(name) => {
                let known: Vec<&str> = self.table.iter().map(|table| table.name.as_str()).collect();
                Err(unknown(format!("one of {}", known.join(", ")), known, name).at_key("table"))
            }
            None => Ok(()),
        }
    }

    fn check(&self) -> Result<()> {
        if self.table.is_empty() {
            return Err(Error::expected("table", "at least one [[table]]", "none"));
        }
        let mut scenes: Vec<&RowEntry> = Vec::new();
        for (i, table) in self.table.iter().enumerate() {
            let at = |key: &str| format!("table[{i}].{key}");
            let stem = file_stem(&table.name);
            if !table.name.contains(|c: char| c.is_ascii_alphanumeric()) {
                return Err(Error::expected(
                    at("name"),
                    "a name with letters or digits",
                    format!("\"{}\"", table.name),
                ));
            }
            if let Some(other) = self.table[..i].iter().find(|other| file_stem(&other.name) == stem) {
                let found = if other.name == table.name { "again" } else { "whose files are those of another" };
                return Err(Error::expected(at("name"), "a name of its own", format!("\"{}\" {found}", table.name)));
            }
            table.check().map_err(|e| e.under(format!("table[{i}]")))?;
            for (j, row) in table.row.iter().enumerate() {
                let same = |other: &&&RowEntry| other.stem() == row.stem() && other.scene != row.scene;
                if let (Some(file), Some(other)) = (&row.scene, scenes.iter().find(same)) {
                    let named = other.scene.as_deref().unwrap_or(Path::new("")).display().to_string();
                    let expected = format!("a file of another name than {named}");
                    return Err(Error::expected(at(&format!("row[{j}].scene")), expected, file.display()));
                }
                scenes.push(row);
            }
        }
        Ok(())
    }
}

/// The heading of a table: Table 1, Figure 9, Torsion.
pub fn heading(name: &str) -> String {
    match name.chars().next() {
        Some(c) if c.is_ascii_digit() => format!("Table {name}"),
        Some(c) => c.to_uppercase().collect::<String>() + &name[c.len_utf8()..],
        None => String::new(),
    }
}

/// The stem of the names of its files.
pub fn file_stem(name: &str) -> String {
    heading(name).to_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "-")
}

impl RowEntry {
    /// The name of the scene without its extension.
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
        for (key, range, such) in [("young", self.young, "[1, 1e4]"), ("poisson", self.poisson, "[0, 0.5]")] {
            if let Some(range) = range.filter(|r| !(r[0] < r[1] && r.iter().all(|v| v.is_finite()))) {
                return Err(Error::expected(key, format!("a range such as {such}"), format!("{range:?}")));
            }
        }
        if self.row.is_empty() {
            return Err(Error::expected("row", "at least one [[table.row]]", "none"));
        }
        let known: &[Column] = match self.kind {
            Kind::Scenes => &[Column::ERms, Column::EMax, Column::Young, Column::Poisson],
            Kind::Timing => &[Column::Seconds],
            Kind::Motion => &[Column::Frames],
            Kind::Surface => &[Column::YoungRatio, Column::PoissonShift],
        };
        let again = (1..self.columns.len()).any(|i| self.columns[..i].contains(&self.columns[i]));
        if self.columns.is_empty() || again || self.columns.iter().any(|column| !known.contains(column)) {
            let names: Vec<&str> = known.iter().map(|column| column.name()).collect();
            let found: Vec<&str> = self.columns.iter().map(|column| column.name()).collect();
            let expected = format!("some of {}, each once", names.join(", "));
            return Err(Error::expected("columns", expected, found.join(", ")));
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
            let odd = |printed: &Vec<f64>| printed.iter().copied().find(|v| !v.is_finite() || v.abs() > LARGEST);
            if let Some((fit, value)) = row.printed.iter().find_map(|(fit, printed)| Some((fit, odd(printed)?))) {
                let expected = format!("figures up to {LARGEST:e}");
                return Err(at(Error::expected(format!("printed.{fit}"), expected, format!("{value:e}"))));
            }
        }
        Ok(())
    }

    /// The reason why the figures of a fit differ from the printed ones, if there is one.
    pub fn why(&self, row: &RowEntry, fit: &str) -> Option<String> {
        let of = |why: &BTreeMap<String, String>| why.get(fit).or_else(|| why.get("all")).cloned();
        of(&row.why).or_else(|| of(&self.why))
    }
}
