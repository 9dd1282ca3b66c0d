//! A network as engines hold it.

use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, MeasureSpring, Network, Support};
use crate::springs::{Measure, distance};
use crate::stiffness::gathered;

/// A network on its points with masses, as an engine holds it.
#[derive(Debug, Clone, Copy)]
pub struct TruncatedModel<'a> {
    /// The springs.
    pub network: &'a Network,
    /// The positions at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The masses, `[points]`, kg.
    pub masses: &'a [f64],
}

/// A relative difference of a measure from its rest value that is rounding.
// Measures of springs whose length is a millionth of the distance from the origin are rounded by 1e-10. The pull of a spring
// beyond the bound is refused, as sweeps at rest have none.
const SLACK: f64 = 1e-9;

impl TruncatedModel<'_> {
    /// Checks that engines hold the springs, and that each free point has a mass.
    ///
    /// # Errors
    /// They do not, or one has none; the kind is `Unsupported`.
    pub(super) fn check(&self, support: &Support) -> Result<()> {
        let TruncatedModel { network, points, masses } = *self;
        let unsupported = |key: &str, expected: &str, found: String| {
            Err(Error::expected(key, expected, found).of_kind(ErrorKind::Unsupported))
        };
        let d = network.dimension;
        if let Some(p) = (0..masses.len()).find(|&p| !(masses[p] > 0.0)) {
            return unsupported("masses", "masses above zero", format!("{:e} kg at point {p}", masses[p]));
        }
        if masses.len() * d != points.len() {
            return unsupported("masses", "a mass of each point", format!("{}", masses.len()));
        }
        if support.prescribed.iter().flatten().any(|u| *u != 0.0) {
            return unsupported("engine", "supports at rest", "a support that moves".into());
        }
        if let Some((_, constant)) = network.springs().find(|(_, constant)| !(*constant > 0.0)) {
            let expected =
                "springs with constants above zero, which engines hold; nonnegative = true has no negative ones";
            return unsupported("engine", expected, format!("{constant:e}"));
        }
        let is_simplex = |spring: &MeasureSpring| {
            // Engines hold triangles in the plane and tetrahedra in space, and no other content.
            matches!(spring.measure, Measure::Content(_) | Measure::Span(_)) && spring.points.len() == d + 1
        };
        if network.others.iter().any(|spring| spring.law.is_some() || !is_simplex(spring)) {
            let expected = "springs on lengths and on the contents of simplices with linear forces, which engines hold";
            return unsupported("engine", expected, "others".into());
        }
        let slack = |rest: f64, now: f64| (rest / now - 1.0).abs() <= SLACK;
        let length = |spring: &LengthSpring| {
            let [a, b] = spring.points.map(|p| &points[p * d..(p + 1) * d]);
            distance(a, b)
        };
        let is_slack = network.lengths.iter().all(|spring| slack(spring.rest, length(spring)))
            && network.others.iter().all(|spring| {
                let own = gathered(points, d, &spring.points);
                slack(spring.rest, spring.measure.value(&own, d))
            });
        if !is_slack {
            let expected = "springs that do not pull at rest: an engine that ends its sweeps early leaves their sum out of balance";
            return unsupported("engine", expected, "rest measures that differ from those of the mesh".into());
        }
        Ok(())
    }
}
