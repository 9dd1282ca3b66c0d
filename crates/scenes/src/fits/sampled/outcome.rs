//! The errors of a sampled fit.

use super::recipe::SampledRecipe;
use crate::fit::{CellStart, FamilyErrors, SampledFits, ShapeError, Spread};
use crate::number::or_nan;
use crate::order::grouped;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The relative errors of the forces, `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` for each cell, with the weights w of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledOutcome {
    /// The springs are fitted to this number of shapes, those of the element with the most.
    pub shapes: usize,
    /// The shapes of a list of gradients that may be fitted; `None` if they are not from one list.
    #[serde(skip)]
    pub listed: Option<usize>,
    /// The forces have these relative errors on the shapes of the fit: `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` with the weights w of the fit, so that
    /// with `weight = "none"` the errors of all shapes are relative to the forces of all shapes.
    pub trained: Spread,
    /// The forces have these relative errors on the shapes that were held out; they are null if there are none.
    pub held_out: Option<Spread>,
    /// At least this share of starts found the best parameters; it is null with a single start.
    #[serde(rename = "agreeing_starts")]
    pub agreeing: Option<f64>,
    /// The shapes of these loads of the scene were sampled; errors under them are not held out.
    pub loads: Vec<String>,
    /// In the element with the most, this number of shapes has less of its deformation than was drawn, as it would have turned the element
    /// inside out.
    pub reduced: usize,
    /// In this number of elements the springs have no finite force at a shape that is held out; then `held_out` is null.
    pub infinite: usize,
    /// Each entry has the errors on the shapes of a family that were held out, of the elements where they are finite.
    pub families: Vec<FamilyOutcome>,
    /// Each entry has the end of a start in the element in which the fewest agree, the first 16; the list is empty with a single start.
    pub starts: Vec<StartOutcome>,
    /// Each entry has one of the 8 shapes with the largest errors, if `data` are asked for. The table `shapes-NAME.csv` has all.
    pub worst: Vec<WorstShape>,
    /// The error of each shape by block of cells, if the data are asked for.
    #[serde(skip)]
    pub errors: Vec<Vec<ShapeError>>,
    /// The end of each start by block of cells, if the data are asked for.
    #[serde(skip)]
    pub ends: Vec<Vec<CellStart>>,
}

/// The errors on the shapes of a family that were held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FamilyOutcome {
    /// The family has this name; it is `listed` of a list of gradients, and `states` of states of the body.
    pub family: String,
    /// This number of its shapes is held out, that of the element with the most.
    pub shapes: usize,
    /// The forces have these relative errors on them.
    pub held_out: Spread,
}

/// The end of a start of the search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StartOutcome {
    /// The forces have this relative error at the end; it is null where the law has no value.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub error: f64,
    /// The search took this number of steps.
    pub steps: usize,
    /// The search has converged.
    pub converged: bool,
    /// A parameter differs by this much from that of the best start, at most, relative to its largest value in the group of springs.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub distance: f64,
}

/// A shape with a large error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorstShape {
    /// The block of cells has this number, from 0.
    pub block: usize,
    /// The cell has this number in its block, from 0.
    pub cell: usize,
    /// The shape is `trained` or `held-out`.
    pub part: String,
    /// The shape is of this family, `listed` or one of the `states`.
    pub family: String,
    /// The shape has this number in its set, from 0.
    pub shape: usize,
    /// The least det F over the quadrature points has this value.
    pub content: f64,
    /// The force has this relative error.
    pub error: f64,
}

impl SampledOutcome {
    /// The outcome of the fits of all blocks of cells.
    pub(super) fn of(recipe: &SampledRecipe, found: &[SampledFits], dimension: usize) -> SampledOutcome {
        let spread =
            |of: fn(&SampledFits) -> &Vec<f64>| Spread::of(&found.iter().flat_map(of).copied().collect::<Vec<f64>>());
        let apart = found.iter().flat_map(|f| &f.held_out).all(|error| error.is_finite());
        let held_out = apart.then(|| spread(|f| &f.held_out));
        SampledOutcome {
            shapes: found.iter().map(|found| found.shapes).max().unwrap_or(0),
            listed: match &recipe.fit.beside[..] {
                [] => recipe.fit.sampling.listed(dimension).map(|[own, _]| own),
                [..] => None,
            },
            trained: spread(|f| &f.trained),
            held_out,
            agreeing: found.iter().filter_map(|f| f.agreeing).reduce(f64::min),
            loads: recipe.loads(),
            reduced: found.iter().map(|found| found.reduced).max().unwrap_or(0),
            infinite: found.iter().flat_map(|f| &f.held_out).filter(|error| error.is_infinite()).count(),
            families: families(found),
            starts: starts(found),
            worst: worst(found),
            errors: if recipe.fit.data { found.iter().map(|found| found.errors.clone()).collect() } else { Vec::new() },
            ends: if recipe.fit.data { found.iter().map(|found| found.starts.clone()).collect() } else { Vec::new() },
        }
    }
}

/// The largest number of starts in a report: so many fit on a screen, and `data` writes all of them.
const STARTS: usize = 16;
/// The largest number of single shapes in a report.
const WORST: usize = 8;

fn families(found: &[SampledFits]) -> Vec<FamilyOutcome> {
    let outcome = |(name, own): (&str, Vec<&FamilyErrors>)| {
        let errors = own.iter().flat_map(|family| &family.errors).copied().filter(|error| error.is_finite());
        FamilyOutcome {
            family: name.into(),
            shapes: own.iter().map(|family| family.shapes).max().unwrap_or(0),
            held_out: Spread::of(&errors.collect::<Vec<f64>>()),
        }
    };
    let all = found.iter().flat_map(|found| &found.families).map(|family| (family.family, family));
    grouped(all).into_iter().map(outcome).collect()
}

/// The starts of the cell in which the fewest agree.
fn starts(found: &[SampledFits]) -> Vec<StartOutcome> {
    let least = found.iter().min_by(|a, b| a.agreeing.unwrap_or(1.0).total_cmp(&b.agreeing.unwrap_or(1.0)));
    let all = least.map_or(&[][..], |found| &found.starts);
    let cells = all.chunk_by(|a, b| a.cell == b.cell);
    // Of the starts that have values, as many as reached the least error agree.
    let agreeing = |starts: &&[CellStart]| {
        let errors = || starts.iter().map(|start| start.end.error);
        let best = errors().fold(f64::INFINITY, f64::min);
        // The share by which the search itself tells optima apart.
        errors().filter(|error| *error <= best * (1.0 + 1e-3)).count()
    };
    let worst = cells.min_by_key(agreeing).filter(|starts| starts.len() > 1).unwrap_or_default();
    let start = |start: &CellStart| StartOutcome {
        error: start.end.error,
        steps: start.end.steps,
        converged: start.end.converged,
        distance: start.end.distance,
    };
    worst.iter().take(STARTS).map(start).collect()
}

fn worst(found: &[SampledFits]) -> Vec<WorstShape> {
    let all = found.iter().enumerate().flat_map(|(block, found)| found.errors.iter().map(move |error| (block, error)));
    let mut all: Vec<(usize, &ShapeError)> = all.collect();
    all.sort_by(|(_, a), (_, b)| b.error.total_cmp(&a.error));
    let shape = |(block, error): (usize, &ShapeError)| WorstShape {
        block,
        cell: error.cell,
        part: error.part.name().into(),
        family: error.family.into(),
        shape: error.shape,
        content: error.content,
        error: error.error,
    };
    all.into_iter().take(WORST).map(shape).collect()
}

/// A fit with a larger relative error than this does not describe the body.
// It was chosen as large as the share of the elasticity tensor from which on a network is said to be another material.
const UNEXPLAINED: f64 = 0.1;

impl SampledOutcome {
    /// The largest relative error of a cell, at the shapes of the fit and at those held out.
    fn unexplained(&self) -> f64 {
        self.held_out.iter().map(|spread| spread.max).fold(self.trained.max, f64::max)
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let unexplained = Some(self.unexplained()).filter(|share| !(*share <= UNEXPLAINED)).map(|share| {
            format!(
                "in the worst element it leaves {:.2} % of the sampled forces unexplained: its springs or its law of force \
                 cannot describe the material there",
                100.0 * share
            )
        });
        let loads = (!self.loads.is_empty()).then(|| {
            format!(
                "fitted to the shapes of the finite elements under {}: its errors under them are not predictions",
                self.loads.join(", ")
            )
        });
        let agreeing = self.agreeing.filter(|share| *share < 1.0).map(|agreeing| {
            format!(
                "in the worst element {:.0} % of the starts reached the best parameters, and the others ended at worse ones",
                100.0 * agreeing
            )
        });
        let left_out = self.listed.filter(|listed| self.shapes < *listed).map(|listed| {
            let shapes = self.shapes;
            format!("fitted to the first {shapes} of the {listed} shapes of the list that are not held out: all are taken without count")
        });
        let reduced = (self.reduced > 0).then(|| {
            let (reduced, shapes) = (self.reduced, self.shapes);
            format!(
                "{reduced} of the {shapes} shapes of an element would have turned it inside out, and have half of their deformation or less"
            )
        });
        let infinite = (self.infinite > 0).then(|| {
            format!(
                "in {} of the elements the springs have no finite force at shapes that are held out: their law of force grows beyond all bounds",
                self.infinite
            )
        });
        unexplained.into_iter().chain(infinite).chain(left_out).chain(loads).chain(agreeing).chain(reduced).collect()
    }
}
