//! The distribution of the constants of a network.

use super::record::HistogramRecord;
use crate::element::SpringKind;
use crate::model::Network;
use crate::study::statistics::Histogram;

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

    fn of(kind: SpringKind, constants: Vec<f64>) -> Option<HistogramRecord> {
        let Histogram { range, first, width, counts, outside } = Histogram::of(constants)?;
        let (kind, unit) = (kind.name().into(), kind.properties().unit.into());
        Some(HistogramRecord { kind, unit, range, first, width, counts, outside })
    }
}
