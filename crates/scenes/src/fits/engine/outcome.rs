//! What a network answers in an engine, before and after its constants are fitted for it.

use crate::engine::{Precision, Setting, Vibration};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a network answers in an engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct EngineOutcome {
    /// How stiff a body the engine can hold.
    #[serde(flatten)]
    pub limit: EngineLimit,
    /// The constants of springs on lengths, and those of springs on contents, were multiplied by these factors; the list is null of a
    /// whole-object fit, which finds each constant.
    pub factors: Option<Vec<f64>>,
    /// The displacements in the engine under the loads of the fit have these errors before the constants are fitted for it.
    pub before: EngineErrors,
    /// The displacements in the engine under the loads of the fit have these errors afterwards.
    pub after: EngineErrors,
    /// The network in the engine has this first natural vibration; it is null where none is found.
    pub vibration: Option<EngineVibration>,
    /// The finite elements have this first frequency in Hz, with the masses of the network.
    pub frequency: f64,
}

/// How stiff a body an engine can hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EngineLimit {
    /// The constants are for these settings.
    pub setting: Setting,
    /// Springs without compliance make a body with this many times the modulus of this one; it is null of `vbd`, which reaches any stiffness, and of `jacobi`
    /// where sweeps without compliance grow without bound.
    pub ceiling: Option<f64>,
    /// The largest Young's modulus is this in Pa; it is null where `ceiling` is, and of a body with several.
    pub modulus: Option<f64>,
    /// The body can be represented with this number of substeps or more; it is null where `ceiling` is.
    pub least_substeps: Option<usize>,
}

/// The limit of the engine of a fit, before the fit is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitLimit {
    /// The fit has this name.
    pub fit: String,
    /// How stiff a body the engine can hold.
    #[serde(flatten)]
    pub limit: EngineLimit,
}

impl EngineLimit {
    /// What is said where there is no ceiling.
    pub const NONE: &str = "no stiffness is too large for the method, or its sweeps do not end without compliance, so that it has no ceiling";

    /// The limit in a sentence, with the name of what has the modulus; `None` where there is no ceiling.
    pub fn words(&self, of: &str) -> Option<String> {
        let ceiling = self.ceiling?;
        let modulus = self.modulus.map_or(String::new(), |modulus| format!(", {modulus:.3e} Pa"));
        let least = match self.least_substeps {
            Some(1) => "1 substep is the least".into(),
            Some(least) => format!("{least} substeps are the least"),
            None => "thousands of substeps are not enough".to_string(),
        };
        Some(format!(
            "springs without compliance reach {ceiling:.2} times the modulus of {of} in this engine{modulus}; {least} for it"
        ))
    }
}

/// The relative errors `‖u − ū‖/‖ū‖` under some loads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EngineErrors {
    /// The errors have this mean.
    pub mean: f64,
    /// The largest error is this.
    pub largest: f64,
}

/// A natural vibration in an engine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EngineVibration {
    /// The frequency is in Hz.
    pub frequency: f64,
    /// The sweeps and the implicit steps damp the vibration with this ratio.
    pub damping: f64,
}

impl From<Vibration> for EngineVibration {
    fn from(vibration: Vibration) -> EngineVibration {
        EngineVibration { frequency: vibration.frequency, damping: vibration.damping }
    }
}

impl EngineErrors {
    /// Those of a list; `None` of none.
    pub fn of(errors: &[f64]) -> Option<EngineErrors> {
        let largest = errors.iter().copied().reduce(f64::max)?;
        Some(EngineErrors { mean: errors.iter().sum::<f64>() / errors.len() as f64, largest })
    }
}

/// A move within a substep, relative to the extent of the body, that single precision rounds by a tenth and more.
const COARSE: f64 = 10.0 * f32::EPSILON as f64;
/// The acceleration by which a substep is judged, m/s².
const GRAVITY: f64 = 9.81;

impl EngineOutcome {
    /// Notes for the reader, one sentence each; `extent` is that of the body in m.
    pub fn notes(&self, extent: f64) -> Vec<String> {
        let percent =
            |errors: EngineErrors| format!("{:.1} (largest {:.1}) %", 100.0 * errors.mean, 100.0 * errors.largest);
        let setting = &self.limit.setting;
        let mut notes = vec![format!(
            "for {}: displacements in the engine under the loads of the fit are {} off, with the constants as they were {}",
            setting.words(),
            percent(self.after),
            percent(self.before)
        )];
        notes.extend(self.limit.words("the body"));
        notes.push(
            "the constants are for the engine alone: equations that are solved to the end, such as those of frequencies and moduli, \
             find the network stiffer than the body by what the engine loses"
                .into(),
        );
        if let Some(factors) = &self.factors {
            let kinds = ["lengths", "contents"].iter().zip(factors);
            let words: Vec<String> = kinds.map(|(kind, factor)| format!("on {kind} by {factor:.4}")).collect();
            notes.push(format!("constants of springs {} are multiplied for the engine", words.join(", ")));
        }
        if let Some(EngineVibration { frequency, damping }) = self.vibration {
            notes.push(format!(
                "the first frequency in the engine is {frequency:.3} Hz, that of the finite elements {:.3} Hz; its sweeps damp that motion with \
                 the ratio {damping:.3}, which no constants change: other damping is less by that much",
                self.frequency
            ));
        }
        let moved = GRAVITY * setting.substep().powi(2);
        if setting.precision == Precision::Single && moved < COARSE * extent {
            notes.push(format!(
                "a substep moves points by {moved:.1e} m under gravity, which single precision rounds by a tenth and more: fewer substeps with \
                 more sweeps are more accurate"
            ));
        }
        notes
    }
}
