//! The loop of an engine: steps of a network with its geometry as it moves.

use super::model::TruncatedModel;
use super::order::point_order;
use super::sequence::Sequence;
use super::setting::{Engine, Setting, Sweep};
use crate::error::{Error, ErrorKind, Result};
use crate::model::Support;
use crate::scalar::of_dimension;

/// A network that is moved by the steps of an engine.
///
/// The linearised sweeps say where a body rests; these are the steps that an engine makes, whose measures and gradients are those of the
/// points where they are. Under a small load both rest in the same place.
#[derive(Debug)]
pub struct Frames {
    dimension: usize,
    /// In the order of a sweep.
    rows: Vec<Row>,
    /// Each free point in the order of a sweep, with its springs and its place in each.
    sets: Vec<(usize, Vec<(usize, usize)>)>,
    rest: Vec<f64>,
    points: Vec<f64>,
    velocities: Vec<f64>,
    /// W, `[dofs]`, 1/kg; zero where points are held.
    inverse: Vec<f64>,
    /// λ, `[rows]`.
    multipliers: Vec<f64>,
    before: Vec<f64>,
    predicted: Vec<f64>,
    setting: Setting,
}

/// Points of a spring at most: those of a tetrahedron.
const MOST: usize = 4;

/// A spring on a length or on the content of a simplex.
#[derive(Debug)]
struct Row {
    points: [usize; MOST],
    count: usize,
    rest: f64,
    /// The sign of the content at rest.
    sign: f64,
    constant: f64,
    /// `1/(k h²)`.
    softness: f64,
    relaxation: f64,
}

impl Frames {
    /// The network at rest.
    ///
    /// # Errors
    /// The engine does not hold the springs, or a point has no mass: kind `Unsupported`.
    pub fn new(model: TruncatedModel, support: &Support, setting: &Setting) -> Result<Frames> {
        model.check(support)?;
        let d = model.network.dimension;
        if !(1..=3).contains(&d) {
            let expected = "a body of 1 to 3 dimensions";
            return Err(Error::expected("engine", expected, d).of_kind(ErrorKind::Unsupported));
        }
        let TruncatedModel { network, points, masses } = model;
        let inverse: Vec<f64> =
            (0..points.len()).map(|dof| if support.is_fixed(dof) { 0.0 } else { 1.0 / masses[dof / d] }).collect();
        let sets: Vec<&[usize]> = network.springs().map(|(points, _)| points).collect();
        let held: Vec<bool> = inverse.chunks_exact(d).map(|w| w.iter().all(|w| *w == 0.0)).collect();
        let lengths = network.lengths.len();
        let sequence = Sequence { springs: &sets, lengths, points, dimension: d, held: &held };
        let constants: Vec<f64> = network.springs().map(|(_, constant)| constant).collect();
        let rests = network.lengths.iter().map(|s| s.rest).chain(network.others.iter().map(|s| s.rest));
        let rests: Vec<f64> = rests.collect();
        let square = setting.substep().powi(2);
        // Vertex block descent goes over the points; its springs stay in their order.
        let order = if setting.is_by_points() { (0..sets.len()).collect() } else { sequence.order(setting.order) };
        let row = |spring: usize| {
            let own = sets[spring];
            let mut row = Row {
                points: [0; MOST],
                count: own.len(),
                rest: rests[spring],
                sign: 1.0,
                constant: constants[spring],
                softness: 1.0 / (constants[spring] * square),
                relaxation: match setting.engine == Engine::NewtonXpbd && spring < lengths {
                    true => 1.0,
                    false => setting.relaxation,
                },
            };
            row.points[..own.len()].copy_from_slice(own);
            // A simplex may be numbered either way round; its content is positive at rest.
            row.sign = of_dimension!(d, |D| row.measure::<D>(points).0.signum());
            row
        };
        let rows: Vec<Row> = order.into_iter().map(row).collect();
        let mut of_point: Vec<Vec<(usize, usize)>> = vec![Vec::new(); held.len()];
        for (place, row) in rows.iter().enumerate() {
            row.points[..row.count].iter().enumerate().for_each(|(corner, &p)| of_point[p].push((place, corner)));
        }
        let by_points = if setting.is_by_points() { point_order(setting.order, &sets, held.len()) } else { Vec::new() };
        let free = by_points.into_iter().filter(|p| !held[*p]);
        Ok(Frames {
            dimension: d,
            sets: free.map(|p| (p, std::mem::take(&mut of_point[p]))).collect(),
            multipliers: vec![0.0; rows.len()],
            rows,
            rest: points.to_vec(),
            points: points.to_vec(),
            velocities: vec![0.0; points.len()],
            before: points.to_vec(),
            predicted: points.to_vec(),
            inverse,
            setting: *setting,
        })
    }

    /// Puts the points at these displacements, `[points · dimension]`, m, without velocities. Held ones stay at rest.
    pub fn start(&mut self, displacement: &[f64]) {
        for (dof, u) in displacement.iter().enumerate().filter(|(dof, _)| self.inverse[*dof] > 0.0) {
            self.points[dof] = self.rest[dof] + u;
        }
        self.velocities.fill(0.0);
    }

    /// Makes a step of the engine, which is all of its substeps, under nodal forces, `[points · dimension]`, N.
    pub fn step(&mut self, forces: &[f64]) {
        let h = self.setting.substep();
        for _ in 0..self.setting.substeps {
            self.before.copy_from_slice(&self.points);
            for (dof, force) in forces.iter().enumerate() {
                self.points[dof] += h * (self.velocities[dof] + h * self.inverse[dof] * force);
            }
            match self.setting.is_by_points() {
                true => of_dimension!(self.dimension, |D| self.descend::<D>()),
                false => of_dimension!(self.dimension, |D| self.project::<D>()),
            }
            for dof in 0..self.points.len() {
                // Engines of positions have no other velocity than that of the corrected positions: what a correction
                // takes away is lost to the motion as well.
                self.velocities[dof] = (self.points[dof] - self.before[dof]) / h;
            }
        }
    }

    /// Multiplies the velocities by a factor.
    pub fn slow(&mut self, factor: f64) {
        self.velocities.iter_mut().for_each(|v| *v *= factor);
    }

    /// The displacements, `[points · dimension]`, m.
    pub fn displacement(&self) -> Vec<f64> {
        self.points.iter().zip(&self.rest).map(|(x, rest)| x - rest).collect()
    }

    /// The sweeps of extended position-based dynamics.
    fn project<const D: usize>(&mut self) {
        // XPBD begins each substep without multipliers; the fit is for that.
        self.multipliers.fill(0.0);
        for _ in 0..self.setting.iterations {
            if self.setting.sweep == Sweep::Jacobi {
                self.predicted.copy_from_slice(&self.points);
            }
            for (row, multiplier) in self.rows.iter().zip(&mut self.multipliers) {
                // Vertex block descent does not come here, so that the list of its predictions is free.
                let from = if self.setting.sweep == Sweep::Jacobi { &self.predicted } else { &self.points };
                let (measure, gradient) = row.measure::<D>(from);
                let mut stiff = row.softness;
                for (p, g) in row.points[..row.count].iter().zip(&gradient) {
                    stiff += (0..D).map(|i| self.inverse[p * D + i] * g[i] * g[i]).sum::<f64>();
                }
                let step = -row.relaxation * (measure - row.rest + row.softness * *multiplier) / stiff;
                *multiplier += step;
                for (p, g) in row.points[..row.count].iter().zip(&gradient) {
                    for i in 0..D {
                        self.points[p * D + i] += self.inverse[p * D + i] * g[i] * step;
                    }
                }
            }
        }
    }

    /// The sweeps of vertex block descent, without the curvature of the measures.
    fn descend<const D: usize>(&mut self) {
        let square = self.setting.substep().powi(2);
        self.predicted.copy_from_slice(&self.points);
        for _ in 0..self.setting.iterations {
            for (point, springs) in &self.sets {
                let first = point * D;
                let (mut force, mut block) = ([0.0; D], [[0.0; D]; D]);
                for &(place, corner) in springs {
                    let row = &self.rows[place];
                    let (measure, gradient) = row.measure::<D>(&self.points);
                    let (g, pull) = (gradient[corner], row.constant * (measure - row.rest));
                    for i in 0..D {
                        force[i] -= pull * g[i];
                        for j in 0..D {
                            block[i][j] += row.constant * g[i] * g[j];
                        }
                    }
                }
                for i in 0..D {
                    let weight = self.inverse[first + i];
                    if weight > 0.0 {
                        let inertia = 1.0 / (weight * square);
                        force[i] -= inertia * (self.points[first + i] - self.predicted[first + i]);
                        block[i][i] += inertia;
                    } else {
                        // A direction that is held does not move.
                        force[i] = 0.0;
                        block[i] = [0.0; D];
                        block.iter_mut().for_each(|row| row[i] = 0.0);
                        block[i][i] = 1.0;
                    }
                }
                let step = solved(block, force);
                for i in 0..D {
                    self.points[first + i] += self.setting.relaxation * step[i];
                }
            }
        }
    }
}

/// The solution of positive definite equations, by elimination.
fn solved<const D: usize>(mut a: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
    for i in 0..D {
        for k in i + 1..D {
            // Pivots of positive definite equations are above zero, and no rows are exchanged.
            let factor = a[k][i] / a[i][i];
            for j in i..D {
                a[k][j] -= factor * a[i][j];
            }
            b[k] -= factor * b[i];
        }
    }
    for i in (0..D).rev() {
        let known: f64 = (i + 1..D).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

impl Row {
    /// The measure, and its gradient in each of the points.
    #[inline(always)]
    fn measure<const D: usize>(&self, points: &[f64]) -> (f64, [[f64; D]; MOST]) {
        let mut gradient = [[0.0; D]; MOST];
        let origin = self.points[0] * D;
        let from = |corner: usize| {
            let at = self.points[corner] * D;
            std::array::from_fn::<f64, D, _>(|i| points[at + i] - points[origin + i])
        };
        let value;
        if self.count == 2 {
            let along = from(1);
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            value = length;
            // Points in one place have no direction in which the spring could push.
            gradient[1] = along.map(|x| if length > 0.0 { x / length } else { 0.0 });
        } else if D == 2 {
            let (u, v) = (from(1), from(2));
            value = 0.5 * (u[0] * v[1] - u[1] * v[0]);
            (gradient[1][0], gradient[1][1]) = (0.5 * v[1], -0.5 * v[0]);
            (gradient[2][0], gradient[2][1]) = (-0.5 * u[1], 0.5 * u[0]);
        } else {
            let edges = [from(1), from(2), from(3)];
            for corner in 0..3 {
                let (v, w) = (edges[(corner + 1) % 3], edges[(corner + 2) % 3]);
                for i in 0..D {
                    let (j, k) = ((i + 1) % D, (i + 2) % D);
                    gradient[corner + 1][i] = (v[j] * w[k] - v[k] * w[j]) / 6.0;
                }
            }
            value = (0..D).map(|i| edges[0][i] * gradient[1][i]).sum::<f64>();
        }
        for i in 0..D {
            // No measure sees a shift of all points.
            gradient[0][i] = -(1..self.count).map(|corner| gradient[corner][i]).sum::<f64>();
        }
        if self.sign < 0.0 {
            gradient.iter_mut().flatten().for_each(|g| *g = -*g);
            return (-value, gradient);
        }
        (value, gradient)
    }
}
