//! Tables, CSV and a work-precision plot of a comparison.

use super::columns::{Heading, aligned, texts};
use super::result_table::ResultTable;
use super::rows::csv;
use super::table::summary_line;
use super::write_files;
use crate::error::{Error, Result};
use crate::study::{EffectiveModuli, MethodOutcome, Outcome};
use crate::text::printable;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

/// What [`Comparison::write`] writes.
pub const COMPARISON_FILES: [&str; 2] = ["table.csv", "plot.svg"];

/// Rows of text under headings: those of a table and of its CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The element, the shapes and the material.
    pub title: String,
    /// What is compared, under the title of the table.
    pub about: Option<String>,
    /// The headings.
    pub columns: Vec<Heading>,
    /// The cells of the table, one row per fit and solver.
    pub rows: Vec<Vec<String>>,
    /// What the plot shows: a name per point, seconds per element, and the error.
    pub points: Vec<(String, f64, f64)>,
    /// What the error is.
    pub error: String,
}

impl Comparison {
    /// Every method on random shapes of one element, with the moduli of its springs beside `young` that was asked for; the plot
    /// has the relative 2-norm error.
    pub fn of_element(title: String, outcomes: &[MethodOutcome], young: f64) -> Comparison {
        let columns = [
            Heading::words("objective"),
            Heading::words("solver"),
            Heading::numbers("us/element median"),
            Heading::numbers("us/element least"),
            Heading::numbers("us/element largest"),
            Heading::numbers("Frobenius mean"),
            Heading::numbers("Frobenius max"),
            Heading::numbers("2-norm mean"),
            Heading::numbers("2-norm max"),
            Heading::numbers("gap max"),
            Heading::numbers("% k < 0"),
            Heading::numbers("E / material"),
            Heading::numbers("nu"),
            Heading::numbers("Zener"),
        ];
        let row = |o: &MethodOutcome| {
            let [least, median, largest] = o.seconds.map(|s| format!("{:.3}", 1e6 * s));
            // One run has no spread.
            let of_several = |time: String| if o.runs > 1 { time } else { "-".into() };
            let share = |v: f64| format!("{v:.4}");
            let modulus = |of: &dyn Fn(&EffectiveModuli) -> f64| {
                o.moduli.as_ref().map_or("-".into(), |m| format!("{:.3}", of(m)))
            };
            vec![
                o.name.clone(),
                o.solver.to_string(),
                median,
                of_several(least),
                of_several(largest),
                share(o.frobenius.mean),
                share(o.frobenius.max),
                share(o.spectral.mean),
                share(o.spectral.max),
                o.gap.map_or("-".into(), |gap| format!("{gap:.1e}")),
                format!("{:.1}", 100.0 * o.negative),
                modulus(&|m| m.young / young),
                modulus(&|m| m.poisson),
                modulus(&|m| m.zener),
            ]
        };
        let name = |o: &MethodOutcome| {
            if ["native", "formula"].contains(&o.solver) {
                o.name.clone()
            } else {
                format!("{} by {}", o.name, o.solver)
            }
        };
        Comparison {
            title,
            about: None,
            columns: columns.into(),
            rows: outcomes.iter().map(row).collect(),
            points: outcomes.iter().map(|o| (name(o), o.seconds[1], o.spectral.mean)).collect(),
            error: "mean |R-K|/|R|, 2-norm".into(),
        }
    }

    /// Every fit of a scene; the plot has the geometric mean of %e_rms over the loads. Networks that do not stand have no
    /// point.
    pub fn of_scene(outcome: &Outcome) -> Comparison {
        let elements = outcome.mesh.cell_count().max(1) as f64;
        let mut columns = vec![Heading::words("fit"), Heading::numbers("us/element")];
        for load in &outcome.loads {
            columns.extend(["rms", "max"].map(|error| Heading::numbers(format!("{} %e_{error}", load.name))));
        }
        columns.extend(["springs", "k < 0", "tensor % off"].map(Heading::numbers));
        columns.push(Heading::words("network"));
        let (mut rows, mut points) = (Vec::new(), Vec::new());
        for fit in &outcome.fits {
            let seconds = fit.seconds / elements;
            let mut row = vec![fit.fit.name.clone(), format!("{:.3}", 1e6 * seconds)];
            for load in &fit.loads {
                let percent = |value: Option<f64>| value.map_or("-".into(), |v| format!("{v:.2}"));
                row.extend([percent(load.error.map(|e| e.rms)), percent(load.error.map(|e| e.max))]);
            }
            row.push(fit.network.len().to_string());
            row.push(fit.network.negative().to_string());
            row.push(format!("{:.1}", 100.0 * fit.as_material.distance));
            row.push(fit.status().into());
            rows.push(row);
            let errors: Option<Vec<f64>> = fit.loads.iter().map(|l| l.error.map(|e| e.rms)).collect();
            if let Some(errors) = errors.filter(|errors| !errors.is_empty()) {
                let mean = errors.iter().map(|e| e.max(1e-12).ln()).sum::<f64>() / errors.len() as f64;
                points.push((fit.fit.name.clone(), seconds, mean.exp()));
            }
        }
        let error = "%e_rms, geometric mean of the loads".into();
        let title = printable(&outcome.scene).into_owned();
        let about = Some(summary_line(outcome));
        Comparison { title, about, columns, rows, points, error }
    }

    /// The table as text.
    pub fn table(&self) -> String {
        let about = self.about.as_ref().map_or(String::new(), |about| format!("{about}\n"));
        format!("{}\n{about}\n{}", self.title, aligned(&self.columns, &self.rows))
    }

    /// The table, to be typeset.
    pub fn result_table(&self) -> ResultTable {
        ResultTable::printed("comparison", &self.title, &self.columns, &self.rows)
    }

    /// The table as CSV.
    pub fn csv(&self) -> String {
        csv(&texts(&self.columns), &self.rows)
    }

    /// Writes `table.csv` and `plot.svg` into `folder`, and returns the paths.
    ///
    /// # Errors
    /// Nothing can be plotted; the folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let [table, plot] = COMPARISON_FILES;
        let files = [(table, self.csv()), (plot, self.plot()?)];
        write_files(folder, &files)
    }

    /// Error against seconds per element, both logarithmic; an SVG file's text.
    ///
    /// # Errors
    /// No method has a time and an error above zero.
    pub fn plot(&self) -> Result<String> {
        let known: Vec<_> = self.points.iter().filter(|(_, s, e)| *s > 0.0 && *e > 0.0).collect();
        // Errors of rounding are drawn under the others, with their numbers: an axis down to them would show nothing else.
        let largest = known.iter().map(|(_, _, e)| *e).fold(0.0, f64::max);
        let least = known.iter().map(|(_, _, e)| *e).filter(|e| *e >= largest * 1e-4).fold(largest, f64::min);
        let placed = |(name, s, e): &(String, f64, f64)| match *e < largest * 1e-4 {
            true => (format!("{name} ({e:.0e})"), *s, least / 3.0),
            false => (name.clone(), *s, *e),
        };
        let shown: Vec<_> = known.into_iter().map(placed).collect();
        let shown: Vec<_> = shown.iter().collect();
        if shown.is_empty() {
            return Err(Error::new("nothing to plot: no fit has an error above zero"));
        }
        let range = |values: &dyn Fn(&(String, f64, f64)) -> f64| {
            let least = shown.iter().map(|p| values(p)).fold(f64::INFINITY, f64::min);
            let largest = shown.iter().map(|p| values(p)).fold(0.0, f64::max);
            let fitted = least / 1.3..largest * 1.3;
            // Whole decades where the axis had less than two numbers.
            match fitted.end.log10().floor() - fitted.start.log10().ceil() >= 1.0 {
                true => fitted,
                // A little more, so that rounding does not take the numbers at the ends from the axis.
                false => {
                    let [start, end] = [fitted.start.log10().floor(), fitted.end.log10().ceil()];
                    10f64.powf(start) * 0.999..10f64.powf(end) * 1.001
                }
            }
        };
        let mut text = String::new();
        draw(&mut text, self, &shown, range(&|p| 1e6 * p.1), range(&|p| p.2))
            .map_err(|e| Error::new(format!("the plot cannot be drawn: {e}")))?;
        Ok(text)
    }
}

/// Okabe and Ito (2008): told apart by all eyes and on paper. Each eight methods share a mark.
pub(super) const COLORS: [RGBColor; 8] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(180, 170, 30),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
];

fn draw(
    text: &mut String,
    comparison: &Comparison,
    points: &[&(String, f64, f64)],
    seconds: std::ops::Range<f64>,
    errors: std::ops::Range<f64>,
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    const HEIGHT: i32 = 520;
    let legend = 22 * points.len() as i32;
    let area = SVGBackend::with_string(text, (980, HEIGHT.max(legend + 80) as u32)).into_drawing_area();
    area.fill(&WHITE)?;
    let (plot, names) = area.split_horizontally(640);
    let mut chart = ChartBuilder::on(&plot)
        .margin(16)
        .caption(&comparison.title, ("sans-serif", 17))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(seconds.log_scale(), errors.log_scale())?;
    let number =
        |v: &f64| if *v >= 0.01 && *v < 1e5 { format!("{}", (v * 1e4).round() / 1e4) } else { format!("{v:.0e}") };
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("fit, microseconds per element")
        .y_desc(&comparison.error)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 13))
        .draw()?;
    for (i, (name, s, e)) in points.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let at = (1e6 * s, *e);
        let label = 30 + 22 * i as i32;
        match i / COLORS.len() % 3 {
            0 => {
                chart.draw_series([Circle::new(at, 5, color.filled())])?;
                names.draw(&Circle::new((14, label + 7), 5, color.filled()))?;
            }
            1 => {
                chart.draw_series([TriangleMarker::new(at, 7, color.filled())])?;
                names.draw(&TriangleMarker::new((14, label + 7), 7, color.filled()))?;
            }
            _ => {
                chart.draw_series([Cross::new(at, 5, color.stroke_width(3))])?;
                names.draw(&Cross::new((14, label + 7), 5, color.stroke_width(3)))?;
            }
        }
        names.draw(&Text::new(name.clone(), (30, label), ("sans-serif", 14)))?;
    }
    area.present()?;
    Ok(())
}
