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
    /// Whether the noise chose ρ.
    pub is_by_noise: bool,
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
    /// The loads of the fit and of its validation whose displacements are those of finite elements with the moduli of the scene, where
    /// others are measured.
    pub guessed: Vec<String>,
    /// The loads of the scene without measured displacements, where moduli are found from measured ones.
    pub unmeasured: Vec<String>,
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
    pub(super) fn words(self) -> &'static str {
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
        let is_by_noise = wanted.validation == Validation::Discrepancy;
        let excess = chosen.filter(|_| is_by_noise).and_then(|stage| stage.validated);
        WholeOutcome {
            is_by_noise,
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
            guessed: Vec::new(),
            unmeasured: Vec::new(),
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
}
