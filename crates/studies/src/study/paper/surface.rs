//! The moduli of a box of one element as functions of those of the material.

use super::index::{Column, RowEntry, TableEntry};
use super::material::material;
use super::outcome::{PaperRow, Surface};
use crate::analysis::moduli::Lattice;
use crate::error::{Error, Result};
use crate::springs::Springs;
use springfit_scenes::{NamedFit, load_element};
use std::path::Path;

/// The number of steps along each constant: a surface of 11 × 11 fits, which shows where they follow the modulus.
const STEPS: usize = 10;

/// The moduli of a box of one element, for logarithmic steps of Young's modulus and equal steps of Poisson's ratio.
pub fn surface(
    row: &RowEntry,
    fits: &[NamedFit],
    young: [f64; 2],
    poisson: [f64; 2],
    folder: &Path,
) -> Result<Vec<Surface>> {
    let element = load_element(row.element.as_deref().unwrap_or_default(), folder)?;
    let size = row.size.clone().unwrap_or_default();
    let part = |i: usize| i as f64 / STEPS as f64;
    // Moduli differ by orders of magnitude, so that they are even in their logarithm; ratios are even in themselves.
    let youngs: Vec<f64> = (0..=STEPS).map(|i| young[0] * (young[1] / young[0]).powf(part(i))).collect();
    let poissons: Vec<f64> = (0..=STEPS).map(|i| poisson[0] + (poisson[1] - poisson[0]) * part(i)).collect();
    let mut surfaces = Vec::new();
    for fit in fits {
        let springs = Springs::select(&element, fit.springs.as_deref())?;
        let mut found = Vec::new();
        for &e in &youngs {
            for &nu in &poissons {
                let material = material(element.dimension(), e, nu)?;
                let of_cells = |points: &[f64], cells: &[usize]| {
                    let missing = || Error::expected("fit", "a fit of single elements", &fit.name);
                    let method = fit.recipe.kind().cell_method().ok_or_else(missing)?;
                    method.fit_cells(&element, &springs, points, cells, material)
                };
                let lattice = Lattice::of(&element, &size, of_cells)?;
                found.push(lattice.of_springs().map(|m| [m.young / material.thickness(), m.poisson]));
            }
        }
        surfaces.push(Surface { fit: fit.name.clone(), young: youngs.clone(), poisson: poissons.clone(), found });
    }
    Ok(surfaces)
}

/// The largest deviation of a surface from the material: `E/E_in` farthest from one, and ν farthest from ν_in.
pub fn of_surface(table: &TableEntry, row: &RowEntry, surface: &Surface) -> PaperRow {
    let asked = surface.young.iter().flat_map(|e| surface.poisson.iter().map(move |nu| [*e, *nu]));
    let known = || asked.clone().zip(&surface.found).filter_map(|(asked, found)| Some((asked, (*found)?)));
    let furthest = |from: f64, of: &dyn Fn([f64; 2], [f64; 2]) -> f64| {
        known().map(|(asked, found)| of(asked, found)).max_by(|a, b| (a - from).abs().total_cmp(&(b - from).abs()))
    };
    let young = furthest(1.0, &|asked, found| found[0] / asked[0]);
    let poisson = furthest(0.0, &|asked, found| found[1] - asked[1]);
    let figure = |column: &Column| if *column == Column::YoungRatio { young } else { poisson };
    let found = table.columns.iter().map(figure).collect();
    PaperRow::new(row, &surface.fit, found, false, surface.found.iter().all(Option::is_some))
}
