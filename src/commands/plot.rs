//! `springfit plot`.

use super::choice::choice;
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::{check_apart, check_file, write_whole};
use springfit_report::report::{Columns, Cost, Figure, Markup, PictureFormat, RunFolder, Table, folder_tables};
use std::path::PathBuf;

/// Figures and tables for a paper, from the folder of a run, a comparison, a sweep or a convergence study
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Plot {
    /// The folder of a run with its report.json, or that of a comparison, a sweep or a convergence study
    run: PathBuf,
    /// Draw this figure
    #[arg(long, value_parser = choice::<Figure>(), conflicts_with = "table", required_unless_present = "table")]
    figure: Option<Figure>,
    /// Typeset the tables of the run
    #[arg(long, value_parser = choice::<Markup>())]
    table: Option<Markup>,
    /// One load or fit of the figure, one element or scene of a comparison, a key of a sweep, or one table: overview, fits, errors, materials, times, costs, whole, unseen, frequencies, motion, damping, dynamic_moduli; of a comparison: comparison, objects, objects-frobenius, objects-e_rms, pairs, ranks
    #[arg(long, value_name = "NAME")]
    of: Option<String>,
    /// The load of the figure deformation, whose fit is --of [default: the first]
    #[arg(long, value_name = "NAME", conflicts_with = "table")]
    load: Option<String>,
    /// What the figure work-precision has across; all but fit need a run that measured costs [default: fit]
    #[arg(long, value_parser = choice::<Cost>(), conflicts_with = "table")]
    cost: Option<Cost>,
    /// Columns of the page that the figure is as wide as: 85 or 178 mm
    #[arg(long, value_parser = choice::<Columns>(), default_value = "one")]
    columns: Columns,
    /// Where it goes: of a figure .svg, or .pdf or .png by the program springfit-pictures [default: standard output, as SVG]
    #[arg(short, long, help_heading = "Output")]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  springfit plot out/cube_tet --figure work-precision -o precision.svg
  springfit plot out/cube_tet --figure work-precision --cost solve -o solve.svg   # of a run that measured costs
  springfit plot out/cube_tet --figure constants --of exact --columns two -o constants.svg
  springfit plot out/cube_tet --figure deformation --of exact --load shear -o shear.svg   # of a run with [output] vtu = true
  springfit plot out/cube_tet --figure moduli -o moduli.svg
  springfit plot out/converge-cube_tet --figure convergence -o convergence.svg
  springfit plot out/compare-norms --figure ecdf --of tet4 -o ecdf.svg
  springfit plot out/compare-norms --figure work-precision -o precision.svg
  springfit plot out/sweep-cube_tet --figure sweep --of material.poisson -o sweep.svg
  springfit plot out/cube_tet --table latex --of errors -o errors.tex   # with \\usepackage{booktabs}
  springfit plot out/cube_tet --table markdown";

impl Plot {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let run = RunFolder::at(&self.run);
        let format = match (&self.output, self.figure) {
            (Some(path), Some(_)) => PictureFormat::of(path)?,
            _ => PictureFormat::Svg,
        };
        if let Some(path) = &self.output {
            check_apart(std::slice::from_ref(path), &[self.run.join("report.json")])
                .map_err(|e| e.at_key("--output"))?;
            if path.symlink_metadata().is_ok() {
                check_file(path)?;
            }
        }
        let text = match (self.figure, self.table) {
            (Some(figure), _) => {
                let picture = figure.picture(&run, self.of.as_deref(), self.load.as_deref(), self.cost)?;
                figure.left_out(&run, self.of.as_deref())?.iter().for_each(|note| terminal.note(note));
                picture.svg(self.columns)?
            }
            (None, Some(markup)) => self.tables(&run, markup)?,
            (None, None) => return Err(Error::new("expected --figure or --table")),
        };
        match &self.output {
            None => terminal.print(&text),
            Some(path) => {
                write_whole(path, &format.bytes(text)?)?;
                terminal.written(std::slice::from_ref(path))
            }
        }
    }

    fn tables(&self, run: &RunFolder, markup: Markup) -> Result<String> {
        let tables = folder_tables(run)?;
        let chosen: Vec<&Table> =
            tables.iter().filter(|table| self.of.as_ref().is_none_or(|name| table.name == *name)).collect();
        if let (Some(name), true) = (&self.of, chosen.is_empty()) {
            let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
            return Err(Error::expected("--of", format!("one of the tables {}", names.join(", ")), name));
        }
        Ok(chosen.iter().map(|table| markup.table(table)).collect::<Vec<_>>().join("\n"))
    }
}
