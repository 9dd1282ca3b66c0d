//! The derivatives of the constants of all cells.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::batch::{Batch, Columns, Product};
use super::inputs::{CellFunction, CellNumbers, GradientFit, Inputs};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::cells::CHUNK;
use crate::fit::exact::{ExactEnergy, VolumeSprings};
use crate::fit::input::{check_cells, check_finite, check_length, check_moduli};
use crate::fit::least_squares::Closed;
use crate::fit::precision::no_answer;
use crate::fit::rest::Rest;
use crate::fit::visit::cell_name;
use crate::material::{BlockValues, Moduli};
use crate::springs::Springs;
use rayon::prelude::*;

impl<'a> CellFunction<'a> {
    /// `connectivity` is `[cells × nodes]` into `points`, `[points × dimension]`, m; the moduli are those of all cells, or one pair for each.
    ///
    /// # Errors
    /// An array has a wrong length or a number is not finite; the fit has bounds or no closed form, or the cells do not fill their space (kind
    /// `Unsupported`).
    pub fn new(
        element: &'a Element,
        springs: &'a Springs,
        points: &'a [f64],
        connectivity: &'a [usize],
        moduli: impl Into<BlockValues<'a, Moduli>>,
        fit: GradientFit,
    ) -> Result<CellFunction<'a>> {
        let (moduli, d) = (moduli.into(), element.dimension());
        element.check_plain("derivatives of fits")?;
        check_cells(element, points, connectivity)?;
        springs.check(element)?;
        moduli.check("moduli", connectivity.len() / element.nodes())?;
        moduli.values().iter().try_for_each(|moduli| check_moduli(moduli, d))?;
        if element.space() != d {
            return Err(unsupported("cells that fill their space", "a surface or lines in space"));
        }
        match &fit {
            GradientFit::Closed(fit) => {
                if fit.nonnegative || fit.rest != Rest::Mesh {
                    return Err(unsupported("constants without bounds and rest lengths of the mesh", "others"));
                }
                if !springs.functions().is_empty() || Closed::<f64>::of(springs, fit).is_none() {
                    return Err(unsupported("a fit with a closed form", &fit.objective.title()));
                }
            }
            GradientFit::Exact(exact) => {
                if exact.large || exact.volume == VolumeSprings::Patches || !springs.areas().is_empty() {
                    let expected = "an exact network for small deformations, with springs on lengths and on contents of points or cells";
                    return Err(unsupported(expected, "another"));
                }
                let is_linear = match exact.energy {
                    ExactEnergy::StableNeoHookean => true,
                    // In the plane it is the same energy.
                    ExactEnergy::StableMooneyRivlin { .. } => d == 2,
                    ExactEnergy::NeoHookean | ExactEnergy::StVenantKirchhoff => false,
                };
                if !is_linear {
                    let expected = "\"stable-neo-hookean\", whose springs on contents are linear";
                    let found = format!("\"{}\"", exact.energy.name());
                    return Err(Error::expected("energy", expected, found).of_kind(ErrorKind::Unsupported));
                }
            }
        }
        Ok(CellFunction { element, springs, points, connectivity, moduli, fit })
    }

    /// The derivative along one change of the inputs, `Σ_i (∂k/∂y_i) t_i`; of two changes the second one, `Σ_ij (∂²k/∂y_i∂y_j) t_i s_j`.
    ///
    /// # Errors
    /// An array has a wrong length or a number is not finite, there are not one or two changes, or a cell has no stiffness or is so flat that
    /// digits are lost.
    pub fn along(&self, changes: &[&Inputs]) -> Result<CellNumbers> {
        if !(1..=2).contains(&changes.len()) {
            return Err(Error::expected("changes", "one or two", changes.len()));
        }
        changes.iter().try_for_each(|change| self.check_inputs(change))?;
        let (cells, [m, r]) = (self.cells(), self.counts());
        let mut found = CellNumbers { constants: vec![0.0; cells * m], rests: vec![0.0; cells * r] };
        self.each_chunk(Product::Along(changes), &mut found.constants, m, &mut found.rests, r)?;
        Ok(found)
    }

    /// The gradient of `Σ w k + Σ v c₀` with the given weights; with a change of the inputs, the derivative of this gradient along it.
    ///
    /// # Errors
    /// An array has a wrong length or a number is not finite, or a cell has no stiffness or is so flat that digits are lost.
    pub fn gradient(&self, weights: &CellNumbers, change: Option<&Inputs>) -> Result<Inputs> {
        let (cells, [m, r]) = (self.cells(), self.counts());
        check_length("weights", weights.constants.len(), cells * m)?;
        check_length("rests", weights.rests.len(), cells * r)?;
        check_finite("weights", &weights.constants)?;
        check_finite("rests", &weights.rests)?;
        change.map_or(Ok(()), |change| self.check_inputs(change))?;
        let (n, d) = (self.element.nodes(), self.element.dimension());
        let (mut nodes, mut moduli) = (vec![0.0; cells * n * d], vec![0.0; cells * 2]);
        self.each_chunk(Product::Gradient(weights, change), &mut nodes, n * d, &mut moduli, 2)?;
        let mut points = vec![0.0; self.points.len()];
        // The shares of cells are added after the threads have ended, in the order of the cells: the sums are the same
        // on any number of threads.
        for (node, own) in self.connectivity.iter().zip(nodes.chunks_exact(d)) {
            points[node * d..][..d].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        Ok(Inputs { points, moduli })
    }

    fn check_inputs(&self, change: &Inputs) -> Result<()> {
        check_length("points", change.points.len(), self.points.len())?;
        check_length("moduli", change.moduli.len(), self.cells() * 2)?;
        check_finite("points", &change.points)?;
        check_finite("moduli", &change.moduli)
    }

    /// Writes a product of the cells into two arrays: `[cells × of_first]` into `first`, and `[cells × of_second]` into `second`.
    fn each_chunk(
        &self,
        product: Product,
        first: &mut [f64],
        of_first: usize,
        second: &mut [f64],
        of_second: usize,
    ) -> Result<()> {
        let n = self.element.nodes();
        let all: Vec<_> =
            chunks(first, of_first, self.cells()).into_iter().zip(chunks(second, of_second, self.cells())).collect();
        // Each chunk writes its own columns, so that threads do not change a result.
        all.into_par_iter().enumerate().try_for_each(|(i, (first, second))| {
            let start = i * CHUNK;
            let nodes = &self.connectivity[start * n..(start * n + CHUNK * n).min(self.connectivity.len())];
            let batch = Batch { function: self, product, start, nodes, into: Columns { first, second } };
            batch.run().map_err(|cell| {
                no_answer("has no stiffness, or is too flat for derivatives").at_key(cell_name(self.element, cell))
            })
        })
    }
}

/// Divides numbers, `[cells × width]`, into those of each chunk of cells. A chunk has none where the width is zero.
fn chunks(all: &mut [f64], width: usize, cells: usize) -> Vec<&mut [f64]> {
    // A list of no numbers for each cell has no pieces that could be cut, because a piece of the length zero is a
    // panic; each chunk of cells has an empty one all the same.
    if width > 0 {
        all.chunks_mut(CHUNK * width).collect()
    } else {
        (0..cells.div_ceil(CHUNK)).map(|_| Default::default()).collect()
    }
}

fn unsupported(expected: &str, found: &str) -> Error {
    Error::expected("objective", expected, found).of_kind(ErrorKind::Unsupported)
}
