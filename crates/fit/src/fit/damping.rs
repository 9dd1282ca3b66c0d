//! Damping that was measured: a Prony series that has it, or Rayleigh's two numbers, with the error that they leave.
//!
//! Theory: page *Springs that forget* of the book.

use super::constrained::solve_nonnegative;
use super::normal::Normal;
use crate::error::{Error, ErrorKind, Result};
use crate::range;
use nalgebra::Complex;
use std::f64::consts::{FRAC_PI_2, TAU};

/// What a measurement of damping gives at each frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DampingKind {
    /// Loss factors η, loss modulus over storage modulus, of vibrations that are kept up; the damping ratio is η/2.
    LossFactor,
    /// Damping ratios ζ of free vibrations, as a share of critical damping.
    Ratio,
    /// Logarithmic decrements δ of free vibrations, from one period to the next; `ζ = δ/√(4π² + δ²)`.
    Decrement,
}

/// Measured damping over a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingTest<'a> {
    /// What the values are.
    pub kind: DampingKind,
    /// The values: one for each frequency, or one that is taken as constant over the band.
    pub values: &'a [f64],
    /// The frequencies of the vibrations as they are seen, Hz, rising; none with one value for the whole band.
    pub frequencies: &'a [f64],
    /// The band over which damping is wanted, Hz; without one it is from the first frequency to the last.
    pub band: Option<[f64; 2]>,
}

/// How far a fit is from the damping that was measured, over a band. Between frequencies that were measured, damping is on a line over the
/// logarithm of the frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingError {
    /// The band, Hz.
    pub band: [f64; 2],
    /// The largest difference of the damping ratio.
    pub largest: f64,
    /// The root mean square of the difference, even over the logarithm of the frequency.
    pub rms: f64,
    /// The root mean square of the damping ratio itself.
    pub size: f64,
}

/// A Prony series that has measured damping.
#[derive(Debug, Clone, PartialEq)]
pub struct DampedSeries {
    /// The shares of the modulus that relax, above zero, and their times, s.
    pub terms: Vec<[f64; 2]>,
    /// The error that it leaves.
    pub error: DampingError,
}

/// Rayleigh's damping `C = α M + β K` that is nearest to measured damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedRayleigh {
    /// α, 1/s, and β, s, both zero or more.
    pub numbers: [f64; 2],
    /// The error that they leave.
    pub error: DampingError,
}

/// A free vibration that dies away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedDecay {
    /// The damping ratio.
    pub ratio: f64,
    /// The root mean square of the differences of `ln A` from a line.
    pub error: f64,
}

/// Frequencies in a decade at which damping is compared, at least so many in all. The damping of a Maxwell element falls by half in half a decade.
// A peak in the middle between two of them is seen to 0.2 %: `2 x/(1 + x²)` is 0.998 at `x = 10^(1/40)`.
const PER_DECADE: f64 = 20.0;
/// Relaxation times in a decade of the band, as many as measured moduli have. They begin and end one time beyond the band: a Maxwell element damps
/// both sides of its frequency alike, and the ends of the band would else lack the damping of one side.
const TIMES: f64 = 2.0;
/// A share of the modulus below it is rounding.
const NONE: f64 = 1e-9;
/// Steps of Gauss and Newton at most; they end when the sum of squares falls no more. Measured: 4 to 12.
const STEPS: usize = 100;
/// Halves of a step at most: a share of 2⁻²⁹ of a step lowers the linearised sum of squares by 4e-9 of itself at most.
const HALVES: usize = 30;
/// The fall of the sum of squares that is rounding: a hundred squares are rounded by up to 1e-14 of their sum.
const FALL: f64 = 1e-13;

/// Damping at one frequency.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// The vibration is `e^(s t)`, 1/s.
    s: Complex<f64>,
    /// The damping ratio there.
    ratio: f64,
    is_free: bool,
}

impl Place {
    /// Of the frequency f, Hz, with the value of a loss factor or of a ratio.
    ///
    /// A free vibration that is seen at `ω_d` is `e^(s t)` with `s = −ζ ω₀ + i ω_d`, `ω₀ = ω_d/√(1 − ζ²)`.
    fn new(frequency: f64, ratio: f64, is_free: bool) -> Place {
        let seen = TAU * frequency;
        let s = match is_free {
            true => Complex::new(-ratio * seen / (1.0 - ratio * ratio).sqrt(), seen),
            false => Complex::new(0.0, seen),
        };
        Place { s, ratio, is_free }
    }

    /// The damping ratio of a modulus `f = |f| e^(iφ)` at s, and its slope over φ.
    ///
    /// Kept up, the loss factor is `tan φ = 2 ζ`. A mass on a free spring has `m s² + k f(s) = 0`, so that f has the angle `2 arg s − π`, and with
    /// `arg s = π − arccos ζ` it is `ζ = sin(φ/2)`.
    fn ratio_of(&self, modulus: Complex<f64>) -> [f64; 2] {
        let angle = modulus.arg();
        match self.is_free {
            true => [(angle / 2.0).sin(), (angle / 2.0).cos() / 2.0],
            // A series has a storage modulus above zero, so that the angle is below π/2.
            false => [angle.tan() / 2.0, 1.0 / (2.0 * angle.cos().powi(2))],
        }
    }
}

impl DampingTest<'_> {
    /// Fits `G(s) = 1 + Σ c_i s τ_i/(1 + s τ_i)`, `c_i ≥ 0`, of the least squares of the differences of the damping ratio over the band: of its phase
    /// at `s = iω` where damping was measured by loss factors, and at the s of free vibrations where it was by their decay. Then `g_i = c_i/(1 + Σ c_i)`.
    ///
    /// # Errors
    /// A value, a frequency or the band is out of its range, frequencies do not rise, or one value has no band.
    pub fn series(&self) -> Result<DampedSeries> {
        let curve = Curve::of(self)?;
        let [first, last] = curve.band;
        if !(first < last) {
            return Err(needs_band("a Prony series needs damping over a band of frequencies"));
        }
        let places = curve.even();
        let (slowest, fastest) = (1.0 / (TAU * first), 1.0 / (TAU * last));
        let count = ((last / first).log10() * TIMES).ceil().max(1.0) as i32;
        let ratio = (slowest / fastest).powf(1.0 / f64::from(count));
        let times: Vec<f64> = (-1..=count + 1).map(|i| fastest * ratio.powi(i)).collect();
        let parts: Vec<Vec<Complex<f64>>> = places
            .iter()
            .map(|place| times.iter().map(|time| place.s * *time / (place.s * *time + 1.0)).collect())
            .collect();
        let shares = nearest(&places, &parts);
        let whole: f64 = 1.0 + shares.iter().sum::<f64>();
        let terms = shares.iter().zip(&times).map(|(c, time)| [c / whole, *time]).filter(|[g, _]| *g > NONE).collect();
        let left: Vec<f64> = places.iter().zip(&parts).map(|(place, parts)| off(place, parts, &shares)).collect();
        Ok(DampedSeries { terms, error: curve.error(&places, &left) })
    }

    /// Fits `ζ = α/(2 ω₀) + β ω₀/2`, `α, β ≥ 0`, of the least squares of the differences of the damping ratio: at the frequencies that were measured, or
    /// over the band if there is one. ω₀ is `|s|`, the frequency without damping, so that free vibrations are met exactly.
    ///
    /// # Errors
    /// It fails as [`DampingTest::series`] does.
    pub fn rayleigh(&self) -> Result<FittedRayleigh> {
        let curve = Curve::of(self)?;
        let [first, last] = curve.band;
        if !(first < last) {
            return Err(needs_band("one frequency gives one condition, and Rayleigh's damping has two numbers"));
        }
        let even = curve.even();
        let at = if self.band.is_some() { &even } else { &curve.measured };
        let row = |place: &Place| [0.5 / place.s.norm(), 0.5 * place.s.norm()];
        let rows = at.iter().map(|place| (row(place).to_vec(), place.ratio));
        let found = least_squares(2, rows);
        let left: Vec<f64> = even
            .iter()
            .map(|place| row(place).iter().zip(&found).map(|(a, number)| a * number).sum::<f64>() - place.ratio)
            .collect();
        Ok(FittedRayleigh { numbers: [found[0], found[1]], error: curve.error(&even, &left) })
    }
}

/// The shares c of the least squares: steps of Gauss and Newton under `c ≥ 0`, halved until the sum of squares falls.
fn nearest(places: &[Place], parts: &[Vec<Complex<f64>>]) -> Vec<f64> {
    let count = parts.first().map_or(0, Vec::len);
    let squares =
        |c: &[f64]| -> f64 { places.iter().zip(parts).map(|(place, parts)| off(place, parts, c).powi(2)).sum() };
    let mut shares = vec![0.0; count];
    let mut least = squares(&shares);
    for _ in 0..STEPS {
        let row = |(place, parts): (&Place, &Vec<Complex<f64>>)| {
            let modulus = modulus(parts, &shares);
            let [ratio, slope] = place.ratio_of(modulus);
            let row: Vec<f64> = parts.iter().map(|part| slope * (part / modulus).im).collect();
            let own: f64 = row.iter().zip(&shares).map(|(a, c)| a * c).sum();
            (row, place.ratio - ratio + own)
        };
        let next = least_squares(count, places.iter().zip(parts).map(row));
        let between = |share: f64| -> Vec<f64> {
            shares.iter().zip(&next).map(|(now, next)| now + share * (next - now)).collect()
        };
        let steps = (0..HALVES).map(|half| between(0.5f64.powi(half as i32)));
        let Some((lower, found)) = steps.map(|c| (squares(&c), c)).find(|(sum, _)| *sum < least * (1.0 - FALL)) else {
            break;
        };
        (least, shares) = (lower, found);
    }
    shares
}

/// `1 + Σ c_i s τ_i/(1 + s τ_i)`.
fn modulus(parts: &[Complex<f64>], shares: &[f64]) -> Complex<f64> {
    parts.iter().zip(shares).map(|(part, c)| part * *c).sum::<Complex<f64>>() + 1.0
}

/// How far the damping ratio is above that which was measured.
fn off(place: &Place, parts: &[Complex<f64>], shares: &[f64]) -> f64 {
    place.ratio_of(modulus(parts, shares))[0] - place.ratio
}

/// `min Σ (row·x − value)²`, `x ≥ 0`.
pub(super) fn least_squares(count: usize, rows: impl Iterator<Item = (impl AsRef<[f64]>, f64)>) -> Vec<f64> {
    let (mut gram, mut rhs) = (vec![0.0; count * count], vec![0.0; count]);
    for (row, value) in rows {
        let row = row.as_ref();
        for (i, a) in row.iter().enumerate() {
            rhs[i] += a * value;
            row.iter().enumerate().for_each(|(j, b)| gram[i * count + j] += a * b);
        }
    }
    solve_nonnegative(&Normal::new(gram, rhs)).0
}

/// Damping over the logarithm of the frequency.
struct Curve {
    band: [f64; 2],
    /// What was measured, at rising frequencies; of one value, that at both ends of the band.
    measured: Vec<Place>,
    frequencies: Vec<f64>,
    is_free: bool,
}

impl Curve {
    fn of(test: &DampingTest) -> Result<Curve> {
        let key = test.kind.name();
        let DampingTest { kind, values, frequencies, band } = *test;
        if values.is_empty() {
            return Err(Error::expected(key, "one number or more", "none"));
        }
        if let Some(found) = values.iter().find(|value| !(**value == 0.0 || range::contains(**value))) {
            let problem = match *found < 0.0 {
                true => "0 or more: what is damped loses energy",
                false => "0, or numbers from 1e-30 to 1e30",
            };
            return Err(Error::expected(key, problem, format!("{found:?}")));
        }
        let ratio = |value: f64| match kind {
            DampingKind::LossFactor => value / 2.0,
            DampingKind::Ratio => value,
            DampingKind::Decrement => value / TAU.hypot(value),
        };
        let is_free = kind != DampingKind::LossFactor;
        if let Some(found) = values.iter().find(|value| is_free && ratio(**value) >= 1.0) {
            return Err(Error::expected(
                key,
                "damping ratios below 1: from 1 on nothing vibrates",
                format!("{found:?}"),
            ));
        }
        if values.iter().all(|value| *value == 0.0) {
            return Err(Error::expected(key, "some damping above 0", "none"));
        }
        if let Some(found) = frequencies.iter().find(|f| !range::contains(**f)) {
            return Err(Error::expected("frequency", "numbers of Hz from 1e-30 to 1e30", format!("{found:?}")));
        }
        check_rising("frequency", frequencies)?;
        if let Some([from, to]) = band
            && !(range::contains(from) && range::contains(to) && from < to)
        {
            let expected = "two frequencies in Hz above 0, the second above the first";
            return Err(Error::expected("band", expected, format!("{from:?} and {to:?}")));
        }
        let is_one = values.len() == 1 && frequencies.len() <= 1;
        if !is_one && values.len() != frequencies.len() {
            let expected = format!("{} numbers, one for each frequency", frequencies.len());
            return Err(Error::expected(key, expected, values.len()));
        }
        if let (Some([from, to]), [first, .., last]) = (band, frequencies)
            && !(from >= *first && to <= *last)
        {
            let expected = format!("frequencies from {first} to {last} Hz, where damping was measured");
            return Err(Error::expected("band", expected, format!("{from:?} and {to:?}")));
        }
        if let (Some([from, to]), [only]) = (band, frequencies)
            && !(from <= *only && *only <= to)
        {
            let expected = format!("frequencies around {only} Hz, where damping was measured");
            return Err(Error::expected("band", expected, format!("{from:?} and {to:?}")));
        }
        let (frequencies, ratios): (Vec<f64>, Vec<f64>) = match (band, is_one) {
            (Some(band), true) => (band.to_vec(), vec![ratio(values[0]); 2]),
            (None, true) if frequencies.is_empty() => {
                let expected = "a band of frequencies, over which the one number is taken as constant";
                return Err(Error::expected("band", expected, "none"));
            }
            _ => (frequencies.to_vec(), values.iter().map(|value| ratio(*value)).collect()),
        };
        let ends = [frequencies[0], frequencies[frequencies.len() - 1]];
        let places = frequencies.iter().zip(&ratios).map(|(f, ratio)| Place::new(*f, *ratio, is_free));
        Ok(Curve { band: band.unwrap_or(ends), measured: places.collect(), frequencies, is_free })
    }

    /// At frequencies that are even over the logarithm of the band, with both ends.
    fn even(&self) -> Vec<Place> {
        let [from, to] = self.band;
        let count = ((to / from).log10() * PER_DECADE).ceil().max(PER_DECADE) as usize;
        let place = |i: usize| {
            let frequency = if i == count { to } else { from * (to / from).powf(i as f64 / count as f64) };
            Place::new(frequency, self.ratio_at(frequency), self.is_free)
        };
        (0..=count).map(place).collect()
    }

    fn ratio_at(&self, frequency: f64) -> f64 {
        let above = self.frequencies.partition_point(|f| *f < frequency).clamp(1, self.frequencies.len() - 1);
        let [low, high] = [above - 1, above].map(|i| (self.frequencies[i].ln(), self.measured[i].ratio));
        let share = ((frequency.ln() - low.0) / (high.0 - low.0)).clamp(0.0, 1.0);
        low.1 + share * (high.1 - low.1)
    }

    fn error(&self, places: &[Place], left: &[f64]) -> DampingError {
        let rms =
            |values: &mut dyn Iterator<Item = f64>| (values.map(|x| x * x).sum::<f64>() / places.len() as f64).sqrt();
        DampingError {
            band: self.band,
            largest: left.iter().fold(0.0, |largest, x| largest.max(x.abs())),
            rms: rms(&mut left.iter().copied()),
            size: rms(&mut places.iter().map(|place| place.ratio)),
        }
    }
}

// The keys of a scene that have the values.
crate::named!(DampingKind { "loss_factor" => LossFactor, "ratio" => Ratio, "decrement" => Decrement });

/// Checks that each number of a list is above the one before.
pub(super) fn check_rising(key: &str, list: &[f64]) -> Result<()> {
    match list.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(Error::expected(key, "numbers that rise", format!("{} after {}", pair[1], pair[0]))),
        None => Ok(()),
    }
}

fn needs_band(why: &str) -> Error {
    let expected = "two frequencies or more, or a band of frequencies over which the one number is taken as constant";
    Error::expected("band", expected, "none").followed_by(format!(": {why}"))
}

/// The damping ratio of a free vibration of `frequency`, Hz, whose amplitude A, the size of its peaks, was read at rising times, s: the line of least
/// squares through `ln A` falls with `ζ ω₀`, and the vibration is seen with `ω₀ √(1 − ζ²)`.
///
/// # Errors
/// There are fewer than two rows, lists differ in length, times do not rise, an amplitude is not above zero, or amplitudes do not fall.
pub fn ratio_of_decay(times: &[f64], amplitudes: &[f64], frequency: f64) -> Result<FittedDecay> {
    if times.len() < 2 {
        return Err(Error::expected("time", "two times or more", times.len()));
    }
    if amplitudes.len() != times.len() {
        return Err(Error::expected("amplitude", format!("{} numbers", times.len()), amplitudes.len()));
    }
    if let Some(found) = times.iter().find(|t| !(**t == 0.0 || range::contains(**t))) {
        return Err(Error::expected("time", "numbers of s from 0 to 1e30", format!("{found:?}")));
    }
    check_rising("time", times)?;
    if let Some(found) = amplitudes.iter().find(|a| !range::contains(**a)) {
        let expected = "sizes of peaks above 0, from 1e-30 to 1e30";
        return Err(Error::expected("amplitude", expected, format!("{found:?}")));
    }
    range::positive("frequency", frequency, "Hz")?;
    let count = times.len() as f64;
    let logarithms: Vec<f64> = amplitudes.iter().map(|a| a.ln()).collect();
    let [middle, height] = [times, &logarithms].map(|list| list.iter().sum::<f64>() / count);
    let both = times.iter().zip(&logarithms).map(|(t, a)| (t - middle, a - height));
    let [across, along] = both.clone().fold([0.0; 2], |[across, along], (t, a)| [across + t * a, along + t * t]);
    let slope = across / along;
    if !(slope < 0.0) {
        let expected = "amplitudes that fall with time";
        let found = format!("{} at first and {} at last", amplitudes[0], amplitudes[amplitudes.len() - 1]);
        return Err(Error::expected("amplitude", expected, found).of_kind(ErrorKind::Infeasible));
    }
    let squares: f64 = both.map(|(t, a)| (a - slope * t).powi(2)).sum();
    let angle = (-slope).atan2(TAU * frequency);
    let ratio = angle.sin();
    if !(angle < FRAC_PI_2 && ratio < 1.0) {
        return Err(Error::expected("amplitude", "a vibration that dies away in more than a period", "a faster one"));
    }
    Ok(FittedDecay { ratio, error: (squares / count).sqrt() })
}
