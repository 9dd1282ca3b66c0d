//! What a fit minimises as a function of the program: of the residual forces of a cell, in place of a norm.
//!
//! Theory: page *Sampled fits* of the book.

use super::quasi_newton::{Found, Quadratic, minimize};
use crate::error::{Error, ErrorKind, Result};
use crate::random::unit_at;
use crate::springs::dot;
use std::fmt::Debug;
use std::sync::Arc;

/// The relative step of the differences by which the gradient is proved. Central differences err by its square, 1e-8,
/// and by the rounding of the values over it, 1e-12.
const STEP: f64 = 1e-4;
/// The largest difference of a slope from that of differences, relative to the slopes that were met. A wrong gradient
/// differs in its first digits.
const SAME: f64 = 1e-3;

/// A function of the residual forces.
pub trait ResidualFunction: Debug + Send + Sync {
    /// Writes the derivatives of the value in the residuals, and returns the value. The residuals are the forces `f − K` of all shapes
    /// of a cell times the roots of their weights, `[shapes × rows × dimension]`; `shape` has these three numbers.
    ///
    /// # Errors
    /// The function has failed.
    fn value(&self, residuals: &[f64], shape: [usize; 3], gradient: &mut [f64]) -> Result<f64>;
}

/// A function of the residual forces under a name.
#[derive(Debug, Clone)]
pub struct ResidualObjective {
    name: String,
    function: Arc<dyn ResidualFunction>,
}

impl PartialEq for ResidualObjective {
    fn eq(&self, other: &ResidualObjective) -> bool {
        Arc::ptr_eq(&self.function, &other.function) && self.name == other.name
    }
}

/// The equations `b − A p` of a cell, `[shapes × rows × dimension]` and row-major.
pub struct Residuals<'a> {
    pub rows: &'a [f64],
    pub rhs: &'a [f64],
    pub shape: [usize; 3],
}

impl ResidualObjective {
    /// The function under this name.
    pub fn new(name: &str, function: Arc<dyn ResidualFunction>) -> ResidualObjective {
        ResidualObjective { name: name.into(), function }
    }

    /// The name in reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The parameters that minimise the function, from those of least squares.
    ///
    /// # Errors
    /// The function fails, has no finite value or gradient, or its gradient is not that of its value.
    pub(super) fn minimize(&self, residuals: &Residuals, squares: &Quadratic, start: Vec<f64>) -> Result<Found> {
        self.prove(residuals)?;
        let count = start.len();
        let value = |unknowns: &[f64]| {
            let left: Vec<f64> = residuals
                .rhs
                .iter()
                .zip(residuals.rows.chunks_exact(count))
                .map(|(b, row)| b - dot(row, unknowns))
                .collect();
            let (value, gradient) = self.ask(&left, residuals.shape)?;
            let mut slope = vec![0.0; count];
            for (g, row) in gradient.iter().zip(residuals.rows.chunks_exact(count)) {
                slope.iter_mut().zip(row).for_each(|(slope, entry)| *slope -= g * entry);
            }
            Ok((value, slope))
        };
        // The value without springs is the size to which decreases are relative: at the optimum it may be zero.
        let scale = self.ask(residuals.rhs, residuals.shape)?.0.abs();
        let found = minimize(value, squares, start, scale)?;
        found.ok_or_else(|| {
            self.without("a finite value and gradient at the forces that springs of least squares leave")
        })
    }

    fn without(&self, expected: &str) -> Error {
        Error::expected("norm", format!("{expected} from \"{}\"", self.name), "another").of_kind(ErrorKind::Infeasible)
    }

    fn ask(&self, residuals: &[f64], shape: [usize; 3]) -> Result<(f64, Vec<f64>)> {
        // A function that leaves an entry unwritten is found out by the proof.
        let mut gradient = vec![f64::NAN; residuals.len()];
        let value = self.function.value(residuals, shape, &mut gradient)?;
        Ok((value, gradient))
    }

    /// Proves at the forces without springs that value and gradient are finite, and along two directions that the gradient is that of
    /// the value.
    fn prove(&self, residuals: &Residuals) -> Result<()> {
        let (b, shape) = (residuals.rhs, residuals.shape);
        let (value, gradient) = self.ask(b, shape)?;
        if !(value.is_finite() && gradient.iter().all(|g| g.is_finite())) {
            let found = if value.is_finite() { "a gradient with others".into() } else { format!("the value {value}") };
            let expected = format!("finite numbers from \"{}\"", self.name);
            return Err(Error::expected("norm", expected, found).of_kind(ErrorKind::Infeasible));
        }
        // The random direction is as large as the forces: steps along both are then alike.
        let size = dot(b, b).sqrt() / (b.len().max(1) as f64).sqrt();
        let random: Vec<f64> = (0..b.len()).map(|i| size * (2.0 * unit_at(1, i as u64, 0) - 1.0)).collect();
        for direction in [b, &random] {
            let along = dot(&gradient, direction);
            let at = |share: f64| {
                let moved: Vec<f64> = b.iter().zip(direction).map(|(b, d)| b + share * STEP * d).collect();
                self.ask(&moved, shape).map(|(value, gradient)| (value, dot(&gradient, direction)))
            };
            let [(below, before), (above, after)] = [at(-1.0)?, at(1.0)?];
            let difference = (above - below) / (2.0 * STEP);
            // Slopes that change a lot within the step, and values that hardly differ from rounding, prove nothing.
            let rough = (after - before).abs() + 1e-12 * value.abs() / STEP;
            // The comparison is negated so that slopes that are not numbers prove nothing.
            if !((difference - along).abs() <= SAME * along.abs().max(difference.abs()) + rough) {
                let found = format!("one with the slope {along:.6e} where differences have {difference:.6e}");
                return Err(Error::expected("norm", format!("the gradient of the value of \"{}\"", self.name), found));
            }
        }
        Ok(())
    }
}
