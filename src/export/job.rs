//! A network on its way to another program, checked against what that program holds.

use super::extent::check_parts;
use super::hinges::{Hinges, check_angles, check_edges_of_hinges};
use super::names::{named, ordered, sorted};
use springfit_bodies::engine::{Order, Sequence};
use springfit_element::springs::{cross, dot, norm};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_networks::network::QUADRILATERAL;
use springfit_report::report::{ContentPart, NetworkRecord, Parts};
use std::collections::{HashMap, HashSet};

/// What a program holds besides springs between two points with masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Holds {
    /// Springs on the volumes of tetrahedra.
    pub volumes: bool,
    /// Springs on the areas of triangles in the plane.
    pub areas: bool,
    /// Springs on the areas of triangles in space.
    pub membranes: bool,
    /// Springs on the angle between two triangles.
    pub hinges: Hinges,
    /// Constants below zero.
    pub negative: bool,
    /// Springs that pull at rest.
    pub tension: Tension,
    /// Points that are held along some axes only.
    pub partial: bool,
    /// Networks in the plane.
    pub plane: bool,
    /// Springs elsewhere than along the edges of tetrahedra.
    pub off_edges: bool,
}

impl Holds {
    /// All of it: a target names what it does not hold.
    pub const ALL: Holds = Holds {
        volumes: true,
        areas: true,
        membranes: true,
        hinges: Hinges::Any,
        negative: true,
        tension: Tension::Any,
        partial: true,
        plane: true,
        off_edges: true,
    };
}

/// Springs that pull at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tension {
    /// Any.
    Any,
    /// Those that balance edge by edge, as in exact networks on tetrahedra.
    Balanced,
    /// None.
    None,
}

/// Whether the inverse of the constant is a number of single precision. A spring that is softer has no force.
pub fn has_compliance(constant: f64) -> bool {
    1.0 / constant <= f64::from(f32::MAX)
}

/// A network that a program holds.
pub struct Job<'a> {
    /// The network as it is in its file.
    pub network: &'a NetworkRecord,
    /// Its springs by what they measure.
    pub parts: Parts,
    /// m/s², with z = 0 in the plane.
    pub gravity: [f64; 3],
    /// `[points]`, kg.
    pub masses: &'a [f64],
    /// The longest explicit step, s.
    pub step: f64,
}

/// A sum of tensions at rest below this share of what they would be if the springs had no rest measures is a rounding error.
const BALANCED: f64 = 1e-9;

impl<'a> Job<'a> {
    /// The network with the gravity that is asked for, that of the network, or 9.81 m/s² against the last axis.
    ///
    /// # Errors
    /// The program does not hold the network, or masses are missing; the error says which fit it holds.
    pub fn new(network: &'a NetworkRecord, gravity: Option<&[f64]>, program: &str, holds: &Holds) -> Result<Job<'a>> {
        let d = network.dimension;
        let unsupported = |key: String, expected: &str, found: String, advice: &str| {
            let error = Error::expected(key, format!("{expected}, which {program} holds"), found);
            Err(error.followed_by(format!("; {advice}")).of_kind(ErrorKind::Unsupported))
        };
        if !(d == 3 || d == 2 && holds.plane) {
            let expected = if holds.plane { "2 or 3" } else { "3" };
            return unsupported("dimension".into(), expected, d.to_string(), "take a solid body");
        }
        let masses = network.masses.as_deref().ok_or_else(|| {
            let expected = "a mass of each point";
            Error::expected("masses", expected, "none")
                .followed_by("; give the fit a density (density in [material], or --density)")
        })?;
        let free = free_points(network);
        if let Some(p) = (0..masses.len()).find(|&p| !(masses[p] > 0.0)) {
            let advice = "row sums of quadratic cells have such masses: mass = \"hrz\" in [motion] has none";
            return unsupported(format!("masses[{p}]"), "masses above zero", format!("{:e} kg", masses[p]), advice);
        }
        let step = network.largest_step.ok_or_else(|| Error::expected("largest_step", "a step in s", "none"))?;
        let parts = Parts::of(network)?;
        check_parts(&parts)?;
        let holds_content = |part: &&ContentPart| match (d, part.points.len()) {
            (2, _) => holds.areas,
            (_, 3) => holds.membranes,
            _ => holds.volumes,
        };
        if let Some(part) = parts.contents.iter().find(|part| !holds_content(part)) {
            let found = format!("a spring on the content of {}", named(network, &part.points));
            let advice = "objective = \"offdiag\" with nonnegative = true has springs between two points alone, and so has \"divergence\"";
            return unsupported("springs".into(), "springs between two points", found, advice);
        }
        check_angles(network, &parts.hinges, program, holds.hinges)?;
        let negative = parts.lengths.iter().filter(|spring| spring.constant < 0.0).count();
        if negative > 0 && !holds.negative {
            let advice = "a fit with nonnegative = true has none: --fit names another fit of the scene";
            let found = format!("{negative} of {} below zero", parts.lengths.len());
            return unsupported("springs".into(), "constants above zero", found, advice);
        }
        if let Some(part) = parts.contents.iter().find(|part| part.constant <= 0.0 || part.rest <= 0.0) {
            let (what, [of_constant, of_rest]) =
                if part.points.len() == 4 { ("volume", ["N/m⁵", "m³"]) } else { ("area", ["N/m³", "m²"]) };
            let at = named(network, &part.points);
            let found = format!("{:e} {of_constant} and {:e} {of_rest} at {at}", part.constant, part.rest);
            return unsupported(
                "springs".into(),
                &format!("{what} springs with constants and rest {what}s above zero"),
                found,
                "another fit has them",
            );
        }
        for held in network.held.iter().filter(|_| !holds.partial) {
            if held.displacement.iter().any(Option::is_none) {
                let found = format!("{} held along some axes", named(network, &[held.point]));
                let advice = "hold it along all axes, or none";
                return unsupported("held".into(), "points that are held in all directions", found, advice);
            }
        }
        if let Some(held) = network.held.iter().find(|held| held.displacement.iter().flatten().any(|u| *u != 0.0)) {
            let found = format!("{} moved", named(network, &[held.point]));
            return unsupported("held".into(), "supports at rest", found, "move it in the program");
        }
        let job = Job { network, parts, gravity: spatial(gravity, network), masses, step };
        if !holds.off_edges {
            job.check_edges(program)?;
        }
        match holds.tension {
            Tension::Any => {}
            Tension::Balanced => job.check_balance(program)?,
            Tension::None => job.check_slack(program)?,
        }
        if free == 0 {
            return Err(Error::expected("held", "a point that is free to move", "none"));
        }
        Ok(job)
    }

    /// The tetrahedra of the mesh; of a surface its triangles.
    pub fn simplices(&self) -> impl Iterator<Item = &'a [usize]> {
        // A quadrilateral has as many corners as a tetrahedron.
        let blocks = || self.network.cells.iter().filter(|block| block.vtk != Some(QUADRILATERAL));
        let cells = || blocks().flat_map(|block| &block.points).map(Vec::as_slice);
        let corners = if cells().any(|points| points.len() == 4) { 4 } else { 3 };
        cells().filter(move |points| points.len() == corners)
    }

    /// Points that are held along each axis.
    pub fn held_along(&self, axis: usize) -> Vec<usize> {
        let held = self.network.held.iter().filter(|held| held.displacement.get(axis).is_some_and(Option::is_some));
        held.map(|held| held.point).collect()
    }

    /// The springs with these points, of which the first `lengths` measure lengths, in the order of a sweep.
    pub fn order<S: AsRef<[usize]>>(&self, springs: &[S], lengths: usize, order: Order) -> Vec<usize> {
        let mut held = vec![false; self.masses.len()];
        for own in &self.network.held {
            held[own.point] = own.displacement.iter().all(Option::is_some);
        }
        let (points, dimension) = (&self.network.points.concat()[..], self.network.dimension);
        Sequence { springs, lengths, points, dimension, held: &held }.order(order)
    }

    /// The coordinates of a point, with z = 0 in the plane.
    pub fn place(&self, p: usize) -> [f64; 3] {
        let x = &self.network.points[p];
        [0, 1, 2].map(|k| x.get(k).copied().unwrap_or(0.0))
    }

    fn check_edges(&self, program: &str) -> Result<()> {
        let mut edges = HashSet::new();
        let corners: HashSet<Vec<usize>> = self.simplices().map(sorted).collect();
        for points in self.simplices() {
            edges.extend((0..points.len()).flat_map(|a| (0..a).map(move |b| ordered(points[a], points[b]))));
        }
        let cells = if corners.iter().any(|points| points.len() == 3) { "triangles" } else { "tetrahedra" };
        let content = if cells == "triangles" { "areas" } else { "volumes" };
        let expected = format!("springs along the edges of {cells} and on their {content}, which {program} holds");
        let advice =
            "; take a mesh of linear tetrahedra or of triangles, and for springs between cells leave `across` out";
        let error = |points: &[usize]| {
            let found = format!("one of {}", named(self.network, points));
            Error::expected("springs", &expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported)
        };
        if let Some(spring) = self.parts.lengths.iter().find(|s| !edges.contains(&ordered(s.points[0], s.points[1]))) {
            return Err(error(&spring.points));
        }
        if let Some(part) = self.parts.contents.iter().find(|part| !corners.contains(&sorted(&part.points))) {
            return Err(error(&part.points));
        }
        check_edges_of_hinges(self.network, &self.parts.hinges, program, &corners)
    }

    /// The area of a triangle, which has a sign in the plane, or the volume of a tetrahedron.
    fn content(&self, points: &[usize]) -> f64 {
        match *points {
            [a, b, c] => {
                let [a, b, c] = [a, b, c].map(|p| self.place(p));
                let area = area_vector([a, b, c]);
                if self.network.dimension == 2 { area[2] } else { norm(&area) }
            }
            _ => volume_by_edges(std::array::from_fn(|i| self.place(points[i]))).0,
        }
    }

    fn check_slack(&self, program: &str) -> Result<()> {
        let lengths = self.parts.lengths.iter().map(|spring| {
            let length = distance(self.place(spring.points[0]), self.place(spring.points[1]));
            (&spring.points[..], spring.rest / length)
        });
        let contents =
            self.parts.contents.iter().map(|part| (&part.points[..], part.rest / self.content(&part.points)));
        let Some((points, share)) = lengths.chain(contents).find(|(_, share)| !((share - 1.0).abs() <= BALANCED))
        else {
            return Ok(());
        };
        let expected = format!("springs that do not pull at rest, which {program} holds");
        let found = format!("a rest measure of {share:.3} of that in the mesh at {}", named(self.network, points));
        let advice = "; objective = \"offdiag\" with nonnegative = true has such springs, with springs = [\"edge\", \"bulk\"] on volumes as well";
        Err(Error::expected("springs", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported))
    }

    /// The derivative of the energy by the squared length of each edge at rest, `T/(2 ℓ)` of a spring and
    /// `K (V − V₀) ∂V/∂(ℓ²)` of a volume, has to vanish.
    fn check_balance(&self, program: &str) -> Result<()> {
        let mut sums: HashMap<[usize; 2], [f64; 2]> = HashMap::new();
        let mut add = |edge: [usize; 2], slope: f64, size: f64| {
            let sum = sums.entry(edge).or_default();
            sum[0] += slope;
            sum[1] += size.abs();
        };
        for spring in &self.parts.lengths {
            let [a, b] = spring.points;
            let length = distance(self.place(a), self.place(b));
            // Without a rest length the slope is k ℓ/(2 ℓ) = k/2, by which the sum is judged.
            add(ordered(a, b), spring.constant * (length - spring.rest) / (2.0 * length), spring.constant / 2.0);
        }
        for part in &self.parts.contents {
            let place = |corner: usize| self.place(part.points[corner]);
            let (content, slopes) = match part.points.len() {
                3 => area_by_edges(std::array::from_fn(place)),
                _ => volume_by_edges(std::array::from_fn(place)),
            };
            for ([a, b], slope) in slopes {
                let size = part.constant * content * slope;
                add(ordered(part.points[a], part.points[b]), size * (1.0 - part.rest / content), size);
            }
        }
        let largest = sums.values().map(|sum| sum[1]).fold(0.0, f64::max);
        // The first of them by its points: a map has no order.
        match sums.iter().filter(|(_, sum)| !(sum[0].abs() <= BALANCED * largest)).min_by_key(|(edge, _)| **edge) {
            None => Ok(()),
            Some((edge, _)) => {
                let expected =
                    format!("springs that do not pull at rest, or balance edge by edge, which {program} holds");
                let advice =
                    "; objective = \"exact\" without nonnegative balances, and fits with rest = \"mesh\" do not pull";
                let error =
                    Error::expected("springs", expected, format!("tension between {}", named(self.network, edge)));
                Err(error.followed_by(advice).of_kind(ErrorKind::Unsupported))
            }
        }
    }
}

fn free_points(network: &NetworkRecord) -> usize {
    let held = network.held.iter().filter(|held| held.displacement.iter().all(Option::is_some)).count();
    network.points.len() - held
}

/// The gravity that is exported, m/s², `[dimension]`: that which is asked for, that of the network, or 9.81 m/s² against the last axis.
pub fn used_gravity(network: &NetworkRecord, asked: Option<&[f64]>) -> Vec<f64> {
    spatial(asked, network)[..network.dimension].to_vec()
}

/// The gravity that is asked for, that of the network, or 9.81 m/s² against the last axis; with z = 0 in the plane.
pub(super) fn spatial(asked: Option<&[f64]>, network: &NetworkRecord) -> [f64; 3] {
    // Down is along −y in the plane and along −z in space.
    let usual = if network.dimension == 2 { [0.0, -9.81, 0.0] } else { [0.0, 0.0, -9.81] };
    let given = asked.or(network.gravity.as_deref());
    given.map_or(usual, |given| [0, 1, 2].map(|k| given.get(k).copied().unwrap_or(0.0)))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    springfit_element::springs::distance(&a, &b)
}

/// The area of a triangle times its unit normal.
fn area_vector([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let edge = |end: [f64; 3]| [0, 1, 2].map(|k| end[k] - a[k]);
    cross(edge(b), edge(c)).map(|twice| twice / 2.0)
}

/// The area A of a triangle in space, and `∂A/∂(ℓ²) = (ℓ_b² + ℓ_c² − ℓ²)/(16 A)` of its edges, from `16 A² = 4 ℓ_b² ℓ_c² − (ℓ_b² + ℓ_c² − ℓ²)²`.
fn area_by_edges(x: [[f64; 3]; 3]) -> (f64, Vec<([usize; 2], f64)>) {
    let edges = [[0, 1], [1, 2], [0, 2]];
    let squares = edges.map(|[a, b]| distance(x[a], x[b]).powi(2));
    let sum: f64 = squares.iter().sum();
    // The cross product has all digits of the area of a thin triangle, of which Heron's formula with the squares loses
    // half.
    let area = norm(&area_vector(x));
    (area, edges.into_iter().zip(squares).map(|(edge, square)| (edge, (sum - 2.0 * square) / (16.0 * area))).collect())
}

/// The volume V of a tetrahedron, and `∂V/∂(ℓ²)` of its edges: `∇V` at node a is `Σ_b 2 ∂V/∂(ℓ_ab²) (x_a − x_b)`, so that with the
/// gradients G of its shape functions the derivative is `−V G_a·G_b/2`.
fn volume_by_edges(x: [[f64; 3]; 4]) -> (f64, Vec<([usize; 2], f64)>) {
    let edge = |a: usize| [0, 1, 2].map(|k| x[a][k] - x[0][k]);
    let dot = |a: [f64; 3], b: [f64; 3]| dot(&a, &b);
    let [u, v, w] = [edge(1), edge(2), edge(3)];
    let six = dot(u, cross(v, w));
    let ahead = [cross(v, w), cross(w, u), cross(u, v)].map(|g| g.map(|g| g / six));
    let first = [0, 1, 2].map(|k| -(ahead[0][k] + ahead[1][k] + ahead[2][k]));
    let gradients = [first, ahead[0], ahead[1], ahead[2]];
    let volume = six / 6.0;
    let slope = |[a, b]: [usize; 2]| ([a, b], -volume * dot(gradients[a], gradients[b]) / 2.0);
    (volume, (0..4).flat_map(|a| (0..a).map(move |b| [b, a])).map(slope).collect())
}
