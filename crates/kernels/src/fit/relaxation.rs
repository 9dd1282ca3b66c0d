//! Prony series of measured moduli: shares that are not negative, of relaxation times that are given by the range of the measurement.
//!
//! Theory: page *Springs that forget* of the book.

use super::constrained::solve_nonnegative;
use super::normal::Normal;
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
    /// The root mean square of the relative errors; of complex moduli relative to their size.
    pub error: f64,
}

/// Relaxation times in a decade of the measurement. A term falls within about one decade, so that two follow any
/// measured curve, and more would follow its noise.
const PER_DECADE: f64 = 2.0;
/// A rise of a modulus that falls, as a share of the largest, that may be noise. A larger rise is no relaxation:
/// columns are exchanged, or rows are out of order.
const NOISE: f64 = 0.02;
/// A share of the modulus below it is rounding.
const NONE: f64 = 1e-9;

impl ModulusTest<'_> {
    /// Fits `G(t) = G_∞ + Σ G_i e^(−t/τ_i)`, `G* = G_∞ + Σ G_i iωτ_i/(1 + iωτ_i)`, with G_∞, G_i ≥ 0 of the least squares of relative errors. There are
    /// two times τ_i in each decade of the measurement, from its first time, or 1/ω, to its last.
    ///
    /// # Errors
    /// A list has another length or a number that is not above zero (a loss may be zero), there are fewer than three rows, times or frequencies do not rise, or moduli rise with
    /// time or fall with frequency by more than noise.
    pub fn fit(&self) -> Result<FittedSeries> {
        let (places, [first, last]) = self.checked()?;
        let count = ((last / first).log10() * PER_DECADE).ceil().max(1.0);
        let times: Vec<f64> = (0..=count as usize).map(|i| first * (last / first).powf(i as f64 / count)).collect();
        let rows = self.rows(places, &times);
        let n = times.len() + 1;
        let (mut gram, mut rhs) = (vec![0.0; n * n], vec![0.0; n]);
        for (row, value) in &rows {
            for (i, a) in row.iter().enumerate() {
                rhs[i] += a * value;
                row.iter().enumerate().for_each(|(j, b)| gram[i * n + j] += a * b);
            }
        }
        let (parts, _) = solve_nonnegative(&Normal::new(gram, rhs));
        let modulus: f64 = parts.iter().sum();
        if !(modulus > 0.0 && modulus.is_finite()) {
            let expected = "moduli that a series of terms above zero has";
            return Err(Error::expected("table", expected, "others").of_kind(ErrorKind::Infeasible));
        }
        let left =
            |(row, value): &(Vec<f64>, f64)| row.iter().zip(&parts).map(|(a, part)| a * part).sum::<f64>() - value;
        let squares: f64 = rows.iter().map(|row| left(row).powi(2)).sum();
        let terms = times.iter().zip(&parts[1..]).map(|(time, part)| [part / modulus, *time]);
        let terms = terms.filter(|[share, _]| *share > NONE).collect();
        Ok(FittedSeries { terms, modulus, error: (squares / places.len() as f64).sqrt() })
    }

    /// The rows of the least squares, each with its value, relative to the size of the modulus.
    fn rows(&self, places: &[f64], times: &[f64]) -> Vec<(Vec<f64>, f64)> {
        let row = |size: f64, rest: f64, of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            std::iter::once(rest).chain(times.iter().map(|time| of(*time))).map(|a| a / size).collect()
        };
        match *self {
            ModulusTest::Relaxation { moduli, .. } => {
                places.iter().zip(moduli).map(|(t, g)| (row(*g, 1.0, &|tau| f64::exp(-t / tau)), 1.0)).collect()
            }
            ModulusTest::Frequencies { storage, loss, .. } => {
                let both = |(frequency, (real, imaginary)): (&f64, (&f64, &f64))| {
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
            ModulusTest::Relaxation { times, .. } => ("time", times),
            ModulusTest::Frequencies { frequencies, .. } => ("frequency", frequencies),
        };
        let lists = match *self {
            ModulusTest::Relaxation { moduli, .. } => vec![("modulus", moduli)],
            ModulusTest::Frequencies { storage, loss, .. } => vec![("storage", storage), ("loss", loss)],
        };
        let rises = matches!(self, ModulusTest::Frequencies { .. });
        if places.len() < 3 {
            return Err(Error::expected(name, "three or more", places.len()));
        }
        let is_sound = |x: &f64| range::contains(*x);
        if let Some(found) = places.iter().find(|x| !is_sound(x)) {
            return Err(Error::expected(name, "numbers above zero, from 1e-30 to 1e30", format!("{found:?}")));
        }
        if let Some(pair) = places.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(Error::expected(name, "numbers that rise", format!("{} after {}", pair[1], pair[0])));
        }
        for (key, list) in &lists {
            if list.len() != places.len() {
                return Err(Error::expected(*key, format!("{} numbers", places.len()), list.len()));
            }
            if let Some(found) = list.iter().find(|x| !(is_sound(x) || *key == "loss" && **x == 0.0)) {
                return Err(Error::expected(
                    *key,
                    "numbers of Pa above zero, from 1e-30 to 1e30",
                    format!("{found:?}"),
                ));
            }
        }
        let (key, list) = lists[0];
        let largest = list.iter().copied().fold(0.0, f64::max);
        let wrong = |pair: &&[f64]| if rises { pair[0] - pair[1] } else { pair[1] - pair[0] } > NOISE * largest;
        if let Some(pair) = list.windows(2).find(wrong) {
            let expected = if rises { "moduli that rise with frequency" } else { "moduli that fall with time" };
            return Err(Error::expected(key, expected, format!("{} after {}", pair[1], pair[0])));
        }
        let ends = [places[0], places[places.len() - 1]];
        Ok((places, if rises { [1.0 / (TAU * ends[1]), 1.0 / (TAU * ends[0])] } else { ends }))
    }
}
