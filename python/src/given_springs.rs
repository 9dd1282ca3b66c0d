//! Springs from arrays.

use crate::arrays::{places, rows};
use crate::error::{invalid, raised};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_bodies::model::{LengthSpring, MeasureSpring, Network, SpringLaw};
use springfit_element::element::{Element, SpringKind, coordinate_names};
use springfit_element::springs::{BEND_POINTS, HINGE_POINTS, Law, Measure, distance};
use springfit_foundation::error::Error;
use springfit_report::report::{
    MeasureKind, MeasureRecord, Measuring, ShareRecord, TermRecord, cell_terms, simplex_term,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Springs between two points, as they are given.
pub struct GivenLengths<'a, 'py> {
    pub springs: &'a PyReadonlyArray2<'py, i64>,
    pub constants: &'a PyReadonlyArray1<'py, f64>,
    /// The lengths at rest; those of the springs where the points are, if there are none.
    pub rest: Option<&'a PyReadonlyArray1<'py, f64>>,
}

/// The cells of a spring on several: the places of their nodes, and their shares.
type Shares = Vec<(Vec<usize>, f64)>;

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
    cells: Option<Vec<Shares>>,
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
    cells: Option<Vec<Shares>>,
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
        found.base.element.clone_from(&group.element);
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
        let element = group.element.as_deref().and_then(|name| measuring.element(name));
        if let (Some(name), None) = (&group.element, &element) {
            let expected = "a shipped element, or one of the cells of the mesh";
            return Err(invalid(py, &format!("{key}.element"), expected, format!("\"{name}\"")));
        }
        if let (SpringKind::Hinge, None) = (kind, &group.cells) {
            if n != HINGE_POINTS {
                let expected = format!("an array of shape (springs, {HINGE_POINTS})");
                return Err(invalid(py, &format!("{key}.points"), &expected, n));
            }
            found.base = MeasureRecord { cells: whole, ..plain(MeasureKind::Turn) };
            return Ok(found);
        }
        if let (SpringKind::Bend | SpringKind::Hinge, Some(cells)) = (kind, &group.cells) {
            let is_turn = |(nodes, _): &(Vec<usize>, f64)| nodes.iter().all(|&a| a < n);
            let size = if kind == SpringKind::Bend { BEND_POINTS } else { HINGE_POINTS };
            if cells.len() != count || n != size || !cells.iter().flatten().all(is_turn) {
                let expected = format!("turns for each of {count} springs of {size} points");
                return Err(invalid(py, &format!("{key}.cells"), &expected, cells.len()));
            }
            found.base = plain(MeasureKind::Turn);
            found.cells = Some(cells.clone());
            return Ok(found);
        }
        if let (SpringKind::Strain, Some(cells)) = (kind, &group.cells) {
            let is_pair = |(nodes, _): &(Vec<usize>, f64)| nodes.len() == 2 && nodes.iter().all(|&a| a < n);
            if cells.len() != count || !cells.iter().flatten().all(is_pair) {
                let expected = format!("pairs of points for each of {count} springs");
                return Err(invalid(py, &format!("{key}.cells"), &expected, cells.len()));
            }
            found.base = plain(MeasureKind::Squares);
            found.cells = Some(cells.clone());
            return Ok(found);
        }
        if let Some(cells) = &group.cells {
            let expected =
                || invalid(py, &format!("{key}.cells"), &format!("a list for each of {count} springs"), cells.len());
            if cells.len() != count {
                return Err(expected());
            }
            let element = element.ok_or_else(|| {
                invalid(py, &format!("{key}.element"), "the name of the element of the cells", "none")
            })?;
            for (nodes, _) in cells.iter().flatten() {
                if nodes.len() != element.nodes() || nodes.iter().any(|&a| a >= n) {
                    let wanted = format!("cells of {} places below {n}", element.nodes());
                    return Err(invalid(py, &format!("{key}.cells"), &wanted, format!("{nodes:?}")));
                }
            }
            found.base.element = Some(element.name.clone());
            found.base.terms = cell_terms(&element.tabulation);
            found.cells = Some(cells.clone());
            return Ok(found);
        }
        if let Some(element) = element {
            if element.nodes() != n {
                let expected = format!("an array of shape (springs, {})", element.nodes());
                return Err(invalid(py, &format!("{key}.points"), &expected, n));
            }
            found.base.terms = cell_terms(&element.tabulation);
            found.base.cells = whole;
            return Ok(found);
        }
        if let Some(term) = simplex_term(kind, n, d) {
            (found.base.terms, found.base.cells) = (vec![term], whole);
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

/// Numbers of which there are as many as springs.
pub fn values(py: Python, key: &str, given: &PyReadonlyArray1<f64>, count: usize) -> PyResult<Vec<f64>> {
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
    let found = places(py, key, given.as_array())?;
    match found.iter().find(|p| **p >= count) {
        Some(wrong) => Err(invalid(py, key, &format!("places of points from 0 and below {count}"), wrong)),
        None => Ok(found),
    }
}

/// Masses of the points.
pub fn masses(py: Python, given: &PyReadonlyArray1<f64>, points: usize) -> PyResult<Vec<f64>> {
    let found = values(py, "masses", given, points)?;
    match found.iter().position(|mass| *mass < 0.0) {
        Some(place) => Err(invalid(py, &format!("masses[{place}]"), "a mass of at least zero, kg", found[place])),
        None => Ok(found),
    }
}
