//! Prony series of measured moduli: shares that are not negative, of relaxation times that are given by the range of the measurement.
//!
//! Theory: page *Springs that forget* of the book.

use super::damping::{check_rising, least_squares};
use crate::error::{Error, ErrorKind, Result};
use crate::range;
use std::f64::consts::TAU;

/// Measured moduli of one kind, all of shear, of bulk or of Young, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModulusTest<'a> {
    /// A relaxation test: the modulus at each time, s, after a strain was applied.
    Relaxation {
        /// The times, s, rising.
        times: &'a [f64],
        /// The moduli, `[times]`, Pa, falling.
        moduli: &'a [f64],
    },
    /// A creep test: the compliance, strain over stress, at each time, s, after a stress was applied.
    Creep {
        /// The times, s, rising.
        times: &'a [f64],
        /// The compliances, `[times]`, 1/Pa, rising.
        compliances: &'a [f64],
    },
    /// A dynamic test: storage and loss modulus at each frequency.
    Frequencies {
        /// The frequencies `ω/2π`, Hz, rising.
        frequencies: &'a [f64],
        /// The storage moduli, `[frequencies]`, Pa, rising.
        storage: &'a [f64],
        /// The loss moduli, `[frequencies]`, Pa.
        loss: &'a [f64],
    },
}

/// A Prony series that was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSeries {
    /// The shares of the modulus that relax, above zero, and their times, s.
    pub terms: Vec<[f64; 2]>,
    /// The modulus against a sudden strain, Pa.
    pub modulus: f64,
    /// The root mean square of the relative errors, of moduli or compliances as they were measured; of complex moduli relative to their size.
    pub error: f64,
}

/// Relaxation times in a decade of the measurement. A term falls within about one decade, so that two follow any
/// measured curve, and more would follow its noise.
const PER_DECADE: f64 = 2.0;
/// A rise of a modulus that falls, as a share of the largest, that may be noise. A larger rise is no relaxation:
/// columns are exchanged, or rows are out of order.
const NOISE: f64 = 0.02;
/// A share of the modulus below it is rounding.
// Measurements have three or four digits. The sum of squares leaves zeros where a term is of no use, and solves for the others to
// some ten digits.
const NONE: f64 = 1e-9;

impl ModulusTest<'_> {
    /// Fits `G(t) = G_∞ + Σ G_i e^(−t/τ_i)`, `G* = G_∞ + Σ G_i iωτ_i/(1 + iωτ_i)`, with G_∞, G_i ≥ 0 of the least squares of relative errors. There are
    /// two times τ_i in each decade of the measurement, from its first time, or 1/ω, to its last. Compliances are fitted by `J(t) = J_0 + Σ J_i (1 − e^(−t/λ_i))` with the
    /// times λ_i, and the series of the modulus is the one that creeps so.
    ///
    /// # Errors
    /// A list has another length or a number that is not above zero (a loss may be zero), there are fewer than three rows, times or frequencies do not rise, or moduli rise with
    /// time or fall with frequency by more than noise, or compliances fall; or nothing of a compliance is there at once.
    pub fn fit(&self) -> Result<FittedSeries> {
        let (places, [first, last]) = self.checked()?;
        // A measurement shorter than half a decade has its first and its last time all the same.
        let count = ((last / first).log10() * PER_DECADE).ceil().max(1.0);
        // Times are even in their logarithm, because each term acts within about a decade of its own.
        let times: Vec<f64> = (0..=count as usize).map(|i| first * (last / first).powf(i as f64 / count)).collect();
        let rows = self.rows(places, &times);
        let parts = least_squares(times.len() + 1, rows.iter().map(|(row, value)| (row, *value)));
        let largest: f64 = parts.iter().sum();
        if !(largest > 0.0 && largest.is_finite()) {
            let expected = "moduli that a series of terms above zero has";
            return Err(Error::expected("table", expected, "others").of_kind(ErrorKind::Infeasible));
        }
        let left =
            |(row, value): &(Vec<f64>, f64)| row.iter().zip(&parts).map(|(a, part)| a * part).sum::<f64>() - value;
        let squares: f64 = rows.iter().map(|row| left(row).powi(2)).sum();
        // Frequencies have two rows, whose squares sum up to that of the complex modulus: the mean is over places.
        let error = (squares / places.len() as f64).sqrt();
        let own = times.iter().zip(&parts[1..]).map(|(time, part)| [part / largest, *time]);
        let own: Vec<[f64; 2]> = own.filter(|[share, _]| *share > NONE).collect();
        if let ModulusTest::Creep { .. } = self {
            let at_once = parts[0] / largest;
            if !(at_once > NONE) {
                let expected = "a compliance of which a part is there at once, before the first time";
                return Err(Error::expected("compliance", expected, "none").of_kind(ErrorKind::Infeasible));
            }
            return Ok(FittedSeries { terms: relaxing(at_once, &own), modulus: 1.0 / parts[0], error });
        }
        Ok(FittedSeries { terms: own, modulus: largest, error })
    }

    /// The rows of the least squares, each with its value, relative to the size of the modulus.
    fn rows(&self, places: &[f64], times: &[f64]) -> Vec<(Vec<f64>, f64)> {
        // Each row is divided by its value: errors count relative to the modulus, which may fall by decades.
        let row = |size: f64, rest: f64, of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            std::iter::once(rest).chain(times.iter().map(|time| of(*time))).map(|a| a / size).collect()
        };
        match *self {
            ModulusTest::Relaxation { moduli, .. } => {
                places.iter().zip(moduli).map(|(t, g)| (row(*g, 1.0, &|tau| f64::exp(-t / tau)), 1.0)).collect()
            }
            ModulusTest::Creep { compliances, .. } => places
                .iter()
                .zip(compliances)
                // `expm1` keeps the digits of times far below τ, where the exponential is nearly one.
                .map(|(t, j)| (row(*j, 1.0, &|tau| -f64::exp_m1(-t / tau)), 1.0))
                .collect(),
            ModulusTest::Frequencies { storage, loss, .. } => {
                // Storage and loss share the size of the complex modulus: a small loss is not weighted up to its own.
                let both = |(frequency, (real, imaginary)): (&f64, (&f64, &f64))| {
                    // Frequencies are in Hz, ω in radians per second.
                    let w = TAU * frequency;
                    let size = real.hypot(*imaginary);
                    let of_real = row(size, 1.0, &|tau| (w * tau).powi(2) / (1.0 + (w * tau).powi(2)));
                    let of_imaginary = row(size, 0.0, &|tau| w * tau / (1.0 + (w * tau).powi(2)));
                    [(of_real, real / size), (of_imaginary, imaginary / size)]
                };
                places.iter().zip(storage.iter().zip(loss)).flat_map(both).collect()
            }
        }
    }

    /// The times or frequencies, and the first and the last relaxation time.
    fn checked(&self) -> Result<(&[f64], [f64; 2])> {
        let (name, places) = match *self {
            ModulusTest::Relaxation { times, .. } | ModulusTest::Creep { times, .. } => ("time", times),
            ModulusTest::Frequencies { frequencies, .. } => ("frequency", frequencies),
        };
        let lists = match *self {
            ModulusTest::Relaxation { moduli, .. } => vec![("modulus", moduli)],
            ModulusTest::Creep { compliances, .. } => vec![("compliance", compliances)],
            ModulusTest::Frequencies { storage, loss, .. } => vec![("storage", storage), ("loss", loss)],
        };
        let rises = !matches!(self, ModulusTest::Relaxation { .. });
        let unit = if matches!(self, ModulusTest::Creep { .. }) { "1/Pa" } else { "Pa" };
        // There are at least two relaxation times and the modulus that stays: three unknowns, which fewer rows leave
        // open.
        if places.len() < 3 {
            return Err(Error::expected(name, "three or more", places.len()));
        }
        let is_sound = |x: &f64| range::contains(*x);
        if let Some(found) = places.iter().find(|x| !is_sound(x)) {
            return Err(Error::expected(name, "numbers above zero, from 1e-30 to 1e30", format!("{found:?}")));
        }
        check_rising(name, places)?;
        for (key, list) in &lists {
            if list.len() != places.len() {
                return Err(Error::expected(*key, format!("{} numbers", places.len()), list.len()));
            }
            if let Some(found) = list.iter().find(|x| !(is_sound(x) || *key == "loss" && **x == 0.0)) {
                return Err(Error::expected(
                    *key,
                    format!("numbers of {unit} above zero, from 1e-30 to 1e30"),
                    format!("{found:?}"),
                ));
            }
        }
        let (key, list) = lists[0];
        let largest = list.iter().copied().fold(0.0, f64::max);
        let wrong = |pair: &&[f64]| if rises { pair[0] - pair[1] } else { pair[1] - pair[0] } > NOISE * largest;
        if let Some(pair) = list.windows(2).find(wrong) {
            let expected = match self {
                ModulusTest::Relaxation { .. } => "moduli that fall with time",
                ModulusTest::Creep { .. } => "compliances that rise with time",
                ModulusTest::Frequencies { .. } => "moduli that rise with frequency",
            };
            return Err(Error::expected(key, expected, format!("{} after {}", pair[1], pair[0])));
        }
        let ends = [places[0], places[places.len() - 1]];
        let is_of_frequencies = matches!(self, ModulusTest::Frequencies { .. });
        // The highest frequency shows the shortest time, so that the order turns.
        Ok((places, if is_of_frequencies { [1.0 / (TAU * ends[1]), 1.0 / (TAU * ends[0])] } else { ends }))
    }
}

/// The shares and times of the modulus whose compliance has the part `at_once` and these shares with times λ_i, which rise, of its largest.
///
/// With the Laplace transform, `f(s) = s J(s) = J_0 + Σ J_i/(1 + s λ_i)` and `s G(s) = 1/f(s) = G_0 − Σ G_i/(1 + s τ_i)`: each zero `s = −1/τ_i` of f is a time of the modulus, with
/// `G_i = −τ_i/f′(s)`. f falls between its poles `−1/λ_i` from +∞ to −∞, so that there is one zero between each two and one beyond the last.
fn relaxing(at_once: f64, shares: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let value = |rate: f64| at_once + shares.iter().map(|[share, time]| share / (1.0 - rate * time)).sum::<f64>();
    let slope = |rate: f64| shares.iter().map(|[share, time]| share * time / (1.0 - rate * time).powi(2)).sum::<f64>();
    let delayed: f64 = shares.iter().map(|[share, _]| share).sum();
    let rates: Vec<f64> = shares.iter().map(|[_, time]| 1.0 / time).collect();
    // With `r = r₁ (1 + D/J₀)`, r₁ the largest rate and D the sum of all delayed parts, every `r λ_i − 1` is at least
    // `D/J₀`, so that the sum is at least `J₀ − D/(D/J₀) = 0`: the last zero is not beyond this rate.
    let beyond = rates.first().map(|largest| largest * (1.0 + delayed / at_once));
    // Times rise, so rates fall: each zero is between a rate and the one before it.
    let above = beyond.into_iter().chain(rates.iter().copied());
    let zero = |(mut low, mut high): (f64, f64)| {
        // The value falls with s = −rate, so it rises from −∞ with the rate. Halves of 2⁻⁵³ of an interval are its rounding.
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = (low + high) / 2.0;
            if value(middle) < 0.0 { low = middle } else { high = middle }
        }
        let rate = (low + high) / 2.0;
        let time = 1.0 / rate;
        [at_once * time / slope(rate), time]
    };
    rates.iter().copied().zip(above).map(zero).collect()
}
