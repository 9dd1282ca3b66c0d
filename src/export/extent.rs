//! The numbers of a network as other programs take them in.

use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_report::report::{NetworkRecord, Parts};

/// The largest number of single precision, in which some programs compute. Products of a few such numbers are finite in double
/// precision: they are not written as infinity.
const LARGEST: f64 = f32::MAX as f64;

/// Checks that each number that is exported is finite in single precision.
///
/// # Errors
/// One is not. The error names it.
pub fn check_numbers(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<()> {
    gravity.into_iter().flatten().try_for_each(|g| fits(|| "--gravity".into(), *g))?;
    for (k, g) in network.gravity.iter().flatten().enumerate() {
        fits(|| format!("gravity[{k}]"), *g)?;
    }
    for (p, x) in network.points.iter().enumerate() {
        x.iter().enumerate().try_for_each(|(k, x)| fits(|| format!("points[{p}][{k}]"), *x))?;
    }
    for (p, mass) in network.masses.iter().flatten().enumerate() {
        fits(|| format!("masses[{p}]"), *mass)?;
    }
    for (s, spring) in network.springs.iter().enumerate() {
        let numbers = [("constant", spring.constant), ("rest", spring.rest), ("damper", spring.damper)];
        numbers.iter().try_for_each(|(name, number)| fits(|| format!("springs[{s}].{name}"), *number))?;
    }
    fits(|| "damping.mass".into(), network.damping.mass)?;
    network.largest_step.map_or(Ok(()), |step| fits(|| "largest_step".into(), step))
}

/// Checks the numbers of springs that are made of those of the network.
///
/// # Errors
/// One is not finite in single precision.
pub fn check_parts(parts: &Parts) -> Result<()> {
    parts.contents.iter().try_for_each(|part| {
        let place = || format!("springs, of which one on the content of points {:?}", &part.points[..]);
        fits(place, part.constant)?;
        fits(place, part.rest)
    })
}

fn fits(key: impl Fn() -> String, number: f64) -> Result<()> {
    // NaN is no such number.
    if number.abs() <= LARGEST {
        return Ok(());
    }
    let expected = format!("a number of at most {LARGEST:.1e}, as single precision holds");
    Err(Error::expected(key(), expected, format!("{number:e}")).of_kind(ErrorKind::Unsupported))
}
