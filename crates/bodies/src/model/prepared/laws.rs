//! Springs with laws on the content of single cells, many at a time, so that each step of a law is read once for all of
//! them.

use crate::model::network::{MeasureSpring, Network};
use crate::springs::{Law, LawRoom};
use std::sync::Arc;

/// The number of springs that are evaluated together.
// Each step of a formula is looked up once for all of them, and the doubles fill whole registers of any width.
const BLOCK: usize = 16;

/// A spring with a law on the content `V = scale · det` of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Lawful {
    pub cell: usize,
    pub scale: f64,
    /// Its index among the other springs of the network.
    pub spring: usize,
}

/// Up to [`BLOCK`] springs with the same law.
#[derive(Debug)]
struct Block {
    law: Arc<Law>,
    cells: Vec<usize>,
    scales: [f64; BLOCK],
    /// The contents, the contents at rest, and the parameters.
    at: Vec<[f64; BLOCK]>,
}

#[derive(Debug, Default)]
pub struct Laws {
    blocks: Vec<Block>,
}

/// Working memory of [`Laws::pull`].
#[derive(Debug, Default)]
pub struct LawsRoom {
    at: Vec<[f64; BLOCK]>,
    law: LawRoom<BLOCK>,
}

impl Laws {
    /// The springs in their order, grouped by law.
    pub fn new(network: &Network, springs: &[Lawful]) -> Laws {
        let law = |lawful: &Lawful| network.others[lawful.spring].law.as_ref().map(|own| &own.law);
        let mut kinds: Vec<(&Arc<Law>, Vec<Lawful>)> = Vec::new();
        for lawful in springs {
            let Some(law) = law(lawful) else { continue };
            // Most springs share one law by its pointer, which is quicker to compare than its text.
            match kinds.iter_mut().find(|(known, _)| Arc::ptr_eq(known, law) || *known == law) {
                Some((_, same)) => same.push(*lawful),
                None => kinds.push((law, vec![*lawful])),
            }
        }
        let of_kind = |(law, springs): (&Arc<Law>, Vec<Lawful>)| -> Vec<Block> {
            springs.chunks(BLOCK).map(|springs| Block::new(&network.others, law, springs)).collect()
        };
        Laws { blocks: kinds.into_iter().flat_map(of_kind).collect() }
    }

    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Adds the tensions of the springs along `∇det` of their cells, with `determinant(cell)`; false if a law has no
    /// force.
    #[inline(always)]
    pub fn pull(&self, determinant: impl Fn(usize) -> f64, room: &mut LawsRoom, tensions: &mut [f64]) -> bool {
        let mut sound = true;
        let LawsRoom { at, law } = room;
        for block in &self.blocks {
            // In memory that is kept: contents at rest and parameters are those of the block, and the contents come
            // from the cells.
            at.clone_from(&block.at);
            for (i, &cell) in block.cells.iter().enumerate() {
                at[0][i] = block.scales[i] * determinant(cell);
            }
            let pulls = block.law.force_each(at, law);
            for (i, &cell) in block.cells.iter().enumerate() {
                sound &= pulls[i].is_finite();
                tensions[cell] += block.scales[i] * pulls[i];
            }
        }
        sound
    }
}

impl Block {
    /// Unused entries have the numbers of the first spring.
    fn new(others: &[MeasureSpring], law: &Arc<Law>, springs: &[Lawful]) -> Block {
        let own = |i: usize| springs.get(i).unwrap_or(&springs[0]);
        let of = |i: usize| &others[own(i).spring];
        let rests: [f64; BLOCK] = std::array::from_fn(|i| of(i).rest);
        let parameter = |p: usize| -> [f64; BLOCK] {
            std::array::from_fn(|i| of(i).law.as_ref().map_or(0.0, |own| own.parameters[p]))
        };
        Block {
            law: law.clone(),
            cells: springs.iter().map(|lawful| lawful.cell).collect(),
            scales: std::array::from_fn(|i| own(i).scale),
            at: [rests, rests].into_iter().chain((0..law.parameters.len()).map(parameter)).collect(),
        }
    }
}
