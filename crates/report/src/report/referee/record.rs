//! What a referee of simulators has found.

use serde::Serialize;

/// The bodies that simulators brought to rest, beside finite elements.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RefereeRecord {
    /// Young's modulus of the bodies, Pa.
    pub young: f64,
    /// The engines that ran.
    pub engines: Vec<EngineRecord>,
    /// Engines that are not there, and why.
    pub not_run: Vec<String>,
    /// Bodies at which a program ended early, and its words.
    pub failed: Vec<String>,
    /// What to tell an engine so that it has the modulus.
    pub repairs: Vec<RepairRecord>,
    /// A row for each body and load.
    pub rows: Vec<RefereeRow>,
}

/// A simulator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EngineRecord {
    /// The option `--engine` calls the engine by this name.
    pub name: String,
    /// The version that ran.
    pub version: String,
}

/// How E, or the constants of springs, have to be changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepairRecord {
    /// The engine.
    pub engine: String,
    /// The solver in it.
    pub solver: String,
    /// Own elements, or the springs of a fit.
    pub model: String,
    /// Poisson's ratio of the body.
    pub poisson: f64,
    /// What E or all constants are multiplied by so that tension is right.
    pub factor: Factor,
    /// The factor of E and the Poisson's ratio that follow from the engine's law, where it is known to be another.
    pub derived: Option<[f64; 2]>,
}

/// What E or all constants are multiplied by so that tension is right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Factor {
    /// None is large enough: with any factor the engine is too soft.
    TooSoft,
    /// It is not known, because the body with the changed modulus, by which it is found, was not at rest.
    NotAtRest,
    /// This number.
    #[serde(untagged)]
    Number(f64),
}

/// A body under a load, at rest in an engine.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RefereeRow {
    /// The engine.
    pub engine: String,
    /// The solver in it.
    pub solver: String,
    /// Own elements, or the springs of a fit.
    pub model: String,
    /// What the engine was told.
    pub telling: Telling,
    /// The load.
    pub load: String,
    /// Poisson's ratio of the body.
    pub poisson: f64,
    /// E in Pa and ν that were told; null of springs.
    pub told: Option<[f64; 2]>,
    /// Half the work of the load as our finite elements of refined meshes, J.
    pub truth: f64,
    /// The truth has this uncertainty, percent.
    pub truth_uncertainty_percent: f64,
    /// The displacement of the point that moves most as finite elements of the mesh, m.
    pub tip_of_finite_elements: f64,
    /// Half the work of the load as finite elements of the mesh, J.
    pub energy_of_finite_elements: f64,
    /// What was found; null if the body was not at rest in the time that it had.
    pub found: Option<FoundRow>,
    /// What moved by how much in the last fifth of the time, percent of the largest displacement; null if the motion diverged.
    pub moving_percent: Option<f64>,
    /// The time in the engine, s.
    pub seconds: f64,
    /// What the engine warned of.
    pub warnings: Vec<String>,
}

/// Tip and energy of a body at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FoundRow {
    /// Whether no point moved by more than the tolerance.
    pub is_still: bool,
    /// m, along the displacement of the finite elements.
    pub tip: f64,
    /// Half the work of the load, J.
    pub energy: f64,
    /// By how much the energy exceeds that of the model itself by linear theory, percent.
    pub of_model_percent: f64,
    /// By how much the tip exceeds that of finite elements of the mesh, percent.
    pub tip_percent: f64,
    /// By how much the energy exceeds that of finite elements of the mesh, percent.
    pub energy_percent: f64,
    /// By how much the energy exceeds the truth, percent.
    pub truth_percent: f64,
}

/// What an engine was told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Telling {
    /// The moduli or constants of the body.
    #[default]
    Given,
    /// E or the constants multiplied so that tension is right.
    Repaired,
    /// E and ν that follow from the law of the engine.
    Derived,
}

impl RefereeRow {
    /// Whether the engine moved elements of its own.
    pub fn is_of_elements(&self) -> bool {
        self.told.is_some()
    }

    /// The model in words, with what it was told.
    pub fn title(&self) -> String {
        let words = match (self.telling, self.is_of_elements()) {
            (Telling::Given, _) => "",
            (Telling::Repaired, true) => ", E repaired",
            (Telling::Repaired, false) => ", k repaired",
            (Telling::Derived, _) => ", E and ν derived",
        };
        format!("{}{words}", self.model)
    }
}
