//! Springs between two points; those with rest length zero are separate because they need no square root.

use crate::model::network::{LengthSpring, MeasureSpring};
use crate::scalar::{Coordinate, Coordinates};
use crate::springs::Measure;

/// Length springs of rest length zero, `f_i = Σ_j k_ij (x_i − x_j)`, each in the rows of both of its points, so that a
/// row does not depend on the forces of other rows.
#[derive(Debug)]
pub struct Edges<N> {
    /// `[rows + 1]`.
    starts: Vec<usize>,
    columns: Vec<u32>,
    constants: Vec<N>,
}

impl<N: Coordinate> Edges<N> {
    pub fn new(lengths: &[&LengthSpring], place: &[usize], rows: usize) -> Edges<N> {
        let springs = || lengths.iter().filter(|s| s.rest == 0.0);
        let mut starts = vec![0; rows + 1];
        springs().flat_map(|s| s.points).for_each(|p| starts[place[p] + 1] += 1);
        (0..rows).for_each(|i| starts[i + 1] += starts[i]);
        let mut next = starts.clone();
        let (mut columns, mut constants) = (vec![0; starts[rows]], vec![N::zero(); starts[rows]]);
        for spring in springs() {
            let [i, j] = spring.points.map(|p| place[p]);
            for (row, column) in [(i, j), (j, i)] {
                columns[next[row]] = column as u32;
                constants[next[row]] = N::of(spring.constant);
                next[row] += 1;
            }
        }
        Edges { starts, columns, constants }
    }

    /// Writes the forces of the rows, as (z, x, y).
    #[inline(always)]
    pub fn pull<C: Coordinates<N>>(&self, zero: C, x: &[[N; 4]], force: &mut [[N; 4]]) {
        for (i, force) in force.iter_mut().enumerate() {
            let springs = self.starts[i]..self.starts[i + 1];
            let (xi, mut sum) = (zero.load(&x[i]), zero);
            for (&j, &k) in self.columns[springs.clone()].iter().zip(&self.constants[springs]) {
                sum = sum.plus_scaled(k, xi.minus(zero.load(&x[j as usize])));
            }
            // From (x, y, z) to (z, x, y): two turns of one place each.
            sum.turned().turned().store(force);
        }
    }
}

/// Length springs with a rest length or a law.
#[derive(Debug)]
pub struct Bars<N> {
    points: Vec<[u32; 2]>,
    constants: Vec<N>,
    rests: Vec<N>,
    lawful: Vec<([u32; 2], usize)>,
}

/// The number of bars whose square roots and quotients are computed together.
// It is a multiple of the numbers of any register, and the block, less than 2 kB, stays in the first cache.
const BLOCK: usize = 32;

impl<N: Coordinate> Bars<N> {
    /// `lawful` are the indices of the springs with a law on a length among the other springs of the network.
    pub fn new(lengths: &[&LengthSpring], others: &[MeasureSpring], lawful: &[usize], place: &[usize]) -> Bars<N> {
        let rows = |points: &[usize]| [place[points[0]] as u32, place[points[1]] as u32];
        let mut springs: Vec<_> = lengths.iter().filter(|s| s.rest != 0.0).collect();
        // In the order of the rows, so that positions of neighbours are still in the cache.
        springs.sort_by_key(|s| s.points.map(|p| place[p]).into_iter().min());
        Bars {
            points: springs.iter().map(|s| rows(&s.points)).collect(),
            constants: springs.iter().map(|s| N::of(s.constant)).collect(),
            rests: springs.iter().map(|s| N::of(s.rest)).collect(),
            lawful: lawful.iter().map(|&s| (rows(&others[s].points), s)).collect(),
        }
    }

    /// Adds `T n` at j and `−T n` at i; false if a bar has no direction or a law no force.
    #[inline(always)]
    pub fn pull<C: Coordinates<N>>(
        &self,
        zero: C,
        others: &[MeasureSpring],
        x: &[[N; 4]],
        force: &mut [[N; 4]],
    ) -> bool {
        let mut sound = true;
        let mut rs = [zero; BLOCK];
        let (mut lengths, mut stresses) = ([N::zero(); BLOCK], [N::zero(); BLOCK]);
        let blocks = self.points.chunks(BLOCK).zip(self.constants.chunks(BLOCK)).zip(self.rests.chunks(BLOCK));
        for ((points, constants), rests) in blocks {
            for ((r, square), [i, j]) in rs.iter_mut().zip(&mut lengths).zip(points) {
                *r = zero.load(&x[*j as usize]).minus(zero.load(&x[*i as usize]));
                *square = r.dot(*r);
            }
            let count = points.len();
            let (lengths, stresses) = (&mut lengths[..count], &mut stresses[..count]);
            for s in 0..count {
                lengths[s] = lengths[s].sqrt();
                stresses[s] = constants[s] * (lengths[s] - rests[s]) / lengths[s];
            }
            for s in 0..count {
                // The quotient was 0/0 or infinite without a length; the answer tells it, and no branch breaks the loop
                // above.
                sound &= lengths[s] > N::zero();
                add(stresses[s], rs[s], points[s], force);
            }
        }
        for &(points, spring) in &self.lawful {
            let [i, j] = points;
            let r = zero.load(&x[j as usize]).minus(zero.load(&x[i as usize]));
            let length = r.dot(r).sqrt();
            let tension = others[spring].tension(length.wide());
            sound &= tension.is_finite();
            add(N::of(tension) / length, r, points, force);
        }
        sound
    }
}

/// Whether a spring is on the distance of two points.
pub fn is_bar(spring: &MeasureSpring) -> bool {
    matches!(spring.measure, Measure::Length) && spring.points.len() == 2
}

/// Adds the force `stress · r` at j, and its opposite at i.
#[inline(always)]
pub fn add<N: Coordinate, C: Coordinates<N>>(stress: N, r: C, [i, j]: [u32; 2], force: &mut [[N; 4]]) {
    let pull = r.scaled(stress).turned().turned();
    let [i, j] = [i as usize, j as usize];
    let at = pull.load(&force[i]).minus(pull);
    at.store(&mut force[i]);
    let at = pull.load(&force[j]).plus(pull);
    at.store(&mut force[j]);
}
