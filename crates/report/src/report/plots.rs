//! Figures for a paper, from the folder of a run, a comparison, a sweep or a convergence study.

use super::compare::{CASES, Drawn, compare_tables, comparison_chart, read_cases, summarized, thinned};
use super::figure::{
    Axis, CONVERGENCE_TABLE, Chart, Columns, Cost, Deformation, Moduli, RunFolder, Series, Shape, convergence_chart,
    precision_chart, swept_chart,
};
use crate::error::{Error, Result};
use crate::file::files_in;
use crate::report::choice::choices;
use crate::report::fit_record::FitRecord;
use crate::report::json::Report;
use crate::report::table::Table;
use crate::study::{BODY, DynamicModuli};

choices! {
    /// What a figure shows.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Figure {
        /// The error of the displacements against the time to fit.
        WorkPrecision = "work-precision",
        /// How the constants of the networks are distributed.
        Constants = "constants",
        /// The distance from the finite elements over time.
        Motion = "motion",
        /// The body under a load: at rest, with finite elements and with springs; from a run with `vtu = true` in `[output]`.
        Deformation = "deformation",
        /// Young's modulus of each network by direction.
        Moduli = "moduli",
        /// Storage and loss moduli of each model over frequency; from a run with `dynamic_moduli` in `[output]`.
        DynamicModuli = "dynamic-moduli",
        /// Errors against the size of the cells, from the folder of springfit converge.
        Convergence = "convergence",
        /// The distribution of the errors, from the folder of springfit compare.
        Ecdf = "ecdf",
        /// The error over Poisson's ratio, from the folder of springfit compare.
        Poisson = "poisson",
        /// The error over the distortion of shapes, from the folder of springfit compare.
        Distortion = "distortion",
        /// The error over the aspect ratio of shapes, from the folder of springfit compare.
        Aspect = "aspect",
        /// The error in the 2-norm against that in the Frobenius norm, from the folder of springfit compare.
        Norms = "norms",
        /// The error over the number of sampled shapes, from the folder of springfit compare.
        Samples = "samples",
        /// The error over a key that was varied, from the folder of springfit sweep; --of names the key.
        Sweep = "sweep",
    }
}

/// A figure that is yet to be drawn.
#[derive(Debug, Clone)]
pub enum Picture {
    /// In the plane of two axes.
    Chart(Chart),
    /// By direction.
    Moduli(Moduli),
    /// A body.
    Deformation(Box<Deformation>),
}

/// Intervals of a distribution.
const INTERVALS: usize = 40;

impl Figure {
    /// The picture of a run: of one fit or load if a name is given, under the load that is named.
    ///
    /// # Errors
    /// The run does not have it, or a file cannot be read.
    pub fn picture(self, run: &RunFolder, of: Option<&str>, load: Option<&str>, cost: Option<Cost>) -> Result<Picture> {
        if let (Some(cost), false) = (cost, self == Figure::WorkPrecision) {
            let found = cost.name();
            return Err(Error::expected("--cost", "the figure work-precision", found));
        }
        if let (Some(load), false) = (load, self == Figure::Deformation) {
            return Err(Error::expected("--load", "the figure deformation; other figures have --of", load));
        }
        Ok(match self {
            Figure::WorkPrecision if run.file(CASES).is_file() => {
                Picture::Chart(compared(run, Drawn::Precision(cost.unwrap_or_default()), of)?)
            }
            Figure::WorkPrecision => Picture::Chart(precision(run, of, cost.unwrap_or_default())?),
            Figure::Constants => Picture::Chart(constants(run, of)?),
            Figure::Motion => Picture::Chart(motion(&run.report()?).map_err(|e| e.in_file(&run.file("report.json")))?),
            Figure::Deformation => Picture::Deformation(Box::new(Deformation::of(run, of, load)?)),
            Figure::Moduli => Picture::Moduli(Moduli::of(run, of)?),
            Figure::DynamicModuli => {
                Picture::Chart(dynamic_moduli(&run.report()?).map_err(|e| e.in_file(&run.file("report.json")))?)
            }
            Figure::Convergence => Picture::Chart(convergence_chart(&run.file(CONVERGENCE_TABLE), of)?),
            Figure::Ecdf => Picture::Chart(compared(run, Drawn::Ecdf, of)?),
            Figure::Poisson => Picture::Chart(compared(run, Drawn::Over("poisson"), of)?),
            Figure::Distortion => Picture::Chart(compared(run, Drawn::Over("distortion"), of)?),
            Figure::Aspect => Picture::Chart(compared(run, Drawn::Over("aspect"), of)?),
            Figure::Norms => Picture::Chart(compared(run, Drawn::Norms, of)?),
            Figure::Samples => Picture::Chart(compared(run, Drawn::Samples, of)?),
            Figure::Sweep => Picture::Chart(swept_chart(run, of)?),
        })
    }
}

impl Figure {
    /// What the picture of a run does not show, one sentence each.
    ///
    /// # Errors
    /// Those of [`Figure::picture`].
    pub fn left_out(self, run: &RunFolder, of: Option<&str>) -> Result<Vec<String>> {
        match self {
            Figure::WorkPrecision if !run.file(CASES).is_file() => without_error(&run.report()?, of),
            Figure::Norms => Ok(thinned(&read_cases(&run.file(""))?, of).into_iter().collect()),
            _ => Ok(Vec::new()),
        }
    }
}

impl Picture {
    /// The figure as an SVG file's text.
    ///
    /// # Errors
    /// Nothing can be shown.
    pub fn svg(&self, columns: Columns) -> Result<String> {
        match self {
            Picture::Chart(chart) => chart.svg(columns),
            Picture::Moduli(moduli) => Ok(moduli.svg(columns)),
            Picture::Deformation(deformation) => Ok(deformation.svg(columns)),
        }
    }
}

/// The place of the load with this name, or of the first, and its name.
fn load_place<'a>(report: &'a Report, load: Option<&str>) -> Result<(usize, &'a str)> {
    let loads = report.fits.first().map_or(&[][..], |fit| &fit.loads);
    let place = match load {
        None => 0,
        Some(name) => loads.iter().position(|load| load.name == name).ok_or_else(|| {
            let names: Vec<&str> = loads.iter().map(|load| load.name.as_str()).collect();
            Error::expected("--of", format!("a load of the run: {}", names.join(", ")), name)
        })?,
    };
    let Some(name) = loads.get(place).map(|load| &load.name) else {
        return Err(Error::new("the run has no loads, so its fits have no errors to draw"));
    };
    Ok((place, name))
}

/// The fits without an error under the load.
fn without_error(report: &Report, load: Option<&str>) -> Result<Vec<String>> {
    let (place, name) = load_place(report, load)?;
    let is_without = |fit: &&FitRecord| fit.loads.get(place).is_none_or(|load| load.error.is_none());
    let words =
        |fit: &FitRecord| format!("{} is not shown: it is {}, without an error under {name}", fit.name, fit.status);
    Ok(report.fits.iter().filter(is_without).map(words).collect())
}

/// A figure of a comparison, of one element or scene if a name is given.
fn compared(run: &RunFolder, drawn: Drawn, of: Option<&str>) -> Result<Chart> {
    let folder = run.file("");
    let records = read_cases(&folder)?;
    let name = folder.file_name().map_or("comparison".into(), |name| name.to_string_lossy());
    let chart = comparison_chart(&name, &records, drawn, of)?;
    match chart.series.iter().all(|series| series.points.is_empty()) {
        true => Err(Error::new(drawn.missing()).in_file(&folder.join(CASES))),
        false => Ok(chart),
    }
}

fn precision(run: &RunFolder, load: Option<&str>, cost: Cost) -> Result<Chart> {
    let report = &run.report()?;
    let (place, name) = load_place(report, load)?;
    let error = |fit: &FitRecord| fit.loads.get(place)?.error.map(|e| e.rms);
    let seconds = |fit: &FitRecord| match cost {
        Cost::Fit => Some(fit.seconds_per_element),
        _ => cost.of_model(fit.model_times.as_ref()?),
    };
    let point = |(place, fit): (usize, &FitRecord)| Some((place, fit.marked(), seconds(fit)?, error(fit)?));
    let mut points: Vec<_> = report.fits.iter().enumerate().filter_map(point).collect();
    if cost != Cost::Fit && report.model_times.is_none() {
        let words = "has no costs of models: springfit run --time measures them";
        return Err(Error::new(words).in_file(&run.file("report.json")));
    }
    if let Some(seconds) = report.model_times.as_ref().and_then(|times| cost.of_model(times)) {
        let known = report.measured.iter().find(|known| known.load == name);
        points.push((
            report.fits.len(),
            BODY.into(),
            seconds,
            known.map_or(Some(0.0), |known| known.fem_e_rms).unwrap_or(f64::NAN),
        ));
    }
    let is_repeated = report.fits.iter().all(|fit| fit.times.is_some());
    let kind = if is_repeated { " (median)" } else { " (one pass)" };
    let title = format!("{}: error under {name} against processor time", report.scene);
    Ok(precision_chart(title, format!("e_rms under {name}, %"), (cost, kind), &points))
}

fn constants(run: &RunFolder, fit: Option<&str>) -> Result<Chart> {
    let network = run.network(fit)?;
    let name = network.provenance.fit.as_ref().map_or("", |fit| &fit.name);
    let mut values: Vec<f64> = network.springs.iter().filter(|s| s.kind == "length").map(|s| s.constant).collect();
    values.sort_by(f64::total_cmp);
    let (Some(&least), Some(&largest)) = (values.first(), values.last()) else {
        return Err(Error::new(format!("{name} has no springs between two points")));
    };
    // Where all are equal, an interval has a width all the same.
    let width = ((largest - least) / INTERVALS as f64).max(1e-6 * largest.abs()).max(f64::MIN_POSITIVE);
    let mut counts = vec![0usize; INTERVALS];
    // The largest value belongs to the last interval, and not to one beyond.
    values.iter().for_each(|value| counts[(((value - least) / width) as usize).min(INTERVALS - 1)] += 1);
    let middle = |i: usize| least + (i as f64 + 0.5) * width;
    let part = |name: &str, keep: fn(f64) -> bool| {
        let points = (0..INTERVALS).filter(|&i| keep(middle(i))).map(|i| (middle(i), counts[i] as f64));
        Series::new(name, points.collect(), Shape::Bars(width))
    };
    let series = vec![part("k ≥ 0", |k| k >= 0.0), part("k < 0", |k| k < 0.0)];
    Ok(Chart {
        title: format!("{name}: constants of {} springs between two points", values.len()),
        x: Axis::linear("constant k, N/m"),
        y: Axis::linear("springs"),
        series: series.into_iter().filter(|part| !part.points.is_empty()).collect(),
    })
}

fn motion(report: &Report) -> Result<Chart> {
    let curve = |model: &crate::report::MotionRecord| {
        let points = model.time.iter().zip(&model.e_rms).filter_map(|(time, error)| Some(((*time)?, (*error)?)));
        let place = report.fits.iter().position(|fit| fit.name == model.name).unwrap_or(report.fits.len());
        let distrust = if model.is_trusted() { "" } else { " (not trusted)" };
        Series::new(format!("{}{distrust}", model.name), points.collect(), Shape::Line).styled(place)
    };
    let has_error = |series: &Series| series.points.iter().any(|(_, error)| *error > 0.0);
    let series: Vec<Series> = report.motion.iter().map(curve).filter(has_error).collect();
    if series.is_empty() {
        let words =
            "has no motion whose distance from the finite elements is known: [motion] of the scene computes one";
        return Err(Error::new(words));
    }
    Ok(Chart {
        title: format!("{}: distance from the finite elements over time", report.scene),
        x: Axis::linear("time, s"),
        y: Axis::linear("e_rms, % of the largest |u|"),
        series,
    })
}

fn dynamic_moduli(report: &Report) -> Result<Chart> {
    let missing = || Error::new("has no moduli over frequency: dynamic_moduli in [output] of the scene computes them");
    let outcome = report.dynamic_moduli.as_ref().ok_or_else(missing)?;
    let curves = |(place, name, moduli): (usize, &str, &DynamicModuli)| {
        let curve = |words: &str, values: &[f64]| {
            // A logarithm has nothing at zero.
            let points =
                outcome.frequency.iter().copied().zip(values.iter().copied()).filter(|(_, value)| *value > 0.0);
            Series::new(format!("{name}, {words}"), points.collect(), Shape::Line).styled(place)
        };
        [curve("storage", &moduli.young.storage), curve("loss", &moduli.young.loss)]
    };
    let models =
        outcome.models.iter().enumerate().filter_map(|(i, model)| Some((i, &*model.name, model.moduli.as_ref()?)));
    let material = outcome.material.iter().map(|moduli| (outcome.models.len(), "material", moduli));
    Ok(Chart {
        title: format!("{}: storage and loss modulus of a tension over frequency", report.scene),
        x: Axis::log("frequency, Hz"),
        y: Axis::log("modulus, Pa"),
        series: models.chain(material).flat_map(curves).filter(|series| !series.points.is_empty()).collect(),
    })
}

/// The tables of the run or of the comparison in a folder.
///
/// # Errors
/// The folder has neither, or the tables are those of a sweep, which its command makes.
pub fn folder_tables(run: &RunFolder) -> Result<Vec<Table>> {
    let folder = run.file("");
    if run.file(CASES).is_file() {
        let records = read_cases(&folder)?;
        return Ok(compare_tables(&summarized("", &records)));
    }
    let is_report = run.file("report.json").is_file();
    if !is_report && files_in(&folder, "jsonl").is_ok_and(|files| !files.is_empty()) {
        let words = "has the studies of a sweep, whose table is table.csv: springfit sweep SCENE --resume --table latex typesets it";
        return Err(Error::new(words).in_file(&folder));
    }
    Ok(Table::all(&run.report()?))
}
