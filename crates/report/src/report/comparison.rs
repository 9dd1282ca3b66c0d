//! Tables, CSV and a work-precision plot of a comparison.

use super::figure::{Columns, Cost, precision_chart};
use super::summary::summary_line;
use super::table::{Column, Table};
use super::write_files;
use crate::error::{Error, Result};
use crate::file::Edition;
use crate::study::Outcome;
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
    /// Every fit of a scene; the plot has the geometric mean of e_rms over the loads. Networks that do not stand have no
    /// point.
    pub fn of_scene(outcome: &Outcome) -> Comparison {
        let mut columns = vec![Column::words("fit"), Column::numbers("time").unit("µs/element")];
        for load in &outcome.loads {
            let standard = load.measured.as_ref().map_or("", |measured| measured.standard.heading());
            let group = format!("{}{standard}", load.name);
            columns.extend(["e_rms", "e_max"].map(|error| Column::numbers(error).unit("%").group(&*group)));
        }
        columns.extend(["springs", "k < 0"].map(Column::numbers));
        columns.extend([Column::numbers("error of C").unit("%"), Column::words("network")]);
        let (mut rows, mut points) = (Vec::new(), Vec::new());
        for fit in &outcome.fits {
            let seconds = fit.seconds_per_element(outcome.mesh.cell_count());
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
                // An error of zero has no logarithm: rounding takes its place.
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
        let known: Vec<_> = {
            // A fit looks the same whatever the others are.
            let all = self.points.iter().enumerate().map(|(place, (name, s, e))| (place, name.clone(), *s, *e));
            all.filter(|(.., s, e)| *s > 0.0 && *e > 0.0).collect()
        };
        if known.is_empty() {
            return Err(Error::new("nothing to plot: no fit has an error above zero"));
        }
        precision_chart(self.table.title.clone(), self.error.clone(), (Cost::Fit, " (median)"), &known)
            .svg(Columns::Two)
    }
}
