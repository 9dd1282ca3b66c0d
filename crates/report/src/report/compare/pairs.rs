//! Methods in pairs, and their ranks.

use crate::order::{distinct, grouped};
use crate::study::statistics::{Interval, Paired, Verdict, adjust, mean_ranks, median, ratio_interval};
use crate::study::{CaseRecord, MethodRecord};
use serde::Serialize;
use std::collections::BTreeMap;

/// Two times tie if they differ by less than this factor: other work on the machine changes them by as much.
const SAME_TIME: f64 = 1.1;
/// Quantities that are figures of merit: the smaller the better.
pub(super) const MERITS: [&str; 3] = ["spectral", "frobenius", "e_rms"];
/// Smaller errors are those of rounding, which are no better or worse than each other; of e_rms in percent.
const ROUNDING: f64 = 1e-12;
/// With more fits each is compared with the first alone.
// Forty fits are 780 pairs. Holm's correction multiplies the least probability by their number, beyond which hardly a pair could be
// told apart.
const MOST: usize = 40;

/// Two methods on the same cases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// The quantity, or `seconds` and what was timed.
    pub quantity: String,
    /// The first method.
    pub first: String,
    /// The second method.
    pub second: String,
    /// The figures; of times a case is one figure.
    #[serde(flatten)]
    pub paired: Paired,
    /// The probability after Holm's correction for all pairs of the quantity; of times of few cases absent.
    pub adjusted: Option<f64>,
    /// The better method, or a tie.
    pub verdict: Verdict,
}

/// The rank of a method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rank {
    /// The quantity.
    pub quantity: String,
    /// The method.
    pub fit: String,
    /// The mean of its ranks, by the median, in the cases in which all methods with figures have one; absent where there is no such case, or the method has none.
    pub rank: Option<f64>,
    /// The number of these cases.
    pub cases: usize,
    /// The number of cases in which some method has a figure.
    pub of: usize,
}

/// The names of the fits, in the order in which they appear.
pub fn fits<'a>(records: impl IntoIterator<Item = &'a CaseRecord>) -> Vec<&'a str> {
    distinct(records.into_iter().flat_map(|record| &record.methods).map(|method| method.fit.as_str()))
}

/// The method of this name on a case, if it has figures there.
pub fn method<'a>(record: &'a CaseRecord, fit: &str) -> Option<&'a MethodRecord> {
    record.methods.iter().find(|method| method.fit == fit)
}

/// All pairs of methods, for each figure of merit and each time.
pub fn pairs(records: &[CaseRecord]) -> Vec<Pair> {
    let names = fits(records);
    let couples: Vec<(&str, &str)> = match names.len() {
        count if count > MOST => names[1..].iter().map(|name| (names[0], *name)).collect(),
        count => {
            (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))).map(|(i, j)| (names[i], names[j])).collect()
        }
    };
    let mut all = Vec::new();
    for quantity in MERITS {
        let found: Vec<((&str, &str), Paired)> =
            couples.iter().filter_map(|pair| Some((*pair, of_values(records, quantity, *pair)?))).collect();
        let made = found.len();
        let adjusted = adjust(&found.iter().map(|(_, paired)| paired.p).collect::<Vec<_>>());
        all.extend(found.into_iter().zip(adjusted).map(|(((first, second), paired), adjusted)| Pair {
            quantity: quantity.into(),
            first: first.into(),
            second: second.into(),
            paired,
            adjusted: Some(adjusted),
            verdict: paired.verdict(adjusted, made),
        }));
    }
    let kinds: BTreeMap<&str, ()> =
        records.iter().flat_map(|r| &r.methods).flat_map(|m| m.times.keys()).map(|kind| (kind.as_str(), ())).collect();
    for kind in kinds.keys() {
        all.extend(couples.iter().filter_map(|pair| of_times(records, kind, *pair)));
    }
    all
}

fn of_values(records: &[CaseRecord], quantity: &str, (first, second): (&str, &str)) -> Option<Paired> {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for same in of_same_shapes(records) {
        let lists = |record: &&CaseRecord| {
            let [one, other] = [first, second].map(|fit| Some(method(record, fit)?.values.get(quantity)?.clone()));
            Some([one?, other?])
        };
        let lists: Vec<[Vec<Option<f64>>; 2]> = same.iter().filter_map(lists).collect();
        // A shape counts where both methods have a figure in each of its cases.
        let [one, other] = [0, 1].map(|of| means(lists.iter().map(|pair| &pair[of])));
        for (one, other) in one.into_iter().zip(other) {
            if let (Some(one), Some(other)) = (one, other) {
                a.push(one);
                b.push(other);
            }
        }
    }
    Paired::of(&a, &b)
}

/// The cases in groups that have the same shapes, loads or stretches: those that differ in Poisson's ratio alone. What is found on the same shape at
/// several ratios is nearly the same, and no independent figure.
pub fn of_same_shapes<'a>(records: impl IntoIterator<Item = &'a CaseRecord>) -> Vec<Vec<&'a CaseRecord>> {
    let of_settings = |record: &'a CaseRecord| {
        let mut settings = record.settings.clone();
        settings.remove("poisson");
        (settings, record)
    };
    grouped(records.into_iter().map(of_settings)).into_iter().map(|(_, group)| group).collect()
}

/// The geometric mean of the figures of each shape over all cases; none where a case has no figure.
pub fn means<'a>(cases: impl IntoIterator<Item = &'a Vec<Option<f64>>>) -> Vec<Option<f64>> {
    let cases: Vec<_> = cases.into_iter().collect();
    let shapes = cases.iter().map(|case| case.len()).max().unwrap_or(0);
    let mean = |shape: usize| {
        // An error of zero has no logarithm: the bound of rounding takes its place.
        let logarithms = cases.iter().map(|case| Some(case.get(shape).copied().flatten()?.max(ROUNDING).ln()));
        let sum: f64 = logarithms.sum::<Option<f64>>()?;
        Some((sum / cases.len() as f64).exp())
    };
    (0..shapes).map(mean).collect()
}

/// The times of two methods. On each case the medians are apart where the interval of their ratio does not have 1 and they differ by more
/// than [`SAME_TIME`]; over all cases the verdict is that of each of them.
fn of_times(records: &[CaseRecord], kind: &str, (first, second): (&str, &str)) -> Option<Pair> {
    let (mut ratios, mut interval, mut verdicts) = (Vec::new(), None::<Interval>, Vec::new());
    for record in records {
        let lists = [first, second].map(|fit| method(record, fit).and_then(|method| method.times.get(kind)));
        let [Some(a), Some(b)] = lists else { continue };
        let (ratio, own) = (median(a) / median(b), ratio_interval(a, b));
        // A clock that has not moved gives zero over zero.
        if !ratio.is_finite() {
            continue;
        }
        ratios.push(ratio);
        let joined = |known: Interval| Interval { low: known.low.min(own.low), high: known.high.max(own.high) };
        interval = Some(interval.map_or(own, joined));
        verdicts.push(match ratio {
            _ if own.has(1.0) || (1.0 / SAME_TIME..SAME_TIME).contains(&ratio) => Verdict::Tie,
            ratio if ratio < 1.0 => Verdict::First,
            _ => Verdict::Second,
        });
    }
    let verdict = *verdicts.first()?;
    let count = |wanted| verdicts.iter().filter(|verdict| **verdict == wanted).count();
    let paired = Paired {
        count: ratios.len(),
        wins: count(Verdict::First),
        losses: count(Verdict::Second),
        ratio: median(&ratios),
        interval: interval?,
        p: f64::NAN,
    };
    // Times of different cases are not of one distribution: where cases disagree nothing is said.
    let verdict = if verdicts.iter().all(|other| *other == verdict) { verdict } else { Verdict::Tie };
    let quantity = format!("seconds {kind}");
    Some(Pair { quantity, first: first.into(), second: second.into(), paired, adjusted: None, verdict })
}

/// The mean ranks by each figure of merit, over the cases in which all methods can be ranked.
pub fn ranks(records: &[CaseRecord]) -> Vec<Rank> {
    let names = fits(records);
    let mut all = Vec::new();
    for quantity in MERITS {
        let has = |record: &&CaseRecord| record.methods.iter().any(|method| method.values.contains_key(quantity));
        let own: Vec<&CaseRecord> = records.iter().filter(has).collect();
        let middle = |record: &CaseRecord, name: &str| {
            let known: Vec<f64> = method(record, name)?.values.get(quantity)?.iter().copied().flatten().collect();
            Some(median(&known)).filter(|median| median.is_finite())
        };
        let measured: Vec<&str> =
            names.iter().copied().filter(|name| own.iter().any(|record| middle(record, name).is_some())).collect();
        // A method without a figure where others fail would be ranked by the easy cases alone.
        let is_complete = |record: &&&CaseRecord| measured.iter().all(|name| middle(record, name).is_some());
        let cases: Vec<&CaseRecord> = own.iter().filter(is_complete).copied().collect();
        let figures: Vec<Vec<Option<f64>>> =
            measured.iter().map(|name| cases.iter().map(|record| middle(record, name)).collect()).collect();
        let rank = |(name, rank): (&&str, Option<f64>)| Rank {
            quantity: quantity.into(),
            fit: name.to_string(),
            rank,
            cases: cases.len(),
            of: own.len(),
        };
        all.extend(measured.iter().zip(mean_ranks(&figures)).map(rank));
    }
    all
}
