//! The results of a sweep.

use serde::Serialize;
/// What is varied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Poisson's ratio.
    Poisson,
    /// Young's modulus.
    Young,
    /// The size of the element.
    Size,
    /// The distance from the origin.
    Place,
    /// Elements stretched along one axis.
    Needle,
    /// Elements flattened along one axis.
    Cap,
    /// Elements flattened such that all nodes approach a plane and no two of them each other.
    Sliver,
    /// Two nodes near each other.
    Near,
    /// A node on an edge away from its middle.
    Bent,
    /// A corner of a quadrilateral that opens to 180 degrees.
    Corner,
    /// Elements with their nodes in the opposite order.
    Reversed,
    /// Regions of different stiffness side by side.
    Contrast,
    /// Points and cells of a mesh that do not fit.
    Mesh,
    /// Stiff motions.
    Motion,
    /// Elements stretched to twice their length and compressed to nothing.
    Collapse,
}

impl Family {
    /// The name in reports.
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
    /// The error is at most the promised one.
    Accurate,
    /// The error is larger, but not larger than the effect of rounding the input.
    InputLimited,
    /// The springs are linearly dependent: the optimum of least norm is returned.
    Dependent,
    /// There is no result, for this reason.
    Refused(String),
    /// There is a result, with this remark.
    Told(String),
    /// The error is larger than allowed: a fault of the program.
    Lost,
}

impl Verdict {
    /// The names, in the order of the variants.
    pub const NAMES: [&'static str; 6] = ["accurate", "input-limited", "dependent", "refused", "told", "LOST"];

    /// The name in reports.
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

    /// The reason or the remark; empty if there is none.
    pub fn words(&self) -> &str {
        match self {
            Verdict::Refused(words) | Verdict::Told(words) => words,
            Verdict::Accurate | Verdict::InputLimited | Verdict::Dependent | Verdict::Lost => "",
        }
    }
}

/// The largest error; infinite if one is NaN.
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

/// The result of one case with one method. A number that the case does not have is `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityRow {
    /// The element, or another subject.
    pub subject: String,
    /// What is varied.
    pub family: Family,
    /// The value that it has.
    pub case: String,
    /// The objective, the solver or the integrator.
    pub method: String,
    /// The verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// The relative error: of constants from double-double results; for spectral fits the proven distance from the
    /// optimum; of bodies and motions from closed forms.
    pub error: Option<f64>,
    /// The allowed error.
    pub allowed: Option<f64>,
    /// The relative error in single precision.
    pub single: Option<f64>,
    /// The condition number of the normal equations, or of the assembled system, both scaled to a unit diagonal.
    pub condition: Option<f64>,
    /// The number of negative constants, and the number of all.
    pub negative: Option<[usize; 2]>,
    /// The least eigenvalue of the network's stiffness without rigid motions, relative to the largest.
    pub softest: Option<f64>,
    /// The longest stable explicit step, s, with a density of 1000 kg/m³.
    pub step: Option<f64>,
    /// The number of iterations.
    pub iterations: Option<usize>,
    /// What to do about it, where the result is trouble and something helps. A remark without it is no trouble.
    pub way_out: Option<&'static str>,
}

impl StabilityRow {
    /// A result without numbers.
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
            way_out: None,
        }
    }

    /// Names what to do about a result that is trouble.
    pub fn with_way_out(mut self, way_out: &'static str) -> StabilityRow {
        self.way_out = Some(way_out);
        self
    }

    /// Whether something has to be done: there is no result, one that is wrong, or one with a way out.
    pub fn is_trouble(&self) -> bool {
        match self.verdict {
            Verdict::Refused(_) | Verdict::Lost => true,
            Verdict::Accurate | Verdict::InputLimited | Verdict::Dependent | Verdict::Told(_) => self.way_out.is_some(),
        }
    }

    /// Gives the result this error and this allowed error.
    pub fn with_error(mut self, error: f64, allowed: f64) -> StabilityRow {
        (self.error, self.allowed) = (Some(error), Some(allowed));
        self
    }
}

/// The results of a whole sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityOutcome {
    /// What was swept.
    pub title: String,
    /// The results of all cases.
    pub rows: Vec<StabilityRow>,
    /// The time of the sweep, s.
    pub seconds: f64,
}

impl StabilityOutcome {
    /// The results with an error that is larger than allowed.
    pub fn lost(&self) -> impl Iterator<Item = &StabilityRow> {
        self.rows.iter().filter(|row| row.verdict == Verdict::Lost)
    }
}
