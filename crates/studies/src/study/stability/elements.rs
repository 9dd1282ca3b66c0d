//! The constants of one element in every case, compared with double-double results.

use super::outcome::{Family, StabilityRow, Verdict, worst};
use super::shapes::{ShapeCase, shape_cases};
use crate::element::Element;
use crate::error::Result;
use crate::fit::{
    CellFits, ExactFit, Fit, Objective, Weight, bounded_constants, condition, distance_from_optimum,
    double_double_constants, exact_double_double_constants, fit_cells, fit_element, fit_exact, single_constants,
};
use crate::random::Random;
use crate::scalar::{DoubleDouble, Real};
use crate::solve;
use crate::springs::Springs;
use crate::stiffness::Geometry;
use nalgebra::{DMatrix, DVectorView};
use rayon::prelude::*;

/// The relative error of constants that is promised, unless rounding of the node positions causes a larger one.
pub const PROMISED: f64 = 1e-9;
/// The gap that a spectral fit proves, plus the rounding of its bound.
const GAP: f64 = 1.1e-8;
/// The rounding of the node positions to whose effect an error may amount, in units of 2⁻⁵³ of the element's size. Each
/// position is rounded some ten times on its way into a Jacobian.
const ROUNDINGS: f64 = 32.0;
/// The number of patterns of moved nodes that are tried.
const PATTERNS: u64 = 4;
/// How far nodes are moved, relative to the element's size: from the farthest down, while constants change by more than
/// a tenth.
const MOVES: [f64; 4] = [1.0 / (1u64 << 26) as f64, 1.0 / (1u64 << 34) as f64, 1.0 / (1u64 << 42) as f64, 1e-15];
/// Bounded and tied fits are tried in one of this number of cases, because each costs as much as the plain fit.
const THINNED: usize = 4;
/// What helps where the nodes run the other way round.
const RENUMBER: &str = "list the nodes in the opposite order; cells of meshes that are read are turned as they are";
/// What helps where a cell is tangled or flat.
const RESHAPE: &str = "move the nodes, or mesh anew: the finite element has no stiffness on this shape";
/// What helps where a spring has no gradient.
const UNMEASURED: &str =
    "leave the group of such springs out of the fit, or move the nodes: no angle may be straight, no length zero";
/// What helps where a motion is too soft on a slender cell.
const SLENDER: &str =
    "choose frobenius, offdiag or modal, which have an optimum here, or mesh anew without such slender cells";
/// What helps where a motion is too soft beside the change of content.
const INCOMPRESSIBLE: &str =
    "choose frobenius, offdiag or modal, which have an optimum here, or a Poisson's ratio farther from its bounds";
/// What helps where a motion is too soft otherwise.
const SOFT: &str = "choose frobenius, offdiag or modal, which have an optimum here";
/// What helps where the optimum is not known.
const INEXACT: &str = "choose springs of which none is a combination of the others, or leave a group out";
/// The density, kg/m³.
const DENSITY: f64 = 1000.0;

/// Every case of the element with every objective.
///
/// # Errors
/// The element has no springs, or no valid shape.
pub fn sweep_element(element: &Element, progress: &mut dyn FnMut(usize, usize)) -> Result<Vec<StabilityRow>> {
    let springs = Springs::select(element, None)?;
    let cases = shape_cases(element)?;
    let (total, mut done, mut rows) = (cases.len(), 0, Vec::new());
    // Cases do not depend on each other, and rows keep their order.
    let of_case = |(i, case): (usize, ShapeCase)| {
        let subject = Subject { element, springs: &springs, case: &case };
        let objectives = Objective::all(element.has_higher_modes());
        let chosen = Choice::ALL.into_iter().filter(|choice| *choice == Choice::Free || i % THINNED == 0);
        let fits = chosen.flat_map(|choice| objectives.iter().map(move |o| (*o, choice)));
        let fits = fits.map(|(objective, choice)| subject.row(objective, choice));
        // What is condensed has no exact network.
        let exact = (element.modes() == 0).then(|| subject.exact_row());
        exact.into_iter().chain(fits).collect::<Vec<_>>()
    };
    let mut cases = cases.into_iter().enumerate();
    while done < total {
        progress(done, total);
        let some: Vec<(usize, ShapeCase)> = cases.by_ref().take(AT_ONCE).collect();
        done += some.len();
        // The rows keep the order of the shapes, on any number of threads.
        rows.par_extend(some.into_par_iter().flat_map_iter(of_case));
    }
    Ok(rows)
}

/// So many shapes are fitted between two messages: enough that no thread waits long for the last of them.
const AT_ONCE: usize = 32;

/// The set from which constants are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Choice {
    Free,
    Nonnegative,
    Tied,
}

impl Choice {
    const ALL: [Choice; 3] = [Choice::Free, Choice::Nonnegative, Choice::Tied];

    fn fit(self, objective: Objective) -> Fit {
        Fit { nonnegative: self == Choice::Nonnegative, tied: self == Choice::Tied, ..Fit::new(objective) }
    }

    fn title(self, objective: Objective) -> String {
        match self {
            Choice::Free => objective.title(),
            Choice::Nonnegative => format!("{}, k >= 0", objective.title()),
            Choice::Tied => format!("{}, tied", objective.title()),
        }
    }
}

struct Subject<'a> {
    element: &'a Element,
    springs: &'a Springs,
    case: &'a ShapeCase,
}

impl Subject<'_> {
    fn row(&self, objective: Objective, choice: Choice) -> StabilityRow {
        let Subject { element, springs, case } = self;
        let method = choice.title(objective);
        let of = |verdict| StabilityRow::new(&element.name, case.family, &case.name, &method, verdict);
        let (fit, moduli) = (choice.fit(objective), case.material.moduli());
        let cell: Vec<usize> = (0..element.nodes()).collect();
        let fits = match fit_cells(element, springs, &case.x, &cell, moduli, &fit, &mut |_| {}) {
            Ok(fits) => fits,
            Err(e) => return of(Verdict::Refused(e.problem().into())).with_way_out(self.way_out()),
        };
        let k = &fits.constants;
        let constants = |x: &[f64]| fit_element(element, springs, x, moduli, &fit).ok();
        let is_spectral = matches!(objective, Objective::Spectral(_));
        // Gaps are proved, and have no reference that single precision could be compared with.
        let single = match choice {
            Choice::Free if !is_spectral => single_constants(element, springs, &case.x, &moduli, &fit).ok(),
            Choice::Free | Choice::Nonnegative | Choice::Tied => None,
        };
        // Where no end is reached, twice the digits would only reach none again, unless single precision has an answer to compare.
        let is_compared = single.is_some() || (fits.deficient == 0 && fits.unreached == 0);
        // The outer option tells whether there is a reference, the inner one whether its positive constants are those
        // of the optimum.
        let reference = match fit.nonnegative {
            _ if is_spectral || !is_compared => None,
            true => bounded_constants(element, springs, &case.x, &moduli, &fit, k).ok(),
            false => double_double_constants(element, springs, &case.x, &moduli, &fit).ok().map(Some),
        };
        let mut row = match (objective, &reference) {
            _ if k.iter().any(|k| !k.is_finite()) => of(Verdict::Lost).with_error(f64::INFINITY, PROMISED),
            _ if fits.deficient > 0 => of(Verdict::Dependent),
            _ if fits.unreached > 0 => {
                of(Verdict::Refused("no end is reached: a motion is too soft beside the stiffest".into()))
                    .with_way_out(self.stiffer())
            }
            (Objective::Spectral(_), _) => {
                let certificate = fits.certificates[0];
                let (said, promised) = ((&k[..], certificate.value), GAP + 1.1 * certificate.rounding());
                match distance_from_optimum(element, springs, &case.x, &moduli, &fit, said) {
                    Ok(distance) => self.judged(of, distance, promised, constants),
                    Err(_) => of(Verdict::Lost).with_error(f64::INFINITY, promised),
                }
            }
            (_, Some(Some(reference))) => self.judged(of, distance(k, reference), PROMISED, constants),
            (_, Some(None)) => of(Verdict::Lost).with_error(f64::INFINITY, PROMISED),
            (_, None) => {
                of(Verdict::Told("twice the digits find no answer to compare with".into())).with_way_out(INEXACT)
            }
        };
        if choice == Choice::Free {
            row.single = single
                .zip(reference.flatten())
                .map(|(k, reference)| distance(&k.iter().map(Real::rounded).collect::<Vec<_>>(), &reference))
                .filter(|error| error.is_finite());
            let weight = objective.weight().filter(|weight| *weight != Weight::Relative).unwrap_or(Weight::None);
            row.condition = condition(weight, element, springs, &case.x, &moduli).ok();
        }
        row.negative = Some([k.iter().filter(|k| **k < 0.0).count(), k.len()]);
        self.measure(&fits, &mut row);
        row
    }

    /// What helps where the element has no fit.
    fn way_out(&self) -> &'static str {
        let Subject { element, springs, case } = self;
        if case.family == Family::Reversed {
            return RENUMBER;
        }
        let mut geometry = Geometry::new(&element.tabulation);
        match geometry.set(&element.tabulation, &case.x) {
            Ok(()) if !springs.functions().is_empty() => UNMEASURED,
            Ok(()) | Err(_) => RESHAPE,
        }
    }

    /// What helps where a motion is too soft beside the stiffest.
    fn stiffer(&self) -> &'static str {
        match self.case.family {
            Family::Poisson => INCOMPRESSIBLE,
            Family::Needle | Family::Cap | Family::Sliver | Family::Near => SLENDER,
            Family::Young | Family::Size | Family::Place | Family::Bent | Family::Corner | Family::Reversed => SOFT,
            Family::Contrast | Family::Mesh | Family::Motion | Family::Collapse => SOFT,
        }
    }

    /// The exact network: its springs between nodes compared with double-double results.
    fn exact_row(&self) -> StabilityRow {
        let Subject { element, case, .. } = self;
        let of = |verdict| StabilityRow::new(&element.name, case.family, &case.name, "exact", verdict);
        let (material, moduli) = (case.material, case.material.moduli());
        let cell: Vec<usize> = (0..element.nodes()).collect();
        let made = |x: &[f64]| fit_exact(element, x, &cell, material, &ExactFit::default(), &mut |_| {});
        let fits = match made(&case.x) {
            Ok(fits) => fits,
            Err(e) => return of(Verdict::Refused(e.problem().into())).with_way_out(self.way_out()),
        };
        let pairs = |fits: &CellFits| fits.constants[..fits.springs.pairs().len()].to_vec();
        let k = pairs(&fits);
        let mut row = match exact_double_double_constants(element, &case.x, moduli.mu) {
            Ok(reference) => {
                self.judged(of, distance(&k, &reference), PROMISED, |x| made(x).ok().map(|fits| pairs(&fits)))
            }
            Err(_) => of(Verdict::Told("twice the digits find no answer to compare with".into())).with_way_out(INEXACT),
        };
        row.negative = Some([k.iter().filter(|k| **k < 0.0).count(), fits.constants.len()]);
        row
    }

    /// The verdict on an error with this bound, or with the effect of rounding the node positions as its bound.
    fn judged(
        &self,
        of: impl Fn(Verdict) -> StabilityRow,
        error: f64,
        promised: f64,
        constants: impl Fn(&[f64]) -> Option<Vec<f64>>,
    ) -> StabilityRow {
        if error <= promised {
            return of(Verdict::Accurate).with_error(error, promised);
        }
        let allowed = self.unavoidable(constants).max(promised);
        of(if error <= allowed { Verdict::InputLimited } else { Verdict::Lost }).with_error(error, allowed)
    }

    /// The relative change of the constants when each node moves by some roundings of the element's size.
    fn unavoidable(&self, of: impl Fn(&[f64]) -> Option<Vec<f64>>) -> f64 {
        let Subject { element, case, .. } = self;
        let d = element.dimension();
        let size = (0..case.x.len()).map(|i| (case.x[i] - case.x[i % d]).abs()).fold(0.0, f64::max);
        let Some(k) = of(&case.x) else { return 0.0 };
        let mut largest = 0.0f64;
        for pattern in 0..PATTERNS {
            let change = |step: f64| {
                let mut random = Random::new(pattern);
                // Each coordinate moves by the whole step, up or down, as it does by the worst rounding.
                let x: Vec<f64> = case.x.iter().map(|x| x + step * size * random.symmetric().signum()).collect();
                of(&x).map_or(f64::INFINITY, |other| difference(&other, &k))
            };
            let changes = MOVES.map(|step| (step, change(step)));
            let small = changes.iter().find(|(_, change)| *change < 0.1).unwrap_or(&changes[3]);
            // Shapes that become invalid when they are perturbed are skipped.
            largest = largest.max(if small.1.is_finite() { small.1 / small.0 } else { 0.0 });
        }
        // The rounding of a number is at most half of the distance to the next one.
        ROUNDINGS * f64::EPSILON / 2.0 * largest
    }

    /// The network of the element alone: its softest motion and its longest explicit step.
    fn measure(&self, fits: &CellFits, row: &mut StabilityRow) {
        let Subject { element, springs, case } = self;
        let (d, n, mut geometry) = (element.dimension(), case.x.len(), Geometry::new(&element.tabulation));
        if geometry.set(&element.tabulation, &case.x).is_err() {
            return;
        }
        let (mut g, mut k) = (Vec::new(), DMatrix::zeros(n, n));
        springs.gradients(&case.x, &geometry, &mut g);
        for (g, constant) in g.chunks_exact(n).zip(&fits.constants) {
            let g = DVectorView::from_slice(g, n);
            k.ger(*constant, &g, &g, 1.0);
        }
        if k.iter().any(|entry| !entry.is_finite()) {
            return;
        }
        let mut eigenvalues: Vec<f64> = solve::eigenvalues(k).iter().copied().collect();
        eigenvalues.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
        let largest = eigenvalues[0].abs();
        // Without the rigid motions, whose eigenvalues are nearest to zero.
        // A body of d dimensions has d translations and d (d − 1)/2 rotations.
        eigenvalues.truncate(n - d * (d + 1) / 2);
        let least = eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        row.softest = (largest > 0.0).then_some(least / largest);
        let mass = DENSITY * case.material.thickness() * geometry.content() / element.nodes() as f64;
        // Central differences are stable up to `2/ω` of the largest frequency.
        row.step = Some(2.0 * (mass / largest).sqrt()).filter(|step| step.is_finite());
    }
}

/// `max |a − b|/max |b|`, with b in double-double numbers.
fn distance(a: &[f64], b: &[DoubleDouble]) -> f64 {
    let size = b.iter().map(|b| b.hi.abs()).fold(0.0, f64::max);
    let away = worst(a.iter().zip(b).map(|(a, b)| (DoubleDouble::from(*a) - b).hi.abs()));
    if away == 0.0 { 0.0 } else { away / size }
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().map(|b| b.abs()).fold(0.0, f64::max);
    worst(a.iter().zip(b).map(|(a, b)| (a - b).abs())) / size
}
