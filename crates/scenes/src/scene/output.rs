//! What a scene writes and computes besides its table.

use crate::bound::check_count;
use crate::error::{Error, Result};
use crate::range;
use schemars::JsonSchema;
use serde::Deserialize;

/// What a scene writes and computes besides its table.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Springs and displacements are written as VTU files, and a motion as a series of them.
    pub vtu: bool,
    /// Springs and points are written as CSV files.
    pub csv: bool,
    /// Each network is written whole as a JSON file.
    #[schemars(extend("default" = true))]
    pub json: Option<bool>,
    /// The errors of the elements' matrices are computed. Without them the tables have `-`, and files null.
    #[schemars(extend("default" = true))]
    pub errors: Option<bool>,
    /// What each fit, each network and the finite elements cost is measured: processor time of one thread, repeated in turns.
    pub time: bool,
    /// Young's modulus, Poisson's ratio and Zener's ratio of each whole network are measured.
    pub moduli: bool,
    /// The storage and loss moduli of each model are measured over frequency, without inertia. The material relaxes, or `[motion]` has damping.
    pub dynamic_moduli: Option<DynamicModuliEntry>,
    /// This number of natural frequencies of each model is computed, without those of rigid motions; they need a density.
    pub frequencies: usize,
    /// The file report.json and the page report.html are written (`true`), or neither (`false`).
    #[schemars(extend("x-default" = "report.json alone"))]
    pub report: Option<bool>,
}

impl Output {
    /// Whether the report is written as a page.
    pub fn has_page(&self) -> bool {
        self.report == Some(true)
    }

    /// Whether the errors of the elements' matrices are computed.
    pub fn has_errors(&self) -> bool {
        self.errors != Some(false)
    }

    /// Whether the states of a motion are kept for pictures.
    pub fn has_pictures(&self) -> bool {
        self.vtu || self.has_page()
    }
}

/// The frequencies of `dynamic_moduli`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DynamicModuliEntry {
    /// The stress changes with frequencies from the first to the second of these, Hz, above 0. One of `band` and `frequency` is required.
    band: Option<[f64; 2]>,
    /// The band has this number of frequencies, with both ends, at equal ratios: from 2 to 10000.
    #[schemars(extend("x-default" = "five in a decade, and one"))]
    count: Option<usize>,
    /// The stress changes with these frequencies in Hz, above 0 and rising.
    frequency: Option<Vec<f64>>,
}

/// Frequencies in a decade where no number is given.
// The peak of a relaxing term in the middle between two of them is seen to 3 %: `2 x/(1 + x²)` is 0.974 at
// `x = 10^(1/10)`.
const PER_DECADE: f64 = 5.0;
/// Frequencies at most. Each takes a solution for every strain, and ten decades with a thousand in each are as many.
const MOST: u64 = 10_000;

impl DynamicModuliEntry {
    /// The frequencies, Hz.
    ///
    /// # Errors
    /// A frequency is not above zero, they do not rise, or both ways to give them are taken, or none.
    pub fn frequencies(&self) -> Result<Vec<f64>> {
        let rising = |key: &str, list: &[f64]| match list.windows(2).find(|pair| pair[1] <= pair[0]) {
            Some(pair) => Err(Error::expected(key, "numbers that rise", format!("{} after {}", pair[1], pair[0]))),
            None => list.iter().try_for_each(|f| range::positive(key, *f, "Hz").map(|_| ())),
        };
        match (self.band, &self.frequency) {
            (Some(band), None) => {
                rising("band", &band)?;
                let [from, to] = band;
                let count = self.count.unwrap_or(((to / from).log10() * PER_DECADE).ceil() as usize + 1);
                check_count("count", count as u64, 2, MOST)?;
                let at = |i: usize| match i {
                    i if i + 1 == count => to,
                    i => from * (to / from).powf(i as f64 / (count - 1) as f64),
                };
                Ok((0..count).map(at).collect())
            }
            (None, Some(list)) => {
                if self.count.is_some() {
                    return Err(Error::at("count", "belongs to \"band\", found beside \"frequency\""));
                }
                if list.is_empty() {
                    return Err(Error::expected("frequency", "one number or more", "none"));
                }
                rising("frequency", list)?;
                check_count("frequency", list.len() as u64, 1, MOST)?;
                Ok(list.clone())
            }
            (band, _) => {
                let found = if band.is_some() { "both" } else { "neither" };
                Err(Error::new(format!("expected \"band\" or \"frequency\", found {found}")))
            }
        }
    }
}
