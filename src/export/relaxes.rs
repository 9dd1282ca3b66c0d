//! What programs do with stress that relaxes.
//!
//! Theory: page *Springs that forget* of the book.

use super::names::named;
use springfit_element::springs::distance;
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_networks::network::RelaxationRecord;
use springfit_report::report::{NetworkRecord, Parts};

/// What a program does with stress that relaxes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Relaxes {
    /// Nothing: the reason is a sentence.
    Not(&'static str),
    /// Its script moves springs that do not pull at rest, each with dashpots: shear and bulk relax alike.
    Springs,
    /// Its script moves these, and exact networks of tetrahedra whose shear relaxes.
    Branches,
    /// The terms are among its numbers, or nothing moves in its files.
    Passed,
}

/// The number of digits to which a spring at rest is as long as it is without force.
const SLACK: f64 = 1e-9;

impl Relaxes {
    /// That stress which relaxes goes where it is held: anywhere else the body would keep the stiffness that it has against a sudden strain.
    ///
    /// # Errors
    /// It is not held.
    pub(super) fn check(self, network: &NetworkRecord) -> Result<()> {
        let terms = network.motion.as_ref().map_or(&[][..], |motion| &motion.relaxation);
        if terms.is_empty() || self == Relaxes::Passed {
            return Ok(());
        }
        let refused = |expected: String, found: String| {
            let advice = "; npz holds it, springfit generate --relaxing writes a step of it, and without [material.relaxation] the body keeps the stiffness against a sudden strain";
            let error = Error::expected("motion.relaxation", expected, found).followed_by(advice);
            Err(error.of_kind(ErrorKind::Unsupported))
        };
        let count = terms.len();
        if let Relaxes::Not(reason) = self {
            return refused(
                format!("a network whose stress does not relax ({reason})"),
                format!("one that relaxes in {count} terms"),
            );
        }
        if let Some(term) = terms.iter().position(|term| term.yield_stress.is_some()) {
            return refused("terms without yield".into(), format!("yield in the term {term}"));
        }
        if terms.iter().any(|term| term.region.is_some()) {
            return refused("terms of the whole body".into(), "regions that relax unlike".into());
        }
        let is_shear = terms.iter().all(|term| term.bulk == 0.0);
        let is_alike = terms.iter().all(|term| term.bulk == term.shear);
        let parts = Parts::of(network)?;
        if is_shear && self == Relaxes::Branches && is_exact(network, &parts) {
            return Ok(());
        }
        let of_springs = "springs that do not pull at rest, with shares of shear and bulk that are alike";
        let expected = match self {
            Relaxes::Branches => {
                format!("an exact network of linear tetrahedra with shares of shear alone, or {of_springs}")
            }
            _ => of_springs.to_string(),
        };
        if !is_alike {
            let words = |term: &RelaxationRecord| format!("shear = {}, bulk = {}", term.shear, term.bulk);
            return refused(expected, terms.iter().map(words).collect::<Vec<_>>().join(" and "));
        }
        let length = |[a, b]: [usize; 2]| distance(&network.points[a], &network.points[b]);
        let pulls = |points: [usize; 2], rest: f64| (rest - length(points)).abs() > SLACK * length(points);
        match parts.lengths.iter().find(|part| part.constant != 0.0 && pulls(part.points, part.rest)) {
            Some(part) => refused(expected, format!("tension at rest between {}", named(network, &part.points))),
            None => Ok(()),
        }
    }
}

/// Whether springs have the rest length zero, and each cell is a tetrahedron with a spring on its volume.
fn is_exact(network: &NetworkRecord, parts: &Parts) -> bool {
    let cells: usize = network.cells.iter().map(|block| block.points.len()).sum();
    let are_tetrahedra = network.dimension == 3 && parts.contents.iter().all(|part| part.points.len() == 4);
    are_tetrahedra && parts.contents.len() == cells && parts.lengths.iter().all(|part| part.rest == 0.0)
}
