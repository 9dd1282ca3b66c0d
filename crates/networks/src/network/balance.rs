//! What a spring measures does not change when its points are moved together.

use super::record::{MeasureKind, NetworkRecord, SpringRecord};
use crate::element::coordinate_names;
use crate::error::{Error, ErrorKind, Result};
use crate::symbolic::{Program, Scope};

/// The largest sum of gradients beside the sum of their sizes: some digits of single precision, in which other programs may have
/// written them.
const BALANCED: f64 = 1e-6;

/// Which measures of a network have been checked.
pub struct Balance<'a> {
    network: &'a NetworkRecord,
    is_checked: Vec<bool>,
}

impl<'a> Balance<'a> {
    pub fn of(network: &'a NetworkRecord) -> Balance<'a> {
        Balance { network, is_checked: vec![false; network.measures.len()] }
    }

    /// Checks the measure of a spring, once for all springs with it.
    ///
    /// # Errors
    /// The gradients of the measure do not add up to zero, so that a body that is moved would have forces; or its expression cannot be read.
    pub fn check(&mut self, spring: &SpringRecord) -> Result<()> {
        if std::mem::replace(&mut self.is_checked[spring.measure], true) {
            return Ok(());
        }
        let measure = &self.network.measures[spring.measure];
        match (measure.kind, &measure.expression) {
            (MeasureKind::Length | MeasureKind::Turn | MeasureKind::Squares, _) => Ok(()),
            (MeasureKind::Content, _) => measure.terms.iter().try_for_each(|term| {
                let columns = term.gradients.iter().map(Vec::len).max().unwrap_or(0);
                let column = |j: usize| term.gradients.iter().map(move |row| row.get(j).copied().unwrap_or(0.0));
                (0..columns).try_for_each(|j| vanishes(spring.measure, column(j)))
            }),
            (MeasureKind::Expression, None) => {
                Err(Error::expected("measure", format!("an expression in measures[{}]", spring.measure), "none"))
            }
            (MeasureKind::Expression, Some(text)) => self.check_expression(spring, text),
        }
    }

    /// `Σ_a ∂c/∂x_a = 0` where the points of the spring are.
    fn check_expression(&self, spring: &SpringRecord, text: &str) -> Result<()> {
        let d = self.network.dimension;
        let names = coordinate_names(spring.points.len(), d);
        let expression = match Scope::new(&names).expression(text) {
            Ok(expression) => expression,
            // A formula that is written out may be longer than one that is read.
            Err(error) if error.kind() == ErrorKind::Limit => return Ok(()),
            Err(error) => return Err(error.under(format!("measures[{}].expression", spring.measure))),
        };
        let at: Vec<f64> = spring.points.iter().flat_map(|&p| self.network.points[p].iter().copied()).collect();
        let slopes = Program::of(&expression).gradient(&at).1;
        (0..d).try_for_each(|k| vanishes(spring.measure, slopes.iter().skip(k).step_by(d).copied()))
    }
}

fn vanishes(measure: usize, gradients: impl Iterator<Item = f64>) -> Result<()> {
    let (sum, size) = gradients.fold((0.0, 0.0), |(sum, size), g| (sum + g, size + g.abs()));
    // No slope, as of a square root at zero, tells nothing.
    if !f64::is_finite(size) || f64::abs(sum) <= BALANCED * size {
        return Ok(());
    }
    let expected =
        format!("gradients of measures[{measure}] that add up to zero, so that a body that is moved has no forces");
    Err(Error::expected("measure", expected, format!("a sum of {sum:e}")))
}
