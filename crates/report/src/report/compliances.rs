//! The constants of a network as engines of position-based dynamics take them.

use super::page::constants_of;
use super::table::Digits::Significant;
use super::table::{Cell, Column, Table};
use crate::element::SpringKind;
use crate::model::Network;

/// One row for each kind of spring, with the least, the median and the largest compliance 1/k of the springs whose constant k is above zero:
/// α of C = ℓ − L with the energy C²/(2 α), divided by Δt² in each step of XPBD. Springs with k ≤ 0 have no compliance, and are counted.
pub fn compliances(network: &Network) -> Table {
    let columns = vec![
        Column::words("springs on"),
        Column::numbers("springs"),
        Column::numbers("k <= 0"),
        Column::numbers("least").group("compliance 1/k"),
        Column::numbers("median").group("compliance 1/k"),
        Column::numbers("largest").group("compliance 1/k"),
        Column::words("unit"),
    ];
    let rows = SpringKind::all().filter_map(|kind| row(network, kind));
    Table::new("compliances", "Compliances of the springs", columns, rows)
}

fn row(network: &Network, kind: SpringKind) -> Option<Vec<Cell>> {
    let constants: Vec<f64> = constants_of(network, kind).collect();
    if constants.is_empty() {
        return None;
    }
    let mut compliances: Vec<f64> = constants.iter().filter(|k| **k > 0.0).map(|k| 1.0 / k).collect();
    compliances.sort_unstable_by(f64::total_cmp);
    let at = |place: usize| Cell::number(compliances.get(place).copied(), Significant(4));
    let last = compliances.len().saturating_sub(1);
    let unit = match kind.properties().unit.split_once('/') {
        Some((force, measure)) => format!("{measure}/{force}"),
        None => format!("1/({})", kind.properties().unit),
    };
    let without = constants.len() - compliances.len();
    Some(vec![kind.name().into(), constants.len().into(), without.into(), at(0), at(last / 2), at(last), unit.into()])
}
