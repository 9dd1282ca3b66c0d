//! Springs as arrays, and other numbers for them.

use crate::arrays::{list, matrix};
use crate::error::invalid;
use crate::given_springs::values;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_bodies::model::{MeasureSpring, Network};
use springfit_element::element::{SpringKind, Tabulation, coordinate_names};
use springfit_element::springs::Measure;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The kind, the number of points, the law, the element and the number of the expression.
type GroupKey<'a> = (&'a str, usize, Option<&'a str>, Option<&'a str>, usize);

/// The places of the springs on other measures than lengths, gathered by kind, number of points, element, law and expression.
pub fn groups(network: &Network) -> Vec<Vec<usize>> {
    let mut functions: HashMap<*const (), usize> = HashMap::new();
    let mut lists: BTreeMap<GroupKey, Vec<usize>> = BTreeMap::new();
    for (place, spring) in network.others.iter().enumerate() {
        let law = spring.law.as_deref().map(|own| &own.law.text[..]);
        let next = functions.len() + 1;
        let function = match &spring.measure {
            Measure::Function(function) => *functions.entry(Arc::as_ptr(function).cast()).or_insert(next),
            _ => 0,
        };
        let key = (spring.kind.name(), spring.points.len(), law, element_of(&spring.measure), function);
        lists.entry(key).or_default().push(place);
    }
    lists.into_values().collect()
}

fn element_of(measure: &Measure) -> Option<&str> {
    match measure {
        Measure::Content(element) | Measure::PointContent(element, _) => Some(&element.name),
        Measure::Patch(patch) => Some(&patch.element.name),
        Measure::Length | Measure::Span(_) | Measure::Function(_) | Measure::Turns(_) | Measure::Squares(_) => None,
    }
}

/// Springs of one group.
pub fn record<'py>(py: Python<'py>, springs: &[&MeasureSpring], d: usize) -> PyResult<Bound<'py, PyDict>> {
    let (record, n) = (PyDict::new(py), springs[0].points.len());
    record.set_item("kind", springs[0].kind.name())?;
    record.set_item("unit", SpringKind::properties(springs[0].kind).unit)?;
    let nodes = springs.iter().flat_map(|s| s.points.iter().map(|&p| p as i64)).collect();
    record.set_item("points", matrix(py, nodes, n))?;
    record.set_item("constants", list(py, springs.iter().map(|s| s.constant).collect()))?;
    record.set_item("rest", list(py, springs.iter().map(|s| s.rest).collect()))?;
    if let Some(name) = element_of(&springs[0].measure) {
        record.set_item("element", name)?;
    }
    if let Measure::Function(function) = &springs[0].measure {
        let names = coordinate_names(n, d);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        record.set_item("expression", function.text(&names))?;
    }
    if let Some(law) = &springs[0].law {
        record.set_item("law", &law.law.text)?;
        let parameters = PyDict::new(py);
        for (i, name) in law.law.parameters.iter().enumerate() {
            let values = springs.iter().flat_map(|s| &s.law).map(|own| own.parameters[i]);
            parameters.set_item(name, list(py, values.collect()))?;
        }
        record.set_item("parameters", parameters)?;
    }
    let of_point = |spring: &MeasureSpring| match &spring.measure {
        Measure::PointContent(element, q) => Some((element.tabulation.clone(), *q as usize)),
        Measure::Span(table) => Some((Tabulation::clone(table), 0)),
        _ => None,
    };
    if of_point(springs[0]).is_some() {
        let tables: Vec<_> = springs.iter().filter_map(|spring| of_point(spring)).collect();
        let own = tables.first().map_or(d, |(table, _)| table.dimension);
        let gradients = tables.iter().flat_map(|(t, q)| {
            let size = t.nodes * t.dimension;
            t.gradients[q * size..(q + 1) * size].to_vec()
        });
        record.set_item("gradients", matrix(py, gradients.collect(), n * own))?;
        record.set_item("weights", list(py, tables.iter().map(|(t, q)| t.point_weight(*q)).collect()))?;
    }
    let cells_of = |spring: &MeasureSpring| match &spring.measure {
        Measure::Patch(patch) => Some(patch.cells.clone()),
        Measure::Turns(turns) => Some(turns.iter().map(|(places, weight)| (places.to_vec(), weight)).collect()),
        Measure::Squares(squares) => Some(squares.iter().map(|(places, weight)| (places.to_vec(), weight)).collect()),
        _ => None,
    };
    if cells_of(springs[0]).is_some() {
        record.set_item("cells", springs.iter().filter_map(|spring| cells_of(spring)).collect::<Vec<_>>())?;
    }
    Ok(record)
}

/// Other numbers in place of those of some springs.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Changed<'py> {
    constants: Option<PyReadonlyArray1<'py, f64>>,
    rest: Option<PyReadonlyArray1<'py, f64>>,
    parameters: BTreeMap<String, PyReadonlyArray1<'py, f64>>,
}

/// A network of the same springs with other numbers of those between two points, and of each group of the others.
pub fn changed(
    py: Python,
    network: &Network,
    constants: Option<&PyReadonlyArray1<f64>>,
    rest: Option<&PyReadonlyArray1<f64>>,
    others: &[Changed],
) -> PyResult<Network> {
    let mut own = network.clone();
    let count = own.lengths.len();
    if let Some(given) = constants {
        let values = values(py, "constants", given, count)?;
        own.lengths.iter_mut().zip(values).for_each(|(spring, constant)| spring.constant = constant);
    }
    if let Some(given) = rest {
        let values = values(py, "rest", given, count)?;
        own.lengths.iter_mut().zip(values).for_each(|(spring, rest)| spring.rest = rest);
    }
    if others.is_empty() {
        return Ok(own);
    }
    let groups = groups(network);
    if groups.len() != others.len() {
        return Err(invalid(py, "contents", &format!("a list of {} groups", groups.len()), others.len()));
    }
    for (g, (group, given)) in groups.iter().zip(others).enumerate() {
        let at = |name: &str| format!("contents[{g}].{name}");
        if let Some(array) = &given.rest {
            let values = values(py, &at("rest"), array, group.len())?;
            group.iter().zip(values).for_each(|(&s, rest)| own.others[s].rest = rest);
        }
        if let Some(array) = &given.constants {
            let values = values(py, &at("constants"), array, group.len())?;
            let has_law = own.others[group[0]].law.is_some();
            if has_law && group.iter().zip(&values).any(|(&s, k)| own.others[s].constant != *k) {
                let expected = "none of springs with a law, whose force follows from \"parameters\"";
                return Err(invalid(py, &at("constants"), expected, "other constants"));
            }
            group.iter().zip(values).for_each(|(&s, constant)| own.others[s].constant = constant);
        }
        for (name, array) in &given.parameters {
            let key = at(&format!("parameters.{name}"));
            let law = own.others[group[0]].law.as_ref().map(|own| own.law.clone());
            let place = law.as_ref().and_then(|law| law.parameters.iter().position(|own| own == name));
            let place = place.ok_or_else(|| invalid(py, &key, "a parameter of the law", format!("\"{name}\"")))?;
            let values = values(py, &key, array, group.len())?;
            for (&s, value) in group.iter().zip(values) {
                let spring = &mut own.others[s];
                if let Some(law) = spring.law.as_deref_mut() {
                    law.parameters[place] = value;
                    spring.constant = law.slope(spring.rest, spring.rest);
                }
            }
        }
    }
    Ok(own)
}
