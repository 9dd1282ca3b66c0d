//! The limit of the answers of finer and finer meshes.
//!
//! Theory: page *Calibration* of the book.

use super::level::{Answer, Level};
use super::sight::Observation;
use super::unknowns::Unknowns;
use crate::error::Result;
use crate::material::{Hooke, Moduli};
use crate::mesh::Mesh;
use crate::whole::ninety_five;

/// The order of displacements of linear elements where strains are bounded.
// It is twice the degree, that of the energy: readings and means over faces are as near by duality.
const LINEAR: f64 = 2.0;
/// The order of displacements of quadratic elements where strains are bounded: twice their degree, as above.
const QUADRATIC: f64 = 4.0;

/// On one refinement the rest is half the way from that of the element to that of a clamped edge, and 95 % of the rests are within this share of the way,
/// and of unknowns within this multiple of the largest change of all of them: a first mesh is often coarser than any order holds for.
// The numbers here and below were chosen by the bodies of `python/benches/calibration.py` with the seeds 0 to 12 and 45
// to 57, whose intervals hold in 97 to 100 %.
const ONCE: (f64, f64) = (0.7, 0.5);
/// Changes whose ratio is below this share of that of a clamped edge have the order that they show.
const ORDERLY: f64 = 0.9;
/// Where the ratio is that of an edge or more, the order is only known to be between that of an edge and that of the element: the rest is this
/// share of the way from the latter.
const PLACE: f64 = 0.55;
/// The share of that way within which 95 % of the rests are.
const REACH: f64 = 0.14;
/// The reach of [`CHANGE`] grows by this multiple of the excess of the ratio over that of an edge, which only meshes without an order have.
const GROWTH: f64 = 12.0;
/// The largest ratio with which changes are compared.
// What is left of a change with this ratio is 1.5 times as large. The ratio of a clamped edge is 0.44 at most: larger ones are of
// meshes without an order.
const SLOWEST: f64 = 0.6;
/// The part of a change that is not that of the mesh before times the ratio goes on by this multiple, and how far to either side 95 % are.
// On bodies without a clamped edge, whose changes are small, 0.05 would hold too few.
const CHANGE: (f64, f64) = (0.55, 0.35);
/// The rest of an unknown is known to this share of the largest change of all of them: one may hide in the other.
const HIDDEN: f64 = 0.018;

/// What is left of an answer beyond the finest mesh, from its last changes `c_1 = u_n − u_{n−1}` and `c_0 = u_{n−1} − u_{n−2}`:
/// `w c_1 + κ (c_1 − r c_0)`, with the ratio r of all answers. w is `q/(1 − q)` of changes that go on with the ratio q. It is bounded by that
/// of the element and by that of the edge of a clamped face, where strains are singular.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// w.
    pub share: f64,
    /// The standard deviation of w.
    pub deviation: f64,
    /// r; `None` with one refinement, which leaves κ out.
    pub ratio: Option<f64>,
    /// The standard deviation of κ.
    other: f64,
    /// The standard deviation that an unknown has of the largest change of all of them.
    pub hidden: f64,
}

impl Rest {
    /// The limit of a body with these elements and this order at clamped edges, by the ratio of changes after this number of refinements;
    /// `None` without refinements.
    fn of(mesh: &Mesh, edge: f64, refinements: usize, ratio: Option<f64>) -> Option<Rest> {
        let is_linear = mesh.blocks.iter().all(|block| block.element.has_corners_alone());
        let (order, goes_on) = (if is_linear { LINEAR } else { QUADRATIC }, |ratio: f64| ratio / (1.0 - ratio));
        // No order is above that of the element: the bounds of the clamp below would be the wrong way round, a panic.
        let (least, most) = ((-order).exp2(), (-edge.min(order)).exp2());
        // The constants above are reaches of 95 %.
        let deviation = |reach: f64| reach / ninety_five(None);
        match refinements {
            0 => return None,
            1 => {
                let way = goes_on(most) - goes_on(least);
                let share = goes_on(least) + 0.5 * way;
                let reach = ONCE.0 * way;
                let hidden = deviation(ONCE.1);
                return Some(Rest { share, deviation: deviation(reach), ratio, other: 0.0, hidden });
            }
            _ => {}
        }
        // Answers that agree to rounding leave nothing beyond the last mesh; which share of it is taken does not
        // matter.
        let met = ratio.unwrap_or(least);
        let bound = met.clamp(least, most);
        let doubt = ((met / most - ORDERLY) / (1.0 - ORDERLY)).clamp(0.0, 1.0);
        let excess = (met - most).max(0.0);
        let share = goes_on(least + (1.0 - (1.0 - PLACE) * doubt) * (bound - least));
        let reach = REACH * (goes_on(bound) - goes_on(least));
        Some(Rest {
            share,
            deviation: deviation(reach),
            ratio,
            other: deviation(CHANGE.1 + GROWTH * excess),
            hidden: deviation(HIDDEN),
        })
    }

    /// The part of the last change that is not that of the mesh before times the ratio.
    fn apart(&self, last: f64, before: f64) -> f64 {
        self.ratio.map_or(0.0, |ratio| last - ratio.min(SLOWEST) * before)
    }

    /// What is left of an answer with these changes.
    pub fn of_changes(&self, last: f64, before: f64) -> f64 {
        self.share * last + CHANGE.0 * self.apart(last, before)
    }

    /// The standard deviation of that.
    pub fn spread(&self, last: f64, before: f64) -> f64 {
        self.deviation * last.abs() + self.other * self.apart(last, before).abs()
    }
}

/// The order of displacements at the edge where a clamped face meets a free one at a right angle: twice the exponent of the displacements
/// there, `sin²(λ π/2) = ((κ + 1)² − 4 λ²)/(4 κ)` with Kolosov's κ (Williams 1952).
pub fn clamped_order(moduli: &Moduli) -> f64 {
    // 3 − 4 ν, that of plane strain: along an edge of a solid nothing stretches as it does across.
    let kappa = (moduli.lambda + 3.0 * moduli.mu) / (moduli.lambda + moduli.mu);
    let beyond = |exponent: f64| {
        let angle = (exponent * std::f64::consts::FRAC_PI_2).sin();
        angle * angle > ((kappa + 1.0).powi(2) - 4.0 * exponent * exponent) / (4.0 * kappa)
    };
    // The left side grows and the right side falls; where they do not meet, strains are bounded. Fifty halvings are all digits.
    let (mut low, mut high) = (0.5, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if beyond(middle) { high = middle } else { low = middle }
    }
    2.0 * high
}

/// Answers whose change is a smaller share of them agree.
// Equations that are solved by iterations leave some 1e-9 of the forces, so that the ratio of smaller changes would be that of noise.
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
    /// The answers at θ of the first `meshes` meshes, with the derivatives on the mesh with the number `derived`.
    pub(super) fn at(&self, theta: &[f64], meshes: usize, derived: usize) -> Result<Option<Limiting>> {
        let (mut answers, mut columns) = (Vec::new(), Vec::new());
        for (index, level) in self.levels[..meshes].iter().enumerate() {
            let found = level.answer(&self.unknowns, &self.observations, theta, derived == index)?;
            let Some(Answer { values, columns: own }) = found else { return Ok(None) };
            answers.push(values);
            if derived == index {
                columns = own;
            }
        }
        let mut found = Limiting { answers, columns, rest: None };
        let edge = self.edge(theta);
        found.rest = Rest::of(&self.levels[0].mesh, edge, meshes - 1, self.ratio(&found));
        Ok(Some(found))
    }

    /// The least order at clamped edges of the materials at θ.
    fn edge(&self, theta: &[f64]) -> f64 {
        let Level { mesh, materials, owners, .. } = &self.levels[0];
        // Materials beyond their range have no answers, and never come here.
        let Ok(found) = self.unknowns.materials(mesh, materials, owners, theta) else { return LINEAR };
        // The order falls as λ/μ rises.
        let ratio = |moduli: &Moduli| moduli.lambda / moduli.mu;
        let moduli = found.moduli();
        let least = moduli.values().filter_map(Hooke::moduli).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        least.map_or(LINEAR, |moduli| clamped_order(&moduli))
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
