//! Congruent cells: objectives that are expensive are fitted once for all cells of the same shape.

use super::visit::each_cell;
use crate::element::Element;
use crate::error::Result;
use crate::material::{BlockValues, Hooke, Moduli};
use crate::springs::distance;
use std::collections::HashMap;

/// The relative difference below which lengths are equal; rounding in generated boxes is about 1e-14.
const EQUAL: f64 = 1e-12;
/// The ratio of the sizes of cells whose lengths are compared in another unit.
const SIZES: f64 = 1e3;

/// Cells grouped by their moduli and the distances of their nodes. These are equal for cells that a rigid motion or a mirror
/// maps onto each other, and such cells have the same constants.
pub struct Congruence {
    /// One cell of each shape.
    pub representatives: Vec<usize>,
    /// The shape of each cell, as an index into `representatives`.
    pub shapes: Vec<usize>,
}

impl Congruence {
    /// Groups cells of the same moduli that a rigid motion or a mirror maps onto each other; under anisotropic laws those that a
    /// translation does.
    ///
    /// # Errors
    /// A cell is reversed, tangled or flat.
    pub fn of(
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        hooke: &BlockValues<Hooke>,
    ) -> Result<Congruence> {
        let d = element.dimension();
        let moduli = |cell: usize| match hooke {
            BlockValues::Uniform(_) => Vec::new(),
            BlockValues::Each(all) => match &all[cell] {
                Hooke::Isotropic(Moduli { lambda, mu }) => vec![lambda.to_bits(), mu.to_bits()],
                Hooke::Anisotropic(stiffness) => stiffness.bits(),
            },
        };
        if hooke.values().iter().any(Hooke::is_anisotropic) {
            // The axes of the material do not turn with the cell.
            return Congruence::by(element, points, connectivity, moduli, |x| differences(x, d));
        }
        Congruence::by(element, points, connectivity, moduli, |x| {
            let node = |a: usize| &x[a * d..(a + 1) * d];
            let pairs = (0..element.nodes()).flat_map(|b| (0..b).map(move |a| (a, b)));
            pairs.map(|(a, b)| distance(node(a), node(b))).collect()
        })
    }

    /// Groups cells that a translation maps onto each other; rotated cells count as different.
    ///
    /// # Errors
    /// A cell is reversed, tangled or flat.
    pub fn by_translation(element: &Element, points: &[f64], connectivity: &[usize]) -> Result<Congruence> {
        let d = element.dimension();
        Congruence::by(element, points, connectivity, |_| Vec::new(), |x| differences(x, d))
    }

    /// Two cells are of one shape if they have the same `moduli`, as bits, and `lengths`, which are computed from the node
    /// positions.
    fn by(
        element: &Element,
        points: &[f64],
        connectivity: &[usize],
        moduli: impl Fn(usize) -> Vec<u64>,
        lengths: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Congruence> {
        let mut congruence = Congruence { representatives: Vec::new(), shapes: Vec::new() };
        let mut known: HashMap<Vec<i64>, usize> = HashMap::new();
        // The largest length of the first cell, m.
        let mut first = 0.0;
        each_cell(element, points, connectivity, 0, |cell, x, _| {
            let lengths = lengths(x);
            let largest = lengths.iter().fold(0.0, |a, length: &f64| length.abs().max(a));
            // The unit is that of the first cell, not of a sum over all, because cells are passed one by one.
            if first == 0.0 {
                first = largest;
            }
            // One unit for all cells of about a size, so that equal lengths have equal keys. In that of a much smaller cell
            // lengths would be beyond whole numbers, and in that of a much larger one cells of different shapes would
            // have one key. Where rounding puts equal cells on two sides of a step, they are only fitted twice.
            let size = ((largest / first).ln() / SIZES.ln()).round();
            let unit = EQUAL * first * SIZES.powf(size);
            let moduli = moduli(cell).into_iter().map(u64::cast_signed).chain([size as i64]);
            // A length is at most half a factor of SIZES above the unit of its size: 3e13 steps, far below 2⁶³.
            let key = moduli.chain(lengths.iter().map(|length| (length / unit).round() as i64)).collect();
            let shape = *known.entry(key).or_insert_with(|| {
                congruence.representatives.push(cell);
                congruence.representatives.len() - 1
            });
            congruence.shapes.push(shape);
        })?;
        Ok(congruence)
    }
}

/// The positions of the nodes relative to the first.
fn differences(x: &[f64], d: usize) -> Vec<f64> {
    (d..x.len()).map(|i| x[i] - x[i % d]).collect()
}
