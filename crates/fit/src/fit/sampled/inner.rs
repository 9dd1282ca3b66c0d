//! Laws that are not linear in their parameters, or whose parameters are bounded: the search from several starts.
//!
//! The first start searches on all shapes, the others on some; those that end apart from each other are finished on all.
//!
//! Theory: page *Sampled fits* of the book.

use super::block::Drawn;
use super::cell::{SampledCell, Sums};
use super::newton::{Descent, End};
use super::numbers::Numbers;
use super::sampling::Part;
use super::starts::{StartEnd, distance, scales};
use crate::error::{Error, ErrorKind, Result};

/// The iteration has converged when a step cannot lower the sum of squares by more than this share.
// The sum is quadratic around its optimum: parameters are known to the root of this share, 1e-6, before the last step of Newton.
const PROMISE: f64 = 1e-12;
/// A start, which searches on some of the shapes, has converged when a step cannot lower the sum of squares by more
/// than this share. That tells optima apart; those that are kept are finished to the finer share on all shapes.
const ROUGH_PROMISE: f64 = 1e-8;
/// Starts whose errors differ by less than this share of the best error have found the same optimum. A local optimum
/// that is worse by less than that is as good to whoever uses the springs.
const SAME: f64 = 1e-3;
/// Starts whose sums of squares differ by less than this share are finished together. It is above what
/// [`ROUGH_PROMISE`] leaves of each of them.
const EQUAL: f64 = 1e-6;
/// Inner parameters without bounds start between these values, evenly in their logarithm; the first start is one. Such
/// parameters are exponents and rates of strains, numbers whose size is mostly near one.
const STARTS: [f64; 2] = [0.1, 10.0];
/// The least number of shapes on which starts search, and the least number of their equations for each unknown.
// The fit to so many equations is near enough to an optimum on all shapes to tell optima apart. A start that is kept is finished on
// all shapes.
const FEW: [usize; 2] = [64, 8];
/// A prime by which the few shapes are spread over all. As it is prime, no shape comes twice unless their number is a
/// multiple of it, and it meets no period of a list.
const STRIDE: usize = 1_000_003;

/// The best of several starts.
pub struct Search {
    pub unknowns: Vec<f64>,
    /// The sums at these unknowns.
    pub sums: Sums,
    /// Whether the search converged within the allowed steps.
    pub converged: bool,
    /// The share of the starts that ended at the same error.
    pub agreeing: f64,
    /// Where each start ended.
    pub starts: Vec<StartEnd>,
}

/// Minimises from `starts` points within `bounds` of each unknown.
pub fn search(cell: &SampledCell, starts: usize, bounds: &[[f64; 2]]) -> Result<Search> {
    let outer = cell.each_parameter(|law, i| law.outer()[i]);
    let all_within = |range: [f64; 2]| (0..outer.len()).all(|i| !outer[i] || bounds[i] == range);
    let nonnegative = all_within([0.0, f64::INFINITY]);
    // Outer parameters with other bounds are left to the steps.
    let eliminated = match nonnegative || all_within([f64::NEG_INFINITY, f64::INFINITY]) {
        true => outer.clone(),
        false => vec![false; outer.len()],
    };
    let descent = Descent { bounds, eliminated: &eliminated, nonnegative };
    let total = cell.shapes(Part::Trained);
    let all = Drawn::new(cell, Part::Trained, (0..total).collect())?;
    // There are `seen` equations in each shape.
    let few = FEW[0].max((FEW[1] * cell.count()).div_ceil(cell.seen()));
    // More than half of the shapes would save little.
    let few = match starts > 1 && 2 * few < total {
        true => Some(Drawn::new(cell, Part::Trained, (0..few).map(|i| i * STRIDE % total).collect())?),
        false => None,
    };
    let mut found: Vec<End> = Vec::new();
    for start in 0..starts.max(1) {
        let mut first = start_of(cell, &outer, start, bounds);
        if eliminated != outer {
            let positive = (0..outer.len()).any(|i| outer[i] && bounds[i][0] >= 0.0);
            descent.eliminate(few.as_ref().unwrap_or(&all), &mut first, &outer, positive)?;
            // The linear equations do not know the bounds.
            first.iter_mut().zip(bounds).for_each(|(p, b)| *p = p.clamp(b[0], b[1]));
        }
        found.push(match &few {
            // The first start searches on all shapes, so that more starts are never worse than one.
            Some(few) if start > 0 => descent.run(few, first, ROUGH_PROMISE)?,
            Some(_) | None => descent.run(&all, first, PROMISE)?,
        });
    }
    // The law may have no value at a start, or lose its values on the way.
    let is_sound = |end: &End| {
        let (constants, parameters) = cell.written(&end.unknowns);
        end.is_finite() && constants.iter().chain(&parameters).all(|value| value.is_finite())
    };
    let starts = found.len();
    let mut of_starts = vec![(None, 0); starts];
    let mut ends: Vec<(End, f64)> = Vec::new();
    for (start, end) in found.into_iter().enumerate() {
        of_starts[start].1 = end.steps;
        if !is_sound(&end) {
            continue;
        }
        let square = end.sums.sums.square;
        // Ends are told apart by their sums: other parameters with the same sum are as good.
        let same = |(other, _): &(End, f64)| (other.sums.sums.square - square).abs() <= EQUAL * square;
        // The first start may be on other shapes than the rest.
        let first = usize::from(start > 0 && of_starts[0].0.is_some());
        let known = ends[first..].iter().position(same).map(|place| place + first);
        match known {
            Some(known) => ends[known].1 += 1.0,
            None => ends.push((end, 1.0)),
        }
        of_starts[start].0 = Some(known.unwrap_or(ends.len() - 1));
    }
    // Those that the others stand for end on all shapes.
    let first = usize::from(of_starts[0].0.is_some());
    for (place, (end, _)) in ends.iter_mut().enumerate() {
        if few.is_some() && place >= first {
            *end = descent.run(&all, std::mem::take(&mut end.unknowns), PROMISE)?;
            of_starts.iter_mut().filter(|(own, _)| *own == Some(place)).for_each(|(_, steps)| *steps += end.steps);
        }
    }
    let square = |end: &End| if is_sound(end) { end.sums.sums.square } else { f64::INFINITY };
    let best = ends.iter().map(|(end, _)| end).min_by(|a, b| square(a).total_cmp(&square(b)));
    let best = best.filter(|end| is_sound(end)).ok_or_else(without_values)?;
    // Errors are roots of these squares. An optimum of zero is met only to what ends a search.
    let limit = (square(best).sqrt() * (1.0 + SAME)).powi(2) + PROMISE * best.sums.sums.size;
    let is_best = |(end, _): &&(End, f64)| square(end) <= limit;
    let agreeing = ends.iter().filter(is_best).map(|(_, count)| count).sum::<f64>() / starts as f64;
    let scales = scales(cell, &best.unknowns);
    let of_start = |(end, steps): (Option<usize>, usize)| match end.map(|place| &ends[place].0) {
        Some(end) if is_sound(end) => StartEnd {
            error: end.sums.sums.error(&vec![0.0; end.unknowns.len()]),
            steps,
            converged: end.converged,
            distance: distance(&end.unknowns, &best.unknowns, &scales),
        },
        Some(_) | None => StartEnd { error: f64::NAN, steps, converged: false, distance: f64::NAN },
    };
    let starts = of_starts.into_iter().map(of_start).collect();
    let (sums, converged, unknowns) = (best.sums.sums.clone(), best.converged, best.unknowns.clone());
    Ok(Search { unknowns, sums, converged, agreeing, starts })
}

fn without_values() -> Error {
    let expected = "a law with finite values at the sampled shapes";
    Error::expected("force", expected, "no start with them").of_kind(ErrorKind::Infeasible)
}

/// Inner parameters as the start prescribes, the same for all springs; outer ones are zero, or as near to it as their
/// bounds allow.
fn start_of(cell: &SampledCell, outer: &[bool], start: usize, bounds: &[[f64; 2]]) -> Vec<f64> {
    let places = cell.each_parameter(|_, i| i);
    let numbers = Numbers { index: start, seed: cell.fit.sampling.seed };
    let value = |(i, &[lower, upper]): (usize, &[f64; 2])| {
        // Linear parameters follow from least squares wherever the search begins.
        if outer[i] {
            return 0f64.clamp(lower, upper);
        }
        let share = if start == 0 { 0.5 } else { numbers.number(places[i]) };
        let value = match lower.is_finite() && upper.is_finite() {
            true => lower + share * (upper - lower),
            // Exponents and rates are of unknown size: even shares of the logarithm try all sizes alike.
            false => STARTS[0] * (STARTS[1] / STARTS[0]).powf(share),
        };
        value.clamp(lower, upper)
    };
    bounds.iter().enumerate().map(value).collect()
}
