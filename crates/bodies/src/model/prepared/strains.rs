//! Springs on weighted sums of squared distances. Those on the same distances share them.
//!
//! With the tensions `T_m = k_m (Σ_i w_mi ℓ_i² − c_m⁰)` a distance from a to b pulls with `2 Σ_m T_m w_mi (x_b − x_a)`.

use super::edges::add;
use crate::model::network::{MeasureSpring, Network};
use crate::scalar::{Coordinate, Coordinates};
use crate::springs::{Measure, Squares};

/// The most distances of a domain: the edges of two triangles.
const SQUARES: usize = 5;
/// The most springs of a domain: one for each component of a strain.
const SPRINGS: usize = 3;

/// Up to three springs on the same distances; unused entries have weights of zero.
#[derive(Debug, Clone, Copy)]
struct Domain<N> {
    pairs: [[u32; 2]; SQUARES],
    /// `[distances][springs]`.
    weights: [[N; SPRINGS]; SQUARES],
    /// `2 k` and `2 k c⁰`.
    slopes: [N; SPRINGS],
    pulls: [N; SPRINGS],
}

/// The domains of a part.
#[derive(Debug)]
pub struct Strains<N> {
    domains: Vec<Domain<N>>,
}

impl<N: Coordinate> Strains<N> {
    /// The domains of these springs, which follow each other where they are those of one.
    pub fn new(network: &Network, springs: &[usize], place: &[usize]) -> Strains<N> {
        let mut domains: Vec<Domain<N>> = Vec::new();
        let mut count = 0;
        for &s in springs {
            let spring = &network.others[s];
            let Measure::Squares(squares) = &spring.measure else { continue };
            // Pairs that a domain does not use are of the first row with itself: their distance is zero and adds
            // nothing.
            let mut pairs = [[0; 2]; SQUARES];
            let mut own = [0.0; SQUARES];
            for (i, (places, weight)) in squares.iter().enumerate() {
                pairs[i] = places.map(|p| place[spring.points[p]] as u32);
                own[i] = weight;
            }
            if count == SPRINGS || domains.last().is_none_or(|last| last.pairs != pairs) {
                let zero = N::zero();
                let (slopes, pulls) = ([zero; SPRINGS], [zero; SPRINGS]);
                domains.push(Domain { pairs, weights: [[zero; SPRINGS]; SQUARES], slopes, pulls });
                count = 0;
            }
            if let Some(last) = domains.last_mut() {
                last.weights.iter_mut().zip(own).for_each(|(weights, own)| weights[count] = N::of(own));
                // The gradient of a squared distance is 2 r, whose factor is taken into the constants here.
                last.slopes[count] = N::of(2.0 * spring.constant);
                last.pulls[count] = N::of(2.0 * spring.constant * spring.rest);
                count += 1;
            }
        }
        Strains { domains }
    }

    /// Adds the forces of the rows, as (z, x, y); false if a spring has none.
    #[inline(always)]
    pub fn pull<C: Coordinates<N>>(&self, zero: C, x: &[[N; 4]], force: &mut [[N; 4]]) -> bool {
        let mut sound = true;
        for Domain { pairs, weights, slopes, pulls } in &self.domains {
            let rs: [C; SQUARES] = pairs.map(|[a, b]| zero.load(&x[b as usize]).minus(zero.load(&x[a as usize])));
            let mut measures = [N::zero(); SPRINGS];
            for (r, weights) in rs.iter().zip(weights) {
                let square = r.dot(*r);
                (0..SPRINGS).for_each(|m| measures[m] = measures[m] + weights[m] * square);
            }
            let tensions: [N; SPRINGS] = std::array::from_fn(|m| slopes[m] * measures[m] - pulls[m]);
            for ((r, weights), pair) in rs.into_iter().zip(weights).zip(pairs) {
                let stress = tensions[0] * weights[0] + tensions[1] * weights[1] + tensions[2] * weights[2];
                sound &= stress.is_finite();
                add(stress, r, *pair, force);
            }
        }
        sound
    }
}

/// Whether a spring is on a strain of at most two triangles, without a law.
pub fn is_strain(spring: &MeasureSpring) -> bool {
    let has_room = |squares: &Squares| squares.iter().count() <= SQUARES;
    spring.law.is_none() && matches!(&spring.measure, Measure::Squares(squares) if has_room(squares))
}
