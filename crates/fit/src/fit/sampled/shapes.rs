//! Deformed shapes of a cell: of families, or of a list.
//!
//! Theory: page *Sampled fits* of the book.

use super::family::{Draw, Resting, within};
use super::numbers::{Numbers, OF_FAMILIES, Sequence};
use super::sampling::{APART, Part, Sampling, Source};

/// A prime by which the states of different cells are spread.
const STRIDE: usize = 1_000_003;

/// The cell whose shapes are drawn.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// The positions at rest, `[nodes × dimension]`, m.
    pub rest: &'a [f64],
    /// The nodes of all cells of this shape.
    pub cells: &'a [&'a [usize]],
    /// The points of the mesh at rest.
    pub points: &'a [f64],
    pub dimension: usize,
    /// The content to the power of one over the dimension, m.
    pub extent: f64,
    /// The ν of the lateral contraction.
    pub poisson: f64,
}

/// The shapes of one cell from one source that belong to one part.
pub struct Shapes<'a> {
    pub sampling: &'a Sampling,
    drawing: Drawing<'a>,
    part: Part,
    /// Whether a list is divided between both parts.
    is_divided: bool,
    sequence: Sequence,
    count: usize,
}

impl<'a> Shapes<'a> {
    /// The shapes of a part; those that are held out in place of the sampling's own are not divided.
    pub fn new(sampling: &'a Sampling, drawing: Drawing<'a>, part: Part, is_divided: bool) -> Shapes<'a> {
        let seed = sampling.seed_of(part);
        let families = if let Source::Families(families) = &sampling.source { families.len() } else { 1 };
        let most = if is_divided && part == Part::HeldOut { sampling.held_out } else { sampling.shapes };
        // A sequence that is laid out for more shapes has the same first ones: shorter fits see the beginning of longer ones.
        let laid = sampling.laid.unwrap_or(most).max(most);
        let sequence = Sequence::new(sampling.design, seed, families, laid);
        let mut own = Shapes { sampling, drawing, part, is_divided, sequence, count: 0 };
        own.count = own.counted(most);
        own
    }

    /// The number of shapes of the list; `None` without one.
    fn listed(&self) -> Option<usize> {
        match &self.sampling.source {
            Source::Families(_) => None,
            Source::Gradients(list) => Some(list.len() / (self.drawing.dimension * self.drawing.dimension)),
            Source::States(states) => Some(states.len() * self.drawing.cells.len()),
        }
    }

    /// Whether these are shapes that the fit does not use.
    pub fn are_others(&self) -> bool {
        let are_apart = !self.is_divided || self.listed().is_none_or(|listed| listed >= APART);
        self.count > 0 && (are_apart || self.sampling.perturbation > 0.0)
    }

    /// The number of shapes: no shape of a list counts more often than another.
    pub fn count(&self) -> usize {
        self.count
    }

    fn counted(&self, most: usize) -> usize {
        let own = |listed| if self.is_divided { self.part.of(listed) } else { listed };
        let Some(own) = self.listed().map(own) else { return most };
        match &self.sampling.source {
            // Displacements of the nodes differ each time, so that states that are used again are other shapes.
            Source::States(_) if most > own && self.sampling.perturbation > 0.0 => most - most % own,
            Source::Families(_) | Source::Gradients(_) | Source::States(_) => most.min(own),
        }
    }

    /// Whether shapes are from a list, so that each is used as it is.
    pub fn are_listed(&self) -> bool {
        match &self.sampling.source {
            Source::Families(_) => false,
            Source::Gradients(_) | Source::States(_) => true,
        }
    }

    /// What shape i is called: its family, or where it is from.
    pub fn kind(&self, i: usize) -> &'static str {
        match &self.sampling.source {
            Source::Families(families) => families[i % families.len()].name(),
            Source::Gradients(_) => "listed",
            Source::States(_) => "states",
        }
    }

    /// The key of shape i in errors, and what is said of its cell.
    pub fn named(&self, i: usize) -> (String, String) {
        match &self.sampling.source {
            Source::Families(_) => ("families".into(), format!(" in shape {i}, \"{}\"", self.kind(i))),
            Source::Gradients(_) => (format!("gradients[{}]", self.chosen(i)), String::new()),
            Source::States(states) => {
                let (state, cell) = self.state(states.len(), i);
                (format!("states[{state}]"), format!(" in the cell with the nodes {:?}", self.drawing.cells[cell]))
            }
        }
    }

    /// The state of shape i, and the cell that has it.
    fn state(&self, states: usize, i: usize) -> (usize, usize) {
        let count = states * self.drawing.cells.len();
        // Consecutive shapes fall on different cells and states.
        let place = self.chosen(i) * STRIDE % count;
        (place % states, place / states)
    }

    /// The positions of the nodes in shape `i`, with the share `scale` of what may be made smaller: of the deformation of a family and
    /// of the displacements of the nodes; `[nodes × dimension]`.
    pub fn place(&self, i: usize, scale: f64) -> Vec<f64> {
        let Drawing { rest, points, cells, dimension: d, extent, poisson } = self.drawing;
        let numbers = Numbers { index: i, seed: self.sampling.seed_of(self.part) };
        let resting = Resting { rest, dimension: d, extent, poisson };
        let mut x = match &self.sampling.source {
            Source::Families(families) => {
                let turn = i / families.len();
                let directions = &self.sampling.directions;
                let draw = Draw {
                    number: &|coordinate| self.sequence.number(i, coordinate),
                    stretch: self.sampling.stretch,
                    scale,
                    direction: directions.get(turn % directions.len().max(1)).map(|direction| &direction[..]),
                };
                resting.deformed(families[i % families.len()], &draw)
            }
            Source::Gradients(list) => {
                let gradient = &list[d * d * self.chosen(i)..][..d * d];
                resting.homogeneous(&within(d, |k, l| gradient[k * d + l]))
            }
            Source::States(states) => {
                let (state, cell) = self.state(states.len(), i);
                let dofs = cells[cell].iter().flat_map(|&p| p * d..(p + 1) * d);
                rest.iter().zip(dofs).map(|(rest, i)| rest + (states[state][i] - points[i])).collect()
            }
        };
        let share = scale * self.sampling.perturbation * extent;
        x.iter_mut().enumerate().for_each(|(k, x)| *x += share * numbers.symmetric(OF_FAMILIES + k));
        x
    }

    /// The index in its list of shape number `i`.
    fn chosen(&self, i: usize) -> usize {
        let count = self.listed().unwrap_or(usize::MAX);
        let apart = if self.is_divided { count / APART } else { 0 };
        match self.part {
            _ if apart == 0 => i % count,
            Part::HeldOut => (i % apart) * APART + APART - 1,
            Part::Trained => {
                let i = i % (count - apart);
                // Each run of four shapes is followed by one that is held out.
                if i / (APART - 1) < apart { i + i / (APART - 1) } else { i + apart }
            }
        }
    }
}
