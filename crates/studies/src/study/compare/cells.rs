//! Fits of single elements on many shapes.

use super::axes::solver_of;
use super::usual::usual_fits;
use crate::analysis::moduli::{EffectiveModuli, Lattice};
use crate::analysis::shapes::ShapeSet;
use crate::bound::{self, check_count};
use crate::clock::Clock;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::{CellFits, ElementErrors, Solver, Spread, element_errors};
use crate::material::Material;
use crate::springs::Springs;
use serde::Serialize;
use springfit_scenes::{Event, NamedFit, Progress, Recipe, TimedWork, Times, interleaved_after, on_one_thread};
use std::sync::Arc;

/// The result of one method on shapes of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodOutcome {
    /// The name of the fit.
    pub name: String,
    /// The name of the solver, or `formula`.
    pub solver: &'static str,
    /// The processor time for each element that is fitted, s; absent where it was not measured.
    pub times: Option<Times>,
    /// The number of elements that were fitted; the others took the constants of a congruent one.
    pub fitted: usize,
    /// The relative errors of R in the Frobenius norm.
    pub frobenius: Spread,
    /// The relative errors of R in the induced 2-norm.
    pub spectral: Spread,
    /// The largest relative duality gap, if the method has certificates.
    pub gap: Option<f64>,
    /// The share of negative constants.
    pub negative: f64,
    /// The moduli of the springs on a periodic box of unit size; not for general solvers, nor for cells that do not
    /// fill a box.
    pub moduli: Option<EffectiveModuli>,
    /// The relative errors of each shape.
    #[serde(skip)]
    pub errors: ElementErrors,
    /// The number of springs of an element.
    #[serde(skip)]
    pub springs: usize,
    /// The number of negative constants of each shape.
    #[serde(skip)]
    pub negatives: Vec<usize>,
    /// The relative duality gap of each shape, if the method has certificates.
    #[serde(skip)]
    pub gaps: Vec<f64>,
}

/// Fits exactly `shapes` random shapes of the element with every objective, the spectral one with every solver, and by
/// the published formulas that it has; on one thread.
///
/// # Errors
/// `shapes` is 0 or exceeds its bound, or no valid shape is found.
pub fn compare_element(
    element: &Element,
    material: Material,
    shapes: usize,
    iterations: u64,
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    let fits = usual_fits(element, material, iterations);
    let set = ShapeSet { count: shapes, ..ShapeSet::default() };
    measure_fits(element, material, &set, &fits, true, progress)?.into_iter().collect()
}

/// Fits `shapes` random shapes of the element by each recipe, on one thread.
///
/// # Errors
/// Those of [`compare_element`]; or a recipe does not fit single elements, or a published method has no formula for
/// this one.
pub fn measure_recipes(
    element: &Element,
    material: Material,
    shapes: usize,
    recipes: &[Recipe],
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    let fits: Vec<NamedFit> = recipes.iter().map(|recipe| NamedFit::of(recipe.clone(), None)).collect();
    let set = ShapeSet { count: shapes, ..ShapeSet::default() };
    measure_fits(element, material, &set, &fits, true, progress)?.into_iter().collect()
}

/// Fits the shapes of the set by each fit, on one thread; the times, where they are asked for, are of passes that take turns. A fit that
/// does not serve the element has an error of its own.
///
/// # Errors
/// The number of shapes is out of range, or nearly every shape is tangled.
pub fn measure_fits(
    element: &Element,
    material: Material,
    set: &ShapeSet,
    fits: &[NamedFit],
    is_timed: bool,
    progress: &mut Progress,
) -> Result<Vec<Result<MethodOutcome>>> {
    check_count("shapes", set.count as u64, 1, bound::RANDOM_SHAPES)?;
    let shapes = Shapes {
        points: set.draw(element)?,
        cells: (0..set.count * element.nodes()).collect(),
        element: Arc::new(element.clone()),
        material,
    };
    let (mut outcomes, mut first) = (Vec::new(), Vec::new());
    for (done, named) in fits.iter().enumerate() {
        progress(Event::stage(&named.name, done, fits.len()));
        let (outcome, seconds) = match on_one_thread(|| shapes.measure(named)) {
            Ok((outcome, seconds)) => (Ok(outcome), seconds),
            Err(error) => (Err(error), 0.0),
        };
        outcomes.push(outcome);
        first.push(seconds);
    }
    if is_timed {
        let served: Vec<usize> = (0..fits.len()).filter(|fit| outcomes[*fit].is_ok()).collect();
        progress(Event::stage("times", fits.len(), fits.len()));
        let first: Vec<f64> = served.iter().map(|fit| first[*fit]).collect();
        let times = on_one_thread(|| {
            let mut works: Vec<TimedWork> = Vec::new();
            for &fit in &served {
                let named = &fits[fit];
                works.push(Box::new(|| {
                    let clock = Clock::start();
                    shapes.fit(named)?;
                    Ok(clock.seconds())
                }));
            }
            interleaved_after(&first, &mut works)
        })?;
        for (fit, times) in served.into_iter().zip(times) {
            if let Ok(outcome) = &mut outcomes[fit] {
                outcome.times = Some(times.scaled(1.0 / outcome.fitted as f64));
            }
        }
    }
    Ok(outcomes)
}

/// Shapes of an element in one mesh.
struct Shapes {
    element: Arc<Element>,
    material: Material,
    points: Vec<f64>,
    cells: Vec<usize>,
}

impl Shapes {
    fn fit(&self, named: &NamedFit) -> Result<CellFits> {
        let other = || Error::expected("recipe", "a fit of single elements", &named.name);
        let method = named.recipe.kind().cell_method().ok_or_else(other)?;
        let springs = Springs::select(&self.element, named.springs.as_deref())?;
        method.fit_cells(&self.element, &springs, &self.points, &self.cells, self.material)
    }

    /// The outcome of a fit, and the processor time of its first pass, s.
    fn measure(&self, named: &NamedFit) -> Result<(MethodOutcome, f64)> {
        let Shapes { element, material, points, cells } = self;
        let clock = Clock::start();
        let fitted = self.fit(named)?;
        let seconds = clock.seconds();
        let errors = element_errors(element, points, cells, material.moduli(), &fitted)?;
        let (shapes, springs) = (cells.len() / element.nodes(), fitted.springs.len());
        let negatives: Vec<usize> =
            fitted.constants.chunks(springs.max(1)).map(|k| k.iter().filter(|k| **k < 0.0).count()).collect();
        let gaps: Vec<f64> = fitted.certificates.iter().map(|c| c.gap()).collect();
        let general = named.recipe.stiffness().is_some_and(|fit| fit.solver != Solver::Native);
        let lattice = || {
            let method = named.recipe.kind().cell_method()?;
            let springs = Springs::select(element, named.springs.as_deref()).ok()?;
            let fit = |points: &[f64], cells: &[usize]| method.fit_cells(element, &springs, points, cells, *material);
            let size = vec![1.0; element.dimension()];
            Some(Lattice::of(element, &size, fit).ok()?.of_springs()?.of_solid(material.state()))
        };
        let outcome = MethodOutcome {
            name: named.name.clone(),
            solver: solver_of(named),
            times: None,
            fitted: shapes - fitted.reused,
            frobenius: Spread::of(&errors.frobenius),
            spectral: Spread::of(&errors.spectral),
            gap: gaps.iter().copied().reduce(f64::max),
            negative: negatives.iter().sum::<usize>() as f64 / fitted.constants.len().max(1) as f64,
            moduli: if general { None } else { lattice() },
            springs,
            errors,
            negatives,
            gaps,
        };
        Ok((outcome, seconds))
    }
}
