//! Springs on the volumes of hexahedra in terms of tetrahedra, for programs that hold these alone.

use super::record::{MeasureKind, MeasureRecord, NetworkRecord, ShareRecord, SpringRecord, TermRecord};
use crate::element::{Cell, Element, SHIPPED};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{Measure, cross, dot};
use std::borrow::Cow;
use std::sync::Arc;

/// The two ways to divide a hexahedron into a tetrahedron in its middle and four at its corners, which cross its faces along the one
/// diagonal and along the other. Corners are in the order of the reference cell; volumes are positive in this order.
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
/// The mean volume of both divisions is that of the hexahedron, also where its faces are bent, to rounding.
const ROUNDING: f64 = 1e-9;

/// A network whose springs on the volumes of hexahedra are on those of tetrahedra.
///
/// The volume of a hexahedron is half that of its ten tetrahedra, `V = ½ Σ_t V_t`. In place of `½ K (V − V̄)²` they have
/// `Σ_t ½ K_t (V_t − V̄_t)²` with `K_t = K V₀/(2 V_t0)` and `V̄_t/V_t0 = V̄/V₀`: the same energy if all grow alike, and more otherwise, by the inequality of Cauchy and
/// Schwarz. The network is stiffer where the cells change their shapes.
#[derive(Debug)]
pub struct Division {
    /// The divided network.
    pub network: NetworkRecord,
    /// The hexahedra, by their places in the springs of the whole one.
    pub hexahedra: Vec<usize>,
    /// What they measure, by the places of the measures; `None` of other measures.
    pub measures: Vec<Option<Measure>>,
}

impl Division {
    /// The division of a network; `None` if it has no spring on the volume of a hexahedron, or one with a law.
    ///
    /// # Errors
    /// A hexahedron is so distorted that one of its tetrahedra has no volume; the key is the place of the spring.
    pub fn of(network: &NetworkRecord) -> Result<Option<Division>> {
        let elements: Vec<Option<Arc<Element>>> = network.measures.iter().map(hexahedron).collect();
        let is_meant = |spring: &SpringRecord| elements[spring.measure].is_some() && spring.law.is_none();
        let hexahedra: Vec<usize> = (0..network.springs.len()).filter(|&s| is_meant(&network.springs[s])).collect();
        if hexahedra.is_empty() || network.dimension != 3 {
            return Ok(None);
        }
        let measures: Vec<Option<Measure>> =
            elements.iter().map(|element| element.clone().map(Measure::Content)).collect();
        let mut divided = network.clone();
        divided.measures.push(of_tetrahedron());
        let of_parts = divided.measures.len() - 1;
        divided.springs = Vec::with_capacity(network.springs.len() + 9 * hexahedra.len());
        for (place, spring) in network.springs.iter().enumerate() {
            let known = elements[spring.measure].as_ref().zip(measures[spring.measure].as_ref());
            let Some((element, measure)) = known.filter(|_| is_meant(spring)) else {
                divided.springs.push(spring.clone());
                continue;
            };
            // A hexahedron of corners alone has a node at each of them.
            let tetrahedra =
                TETRAHEDRA.map(|corners| corners.map(|corner| element.corner_node(corner).unwrap_or(corner)));
            let x: Vec<f64> = spring.points.iter().flat_map(|&p| network.points[p].iter().copied()).collect();
            let volumes = tetrahedra.map(|corners| volume(&x, corners));
            let (whole, half) = (measure.value(&x, 3), volumes.iter().sum::<f64>() / 2.0);
            if !(volumes.iter().all(|volume| *volume > 0.0) && (half / whole - 1.0).abs() < ROUNDING) {
                let expected = "hexahedra that consist of tetrahedra, into which their springs on volumes are divided";
                let found = format!("a cell that is folded at {:?} m", network.points[spring.points[0]]);
                return Err(
                    Error::expected(format!("springs[{place}]"), expected, found).of_kind(ErrorKind::Unsupported)
                );
            }
            let parts = tetrahedra.iter().zip(volumes).map(|(corners, volume)| SpringRecord {
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
        Ok(Some(Division { network: divided, hexahedra, measures }))
    }
}

/// The element of a measure that is the volume of a single hexahedron, whose nodes are its corners; `None` of other measures.
fn hexahedron(measure: &MeasureRecord) -> Option<Arc<Element>> {
    let is_whole = |cell: &ShareRecord| cell.share == 1.0 && cell.nodes.iter().copied().eq(0..8);
    let is_single = measure.kind == MeasureKind::Content && matches!(&measure.cells[..], [cell] if is_whole(cell));
    let name = measure.element.as_deref().filter(|_| is_single)?;
    // Elements of users' own files are not known here.
    let file = SHIPPED.iter().find(|file| file.name == name)?;
    let element = Element::shipped(file).ok()?;
    let is_hexahedron = element.cell == Cell::Hexahedron && element.has_corners_alone();
    // The volume of a single quadrature point is not that of the cell.
    (is_hexahedron && measure.terms.len() == element.tabulation.points()).then(|| Arc::new(element))
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
