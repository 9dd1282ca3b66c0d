//! The errors of a sweep over one of its keys.

use super::axis::Axis;
use super::chart::{Chart, Series, Shape};
use super::precision::BELOW;
use super::run_folder::RunFolder;
use crate::error::{Error, Result};
use crate::file::{files_in, read_text};
use crate::order::{distinct, grouped};
use crate::report::StudyRecord;
use crate::report::study_record::reference;
use crate::study::statistics::median;
use serde_json::Value;

/// A fit with its median error at each value of the key.
type Medians = (String, Vec<(f64, f64)>);
/// The name of a fit, and what errors are relative to.
type Curve<'a> = (&'a str, &'a str);

/// A curve for each fit: the median over all studies and loads of the error e_rms at each value of the key, which is the first one with
/// several numbers unless it is named. Errors that are relative to different solutions are of different curves.
///
/// # Errors
/// The folder has no studies, or they have no such key with numbers.
pub fn swept_chart(run: &RunFolder, key: Option<&str>) -> Result<Chart> {
    let folder = run.file("");
    let mut records: Vec<StudyRecord> = Vec::new();
    for path in files_in(&folder, "jsonl")? {
        for (number, line) in read_text(&path)?.lines().enumerate() {
            let wrong = |e| Error::new(format!("expected a study of a sweep, found something else: {e}"));
            records.push(serde_json::from_str(line).map_err(|e| wrong(e).on_line(number + 1).in_file(&path))?);
        }
    }
    let Some(first) = records.first() else {
        return Err(Error::new("has no studies: springfit sweep writes them").in_file(&folder));
    };
    let values = |key: &str| -> Vec<f64> { records.iter().filter_map(|r| r.settings.get(key)?.as_f64()).collect() };
    let varies = |key: &&String| values(key).windows(2).any(|pair| pair[0] != pair[1]);
    let known: Vec<&String> = first.settings.keys().filter(varies).collect();
    let key = match key {
        Some(key) => known.iter().find(|known| **known == key),
        None => known.first(),
    };
    let Some(key) = key else {
        let names: Vec<&str> = known.iter().map(|key| key.as_str()).collect();
        if names.is_empty() {
            return Err(Error::new("has no key with several numbers to draw errors over").in_file(&folder));
        }
        return Err(Error::expected(
            "--of",
            format!("a key with several numbers: {}", names.join(", ")),
            "none of them",
        ));
    };
    let fits = records.iter().filter_map(|record| {
        let at = record.settings.get(*key).and_then(Value::as_f64)?;
        let report = record.report.as_ref()?;
        let errors = |fit| errors_of(report, fit).map(move |(curve, errors)| (curve, (at, errors)));
        Some(report["fits"].as_array()?.iter().flat_map(errors).collect::<Vec<_>>())
    });
    let curves = grouped(fits.flatten());
    let references = distinct(curves.iter().map(|((_, reference), _)| *reference));
    let medians = |((name, reference), lists): (Curve, Vec<(f64, Vec<f64>)>)| -> Medians {
        let name = if references.len() > 1 { format!("{name}, relative to {reference}") } else { name.into() };
        let points = grouped(lists).into_iter().map(|(at, lists)| (at, median(&lists.concat())));
        let mut points: Vec<(f64, f64)> = points.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        (name, points)
    };
    let curves: Vec<Medians> = curves.into_iter().map(medians).collect();
    let errors = || curves.iter().flat_map(|(_, points)| points).map(|(_, error)| *error);
    // Errors that are rounding, in percent, have no place on a logarithmic axis.
    let is_shown = |error: &f64| *error > 1e-9;
    let least = errors().filter(is_shown).fold(f64::INFINITY, f64::min);
    let curve = |(place, (name, points)): (usize, &Medians)| {
        let largest = points.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        // A fit that is rounding at all values is below the others, with its largest number in the legend.
        let is_below = least.is_finite() && !is_shown(&largest);
        let (name, shape) = match is_below {
            true => (format!("{name} (at most {largest:.0e} %)"), Shape::Below),
            false => (name.clone(), Shape::Curve),
        };
        let drawn = points.iter().filter(|(_, error)| is_below || is_shown(error));
        let drawn = drawn.map(|(at, error)| (*at, if is_below { least / BELOW } else { *error }));
        Series::new(name, drawn.collect(), shape).styled(place)
    };
    let series: Vec<Series> = curves.iter().enumerate().map(curve).filter(|curve| !curve.points.is_empty()).collect();
    Ok(Chart {
        title: format!("e_rms over {key}, {} studies", records.len()),
        x: Axis::linear(key.as_str()),
        y: Axis::log("e_rms, % (median of studies and loads)"),
        series,
    })
}

/// The errors e_rms of a fit in percent, by their curves.
// Whole lists are grouped: to look for the curve of each error would take as many times as long as there are loads.
fn errors_of<'a>(report: &'a Value, fit: &'a Value) -> impl Iterator<Item = (Curve<'a>, Vec<f64>)> {
    let loads = fit["loads"].as_array().into_iter().flatten();
    let errors = loads.filter_map(|load| Some((reference(report, load), load["e_rms"].as_f64()?)));
    let name = fit["name"].as_str().unwrap_or_default();
    grouped(errors).into_iter().map(move |(reference, errors)| ((name, reference), errors))
}
