//! The loads of a whole-object fit, and its result.

use super::made_loads::MadeLoads;
use super::moduli::FoundModuli;
use super::recipe::{Start, WholeRecipe};
use crate::material::{CellMap, Hooke, Moduli};
use crate::number::{each_or_nan, finite, or_nan};
use crate::whole::{Errors, MassStage, Stage, Target, Validation, Wanted, WholeFit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The loads of a whole-object fit, and its result.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct WholeOutcome {
    /// These loads were fitted.
    pub loads: Vec<String>,
    /// These loads chose the regularization.
    pub validated: Vec<String>,
    /// The regularization ρ was chosen; it is null if the start was best.
    pub regularization: Option<f64>,
    /// A constant changed by at most this factor.
    #[serde(rename = "largest_change", deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub change: f64,
    /// The largest constant of the length springs is this many times the least.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub range: f64,
    /// A better ρ was left out because the range would have been too large.
    #[serde(rename = "limited_by_range")]
    pub limited: bool,
    /// Each entry is a stage of the path: the curve of errors against ρ.
    pub curve: Vec<Stage>,
    /// This number of steps was made.
    pub steps: usize,
    /// The fit was ended early.
    pub cancelled: bool,
    /// The starting network is stable under every load; otherwise it is returned unchanged.
    pub stands: bool,
    /// Each entry has the relative errors on a load of the fit.
    #[serde(rename = "relative_errors_fitted")]
    pub fitted: Vec<FittedLoad>,
    /// Each entry has the relative errors on a load that chose the regularization.
    #[serde(rename = "relative_errors_validated")]
    pub judged: Vec<FittedLoad>,
    /// The moduli of the body or of its regions are here, if these are the unknowns.
    #[serde(flatten)]
    pub moduli: FoundModuli,
    /// Each entry has the errors of a support under loads that were neither fitted nor chose ρ. The list is empty without `[reference]` and
    /// `supports`, unless made loads are fitted at large deformation, and with measured displacements.
    pub held_out: Vec<HeldOut>,
    /// `stretched` says how far made loads stretch the body at large deformation; it is null at small deformation and without such loads.
    #[serde(default)]
    pub stretched: Option<MadeLoads>,
    /// `relative_errors_of_frequencies` has the relative errors of the frequencies before and after.
    #[serde(rename = "relative_errors_of_frequencies")]
    pub frequencies: FrequencyErrors,
    /// `masses` has the fit of the masses; it is null unless the scene asks for `masses`.
    pub masses: Option<FittedMasses>,
    /// Whether the ratio is larger than the one that is allowed where ρ is chosen.
    #[serde(skip)]
    pub exceeds: bool,
    /// Whether the noise chose ρ.
    #[serde(skip)]
    pub is_by_noise: bool,
    /// How many times as large as the noise the residuals are, if the noise chose ρ.
    #[serde(skip)]
    pub excess: Option<f64>,
    /// Whether the fit started from the exact network.
    #[serde(skip)]
    pub is_exact: bool,
    /// Whether the constants are for an engine.
    #[serde(skip)]
    pub is_for_engine: bool,
    /// Whether the displacements were measured, so that the moduli of the scene are a guess.
    #[serde(skip)]
    pub is_measured: bool,
    /// The loads of the fit and of its validation whose displacements are those of finite elements with the moduli of the scene, where
    /// others are measured.
    #[serde(skip)]
    pub guessed: Vec<String>,
    /// The loads of the scene without measured displacements, where moduli are found from measured ones.
    #[serde(skip)]
    pub unmeasured: Vec<String>,
}

/// The relative errors `ω_i/ω̄_i − 1` of the frequencies.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct FrequencyErrors {
    /// The frequencies have the relative errors `ω_i/ω̄_i − 1` before the fit.
    #[serde(deserialize_with = "each_or_nan")]
    #[schemars(with = "Vec<Option<f64>>")]
    pub before: Vec<f64>,
    /// The frequencies have the relative errors `ω_i/ω̄_i − 1` after the fit.
    #[serde(deserialize_with = "each_or_nan")]
    #[schemars(with = "Vec<Option<f64>>")]
    pub after: Vec<f64>,
}

/// Masses that were fitted to the frequencies of the body, with its mass, centre and second moments. The masses themselves are in the file of
/// the network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FittedMasses {
    /// This number of frequencies was fitted under each support.
    #[serde(rename = "frequencies")]
    pub count: usize,
    /// The regularization ρ was chosen.
    pub regularization: f64,
    /// The second moments `Σ m x_k²` about the centre have at most this error, relative to those of the body. The error is zero, or as large as that
    /// of lumped masses.
    #[serde(rename = "second_moment_error")]
    pub second_error: f64,
    /// A mass changed by at most this factor.
    #[serde(rename = "largest_change")]
    pub change: f64,
    /// The sum of the masses is in kg.
    pub total: f64,
    /// Lumped masses have this share s in the mass matrix `(1 − s) M_c + s diag(m)`; M_c is the consistent one.
    #[serde(rename = "lumped_share", default)]
    pub share: f64,
    /// Each entry has the errors of the frequencies with one ρ.
    pub curve: Vec<MassStage>,
    /// Each entry has the errors of the frequencies under a support.
    pub supports: Vec<SupportFrequencies>,
    /// The masses, `[points]`, kg.
    #[serde(skip)]
    pub masses: Vec<f64>,
}

/// What loads and frequencies under a support are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "PartFlags", into = "PartFlags")]
pub enum SupportPart {
    /// They are fitted; others may choose ρ.
    Fitted,
    /// They choose ρ.
    Consulted,
    /// Their errors are reported alone.
    Unseen,
}

/// A [`SupportPart`] in a report.
#[derive(Serialize, Deserialize, JsonSchema)]
struct PartFlags {
    /// What is under this support was fitted.
    trained: bool,
    /// What is under this support chose the regularization without being fitted.
    #[serde(default)]
    chooses: bool,
}

impl From<SupportPart> for PartFlags {
    fn from(part: SupportPart) -> PartFlags {
        PartFlags { trained: part == SupportPart::Fitted, chooses: part == SupportPart::Consulted }
    }
}

impl From<PartFlags> for SupportPart {
    fn from(flags: PartFlags) -> SupportPart {
        match (flags.trained, flags.chooses) {
            (true, _) => SupportPart::Fitted,
            (false, true) => SupportPart::Consulted,
            (false, false) => SupportPart::Unseen,
        }
    }
}

impl SupportPart {
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SupportFrequencies {
    /// These groups are held, in words.
    pub support: String,
    /// The first of the frequencies are for this.
    #[serde(flatten)]
    #[schemars(with = "PartFlags")]
    pub part: SupportPart,
    /// The entries are the finite elements of the mesh and the fitted network with lumped masses, and the fitted network with fitted masses
    /// and with the mass matrix.
    pub models: Vec<ModelFrequencies>,
}

/// The root mean squares of the relative errors `ω_i/ω̄_i − 1` of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ModelFrequencies {
    /// The model is `finite elements`, `fitted`, `fitted masses` or `mass matrix`.
    pub model: String,
    /// This is the root mean square of `ω_i/ω̄_i − 1` over as many first frequencies as were fitted.
    pub first: f64,
    /// This is the root mean square of `ω_i/ω̄_i − 1` over as many frequencies after the first, which no fit has seen.
    pub next: f64,
}

/// The errors of several models under loads made from the mesh that were neither fitted nor chose ρ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct HeldOut {
    /// These groups are held, in words.
    pub support: String,
    /// Loads with this support were for this.
    #[serde(flatten)]
    #[schemars(with = "PartFlags")]
    pub part: SupportPart,
    /// The support has this number of loads, none of which was fitted or chose ρ.
    pub loads: usize,
    /// The entries are the finite elements of the mesh, its exact networks, the network at the start, and the fitted one.
    pub models: Vec<ModelError>,
    /// Each entry is a load whose error is more than a tenth larger with the fitted network than with the finite elements of the mesh.
    #[serde(rename = "worse_than_finite_elements", default)]
    pub worse: Vec<WorseLoad>,
    /// A linear implicit step of the finer body takes this time in s; it is null without one.
    #[serde(rename = "seconds_per_step_fine")]
    pub seconds_fine: Option<f64>,
}

impl HeldOut {
    /// The support and what its loads were for, as a table has them.
    pub fn column(&self) -> String {
        match self.part {
            SupportPart::Fitted => self.support.clone(),
            SupportPart::Consulted => format!("{}, not fitted", self.support),
            SupportPart::Unseen => format!("{}, unseen", self.support),
        }
    }

    /// What is held, in words, and what loads with this support were for.
    pub fn place(&self) -> String {
        format!("{}{}", self.support, self.part.words())
    }
}

/// The relative errors `‖u − ū‖/‖ū‖` under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct WorseLoad {
    /// The load has this name.
    pub load: String,
    /// The finite elements of the mesh have this relative error `‖u − ū‖/‖ū‖`.
    pub finite_elements: f64,
    /// The fitted network has this relative error `‖u − ū‖/‖ū‖`.
    pub fitted: f64,
}

/// The relative errors `‖u − ū‖/‖ū‖` of a model over some loads; null if it is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ModelError {
    /// The model is `finite elements`; `exact`, `exact patches` and `exact edges patches` where the mesh has them; `start`, where the
    /// moduli of the body are fitted already; or `fitted`.
    pub model: String,
    /// The relative errors `‖u − ū‖/‖ū‖` have this median; it is null if the model is not stable.
    pub median: Option<f64>,
    /// The largest relative error `‖u − ū‖/‖ū‖` is this; it is null if the model is not stable.
    pub worst: Option<f64>,
    /// The largest error is under this load.
    pub worst_load: Option<String>,
    /// A linear implicit step takes this time in s: one solution with a factor or levels that are there. It is null at large deformation.
    pub seconds_per_step: Option<f64>,
    /// The model has no equilibrium under this number of the loads. They count as those with the largest errors, which are then null.
    #[serde(default)]
    pub lost: usize,
}

/// The relative error `‖u − ū‖/‖ū‖` under a load, before and after a whole-object fit; null if the network is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FittedLoad {
    /// The load has this name.
    pub load: String,
    /// The displacements have this relative error before the fit.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub before: f64,
    /// The displacements have this relative error after the fit.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub after: f64,
}

impl WholeOutcome {
    pub(super) fn of(recipe: &WholeRecipe, wanted: &Wanted, found: &WholeFit) -> WholeOutcome {
        let errors = |targets: &[Target], [before, after]: &[Errors; 2]| {
            let name = targets.iter().map(|target| target.name.clone());
            let before = before.loads.iter().copied().chain(std::iter::repeat(f64::NAN));
            let after = after.loads.iter().copied().chain(std::iter::repeat(f64::NAN));
            name.zip(before.zip(after)).map(|(load, (before, after))| FittedLoad { load, before, after }).collect()
        };
        let chosen = found.curve.iter().find(|stage| Some(stage.regularization) == found.regularization);
        let is_by_noise = wanted.validation == Validation::Discrepancy;
        let excess = chosen.filter(|_| is_by_noise).and_then(|stage| stage.validated);
        let [before, after] = found.trained.clone().map(|errors| errors.frequencies);
        let mut curve = found.curve.clone();
        // With leave-one-out validation each load has judged the fit of the others.
        curve.iter_mut().zip(&found.left_out).for_each(|(stage, mean)| stage.validated = finite(*mean));
        WholeOutcome {
            is_by_noise,
            excess,
            loads: recipe.loads.words(),
            validated: recipe.validation.words(),
            regularization: found.regularization,
            fitted: errors(&wanted.trained, &found.trained),
            judged: errors(wanted.validation.loads(), &found.validated),
            frequencies: FrequencyErrors { before, after },
            change: found.change,
            range: found.range,
            limited: found.limited,
            exceeds: found.exceeds,
            curve,
            steps: found.steps,
            stands: found.stands,
            cancelled: found.cancelled,
            is_exact: matches!(recipe.start, Start::Exact(..)),
            is_for_engine: recipe.engine.is_some(),
            ..WholeOutcome::default()
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
