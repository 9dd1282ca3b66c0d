//! Errors of a convergence study against the size of the cells, from the file that the study writes.

use super::axis::Axis;
use super::chart::{Chart, Series, Shape};
use crate::error::{Error, Result};
use crate::study::BODY;
use crate::text::of_csv;
use std::path::Path;

/// The file of a convergence study.
pub const CONVERGENCE_TABLE: &str = "converge.csv";

/// A line of `converge.csv`, as far as it is drawn.
#[derive(serde::Deserialize)]
struct Row {
    load: String,
    model: String,
    h_m: f64,
    of_truth_percent: Option<f64>,
    rate: Option<f64>,
}

/// A model under a load.
struct Curve {
    load: String,
    model: String,
    /// Cell size in mm and the error in percent, both above zero.
    points: Vec<(f64, f64)>,
    /// Between the finest levels that have one.
    rate: Option<f64>,
}

/// A chart for each load under which some error is above zero.
///
/// # Errors
/// The text is not that of a convergence study.
pub fn convergence_charts(csv: &str) -> Result<Vec<Chart>> {
    let mut curves: Vec<Curve> = Vec::new();
    for (i, row) in csv::Reader::from_reader(csv.as_bytes()).deserialize().enumerate() {
        let row: Row = row.map_err(|e| Error::new(words(&e)).on_line(i + 2))?;
        let (load, model) = (of_csv(&row.load), of_csv(&row.model));
        let known = curves.iter().position(|curve| curve.load == load && curve.model == model);
        let place = known.unwrap_or_else(|| {
            curves.push(Curve { load: load.into(), model: model.into(), points: Vec::new(), rate: None });
            curves.len() - 1
        });
        let error = row.of_truth_percent.map(f64::abs).filter(|error| *error > 0.0 && row.h_m > 0.0);
        curves[place].points.extend(error.map(|error| (1e3 * row.h_m, error)));
        curves[place].rate = row.rate.or(curves[place].rate);
    }
    let mut loads: Vec<&str> = curves.iter().map(|curve| curve.load.as_str()).collect();
    loads.dedup();
    let chart = |load: &&str| chart(load, curves.iter().filter(|curve| curve.load == **load));
    Ok(loads.iter().filter_map(chart).collect())
}

/// The chart of the load that is named, or of the first, from the file of a study.
///
/// # Errors
/// The file cannot be read, or has no such load.
pub fn convergence_chart(path: &Path, load: Option<&str>) -> Result<Chart> {
    let text = std::fs::read_to_string(path).map_err(|e| {
        let advice = "springfit converge SCENE writes it; its folder is the one to plot";
        Error::new(format!("cannot be read: {e}; {advice}")).in_file(path)
    })?;
    let mut charts = convergence_charts(&text).map_err(|e| e.in_file(path))?;
    let is_asked = |chart: &Chart| load.is_none_or(|load| chart.title == title(load));
    match charts.iter().position(is_asked) {
        Some(place) => Ok(charts.swap_remove(place)),
        None if charts.is_empty() => {
            Err(Error::new("no error is above zero, so there is nothing to draw").in_file(path))
        }
        None => {
            let loads: Vec<&str> = charts.iter().filter_map(|chart| chart.title.strip_prefix(TITLE)).collect();
            let expected = format!("a load of the study with an error above zero: {}", loads.join(", "));
            Err(Error::expected("--of", expected, load.unwrap_or_default()))
        }
    }
}

const TITLE: &str = "Error against cell size under ";

fn title(load: &str) -> String {
    format!("{TITLE}{load}")
}

fn chart<'a>(load: &str, curves: impl Iterator<Item = &'a Curve>) -> Option<Chart> {
    let all: Vec<&Curve> = curves.collect();
    let drawn: Vec<&Curve> = all.iter().copied().filter(|curve| !curve.points.is_empty()).collect();
    // Fits look as in the figures of a run, and finite elements as behind them.
    let fits: Vec<&str> = all.iter().map(|curve| &*curve.model).filter(|model| *model != BODY).collect();
    let place = |curve: &Curve| fits.iter().position(|model| *model == curve.model).unwrap_or(fits.len());
    let name = |curve: &Curve| match curve.rate {
        // Without the sign of a zero.
        Some(rate) => format!("{} (rate {:.1})", curve.model, if rate.abs() < 0.05 { 0.0 } else { rate }),
        None => curve.model.clone(),
    };
    let series = |curve: &&Curve| Series::new(name(curve), curve.points.clone(), Shape::Curve).styled(place(curve));
    let mut series: Vec<Series> = drawn.iter().map(series).collect();
    // Slopes through the first model's error on the coarsest level, as far down as there are errors.
    let (h, e) = *drawn.first()?.points.first()?;
    let points = || drawn.iter().flat_map(|curve| &curve.points);
    let least = points().fold((f64::INFINITY, f64::INFINITY), |(a, b), (h, e)| (a.min(*h), b.min(*e)));
    for order in [1, 2] {
        let end = least.0.max(h * (least.1 / e).powf(1.0 / f64::from(order)));
        let points = vec![(h, e), (end, e * (end / h).powi(order))];
        series.push(Series::new(format!("order {order}"), points, Shape::Guide));
    }
    Some(Chart {
        title: title(load),
        x: Axis::log("cell size h, mm"),
        y: Axis::log(format!("compliance error, {load}, %")),
        series,
    })
}

/// What the reader of tables says, without the place, which is said otherwise.
fn words(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => format!("is no line of converge.csv: {}", err.kind()),
        _ => format!("is no table: {error}"),
    }
}
