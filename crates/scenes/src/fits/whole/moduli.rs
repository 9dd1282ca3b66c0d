//! The moduli of the body or of its regions that a fit has found.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Residuals of this multiple of the noise are more than noise.
// Where ten numbers more than unknowns were measured, noise alone leaves as much once in 80 cases, and where thirty
// were, once in 10 000: χ² over that number is then 2.25.
const MISFIT: f64 = 1.5;

/// Residuals of this multiple are those of another model or another noise, as in `springfit calibrate`.
// With one number more than unknowns noise alone leaves as much in 0.3 % of cases, and with two more in 0.01 %.
const MANY: f64 = 3.0;

/// By what deviations by the stated noise are multiplied where residuals are more than noise (Birge 1932).
pub(super) fn excess(misfit: Option<f64>) -> f64 {
    misfit.filter(|misfit| *misfit > MISFIT).unwrap_or(1.0)
}

/// What displacements say of moduli.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FoundModuli {
    /// Each entry is the factor on a modulus of the body or of its regions, if these are the unknowns.
    #[serde(rename = "moduli")]
    pub all: Vec<FoundModulus>,
    /// These moduli have a 95 % interval that reaches beyond the factor 2: one alone, or several whose combination the displacements do not
    /// see.
    #[serde(rename = "hardly_seen")]
    pub weak: Vec<String>,
    /// The residuals are this many times as large as the stated noise; it is null where no `sigma` is given.
    pub misfit: Option<f64>,
    /// How the search for them ended.
    #[serde(skip)]
    pub search: ModuliSearch,
}

/// How the search for moduli ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ModuliSearch {
    /// At the optimum with its ρ.
    #[default]
    Finished,
    /// At the largest number of steps before the optimum, which the intervals reach.
    Ended,
    /// Neither the fit nor a search without ρ from there has reached an optimum.
    Lost,
}

/// The factor on a modulus.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FoundModulus {
    /// The modulus is `mu` or `lambda`, with its region, such as `mu of tumour`.
    #[serde(rename = "modulus")]
    pub name: String,
    /// The modulus of the material is multiplied by this factor.
    pub factor: f64,
    /// The factor is in this interval with 95 %; it is null if the displacements do not determine it, or if an end is beyond all numbers.
    pub interval: Option<[f64; 2]>,
    /// The meshes cause this standard deviation of the logarithm of the factor, which is in the interval; it is null without a finer body.
    #[serde(rename = "mesh_deviation")]
    pub mesh: Option<f64>,
}

impl FoundModuli {
    /// Notes for the reader, one sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let Some(first) = self.all.first() else { return Vec::new() };
        let one = |modulus: &FoundModulus| {
            let told = match modulus.interval {
                Some([low, high]) => format!("{} to {}", factor(low), factor(high)),
                None => "not determined by these displacements".into(),
            };
            format!("{} x {} ({told})", modulus.name, factor(modulus.factor))
        };
        let list: Vec<String> = self.all.iter().map(one).collect();
        let mesh = if first.mesh.is_some() { "with" } else { "without" };
        let found =
            format!("moduli relative to the material, 95 % intervals {mesh} errors of the mesh: {}", list.join(", "));
        let prior = match self.all.iter().any(|modulus| modulus.name.starts_with("lambda")) {
            true => "; unknowns = \"region-young\" keeps Poisson's ratio",
            false => "",
        };
        let weak = (!self.weak.is_empty()).then(|| {
            let weak = self.weak.join("; or of ");
            format!("the displacements hardly see {weak}: intervals reach beyond the factor 2{prior}")
        });
        let misfit = self.misfit.map(|misfit| {
            let told = match misfit {
                _ if misfit > MISFIT => {
                    ": the model does not explain these displacements, and deviations by noise are multiplied by it"
                }
                _ => "",
            };
            let distrust = if misfit > MANY { "NOT TRUSTED: " } else { "" };
            format!("{distrust}residuals are {misfit:.2} times the stated noise{told}")
        });
        let search = match self.search {
            ModuliSearch::Finished => None,
            ModuliSearch::Ended => Some(
                "the search for the moduli ended at its largest number of iterations, before the optimum that the intervals reach: \
                 the factors are not the best ones; more iterations, or solver = \"gauss-newton\", find them",
            ),
            ModuliSearch::Lost => Some(
                "the search for the moduli has found no optimum: neither the factors nor their intervals are to be trusted",
            ),
        };
        [Some(found), search.map(String::from), weak, misfit].into_iter().flatten().collect()
    }
}

/// A factor with four digits after the point, or four in all where these would hide it.
fn factor(value: f64) -> String {
    match value {
        0.01..1e4 => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    }
}
