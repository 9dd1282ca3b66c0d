//! The summary of a comparison: quantiles of every figure, and intervals of their medians.

use super::pairs::{MERITS, Pair, Rank, fits, means, method as method_of, of_same_shapes, pairs, ranks};
use crate::order::distinct;
use crate::study::statistics::{Interval, Quantiles, median, median_interval};
use crate::study::{CaseRecord, MethodRecord};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A comparison in figures. A figure is better the smaller it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The title of the comparison.
    pub title: String,
    /// The version of the program.
    pub version: String,
    /// The machine: its processor architecture, its system, and the number of its processors.
    pub machine: String,
    /// Each case with its methods.
    pub cases: Vec<CaseSummary>,
    /// Each method on each element or scene, over all its cases, by quantity.
    pub objects: Vec<Object>,
    /// Each pair of methods, by quantity.
    pub pairs: Vec<Pair>,
    /// The mean rank of each method, by quantity.
    pub ranks: Vec<Rank>,
}

/// A method on all cases of an element or of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Object {
    /// The element, with its law, or the scene.
    pub name: String,
    /// The name of the fit.
    pub fit: String,
    /// The quantity that errors are of.
    pub quantity: String,
    /// The errors of all its shapes, loads or stretches; of a shape at several Poisson's ratios the geometric mean.
    pub error: Option<Told>,
    /// The median over its cases of the median processor time to fit an element, s.
    pub seconds: Option<f64>,
}

/// A case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseSummary {
    /// What the case is.
    pub settings: BTreeMap<String, Value>,
    /// Why the case failed.
    pub error: Option<String>,
    /// The methods, in the order of the fits.
    pub methods: Vec<MethodSummary>,
}

/// A method on a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodSummary {
    /// The name of the fit.
    pub fit: String,
    /// The settings of the fit.
    pub settings: BTreeMap<String, Value>,
    /// The number of elements that were fitted.
    pub fitted: usize,
    /// The number of elements that have the constants of a congruent one.
    pub copied: usize,
    /// Why the method has no figures here, or why they are not to be trusted.
    pub refused: Option<String>,
    /// Figures of the whole case.
    pub figures: BTreeMap<String, Option<f64>>,
    /// Each quantity has these quantiles.
    pub values: BTreeMap<String, Told>,
    /// Each processor time has these quantiles, s.
    pub times: BTreeMap<String, Told>,
}

/// The quantiles of a list of figures, and the interval of their median.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Told {
    /// Quantiles.
    #[serde(flatten)]
    pub quantiles: Quantiles,
    /// The bootstrap interval of the median, 95 %; absent of fewer values than can hold it so often.
    pub interval: Option<Interval>,
}

/// Of fewer values not even the least and the largest hold the median in 95 % of samples: they do in a share `1 − 2^(1−n)`.
const FEWEST: usize = 6;

impl Told {
    fn of(values: &[f64]) -> Option<Told> {
        let interval = (values.len() >= FEWEST).then(|| median_interval(values));
        let told = || Told { quantiles: Quantiles::of(values), interval };
        (!values.is_empty()).then(told)
    }
}

/// The version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The machine in words.
pub fn machine() -> String {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{} {}, {processors} processors", std::env::consts::ARCH, std::env::consts::OS)
}

/// The summary of a comparison.
pub fn summarized(title: &str, records: &[CaseRecord]) -> Summary {
    Summary {
        title: title.into(),
        version: VERSION.into(),
        machine: machine(),
        cases: records.iter().map(case).collect(),
        objects: objects(records),
        pairs: pairs(records),
        ranks: ranks(records),
    }
}

/// The name of the element of a case, with its law, or of its scene.
fn object_of(record: &CaseRecord) -> String {
    let (name, law) = (record.object(), record.settings.get("law").and_then(Value::as_str));
    law.map_or(name.into(), |law| format!("{name}, {law}"))
}

fn objects(records: &[CaseRecord]) -> Vec<Object> {
    let mut all = Vec::new();
    for name in distinct(records.iter().map(object_of)) {
        let own: Vec<&CaseRecord> = records.iter().filter(|record| object_of(record) == name).collect();
        let has = |quantity: &&str| own.iter().flat_map(|r| &r.methods).any(|m| m.values.contains_key(*quantity));
        for fit in fits(records) {
            let methods: Vec<&MethodRecord> = own.iter().filter_map(|record| method_of(record, fit)).collect();
            let times: Vec<f64> = methods.iter().filter_map(|m| Some(median(m.times.get("fit")?))).collect();
            if methods.is_empty() {
                continue;
            }
            for quantity in MERITS.into_iter().filter(has) {
                let of_shapes = |same: Vec<&CaseRecord>| {
                    means(same.into_iter().filter_map(|record| method_of(record, fit)?.values.get(quantity)))
                };
                let errors: Vec<f64> =
                    of_same_shapes(own.iter().copied()).into_iter().flat_map(of_shapes).flatten().collect();
                all.push(Object {
                    name: name.clone(),
                    fit: fit.into(),
                    quantity: quantity.into(),
                    error: Told::of(&errors),
                    seconds: (!times.is_empty()).then(|| median(&times)),
                });
            }
        }
    }
    all
}

fn case(record: &CaseRecord) -> CaseSummary {
    CaseSummary {
        settings: record.settings.clone(),
        error: record.error.clone(),
        methods: record.methods.iter().map(method).collect(),
    }
}

fn method(record: &MethodRecord) -> MethodSummary {
    let known = |list: &Vec<Option<f64>>| Told::of(&list.iter().copied().flatten().collect::<Vec<_>>());
    let values = record.values.iter().filter_map(|(name, list)| Some((name.clone(), known(list)?)));
    let times = record.times.iter().filter_map(|(name, list)| Some((name.clone(), Told::of(list)?)));
    MethodSummary {
        fit: record.fit.clone(),
        settings: record.settings.clone(),
        fitted: record.fitted,
        copied: record.copied,
        refused: record.refused.clone(),
        figures: record.figures.clone(),
        values: values.collect(),
        times: times.collect(),
    }
}
