//! The springs of a record as a model, which has energy, forces and stiffness.

use super::measures::cell_terms;
use super::record::{MeasureKind, MeasureRecord, NetworkRecord, SpringRecord, TermRecord};
use crate::element::{Element, SpringKind, Tabulation, coordinate_names};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::{Gate, Mesh, MeshArrays};
use crate::model::{LengthSpring, MeasureSpring, Network, SpringLaw};
use crate::springs::{Law, Measure, Patch, Squares, Turns};
use crate::symbolic::Scope;
use smallvec::SmallVec;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// By how much the numbers of a term may differ from those of an element, relative to the largest: those of single precision.
const SAME: f64 = 1e-6;

/// Makes measures from their records; equal tables, elements and expressions are shared.
pub struct Measuring {
    dimension: usize,
    elements: BTreeMap<String, Option<Arc<Element>>>,
    tables: HashMap<Vec<u64>, Arc<Tabulation>>,
    laws: HashMap<String, Arc<Law>>,
}

impl Measuring {
    /// The measures of springs on points with `dimension` coordinates. `elements` are the elements that are not shipped.
    pub fn new(dimension: usize, elements: &[Arc<Element>]) -> Measuring {
        let elements = elements.iter().map(|element| (element.name.clone(), Some(element.clone()))).collect();
        Measuring { dimension, elements, tables: HashMap::new(), laws: HashMap::new() }
    }

    /// The element of this name; none if it is neither given nor shipped.
    pub fn element(&mut self, name: &str) -> Option<Arc<Element>> {
        let shipped = || if name.ends_with(".toml") { None } else { Element::load(name).ok().map(Arc::new) };
        self.elements.entry(name.into()).or_insert_with(shipped).clone()
    }

    /// The law of this expression.
    ///
    /// # Errors
    /// The text is no law.
    pub fn law(&mut self, text: &str) -> Result<Arc<Law>> {
        if let Some(law) = self.laws.get(text) {
            return Ok(law.clone());
        }
        let law = Arc::new(Law::parse(text).map_err(|e| e.at_key("law"))?);
        self.laws.insert(text.into(), law.clone());
        Ok(law)
    }

    /// What springs of this kind on so many points measure.
    ///
    /// # Errors
    /// The record does not say what it is: it is the content of cells of an element that is neither given nor shipped, or its expression
    /// cannot be read.
    pub fn measure(&mut self, record: &MeasureRecord, kind: SpringKind, points: usize) -> Result<Measure> {
        let listed = record.cells.iter().map(|cell| (&cell.nodes[..], cell.share));
        let wrong = |expected: String| Error::expected("cells", expected, "others");
        match record.kind {
            MeasureKind::Length => Ok(Measure::Length),
            MeasureKind::Expression => {
                let text = record.expression.as_deref().unwrap_or_default();
                let names = coordinate_names(points, self.dimension);
                let expression = Scope::new(&names).expression(text).map_err(|e| e.at_key("expression"))?;
                Ok(Measure::Function(Arc::new(expression.into())))
            }
            MeasureKind::Content => self.content(record, kind, points),
            MeasureKind::Turn => {
                let expected = format!("turns, each with four different places below {points}");
                let turns = Turns::new(listed, points).ok_or_else(|| wrong(expected))?;
                Ok(Measure::Turns(Box::new(turns)))
            }
            MeasureKind::Squares => {
                let expected = format!("pairs of two different places below {points}");
                let squares = Squares::new(listed, points).ok_or_else(|| wrong(expected))?;
                Ok(Measure::Squares(Box::new(squares)))
            }
        }
    }

    fn content(&mut self, record: &MeasureRecord, kind: SpringKind, points: usize) -> Result<Measure> {
        let element = record.element.as_deref().and_then(|name| self.element(name));
        let is_whole = match &record.cells[..] {
            [cell] => cell.share == 1.0 && cell.nodes.iter().copied().eq(0..points),
            _ => false,
        };
        let is_cell = |element: &Element| are_same(&cell_terms(&element.tabulation), &record.terms);
        match element {
            Some(element) if is_whole && kind != SpringKind::PointContent && is_cell(&element) => {
                return Ok(Measure::Content(element));
            }
            Some(element) if !is_whole && is_cell(&element) => {
                let cells = record.cells.iter().map(|cell| (cell.nodes.clone(), cell.share)).collect();
                return Ok(Measure::Patch(Arc::new(Patch { element, cells })));
            }
            Some(element) if is_whole && record.terms.len() == 1 => {
                let table = &element.tabulation;
                let is_point = |q: &usize| are_same(&[super::measures::point_term(table, *q)], &record.terms);
                if let Some(q) = (0..table.points()).find(is_point) {
                    return Ok(Measure::PointContent(element, q as u32));
                }
            }
            _ => {}
        }
        match &record.terms[..] {
            [term] if is_whole => Ok(Measure::Span(self.table(term))),
            _ => {
                let name = record.element.as_deref().unwrap_or("an element without a name");
                let expected = "springs on the cells of shipped elements, or of elements that are given";
                Err(Error::expected("element", expected, format!("\"{name}\"")).of_kind(ErrorKind::Unsupported))
            }
        }
    }

    /// A table of one point with this term.
    fn table(&mut self, term: &TermRecord) -> Arc<Tabulation> {
        let columns = term.gradients.first().map_or(0, Vec::len);
        let numbers = || std::iter::once(term.weight).chain(term.gradients.iter().flatten().copied());
        let key = std::iter::once(columns as u64).chain(numbers().map(f64::to_bits)).collect();
        let nodes = term.gradients.len();
        let table = || Tabulation {
            nodes,
            dimension: columns,
            space: self.dimension,
            weights: vec![term.weight],
            volumetric: Vec::new(),
            values: vec![1.0 / nodes as f64; nodes],
            gradients: term.gradients.iter().flatten().copied().collect(),
            modes: None,
        };
        self.tables.entry(key).or_insert_with(|| Arc::new(table())).clone()
    }
}

fn are_same(own: &[TermRecord], given: &[TermRecord]) -> bool {
    let numbers = |terms: &[TermRecord]| -> Vec<f64> {
        terms.iter().flat_map(|t| std::iter::once(t.weight).chain(t.gradients.iter().flatten().copied())).collect()
    };
    let shape = |terms: &[TermRecord]| -> Vec<(usize, Option<usize>)> {
        terms.iter().map(|t| (t.gradients.len(), t.gradients.first().map(Vec::len))).collect()
    };
    if shape(own) != shape(given) {
        return false;
    }
    let (own, given) = (numbers(own), numbers(given));
    let size = own.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    own.len() == given.len() && own.iter().zip(&given).all(|(a, b)| (a - b).abs() <= SAME * size)
}

impl NetworkRecord {
    /// The springs as a model; `elements` are those of the cells that are not shipped.
    ///
    /// # Errors
    /// A measure, a law or a kind is not known; the error names the spring.
    pub fn model(&self, elements: &[Arc<Element>]) -> Result<Network> {
        let mut measuring = Measuring::new(self.dimension, elements);
        let mut known: HashMap<(usize, &str), Measure> = HashMap::new();
        let mut network = Network { dimension: self.dimension, ..Network::default() };
        for (s, spring) in self.springs.iter().enumerate() {
            let under = |e: Error| e.under(format!("springs[{s}]"));
            let kind = SpringKind::named(&spring.kind).map_err(|e| under(e.at_key("kind")))?;
            if let (SpringKind::Length, None, [i, j]) = (kind, &spring.law, &spring.points[..]) {
                let points = [*i.min(j), *i.max(j)];
                network.lengths.push(LengthSpring { points, constant: spring.constant, rest: spring.rest });
                continue;
            }
            let measure = match known.get(&(spring.measure, &*spring.kind)) {
                Some(measure) => measure.clone(),
                None => {
                    let record = &self.measures[spring.measure];
                    let measure = measuring.measure(record, kind, spring.points.len()).map_err(under)?;
                    known.insert((spring.measure, &*spring.kind), measure.clone());
                    measure
                }
            };
            let law = spring.law.as_deref().map(|text| own_law(&mut measuring, text, spring)).transpose();
            network.others.push(MeasureSpring {
                kind,
                points: SmallVec::from_slice(&spring.points),
                constant: spring.constant,
                rest: spring.rest,
                measure,
                law: law.map_err(under)?.map(Box::new),
            });
        }
        Ok(network)
    }

    /// The mesh of the cells on the same points; none if there are no cells, their elements are neither given nor shipped, or the points are not
    /// those of the cells alone.
    pub fn mesh(&self, elements: &[Arc<Element>]) -> Option<Mesh> {
        let mut measuring = Measuring::new(self.dimension, elements);
        let block = |block: &super::record::CellBlockRecord| {
            let element = measuring.element(&block.element)?;
            let is_sound = block.points.iter().all(|cell| cell.len() == element.nodes());
            is_sound.then(|| (element, block.points.concat()))
        };
        let blocks: Vec<_> = self.cells.iter().map(block).collect::<Option<_>>()?;
        // Where building turns cells, springs would name other points.
        let mesh = if blocks.is_empty() { None } else { mesh_of(self.dimension, &self.points.concat(), blocks) };
        mesh.filter(|mesh| mesh.reversed == 0)
    }
}

/// A mesh of cells, if it can be built and has all points: of a mesh that leaves some out the numbers are not those of the springs.
pub(super) fn mesh_of(dimension: usize, points: &[f64], blocks: Vec<(Arc<Element>, Vec<usize>)>) -> Option<Mesh> {
    let (groups, cell_groups) = Default::default();
    let arrays = MeshArrays { dimension, points: points.to_vec(), blocks, groups, cell_groups };
    arrays.build(Gate::default()).ok().filter(|mesh| mesh.points == points)
}

fn own_law(measuring: &mut Measuring, text: &str, spring: &SpringRecord) -> Result<SpringLaw> {
    let law = measuring.law(text)?;
    let value = |name: &String| {
        let missing = || Error::expected(format!("parameters.{name}"), "a number", "none");
        spring.parameters.get(name).copied().ok_or_else(missing)
    };
    let parameters = law.parameters.iter().map(value).collect::<Result<Vec<f64>>>()?;
    Ok(SpringLaw::new(law, &parameters))
}
