//! What a sweep finds.

use serde::Serialize;
/// What is varied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    Poisson,
    Young,
    Size,
    Place,
    /// Stretched along one axis.
    Needle,
    /// Flattened along one axis.
    Cap,
    /// Flattened across every face.
    Sliver,
    /// Two nodes near each other.
    Near,
    /// A node between two corners off its middle.
    Bent,
    /// A corner of a quadrilateral that opens to 180 degrees.
    Corner,
    Reversed,
    /// Regions of different stiffness side by side.
    Contrast,
    /// Points and cells of a mesh that do not belong together.
    Mesh,
    /// Stiff motions.
    Motion,
    /// Stretched to twice the length, and down to nothing.
    Collapse,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Family::Poisson => "Poisson's ratio",
            Family::Young => "Young's modulus",
            Family::Size => "size",
            Family::Place => "place",
            Family::Needle => "needle",
            Family::Cap => "cap",
            Family::Sliver => "sliver",
            Family::Near => "near nodes",
            Family::Bent => "bent edge",
            Family::Corner => "open corner",
            Family::Reversed => "reversed",
            Family::Contrast => "contrast",
            Family::Mesh => "mesh",
            Family::Motion => "motion",
            Family::Collapse => "collapse",
        }
    }
}

/// How a case ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "verdict", content = "words")]
pub enum Verdict {
    /// The error is at most what is promised.
    Accurate,
    /// The error is more than that, but no more than rounding the input may cost.
    InputLimited,
    /// Springs depend on each other: of all optima the one of least norm was taken.
    Dependent,
    /// No answer, for this reason.
    Refused(String),
    /// An answer, and what is to be known of it.
    Told(String),
    /// The error is more than it may be: a fault of the program.
    Lost,
}

impl Verdict {
    /// The names, in the order of the variants.
    pub const NAMES: [&'static str; 6] = ["accurate", "input-limited", "dependent", "refused", "told", "LOST"];

    pub fn name(&self) -> &'static str {
        let place = match self {
            Verdict::Accurate => 0,
            Verdict::InputLimited => 1,
            Verdict::Dependent => 2,
            Verdict::Refused(_) => 3,
            Verdict::Told(_) => 4,
            Verdict::Lost => 5,
        };
        Verdict::NAMES[place]
    }

    /// The reason or the remark; empty where the name says all.
    pub fn words(&self) -> &str {
        match self {
            Verdict::Refused(words) | Verdict::Told(words) => words,
            Verdict::Accurate | Verdict::InputLimited | Verdict::Dependent | Verdict::Lost => "",
        }
    }
}

/// The largest; infinite if one is not a number.
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |worst, error| {
        if error <= worst {
            worst
        } else if error > worst {
            error
        } else {
            f64::INFINITY
        }
    })
}

/// What came of one case by one method. What a case has not is `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityRow {
    /// The element, or what else is tried.
    pub subject: String,
    pub family: Family,
    pub case: String,
    /// The objective, the solver or the integrator.
    pub method: String,
    #[serde(flatten)]
    pub verdict: Verdict,
    /// Relative to the largest: of the constants from twice the digits; of spectral fits the proven distance from the optimum; of
    /// bodies and motions from closed forms.
    pub error: Option<f64>,
    /// What the error may be.
    pub allowed: Option<f64>,
    /// The same error in single precision.
    pub single: Option<f64>,
    /// Of the normal equations, or of the assembled system, both scaled to a unit diagonal.
    pub condition: Option<f64>,
    /// Constants below zero, of how many.
    pub negative: Option<[usize; 2]>,
    /// The least eigenvalue of the network's stiffness beyond rigid motions, relative to the largest.
    pub softest: Option<f64>,
    /// The longest stable explicit step, s, with a density of 1000 kg/m³.
    pub step: Option<f64>,
    pub iterations: Option<usize>,
}

impl StabilityRow {
    pub fn new(subject: &str, family: Family, case: &str, method: &str, verdict: Verdict) -> StabilityRow {
        StabilityRow {
            subject: subject.into(),
            family,
            case: case.into(),
            method: method.into(),
            verdict,
            error: None,
            allowed: None,
            single: None,
            condition: None,
            negative: None,
            softest: None,
            step: None,
            iterations: None,
        }
    }

    /// With this error, which may be so large.
    pub fn with_error(mut self, error: f64, allowed: f64) -> StabilityRow {
        (self.error, self.allowed) = (Some(error), Some(allowed));
        self
    }
}

/// A whole sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityOutcome {
    /// What was swept.
    pub title: String,
    pub rows: Vec<StabilityRow>,
    pub seconds: f64,
}

impl StabilityOutcome {
    /// The rows whose error is more than it may be.
    pub fn lost(&self) -> impl Iterator<Item = &StabilityRow> {
        self.rows.iter().filter(|row| row.verdict == Verdict::Lost)
    }
}
