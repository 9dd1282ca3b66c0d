//! Springs on the volumes of hexahedra in terms of tetrahedra, for programs that hold these alone.

use super::record::{MeasureKind, MeasureRecord, NetworkRecord, ShareRecord, SpringRecord, TermRecord};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{Measure, cross, dot};
use std::borrow::Cow;
use std::sync::Arc;

/// The two ways to divide a hexahedron into a tetrahedron in its middle and four at its corners, which cross its faces along the one
/// diagonal and along the other. Corners are in the order of `hex8`; volumes are positive in this order.
const TETRAHEDRA: [[usize; 4]; 10] = [
    [0, 2, 7, 5],
    [1, 2, 0, 5],
    [3, 0, 2, 7],
    [4, 7, 5, 0],
    [6, 5, 7, 2],
    [1, 3, 4, 6],
    [0, 1, 3, 4],
    [2, 3, 1, 6],
    [5, 4, 6, 1],
    [7, 6, 4, 3],
];
/// The name of the element whose corners have this order.
const ELEMENT: &str = "hex8";
/// The mean volume of both divisions is that of the hexahedron, also where its faces are bent, to rounding.
const ROUNDING: f64 = 1e-9;

/// A network whose springs on the volumes of hexahedra are on those of tetrahedra.
///
/// The volume of a hexahedron is half that of its ten [tetrahedra](TETRAHEDRA), `V = ½ Σ_t V_t`. In place of `½ K (V − V̄)²` they have
/// `Σ_t ½ K_t (V_t − V̄_t)²` with `K_t = K V₀/(2 V_t0)` and `V̄_t/V_t0 = V̄/V₀`: the same energy if all grow alike, and more otherwise, by the inequality of Cauchy and
/// Schwarz. The network is stiffer where the cells change their shapes.
#[derive(Debug)]
pub struct Division {
    /// The divided network.
    pub network: NetworkRecord,
    /// The hexahedra, by their places in the springs of the whole one.
    pub hexahedra: Vec<usize>,
    /// What they measure.
    pub measure: Measure,
}

impl Division {
    /// The division of a network; `None` if it has no spring on the volume of a hexahedron, or one with a law.
    ///
    /// # Errors
    /// A hexahedron is so distorted that one of its tetrahedra has no volume; the key is the place of the spring.
    pub fn of(network: &NetworkRecord) -> Result<Option<Division>> {
        let is_hexahedral: Vec<bool> = network.measures.iter().map(is_of_hexahedron).collect();
        let is_meant = |spring: &SpringRecord| is_hexahedral[spring.measure] && spring.law.is_none();
        let hexahedra: Vec<usize> = (0..network.springs.len()).filter(|&s| is_meant(&network.springs[s])).collect();
        if hexahedra.is_empty() || network.dimension != 3 {
            return Ok(None);
        }
        let measure = Measure::Content(Arc::new(Element::load(ELEMENT)?));
        let mut divided = network.clone();
        divided.measures.push(of_tetrahedron());
        let of_parts = divided.measures.len() - 1;
        divided.springs = Vec::with_capacity(network.springs.len() + 9 * hexahedra.len());
        for (place, spring) in network.springs.iter().enumerate() {
            if !is_meant(spring) {
                divided.springs.push(spring.clone());
                continue;
            }
            let x: Vec<f64> = spring.points.iter().flat_map(|&p| network.points[p].iter().copied()).collect();
            let volumes = TETRAHEDRA.map(|corners| volume(&x, corners));
            let (whole, half) = (measure.value(&x, 3), volumes.iter().sum::<f64>() / 2.0);
            if !(volumes.iter().all(|volume| *volume > 0.0) && (half / whole - 1.0).abs() < ROUNDING) {
                let expected = "hexahedra that consist of tetrahedra, into which their springs on volumes are divided";
                let found = format!("a cell that is folded at {:?} m", network.points[spring.points[0]]);
                return Err(
                    Error::expected(format!("springs[{place}]"), expected, found).of_kind(ErrorKind::Unsupported)
                );
            }
            let parts = TETRAHEDRA.iter().zip(volumes).map(|(corners, volume)| SpringRecord {
                kind: Cow::Borrowed("volume"),
                points: Cow::Owned(corners.map(|a| spring.points[a]).to_vec()),
                constant: spring.constant * whole / (2.0 * volume),
                rest: spring.rest * volume / whole,
                measure: of_parts,
                damper: spring.damper * whole / (2.0 * volume),
                ..spring.clone()
            });
            divided.springs.extend(parts);
        }
        Ok(Some(Division { network: divided, hexahedra, measure }))
    }
}

/// Whether a measure is the volume of a single hexahedron with eight corners.
fn is_of_hexahedron(measure: &MeasureRecord) -> bool {
    let is_whole = |cell: &ShareRecord| cell.share == 1.0 && cell.nodes.iter().copied().eq(0..8);
    let is_solid = |term: &TermRecord| term.gradients.len() == 8 && term.gradients.iter().all(|g| g.len() == 3);
    let is_of_element = measure.kind == MeasureKind::Content && measure.element.as_deref() == Some(ELEMENT);
    is_of_element
        && matches!(&measure.cells[..], [cell] if is_whole(cell))
        && measure.terms.len() == 8
        && measure.terms.iter().all(is_solid)
}

/// The volume of the tetrahedron of its points.
fn of_tetrahedron() -> MeasureRecord {
    let gradients = [[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|g| g.to_vec()).to_vec();
    MeasureRecord {
        kind: MeasureKind::Content,
        element: None,
        terms: vec![TermRecord { weight: 1.0 / 6.0, gradients }],
        cells: vec![ShareRecord { nodes: (0..4).collect(), share: 1.0 }],
        expression: None,
    }
}

/// The volume of a tetrahedron of points at `x`, `[points × 3]`.
fn volume(x: &[f64], [o, a, b, c]: [usize; 4]) -> f64 {
    let from = |p: usize| std::array::from_fn::<f64, 3, _>(|k| x[3 * p + k] - x[3 * o + k]);
    dot(&from(a), &cross(from(b), from(c))) / 6.0
}
