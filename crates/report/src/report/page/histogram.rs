//! The distribution of the constants of a network.

use super::record::HistogramRecord;
use crate::element::SpringKind;
use crate::model::Network;

/// Intervals of a histogram.
const INTERVALS: usize = 48;
/// The share of springs at each end that may lie outside, where they lie far out: a single far spring would leave the others one interval.
const OUTSIDE: f64 = 0.01;

/// The constants of the springs of a kind.
pub(in crate::report) fn constants_of(network: &Network, kind: SpringKind) -> impl Iterator<Item = f64> {
    let lengths = network.lengths.iter().filter(move |_| kind == SpringKind::Length).map(|spring| spring.constant);
    lengths.chain(network.others.iter().filter(move |spring| spring.kind == kind).map(|spring| spring.constant))
}

impl HistogramRecord {
    /// One for each kind of spring of the network.
    pub fn all(network: &Network) -> Vec<HistogramRecord> {
        let constants = |kind| constants_of(network, kind).filter(|constant| constant.is_finite()).collect();
        SpringKind::all().filter_map(|kind| HistogramRecord::of(kind, constants(kind))).collect()
    }

    fn of(kind: SpringKind, mut constants: Vec<f64>) -> Option<HistogramRecord> {
        constants.sort_unstable_by(f64::total_cmp);
        let (least, largest) = (*constants.first()?, *constants.last()?);
        let skipped = (OUTSIDE * constants.len() as f64) as usize;
        let inner = [constants[skipped], constants[constants.len() - 1 - skipped]];
        let is_far = largest - least > 3.0 * (inner[1] - inner[0]);
        let [first, last] = if is_far && inner[0] < inner[1] { inner } else { [least, largest] };
        // Where nearly all are equal, an interval has a width all the same.
        let span = (last - first).max(1e-6 * first.abs().max(last.abs())).max(f64::MIN_POSITIVE);
        // The largest constant belongs to the last interval, and not to one beyond.
        let width = span * (1.0 + 1e-9) / INTERVALS as f64;
        let mut record = HistogramRecord {
            kind: kind.name().into(),
            unit: kind.properties().unit.into(),
            range: [least, largest],
            first,
            width,
            counts: vec![0; INTERVALS],
            outside: [0; 2],
        };
        for constant in constants {
            match ((constant - first) / width).floor() {
                place if place < 0.0 => record.outside[0] += 1,
                place if place >= INTERVALS as f64 => record.outside[1] += 1,
                place => record.counts[place as usize] += 1,
            }
        }
        Some(record)
    }
}
