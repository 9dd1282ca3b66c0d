//! The springs of a network that programs with springs between two points and volume springs hold.

use super::measures::point_term;
use super::record::{MeasureKind, MeasureRecord, NetworkRecord, SpringRecord, TermRecord};
use crate::element::{SpringKind, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, MeasureSpring, Network};
use crate::springs::Measure;
use smallvec::SmallVec;
use std::borrow::Borrow;
use std::sync::Arc;

/// A linear spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthPart {
    /// The two points that it joins.
    pub points: [usize; 2],
    /// N/m.
    pub constant: f64,
    /// m.
    pub rest: f64,
    /// kg/s.
    pub damper: f64,
}

/// A linear spring on the content of a simplex: the area of a triangle in the plane, the volume of a tetrahedron in space.
#[derive(Debug, Clone, PartialEq)]
pub struct ContentPart {
    /// The simplex has one more point than dimensions; the content of the points is positive in this order.
    pub points: SmallVec<[usize; 4]>,
    /// N/m⁵; in the plane N/m³.
    pub constant: f64,
    /// m³; in the plane m².
    pub rest: f64,
}

/// A network of linear springs on lengths and on the contents of simplices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    /// Springs on lengths.
    pub lengths: Vec<LengthPart>,
    /// Springs on contents.
    pub contents: Vec<ContentPart>,
}

impl Parts {
    /// # Errors
    /// A spring has a law or measures something else; kind `Unsupported`, and the key is the place of the spring.
    pub fn of(network: &NetworkRecord) -> Result<Parts> {
        Parts::default().with_springs(network, &network.springs)
    }

    /// The springs as a model in this dimension, without dampers.
    pub fn network(&self, dimension: usize) -> Network {
        let kind = if dimension == 2 { SpringKind::Area } else { SpringKind::Volume };
        let measure = Measure::Span(Arc::new(simplex_table(dimension)));
        let of_length =
            |part: &LengthPart| LengthSpring { points: part.points, constant: part.constant, rest: part.rest };
        let of_content = |part: &ContentPart| MeasureSpring {
            kind,
            points: part.points.clone(),
            constant: part.constant,
            rest: part.rest,
            measure: measure.clone(),
            law: None,
        };
        let others = self.contents.iter().map(of_content).collect();
        Network { dimension, lengths: self.lengths.iter().map(of_length).collect(), others }
    }

    /// No springs yet, and memory for those of a network. A list that grew would leave behind the memory of its shorter forms.
    pub(super) fn with_room(network: &Network) -> Parts {
        Parts { lengths: Vec::with_capacity(network.lengths.len()), contents: Vec::with_capacity(network.others.len()) }
    }

    /// With springs that are not in the list of the record.
    pub(super) fn with_springs<'a, S, C>(
        mut self,
        network: &NetworkRecord<S, C>,
        springs: impl IntoIterator<Item = impl Borrow<SpringRecord<'a>>>,
    ) -> Result<Parts> {
        let simplices: Vec<Option<(f64, bool)>> =
            network.measures.iter().map(|measure| simplex(measure, network.dimension)).collect();
        for (i, spring) in springs.into_iter().enumerate() {
            let spring = spring.borrow();
            let measure = &network.measures[spring.measure];
            let refused = |found: String| {
                let expected = "linear springs on lengths and on the contents of triangles or tetrahedra";
                let error = Error::expected(format!("springs[{i}]"), expected, found);
                error
                    .followed_by(format!("; {}", advice(spring, measure, network.dimension)))
                    .of_kind(ErrorKind::Unsupported)
            };
            if let Some(law) = &spring.law {
                return Err(refused(format!("the law {law}")));
            }
            match (measure.kind, simplices[spring.measure]) {
                (MeasureKind::Length, _) => self.lengths.push(LengthPart {
                    points: [spring.points[0], spring.points[1]],
                    constant: spring.constant,
                    rest: spring.rest,
                    damper: spring.damper,
                }),
                (MeasureKind::Content, Some((scale, is_turned))) => {
                    let mut points = SmallVec::from_slice(&spring.points);
                    if is_turned {
                        points.swap(0, 1);
                    }
                    self.contents.push(ContentPart {
                        points,
                        constant: spring.constant * scale * scale,
                        rest: spring.rest / scale,
                    });
                }
                _ => return Err(refused(format!("one of the kind {}", spring.kind))),
            }
        }
        Ok(self)
    }
}

/// The simplex between the origin and the units of the axes, at its centre: a weight of 1/d!, and the gradients of `1 − Σ ξ_k`, ξ_1, …
fn simplex_table(d: usize) -> Tabulation {
    let gradient = |(a, k): (usize, usize)| if a == 0 { -1.0 } else { f64::from(u8::from(a == k + 1)) };
    Tabulation {
        nodes: d + 1,
        dimension: d,
        space: d,
        weights: vec![1.0 / (1..=d).product::<usize>() as f64],
        volumetric: Vec::new(),
        values: vec![1.0 / (d + 1) as f64; d + 1],
        gradients: (0..=d).flat_map(|a| (0..d).map(move |k| (a, k))).map(gradient).collect(),
        modes: None,
    }
}

/// What springs on the area of a triangle in the plane or the volume of a tetrahedron measure; none for other kinds and numbers of points.
pub fn simplex_term(kind: SpringKind, points: usize, d: usize) -> Option<TermRecord> {
    let is_simplex = points == d + 1 && matches!((kind, d), (SpringKind::Area, 2) | (SpringKind::Volume, 3));
    is_simplex.then(|| point_term(&simplex_table(d), 0))
}

/// The fit that has springs of the right kind.
fn advice(spring: &SpringRecord, measure: &MeasureRecord, dimension: usize) -> &'static str {
    let is_embedded = measure.terms.iter().flat_map(|term| &term.gradients).any(|g| g.len() < dimension);
    match (measure.cells.len(), &spring.law) {
        _ if is_embedded => {
            "springs on the areas of membranes and on the lengths of rods in space are held by no program: objective = \"offdiag\" with nonnegative = true has \
             springs on lengths alone"
        }
        (_, Some(_)) => "objective = \"exact\" with energy = \"stable-neo-hookean\" has linear springs alone",
        (2.., None) => "volume = \"points\" has springs on single cells",
        (_, None) => {
            "objective = \"exact\" on a mesh of linear tetrahedra has these, and objective = \"offdiag\" with nonnegative = true \
             has springs on lengths on any mesh"
        }
    }
}

/// If the measure is the content of the simplex of its points times a number: that number, and whether the points are to be turned.
fn simplex(measure: &MeasureRecord, d: usize) -> Option<(f64, bool)> {
    let ([term], [cell]) = (&measure.terms[..], &measure.cells[..]) else { return None };
    let is_whole = cell.nodes.iter().enumerate().all(|(i, node)| i == *node);
    let is_simplex = term.gradients.len() == d + 1 && term.gradients.iter().all(|g| g.len() == d);
    if d < 2 || !is_whole || !is_simplex {
        return None;
    }
    // x = Σ_a x_a ⊗ g_a = (x_1 − x_0, …) G with the rows g_1, …, because the g_a add up to zero.
    let g = |i: usize, j: usize| term.gradients[i + 1][j];
    let determinant = match d {
        2 => g(0, 0) * g(1, 1) - g(0, 1) * g(1, 0),
        _ => (0..3)
            .map(|k| g(0, k) * (g(1, (k + 1) % 3) * g(2, (k + 2) % 3) - g(1, (k + 2) % 3) * g(2, (k + 1) % 3)))
            .sum(),
    };
    let factorial = if d == 2 { 2.0 } else { 6.0 };
    let scale: f64 = cell.share * term.weight * determinant * factorial;
    (scale != 0.0 && scale.is_finite()).then_some((scale.abs(), scale < 0.0))
}
