//! Tables, CSV and a work-precision plot of a comparison.

use super::figure::{Columns, precision_chart};
use super::summary::summary_line;
use super::table::{Column, Table};
use super::write_files;
use crate::error::{Error, Result};
use crate::file::Edition;
use crate::study::{EffectiveModuli, MethodOutcome, Outcome};
use crate::text::printable;
use std::path::PathBuf;

/// What [`Comparison::write`] writes.
pub const COMPARISON_FILES: [&str; 2] = ["table.csv", "plot.svg"];

/// A table with one row per fit and solver, and its plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The title names the element, the shapes and the material.
    pub table: Table,
    /// What is compared, under the title of the table.
    pub about: Option<String>,
    /// What the plot shows: a name per point, seconds per element, and the error.
    pub points: Vec<(String, f64, f64)>,
    /// What the error is.
    pub error: String,
}

impl Comparison {
    /// Every method on random shapes of one element, with the moduli of its springs beside `young` that was asked for; the plot
    /// has the relative 2-norm error.
    pub fn of_element(title: String, outcomes: &[MethodOutcome], young: f64) -> Comparison {
        let time = |title| Column::numbers(title).unit("µs/element");
        let columns = vec![
            Column::words("objective"),
            Column::words("solver"),
            time("median"),
            time("least"),
            time("largest"),
            Column::numbers("mean").group("Frobenius"),
            Column::numbers("max").group("Frobenius"),
            Column::numbers("mean").group("2-norm"),
            Column::numbers("max").group("2-norm"),
            Column::numbers("gap max"),
            Column::numbers("k < 0").unit("%"),
            Column::numbers("E / material"),
            Column::numbers("ν"),
            Column::numbers("Zener"),
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
            table: Table::new("comparison", title, columns, outcomes.iter().map(row)),
            about: None,
            points: outcomes.iter().map(|o| (name(o), o.seconds[1], o.spectral.mean)).collect(),
            error: "mean |R-K|/|R|, 2-norm".into(),
        }
    }

    /// Every fit of a scene; the plot has the geometric mean of e_rms over the loads. Networks that do not stand have no
    /// point.
    pub fn of_scene(outcome: &Outcome) -> Comparison {
        let elements = outcome.mesh.cell_count().max(1) as f64;
        let mut columns = vec![Column::words("fit"), Column::numbers("time").unit("µs/element")];
        for load in &outcome.loads {
            let standard = load.measured.map_or("", |measured| measured.standard.heading());
            let group = format!("{}{standard}", load.name);
            columns.extend(["e_rms", "e_max"].map(|error| Column::numbers(error).unit("%").group(&*group)));
        }
        columns.extend(["springs", "k < 0"].map(Column::numbers));
        columns.extend([Column::numbers("error of C").unit("%"), Column::words("network")]);
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
        let error = "e_rms in %, geometric mean of the loads".into();
        let table = Table::new("comparison", printable(&outcome.scene), columns, rows);
        Comparison { table, about: Some(summary_line(outcome)), points, error }
    }

    /// The table as text.
    pub fn text(&self) -> String {
        let about = self.about.as_ref().map_or(String::new(), |about| format!("{about}\n"));
        format!("{}\n{about}\n{}", self.table.title, self.table.text())
    }

    /// Writes `table.csv` and `plot.svg`, and returns the paths.
    ///
    /// # Errors
    /// Nothing can be plotted; a file cannot be written, and the folder is as it was.
    pub fn write(&self, edition: Edition) -> Result<Vec<PathBuf>> {
        let [table, plot] = COMPARISON_FILES;
        let files = [(table, self.table.csv()), (plot, self.plot()?)];
        write_files(edition, &files)
    }

    /// Error against seconds per element, both logarithmic; an SVG file's text.
    ///
    /// # Errors
    /// No method has a time and an error above zero.
    pub fn plot(&self) -> Result<String> {
        let known: Vec<_> = self.points.iter().filter(|(_, s, e)| *s > 0.0 && *e > 0.0).cloned().collect();
        if known.is_empty() {
            return Err(Error::new("nothing to plot: no fit has an error above zero"));
        }
        precision_chart(self.table.title.clone(), self.error.clone(), &known).svg(Columns::Two)
    }
}
