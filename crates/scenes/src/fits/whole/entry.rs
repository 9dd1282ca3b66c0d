//! The keys of a `[[fit]]` with the objective "whole".

use super::recipe::{DISCREPANCY, LEAVE_ONE_OUT, LoadSelection, MADE, Sharing, Start, ValidationRecipe, WholeRecipe};
use crate::bound::{self, check_count};
use crate::choice::choice;
use crate::error::{Error, Result, expect_none};
use crate::file::Forms;
use crate::fit::{Choices, Fit, Objective, ShearSprings, VolumeSprings};
use crate::fits::sampled::SampledRecipe;
use crate::named::unknown;
use crate::whole::{DescentMethod, GaussNewton, ModuliSharing, WholeSettings};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny};

/// The default seed of the random loads. Any number would do; it is the year of the paper.
const SEED: u64 = 2010;
/// ρ where few unknowns are found from measured displacements: too small to move what they see, large enough to hold what they do not.
pub(super) const FEW: f64 = 1e-9;

/// The keys. Those of sampled fits are allowed as well if the fit starts from one.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WholeEntry {
    /// The fit starts from the constants of this objective, or of `sampled`, `equal` or `exact`; a list gives one fit from each. With
    /// `sampled`, the keys of sampled fits are allowed too.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "text, or list of texts", "default" = "offdiag"))]
    pub start: Option<toml::Value>,
    /// The objective of the start has this weight.
    #[schemars(extend("x-default" = "that of the objective"))]
    pub weight: Option<String>,
    /// Motions beyond constant strain have this scale in the objective of the start, above 0 and at most 1.
    #[schemars(extend("x-default" = "that of the objective"))]
    pub higher: Option<f64>,
    /// The divergence of the start is balanced between too soft, 0, and too stiff, 1.
    #[schemars(extend("x-default" = "that of the objective"))]
    pub balance: Option<f64>,
    /// These loads are fitted: names of loads of the scene, or `made` for loads that are made for the fit.
    #[schemars(extend("default" = [MADE]))]
    pub loads: Option<Vec<String>>,
    /// These loads choose ρ: names of loads of the scene, or `made`. `leave-one-out` leaves out one load after the other. `discrepancy`
    /// takes the largest ρ whose residuals are no larger than the `sigma` of the measured displacements.
    #[serde(deserialize_with = "one_or_more")]
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "text, or list of texts", "default" = [MADE]))]
    pub validate: Option<Vec<String>>,
    /// Each spring, group, region or element has a factor of its own. With the start `exact` the moduli of each cell (`moduli`), of each
    /// region (`region-moduli`, or `region-young` with Poisson's ratio of the material) or of the body (`body-moduli`) have one. Moduli are
    /// found from measured loads alone, or from none.
    #[schemars(extend("enum" = Sharing::NAMES, "x-default" = "`\"spring\"`; `\"moduli\"` with the start `exact`"))]
    pub unknowns: Option<String>,
    /// The regularization ρ is given, 0 or more, instead of chosen by `validate`.
    #[schemars(extend("x-default" = "chosen by `validate`"))]
    pub regularization: Option<f64>,
    /// The largest constant of the length springs is at most this many times the least where ρ is chosen, 1 or more. A given ρ is used
    /// whatever the range is.
    #[schemars(extend("default" = WholeSettings::default().range))]
    pub range: Option<f64>,
    /// This number of natural frequencies is fitted as well. They need a density, and no measured displacements.
    #[schemars(extend("default" = 0))]
    pub frequencies: Option<usize>,
    /// The masses of the points are fitted to this number of natural frequencies under each support, after the springs. They need a
    /// density, and no measured displacements.
    #[schemars(extend("default" = 0))]
    pub masses: Option<usize>,
    /// Another seed gives other random loads.
    #[schemars(extend("default" = SEED))]
    pub seed: Option<u64>,
    /// Made loads are as large as it takes for a tenth of the body to become longer or shorter by this share, above 0 and at most 1. The key
    /// belongs to made loads and a material with a law.
    #[schemars(extend("x-default" = "0.3, with a law"))]
    pub stretch: Option<f64>,
    /// Made loads are fitted under these supports, each a list of groups that are held, or of conditions on x, y and z in m, such as
    /// `[["left"], ["x < 0.01", "right"]]`.
    #[schemars(extend("x-default" = "that of `[[fix]]`"))]
    pub supports: Option<Vec<Vec<String>>>,
    /// Made loads that choose ρ have these supports, each a list of groups that are held, or of conditions; the key belongs to
    /// `validate = "made"`.
    #[schemars(extend("x-default" = "`supports`"))]
    pub validate_supports: Option<Vec<Vec<String>>>,
    /// Made loads with these supports, each a list of groups that are held, or of conditions, neither are fitted nor choose ρ; their errors are
    /// reported.
    pub other_supports: Option<Vec<Vec<String>>>,
    /// Springs for the shear modulus of the start `exact` measure the deformation in each cell, or on the domain of each edge. With `edges`
    /// the unknowns of `moduli` are those of the domain of each edge.
    #[schemars(extend("enum" = ShearSprings::NAMES, "default" = ShearSprings::default().name()))]
    pub shear: Option<String>,
    /// The start `exact` has these volume springs. With `patches` the cells and the patches have half of λ each, and with `shear = "edges"`
    /// the patches have all of it.
    #[schemars(extend("enum" = VolumeSprings::NAMES, "default" = VolumeSprings::default().name()))]
    pub volume: Option<String>,
    /// The search steps by this method.
    #[schemars(extend("enum" = DescentMethod::NAMES, "default" = WholeSettings::default().method.name()))]
    pub solver: Option<String>,
    /// The search takes at most this number of iterations with each ρ, 1 or more.
    #[schemars(extend("default" = WholeSettings::default().iterations))]
    pub iterations: Option<u64>,
}

impl WholeEntry {
    /// The recipes, one for each start, with the name of the start; `sampled` makes the recipe of a sampled fit.
    ///
    /// # Errors
    /// A value is unknown or out of range, or a load is both fitted and used for validation.
    pub fn recipes(&self, sampled: impl Fn() -> Result<SampledRecipe>) -> Result<Vec<(String, WholeRecipe)>> {
        let recipe = |name: String| {
            let start = match name.as_str() {
                "sampled" => Start::Sampled(Box::new(sampled()?)),
                "equal" => self.without_objective("equal", Start::Equal)?,
                "exact" => self.exact()?,
                objective => self.objective(objective)?,
            };
            Ok((name, self.recipe(start)?))
        };
        starts(self.start.as_ref())?.into_iter().map(recipe).collect()
    }

    fn exact(&self) -> Result<Start> {
        let shear = choice("shear", self.shear.as_deref(), ShearSprings::default(), ShearSprings::named)?;
        let volume = choice("volume", self.volume.as_deref(), VolumeSprings::default(), VolumeSprings::named)?;
        shear.check(volume)?;
        self.without_objective("exact", Start::Exact(shear, volume))
    }

    fn without_objective(&self, name: &str, start: Start) -> Result<Start> {
        let choices =
            [("weight", self.weight.is_some()), ("higher", self.higher.is_some()), ("balance", self.balance.is_some())];
        expect_none(choices, format!("belongs to an objective, found with the start \"{name}\""))?;
        Ok(start)
    }

    fn objective(&self, name: &str) -> Result<Start> {
        if !Objective::NAMES.contains(&name) {
            let expected = format!("one of {}, sampled, equal, exact", Objective::NAMES.join(", "));
            let names = Objective::NAMES.iter().copied().chain(["sampled", "equal", "exact"]);
            return Err(unknown(expected, names, name).at_key("start"));
        }
        let choices = Choices { weight: self.weight.as_deref(), higher: self.higher, balance: self.balance };
        Ok(Start::Fit(Fit { nonnegative: true, ..Fit::new(Objective::named(name, choices)?) }))
    }

    /// The recipe with this start.
    ///
    /// # Errors
    /// A value is unknown or out of range, or a load is both fitted and used for validation.
    fn recipe(&self, start: Start) -> Result<WholeRecipe> {
        let loads = self.fitted_loads()?;
        let is_made = loads.iter().any(|name| name == MADE);
        let unknowns = self.sharing(&start)?;
        let few = unknowns.moduli().is_some_and(|sharing| sharing != ModuliSharing::Element);
        let mut settings = self.settings(few)?;
        let validation = match self.regularization {
            Some(rho) => {
                self.check_given(rho)?;
                settings.regularizations.retain(|larger| *larger > rho);
                settings.regularizations.push(rho);
                ValidationRecipe::None
            }
            None if self.validate.is_none() && few && !is_made => {
                settings.regularizations = vec![FEW];
                ValidationRecipe::None
            }
            None => self.validation(&loads)?,
        };
        let supports = checked_supports("supports", self.supports.as_deref())?;
        let validation_supports = checked_supports("validate_supports", self.validate_supports.as_deref())?;
        let is_validated = matches!(&validation, ValidationRecipe::Loads(loads) if loads.made);
        if !validation_supports.is_empty() && !is_validated {
            return Err(Error::at("validate_supports", "belongs to validate = \"made\""));
        }
        let other_supports = checked_supports("other_supports", self.other_supports.as_deref())?;
        for (key, given) in [("supports", &supports), ("other_supports", &other_supports)] {
            if !given.is_empty() && !is_made {
                return Err(Error::at(key, "belongs to loads = [\"made\"]"));
            }
        }
        let is_stretched = is_made || is_validated;
        if let Some(stretch) = self.stretch {
            if !is_stretched {
                return Err(Error::at("stretch", "belongs to loads = [\"made\"] or validate = \"made\""));
            }
            if !(stretch > 0.0 && stretch <= 1.0) {
                return Err(Error::expected("stretch", "a number above 0 and at most 1", stretch));
            }
        }
        Ok(WholeRecipe {
            start,
            engine: None,
            unknowns,
            loads: LoadSelection::new(loads),
            validation,
            settings,
            frequencies: self.frequencies.unwrap_or(0),
            masses: self.masses.unwrap_or(0),
            seed: self.seed.unwrap_or(SEED),
            stretch: self.stretch,
            supports,
            validation_supports,
            other_supports,
        })
    }

    /// The names of the loads that are fitted.
    fn fitted_loads(&self) -> Result<Vec<String>> {
        let loads = self.loads.clone().unwrap_or_else(|| vec![MADE.into()]);
        if loads.is_empty() {
            return Err(Error::expected("loads", "names of loads of the scene to fit, or \"made\"", "none"));
        }
        for (key, names) in [("loads", Some(&loads)), ("validate", self.validate.as_ref())] {
            let names = names.map_or(&[][..], |names| names);
            if let Some(i) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
                return Err(Error::expected(key, "each load once", format!("\"{}\" again", names[i])));
            }
        }
        Ok(loads)
    }

    /// Which constants have an unknown of their own: moduli with the start `exact`, and factors on springs with others.
    fn sharing(&self, start: &Start) -> Result<Sharing> {
        let is_exact = matches!(start, Start::Exact(..));
        let default = if is_exact { Sharing::Moduli } else { Sharing::default() };
        let unknowns = choice("unknowns", self.unknowns.as_deref(), default, Sharing::named)?;
        if unknowns == Sharing::RegionYoung && matches!(start, Start::Exact(_, VolumeSprings::Patches)) {
            let expected = "\"points\" or \"cells\" with unknowns = \"region-young\": patches at a boundary of regions belong to both";
            return Err(Error::expected("volume", expected, "\"patches\""));
        }
        if unknowns.moduli().is_some() != is_exact {
            let found = format!("\"{}\" with the start \"{}\"", unknowns.name(), start.title());
            let expected = "\"moduli\", \"region-moduli\", \"region-young\" or \"body-moduli\" with the start \"exact\", and no others";
            return Err(Error::expected("unknowns", expected, found));
        }
        let of_exact = [("shear", self.shear.is_some()), ("volume", self.volume.is_some())];
        match of_exact.iter().find(|(_, given)| *given && !is_exact) {
            Some((key, _)) => Err(Error::at(*key, "belongs to the start \"exact\"")),
            None => Ok(unknowns),
        }
    }

    /// How the search goes; `few` unknowns are found more precisely.
    fn settings(&self, few: bool) -> Result<WholeSettings> {
        let settings = WholeSettings::default();
        let method = DescentMethod::GaussNewton(if few { GaussNewton::PRECISE } else { GaussNewton::default() });
        let settings = WholeSettings {
            iterations: self.iterations.map_or(settings.iterations, |i| usize::try_from(i).unwrap_or(usize::MAX)),
            method: choice("solver", self.solver.as_deref(), method, DescentMethod::named)?,
            range: self.range.unwrap_or(settings.range),
            ..settings
        };
        if !(settings.range >= 1.0) {
            return Err(Error::expected("range", "a factor of at least 1 between constants", settings.range));
        }
        check_count("iterations", settings.iterations as u64, 1, bound::ITERATIONS)?;
        check_count("frequencies", self.frequencies.unwrap_or(0) as u64, 0, bound::MODES)?;
        check_count("masses", self.masses.unwrap_or(0) as u64, 0, bound::MODES / 2)?;
        Ok(settings)
    }

    /// A regularization that is given is a number, and nothing else chooses it.
    fn check_given(&self, rho: f64) -> Result<()> {
        if self.range.is_some() {
            let problem = "limits what \"validate\" may choose, found with a regularization that is given";
            return Err(Error::at("range", problem));
        }
        if self.validate.is_some() {
            return Err(Error::at("regularization", "is chosen by \"validate\" or given, found both"));
        }
        if !(rho >= 0.0 && rho.is_finite()) {
            return Err(Error::expected("regularization", "a number of at least 0", rho));
        }
        Ok(())
    }

    /// What chooses the regularization, beside the `loads` that are fitted.
    fn validation(&self, loads: &[String]) -> Result<ValidationRecipe> {
        let names = self.validate.clone().unwrap_or_else(|| vec![MADE.into()]);
        if names == [LEAVE_ONE_OUT] {
            return Ok(ValidationRecipe::LeaveOneOut);
        }
        if names == [DISCREPANCY] {
            return Ok(ValidationRecipe::Discrepancy);
        }
        if names.is_empty() {
            let expected = "names of loads of the scene, \"made\", or \"leave-one-out\" or \"discrepancy\" alone";
            return Err(Error::expected("validate", expected, "none"));
        }
        match names.iter().find(|name| *name != MADE && loads.contains(name)) {
            Some(name) => Err(Error::expected("validate", "loads that are not fitted", format!("\"{name}\""))),
            None => Ok(ValidationRecipe::Loads(LoadSelection::new(names))),
        }
    }
}

/// The given lists of groups or conditions.
///
/// # Errors
/// There is no list, a list has no group or one twice, or two lists have the same groups.
fn checked_supports(key: &str, supports: Option<&[Vec<String>]>) -> Result<Vec<Vec<String>>> {
    match supports {
        Some([]) => Err(Error::expected(key, "lists of groups that are held, or of conditions", "none")),
        Some(supports) => {
            for (i, groups) in supports.iter().enumerate() {
                let wrong = |found: String| {
                    Err(Error::expected(format!("{key}[{i}]"), "groups that are held or conditions, each once", found))
                };
                if groups.is_empty() {
                    return wrong("none".into());
                }
                if let Some(again) = (1..groups.len()).find(|&k| groups[..k].contains(&groups[k])) {
                    return wrong(format!("\"{}\" again", groups[again]));
                }
                let alike =
                    |other: &Vec<String>| other.len() == groups.len() && other.iter().all(|name| groups.contains(name));
                if let Some(first) = supports[..i].iter().position(alike) {
                    return Err(Error::expected(
                        format!("{key}[{i}]"),
                        "a support of its own",
                        format!("{key}[{first}] again"),
                    ));
                }
            }
            Ok(supports.to_vec())
        }
        None => Ok(Vec::new()),
    }
}

/// A text, or a list of texts.
fn one_or_more<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Option<Vec<String>>, D::Error> {
    deserializer.deserialize_any(Forms::<_, _, IgnoredAny> {
        text: Some(&|one| Ok(Some(vec![one.into()]))),
        list: Some(|all| Ok(Some(all))),
        ..Forms::expecting("a text or a list of texts")
    })
}

/// The names of the starts: a name, or a list of different names.
///
/// # Errors
/// The value is neither.
pub fn starts(value: Option<&toml::Value>) -> Result<Vec<String>> {
    let Some(value) = value else { return Ok(vec!["offdiag".into()]) };
    let names: Option<Vec<String>> = match value.as_array() {
        None => value.as_str().map(|name| vec![name.into()]),
        Some(list) => list.iter().map(|name| name.as_str().map(String::from)).collect(),
    };
    let once = |names: &Vec<String>| !names.is_empty() && (1..names.len()).all(|i| !names[..i].contains(&names[i]));
    let wrong = || Error::at("start", "expected an objective or \"equal\", or a list of them, each once");
    names.filter(once).ok_or_else(wrong)
}

impl Default for WholeRecipe {
    fn default() -> WholeRecipe {
        let entry = WholeEntry::default();
        let start = entry.objective("offdiag").expect("this is an objective");
        entry.recipe(start).expect("all keys have defaults")
    }
}
