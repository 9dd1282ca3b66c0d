//! `springfit matrix`.

use super::measure::write;
use super::output::OutputOptions;
use crate::terminal::Terminal;
use clap::Args;
use serde::Serialize;
use springfit_bodies::model::{LengthSpring, Network, Specimen};
use springfit_element::springs::distance;
use springfit_fit::fit::{Choices, Fit, GivenFit, GivenStiffness, Objective, condense};
use springfit_foundation::error::{Error, Result};
use springfit_report::report::{PointTable, read_matrix, read_points};
use std::path::PathBuf;

/// Fit springs to a stiffness matrix from elsewhere: of a shell, of displacements and pressures, of a superelement
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Matrix {
    /// The stiffness in the format of Matrix Market: .mtx
    matrix: PathBuf,
    /// A table of the points: columns x, y, z in m, in the order of the rows; or columns rx, ry, rz with the row of each displacement,
    /// from 0. Rows that are not named are condensed: no force acts on them
    #[arg(long)]
    points: PathBuf,
    /// frobenius, offdiag, modal, spectral or divergence
    #[arg(long, default_value = "frobenius", help_heading = "Fit")]
    objective: String,
    /// The weight of frobenius and spectral: none, modal or relative
    #[arg(long, help_heading = "Fit")]
    weight: Option<String>,
    /// No constant is below zero
    #[arg(long, help_heading = "Fit")]
    nonnegative: bool,
    /// Springs are no longer than this, m [default: between all points]
    #[arg(long, allow_hyphen_values = true, help_heading = "Fit")]
    longest: Option<f64>,
    /// Where the springs go: .json, .npz, .csv or .vtu
    #[arg(short, long, help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    format: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit matrix shell.mtx --points nodes.csv -o springs.csv
  springfit matrix superelement.mtx --points boundary.csv --objective spectral -o springs.json
  springfit matrix block.mtx --points nodes.csv --objective offdiag --nonnegative -o springs.npz";

/// What is printed as JSON.
#[derive(Serialize)]
struct Record<'a> {
    points: usize,
    condensed: usize,
    springs: usize,
    negative_springs: usize,
    objective: String,
    relative_frobenius: f64,
    relative_spectral: f64,
    is_unique: bool,
    reached: bool,
    gap: Option<f64>,
    constants: &'a [f64],
}

impl Matrix {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        springfit_foundation::file::check_apart(
            std::slice::from_ref(&self.output),
            &[self.matrix.clone(), self.points.clone()],
        )?;
        let choices = Choices { weight: self.weight.as_deref(), ..Choices::default() };
        let objective = Objective::named(&self.objective, choices).map_err(Error::of_option)?;
        let fit = Fit { nonnegative: self.nonnegative, ..Fit::new(objective) };
        let matrix = read_matrix(&self.matrix)?;
        let PointTable { points, dimension: d, numbers, rows, .. } = read_points(&self.points)?;
        // Without columns of rows the order of the points is that of the matrix, and numbers may only confirm it.
        if let (None, Some(at)) = (&rows, numbers.windows(2).position(|pair| pair[1] < pair[0])) {
            let expected = "points in ascending order, as the rows of the matrix, or their rows in columns rx, ry, rz";
            let found = format!("{} after {}", numbers[at + 1], numbers[at]);
            return Err(Error::expected("point", expected, found).in_file(&self.points));
        }
        let order = matrix.nrows();
        let of_matrix = |e: Error| e.placed(|e| e.in_file(&self.matrix));
        let (matrix, condensed) = match &rows {
            Some(rows) => (condense(&matrix, rows).map_err(of_matrix)?, order.saturating_sub(rows.len())),
            None => (matrix, 0),
        };
        let given = GivenStiffness::new(matrix, points.clone(), d).map_err(of_matrix)?;
        let at = |p: usize| &points[p * d..(p + 1) * d];
        let is_short = |[i, j]: &[usize; 2]| self.longest.is_none_or(|longest| distance(at(*i), at(*j)) <= longest);
        let pairs: Vec<[usize; 2]> = given.pairs().into_iter().filter(is_short).collect();
        // Without a limit the fit tells that there are no pairs.
        if let (Some(longest), true) = (self.longest, pairs.is_empty()) {
            return Err(Error::expected("--longest", "a length of at least one pair of points, m", longest));
        }
        let found = given.fit(&pairs, &fit).map_err(of_matrix)?;
        let spring = |(points, constant): (&[usize; 2], &f64)| LengthSpring {
            points: *points,
            constant: *constant,
            rest: distance(at(points[0]), at(points[1])),
        };
        let lengths = pairs.iter().zip(&found.constants).map(spring).collect();
        let specimen = Specimen::new(Network { dimension: d, lengths, others: Vec::new() }, points.clone());
        write(&specimen, &self.output)?;
        let negative = found.constants.iter().filter(|k| **k < 0.0).count();
        let record = Record {
            points: points.len() / d,
            condensed,
            springs: pairs.len(),
            negative_springs: negative,
            objective: objective.title(),
            relative_frobenius: found.frobenius,
            relative_spectral: found.spectral,
            is_unique: found.is_unique,
            reached: found.reached,
            gap: found.gap,
            constants: &found.constants,
        };
        let text = || text(&record, &found);
        if self.format.is_text() || self.format.json {
            self.format.print(terminal, || &record, Vec::new, text)?;
        } else {
            return Err(Error::at("--table", "belongs to commands with tables"));
        }
        if !found.reached {
            terminal.note("the search has not reached its accuracy");
        }
        if !found.is_unique {
            terminal.note("other constants reach the same value: these are the smallest");
        }
        terminal.written(std::slice::from_ref(&self.output))
    }
}

fn text(record: &Record, found: &GivenFit) -> String {
    let condensed = match record.condensed {
        0 => String::new(),
        count => format!(", {count} rows condensed"),
    };
    format!(
        "{} points{condensed}; R is symmetric and has no forces under rigid motions\n{}: {} springs, {} negative, |R-K|/|R| = {:.6} Frobenius, {:.6} 2-norm\n",
        record.points, record.objective, record.springs, record.negative_springs, found.frobenius, found.spectral
    )
}
