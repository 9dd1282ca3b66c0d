//! Springs as arrays, and arrays as springs.

use crate::arrays::{list, matrix, places, rows};
use crate::error::{invalid, raised};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::element::{Element, SpringKind, Tabulation, coordinate_names};
use springfit::error::Error;
use springfit::model::{LengthSpring, MeasureSpring, Network, SpringLaw};
use springfit::report::{MeasureKind, MeasureRecord, Measuring, ShareRecord, TermRecord};
use springfit::springs::{Law, Measure, distance};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The places of the springs on other measures than lengths, gathered by kind, number of points, element, law and expression.
pub fn groups(network: &Network) -> Vec<Vec<usize>> {
    let mut functions: HashMap<*const (), usize> = HashMap::new();
    let mut lists: BTreeMap<(&str, usize, Option<&str>, Option<&str>, usize), Vec<usize>> = BTreeMap::new();
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
        Measure::Length | Measure::Span(_) | Measure::Function(_) => None,
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
    if let Measure::Patch(_) = &springs[0].measure {
        let cells = springs.iter().map(|spring| match &spring.measure {
            Measure::Patch(patch) => patch.cells.clone(),
            _ => Vec::new(),
        });
        record.set_item("cells", cells.collect::<Vec<_>>())?;
    }
    Ok(record)
}

/// Springs between two points, as they are given.
pub struct GivenLengths<'a, 'py> {
    pub springs: &'a PyReadonlyArray2<'py, i64>,
    pub constants: &'a PyReadonlyArray1<'py, f64>,
    /// The lengths at rest; those of the springs where the points are, if there are none.
    pub rest: Option<&'a PyReadonlyArray1<'py, f64>>,
}

/// A group of springs on other measures, as [`record`] has it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct GivenGroup<'py> {
    kind: String,
    points: PyReadonlyArray2<'py, i64>,
    constants: PyReadonlyArray1<'py, f64>,
    rest: Option<PyReadonlyArray1<'py, f64>>,
    law: Option<String>,
    parameters: BTreeMap<String, PyReadonlyArray1<'py, f64>>,
    element: Option<String>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    gradients: Option<PyReadonlyArray2<'py, f64>>,
    cells: Option<Vec<Vec<(Vec<usize>, f64)>>>,
    expression: Option<String>,
}

/// The network of these springs on points, `[points × dimension]`, m. `elements` are those that are not shipped.
pub fn network(
    py: Python,
    (points, d): (&[f64], usize),
    lengths: &GivenLengths,
    groups: &[GivenGroup],
    elements: &[Arc<Element>],
) -> PyResult<Network> {
    let count = points.len() / d;
    let mut own = Network { dimension: d, ..Network::default() };
    let ends = checked_places(py, "springs", lengths.springs, count)?;
    let constants = values(py, "constants", lengths.constants, ends.len() / 2)?;
    let rest = lengths.rest.map(|rest| values(py, "rest", rest, constants.len())).transpose()?;
    for (s, (pair, &constant)) in ends.as_chunks::<2>().0.iter().zip(&constants).enumerate() {
        let [i, j] = *pair;
        if i == j {
            return Err(invalid(py, &format!("springs[{s}]"), "two points", format!("point {i} twice")));
        }
        let points_of = |p: usize| &points[p * d..(p + 1) * d];
        let rest = rest.as_ref().map_or_else(|| distance(points_of(i), points_of(j)), |rest| rest[s]);
        own.lengths.push(LengthSpring { points: [i.min(j), i.max(j)], constant, rest });
    }
    let mut measuring = Measuring::new(d, elements);
    for (g, group) in groups.iter().enumerate() {
        add_group(py, &format!("contents[{g}]"), (points, d), group, &mut measuring, &mut own)?;
    }
    Ok(own)
}

fn add_group(
    py: Python,
    key: &str,
    (points, d): (&[f64], usize),
    group: &GivenGroup,
    measuring: &mut Measuring,
    own: &mut Network,
) -> PyResult<()> {
    let at = |name: &str| format!("{key}.{name}");
    let fault = |error: Error| raised(py, error.under(key.to_string()));
    let kind = SpringKind::named(&group.kind).map_err(|e| fault(e.at_key("kind")))?;
    let n = group.points.shape()[1];
    if n == 0 {
        return Err(invalid(
            py,
            &at("points"),
            "an array of shape (springs, points of each)",
            "springs without points",
        ));
    }
    let nodes = checked_places(py, &at("points"), &group.points, points.len() / d)?;
    let constants = values(py, &at("constants"), &group.constants, nodes.len() / n)?;
    let rest = group.rest.as_ref().map(|rest| values(py, &at("rest"), rest, constants.len())).transpose()?;
    let law = group.law.as_deref().map(|text| measuring.law(text)).transpose().map_err(fault)?;
    let mut parameters = Vec::new();
    for name in law.iter().flat_map(|law| &law.parameters) {
        let key = at(&format!("parameters.{name}"));
        let given = group.parameters.get(name).ok_or_else(|| invalid(py, &key, "an array of numbers", "none"))?;
        parameters.push(values(py, &key, given, constants.len())?);
    }
    let records = MeasureRecords::new(py, key, kind, n, d, group, measuring, constants.len())?;
    let mut known: Option<Measure> = None;
    let mut x = Vec::new();
    for (s, &constant) in constants.iter().enumerate() {
        let measure = match &known {
            Some(measure) => measure.clone(),
            None => {
                let record = records.of(s);
                measuring.measure(&record, kind, n).map_err(fault)?
            }
        };
        if records.are_equal() {
            known = Some(measure.clone());
        }
        let own_points = &nodes[s * n..(s + 1) * n];
        x.clear();
        x.extend(own_points.iter().flat_map(|&p| &points[p * d..(p + 1) * d]));
        let rest = rest.as_ref().map_or_else(|| measure.value(&x, d), |rest| rest[s]);
        let of_law = |law: &Arc<Law>| {
            let own: Vec<f64> = parameters.iter().map(|values| values[s]).collect();
            Box::new(SpringLaw::new(law.clone(), &own))
        };
        own.others.push(MeasureSpring {
            kind,
            points: own_points.into(),
            constant,
            rest,
            measure,
            law: law.as_ref().map(of_law),
        });
    }
    Ok(())
}

/// What each spring of a group measures.
struct MeasureRecords {
    base: MeasureRecord,
    /// The weight and the gradients of each spring.
    terms: Option<(Vec<f64>, Vec<f64>, usize)>,
    cells: Option<Vec<Vec<(Vec<usize>, f64)>>>,
    nodes: usize,
}

impl MeasureRecords {
    #[expect(clippy::too_many_arguments, reason = "what a group has")]
    fn new(
        py: Python,
        key: &str,
        kind: SpringKind,
        n: usize,
        d: usize,
        group: &GivenGroup,
        measuring: &mut Measuring,
        count: usize,
    ) -> PyResult<MeasureRecords> {
        let fault = |error: Error| raised(py, error.under(key.to_string()));
        let plain =
            |kind| MeasureRecord { kind, element: None, terms: Vec::new(), cells: Vec::new(), expression: None };
        let mut found = MeasureRecords { base: plain(MeasureKind::Content), terms: None, cells: None, nodes: n };
        let whole = vec![ShareRecord { nodes: (0..n).collect(), share: 1.0 }];
        let simplex = measuring.simplex(kind, n).map(|element| element.name.clone());
        let name = group.element.clone().or(simplex);
        found.base.element.clone_from(&name);
        if kind == SpringKind::Length {
            if n != 2 {
                return Err(invalid(py, &format!("{key}.points"), "an array of shape (springs, 2)", n));
            }
            found.base = plain(MeasureKind::Length);
            return Ok(found);
        }
        if let Some(text) = &group.expression {
            found.base = MeasureRecord { expression: Some(text.clone()), ..plain(MeasureKind::Expression) };
            return Ok(found);
        }
        if let (Some(weights), Some(gradients)) = (&group.weights, &group.gradients) {
            let weights = values(py, &format!("{key}.weights"), weights, count)?;
            let width = gradients.shape()[1];
            if gradients.shape()[0] != count || n == 0 || !width.is_multiple_of(n) || !(1..=d).contains(&(width / n)) {
                let expected = format!("an array of shape ({count}, {n}·columns)");
                let shape = format!("{:?}", gradients.shape());
                return Err(invalid(py, &format!("{key}.gradients"), &expected, shape));
            }
            found.terms = Some((weights, rows(gradients), width / n));
            found.base.cells = whole;
            return Ok(found);
        }
        let element = name.as_deref().and_then(|name| measuring.element(name));
        if let (Some(name), None) = (&group.element, &element) {
            let expected = "a shipped element, or one of the cells of the mesh";
            return Err(invalid(py, &format!("{key}.element"), expected, format!("\"{name}\"")));
        }
        if let Some(cells) = &group.cells {
            let expected =
                || invalid(py, &format!("{key}.cells"), &format!("a list for each of {count} springs"), cells.len());
            if cells.len() != count {
                return Err(expected());
            }
            // The element of a patch of simplices follows from the number of nodes.
            let first = cells.iter().flatten().map(|(nodes, _)| nodes.len()).next().unwrap_or(0);
            let of_nodes = || match (d, first) {
                (2, 3) => measuring.element("tri3"),
                (3, 4) => measuring.element("tet4"),
                _ => None,
            };
            let element = element.or_else(of_nodes).ok_or_else(|| {
                invalid(py, &format!("{key}.element"), "the name of the element of the cells", "none")
            })?;
            for (nodes, _) in cells.iter().flatten() {
                if nodes.len() != element.nodes() || nodes.iter().any(|&a| a >= n) {
                    let wanted = format!("cells of {} places below {n}", element.nodes());
                    return Err(invalid(py, &format!("{key}.cells"), &wanted, format!("{nodes:?}")));
                }
            }
            found.base.element = Some(element.name.clone());
            found.base.terms = cell_terms(&element);
            found.cells = Some(cells.clone());
            return Ok(found);
        }
        if let Some(element) = element {
            if element.nodes() != n {
                let expected = format!("an array of shape (springs, {})", element.nodes());
                return Err(invalid(py, &format!("{key}.points"), &expected, n));
            }
            found.base.terms = cell_terms(&element);
            found.base.cells = whole;
            return Ok(found);
        }
        // A kind whose formula follows from its points.
        let function = Measure::of_kind(kind, n, d).map_err(fault)?;
        let names = coordinate_names(n, d);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        found.base = MeasureRecord { expression: Some(function.text(&names)), ..plain(MeasureKind::Expression) };
        Ok(found)
    }

    fn are_equal(&self) -> bool {
        self.terms.is_none() && self.cells.is_none()
    }

    fn of(&self, s: usize) -> MeasureRecord {
        let mut record = self.base.clone();
        if let Some((weights, gradients, columns)) = &self.terms {
            let size = self.nodes * columns;
            let own = gradients[s * size..(s + 1) * size].chunks_exact(*columns).map(<[f64]>::to_vec).collect();
            record.terms = vec![TermRecord { weight: weights[s], gradients: own }];
        }
        if let Some(cells) = &self.cells {
            let share = |(nodes, share): &(Vec<usize>, f64)| ShareRecord { nodes: nodes.clone(), share: *share };
            record.cells = cells[s].iter().map(share).collect();
        }
        record
    }
}

fn cell_terms(element: &Element) -> Vec<TermRecord> {
    springfit::report::cell_terms(&element.tabulation)
}

/// Numbers of which there are as many as springs.
fn values(py: Python, key: &str, given: &PyReadonlyArray1<f64>, count: usize) -> PyResult<Vec<f64>> {
    let found: Vec<f64> = given.as_array().iter().copied().collect();
    if found.len() != count {
        return Err(invalid(
            py,
            key,
            &format!("an array of shape ({count},)"),
            format!("one of shape ({},)", found.len()),
        ));
    }
    match found.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(invalid(py, &format!("{key}[{place}]"), "a finite number", found[place])),
        None => Ok(found),
    }
}

fn checked_places(py: Python, key: &str, given: &PyReadonlyArray2<i64>, count: usize) -> PyResult<Vec<usize>> {
    let found = places(py, key, given.as_array().iter())?;
    match found.iter().find(|p| **p >= count) {
        Some(wrong) => Err(invalid(py, key, &format!("places of points from 0 and below {count}"), wrong)),
        None => Ok(found),
    }
}

/// Other numbers in place of those of some springs.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Changed<'py> {
    constants: Option<PyReadonlyArray1<'py, f64>>,
    rest: Option<PyReadonlyArray1<'py, f64>>,
    parameters: BTreeMap<String, PyReadonlyArray1<'py, f64>>,
}

/// The same springs with these numbers: of the springs between two points, and of each group of the others.
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

/// Masses of the points.
pub fn masses(py: Python, given: &PyReadonlyArray1<f64>, points: usize) -> PyResult<Vec<f64>> {
    let found = values(py, "masses", given, points)?;
    match found.iter().position(|mass| *mass < 0.0) {
        Some(place) => Err(invalid(py, &format!("masses[{place}]"), "a mass of at least zero, kg", found[place])),
        None => Ok(found),
    }
}
