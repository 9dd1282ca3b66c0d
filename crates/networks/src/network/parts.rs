//! The springs of a network that programs with springs between two points and volume springs hold.

use super::measures::point_term;
use super::record::{MeasureKind, MeasureRecord, NetworkRecord, SpringRecord, TermRecord};
use crate::element::{SpringKind, Tabulation, coordinate_names};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, MeasureSpring, Network};
use crate::springs::{HINGE_POINTS, Measure, Turns};
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

/// A linear spring on the content of a simplex: the area of a triangle, the volume of a tetrahedron.
#[derive(Debug, Clone, PartialEq)]
pub struct ContentPart {
    /// A tetrahedron has four points and a triangle three; the content of the points is positive in this order.
    pub points: SmallVec<[usize; 4]>,
    /// N/m⁵; of a triangle N/m³.
    pub constant: f64,
    /// m³; of a triangle m².
    pub rest: f64,
}

/// A linear spring on the turn of a triangle about one of its edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingePart {
    /// The corner of the triangle opposite to the edge, the ends of the edge as the triangle runs through it, and the point towards which the turn is measured: the
    /// apex of another triangle, or a point beyond the edge.
    pub points: [usize; 4],
    /// N·m.
    pub constant: f64,
    /// rad; zero if the four points are in a plane.
    pub rest: f64,
}

/// A network of linear springs on lengths, on the contents of simplices and on the turns of triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    /// Springs on lengths.
    pub lengths: Vec<LengthPart>,
    /// Springs on contents.
    pub contents: Vec<ContentPart>,
    /// Springs on turns.
    pub hinges: Vec<HingePart>,
}

impl Parts {
    /// # Errors
    /// A spring has a law or measures something else; kind `Unsupported`, and the key is the place of the spring.
    pub fn of(network: &NetworkRecord) -> Result<Parts> {
        Parts::default().with_springs(network, &network.springs)
    }

    /// The springs as a model in this dimension, without dampers.
    pub fn network(&self, dimension: usize) -> Network {
        let simplices = [2, 3].map(|d| Measure::Span(Arc::new(simplex_table(d, dimension))));
        let simplex = |corners: usize| match corners {
            3 => (SpringKind::Area, simplices[0].clone()),
            _ => (SpringKind::Volume, simplices[1].clone()),
        };
        let turn = Measure::Turns(Box::new(Turns::of_hinge()));
        let of_length =
            |part: &LengthPart| LengthSpring { points: part.points, constant: part.constant, rest: part.rest };
        let of_content = |part: &ContentPart| {
            let (kind, measure) = simplex(part.points.len());
            let ContentPart { points, constant, rest } = part.clone();
            MeasureSpring { kind, points, constant, rest, measure, law: None }
        };
        let of_hinge = |part: &HingePart| MeasureSpring {
            kind: SpringKind::Hinge,
            points: SmallVec::from_slice(&part.points),
            constant: part.constant,
            rest: part.rest,
            measure: turn.clone(),
            law: None,
        };
        let others = self.contents.iter().map(of_content).chain(self.hinges.iter().map(of_hinge)).collect();
        Network { dimension, lengths: self.lengths.iter().map(of_length).collect(), others }
    }

    /// No springs yet, and memory for those of a network. A list that grew would leave behind the memory of its shorter forms.
    pub(super) fn with_room(network: &Network) -> Parts {
        Parts {
            lengths: Vec::with_capacity(network.lengths.len()),
            contents: Vec::with_capacity(network.others.len()),
            hinges: Vec::new(),
        }
    }

    /// With springs that are not in the list of the record.
    pub(super) fn with_springs<'a, S, C>(
        mut self,
        network: &NetworkRecord<S, C>,
        springs: impl IntoIterator<Item = impl Borrow<SpringRecord<'a>>>,
    ) -> Result<Parts> {
        let area = area_in_space(network.dimension);
        let of_measure = |measure: &MeasureRecord| match measure.kind {
            MeasureKind::Expression => (area.is_some() && measure.expression == area).then_some((1.0, false)),
            _ => simplex(measure, network.dimension),
        };
        let simplices: Vec<Option<(f64, bool)>> = network.measures.iter().map(of_measure).collect();
        for (i, spring) in springs.into_iter().enumerate() {
            let spring = spring.borrow();
            let measure = &network.measures[spring.measure];
            let refused = |found: String| {
                let expected = "linear springs on lengths, on the contents of triangles or tetrahedra, and on the angles of hinges";
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
                (MeasureKind::Content | MeasureKind::Expression, Some((scale, is_turned))) => {
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
                (MeasureKind::Turn, _) if is_hinge(measure) => self.hinges.push(HingePart {
                    points: std::array::from_fn(|place| spring.points[place]),
                    constant: spring.constant,
                    rest: spring.rest,
                }),
                _ => return Err(refused(format!("one of the kind {}", spring.kind))),
            }
        }
        Ok(self)
    }
}

/// The simplex between the origin and the units of the axes, at its centre: a weight of 1/d!, and the gradients of `1 − Σ ξ_k`, ξ_1, … Its points have
/// `space` coordinates.
fn simplex_table(d: usize, space: usize) -> Tabulation {
    let gradient = |(a, k): (usize, usize)| if a == 0 { -1.0 } else { f64::from(u8::from(a == k + 1)) };
    Tabulation {
        nodes: d + 1,
        dimension: d,
        space,
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
    is_simplex.then(|| point_term(&simplex_table(d, d), 0))
}

/// The expression of the area of a triangle in space, which has no other table; none in the plane.
fn area_in_space(dimension: usize) -> Option<String> {
    let area = Measure::of_kind(SpringKind::Area, 3, dimension).ok().filter(|_| dimension == 3)?;
    let names = coordinate_names(3, dimension);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Some(area.text(&names))
}

/// Whether a measure is the turn of a single triangle about an edge, of the points of the spring in their order.
fn is_hinge(measure: &MeasureRecord) -> bool {
    matches!(&measure.cells[..], [turn] if turn.share == 1.0 && turn.nodes.iter().copied().eq(0..HINGE_POINTS))
}

/// The fit that has springs of the right kind.
fn advice(spring: &SpringRecord, measure: &MeasureRecord, dimension: usize) -> &'static str {
    let is_embedded = measure.terms.iter().flat_map(|term| &term.gradients).any(|g| g.len() < dimension);
    match (measure.cells.len(), &spring.law) {
        _ if measure.kind == MeasureKind::Turn => {
            "bending = \"hinges\" in the fit of a sheet has springs on single angles, of sheets and of rods in line"
        }
        _ if measure.kind == MeasureKind::Squares => {
            "springs on strains are held by no program: objective = \"offdiag\" with nonnegative = true has springs on lengths alone"
        }
        _ if is_embedded => {
            "springs on the areas of curved membranes and on the lengths of rods in space are held by no program: objective = \"offdiag\" with \
             nonnegative = true has springs on lengths alone"
        }
        (_, Some(_)) => "objective = \"exact\" with energy = \"stable-neo-hookean\" has linear springs alone",
        (2.., None) => "volume = \"points\" has springs on single cells",
        (_, None) => {
            "objective = \"exact\" on a mesh of linear tetrahedra has these, and objective = \"offdiag\" with nonnegative = true \
             has springs on lengths on any mesh"
        }
    }
}

/// If the measure is the content of the simplex of its points times a number: that number, and whether the points are to be turned. In space it may be that of a
/// triangle.
fn simplex(measure: &MeasureRecord, space: usize) -> Option<(f64, bool)> {
    let ([term], [cell]) = (&measure.terms[..], &measure.cells[..]) else { return None };
    let is_whole = cell.nodes.iter().enumerate().all(|(i, node)| i == *node);
    let d = term.gradients.first()?.len();
    let is_simplex = term.gradients.len() == d + 1 && term.gradients.iter().all(|g| g.len() == d);
    if !(2..=space).contains(&d) || !is_whole || !is_simplex {
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
    // The area of a triangle in space has no sign.
    (scale != 0.0 && scale.is_finite()).then_some((scale.abs(), scale < 0.0 && d == space))
}
