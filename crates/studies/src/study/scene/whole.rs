//! The keys of a `[[fit]]` whose objective is "whole".

use super::entry::FitEntry;
use super::recipe::SampledRecipe;
use crate::error::{Error, Result};
use crate::fit::{Choices, Fit, Objective};
use crate::whole::{GaussNewton, Method, Residual, WholeSettings};

/// A whole-object fit before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeRecipe {
    pub start: Start,
    pub unknowns: Sharing,
    /// Loads of the scene that are fitted, and whether those made from the mesh are.
    pub loads: Named,
    pub validation: Judge,
    pub settings: WholeSettings,
    /// How many natural frequencies of the finite elements are fitted as well.
    pub frequencies: usize,
    /// Of the random loads.
    pub seed: u64,
}

/// The constants it starts from; none is below zero.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    Fit(Fit),
    /// Large deformation.
    Sampled(Box<SampledRecipe>),
    /// One constant for all springs of a kind.
    Equal,
}

/// What has a factor of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sharing {
    #[default]
    Spring,
    Group,
    Region,
    Element,
}

/// Loads of the scene, and perhaps a set that is made from the mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named {
    pub names: Vec<String>,
    pub made: bool,
}

/// What chooses the regularization.
#[derive(Debug, Clone, PartialEq)]
pub enum Judge {
    Loads(Named),
    LeaveOneOut,
    /// Nothing: the last regularization is taken.
    Given,
}

/// What stands for the loads that are made from the mesh.
const MADE: &str = "made";
const LEAVE_ONE_OUT: &str = "leave-one-out";
/// Names that no load of a scene may have.
pub const RESERVED: [&str; 2] = [MADE, LEAVE_ONE_OUT];
/// Pairs that L-BFGS remembers.
const MEMORY: usize = 10;
const SEED: u64 = 2010;

impl Start {
    /// The names in a fit's entry.
    ///
    /// # Errors
    /// It is neither a name nor a list of names, each once.
    pub(super) fn names(value: Option<&toml::Value>) -> Result<Vec<String>> {
        let Some(value) = value else { return Ok(vec!["offdiag".into()]) };
        let names: Option<Vec<String>> = match value {
            toml::Value::String(name) => Some(vec![name.clone()]),
            toml::Value::Array(list) => list.iter().map(|name| name.as_str().map(String::from)).collect(),
            _ => None,
        };
        let once = |names: &Vec<String>| !names.is_empty() && (1..names.len()).all(|i| !names[..i].contains(&names[i]));
        let wrong = || Error::at("start", "expected an objective or \"equal\", or a list of them, each once");
        names.filter(once).ok_or_else(wrong)
    }

    /// # Errors
    /// The name is no objective; `choices` are those of it.
    pub fn named(name: &str, choices: Choices) -> Result<Start> {
        if name == "equal" {
            let given = [
                ("weight", choices.weight.is_some()),
                ("higher", choices.higher.is_some()),
                ("balance", choices.balance.is_some()),
            ];
            return match given.iter().find(|(_, given)| *given) {
                Some((key, _)) => Err(Error::at(*key, "belongs to an objective, found with the start \"equal\"")),
                None => Ok(Start::Equal),
            };
        }
        let objective = Objective::named(name, choices).map_err(|e| match e.key() {
            Some("objective") => {
                let expected = format!("one of {}, sampled, equal", Objective::NAMES.join(", "));
                Error::expected("start", expected, format!("\"{name}\""))
            }
            _ => e,
        })?;
        Ok(Start::Fit(Fit { nonnegative: true, ..Fit::new(objective) }))
    }

    pub fn title(&self) -> String {
        match self {
            Start::Fit(fit) => fit.objective.title(),
            Start::Sampled(recipe) => format!("sampled{}", recipe.force.name()),
            Start::Equal => "equal".into(),
        }
    }
}

impl Sharing {
    pub const NAMES: [&'static str; 4] = ["spring", "group", "region", "element"];

    pub fn name(self) -> &'static str {
        Sharing::NAMES[self as usize]
    }
}

impl Default for WholeRecipe {
    fn default() -> WholeRecipe {
        let start = Start::named("offdiag", Choices::default()).expect("this is an objective");
        WholeRecipe::new(&FitEntry::default(), start).expect("all keys have defaults")
    }
}

impl WholeRecipe {
    /// What the entry says of a whole-object fit.
    ///
    /// # Errors
    /// A value is unknown or out of range, or a load is fitted and validates as well.
    pub fn new(entry: &FitEntry, start: Start) -> Result<WholeRecipe> {
        let loads = entry.loads.clone().unwrap_or_else(|| vec![MADE.into()]);
        if loads.is_empty() {
            return Err(Error::expected("loads", "names of loads of the scene to fit, or \"made\"", "none"));
        }
        for (key, names) in [("loads", Some(&loads)), ("validate", entry.validate.as_ref())] {
            let names = names.map_or(&[][..], |names| names);
            if let Some(i) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
                return Err(Error::expected(key, "each load once", format!("\"{}\" again", names[i])));
            }
        }
        let settings = WholeSettings::default();
        let mut settings = WholeSettings {
            iterations: entry.iterations.map_or(settings.iterations, |i| usize::try_from(i).unwrap_or(usize::MAX)),
            method: match entry.solver.as_deref().unwrap_or("gauss-newton") {
                "gauss-newton" => Method::GaussNewton(GaussNewton::default()),
                "l-bfgs" => Method::Lbfgs { memory: MEMORY },
                other => {
                    let expected = "\"gauss-newton\" or \"l-bfgs\" with the objective \"whole\"";
                    return Err(Error::expected("solver", expected, format!("\"{other}\"")));
                }
            },
            residual: match entry.residual.as_deref().unwrap_or("displacements") {
                "displacements" => Residual::Displacements,
                "forces" => Residual::Forces,
                "forces-first" => Residual::ForcesFirst,
                other => {
                    let expected = "\"displacements\", \"forces\" or \"forces-first\"";
                    return Err(Error::expected("residual", expected, format!("\"{other}\"")));
                }
            },
            ..settings
        };
        settings.range = entry.range.unwrap_or(settings.range);
        if !(settings.range >= 1.0) {
            return Err(Error::expected("range", "a factor of at least 1 between constants", settings.range));
        }
        if settings.iterations == 0 {
            return Err(Error::expected("iterations", "a number above 0", 0));
        }
        if settings.residual == Residual::Forces && entry.frequencies.is_some() {
            return Err(Error::at("frequencies", "does not go with residual = \"forces\", which has no displacements"));
        }
        if entry.range.is_some() && entry.regularization.is_some() {
            return Err(Error::at(
                "range",
                "limits what \"validate\" may choose, found with a regularization that is given",
            ));
        }
        let validation = match (entry.validate.clone(), entry.regularization) {
            (Some(_), Some(_)) => {
                return Err(Error::at("regularization", "is chosen by \"validate\" or given, found both"));
            }
            (None, Some(rho)) if !(rho >= 0.0 && rho.is_finite()) => {
                return Err(Error::expected("regularization", "a number of at least 0", rho));
            }
            (None, Some(rho)) => {
                settings.regularizations.retain(|larger| *larger > rho);
                settings.regularizations.push(rho);
                Judge::Given
            }
            (None, None) => Judge::Loads(Named::new(vec![MADE.into()])),
            (Some(names), None) if names == [LEAVE_ONE_OUT] => Judge::LeaveOneOut,
            (Some(names), None) => {
                if names.is_empty() {
                    let expected = "names of loads of the scene, \"made\", or \"leave-one-out\" alone";
                    return Err(Error::expected("validate", expected, "none"));
                }
                if let Some(name) = names.iter().find(|name| *name != MADE && loads.contains(name)) {
                    return Err(Error::expected("validate", "loads that are not fitted", format!("\"{name}\"")));
                }
                Judge::Loads(Named::new(names))
            }
        };
        let unknowns = match entry.unknowns.as_deref().unwrap_or("spring") {
            "spring" => Sharing::Spring,
            "group" => Sharing::Group,
            "region" => Sharing::Region,
            "element" => Sharing::Element,
            other => {
                let expected = format!("one of {}", Sharing::NAMES.join(", "));
                return Err(Error::expected("unknowns", expected, format!("\"{other}\"")));
            }
        };
        Ok(WholeRecipe {
            start,
            unknowns,
            loads: Named::new(loads),
            validation,
            settings,
            frequencies: entry.frequencies.unwrap_or(0),
            seed: entry.seed.unwrap_or(SEED),
        })
    }

    /// What of it goes with the material.
    ///
    /// # Errors
    /// Loads are made where displacements are large, or frequencies wanted without a density.
    pub fn check(&self, law: bool, density: bool) -> Result<()> {
        let judged = matches!(&self.validation, Judge::Loads(named) if named.made);
        for (key, made) in [("loads", self.loads.made), ("validate", judged)] {
            if law && made {
                let expected = "loads of the scene, where the material has a law";
                return Err(Error::expected(key, expected, "\"made\""));
            }
        }
        if self.frequencies > 0 && !density {
            return Err(Error::expected("frequencies", "a density in [material]", "none"));
        }
        Ok(())
    }
}

impl Named {
    fn new(names: Vec<String>) -> Named {
        let made = names.iter().any(|name| name == MADE);
        Named { names: names.into_iter().filter(|name| name != MADE).collect(), made }
    }

    /// In the words of the scene.
    pub fn words(&self) -> Vec<String> {
        let made = self.made.then(|| "loads made from the mesh".to_string());
        self.names.iter().cloned().chain(made).collect()
    }
}

impl Judge {
    /// In the words of the scene.
    pub fn words(&self) -> Vec<String> {
        match self {
            Judge::Loads(named) if named.made && named.names.is_empty() => {
                vec!["random loads made from the mesh".into()]
            }
            Judge::Loads(named) => named.words(),
            Judge::LeaveOneOut => vec!["each of them left out in turn".into()],
            Judge::Given => Vec::new(),
        }
    }
}
