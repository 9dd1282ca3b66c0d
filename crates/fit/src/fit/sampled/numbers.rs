//! The numbers in [0, 1) from which shapes are drawn.

use crate::random::{Latin, Sobol, unit_at};

/// The length of a sequence of Sobol points; the next shapes use another seed. The generator knows so many points of a
/// sequence.
const LONGEST: usize = 1 << 16;
/// The number of coordinates of a Sobol point, the most that the generator knows.
const WIDEST: usize = 256;
/// The number of coordinates from which the deformation of a family is drawn; those after it displace the nodes.
pub const OF_FAMILIES: usize = 9;

/// How the parameters of families are spread over their ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Design {
    /// Points of Sobol's sequence, scrambled, which all families share.
    #[default]
    Scrambled,
    /// Points of Sobol's sequence under one digital shift, a sequence for each family.
    Sobol,
    /// A Latin hypercube for each family.
    Latin,
    /// Independent numbers.
    Random,
}

crate::named!(Design {
    "scrambled" => Scrambled,
    "sobol" => Sobol,
    "latin-hypercube" => Latin,
    "random" => Random,
});

/// A point of a scrambled Sobol sequence (Burley 2020), coordinate by coordinate.
pub struct Numbers {
    pub index: usize,
    pub seed: u64,
}

impl Numbers {
    /// A number in [0, 1).
    pub fn number(&self, coordinate: usize) -> f64 {
        // At most 1e7 shapes have 153 sequences. The prime 7919 is beyond that, so that no sequence of further
        // coordinates is one of other shapes.
        let block = (self.index / LONGEST + 7919 * (coordinate / WIDEST)) as u64;
        // The sampler takes 32 bits. The upper half of the product depends on every bit of the seed, the lower one on
        // the lower half alone.
        let seed = apart(self.seed.wrapping_add(block << 32)) >> 32;
        f64::from(sobol_burley::sample((self.index % LONGEST) as u32, (coordinate % WIDEST) as u32, seed as u32))
    }

    /// A number in [−1, 1).
    pub fn symmetric(&self, coordinate: usize) -> f64 {
        2.0 * self.number(coordinate) - 1.0
    }
}

/// Spreads seeds: sequences of neighbouring ones must not be similar.
fn apart(seed: u64) -> u64 {
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// The points of a design for families that take turns.
pub struct Sequence {
    seed: u64,
    families: usize,
    points: Points,
}

enum Points {
    Scrambled,
    Sobol(Vec<Sobol>),
    Latin(Vec<Latin>),
    Random,
}

impl Sequence {
    /// The sequence of `count` shapes of some families, at least one.
    pub fn new(design: Design, seed: u64, families: usize, count: usize) -> Sequence {
        let own = |family: usize| apart(seed.wrapping_add((family as u64) << 40));
        let points = match design {
            Design::Scrambled => Points::Scrambled,
            Design::Random => Points::Random,
            Design::Sobol => Points::Sobol((0..families).map(|k| Sobol::new(OF_FAMILIES, Some(own(k)))).collect()),
            // Those that are left over are the first of the next turn.
            Design::Latin => {
                let turns = |k: usize| (count + families - 1).saturating_sub(k) / families;
                Points::Latin((0..families).map(|k| Latin::new(turns(k), own(k))).collect())
            }
        };
        Sequence { seed, families, points }
    }

    /// A number in [0, 1) of shape i, one of the first [`OF_FAMILIES`].
    pub fn number(&self, i: usize, coordinate: usize) -> f64 {
        let (family, turn) = (i % self.families, i / self.families);
        match &self.points {
            Points::Scrambled => Numbers { index: i, seed: self.seed }.number(coordinate),
            Points::Random => unit_at(self.seed, i as u64, coordinate as u64),
            Points::Sobol(of_families) => of_families[family].at(turn as u32, coordinate),
            Points::Latin(of_families) => of_families[family].at(turn, coordinate),
        }
    }
}
