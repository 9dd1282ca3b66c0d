//! Damping that was measured, from which a scene takes a Prony series or Rayleigh's two numbers.
//!
//! Theory: page *Springs that forget* of the book.

use super::value::Numbers;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{DampedSeries, DampingError, DampingKind, DampingTest, FittedRayleigh, ratio_of_decay};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Damping that was measured, by loss factors or by free vibrations that die away.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DampingMeasurement {
    /// Damping was measured at these frequencies in Hz, above 0 and rising, or at one: those of the vibrations as they are seen.
    pub frequency: Option<Numbers>,
    /// Vibrations that are kept up have these loss factors, loss modulus over storage modulus, 0 or more: one at each frequency, or one over the `band`.
    pub loss_factor: Option<Numbers>,
    /// Free vibrations have these damping ratios, shares of critical damping from 0 to below 1: one at each frequency, or one over the `band`.
    pub ratio: Option<Numbers>,
    /// Free vibrations have these logarithmic decrements, ln of a peak over the next one, 0 or more: one at each frequency, or one over the `band`.
    pub decrement: Option<Numbers>,
    /// A free vibration was read at these times in s, rising. The key belongs to `amplitude`.
    pub time: Option<Vec<f64>>,
    /// The free vibration has these amplitudes, the sizes of its peaks in any unit, above 0 and falling. The key belongs to `time` and one `frequency`.
    pub amplitude: Option<Vec<f64>>,
    /// Damping is wanted from the first to the second of these frequencies in Hz. One number is taken as constant there, and needs the key; without it the
    /// frequencies that were measured are the band.
    pub band: Option<[f64; 2]>,
}

/// What was fitted to damping that was measured, and the error that it leaves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MeasuredDamping {
    /// The scene has the measurement under this key.
    pub key: String,
    /// Rayleigh's damping has these α in 1/s and β in s; it is null where a Prony series was fitted.
    pub rayleigh: Option<[f64; 2]>,
    /// Each entry is a term of the Prony series: the share of the modulus that relaxes, and its time in s. The list is empty where Rayleigh's damping was
    /// fitted.
    pub terms: Vec<[f64; 2]>,
    /// One number was measured, which is taken as constant over the band.
    pub is_constant: bool,
    /// The band is from the first to the second of these frequencies, Hz.
    pub band: [f64; 2],
    /// The damping ratio that was measured has this root mean square over the band.
    pub ratio: f64,
    /// The damping ratio differs from that which was measured by this at most over the band.
    pub largest_difference: f64,
    /// The root mean square of the difference of the damping ratio is this, even over the logarithm of the frequency.
    pub rms_difference: f64,
    /// The logarithm of the amplitudes of a decay differs from a line by this root mean square; it is null where no amplitudes were given.
    pub decay_error: Option<f64>,
}

/// The largest decrement. What dies away faster is gone within a fiftieth of a period, and its damping ratio is above 0.99.
const LARGEST_DECREMENT: f64 = 50.0;
/// The largest error of a series that stands for measured damping, relative to it.
// Over two decades series of two terms in each have constant damping to 0.05 % and damping that rises with the
// frequency to 3 %. A peak that is the square of a Maxwell element's leaves 25 %, and damping that rises with the
// square of the frequency 36 %.
const LARGEST_ERROR: f64 = 0.2;

impl DampingMeasurement {
    /// Whether one of the keys is given that belong to damping alone.
    pub fn is_given(&self) -> bool {
        let one = [&self.loss_factor, &self.ratio, &self.decrement].iter().any(|values| values.is_some());
        one || self.amplitude.is_some() || self.band.is_some()
    }

    /// The Prony series that has the damping. Its key is empty.
    ///
    /// # Errors
    /// A number is out of its range, keys contradict each other, or no series has this damping.
    pub fn series(&self) -> Result<MeasuredDamping> {
        let (found, is_constant, decay) = self.fitted(|test: &DampingTest| test.series())?;
        let DampedSeries { terms, error } = found;
        if !(error.rms <= LARGEST_ERROR * error.size) {
            let expected = format!("damping that a Prony series has within {:.0} %", 100.0 * LARGEST_ERROR);
            let found = format!("an error of {:.0} %", 100.0 * error.rms / error.size);
            return Err(Error::new(format!("expected {expected}, found {found}")).of_kind(ErrorKind::Infeasible));
        }
        Ok(MeasuredDamping { terms, ..MeasuredDamping::of(error, is_constant, decay) })
    }

    /// Rayleigh's damping that is nearest. Its key is empty.
    ///
    /// # Errors
    /// A number is out of its range, or keys contradict each other.
    pub fn rayleigh(&self) -> Result<MeasuredDamping> {
        let (found, is_constant, decay) = self.fitted(|test: &DampingTest| test.rayleigh())?;
        let FittedRayleigh { numbers, error } = found;
        Ok(MeasuredDamping { rayleigh: Some(numbers), ..MeasuredDamping::of(error, is_constant, decay) })
    }

    /// What is fitted to the measurement, whether one number stands for a band, and the error of a decay.
    fn fitted<T>(&self, fit: impl Fn(&DampingTest) -> Result<T>) -> Result<(T, bool, Option<f64>)> {
        let given = [
            (DampingKind::LossFactor, &self.loss_factor),
            (DampingKind::Ratio, &self.ratio),
            (DampingKind::Decrement, &self.decrement),
        ];
        let given: Vec<(DampingKind, &[f64])> =
            given.into_iter().filter_map(|(kind, values)| Some((kind, &values.as_ref()?.0[..]))).collect();
        let frequencies: &[f64] = self.frequency.as_ref().map_or(&[], |list| &list.0);
        let decrements = self.decrement.iter().flat_map(|list| &list.0);
        if let Some(found) = decrements.copied().find(|decrement| *decrement > LARGEST_DECREMENT) {
            let expected = format!("0 or more, at most {LARGEST_DECREMENT}");
            return Err(Error::expected("decrement", expected, format!("{found:?}")));
        }
        let test = |kind, values: &[f64]| {
            let is_constant = values.len() == 1 && frequencies.len() <= 1;
            Ok((fit(&DampingTest { kind, values, frequencies, band: self.band })?, is_constant))
        };
        match (&given[..], &self.time, &self.amplitude) {
            ([(kind, values)], None, None) => {
                test(*kind, values).map(|(found, is_constant)| (found, is_constant, None))
            }
            ([], Some(times), Some(amplitudes)) => {
                let [frequency] = *frequencies else {
                    let expected = "the one frequency in Hz at which the body vibrates";
                    return Err(Error::expected("frequency", expected, format!("{} numbers", frequencies.len())));
                };
                let decay = ratio_of_decay(times, amplitudes, frequency)?;
                let (found, is_constant) = test(DampingKind::Ratio, &[decay.ratio])?;
                Ok((found, is_constant, Some(decay.error)))
            }
            (given, times, amplitudes) => {
                let expected = "one of \"loss_factor\", \"ratio\", \"decrement\", and \"time\" with \"amplitude\"";
                let mut names: Vec<&str> = given.iter().map(|(kind, _)| kind.name()).collect();
                names.extend(times.iter().map(|_| "time").chain(amplitudes.iter().map(|_| "amplitude")));
                let found = if names.is_empty() { "none".into() } else { names.join(", ") };
                Err(Error::new(format!("expected {expected}, found {found}")))
            }
        }
    }
}

impl MeasuredDamping {
    fn of(error: DampingError, is_constant: bool, decay_error: Option<f64>) -> MeasuredDamping {
        MeasuredDamping {
            key: String::new(),
            rayleigh: None,
            terms: Vec::new(),
            is_constant,
            band: error.band,
            ratio: error.size,
            largest_difference: error.largest,
            rms_difference: error.rms,
            decay_error,
        }
    }

    /// The same, under this key of the scene.
    pub fn at(self, key: impl Into<String>) -> MeasuredDamping {
        MeasuredDamping { key: key.into(), ..self }
    }
}
