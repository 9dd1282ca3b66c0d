//! The loads of a whole-object fit, and its result.

use super::moduli::FoundModuli;
use super::recipe::{Start, WholeRecipe};
use crate::material::{CellMap, Hooke, Moduli};
use crate::whole::{Errors, MassStage, Stage, Target, Validation, Wanted, WholeFit};

/// The loads of a whole-object fit, and its result.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WholeOutcome {
    /// The names of the loads that were fitted.
    pub loads: Vec<String>,
    /// The names of the loads that chose the regularization.
    pub validated: Vec<String>,
    /// The regularization ρ that was chosen; `None` if the start was best.
    pub regularization: Option<f64>,
    /// The errors on the loads of the fit.
    pub fitted: Vec<FittedLoad>,
    /// The errors on the loads that chose the regularization.
    pub judged: Vec<FittedLoad>,
    /// The relative errors `ω_i/ω̄_i − 1` of the frequencies that were fitted, before and after.
    pub frequencies: [Vec<f64>; 2],
    /// The largest factor by which a constant changed.
    pub change: f64,
    /// The ratio of the largest to the least constant of the length springs.
    pub range: f64,
    /// Whether a better ρ was rejected because this ratio would have been too large.
    pub limited: bool,
    /// Whether the ratio is larger than the one that is allowed where ρ is chosen.
    pub exceeds: bool,
    /// The stages of the path, one for each ρ.
    pub curve: Vec<Stage>,
    /// How many times as large as the noise the residuals are, if the noise chose ρ.
    pub excess: Option<f64>,
    /// With leave-one-out validation the geometric mean of the relative errors after each stage.
    pub left_out: Vec<f64>,
    /// The number of steps.
    pub steps: usize,
    /// Whether the network is stable under every load at the start; otherwise it is returned unchanged.
    pub stands: bool,
    /// Whether the fit was cancelled.
    pub cancelled: bool,
    /// Whether the fit started from the exact network.
    pub is_exact: bool,
    /// Whether the displacements were measured, so that the moduli of the scene are a guess.
    pub is_measured: bool,
    /// The moduli of the body or of its regions, if these are the unknowns.
    pub moduli: FoundModuli,
    /// The errors under loads that were neither fitted nor chose ρ, for each support, if they were computed.
    pub held_out: Vec<HeldOut>,
    /// The masses, if they were fitted.
    pub masses: Option<FittedMasses>,
}

/// Masses that were fitted to the frequencies of the body, with its mass, centre and second moments.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FittedMasses {
    /// The masses, `[points]`, kg.
    pub masses: Vec<f64>,
    /// The number of frequencies that were fitted under each support.
    pub count: usize,
    /// The regularization ρ that was chosen.
    pub regularization: f64,
    /// The largest error of the second moments on the diagonal, relative to those of the body: none, or that of lumped masses.
    pub second_error: f64,
    /// The largest factor by which a mass changed.
    pub change: f64,
    /// Their sum, kg.
    pub total: f64,
    /// The share s of lumped masses in the mass matrix `(1 − s) M_c + s diag(m)` that was fitted to the same frequencies.
    pub share: f64,
    /// The stages of its path.
    pub curve: Vec<MassStage>,
    /// The errors of frequencies under each support.
    pub supports: Vec<SupportFrequencies>,
}

/// What loads and frequencies under a support are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SupportPart {
    /// They are fitted; others may choose ρ.
    Fitted,
    /// They choose ρ.
    Consulted,
    /// Their errors are reported alone.
    Unseen,
}

impl SupportPart {
    /// Whether they are fitted.
    pub fn is_fitted(self) -> bool {
        self == SupportPart::Fitted
    }

    /// Whether they choose ρ without being fitted.
    pub fn is_consulted(self) -> bool {
        self == SupportPart::Consulted
    }

    /// For notes, after the support.
    fn words(self) -> &'static str {
        match self {
            SupportPart::Fitted => "",
            SupportPart::Consulted => ", a support that was not fitted",
            SupportPart::Unseen => ", a support that was neither fitted nor chose rho",
        }
    }
}

/// The errors of the frequencies of several models under a support.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SupportFrequencies {
    /// The groups that are held, in words.
    pub support: String,
    /// What the first of its frequencies were for.
    pub part: SupportPart,
    /// The models.
    pub models: Vec<ModelFrequencies>,
}

/// The root mean squares of the errors `ω_i/ω̄_i − 1` of a model.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelFrequencies {
    /// The model.
    pub model: &'static str,
    /// Of as many first frequencies as were fitted.
    pub first: f64,
    /// Of as many after these, which no fit has seen.
    pub next: f64,
}

/// The errors of several models under loads made from the mesh that were neither fitted nor chose ρ.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HeldOut {
    /// The groups that are held, in words.
    pub support: String,
    /// What loads with this support were for.
    pub part: SupportPart,
    /// The number of loads.
    pub loads: usize,
    /// The models.
    pub models: Vec<ModelError>,
    /// The loads whose errors the fitted network has more than a tenth larger than the finite elements of the mesh.
    pub worse: Vec<WorseLoad>,
    /// Seconds of the same step of the finer body, if there is one.
    pub seconds_fine: Option<f64>,
}

/// The relative errors `‖u − ū‖/‖ū‖` under a load.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WorseLoad {
    /// The name of the load.
    pub load: String,
    /// Of the finite elements of the mesh.
    pub finite_elements: f64,
    /// Of the fitted network.
    pub fitted: f64,
}

/// The relative errors `‖u − ū‖/‖ū‖` of a model over some loads.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelError {
    /// The model.
    pub model: String,
    /// The median; `None` if the model is not stable.
    pub median: Option<f64>,
    /// The largest.
    pub worst: Option<f64>,
    /// The load that has it.
    pub worst_load: Option<String>,
    /// Seconds of a linear implicit step, which is one solution with a factor or levels that are there.
    pub seconds_per_step: Option<f64>,
}

/// A relative error under a load from which on a fit has not enough unknowns of the right kind.
const CAPACITY: f64 = 0.2;
/// The relative error `‖u_l − ū_l‖/‖ū_l‖` under a load, before and after a whole-object fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FittedLoad {
    /// The name of the load.
    pub name: String,
    /// The error at the start.
    pub before: f64,
    /// The error after the fit.
    pub after: f64,
}

impl WholeOutcome {
    pub(super) fn of(recipe: &WholeRecipe, wanted: &Wanted, found: &WholeFit) -> WholeOutcome {
        let errors = |targets: &[Target], [before, after]: &[Errors; 2]| {
            let name = targets.iter().map(|target| target.name.clone());
            let before = before.loads.iter().copied().chain(std::iter::repeat(f64::NAN));
            let after = after.loads.iter().copied().chain(std::iter::repeat(f64::NAN));
            name.zip(before.zip(after)).map(|(name, (before, after))| FittedLoad { name, before, after }).collect()
        };
        let chosen = found.curve.iter().find(|stage| Some(stage.regularization) == found.regularization);
        let excess = chosen.filter(|_| wanted.validation == Validation::Discrepancy).and_then(|stage| stage.validated);
        WholeOutcome {
            excess,
            loads: recipe.loads.words(),
            validated: recipe.validation.words(),
            regularization: found.regularization,
            fitted: errors(&wanted.trained, &found.trained),
            judged: errors(wanted.validation.loads(), &found.validated),
            frequencies: found.trained.clone().map(|errors| errors.frequencies),
            change: found.change,
            range: found.range,
            limited: found.limited,
            exceeds: found.exceeds,
            curve: found.curve.clone(),
            left_out: found.left_out.clone(),
            steps: found.steps,
            stands: found.stands,
            cancelled: found.cancelled,
            is_exact: matches!(recipe.start, Start::Exact(..)),
            is_measured: false,
            moduli: FoundModuli::default(),
            held_out: Vec::new(),
            masses: None,
        }
    }

    /// The moduli of the finite elements with whose energies those of the network are compared. Where those of the scene are a guess, they
    /// are multiplied by the least factor that was found.
    pub fn compared(&self, moduli: CellMap<Hooke>) -> CellMap<Hooke> {
        let found = self.moduli.all.iter().filter(|_| self.is_measured).map(|modulus| modulus.factor);
        let Some(factor) = found.reduce(f64::min) else { return moduli };
        moduli.map(|hooke| match hooke {
            Hooke::Isotropic(own) => Hooke::Isotropic(Moduli { lambda: factor * own.lambda, mu: factor * own.mu }),
            Hooke::Anisotropic(_) => hooke.clone(),
        })
    }

    /// The largest relative error after the fit under the loads that it has seen.
    fn largest_left(&self) -> f64 {
        let loads = self.fitted.iter().chain(&self.judged);
        loads.map(|load| load.after).filter(|error| error.is_finite()).fold(0.0, f64::max)
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let validated = match &self.validated[..] {
            [] => String::new(),
            loads => format!(", regularization rho chosen by {}", loads.join(", ")),
        };
        let done = match self.regularization {
            Some(rho) => {
                let (change, range) = (self.change, self.range);
                format!(
                    "rho {rho:.0e}, {} steps, constants changed by factors up to {change:.1}, range {range:.0}",
                    self.steps
                )
            }
            None if !self.stands => "the start is not stable under each of them, so its constants are unchanged".into(),
            None => {
                let tried = self.curve.len();
                format!(
                    "none of {tried} values of rho gave smaller errors than the start, in {} steps; its constants are unchanged",
                    self.steps
                )
            }
        };
        let largest = |errors: &[f64]| 100.0 * errors.iter().fold(0.0f64, |a, e| a.max(e.abs()));
        let [before, after] = [0, 1].map(|i| largest(&self.frequencies[i]));
        let done = match self.frequencies[0].len() {
            0 => done,
            count => format!("{done}, {count} frequencies off by up to {before:.1} -> {after:.1} %"),
        };
        let ended = match (self.cancelled, self.limited, self.excess) {
            (true, ..) => "; it was ended early".into(),
            _ if self.exceeds => "; the range is larger than the one that is allowed where rho is chosen".into(),
            (_, true, _) => "; a better rho exceeds the range that is allowed".into(),
            (.., Some(excess)) if excess > 1.0 => {
                format!("; no rho that was tried reaches the noise: residuals are {excess:.2} times as large")
            }
            _ => String::new(),
        };
        let percent = |error: Option<f64>| error.map_or("-".into(), |error| format!("{:.2}", 100.0 * error));
        let held_out = self.held_out.iter().map(|held_out| {
            let seen = held_out.part.words();
            let model =
                |model: &ModelError| format!("{} {} / {}", model.model, percent(model.median), percent(model.worst));
            let models: Vec<String> = held_out.models.iter().map(model).collect();
            let (loads, support) = (held_out.loads, &held_out.support);
            let worse = |load: &WorseLoad| {
                format!("{} {} / {}", load.load, percent(Some(load.finite_elements)), percent(Some(load.fitted)))
            };
            let worse: Vec<String> = held_out.worse.iter().map(worse).collect();
            let listed = if worse.is_empty() {
                String::new()
            } else {
                format!(
                    "; loads worse than finite elements by more than a tenth (finite elements / fitted): {}",
                    worse.join(", ")
                )
            };
            format!(
                "median and largest error in % of {loads} other loads, held at {support}{seen}: {}{listed}",
                models.join(", ")
            )
        });
        let fitted = format!(
            "fitted to {}, so that errors under them are not predictions{validated}: {done}{ended}",
            self.loads.join(", ")
        );
        let moduli = self.moduli.notes();
        let capacity = (self.largest_left() > CAPACITY && !self.is_exact).then(|| {
            format!(
                "errors of up to {:.0} % are left: springs with the rest lengths of the mesh cannot do better here; start = \"exact\" has \
                 the capacity",
                100.0 * self.largest_left()
            )
        });
        let masses = self.masses.iter().flat_map(FittedMasses::notes);
        std::iter::once(fitted).chain(moduli).chain(held_out).chain(masses).chain(capacity).collect()
    }
}

impl FittedMasses {
    fn notes(&self) -> Vec<String> {
        let (count, total, change) = (self.count, self.total, self.change);
        let second = format!(
            "mass and centre are those of the body, second moments up to {:.1} % off",
            100.0 * self.second_error
        );
        let first = format!(
            "masses fitted to the first {count} frequencies under each support, {total:.4e} kg in all, changed by factors up to \
             {change:.1}, rho {:.0e}: {second}",
            self.regularization
        );
        let support = |of: &SupportFrequencies| {
            let seen = of.part.words();
            let model = |m: &ModelFrequencies| format!("{} {:.2} / {:.2}", m.model, 100.0 * m.first, 100.0 * m.next);
            let models: Vec<String> = of.models.iter().map(model).collect();
            let (support, last) = (&of.support, 2 * count);
            format!(
                "frequencies 1 to {count} / {} to {last} off by (rms, %), held at {support}{seen}: {}",
                count + 1,
                models.join(", ")
            )
        };
        let matrix = format!(
            "mass matrix for programs that have one: {:.3} of the consistent one and {:.3} of lumped masses",
            1.0 - self.share,
            self.share
        );
        [first, matrix].into_iter().chain(self.supports.iter().map(support)).collect()
    }
}
