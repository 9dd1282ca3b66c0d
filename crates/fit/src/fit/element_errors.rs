//! The errors of the networks of elements: norms of the difference between the stiffness of the springs and that of the finite element.

use super::cells::{CHUNK, CellFits, ROUND};
use super::extremes::Extremes;
use super::input::{check_fit, check_length};
use super::stiffness_difference::StiffnessDifferences;
use super::visit::cell_fault;
use crate::element::Element;
use crate::error::Result;
use crate::material::{BlockValues, Hooke};
use crate::number::or_nan;
use crate::scalar::{Packed, PackedWork, vectorized, widest};
use crate::stiffness::Fault;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A relative error below this is the rounding of R and K: an exact network on linear triangles and tetrahedra leaves 1e-16 to 1e-14. A
/// bound takes the place of its 2-norm, without eigenvalues.
const ROUNDED: f64 = 1e-13;

/// The mean and the maximum of a number over the elements. Both are null where no element has this number.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    /// The mean is taken over the elements.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub mean: f64,
    /// The largest value is taken over the elements.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub max: f64,
}

/// The relative error `‖R − K‖/‖R‖` of each element.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ElementErrors {
    /// In the Frobenius norm, `[cells]`.
    pub frobenius: Vec<f64>,
    /// In the induced 2-norm, `[cells]`; where R − K is rounding, a bound of it: `√n` times the other, n the order of R.
    pub spectral: Vec<f64>,
}

impl ElementErrors {
    /// Appends the errors of further cells.
    pub fn extend(&mut self, other: ElementErrors) {
        self.frobenius.extend(other.frobenius);
        self.spectral.extend(other.spectral);
    }
}

impl Spread {
    /// Neither mean nor maximum.
    pub const UNKNOWN: Spread = Spread { mean: f64::NAN, max: f64::NAN };

    /// Mean and maximum of the values.
    pub fn of(values: &[f64]) -> Spread {
        let mut all = SpreadSum::default();
        all.add(values);
        all.spread()
    }
}

/// Sum and maximum of values that come one after the other, so that no list of all of them is held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpreadSum {
    sum: f64,
    max: f64,
    count: usize,
}

impl SpreadSum {
    /// Adds further values, none below zero.
    pub fn add(&mut self, values: &[f64]) {
        self.sum = values.iter().fold(self.sum, |sum, value| sum + value);
        // Errors are not negative, so that zero is the start of their maximum. A maximum passes NaN over; the mean
        // shows it.
        self.max = values.iter().copied().fold(self.max, f64::max);
        self.count += values.len();
    }

    /// Mean and maximum of all values; zero if there are none.
    pub fn spread(&self) -> Spread {
        // The mean of no values is zero, not 0/0.
        Spread { mean: self.sum / self.count.max(1) as f64, max: self.max }
    }
}

/// The relative errors of every cell, from R and `K = Σ k_s g_s g_sᵀ`.
///
/// # Errors
/// An array has a wrong length; a coordinate or modulus is not finite or is out of its range; the springs belong to
/// another element; or a cell is reversed, tangled or flat.
pub fn element_errors<'a>(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    moduli: impl Into<BlockValues<'a, Hooke>>,
    fits: &CellFits,
) -> Result<ElementErrors> {
    let cells = connectivity.len() / element.nodes();
    let mut all = ElementErrors { frobenius: Vec::with_capacity(cells), spectral: Vec::with_capacity(cells) };
    each_element_errors(element, points, connectivity, moduli.into(), fits, &mut |errors| all.extend(errors))?;
    Ok(all)
}

/// Computes the errors of [`element_errors`]; `visit` is called with the errors of some cells after those of the others, in their order.
///
/// # Errors
/// Those of [`element_errors`].
// A function without parameters of type is compiled in this package, which is optimised, whoever calls it.
pub fn each_element_errors(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    moduli: BlockValues<Hooke>,
    fits: &CellFits,
    visit: &mut dyn FnMut(ElementErrors),
) -> Result<()> {
    check_fit(element, &fits.springs, points, connectivity, &moduli)?;
    let cells = connectivity.len() / element.nodes();
    check_length("constants", fits.constants.len(), cells * fits.springs.len())?;
    fits.force.check(fits.springs.names().len())?;
    let parameters = fits.force.places(&fits.springs).last().map_or(0, |count| cells * count);
    check_length("parameters", fits.parameters.len(), parameters)?;
    let n = element.nodes();
    for (round, nodes) in connectivity.chunks(ROUND * n).enumerate() {
        let chunk = |(i, nodes): (usize, &[usize])| {
            let first = round * ROUND + i * CHUNK;
            let moduli = moduli.part(first, nodes.len() / n);
            let batch = ErrorBatch { element, points, connectivity: nodes, moduli, fits, first };
            widest(batch).map_err(|(cell, fault)| cell_fault(element, first + cell, fault))
        };
        let chunks: Vec<Result<ElementErrors>> = nodes.par_chunks(CHUNK * n).enumerate().map(chunk).collect();
        // The results of the threads are visited in the order of the cells, so that sums over them are the same on any
        // number of threads.
        chunks.into_iter().try_for_each(|errors| errors.map(&mut *visit))?;
    }
    Ok(())
}

/// Cells of one block, of which the first has the number `first`.
struct ErrorBatch<'a> {
    element: &'a Element,
    points: &'a [f64],
    connectivity: &'a [usize],
    moduli: BlockValues<'a, Hooke>,
    fits: &'a CellFits,
    first: usize,
}

impl PackedWork for ErrorBatch<'_> {
    type Output = std::result::Result<ElementErrors, (usize, Fault)>;

    fn run<T: Packed>(self, zero: T) -> Self::Output {
        let n = self.element.nodes();
        let size = n * self.element.dimension();
        let mut both = StiffnessDifferences::new(&zero, self.element, self.points, self.moduli, self.fits);
        let mut extremes = Extremes::like(&zero, size);
        let mut errors = ElementErrors::default();
        for (i, nodes) in self.connectivity.chunks(T::COUNT * n).enumerate() {
            let done = i * T::COUNT;
            both.set_hooke(done, nodes.len() / n);
            both.update(self.first + done, nodes).map_err(|(lane, fault)| (done + lane, fault))?;
            let frobenius = (frobenius_square(&both.left, size) / &frobenius_square(&both.stiffness, size)).sqrt();
            let spectral = match zero.constant(&ROUNDED).exceeds(&frobenius) {
                // ‖R − K‖₂ ≤ ‖R − K‖_F, and ‖R‖_F ≤ √n ‖R‖₂.
                true => frobenius.clone().scaled(&(size as f64).sqrt()),
                false => extremes.norm(&mut both.left) / &extremes.norm(&mut both.stiffness),
            };
            let cells = nodes.len() / n;
            errors.frobenius.extend_from_slice(&frobenius.as_slice()[..cells]);
            errors.spectral.extend_from_slice(&spectral.as_slice()[..cells]);
        }
        Ok(errors)
    }
}

/// The squared Frobenius norm of a symmetric matrix from its lower triangle.
fn frobenius_square<T: Packed>(a: &[T], size: usize) -> T {
    vectorized!(a[0], {
        let (mut diagonal, mut below) = (a[0].zero(), a[0].zero());
        for (i, row) in a.chunks_exact(size).enumerate() {
            diagonal = diagonal.plus_product(&row[i], &row[i]);
            for entry in &row[..i] {
                below = below.plus_product(entry, entry);
            }
        }
        // Each entry below the diagonal has its mirror image above it.
        diagonal + &below.scaled(&2.0)
    })
}
