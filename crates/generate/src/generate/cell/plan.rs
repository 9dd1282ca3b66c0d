//! Which loops of a cell are unrolled, by the size of the code.

use crate::element::Element;
use crate::springs::Springs;

/// Which loops are unrolled; the others are loops of the generated code, with tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Those over quadrature points.
    pub points: bool,
    /// Those over length springs.
    pub springs: bool,
    /// Those of the normal equations and their solution.
    pub equations: bool,
}

/// The largest numbers of nodes at points, of springs at points, of springs in a loop over points, and of unknowns for
/// which loops are unrolled: lines of code and time to compile grow with them (with the third power of the unknowns).
const NODES: usize = 64;
const SPRINGS: usize = 240;
const SPRINGS_OF_POINT: usize = 48;
const UNKNOWNS: usize = 10;

impl Plan {
    /// Unrolls the loops over all springs; the other loops stay as they are planned.
    pub fn with_springs(self) -> Plan {
        Plan { springs: true, ..self }
    }

    /// The plan for an element and its springs.
    pub fn of(element: &Element, springs: &Springs) -> Plan {
        let (n, points) = (element.nodes(), element.tabulation.points());
        // Points that serve one of two terms alone, or have no spring, have different code.
        let differ = !element.tabulation.volumetric.is_empty()
            || !springs.points().is_empty() && springs.points().len() != points;
        let unrolled = n * points <= NODES || differ;
        let lengths = springs.pairs().len();
        let all = if unrolled { lengths * points <= SPRINGS } else { lengths <= SPRINGS_OF_POINT };
        Plan { points: unrolled, springs: all, equations: all && springs.len() <= UNKNOWNS }
    }
}
