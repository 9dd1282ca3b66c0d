//! Runs a whole-object fit from its targets to the fitted network.

use super::displacements::{Displacements, Errors};
use super::object::Object;
use super::path::{Best, Path, Snapshot, Stage, StepCallback, leave_one_out, mean};
use super::settings::{Validation, Wanted, WholeSettings};
use crate::error::{Error, ErrorKind, Result};
use crate::model::Network;

/// The result of a whole-object fit.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct WholeFit {
    /// The fitted network.
    pub network: Network,
    /// The unknowns θ of the network.
    pub theta: Vec<f64>,
    /// The regularization ρ that was chosen; `None` if the start was best.
    pub regularization: Option<f64>,
    /// The errors on the loads of the fit and on frequencies, before and after.
    pub trained: [Errors; 2],
    /// The errors on the loads of the validation, before and after.
    pub validated: [Errors; 2],
    /// The number of steps that were made.
    pub steps: usize,
    /// The largest factor by which a constant changed.
    pub change: f64,
    /// The ratio of the largest to the least constant of the length springs.
    pub range: f64,
    /// Whether a better ρ was rejected because this ratio would have been too large.
    pub limited: bool,
    /// Whether this ratio is larger than the one that is allowed where ρ is chosen, and than that of the start.
    pub exceeds: bool,
    /// The stages of the path, one for each ρ.
    pub curve: Vec<Stage>,
    /// With leave-one-out validation the geometric mean of the relative errors after each stage.
    pub left_out: Vec<f64>,
    /// Whether the network is stable under every load at the start; otherwise it is returned unchanged.
    pub stands: bool,
    /// Whether the fit was cancelled.
    pub cancelled: bool,
}

impl WholeFit {
    /// The fit with unknowns θ that were found in another way.
    ///
    /// # Errors
    /// The network is not stable at θ, or the equations do not fit into memory.
    pub fn moved(self, object: &Object, wanted: &Wanted, theta: &[f64]) -> Result<WholeFit> {
        let problem = Displacements::new(object, wanted.trained.iter().collect(), wanted.frequencies.as_ref())?;
        let judge = Displacements::new(object, wanted.validation.loads().iter().collect(), None)?;
        self.ended(object, (&problem, &judge), theta)
    }

    fn ended(
        mut self,
        object: &Object,
        (problem, judge): (&Displacements, &Displacements),
        theta: &[f64],
    ) -> Result<WholeFit> {
        let after = |problem: &Displacements| {
            let fell = || {
                let problem = "the fitted network has become unstable under a load";
                Error::at("network", problem).of_kind(ErrorKind::Infeasible)
            };
            // The result is judged as a run that begins with these unknowns would judge it.
            problem.forget();
            problem.errors(theta)?.ok_or_else(fell)
        };
        (self.trained[1], self.validated[1]) = (after(problem)?, after(judge)?);
        (self.network, self.range) = (object.network(theta), object.range(theta));
        self.change = object.unknowns().factors(theta).into_iter().map(|c| c.max(1.0 / c)).fold(1.0, f64::max);
        self.theta = theta.to_vec();
        Ok(self)
    }
}

/// Fits the constants of the object. `from` is a state of an earlier run of the same fit. A network that is unstable at
/// the start is not an error.
///
/// # Errors
/// There is no load, or one moves nothing; the snapshot belongs to another fit; or the equations do not fit into
/// memory.
pub fn fit_whole(
    object: &Object,
    wanted: &Wanted,
    settings: &WholeSettings,
    from: Option<Snapshot>,
    watch: &mut StepCallback,
) -> Result<WholeFit> {
    let (m, stages) = (object.unknowns().count(), settings.regularizations.len());
    if let Some(snapshot) = &from {
        snapshot.check(m, stages)?;
    }
    if wanted.trained.is_empty() {
        return Err(Error::expected("loads", "loads that act on a free point", "none"));
    }
    if stages == 0 {
        return Err(Error::expected("regularization", "at least one", "none"));
    }
    let problem = Displacements::new(object, wanted.trained.iter().collect(), wanted.frequencies.as_ref())?;
    let judge = Displacements::new(object, wanted.validation.loads().iter().collect(), None)
        .map_err(|e| e.at_key("validate"))?;
    let start = vec![0.0; m];
    let network = object.network(&start);
    let mut found = WholeFit {
        range: object.range(&start),
        network,
        theta: start.clone(),
        regularization: None,
        trained: Default::default(),
        validated: Default::default(),
        steps: 0,
        change: 1.0,
        limited: false,
        exceeds: false,
        curve: Vec::new(),
        left_out: Vec::new(),
        stands: false,
        cancelled: false,
    };
    let (Some(trained), Some(validated)) = (problem.errors(&start)?, judge.errors(&start)?) else { return Ok(found) };
    found.stands = true;
    let error = match wanted.validation {
        Validation::Discrepancy => Path { object, wanted, settings }.excess(&problem, &start)?,
        Validation::None | Validation::Loads(_) | Validation::LeaveOneOut => mean(&validated),
    };
    let first = Best { error, theta: start.clone(), stage: None };
    let begin = || Snapshot { stage: 0, theta: start, best: first, curve: Vec::new(), left_out: Vec::new() };
    let mut snapshot = from.unwrap_or_else(begin);
    let (mut steps, mut cancelled) = (0, false);
    let mut count = |snapshot: Option<&Snapshot>| {
        steps += 1;
        cancelled |= !watch(snapshot);
        !cancelled
    };
    let mut begins = true;
    if wanted.validation == Validation::LeaveOneOut && snapshot.left_out.is_empty() {
        snapshot.left_out = leave_one_out(object, wanted, settings, &mut count)?;
        // Cancelled during cross-validation, the fit has not begun.
        begins = !snapshot.left_out.is_empty();
    }
    let best = match begins {
        true => Path { object, wanted, settings }.follow(&problem, &judge, &mut snapshot, &mut count)?,
        false => snapshot.best.clone(),
    };
    // A run that goes on from this state has nothing left to do, also where leave-one-out has ended the path early.
    if !cancelled {
        snapshot.stage = stages;
    }
    watch(Some(&snapshot));
    // Where nothing validates no stage is refused for its range, and the report has to say it.
    found.exceeds = object.range(&best.theta) > settings.range.max(found.range);
    found.regularization = best.stage.map(|stage| settings.regularizations[stage]);
    (found.trained[0], found.validated[0]) = (trained, validated);
    let mut found = found.ended(object, (&problem, &judge), &best.theta)?;
    (found.steps, found.limited, found.cancelled) = (steps, snapshot.is_limited(), cancelled);
    (found.curve, found.left_out) = (snapshot.curve, snapshot.left_out);
    Ok(found)
}
