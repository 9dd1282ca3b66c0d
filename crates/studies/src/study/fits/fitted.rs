//! The springs of a fit, and what only its kind knows of them.

use super::exact::ExactOutcome;
use super::published::PublishedOutcome;
use super::sampled::SampledOutcome;
use super::stiffness::StiffnessOutcome;
use super::whole::WholeOutcome;
use crate::fit::{CellFits, VolumeSprings};
use crate::material::{Material, Moduli};
use crate::mesh::Mesh;
use crate::model::Network;
use std::time::Instant;

/// The springs of a fit.
pub struct Fitted {
    /// Of each block of cells; empty if springs belong to no cell.
    pub cells: Vec<CellFits>,
    pub network: Network,
    /// For the constants, without assembly.
    pub seconds: f64,
    pub seconds_assembly: f64,
    pub kind: FittedKind,
}

/// What only the kind of a fit knows of its springs.
#[derive(Debug, Clone, PartialEq)]
pub enum FittedKind {
    Stiffness(StiffnessOutcome),
    Sampled(SampledOutcome),
    Whole(WholeOutcome),
    Published(PublishedOutcome),
    Exact(ExactOutcome),
}

impl Fitted {
    /// The network of the cells' springs, which took `seconds` to fit.
    pub fn assembled(mesh: &Mesh, cells: Vec<CellFits>, seconds: f64, kind: FittedKind) -> Fitted {
        let start = Instant::now();
        let network = Network::assemble(mesh, &cells);
        Fitted { cells, network, seconds, seconds_assembly: start.elapsed().as_secs_f64(), kind }
    }
}

impl FittedKind {
    /// What a reader must know of the fit, one sentence each. The body has `cells` cells of `material`.
    pub fn notes(&self, cells: usize, material: Material) -> Vec<String> {
        match self {
            FittedKind::Stiffness(outcome) => outcome.notes(),
            FittedKind::Sampled(outcome) => outcome.notes(),
            FittedKind::Whole(outcome) => outcome.notes(),
            FittedKind::Published(outcome) => outcome.notes(cells, material),
            FittedKind::Exact(outcome) => outcome.notes(),
        }
    }

    /// Whether the springs of each cell are its whole stiffness; those on the content of patches belong to several cells.
    pub fn is_of_cells(&self) -> bool {
        self.exact().is_none_or(|outcome| outcome.volume != VolumeSprings::Patches)
    }

    /// The moduli of the finite elements by whose energies the network's are measured.
    pub fn compared(&self, moduli: Moduli) -> Moduli {
        match self {
            FittedKind::Exact(outcome) => outcome.compared(moduli),
            FittedKind::Stiffness(_) | FittedKind::Sampled(_) | FittedKind::Whole(_) | FittedKind::Published(_) => {
                moduli
            }
        }
    }

    pub fn exact(&self) -> Option<&ExactOutcome> {
        if let FittedKind::Exact(outcome) = self { Some(outcome) } else { None }
    }

    pub fn stiffness(&self) -> Option<&StiffnessOutcome> {
        if let FittedKind::Stiffness(outcome) = self { Some(outcome) } else { None }
    }

    pub fn sampled(&self) -> Option<&SampledOutcome> {
        if let FittedKind::Sampled(outcome) = self { Some(outcome) } else { None }
    }

    pub fn whole(&self) -> Option<&WholeOutcome> {
        if let FittedKind::Whole(outcome) = self { Some(outcome) } else { None }
    }

    pub fn published(&self) -> Option<&PublishedOutcome> {
        if let FittedKind::Published(outcome) = self { Some(outcome) } else { None }
    }
}
