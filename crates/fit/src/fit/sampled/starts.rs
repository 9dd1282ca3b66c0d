//! Where the starts of a search ended, and how far from the best of them.

use super::cell::SampledCell;
use std::collections::BTreeMap;

/// Where one start of the search for the parameters of a law ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StartEnd {
    /// The error `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` at the end, on all shapes of the fit; NaN where the law has no value.
    pub error: f64,
    /// The number of steps, on some of the shapes and on all of them.
    pub steps: usize,
    /// Whether the search converged within the allowed steps.
    pub converged: bool,
    /// The largest difference of a parameter from that of the best start, relative to the largest value of this parameter in the group
    /// of springs.
    pub distance: f64,
}

/// The largest value of each parameter in its group of springs, unknown by unknown.
pub fn scales(cell: &SampledCell, unknowns: &[f64]) -> Vec<f64> {
    let mut largest: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut kinds = vec![(0, 0); unknowns.len()];
    for s in 0..cell.len() {
        for (i, unknown) in cell.places(s).enumerate() {
            kinds[unknown] = (cell.group(s), i);
            let size = largest.entry(kinds[unknown]).or_default();
            *size = size.max(unknowns[unknown].abs());
        }
    }
    kinds.iter().map(|kind| largest[kind]).collect()
}

/// The largest difference of two parameters, relative to their scales.
pub fn distance(unknowns: &[f64], best: &[f64], scales: &[f64]) -> f64 {
    // Equal parameters have the distance zero, also where their scale is zero.
    let one = |((p, b), scale): ((&f64, &f64), &f64)| if p == b { 0.0 } else { (p - b).abs() / scale.max(p.abs()) };
    unknowns.iter().zip(best).zip(scales).map(one).fold(0.0, f64::max)
}
