//! Forces and tangent of a network, written into existing memory, as a simulation requires them at every step.

use super::functions::{function_pulls, function_tensions};
use super::network::{LengthSpring, MeasureSpring, Network};
use super::numbering::dofs;
use crate::scalar::of_dimension;
use crate::stiffness::gather;
use std::array::from_fn;

impl Network {
    /// Rows and columns of the entries of the tangent, in the lower triangle: for each spring, length springs first,
    /// its own lower triangle row by row.
    pub(super) fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let d = self.dimension;
        let lengths = self.lengths.iter().flat_map(move |spring| {
            let dof = move |a: usize| spring.points[a / d] * d + a % d;
            (0..2 * d).flat_map(move |a| (0..=a).map(move |b| (dof(a).max(dof(b)), dof(a).min(dof(b)))))
        });
        let others = self.others.iter().flat_map(move |spring| {
            let columns = dofs(&spring.points, d);
            dofs(&spring.points, d).flat_map(move |row| {
                columns.clone().filter(move |column| row >= *column).map(move |column| (row, column))
            })
        });
        lengths.chain(others)
    }

    /// The energy, J; `None` if it is not finite or a spring has no direction.
    pub(super) fn stored(&self, x: &[f64]) -> Option<f64> {
        let lengths = of_dimension!(self.dimension, |D| stored::<D>(&self.lengths, x));
        let mut total = lengths?;
        let mut local = Vec::new();
        let mut pulls = None;
        for spring in &self.others {
            let ask = || function_pulls(self.others.iter(), x, self.dimension).into_iter();
            // Functions of the program are asked for all of their springs at once, when the first is met: a call has
            // its price.
            let known = spring.function().and_then(|_| pulls.get_or_insert_with(ask).next());
            total += match known {
                Some([energy, ..]) => energy,
                None => {
                    local.resize(spring.points.len() * self.dimension, 0.0);
                    gather(x, self.dimension, &spring.points, &mut local);
                    spring.pull(spring.measure.value(&local, self.dimension))[0]
                }
            };
        }
        total.is_finite().then_some(total)
    }

    /// The gradient of the energy, `[points × dimension]`, N; false if there is none.
    pub(super) fn pull(&self, x: &[f64], force: &mut [f64]) -> bool {
        let sound = self.pull_lengths(x, force);
        // Without a short cut, so that forces are complete even if one spring has no direction.
        self.add_others(&self.others, x, force) & sound
    }

    /// The gradient of the energy of the springs between two points, `[points × dimension]`, N; false if one has no direction.
    pub(super) fn pull_lengths(&self, x: &[f64], force: &mut [f64]) -> bool {
        force.fill(0.0);
        let mut sound = true;
        self.visit_lengths(x, force, |spring, length| sound &= spring.has_direction(length));
        sound
    }

    /// Adds to the gradient what the springs between two points give, and tells `visit` the length of each.
    fn visit_lengths(&self, x: &[f64], force: &mut [f64], visit: impl FnMut(&LengthSpring, f64)) {
        of_dimension!(self.dimension, |D| pull::<D>(&self.lengths, x, force, visit))
    }

    /// Adds to the gradient what the springs between two points give. The largest of their pulls, and the largest that one would have with its
    /// whole length, N.
    pub(super) fn compare_lengths(&self, x: &[f64], force: &mut [f64]) -> [f64; 2] {
        let [mut largest, mut whole] = [0.0_f64; 2];
        self.visit_lengths(x, force, |spring, length| {
            largest = largest.max(spring.pull(length)[1].abs());
            whole = whole.max((spring.constant * length).abs());
        });
        [largest, whole]
    }

    /// Adds the forces of some of the other springs; false if one has no force.
    pub(super) fn add_others<'a>(
        &self,
        springs: impl IntoIterator<Item = &'a MeasureSpring, IntoIter: Clone>,
        x: &[f64],
        force: &mut [f64],
    ) -> bool {
        let (d, mut sound) = (self.dimension, true);
        self.each_tension(springs, x, |spring, tension, gradient| {
            sound &= tension.is_finite();
            dofs(&spring.points, d).zip(gradient).for_each(|(dof, g)| force[dof] += tension * g);
        });
        sound
    }

    /// Calls `visit(spring, T, ∇c)` with the tension and the gradient of what is measured, for some of the other springs.
    pub(super) fn each_tension<'a>(
        &self,
        springs: impl IntoIterator<Item = &'a MeasureSpring, IntoIter: Clone>,
        x: &[f64],
        mut visit: impl FnMut(&MeasureSpring, f64, &[f64]),
    ) {
        let d = self.dimension;
        let (mut local, mut gradient) = (Vec::new(), Vec::new());
        let springs = springs.into_iter();
        let (all, mut tensions) = (springs.clone(), None);
        for spring in springs {
            local.resize(spring.points.len() * d, 0.0);
            gather(x, d, &spring.points, &mut local);
            let ask = || function_tensions(all.clone(), x, d).into_iter();
            let known = spring.function().and_then(|_| tensions.get_or_insert_with(ask).next());
            let value = spring.measure.both(&local, d, &mut gradient);
            visit(spring, known.unwrap_or_else(|| spring.tension(value)), &gradient);
        }
    }

    /// Forces, the values of the tangent at [`Network::places`], and the energy. If the tangent is to be `definite`,
    /// the tangent of each spring is made positive semidefinite: that of a length spring by dropping negative factors,
    /// that of others by omitting the term with second derivatives.
    pub(super) fn pull_and_stiffen(
        &self,
        x: &[f64],
        force: &mut [f64],
        tangent: &mut [f64],
        definite: bool,
    ) -> Option<f64> {
        force.fill(0.0);
        let d = self.dimension;
        // The lower triangle of the 2 d rows of two points has `2 d (2 d + 1)/2` entries.
        let (lengths, others) = tangent.split_at_mut(self.lengths.len() * d * (2 * d + 1));
        let mut total = of_dimension!(d, |D| pull_and_stiffen::<D>(&self.lengths, x, force, lengths, definite))?;
        let mut values = others.iter_mut();
        let (mut local, mut gradient, mut hessian) = (Vec::new(), Vec::new(), Vec::new());
        let mut places: Vec<usize> = Vec::new();
        let mut pulls = None;
        for spring in &self.others {
            local.resize(spring.points.len() * d, 0.0);
            gather(x, d, &spring.points, &mut local);
            let value = if definite {
                spring.measure.both(&local, d, &mut gradient)
            } else {
                let jet = spring.measure.jet(&local, d);
                (gradient, hessian) = (jet.gradient, jet.hessian);
                jet.value
            };
            let ask = || function_pulls(self.others.iter(), x, d).into_iter();
            let known = spring.function().and_then(|_| pulls.get_or_insert_with(ask).next());
            let [energy, tension, slope] = known.unwrap_or_else(|| spring.pull(value));
            // `slope g gᵀ` with a slope of at least zero is semidefinite; the other term may have any sign.
            let slope = if definite { slope.max(0.0) } else { slope };
            total += energy;
            places.clear();
            places.extend(dofs(&spring.points, d));
            for (a, &row) in places.iter().enumerate() {
                force[row] += tension * gradient[a];
                for (b, &column) in places.iter().enumerate() {
                    if row >= column
                        && let Some(entry) = values.next()
                    {
                        let bend = if definite { 0.0 } else { tension * hessian[a * local.len() + b] };
                        *entry = slope * gradient[a] * gradient[b] + bend;
                    }
                }
            }
        }
        total.is_finite().then_some(total)
    }
}

/// `r = x_j − x_i` and its length.
#[inline(always)]
fn between<const D: usize>(x: &[[f64; D]], [i, j]: [usize; 2]) -> ([f64; D], f64) {
    let r: [f64; D] = from_fn(|k| x[j][k] - x[i][k]);
    (r, r.iter().map(|r| r * r).sum::<f64>().sqrt())
}

/// The energy `Σ ½ k (ℓ − L₀)²`.
fn stored<const D: usize>(springs: &[LengthSpring], x: &[f64]) -> Option<f64> {
    let (x, _) = x.as_chunks::<D>();
    let mut sound = true;
    let energy = |spring: &LengthSpring| {
        let (_, length) = between(x, spring.points);
        sound &= spring.has_direction(length);
        spring.constant * (length - spring.rest).powi(2) / 2.0
    };
    let total: f64 = springs.iter().map(energy).sum();
    sound.then_some(total)
}

/// Adds `T n` at j and `−T n` at i, with `T = k (ℓ − L₀)` and `n = r/ℓ`, and tells `visit` the length of each spring.
fn pull<const D: usize>(
    springs: &[LengthSpring],
    x: &[f64],
    force: &mut [f64],
    mut visit: impl FnMut(&LengthSpring, f64),
) {
    let ((x, _), (force, _)) = (x.as_chunks::<D>(), force.as_chunks_mut::<D>());
    for spring in springs {
        let [i, j] = spring.points;
        let (r, length) = between(x, spring.points);
        visit(spring, length);
        let t = spring.stress(length);
        for k in 0..D {
            force[i][k] -= t * r[k];
            force[j][k] += t * r[k];
        }
    }
}

/// Adds `T n` at j and `−T n` at i, with `T = k (ℓ − L₀)` and `n = r/ℓ`, and writes the tangent `±B`, `B = T/ℓ (I − n nᵀ) + k n nᵀ`;
/// negative factors are dropped if it is to be definite. Returns the energy.
fn pull_and_stiffen<const D: usize>(
    springs: &[LengthSpring],
    x: &[f64],
    force: &mut [f64],
    tangent: &mut [f64],
    definite: bool,
) -> Option<f64> {
    let ((x, _), (force, _)) = (x.as_chunks::<D>(), force.as_chunks_mut::<D>());
    let (mut sound, mut energy) = (true, 0.0);
    for (spring, tangent) in springs.iter().zip(tangent.chunks_exact_mut(D * (2 * D + 1))) {
        let [i, j] = spring.points;
        let (r, length) = between(x, spring.points);
        let change = length - spring.rest;
        let t = spring.stress(length);
        let [across, along] = if definite { [t.max(0.0), spring.constant.max(0.0)] } else { [t, spring.constant] };
        // Without a rest length the tangent is k I in any direction, also at length zero, where the quotient has no
        // value.
        let along = if spring.rest == 0.0 { 0.0 } else { (along - across) / (length * length) };
        sound &= spring.has_direction(length);
        energy += spring.constant * change * change / 2.0;
        for k in 0..D {
            force[i][k] -= t * r[k];
            force[j][k] += t * r[k];
        }
        let b: [[f64; D]; D] = from_fn(|k| from_fn(|l| along * r[k] * r[l] + if k == l { across } else { 0.0 }));
        let mut at = 0;
        for k in 0..D {
            // Entries come in the order in which they are listed: the rows of the first point, then those of the second
            // with both blocks.
            tangent[at..=at + k].copy_from_slice(&b[k][..=k]);
            at += k + 1;
        }
        for k in 0..D {
            for l in 0..D {
                tangent[at + l] = -b[k][l];
            }
            tangent[at + D..=at + D + k].copy_from_slice(&b[k][..=k]);
            at += D + k + 1;
        }
    }
    sound.then_some(energy)
}
