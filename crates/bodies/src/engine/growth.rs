//! Whether sweeps that take all springs at once come to an end, and whether the body does that they move.
//!
//! Theory: page *Networks in engines* of the book.

use super::constraints::Constraints;
use super::lanes::{Block, LANES};
use super::setting::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Network;

/// Checks that sweeps which take all springs at once come to an end.
///
/// # Errors
/// They grow; the kind is `Unsupported`, and the error has the substeps with which they end.
pub(super) fn check_growth(
    constraints: &Constraints,
    (network, points, inverse): (&Network, &[f64], &[f64]),
    setting: &Setting,
) -> Result<()> {
    if ends(constraints, points.len()) {
        return Ok(());
    }
    let is_stable = |substeps: usize| {
        let setting = setting.with_substeps(substeps);
        ends(&Constraints::new(network, (points, inverse), &setting, false), points.len())
    };
    // Doubling brackets the least number in as many trials as it has binary digits.
    let (mut below, mut above) = (setting.substeps, 2 * setting.substeps);
    while !is_stable(above) && above < LARGE {
        (below, above) = (above, 2 * above);
    }
    // To a percent: the number is advice, not a bound.
    while above - below > 1 + below / 100 {
        let middle = (below + above) / 2;
        if is_stable(middle) { above = middle } else { below = middle }
    }
    let expected = format!(
        "{above} substeps or more of a step of {:.3e} s: sweeps that take all springs at once grow without bound with longer ones",
        setting.step
    );
    let found = format!("{}", setting.substeps);
    let advice = "; there they are nearly converged, so that constants for this engine are those of other fits";
    Err(Error::expected("engine.substeps", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported))
}

/// Whether sweeps that take all springs at once come to an end.
pub(super) fn ends(constraints: &Constraints, size: usize) -> bool {
    constraints.growth(size) < STABLE
}

/// The factor by which the motion of a body grows in each substep where nothing pushes it; `None` if it does not grow.
///
/// It is `x_{n+1} = (I − h² W K_N)(2 x_n − x_{n−1})`, from a displaced shape at rest. A motion with the real eigenvalue κ of `W K_N` has the factors
/// `r² = (1 − h² κ)(2 r − 1)`, which are within one up to `h² κ = 4/3`. Sweeps that correct too much go beyond it: also such as come to an end.
pub(super) fn motion_growth(apply: impl Fn(&Block) -> Block, inverse: &[f64], substep: f64) -> Option<f64> {
    // The start has no symmetry of a body, so that it has a part along every motion.
    let start = |(dof, w): (usize, &f64)| if *w > 0.0 { (1.0 + 1.3 * dof as f64).sin() } else { 0.0 };
    let mut now: Block = inverse.iter().enumerate().map(|own| [start(own); LANES]).collect();
    let mut before = now.clone();
    let size = |x: &Block| x.iter().map(|x| x[0] * x[0]).sum::<f64>().sqrt();
    let (first, square) = (size(&now), substep * substep);
    let mut last = first;
    for _ in 0..SUBSTEPS {
        let mut next: Block = now.iter().zip(&before).map(|(now, before)| [2.0 * now[0] - before[0]; LANES]).collect();
        let force = apply(&next);
        next.iter_mut().zip(&force).zip(inverse).for_each(|((x, f), w)| *x = [x[0] - square * w * f[0]; LANES]);
        (before, now) = (now, next);
        let own = size(&now);
        // In this form NaN and infinity count as grown.
        if !(own <= GROWN * first) {
            return Some(own / last);
        }
        last = own;
    }
    None
}

/// Substeps after which a motion that grows has grown, by three thousandths in each or more.
// A factor of 1.0023 in each substep is 1000 after 3000 of them.
const SUBSTEPS: usize = 3000;
/// No motion that is damped becomes so much larger than it began.
const GROWN: f64 = 1e3;
/// The largest eigenvalue of `ω D⁻¹ A` with which sweeps end, below 2 by what the power method may miss.
const STABLE: f64 = 1.98;
/// More substeps than are looked for.
// Those of a frame of 1/60 s last 1 ns then. A point at 1 m/s moves by 1e-9 m in one, less than a digit of single precision in a body of
// 10 cm.
const LARGE: usize = 1 << 24;
