//! The `[material.relaxation]` of a scene.

use super::damping::{DampingMeasurement, MeasuredDamping};
use super::value::{self, Numbers};
use crate::choice::choice;
use crate::error::{Error, ErrorKind, Result, expect_none};
use crate::fit::{FittedSeries, ModulusTest};
use crate::material::{Relaxation, RelaxationTerm};
use schemars::JsonSchema;
use serde::Deserialize;

/// The largest error of a series that stands for measured moduli.
// Over three decades series of two terms in each have moduli that fall as `t^(−1/2)` to 0.4 % and as `1/t` to 1.6 %. A
// sudden fall to a fourth leaves 22 %, and one to a tenth 30 %.
const LARGEST_ERROR: f64 = 0.2;

/// How the moduli of a material relax.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelaxationEntry {
    /// The moduli relax in these terms of a Prony series, one or more. Of each modulus the shares add up to at most 1. One of `terms` and
    /// `measured` is required.
    #[serde(default)]
    terms: Vec<TermEntry>,
    /// The terms are fitted to these moduli, or to this damping; a note or a table has the error.
    measured: Option<MeasuredModuli>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TermEntry {
    /// This share of the shear modulus relaxes, from 0 to 1. A term has `shear` or `bulk` above 0.
    #[serde(default)]
    shear: f64,
    /// This share of the bulk modulus relaxes, from 0 to 1. With a law it is 0.
    #[serde(default)]
    bulk: f64,
    /// The term has this relaxation time in s, above 0.
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::time_schema")]
    time: f64,
    /// The term does not flow while the von Mises stress of the term is below this, in Pa; beyond it flows at the rate of what exceeds it. A term
    /// with `yield` has no `bulk`, and the material a law.
    #[serde(default, rename = "yield", deserialize_with = "value::optional_stress")]
    #[schemars(schema_with = "value::stress_schema")]
    yield_stress: Option<f64>,
}

/// Measured moduli, of a relaxation test, a creep test or a dynamic one; or damping, by loss factors or free vibrations.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MeasuredModuli {
    /// A relaxation test was read at these times in s after a strain was applied, above 0 and rising; or a free vibration, from any time on.
    time: Option<Vec<f64>>,
    /// The test has these moduli in Pa, above 0 and falling. The key belongs to `time`.
    modulus: Option<Vec<f64>>,
    /// A creep test has these compliances, strain over stress in 1/Pa, above 0 and rising, at these times after a stress was applied. The key belongs to `time`, in place of `modulus`.
    compliance: Option<Vec<f64>>,
    /// A dynamic test has these frequencies in Hz, above 0 and rising, or damping was measured at them. The key stands in place of `time`, but for `amplitude`.
    frequency: Option<Numbers>,
    /// The test has these storage moduli in Pa, above 0 and rising. The key belongs to `frequency`.
    storage: Option<Vec<f64>>,
    /// The test has these loss moduli in Pa, 0 or more. The key belongs to `frequency`.
    loss: Option<Vec<f64>>,
    /// Vibrations that are kept up have these loss factors, loss modulus over storage modulus, 0 or more: one at each `frequency`, or one over the `band`.
    loss_factor: Option<Numbers>,
    /// Free vibrations have these damping ratios, shares of critical damping from 0 to below 1: one at each `frequency`, or one over the `band`.
    ratio: Option<Numbers>,
    /// Free vibrations have these logarithmic decrements, ln of a peak over the next one, 0 or more: one at each `frequency`, or one over the `band`.
    decrement: Option<Numbers>,
    /// A free vibration has these amplitudes, the sizes of its peaks in any unit, above 0 and falling. The key belongs to `time` and one `frequency`.
    amplitude: Option<Vec<f64>>,
    /// Damping is wanted from the first to the second of these frequencies in Hz. One number of damping is taken as constant there, and needs the key.
    band: Option<[f64; 2]>,
    /// The moduli or the damping are those of shear, and bulk does not relax (`shear`); or all moduli relax alike (`all`).
    #[schemars(extend("enum" = MeasuredPart::NAMES, "default" = MeasuredPart::default().name()))]
    of: Option<String>,
}

/// What relaxes as measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum MeasuredPart {
    /// Shear.
    #[default]
    Shear,
    /// Shear and bulk.
    All,
}

crate::named!(MeasuredPart {
    "shear" => Shear,
    "all" => All,
});

impl RelaxationEntry {
    /// The Prony series of the key `relaxation`.
    ///
    /// # Errors
    /// A share or a time is out of its range, or measured moduli are those of no series.
    pub fn check(&self) -> Result<Relaxation> {
        self.series().map_err(|e| e.under("relaxation"))
    }

    /// The series that was fitted, if moduli were measured.
    pub fn fitted(&self) -> Option<FittedSeries> {
        self.measured.as_ref().filter(|measured| measured.damping().is_none())?.fit().ok()
    }

    /// The damping that was measured, with the series that was fitted to it.
    pub fn damping(&self) -> Option<MeasuredDamping> {
        self.measured.as_ref()?.damping()?.series().ok()
    }

    fn series(&self) -> Result<Relaxation> {
        if let Some(measured) = &self.measured {
            if !self.terms.is_empty() {
                return Err(Error::expected("measured", "either \"terms\" or \"measured\"", "both"));
            }
            return measured.series().map_err(|e| e.under("measured"));
        }
        let term = |term: &TermEntry| RelaxationTerm {
            shear: term.shear,
            bulk: term.bulk,
            time: term.time,
            yield_stress: term.yield_stress,
        };
        Relaxation::new(self.terms.iter().map(term).collect())
    }
}

impl MeasuredModuli {
    fn series(&self) -> Result<Relaxation> {
        let of = choice("of", self.of.as_deref(), MeasuredPart::default(), MeasuredPart::named)?;
        let term = |&[shear, time]: &[f64; 2]| {
            let bulk = if of == MeasuredPart::All { shear } else { 0.0 };
            RelaxationTerm { shear, bulk, time, yield_stress: None }
        };
        if let Some(damping) = self.damping() {
            let others = [
                ("modulus", self.modulus.is_some()),
                ("compliance", self.compliance.is_some()),
                ("storage", self.storage.is_some()),
                ("loss", self.loss.is_some()),
            ];
            expect_none(others, "is a modulus, found beside damping")?;
            return Relaxation::new(damping.series()?.terms.iter().map(term).collect());
        }
        let fitted = self.fit()?;
        if fitted.terms.is_empty() {
            return Err(Error::new("expected moduli that relax, found some that do not"));
        }
        if !(fitted.error <= LARGEST_ERROR) {
            let expected = format!("moduli that a Prony series has within {:.0} %", 100.0 * LARGEST_ERROR);
            let found = format!("an error of {:.0} %", 100.0 * fitted.error);
            return Err(Error::new(format!("expected {expected}, found {found}")).of_kind(ErrorKind::Infeasible));
        }
        Relaxation::new(fitted.terms.iter().map(term).collect())
    }

    /// The damping, if one of its keys is given.
    fn damping(&self) -> Option<DampingMeasurement> {
        let damping = DampingMeasurement {
            frequency: self.frequency.clone(),
            loss_factor: self.loss_factor.clone(),
            ratio: self.ratio.clone(),
            decrement: self.decrement.clone(),
            time: self.time.clone(),
            amplitude: self.amplitude.clone(),
            band: self.band,
        };
        damping.is_given().then_some(damping)
    }

    fn fit(&self) -> Result<FittedSeries> {
        let of_time = (&self.time, &self.modulus, &self.compliance);
        match (of_time, (&self.frequency, &self.storage, &self.loss)) {
            ((Some(times), Some(moduli), None), (None, None, None)) => ModulusTest::Relaxation { times, moduli }.fit(),
            ((Some(times), None, Some(compliances)), (None, None, None)) => {
                ModulusTest::Creep { times, compliances }.fit()
            }
            ((None, None, None), (Some(Numbers(frequencies)), Some(storage), Some(loss))) => {
                ModulusTest::Frequencies { frequencies, storage, loss }.fit()
            }
            _ => {
                let expected =
                    "damping, \"time\" and \"modulus\" or \"compliance\", or \"frequency\", \"storage\" and \"loss\"";
                Err(Error::new(format!("expected {expected}, found others")))
            }
        }
    }
}
