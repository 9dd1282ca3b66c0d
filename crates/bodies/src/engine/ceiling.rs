//! The largest stiffness that an engine reaches at a setting, whatever the constants are.
//!
//! Theory: page *Networks in engines* of the book.

use super::model::TruncatedModel;
use super::setting::Setting;
use super::truncated::Truncated;
use crate::error::Result;
use crate::model::Support;

/// How stiff a body can be at a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ceiling {
    /// The largest modulus over that of the body: the geometric mean, over the loads, of the displacements of the body over those of springs
    /// without compliance.
    pub factor: f64,
}

/// A load and the displacements of the body under it, `[points · dimension]`.
type Load<'a> = (&'a Support, &'a [f64], &'a [f64]);

impl Ceiling {
    /// The ceiling over these loads; `None` if the method has none (sweeps over points, or sweeps that take all springs at once and
    /// grow without compliance), some motion has no stiffness, or no load moves anything.
    ///
    /// # Errors
    /// The engine does not hold the network.
    pub fn of(model: TruncatedModel, loads: &[Load], setting: &Setting) -> Result<Option<Ceiling>> {
        if setting.is_by_points() {
            return Ok(None);
        }
        let mut logarithms = Vec::new();
        let mut rest: Vec<&Load> = loads.iter().collect();
        while let Some((support, ..)) = rest.first().copied() {
            // The loads of one support share one effective stiffness, which is dear.
            let (own, others): (Vec<&Load>, Vec<&Load>) = rest.iter().partition(|load| load.0 == *support);
            rest = others;
            let Some(rigid) = Truncated::rigid(model, support, setting)? else { return Ok(None) };
            let forces: Vec<Vec<f64>> = own.iter().map(|load| load.1.to_vec()).collect();
            for (load, u) in own.iter().zip(rigid.answers(&forces)?) {
                let along: f64 = load.2.iter().zip(&u).map(|(a, b)| a * b).sum();
                let square: f64 = load.2.iter().map(|a| a * a).sum();
                if along > 0.0 && square > 0.0 {
                    // The mean of logarithms counts a factor and its inverse alike.
                    logarithms.push((square / along).ln());
                }
            }
        }
        let factor = (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
        Ok((!logarithms.is_empty()).then_some(Ceiling { factor }))
    }
}

/// Substeps that are tried at most.
// The ceiling grows with the square of the substeps: so many hold a body of 1.7e7 times the modulus that one holds.
const MOST: usize = 4096;

/// The least number of substeps at which the ceiling is at least that of the body; `None` if 4096 are not enough, or there is no ceiling.
///
/// # Errors
/// Those of [`Ceiling::of`].
pub fn least_substeps(model: TruncatedModel, loads: &[Load], setting: &Setting) -> Result<Option<usize>> {
    let reaches = |substeps: usize| -> Result<bool> {
        Ok(Ceiling::of(model, loads, &setting.with_substeps(substeps))?.is_some_and(|ceiling| ceiling.factor >= 1.0))
    };
    let (mut below, mut above) = (0, 1);
    while !reaches(above)? {
        (below, above) = (above, 2 * above);
        if above > MOST {
            return Ok(None);
        }
    }
    // The ceiling grows with the substeps, so that bisection finds the least number.
    while above - below > 1 {
        let middle = (below + above) / 2;
        if reaches(middle)? { above = middle } else { below = middle }
    }
    Ok(Some(above))
}
