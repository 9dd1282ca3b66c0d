//! What a model remembers of its motion: Maxwell branches, whose stress relaxes.
//!
//! A step has a length h and ends at the displacements u. During it the branches are elastic: the remembered state enters as numbers that are
//! known at its start. Then the state advances. Between steps h is zero, and the forces are those of the present state.
//!
//! Theory: page *Springs that forget* of the book.

mod decay;
mod form;
mod large;
mod linear;

pub use decay::Decay;
pub use form::BranchForm;
pub use large::LargeMemory;
pub use linear::{LinearMemory, RelaxingPart};

/// The memory of a model, beside its elastic forces.
#[derive(Debug, Clone)]
pub enum Memory {
    /// A linear model has this memory.
    Linear(LinearMemory),
    /// A model at large deformation has this memory.
    Large(Box<LargeMemory>),
}

impl Memory {
    /// Whether it is that of a linear model.
    pub fn is_linear(&self) -> bool {
        matches!(self, Memory::Linear(_))
    }

    /// The number of degrees of freedom.
    pub fn dofs(&self) -> usize {
        match self {
            Memory::Linear(memory) => memory.dofs(),
            Memory::Large(memory) => memory.dofs(),
        }
    }

    /// The shortest relaxation time, s.
    pub fn shortest(&self) -> f64 {
        let times = match self {
            Memory::Linear(memory) => memory.times(),
            Memory::Large(memory) => memory.times(),
        };
        times.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The positions of the entries that it adds to the lower triangle of the tangent.
    pub fn places(&self) -> Vec<(usize, usize)> {
        match self {
            Memory::Linear(memory) => memory.places(),
            Memory::Large(memory) => memory.places(),
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
        }
    }

    /// Sets the length of the step whose end [`Memory::add`] computes, s; zero for a jump, or for no step at all.
    pub fn prepare(&mut self, step: f64) {
        match self {
            Memory::Linear(memory) => memory.prepare(step),
            Memory::Large(memory) => memory.prepare(step),
        }
    }

    /// Adds the forces at the end of a step to the displacements u, N, and writes the entries of the tangent, N/m. Returns the potential of
    /// these forces, J; `None` if there is no response.
    pub fn add(&self, u: &[f64], force: &mut [f64], tangent: Option<&mut [f64]>) -> Option<f64> {
        match self {
            Memory::Linear(memory) => {
                memory.add(u, force, tangent);
                Some(0.0)
            }
            Memory::Large(memory) => memory.add(u, force, tangent),
        }
    }

    /// Ends the step at the displacements u. The length of the next is zero until it is prepared.
    pub fn advance(&mut self, u: &[f64]) {
        match self {
            Memory::Linear(memory) => memory.advance(u),
            Memory::Large(memory) => memory.advance(u),
        }
        self.prepare(0.0);
    }

    /// The elastic energy at the displacements u that it adds to that of the model, J.
    pub fn stored(&self, u: &[f64]) -> Option<f64> {
        match self {
            Memory::Linear(memory) => Some(memory.stored(u)),
            Memory::Large(memory) => memory.stored(u),
        }
    }

    /// The energy that has been dissipated since the start, J; it never decreases.
    pub fn dissipated(&self) -> f64 {
        match self {
            Memory::Linear(memory) => memory.dissipated(),
            Memory::Large(memory) => memory.dissipated(),
        }
    }
}
