//! The limit of a sequence of values on meshes whose cells are halved from level to level.

use serde::Serialize;
/// Values that differ by less than this share are equal: solutions are not more accurate, and the quotient of such
/// differences is noise.
const EQUAL: f64 = 1e-9;
/// The lowest order from which a limit is extrapolated. At order ½ the extrapolation adds 2.4 times the last
/// difference.
// The displacements at the tip of a crack grow with the root of the distance, so that values there have this order. Lower ones are mostly
// those of meshes that show no order yet.
const SLOWEST: f64 = 0.5;

/// The limit of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// The limit.
    pub value: f64,
    /// An estimate of the error of the value: its change by the last level, or else what extrapolation has added to the
    /// finest value; for the value of the finest level its distance from the level before.
    pub uncertainty: f64,
    /// How the limit was found.
    pub kind: LimitKind,
}

/// How a limit was found; if it was not extrapolated, it is the value of the finest level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LimitKind {
    /// Extrapolated from the three finest levels, with this order in the size of the cells.
    Extrapolated(f64),
    /// The two finest levels agree up to rounding.
    Constant,
    /// There are fewer than three levels.
    TooFew,
    /// The differences between levels change their sign.
    NotMonotonic,
    /// The last difference is no smaller than the one before: the values do not converge yet, if they do at all.
    Growing,
    /// The order, given here, is below ½: the extrapolation would add more than is known.
    TooSlow(f64),
}

impl Limit {
    /// The order of convergence, if the limit was extrapolated.
    pub fn order(&self) -> Option<f64> {
        match self.kind {
            LimitKind::Extrapolated(order) => Some(order),
            LimitKind::Constant
            | LimitKind::TooFew
            | LimitKind::NotMonotonic
            | LimitKind::Growing
            | LimitKind::TooSlow(_) => None,
        }
    }
}

/// The limit of values on levels of cell size `h, h/2, h/4, …`; `None` without values.
///
/// For `v(h) = v₀ + c hᵖ` the differences `d₁`, `d₂` of the three finest values give `q = d₂/d₁ = 2⁻ᵖ` and
/// `v₀ = v₃ + d₂ q/(1 − q)` (Aitken 1926; Richardson 1911 with the observed order). All differences must have the same
/// sign and the last two must decrease; otherwise the finest value is used.
pub fn limit_of(values: &[f64]) -> Option<Limit> {
    let finest = *values.last()?;
    let differences: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let last = differences.last().copied().unwrap_or(0.0);
    let of_finest = |kind| Some(Limit { value: finest, uncertainty: last.abs(), kind });
    // Before the signs are compared, for those of rounding are random.
    if !differences.is_empty() && last.abs() <= EQUAL * finest.abs() {
        return of_finest(LimitKind::Constant);
    }
    if values.len() < 3 {
        return of_finest(LimitKind::TooFew);
    }
    let one_sign = differences.iter().all(|d| d * last > 0.0);
    if !one_sign {
        return of_finest(LimitKind::NotMonotonic);
    }
    let Some((q, correction)) = aitken(&differences) else { return of_finest(LimitKind::Growing) };
    let order = -q.log2();
    if order < SLOWEST {
        return of_finest(LimitKind::TooSlow(order));
    }
    let value = finest + correction;
    // The limit that was known one level before, from the finest value of then. Its distance shows how far the order
    // still changes.
    let coarser = aitken(&differences[..differences.len() - 1]).map(|(_, correction)| finest - last + correction);
    let uncertainty = coarser.map_or(correction.abs(), |coarser| (value - coarser).abs());
    Some(Limit { value, uncertainty, kind: LimitKind::Extrapolated(order) })
}

/// `q` and `d₂ q/(1 − q)` of the last two differences, if 0 < q < 1.
fn aitken(differences: &[f64]) -> Option<(f64, f64)> {
    let [.., first, second] = differences else { return None };
    let q = second / first;
    // Differences that fall by q from level to level go on as a geometric series, `d₂ (q + q² + …)`. With q of one or
    // more the series has no sum, and a negative q is that of values that swing.
    (q > 0.0 && q < 1.0).then_some((q, second * q / (1.0 - q)))
}
