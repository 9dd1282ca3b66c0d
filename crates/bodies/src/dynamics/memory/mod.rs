//! What a model remembers of its motion: Maxwell branches, whose stress relaxes.
//!
//! A step has a length h and ends at the displacements u. During it the branches are elastic: the remembered state enters as numbers that are
//! known at its start. Then the state advances. Between steps h is zero, and the forces are those of the present state.
//!
//! Theory: page *Springs that forget* of the book.

mod decay;
mod explicit;
mod flow;
mod form;
mod large;
mod linear;
mod term;
mod yielding;

pub use decay::Decay;
pub use explicit::ExplicitMemory;
pub use flow::FlowMemory;
pub use form::BranchForm;
pub use large::LargeMemory;
pub use linear::{LinearMemory, RelaxingPart};
pub use term::BranchTerm;

/// The memory of a model, beside its elastic forces.
#[derive(Debug, Clone)]
pub enum Memory {
    /// A linear model has this memory.
    Linear(LinearMemory),
    /// A model at large deformation has this memory.
    Large(Box<LargeMemory>),
    /// A model at large deformation whose branches yield, or differ by region, has this memory.
    Flow(Box<FlowMemory>),
    /// A model at large deformation has this memory in explicit steps.
    Explicit(Box<ExplicitMemory>),
}

impl Memory {
    /// Whether it is that of a linear model.
    pub fn is_linear(&self) -> bool {
        matches!(self, Memory::Linear(_))
    }

    /// The memory for explicit steps of the length `step`, s: the same, and faster where it can be.
    pub fn for_explicit(self, step: f64) -> Memory {
        match &self {
            Memory::Large(memory) => Memory::Explicit(Box::new(memory.for_explicit(step))),
            Memory::Flow(memory) if memory.terms().iter().all(|term| term.yield_stress.is_none()) => {
                let explicit = ExplicitMemory::new(memory.points(), memory.rest(), memory.terms(), step);
                Memory::Explicit(Box::new(explicit))
            }
            Memory::Linear(_) | Memory::Flow(_) | Memory::Explicit(_) => self,
        }
    }

    /// The number of degrees of freedom.
    pub fn dofs(&self) -> usize {
        match self {
            Memory::Linear(memory) => memory.dofs(),
            Memory::Large(memory) => memory.dofs(),
            Memory::Flow(memory) => memory.dofs(),
            Memory::Explicit(memory) => memory.dofs(),
        }
    }

    /// The number of numbers that are remembered from step to step.
    pub fn numbers(&self) -> usize {
        match self {
            Memory::Linear(memory) => memory.numbers(),
            Memory::Large(memory) => memory.numbers(),
            Memory::Flow(memory) => memory.numbers(),
            Memory::Explicit(memory) => memory.numbers(),
        }
    }

    /// The positions of the entries that it adds to the lower triangle of the tangent; none in explicit steps, which have no tangent.
    pub fn places(&self) -> Vec<(usize, usize)> {
        match self {
            Memory::Linear(memory) => memory.places(),
            Memory::Large(memory) => memory.places(),
            Memory::Flow(memory) => memory.places(),
            // Explicit steps solve no equations, and need no tangent.
            Memory::Explicit(_) => Vec::new(),
        }
    }

    /// Forgets everything: the model was at rest until it jumped to the displacements u. False if it has no response there.
    pub fn reset(&mut self, u: &[f64]) -> bool {
        match self {
            Memory::Linear(memory) => {
                memory.reset(u);
                true
            }
            Memory::Large(memory) => memory.reset(u),
            Memory::Flow(memory) => memory.reset(u),
            Memory::Explicit(memory) => memory.reset(u),
        }
    }

    /// Sets the length of the step whose end [`Memory::add`] computes, s; zero for a jump, or for no step at all.
    pub fn prepare(&mut self, step: f64) {
        match self {
            Memory::Linear(memory) => memory.prepare(step),
            Memory::Large(memory) => memory.prepare(step),
            Memory::Flow(memory) => memory.prepare(step),
            Memory::Explicit(memory) => memory.prepare(step),
        }
    }

    /// Adds the forces at the end of a step to the displacements u, N, and writes the entries of the tangent, N/m. Returns the potential of
    /// these forces, J; `None` if there is no response, or if the memory is that of explicit steps.
    pub fn add(&self, u: &[f64], force: &mut [f64], tangent: Option<&mut [f64]>) -> Option<f64> {
        match self {
            Memory::Linear(memory) => {
                memory.add(u, force, tangent);
                Some(0.0)
            }
            Memory::Large(memory) => memory.add(u, force, tangent),
            Memory::Flow(memory) => memory.add(u, force, tangent),
            Memory::Explicit(_) => None,
        }
    }

    /// Adds the forces at the end of a step to the displacements u, N, to which [`Memory::advance`] then ends it; false if there is no response.
    pub fn pull(&mut self, u: &[f64], force: &mut [f64]) -> bool {
        match self {
            Memory::Explicit(memory) => memory.pull(u, force),
            Memory::Linear(_) | Memory::Large(_) | Memory::Flow(_) => self.add(u, force, None).is_some(),
        }
    }

    /// Ends the step at the displacements u. The length of the next is zero until it is prepared.
    pub fn advance(&mut self, u: &[f64]) {
        match self {
            Memory::Linear(memory) => memory.advance(u),
            Memory::Large(memory) => memory.advance(u),
            Memory::Flow(memory) => memory.advance(u),
            Memory::Explicit(memory) => memory.advance(),
        }
        self.prepare(0.0);
    }

    /// The elastic energy at the displacements u that it adds to that of the model, J.
    pub fn stored(&self, u: &[f64]) -> Option<f64> {
        match self {
            Memory::Linear(memory) => Some(memory.stored(u)),
            Memory::Large(memory) => memory.stored(u),
            Memory::Flow(memory) => memory.stored(u),
            Memory::Explicit(memory) => Some(memory.stored()),
        }
    }

    /// The energy that has been dissipated since the start, J; it never decreases.
    pub fn dissipated(&self) -> f64 {
        match self {
            Memory::Linear(memory) => memory.dissipated(),
            Memory::Large(memory) => memory.dissipated(),
            Memory::Flow(memory) => memory.dissipated(),
            Memory::Explicit(memory) => memory.dissipated(),
        }
    }
}
