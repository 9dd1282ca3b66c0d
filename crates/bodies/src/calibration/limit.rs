//! The limit of the answers of finer and finer meshes.
//!
//! Theory: page *Calibration* of the book.

use super::level::{Answer, Level};
use super::sight::Observation;
use super::unknowns::Unknowns;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::whole::ninety_five;

/// The order of displacements of linear elements where strains are bounded.
const LINEAR: f64 = 2.0;
/// The order of displacements of quadratic elements where strains are bounded.
const QUADRATIC: f64 = 4.0;
/// The order where strains are singular, as at the edge of a clamped face: twice the exponent of 0.7 of the displacements there.
const SINGULAR: f64 = 1.4;

/// This is where between both orders the rest of an answer is on two refinements, as a share of the way from that of
/// the element to that of an edge, and how far to either side 95 % of the rests are. The bench
/// `python/benches/calibration.py` measures both numbers.
const TWICE: (f64, f64) = (0.17, 0.3);
/// These are the numbers of [`TWICE`] on one refinement: a first mesh is often coarser than any order holds for.
const ONCE: (f64, f64) = (0.5, 0.7);
/// Answers that change from mesh to mesh by a larger ratio have no order yet; their rest grows with it, and what is known of it as well.
const ORDERLY: f64 = 0.4;
/// The rest and what is known of it grow by this multiple of the excess over [`ORDERLY`].
const GROWTH: f64 = 1.5;
/// The largest ratio that is believed.
const SLOWEST: f64 = 0.6;
/// The part of a change that is not that of the mesh before times the ratio goes on by this multiple, and how far to either side 95 % are.
const CHANGE: (f64, f64) = (0.7, 0.2);

/// What is left of an answer beyond the finest mesh, from its last changes `c_1 = u_n − u_{n−1}` and `c_0 = u_{n−1} − u_{n−2}`:
/// `w c_1 + κ (c_1 − r c_0)`, with the ratio r of all answers. w is `1/(2^p − 1)` of an order p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// w.
    pub share: f64,
    /// The standard deviation of w.
    pub deviation: f64,
    /// r; `None` with one refinement, which leaves κ out.
    pub ratio: Option<f64>,
}

impl Rest {
    /// The limit of a body with these elements and this ratio of changes after this number of refinements; `None` without refinements.
    fn of(mesh: &Mesh, refinements: usize, ratio: Option<f64>) -> Option<Rest> {
        let is_linear = mesh.blocks.iter().all(|block| block.element.has_corners_alone());
        let multiple = |order: f64| 1.0 / (order.exp2() - 1.0);
        let (least, most) = (multiple(if is_linear { LINEAR } else { QUADRATIC }), multiple(SINGULAR));
        let (place, reach) = match refinements {
            0 => return None,
            1 => ONCE,
            _ => TWICE,
        };
        let (way, ratio) = (most - least, ratio.map(|ratio| ratio.min(SLOWEST)));
        let excess = ratio.map_or(0.0, |ratio| (ratio - ORDERLY).max(0.0));
        let share = least + place * way + GROWTH * excess;
        Some(Rest { share, deviation: (reach * way + excess) / ninety_five(None), ratio })
    }

    /// What is left of an answer with these changes.
    pub fn of_changes(&self, last: f64, before: f64) -> f64 {
        let other = self.ratio.map_or(0.0, |ratio| last - ratio * before);
        self.share * last + CHANGE.0 * other
    }

    /// The standard deviation of that.
    pub fn spread(&self, last: f64, before: f64) -> f64 {
        let other = self.ratio.map_or(0.0, |ratio| last - ratio * before);
        self.deviation * last.abs() + CHANGE.1 / ninety_five(None) * other.abs()
    }
}

/// Answers whose change is a smaller share of them agree.
const SAME: f64 = 1e-8;

/// The meshes of a body, each finer than the one before, and what their answers tend to.
pub struct Limit<'a> {
    /// The meshes.
    pub levels: Vec<Level<'a>>,
    /// What is sought.
    pub unknowns: Unknowns,
    /// What was measured.
    pub observations: Vec<Observation>,
    /// 1/σ of each observation, or that of its kind under its load where noise is not known.
    pub weights: Vec<f64>,
}

/// The answers at θ.
pub(super) struct Limiting {
    /// The answers of each mesh.
    pub answers: Vec<Vec<f64>>,
    /// The derivatives on one of the meshes, `[unknowns][observations]`.
    pub columns: Vec<Vec<f64>>,
    /// What is extrapolated; `None` without a finer mesh.
    pub rest: Option<Rest>,
}

impl Limiting {
    /// The change of the answers from a mesh to the next one, by its number.
    pub fn change(&self, level: usize) -> Vec<f64> {
        self.answers[level + 1].iter().zip(&self.answers[level]).map(|(fine, coarse)| fine - coarse).collect()
    }

    /// The last change of the answers, and the one before, which is zero without a third mesh.
    pub fn changes(&self) -> [Vec<f64>; 2] {
        let count = self.answers.len();
        let before = count.checked_sub(3).map_or_else(|| vec![0.0; self.answers[0].len()], |level| self.change(level));
        [self.change(count - 2), before]
    }

    /// The extrapolated answers.
    pub fn values(&self) -> Vec<f64> {
        let last = &self.answers[self.answers.len() - 1];
        let Some(rest) = self.rest else { return last.clone() };
        let [change, before] = self.changes();
        last.iter().zip(change.iter().zip(&before)).map(|(u, (c, b))| u + rest.of_changes(*c, *b)).collect()
    }
}

impl Limit<'_> {
    /// The answers at θ, with the derivatives on the mesh with this number.
    pub(super) fn at(&self, theta: &[f64], derived: usize) -> Result<Option<Limiting>> {
        let (mut answers, mut columns) = (Vec::new(), Vec::new());
        for (index, level) in self.levels.iter().enumerate() {
            let found = level.answer(&self.unknowns, &self.observations, theta, derived == index)?;
            let Some(Answer { values, columns: own }) = found else { return Ok(None) };
            answers.push(values);
            if derived == index {
                columns = own;
            }
        }
        let mut found = Limiting { answers, columns, rest: None };
        found.rest = Rest::of(&self.levels[0].mesh, self.levels.len() - 1, self.ratio(&found));
        Ok(Some(found))
    }

    /// The ratio of the last two changes of the answers, in units of σ; `None` with fewer than three meshes, or where they agree to rounding.
    fn ratio(&self, at: &Limiting) -> Option<f64> {
        let size = |values: &[f64]| values.iter().zip(&self.weights).map(|(c, w)| (c * w).powi(2)).sum::<f64>().sqrt();
        let count = at.answers.len();
        let (before, last) = (size(&at.change(count.checked_sub(3)?)), size(&at.change(count - 2)));
        (before > SAME * size(&at.answers[0])).then(|| last / before)
    }

    /// What the error of the meshes gives to the sum of the squares of the residuals.
    pub(super) fn left(&self, at: &Limiting) -> f64 {
        let Some(rest) = at.rest else { return 0.0 };
        let [last, before] = at.changes();
        let all = last.iter().zip(&before).zip(&self.weights);
        all.map(|((last, before), weight)| (weight * rest.spread(*last, *before)).powi(2)).sum()
    }

    /// The residuals `(y − u)/σ`.
    pub(super) fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let all = self.observations.iter().zip(values).zip(&self.weights);
        all.map(|((observation, value), weight)| weight * (observation.value - value)).collect()
    }

    /// Derivatives in units of σ.
    pub(super) fn weighed(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let one = |column: &Vec<f64>| column.iter().zip(&self.weights).map(|(c, w)| c * w).collect();
        columns.iter().map(one).collect()
    }
}
