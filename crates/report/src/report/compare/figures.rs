//! The figures of a comparison.

use super::pairs::{fits, method};
use crate::error::{Error, Result};
use crate::order::{distinct, grouped};
use crate::report::figure::{Axis, Chart, Cost, Series, Shape};
use crate::study::statistics::{Quantiles, median};
use crate::study::{CaseRecord, MethodRecord};
use serde_json::Value;

/// What a figure of a comparison shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// The error against processor time, with quartiles, and the Pareto front.
    Precision(Cost),
    /// The share of shapes or loads whose error is at most that of the axis.
    Ecdf,
    /// The error over a key that cases differ in.
    Over(&'static str),
    /// The error in the 2-norm against that in the Frobenius norm, for each shape.
    Norms,
    /// The error over the number of shapes that a fit is sampled at.
    Samples,
}

impl Drawn {
    /// What a comparison lacks that has nothing to draw.
    pub fn missing(self) -> &'static str {
        match self {
            Drawn::Precision(Cost::Fit) => "has no times: time = false leaves them out",
            Drawn::Precision(_) => "has no such times: cases that are scenes have them",
            Drawn::Ecdf | Drawn::Over(_) => "has no errors above those of rounding",
            Drawn::Norms => "has no errors in both norms: cases that are shapes of elements have them",
            Drawn::Samples => {
                "has no fits with several numbers of shapes: shapes = { count = [10, 100] } of sampled fits has them"
            }
        }
    }
}

/// Points of a scatter for each fit at most: more cover each other, and a picture of dozens of fits stays of a size that opens.
const MOST: usize = 1000;
/// Errors below this share of the largest are those of rounding.
// An axis of logarithms that had them would be mostly empty, and those of fits that differ would be pressed together.
const ROUNDING: f64 = 1e-9;

/// The chart, of the cases whose element or scene is `of`, or of all.
///
/// # Errors
/// No case is left, or no method has such figures.
pub fn comparison_chart(title: &str, records: &[CaseRecord], drawn: Drawn, of: Option<&str>) -> Result<Chart> {
    let is_named = |record: &&CaseRecord| of.is_none_or(|of| record.object() == of);
    let own: Vec<&CaseRecord> = records.iter().filter(is_named).filter(|record| record.error.is_none()).collect();
    if let (Some(of), true) = (of, own.is_empty()) {
        let names = distinct(records.iter().map(CaseRecord::object));
        return Err(Error::expected(
            "--of",
            format!("an element or a scene of the comparison: {}", names.join(", ")),
            of,
        ));
    }
    if let Drawn::Over(key) = drawn
        && !own.iter().any(|record| record.settings.get(key) != own[0].settings.get(key))
    {
        return Err(Error::new(format!("expected cases with several values of {key}, found one")));
    }
    let data = Data { quantity: quantity(&own), records: own };
    let chart = match drawn {
        Drawn::Precision(cost) => data.precision(cost),
        Drawn::Ecdf => data.ecdf(),
        Drawn::Over(key) => data.over(key, |_, record| number(record.settings.get(key))),
        Drawn::Samples => data.samples(),
        Drawn::Norms => data.norms(),
    };
    let of = of.map_or(String::new(), |of| format!(", {of}"));
    Ok(Chart { title: format!("{title}{of}: {}", chart.title), ..chart })
}

/// The figure of merit of most methods.
fn quantity(records: &[&CaseRecord]) -> &'static str {
    let count = |name: &str| records.iter().flat_map(|r| &r.methods).filter(|m| m.values.contains_key(name)).count();
    ["spectral", "e_rms"].into_iter().max_by_key(|name| count(name)).unwrap_or("e_rms")
}

struct Data<'a> {
    quantity: &'static str,
    records: Vec<&'a CaseRecord>,
}

fn number(value: Option<&Value>) -> Option<f64> {
    value.and_then(Value::as_f64)
}

impl Data<'_> {
    fn error(&self) -> &'static str {
        if self.quantity == "spectral" { "relative error in the 2-norm" } else { "e_rms, %" }
    }

    fn fits(&self) -> Vec<String> {
        fits(self.records.iter().copied()).into_iter().map(String::from).collect()
    }

    /// All errors of a fit.
    fn errors(&self, fit: &str) -> Vec<f64> {
        let lists = self.records.iter().filter_map(|r| method(r, fit)?.values.get(self.quantity));
        lists.flatten().copied().flatten().collect()
    }

    fn largest(&self) -> f64 {
        self.fits().iter().flat_map(|fit| self.errors(fit)).fold(0.0, f64::max)
    }

    /// Marks with bars from the lower to the upper quartile of errors and of times, and the methods that no other beats in both.
    fn precision(&self, cost: Cost) -> Chart {
        let (kind, unit, per_second) = cost.of_comparison();
        let least = ROUNDING * self.largest();
        let (mut series, mut points) = (Vec::new(), Vec::new());
        for (place, fit) in self.fits().into_iter().enumerate() {
            let medians = self.records.iter().filter_map(|r| Some(median(method(r, &fit)?.times.get(kind)?)));
            let times = Quantiles::of(&medians.collect::<Vec<f64>>());
            let errors = Quantiles::of(&self.errors(&fit));
            // Without a time or an error a fit has no place in the plane of both.
            if times.count == 0 || errors.count == 0 {
                continue;
            }
            let (x, y) = (per_second * times.median, errors.median.max(least));
            if errors.median > least {
                points.push((x, y));
            }
            let shape = if errors.median > least { Shape::Marks } else { Shape::Below };
            series.push(Series::new(fit, vec![(x, y)], shape).styled(place));
            let ends = |low: f64, high: f64| [low.max(least), high.max(least)];
            let [low, high] = ends(errors.lower, errors.upper);
            let across = [per_second * times.lower, per_second * times.upper];
            let bars = vec![(x, low), (x, high), (across[0], y), (across[1], y)];
            series.push(Series::new("", bars, Shape::Whiskers));
        }
        let lowest = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        for series in &mut series {
            if series.shape == Shape::Below {
                // Rounding has no place on the axis: an open mark below the others.
                series.points[0].1 = lowest / 3.0;
            }
        }
        series.retain(|series| series.shape != Shape::Whiskers || series.points.iter().all(|p| p.1 > 2.0 * least));
        // A method without error beats all that take as long or longer.
        let exact = series.iter().filter(|series| series.shape == Shape::Below).map(|series| series.points[0].0);
        let exact = exact.fold(f64::INFINITY, f64::min);
        points.retain(|point| point.0 < exact);
        let front = front(points);
        if let [.., (x, y), (to_x, to_y)] = front[..] {
            // The name stands above the middle of the last part, where no mark is.
            let middle = ((x * to_x).sqrt(), (y * to_y).sqrt());
            series.push(Series::new("Pareto front", vec![middle], Shape::Guide));
        }
        series.push(Series::new("", front, Shape::Guide));
        Chart {
            title: format!("{} against processor time", self.error()),
            x: Axis::log(format!("processor time {}, {unit} (median)", cost.words())),
            y: Axis::log(format!("{} (median and quartiles)", self.error())),
            series,
        }
    }

    fn ecdf(&self) -> Chart {
        let least = ROUNDING * self.largest();
        let curve = |(place, fit): (usize, String)| {
            let mut errors: Vec<f64> = self.errors(&fit).into_iter().filter(|error| *error > least).collect();
            errors.sort_by(f64::total_cmp);
            let count = errors.len() as f64;
            let step = |(i, error): (usize, &f64)| [(*error, i as f64 / count), (*error, (i + 1) as f64 / count)];
            Series::new(fit, errors.iter().enumerate().flat_map(step).collect(), Shape::Line).styled(place)
        };
        let series = self.fits().into_iter().enumerate().map(curve).filter(|curve| !curve.points.is_empty()).collect();
        Chart {
            title: "distribution of the errors".into(),
            x: Axis::log(self.error()),
            y: Axis::linear("share of shapes or loads"),
            series,
        }
    }

    /// The median error of each fit over a value of its cases.
    fn over(&self, key: &str, value: impl Fn(&MethodRecord, &CaseRecord) -> Option<f64>) -> Chart {
        let least = ROUNDING * self.largest();
        let curve = |(place, fit): (usize, String)| {
            let errors = self.records.iter().filter_map(|record| {
                let method = method(record, &fit)?;
                let at = value(method, record)?;
                Some(method.values.get(self.quantity)?.iter().copied().flatten().map(move |error| (at, error)))
            });
            let mut known = grouped(errors.flatten());
            known.sort_by(|a, b| a.0.total_cmp(&b.0));
            let points = known.iter().map(|(at, errors)| (*at, median(errors))).filter(|point| point.1 > least);
            Series::new(fit, points.collect(), Shape::Curve).styled(place)
        };
        let series: Vec<Series> =
            self.fits().into_iter().enumerate().map(curve).filter(|curve| !curve.points.is_empty()).collect();
        let name = if key == "poisson" { "Poisson's ratio ν" } else { key };
        Chart {
            title: format!("{} over {name}", self.error()),
            x: Axis::linear(name),
            y: Axis::log(format!("{} (median)", self.error())),
            series,
        }
    }

    /// The error over the number of sampled shapes: a curve for each family of fits that differ in it alone.
    fn samples(&self) -> Chart {
        let point = |method: &MethodRecord| {
            let count = number(method.settings.get("shapes.count"))?;
            let held_out = method.figures.get("held_out").copied().flatten()?;
            let own = format!("count {count}");
            let name = method.fit.split(", ").filter(|part| *part != own).collect::<Vec<_>>().join(", ");
            Some((name, (count, 100.0 * held_out)))
        };
        let curve = |(name, mut points): (String, Vec<(f64, f64)>)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            Series::new(name, points, Shape::Curve)
        };
        let points = self.records.iter().flat_map(|record| &record.methods).filter_map(point);
        let series = grouped(points).into_iter().map(curve).collect();
        Chart {
            title: "error of the forces at shapes held out over the number of shapes".into(),
            x: Axis::log("shapes"),
            y: Axis::log("error at shapes held out, %"),
            series,
        }
    }

    /// The errors of a fit in the Frobenius norm and in the 2-norm.
    fn in_both_norms(&self, fit: &str) -> Vec<(f64, f64)> {
        let pairs = self.records.iter().filter_map(|record| {
            let values = &method(record, fit)?.values;
            Some(values.get("frobenius")?.iter().zip(values.get("spectral")?))
        });
        pairs.flatten().filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect()
    }

    /// The most shapes of a fit with errors in both norms.
    fn most_in_both_norms(&self) -> usize {
        self.fits().iter().map(|fit| self.in_both_norms(fit).len()).max().unwrap_or(0)
    }

    fn norms(&self) -> Chart {
        let scatter = |(place, fit): (usize, String)| {
            let all = self.in_both_norms(&fit);
            // Without points the quotient is zero, by which no iterator steps.
            let every = all.len().div_ceil(MOST).max(1);
            let points = all.into_iter().step_by(every).filter(|(a, b)| *a > ROUNDING && *b > ROUNDING).collect();
            Series::new(fit, points, Shape::Dots).styled(place)
        };
        let series =
            self.fits().into_iter().enumerate().map(scatter).filter(|series| !series.points.is_empty()).collect();
        let every = self.most_in_both_norms().div_ceil(MOST).max(1);
        let which = if every > 1 { format!("one in {every} shapes") } else { "each shape".into() };
        Chart {
            title: format!("the error of {which} in both norms"),
            x: Axis::log("relative error in the Frobenius norm"),
            y: Axis::log("relative error in the 2-norm"),
            series,
        }
    }
}

/// That the figure of both norms has a part of the shapes alone, if it has.
pub fn thinned(records: &[CaseRecord], of: Option<&str>) -> Option<String> {
    let is_shown = |record: &&CaseRecord| record.error.is_none() && of.is_none_or(|of| record.object() == of);
    let data = Data { quantity: "spectral", records: records.iter().filter(is_shown).collect() };
    let count = data.most_in_both_norms();
    let every = count.div_ceil(MOST).max(1);
    (every > 1)
        .then(|| format!("one in {every} of the {count} shapes of a fit is drawn: {} points", count.div_ceil(every)))
}

/// The points that no other is at most as far in both directions, from the left.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    // Of equal times the least error comes first, so that the others are not below it.
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
}

/// The figures for which a comparison has data, with their names.
pub fn all(records: &[CaseRecord]) -> Vec<(String, Drawn)> {
    let differs = |key: &str| records.iter().any(|record| record.settings.get(key) != records[0].settings.get(key));
    let methods = || records.iter().flat_map(|record| &record.methods);
    let has_times = |kind: &str| methods().any(|method| method.times.contains_key(kind));
    let mut all = Vec::new();
    for cost in Cost::all() {
        let (kind, ..) = cost.of_comparison();
        let name = if cost == Cost::Fit { "precision".into() } else { format!("precision-{kind}") };
        all.extend(has_times(kind).then_some((name, Drawn::Precision(cost))));
    }
    all.push(("ecdf".into(), Drawn::Ecdf));
    for key in ["poisson", "distortion", "aspect"] {
        all.extend((!records.is_empty() && differs(key)).then_some((key.into(), Drawn::Over(key))));
    }
    let has_norms = methods().any(|method| method.values.contains_key("spectral"));
    all.extend(has_norms.then_some(("norms".into(), Drawn::Norms)));
    let has_samples = methods().any(|method| method.settings.contains_key("shapes.count"));
    all.extend(has_samples.then_some(("samples".into(), Drawn::Samples)));
    all
}
