//! The fits of all cells of one element type.
//!
//! Theory: page *Least squares* of the book.

use super::batch::{Batch, Tally};
use super::congruence::Congruence;
use super::descent;
use super::input::{check_fit, check_nodes};
use super::method::Certificate;
use super::rest::Rest;
use super::settings::Fit;
use super::solver::Solver;
use super::tension::fit_tensions;
use super::visit::{cell_fault, cell_name, each_cell};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{BlockValues, Hooke};
use crate::number::first_not_finite;
use crate::springs::{Force, Springs};
use crate::stiffness::Fault;
use rayon::prelude::*;

/// The number of cells that one thread fits at a time: enough that starting the thread costs nothing.
pub(super) const CHUNK: usize = 512;
/// The number of cells between two reports of progress. So many chunks keep all threads busy until nearly the end of a
/// round.
pub(super) const ROUND: usize = 64 * CHUNK;
/// The number of cells that one thread fits at a time where each takes a good part of a second: whole lanes, and few enough that
/// progress is reported, and a caller can end the work, every few seconds.
const COSTLY_CHUNK: usize = 8;

/// The constants of all cells of one element type.
#[derive(Debug, Clone, PartialEq)]
pub struct CellFits {
    /// The springs of each cell.
    pub springs: Springs,
    /// The constants, `[cells × springs]`, N/m; of springs on areas N/m³, on volumes N/m⁵. For a force law, its slope
    /// at rest.
    pub constants: Vec<f64>,
    /// The force law of the springs.
    pub force: Force,
    /// The further parameters of the springs, cell by cell and spring by spring, see [`Force::places`].
    pub parameters: Vec<f64>,
    /// The number of cells whose normal equations were singular, see [`Rank::Deficient`](super::Rank::Deficient).
    pub deficient: usize,
    /// The number of cells whose iteration did not converge; of congruent cells only the fitted one counts.
    pub unreached: usize,
    /// The number of cells that received the constants of a congruent cell; for objectives without a closed form.
    pub reused: usize,
    /// For the spectral objective one certificate per cell, otherwise empty.
    pub certificates: Vec<Certificate>,
}

/// Fits every cell. `connectivity` is `[cells × nodes]` into `points`, `[points × dimension]`, m. The moduli are those of all cells, or
/// one pair for each.
///
/// `progress` is called from time to time with the number of finished cells.
///
/// # Errors
/// An array has a wrong length; a number is not finite or is out of its range; the springs belong to another element;
/// or a cell is reversed, tangled or flat. The error names the cell, counted from 1.
pub fn fit_cells<'a>(
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    moduli: impl Into<BlockValues<'a, Hooke>>,
    fit: &Fit,
    progress: &mut dyn FnMut(usize),
) -> Result<CellFits> {
    let mut fits = CellFits::new(springs.clone());
    fits.refit(element, points, connectivity, moduli, fit, progress)?;
    Ok(fits)
}

impl CellFits {
    pub(super) fn new(springs: Springs) -> CellFits {
        CellFits {
            springs,
            constants: Vec::new(),
            force: Force::Linear,
            parameters: Vec::new(),
            deficient: 0,
            unreached: 0,
            reused: 0,
            certificates: Vec::new(),
        }
    }

    /// The constants of some of the cells, without counts and certificates.
    pub fn of_cells(&self, cells: &[usize]) -> CellFits {
        let m = self.springs.len();
        let p = self.force.places(&self.springs)[m];
        let rows = |values: &[f64], width: usize| {
            cells.iter().flat_map(|&cell| &values[cell * width..(cell + 1) * width]).copied().collect()
        };
        CellFits {
            constants: rows(&self.constants, m),
            parameters: rows(&self.parameters, p),
            force: self.force.clone(),
            ..CellFits::new(self.springs.clone())
        }
    }

    /// Fits every cell as [`fit_cells`] does, with the memory of an earlier fit.
    ///
    /// # Errors
    /// Those of [`fit_cells`].
    pub fn refit<'a>(
        &mut self,
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        moduli: impl Into<BlockValues<'a, Hooke>>,
        fit: &Fit,
        progress: &mut dyn FnMut(usize),
    ) -> Result<()> {
        self.refit_block(element, points, connectivity, moduli.into(), fit, progress)
    }

    /// [`Self::refit`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn refit_block<'a>(
        &mut self,
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        moduli: BlockValues<'a, Hooke>,
        fit: &Fit,
        progress: &mut dyn FnMut(usize),
    ) -> Result<()> {
        check_fit(element, &self.springs, points, connectivity, &moduli)?;
        if !self.springs.points().is_empty() {
            return Err(Error::at("springs", "are those of an exact network, which is not fitted"));
        }
        fit.check()?;
        let (n, m) = (element.nodes(), self.springs.len());
        let cells = connectivity.len() / n;
        self.constants.resize(cells * m, 0.0);
        (self.deficient, self.unreached, self.reused) = (0, 0, 0);
        self.certificates.clear();
        self.force = Force::Linear;
        self.parameters.clear();
        // Without springs there is nothing to fit, and a slice has no pieces of length zero.
        if m == 0 {
            return Ok(());
        }
        if fit.rest != Rest::Mesh {
            let found = fit_tensions(element, &self.springs, points, connectivity, moduli, fit, progress)?;
            check_constants(element, 0, m, &found.constants)?;
            check_constants(element, 0, m, &found.parameters)?;
            self.force = Force::FreeRest;
            (self.constants, self.parameters) = (found.constants, found.parameters);
            (self.deficient, self.unreached, self.reused) = (found.deficient, found.unreached, found.reused);
            return Ok(());
        }
        if fit.is_costly() && cells > 1 {
            let congruence = Congruence::of(element, points, connectivity, &moduli)?;
            let shapes = congruence.representatives.len();
            // Where no two cells are alike, the copies would only take memory.
            if shapes < cells {
                let nodes = |&cell: &usize| &connectivity[cell * n..(cell + 1) * n];
                let few: Vec<usize> = congruence.representatives.iter().flat_map(nodes).copied().collect();
                let mut fitted = CellFits::new(self.springs.clone());
                fitted.constants.resize(shapes * m, 0.0);
                // The caller counts cells, not shapes.
                let mut share = |done: usize| progress(done * cells / shapes);
                let own = moduli.of_cells(&congruence.representatives);
                // One pair of moduli stays one, so that lanes need not be filled anew for each block.
                let own = BlockValues::listed(&own, matches!(moduli, BlockValues::Uniform(_)));
                fitted.fit_each(element, points, &few, own, fit, &mut share)?;
                self.copy_by_shape(&fitted, &congruence.shapes);
                return Ok(());
            }
        }
        self.fit_each(element, points, connectivity, moduli, fit, progress)
    }

    /// Fits every cell separately; the memory for the constants has been allocated.
    fn fit_each(
        &mut self,
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        moduli: BlockValues<Hooke>,
        fit: &Fit,
        progress: &mut dyn FnMut(usize),
    ) -> Result<()> {
        let CellFits { springs, constants, .. } = self;
        let springs = &*springs;
        let (n, m) = (element.nodes(), springs.len());
        let cells = connectivity.len() / n;
        let chunk = |first: usize, connectivity: &[usize], constants: &mut [f64]| {
            let moduli = moduli.part(first, connectivity.len() / n);
            if let Solver::General { method, iterations, topology } = fit.solver {
                let weight = fit.objective.of_motions()?;
                // The loop over the cells cannot be ended early. The error names the first cell with a fault, as below.
                let (mut unmeasured, mut failed) = (None, None);
                each_cell(element, points, connectivity, first, |cell, x, geometry| {
                    if !springs.function_gradients(x, &mut vec![0.0; springs.functions().len() * x.len()]) {
                        unmeasured.get_or_insert(cell);
                        return;
                    }
                    match descent::search(
                        springs,
                        x,
                        geometry,
                        moduli.at(cell),
                        fit,
                        weight,
                        (method, iterations, topology),
                    ) {
                        Ok(found) => constants[cell * m..(cell + 1) * m].copy_from_slice(&found),
                        Err(problem) => _ = failed.get_or_insert((cell, problem)),
                    }
                })?;
                if let Some(cell) = unmeasured {
                    return Err(cell_fault(element, first + cell, Fault::Unmeasured));
                }
                if let Some((cell, problem)) = failed {
                    let problem = format!("the optimiser \"{}\" failed: {problem}", fit.solver.name());
                    return Err(Error::at(cell_name(element, first + cell), problem).of_kind(ErrorKind::Infeasible));
                }
                check_constants(element, first, m, constants)?;
                return Ok(Tally::default());
            }
            let hooke = moduli;
            let batch = Batch { element, springs, points, connectivity, hooke, fit: *fit, constants: &mut *constants };
            let tally = batch.run().map_err(|(cell, fault)| cell_fault(element, first + cell, fault))?;
            check_constants(element, first, m, constants)?;
            Ok(tally)
        };
        let (size, round_size) = match fit.is_costly() {
            // Two chunks for each thread: whoever ends early finds another one, and the end of a round stays near.
            true => (COSTLY_CHUNK, 2 * COSTLY_CHUNK * rayon::current_num_threads()),
            false => (CHUNK, ROUND),
        };
        let rounds = connectivity.chunks(round_size * n).zip(constants.chunks_mut(round_size * m));
        for (round, (nodes, constants)) in rounds.enumerate() {
            let chunks = nodes.par_chunks(size * n).zip(constants.par_chunks_mut(size * m)).enumerate();
            let results: Vec<Result<Tally>> =
                chunks.map(|(i, (nodes, constants))| chunk(round * round_size + i * size, nodes, constants)).collect();
            // The results are taken in the order of the cells: the error names the first faulty cell, and lists do not depend on the threads.
            for tally in results {
                let tally = tally?;
                self.deficient += tally.deficient;
                self.unreached += tally.unreached;
                self.certificates.extend(tally.certificates);
            }
            progress(((round + 1) * round_size).min(cells));
        }
        Ok(())
    }

    /// Copies the constants of one cell of each shape to all cells; `shapes` gives the shape of each cell.
    fn copy_by_shape(&mut self, fitted: &CellFits, shapes: &[usize]) {
        let m = self.springs.len();
        for (constants, &shape) in self.constants.chunks_exact_mut(m).zip(shapes) {
            constants.copy_from_slice(&fitted.constants[shape * m..(shape + 1) * m]);
        }
        if !fitted.certificates.is_empty() {
            self.certificates = shapes.iter().map(|&shape| fitted.certificates[shape]).collect();
        }
        (self.deficient, self.unreached) = (fitted.deficient, fitted.unreached);
        self.reused = shapes.len() - fitted.constants.len() / m;
    }
}

/// That the `values` of springs, `[cells × springs]`, are numbers; those of a spring between two nodes at one place, or of a cell
/// beyond the range of numbers, are not. The first cell is number `first` of its block.
fn check_constants(element: &Element, first: usize, springs: usize, values: &[f64]) -> Result<()> {
    match first_not_finite(values) {
        Some(place) => Err(cell_fault(element, first + place / springs, Fault::Unmeasured)),
        None => Ok(()),
    }
}

/// The constants of a single element with nodes at `x`, `[nodes × space]`, m; `[springs]`.
///
/// # Errors
/// Those of [`fit_cells`]; or the springs pull at rest, so that constants alone do not describe them.
pub fn fit_element(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: impl Into<Hooke>,
    fit: &Fit,
) -> Result<Vec<f64>> {
    let moduli = moduli.into();
    check_nodes(element, element.space(), x)?;
    fit.check_constants_alone()?;
    let connectivity: Vec<usize> = (0..element.nodes()).collect();
    Ok(fit_cells(element, springs, x, &connectivity, moduli, fit, &mut |_| {})?.constants)
}
