//! The outcome of the fits of all cells.

use super::errors::{FamilyErrors, FamilySums, ShapeError};
use super::settings::SampledFit;
use super::starts::StartEnd;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::cells::CellFits;
use crate::fit::normal::Rank;
use crate::springs::Springs;

/// The largest number of rows of the data of a block: a quarter of a gigabyte.
const MOST_ROWS: usize = 2_000_000;

/// The outcome of one cell.
#[derive(Default)]
pub struct CellFit {
    pub constants: Vec<f64>,
    pub parameters: Vec<f64>,
    pub rank: Rank,
    pub converged: bool,
    pub agreeing: Option<f64>,
    pub starts: Vec<StartEnd>,
    pub cell: usize,
    pub shapes: usize,
    pub reduced: usize,
    pub trained: f64,
    pub held_out: f64,
    pub families: Vec<FamilySums>,
    pub errors: Vec<ShapeError>,
}

/// The constants of all cells, and the errors at the shapes.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SampledFits {
    /// The constants and parameters.
    pub fits: CellFits,
    /// The number of shapes of the fit, that of the cell with the most.
    pub shapes: usize,
    /// The number of these shapes that have less of their deformation than was drawn, as they would have turned the cell inside out; that
    /// of the cell with the most.
    pub reduced: usize,
    /// `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` on the shapes of the fit, `[cells]`, with f the forces of the element and K those of
    /// its springs.
    pub trained: Vec<f64>,
    /// The error `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` of the springs' forces K from those of the element, f, on the shapes that were held out,
    /// `[cells]`; NaN if there are none, and infinite where the springs have no finite force at one.
    pub held_out: Vec<f64>,
    /// The errors on the shapes that were held out, family by family.
    pub families: Vec<FamilyErrors>,
    /// For laws that are not linear in their parameters: the share of the starts that ended at the best error, the
    /// least over the cells.
    pub agreeing: Option<f64>,
    /// Where the starts of the cell ended in which the fewest agree, or, with the data, those of one cell of each shape.
    pub starts: Vec<CellStart>,
    /// The error of each shape of one cell of each shape, if the data are asked for.
    pub errors: Vec<ShapeError>,
}

/// Where a start ended, with its cell and its number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CellStart {
    /// The cell, from 0 in its block.
    pub cell: usize,
    /// The number of the start, from 0.
    pub start: usize,
    /// Where it ended.
    pub end: StartEnd,
}

impl SampledFits {
    /// The outcome without cells.
    pub(super) fn new(springs: &Springs, fit: &SampledFit) -> SampledFits {
        let mut fits = CellFits::new(springs.clone());
        fits.force = fit.force.clone();
        let (shapes, reduced, trained, held_out, families, agreeing, starts, errors) = Default::default();
        SampledFits { fits, shapes, reduced, trained, held_out, families, agreeing, starts, errors }
    }

    /// Counts a cell that was fitted, and keeps its data.
    ///
    /// # Errors
    /// The data are too many.
    pub(super) fn count(&mut self, one: &CellFit) -> Result<()> {
        self.shapes = self.shapes.max(one.shapes);
        self.reduced = self.reduced.max(one.reduced);
        self.fits.unreached += usize::from(!one.converged);
        self.fits.deficient += usize::from(one.rank == Rank::Deficient);
        let starts = one.starts.iter().enumerate();
        let starts = starts.map(|(start, &end)| CellStart { cell: one.cell, start, end });
        let is_worst = one.agreeing.is_some_and(|share| self.agreeing.is_none_or(|least| share < least));
        if !one.errors.is_empty() {
            self.starts.extend(starts);
        } else if is_worst {
            self.starts = starts.collect();
        }
        self.agreeing = self.agreeing.into_iter().chain(one.agreeing).reduce(f64::min);
        if self.errors.len().max(self.starts.len()) + one.errors.len() > MOST_ROWS {
            let expected = format!("at most {MOST_ROWS} shapes of all cells whose errors are kept");
            return Err(Error::expected("data", expected, "more").of_kind(ErrorKind::Limit));
        }
        self.errors.extend(&one.errors);
        Ok(())
    }

    /// Appends a cell with the constants of one that was fitted.
    pub(super) fn add(&mut self, one: &CellFit) {
        self.fits.constants.extend(&one.constants);
        self.fits.parameters.extend(&one.parameters);
        let cells = self.trained.len();
        self.trained.push(one.trained);
        self.held_out.push(one.held_out);
        for sums in &one.families {
            if !self.families.iter().any(|known| known.family == sums.family) {
                // Cells before this one have no shape of the family, and NaN as its error.
                self.families.push(FamilyErrors { family: sums.family, shapes: 0, errors: vec![f64::NAN; cells] });
            }
        }
        for known in &mut self.families {
            let sums = one.families.iter().find(|sums| sums.family == known.family);
            known.shapes = known.shapes.max(sums.map_or(0, |sums| sums.shapes));
            known.errors.push(sums.map_or(f64::NAN, |sums| sums.error()));
        }
    }

    /// Gives the cells these places among `count` cells, of which others have other energies.
    ///
    /// # Panics
    /// If there is no cell, or a place is not below `count`.
    pub fn spread(&mut self, cells: &[usize], count: usize) {
        let spread = |values: &mut Vec<f64>| {
            let width = values.len() / cells.len();
            let mut all = vec![f64::NAN; count * width];
            for (own, &cell) in values.chunks_exact(width.max(1)).zip(cells) {
                all[cell * width..(cell + 1) * width].copy_from_slice(own);
            }
            *values = all;
        };
        self.each_list(spread);
    }

    /// Takes the fits of other cells, which have these places.
    ///
    /// # Panics
    /// If the springs differ, or a place is not among those of [`SampledFits::spread`].
    pub fn join(&mut self, cells: &[usize], mut other: SampledFits) {
        let count = self.trained.len();
        other.spread(cells, count);
        for family in &other.families {
            if !self.families.iter().any(|known| known.family == family.family) {
                self.families.push(FamilyErrors { errors: vec![f64::NAN; count], ..family.clone() });
            }
        }
        let order = |family: &FamilyErrors| self.families.iter().position(|known| known.family == family.family);
        other.families.sort_by_key(order);
        let mut taken = other.families.into_iter().peekable();
        let pairs = [
            (&mut self.fits.constants, &other.fits.constants),
            (&mut self.fits.parameters, &other.fits.parameters),
            (&mut self.trained, &other.trained),
            (&mut self.held_out, &other.held_out),
        ];
        for (ours, theirs) in pairs {
            let width = theirs.len() / count.max(1);
            for &cell in cells {
                let place = cell * width..(cell + 1) * width;
                ours[place.clone()].copy_from_slice(&theirs[place]);
            }
        }
        for known in &mut self.families {
            let Some(own) = taken.next_if(|own| own.family == known.family) else { continue };
            known.shapes = known.shapes.max(own.shapes);
            cells.iter().for_each(|&cell| known.errors[cell] = own.errors[cell]);
        }
        self.shapes = self.shapes.max(other.shapes);
        self.reduced = self.reduced.max(other.reduced);
        self.fits.deficient += other.fits.deficient;
        self.fits.unreached += other.fits.unreached;
        self.fits.reused += other.fits.reused;
        let is_worst = other.agreeing.is_some_and(|share| self.agreeing.is_none_or(|least| share < least));
        if !other.errors.is_empty() {
            self.starts.extend(other.starts);
        } else if is_worst {
            self.starts = other.starts;
        }
        self.errors.extend(other.errors);
        self.agreeing = self.agreeing.into_iter().chain(other.agreeing).reduce(f64::min);
    }

    /// Does something with each list that has values of every cell.
    fn each_list(&mut self, mut each: impl FnMut(&mut Vec<f64>)) {
        [&mut self.fits.constants, &mut self.fits.parameters, &mut self.trained, &mut self.held_out]
            .into_iter()
            .for_each(&mut each);
        self.families.iter_mut().for_each(|family| each(&mut family.errors));
    }
}
