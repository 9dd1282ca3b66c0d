//! The equilibrium of a network at large deformation.

use crate::body::Body;
use crate::factorized::loose;
use springfit_bodies::model::{Elastic, Entries, Support, displaced, inverted};
use springfit_bodies::solve::{Applied, Ending, Newton};
use springfit_foundation::error::{Error, ErrorKind, Result};

/// What acts on a network.
pub struct Loads {
    /// `[points · dimension]`, N.
    pub forces: Vec<f64>,
    pub support: Support,
    /// Positions near the equilibrium, `[points · dimension]`, m.
    pub start: Option<Vec<f64>>,
}

/// An equilibrium.
pub struct Found {
    /// The positions, `[points · dimension]`, m.
    pub x: Vec<f64>,
    /// Whether rounding of the forces limits it.
    pub is_rounded: bool,
    /// The number of cells that are turned inside out.
    pub inverted: usize,
}

/// Finds the equilibrium from the positions that are given. Without positions, or if no equilibrium is found from them, the load is applied step by step from rest.
///
/// # Errors
/// No equilibrium is found; or the support leaves the network free to move as it is.
pub fn find(body: &Body, loads: &Loads) -> Result<Found> {
    let Loads { forces, support, start } = loads;
    if !body.is_held(support) {
        return Err(Error::expected("fix", "supports that hold every connected part", "one that can move as it is"));
    }
    let (network, points, newton) = (body.network(), body.points(), Newton::default());
    network.check_size()?;
    let tangent: Entries = match network.respond(points) {
        Some(rest) => rest.tangent,
        None => return Err(loose("springs without a response at rest")),
    };
    let pattern = Newton::pattern(&tangent, support)?.placed(points, body.dimension());
    // The pattern is all that is needed of it, and factors take the memory.
    drop(tangent);
    let ended = |u: &[f64], is_rounded: bool| {
        let x = displaced(points, u);
        let inverted = if body.has_cells() { inverted(body.mesh(), &x) } else { 0 };
        Found { x, is_rounded, inverted }
    };
    if let Some(start) = start {
        let guess: Vec<f64> = start.iter().zip(points).map(|(x, rest)| x - rest).collect();
        if let Some(u) = newton.settle(network, points, support, forces, &guess, Some(&pattern))? {
            return Ok(ended(&u, false));
        }
    }
    let applied = Applied { forces, pressed: None };
    let found = newton.solve_with(network, points, support, applied, Some(&pattern))?;
    if found.ending == Ending::Stalled {
        let residual = found.residuals.last().and_then(|all| all.last()).copied().unwrap_or(f64::NAN);
        let expected = "loads under which the network has an equilibrium that Newton's method finds";
        let reached = format!("none beyond {:.3} of the load (residual {residual:.1e} there)", found.load);
        return Err(Error::expected("forces", expected, reached).of_kind(ErrorKind::Infeasible));
    }
    Ok(ended(&found.displacement, found.is_rounded))
}
