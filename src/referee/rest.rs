//! When a body is at rest: the motion is damped at the critical damping of its slowest oscillation until nothing moves.

use super::session::Session;
use springfit_foundation::error::Result;

/// After the time T the slowest oscillation, which is damped critically, has fallen to `(1 + ω T) exp(−ω T)`: 8e-5.
const DECAYS: f64 = 12.0;
/// A body is still if nothing has moved by more than this, of the largest displacement, in the last fifth of the time.
// The slowest oscillation moves by `(1 + 0.8 ω T) exp(−0.8 ω T)` at most there, 7e-4 in the first round. In the second,
// with a time that is longer by a quarter, it moves by 8e-5.
pub const STILL: f64 = 3e-4;
/// A body that moves by more than this after all rounds has no energy at rest.
// Bodies in Jolt, whose numbers have 32 bits, go on moving by up to 0.93 % of the largest displacement. Their energy at rest is known to
// about that, and has a star.
pub const MOVING: f64 = 1e-2;
/// The least number of steps, and how often the time is made longer.
// The last fifth of the time, in which rest is judged, has four steps then.
const LEAST_STEPS: usize = 20;
const ROUNDS: usize = 8;

/// The rate at which velocities fall, 1/s, for the lowest angular frequency.
pub fn damping(slowest: f64) -> f64 {
    // x″ + c x′ + ω² x = 0 does not swing from c = 2 ω on.
    2.0 * slowest
}

/// How a body came to rest.
pub struct Rest {
    /// `[points · 3]`, m; `None` if the motion has diverged.
    pub displacement: Option<Vec<f64>>,
    /// What moved in the last fifth of the time, a share of the largest displacement.
    pub moving: f64,
    /// What the engine warned of.
    pub warnings: Vec<String>,
}

/// Loads the body of a session and waits until it is still, or all rounds are over.
///
/// # Errors
/// The program ended.
pub fn come_to_rest(session: &mut Session, forces: &[f64], slowest: f64) -> Result<Rest> {
    session.load(forces)?;
    let step = session.step;
    let mut warnings = Vec::new();
    let mut advance = |steps: usize| -> Result<Option<Vec<f64>>> {
        let advanced = session.advance(steps)?;
        warnings.extend(advanced.warnings);
        Ok(advanced.positions.map(|x| x.concat()).filter(|x| x.len() == forces.len()))
    };
    let Some(start) = advance(0)? else {
        return Ok(Rest { displacement: None, moving: f64::INFINITY, warnings });
    };
    let mut steps = ((DECAYS / (slowest * step)).ceil() as usize).max(LEAST_STEPS);
    let (mut before, mut moving) = (advance(steps - steps / 5)?, f64::INFINITY);
    for _ in 0..ROUNDS {
        let after = advance((steps / 5).max(1))?;
        let (Some(from), Some(to)) = (&before, &after) else {
            before = None;
            break;
        };
        let largest = |of: &[f64]| of.iter().zip(to).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Without any displacement the share is NaN, which counts as moving in each comparison.
        moving = largest(from) / largest(&start);
        before = after;
        if moving <= STILL {
            break;
        }
        // A time that is a quarter longer, of which the last fifth is yet to come. After all rounds it is 1.25⁷ times
        // the first, nearly five.
        steps += steps / 4;
    }
    warnings.sort();
    warnings.dedup();
    let displacement = before.map(|x| x.iter().zip(&start).map(|(x, start)| x - start).collect());
    Ok(Rest { displacement, moving, warnings })
}
