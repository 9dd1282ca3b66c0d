//! The mass-spring model: springs on the points of a mesh.

use super::Entries;
use super::numbering::dofs;
use super::steady::steady_law;
use crate::element::SpringKind;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{Law, Measure, Turns, distance, linear};
use crate::stiffness::gathered;
use faer::sparse::Triplet;
use smallvec::SmallVec;
use std::sync::Arc;

/// A linear spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthSpring {
    /// Its points, the lower index first.
    pub points: [usize; 2],
    /// The spring constant, N/m.
    pub constant: f64,
    /// The rest length, m.
    pub rest: f64,
}

impl LengthSpring {
    /// Energy (J), force (N) and its slope (N/m) at a length in m.
    pub fn pull(&self, length: f64) -> [f64; 3] {
        linear(self.constant, length - self.rest)
    }

    /// What its tangent is over its constant, at the points as they are.
    pub(super) fn along(&self, points: &[f64], d: usize) -> Along {
        let [i, j] = self.points;
        let (xi, xj) = (&points[i * d..(i + 1) * d], &points[j * d..(j + 1) * d]);
        let length = distance(xi, xj);
        let mut n = [0.0; 3];
        n.iter_mut().zip(xi.iter().zip(xj)).for_each(|(n, (a, b))| *n = (b - a) / length);
        // A spring of no rest length may have no length either, where the quotient is 0/0. Its tangent is the identity
        // at every length.
        Along { share: if self.rest == 0.0 { 0.0 } else { self.rest / length }, direction: n }
    }

    /// The force divided by the length, N/m. It is the constant if the rest length is zero.
    #[inline(always)]
    pub(super) fn stress(&self, length: f64) -> f64 {
        // Without a rest length the force is `k ℓ n`, whose quotient by ℓ is k even at ℓ = 0, where the general form
        // divides by zero.
        if self.rest == 0.0 { self.constant } else { self.constant * (length - self.rest) / length }
    }

    /// Whether the force has a direction at this length. With a rest length of zero it always has.
    #[inline(always)]
    pub(super) fn has_direction(&self, length: f64) -> bool {
        length > 0.0 || self.rest == 0.0
    }
}

/// `(1 − L₀/ℓ) I + (L₀/ℓ) n nᵀ`: n nᵀ of springs that do not pull at rest, I of those without a rest length.
pub(super) struct Along {
    /// L₀/ℓ.
    share: f64,
    /// n.
    direction: [f64; 3],
}

impl Along {
    #[inline(always)]
    pub(super) fn entry(&self, k: usize, l: usize) -> f64 {
        let across = if k == l { 1.0 - self.share } else { 0.0 };
        across + self.share * self.direction[k] * self.direction[l]
    }
}

/// A spring with another measure of some points (an angle, an area, a volume, a coupling, a user's expression) or with
/// a force law.
#[derive(Debug, Clone)]
pub struct MeasureSpring {
    /// The kind of spring.
    pub kind: SpringKind,
    /// Its points, in the order of the measure; those of a tetrahedron are stored in the spring.
    pub points: SmallVec<[usize; 4]>,
    /// The spring constant, in J divided by the square of the measure's unit: N/m³ for an area, N/m⁵ for a volume, N·m
    /// for an angle.
    pub constant: f64,
    /// The measure at rest, in m, m², m³ or rad.
    pub rest: f64,
    /// What it measures.
    pub measure: Measure,
    /// The force law, unless the force is `constant · (c − rest)`. With a law the constant is its slope at rest. It is behind a pointer,
    /// because most springs of a body have none.
    pub law: Option<Box<SpringLaw>>,
}

/// A law of force with the parameters of one spring.
#[derive(Debug, Clone)]
pub struct SpringLaw {
    /// The law.
    pub law: Arc<Law>,
    /// Its parameters, in the order of [`Law::parameters`], in its units; two are stored here, more on the heap.
    pub parameters: SmallVec<[f64; 2]>,
}

impl SpringLaw {
    /// A law with these parameters.
    pub fn new(law: Arc<Law>, parameters: &[f64]) -> SpringLaw {
        SpringLaw { law, parameters: SmallVec::from_slice(parameters) }
    }

    /// The force if the spring measures c, and `rest` at rest.
    pub fn force(&self, c: f64, rest: f64) -> f64 {
        self.law.force(c, rest, &self.parameters)
    }

    /// The slope of the force, as [`SpringLaw::force`].
    pub fn slope(&self, c: f64, rest: f64) -> f64 {
        self.law.slope(c, rest, &self.parameters)
    }

    /// Energy, force and its slope, as [`SpringLaw::force`].
    pub fn pull(&self, c: f64, rest: f64) -> [f64; 3] {
        [self.law.energy(c, rest, &self.parameters), self.force(c, rest), self.slope(c, rest)]
    }
}

impl MeasureSpring {
    /// A spring that measures c at rest, with the slope k and the force T there, for which [`is_steady`] holds.
    pub(super) fn steady(
        kind: SpringKind,
        points: SmallVec<[usize; 4]>,
        measure: Measure,
        c: f64,
        [k, t]: [f64; 2],
    ) -> MeasureSpring {
        let law = Some(Box::new(SpringLaw::new(steady_law(), &[t, k])));
        MeasureSpring { kind, points, constant: k, rest: c, measure, law }
    }

    /// A spring on a sum of turns, at rest at the positions x of its points, `[points × 3]`, m.
    pub(super) fn turning(
        kind: SpringKind,
        points: SmallVec<[usize; 4]>,
        x: &[f64],
        turns: Turns,
        constant: f64,
    ) -> MeasureSpring {
        let measure = Measure::Turns(Box::new(turns));
        MeasureSpring { kind, points, constant, rest: measure.value(x, 3), measure, law: None }
    }

    /// Energy, force and its slope if the measure is c.
    pub fn pull(&self, c: f64) -> [f64; 3] {
        match &self.law {
            None => linear(self.constant, c - self.rest),
            Some(law) => law.pull(c, self.rest),
        }
    }

    /// Makes it pull `factor` times as hard. Of a law the parameters to which the force is proportional are scaled.
    pub fn scale(&mut self, factor: f64) {
        self.constant *= factor;
        let Some(SpringLaw { law, parameters }) = self.law.as_deref_mut() else { return };
        parameters.iter_mut().zip(law.outer()).filter(|(_, outer)| **outer).for_each(|(p, _)| *p *= factor);
    }

    /// `k g gᵀ + T H` at the points as they are, `[points · d × points · d]`: the slope, the gradient, the force, the second derivatives.
    pub fn tangent(&self, points: &[f64], d: usize, entries: &mut [f64]) {
        let x = gathered(points, d, &self.points);
        let mut gradient = Vec::new();
        let [_, pull, slope] = self.pull(self.measure.both(&x, d, &mut gradient));
        // Springs that do not pull at rest need no second derivatives.
        let bend = if pull == 0.0 { Vec::new() } else { self.measure.jet(&x, d).hessian };
        for (at, entry) in entries.iter_mut().enumerate() {
            let bent = bend.get(at).map_or(0.0, |h| pull * h);
            *entry = slope * gradient[at / x.len()] * gradient[at % x.len()] + bent;
        }
    }

    /// The law of force, if it is a function of the program, which is quicker when it is asked for many springs at once.
    pub(super) fn function(&self) -> Option<&SpringLaw> {
        self.law.as_deref().filter(|own| own.law.is_function())
    }

    /// The force of [`MeasureSpring::pull`] alone; the energy of a law is an integral.
    pub fn tension(&self, c: f64) -> f64 {
        match &self.law {
            None => linear(self.constant, c - self.rest)[1],
            Some(law) => law.force(c, self.rest),
        }
    }
}

/// Springs on the points of a mesh. Springs with a constant of zero are left out.
#[derive(Debug, Clone, Default)]
pub struct Network {
    /// The number of coordinates of a point.
    pub dimension: usize,
    /// The linear springs between two points, sorted by their points.
    pub lengths: Vec<LengthSpring>,
    /// All other springs, cell after cell.
    pub others: Vec<MeasureSpring>,
}

impl Network {
    /// The springs of both networks on the same points. Two springs between the same points without a rest length are one.
    pub fn joined(mut self, other: Network) -> Network {
        self.lengths.extend(other.lengths);
        // The order of equal springs is kept, so that their sum has the same bits in each run.
        self.lengths.sort_by_key(|spring| spring.points);
        self.lengths.dedup_by(|later, first| {
            let is_same = later.points == first.points && later.rest == 0.0 && first.rest == 0.0;
            if is_same {
                first.constant += later.constant;
            }
            is_same
        });
        self.others.extend(other.others);
        self
    }

    /// Checks that the law of force of every spring is an expression, which files hold.
    ///
    /// # Errors
    /// One is a function of the program; the kind is `Unsupported`.
    pub fn check_formulas(&self) -> Result<()> {
        match self.others.iter().filter_map(|spring| spring.law.as_ref()).find(|own| own.law.is_function()) {
            Some(own) => {
                let law = &own.law;
                let found = format!("the function {}", law.text);
                let expected = "laws of force that are expressions, which a file can hold";
                Err(Error::expected("force", expected, found).of_kind(ErrorKind::Unsupported))
            }
            None => Ok(()),
        }
    }

    /// The tangent stiffness at rest, `Σ_s k_s g_s g_sᵀ`, N/m, with the points of the mesh, `[points × dimension]`, m.
    pub fn stiffness(&self, points: &[f64]) -> Entries {
        let d = self.dimension;
        let mut entries = Entries::with_capacity(self.entries());
        for spring in &self.lengths {
            let [i, j] = spring.points;
            let along = spring.along(points, d);
            for (k, l) in (0..d).flat_map(|k| (0..d).map(move |l| (k, l))) {
                let value = spring.constant * along.entry(k, l);
                if l <= k {
                    entries.push(Triplet::new(i * d + k, i * d + l, value));
                    entries.push(Triplet::new(j * d + k, j * d + l, value));
                }
                entries.push(Triplet::new(j * d + k, i * d + l, -value));
            }
        }
        let (mut sum, mut own) = (Vec::new(), Vec::new());
        // Springs on the same points are summed first: a list of entries takes more memory than the matrix.
        for springs in self.on_same_points() {
            let of = &springs[0].points;
            let n = of.len() * d;
            sum.clear();
            sum.resize(n * n, 0.0);
            own.resize(n * n, 0.0);
            for spring in springs {
                spring.tangent(points, d, &mut own);
                sum.iter_mut().zip(&own).for_each(|(sum, own)| *sum += own);
            }
            for (a, row) in dofs(of, d).enumerate() {
                for (b, column) in dofs(of, d).enumerate().filter(|(_, column)| row >= *column) {
                    entries.push(Triplet::new(row, column, sum[a * n + b]));
                }
            }
        }
        entries
    }

    /// The other springs in runs on the same points, such as the volume springs of one cell at its quadrature points: their stiffness has the entries
    /// of one.
    pub(super) fn on_same_points(&self) -> impl Iterator<Item = &[MeasureSpring]> {
        self.others.chunk_by(|a, b| a.points == b.points)
    }

    /// The network whose springs pull `factors` times as hard, `[springs]`, length springs first. For a law the
    /// parameters to which the force is proportional are scaled.
    pub fn scaled(&self, factors: &[f64]) -> Network {
        let mut network = self.clone();
        let (lengths, others) = factors.split_at(network.lengths.len());
        network.lengths.iter_mut().zip(lengths).for_each(|(s, factor)| s.constant *= factor);
        network.others.iter_mut().zip(others).for_each(|(spring, factor)| spring.scale(*factor));
        network
    }

    /// The points and the constant of each spring, length springs first.
    pub fn springs(&self) -> impl Iterator<Item = (&[usize], f64)> {
        let lengths = self.lengths.iter().map(|s| (&s.points[..], s.constant));
        lengths.chain(self.others.iter().map(|s| (&s.points[..], s.constant)))
    }

    /// The number of springs.
    pub fn len(&self) -> usize {
        self.lengths.len() + self.others.len()
    }

    /// Whether there are no springs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The ratio of the largest to the least constant of the length springs.
    pub fn range(&self) -> f64 {
        let constants = || self.lengths.iter().map(|s| s.constant);
        // Without springs on lengths the quotient is zero over infinity, zero.
        constants().fold(0.0, f64::max) / constants().fold(f64::INFINITY, f64::min)
    }

    /// The number of negative constants.
    pub fn negative(&self) -> usize {
        self.negative_springs().count()
    }

    /// The `count` springs with the most negative constants: their points and constants, the least first.
    pub fn most_negative(&self, count: usize) -> Vec<(&[usize], f64)> {
        let mut springs: Vec<(&[usize], f64)> = self.negative_springs().collect();
        // The sort is stable: of equal constants the first springs of the network are named on each machine.
        springs.sort_by(|a, b| a.1.total_cmp(&b.1));
        springs.truncate(count);
        springs
    }

    fn negative_springs(&self) -> impl Iterator<Item = (&[usize], f64)> {
        self.springs().filter(|(_, k)| *k < 0.0)
    }
}
