//! What the springs of a network measure, each measure once.

use super::record::{MeasureKind, MeasureRecord, ShareRecord, TermRecord};
use crate::element::{Tabulation, coordinate_names};
use crate::model::Network;
use crate::springs::{Measure, Turns};
use std::collections::HashMap;
use std::sync::Arc;

/// The measures of a network, and the place of that of each spring in the list.
pub struct Measures {
    /// The measures.
    pub records: Vec<MeasureRecord>,
    /// `[springs that are not on lengths alone]`.
    pub places: Vec<u32>,
}

/// What makes measures equal: shared tables and expressions.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Identity {
    Cell(usize),
    Point(usize, u32),
    Shared(usize),
    Hinge,
}

impl Measures {
    /// The first measure is the length.
    pub fn of(network: &Network) -> Measures {
        let mut records = vec![plain(MeasureKind::Length)];
        let mut known: HashMap<Identity, usize> = HashMap::new();
        // Neighbours mostly measure the same.
        let mut last: Option<(Identity, usize)> = None;
        let place = |spring: &crate::model::MeasureSpring| {
            let next = records.len();
            let place = match identity(&spring.measure) {
                Some(identity) => match &last {
                    Some((same, place)) if *same == identity => *place,
                    _ => {
                        let place = *known.entry(identity).or_insert(next);
                        last = Some((identity, place));
                        place
                    }
                },
                None if matches!(spring.measure, Measure::Length) => 0,
                None => next,
            };
            if place == next {
                records.push(record(&spring.measure, spring.points.len(), network.dimension));
            }
            place as u32
        };
        let places = network.others.iter().map(place).collect();
        Measures { records, places }
    }
}

fn identity(measure: &Measure) -> Option<Identity> {
    match measure {
        Measure::Turns(turns) if **turns == Turns::of_hinge() => Some(Identity::Hinge),
        Measure::Length | Measure::Patch(_) | Measure::Turns(_) | Measure::Squares(_) => None,
        Measure::Content(element) => Some(Identity::Cell(Arc::as_ptr(element) as usize)),
        Measure::PointContent(element, q) => Some(Identity::Point(Arc::as_ptr(element) as usize, *q)),
        Measure::Span(table) => Some(Identity::Shared(Arc::as_ptr(table) as usize)),
        Measure::Function(function) => Some(Identity::Shared(Arc::as_ptr(function) as usize)),
    }
}

fn plain(kind: MeasureKind) -> MeasureRecord {
    MeasureRecord { kind, element: None, terms: Vec::new(), cells: Vec::new(), expression: None }
}

fn record(measure: &Measure, points: usize, dimension: usize) -> MeasureRecord {
    let whole = || vec![ShareRecord { nodes: (0..points).collect(), share: 1.0 }];
    let content = |element: Option<&String>, terms: Vec<TermRecord>, cells: Vec<ShareRecord>| {
        let element = element.cloned();
        MeasureRecord { element, terms, cells, ..plain(MeasureKind::Content) }
    };
    match measure {
        Measure::Length => plain(MeasureKind::Length),
        Measure::Content(element) => content(Some(&element.name), cell_terms(&element.tabulation), whole()),
        Measure::PointContent(element, q) => {
            let (table, q) = (&element.tabulation, *q as usize);
            content(Some(&element.name), vec![point_term(table, q)], whole())
        }
        Measure::Span(table) => content(None, vec![term(table, 0, table.point_weight(0))], whole()),
        Measure::Patch(patch) => {
            let share = |(nodes, share): &(Vec<usize>, f64)| ShareRecord { nodes: nodes.clone(), share: *share };
            let element = &patch.element;
            content(Some(&element.name), cell_terms(&element.tabulation), patch.cells.iter().map(share).collect())
        }
        Measure::Turns(turns) => {
            let turn = |(places, share): ([usize; 4], f64)| ShareRecord { nodes: places.to_vec(), share };
            MeasureRecord { cells: turns.iter().map(turn).collect(), ..plain(MeasureKind::Turn) }
        }
        Measure::Squares(squares) => {
            let square = |(places, share): ([usize; 2], f64)| ShareRecord { nodes: places.to_vec(), share };
            MeasureRecord { cells: squares.iter().map(square).collect(), ..plain(MeasureKind::Squares) }
        }
        Measure::Function(function) => {
            let names = coordinate_names(points, dimension);
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            MeasureRecord { expression: Some(function.text(&names)), ..plain(MeasureKind::Expression) }
        }
    }
}

/// The terms of the content of a whole cell.
pub fn cell_terms(table: &Tabulation) -> Vec<TermRecord> {
    let weights = table.weights.iter().enumerate();
    // A single point may have its weight in the other rule.
    match table.points() {
        1 => vec![point_term(table, 0)],
        _ => weights.filter(|(_, w)| **w != 0.0).map(|(q, w)| term(table, q, *w)).collect(),
    }
}

/// The term of one point alone.
pub(super) fn point_term(table: &Tabulation, q: usize) -> TermRecord {
    term(table, q, table.point_weight(q))
}

fn term(table: &Tabulation, q: usize, weight: f64) -> TermRecord {
    let size = table.nodes * table.dimension;
    let rows = table.gradients[q * size..(q + 1) * size].chunks_exact(table.dimension);
    TermRecord { weight, gradients: rows.map(<[f64]>::to_vec).collect() }
}
