//! The springs of a fit, and the results that only its kind has.

use super::exact::ExactOutcome;
use super::published::PublishedOutcome;
use super::sampled::SampledOutcome;
use super::stiffness::StiffnessOutcome;
use super::whole::WholeOutcome;
use crate::analysis::tensor::SpringOwners;
use crate::clock::Clock;
use crate::fit::{CellFits, ShearSprings};
use crate::material::{CellMap, Hooke, MaterialMap};
use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::Springs;

/// The springs of a fit.
#[non_exhaustive]
pub struct Fitted {
    /// The springs of each block of cells; empty if springs belong to no cell.
    pub cells: Vec<CellFits>,
    /// The springs that each block of cells was fitted with, which may have no constants of their own in the network.
    pub springs: Vec<Springs>,
    /// The assembled network.
    pub network: Network,
    /// The processor time for the constants without assembly, s.
    pub seconds: f64,
    /// The processor time of the assembly, s.
    pub seconds_assembly: f64,
    /// The results that only the kind of the fit has.
    pub kind: FittedKind,
}

/// The results that only one kind of fit has.
#[derive(Debug, Clone, PartialEq)]
pub enum FittedKind {
    /// A fit to the stiffness at rest has this outcome.
    Stiffness(StiffnessOutcome),
    /// A fit to the forces at sampled shapes has this outcome.
    Sampled(SampledOutcome),
    /// A fit to the displacements of the whole object has this outcome.
    Whole(Box<WholeOutcome>),
    /// A published formula has this outcome.
    Published(PublishedOutcome),
    /// An exact network has this outcome.
    Exact(ExactOutcome),
}

impl Fitted {
    /// The assembled network of the springs of the cells, which took `seconds` to fit.
    pub fn assembled(mesh: &Mesh, cells: Vec<CellFits>, seconds: f64, kind: FittedKind) -> Fitted {
        let start = Clock::start();
        let network = Network::assemble(mesh, &cells);
        let springs = Fitted::springs_of(&cells);
        Fitted { cells, springs, network, seconds, seconds_assembly: start.seconds(), kind }
    }
}

impl Fitted {
    /// The springs of each block of cells.
    pub fn springs_of(cells: &[CellFits]) -> Vec<Springs> {
        cells.iter().map(|cells| cells.springs.clone()).collect()
    }
}

impl Fitted {
    /// The springs of each block of cells where those of a cell are its whole stiffness; none where springs belong to no element.
    pub fn of_elements(&self) -> &[CellFits] {
        if self.kind.is_of_cells() { &self.cells } else { &[] }
    }

    /// The number of cells that were fitted; the others took the constants of a congruent one.
    pub fn fitted_elements(&self, mesh: &Mesh) -> usize {
        let reused: usize = self.cells.iter().map(|cells| cells.reused).sum();
        mesh.cell_count().saturating_sub(reused).max(1)
    }

    /// To what the springs belong.
    pub fn owners(&self) -> SpringOwners<'_> {
        match self.kind.exact() {
            Some(outcome) if outcome.shear == ShearSprings::Edges => SpringOwners::Edges(outcome.at_rest()),
            _ if self.cells.is_empty() => SpringOwners::Body,
            _ => SpringOwners::Cells(&self.cells),
        }
    }
}

impl FittedKind {
    /// Notes for the reader, one sentence each. The body has `cells` cells of `material`.
    pub fn notes(&self, cells: usize, material: &MaterialMap) -> Vec<String> {
        match self {
            FittedKind::Stiffness(outcome) => outcome.notes(),
            FittedKind::Sampled(outcome) => outcome.notes(),
            FittedKind::Whole(outcome) => outcome.notes(),
            FittedKind::Published(outcome) => outcome.notes(cells, material),
            FittedKind::Exact(outcome) => outcome.notes(),
        }
    }

    /// Whether the springs of each cell are its whole stiffness. Springs on patches and on the domains of edges belong to
    /// several cells.
    pub fn is_of_cells(&self) -> bool {
        self.exact().is_none_or(|outcome| outcome.shear.is_of_cells(outcome.volume))
    }

    /// The moduli of the finite elements with whose energies those of the network are compared.
    pub fn compared(&self, moduli: CellMap<Hooke>) -> CellMap<Hooke> {
        match self {
            FittedKind::Exact(outcome) => outcome.compared(moduli),
            FittedKind::Whole(outcome) => outcome.compared(moduli),
            FittedKind::Stiffness(_) | FittedKind::Sampled(_) | FittedKind::Published(_) => moduli,
        }
    }

    /// The results of an exact network.
    pub fn exact(&self) -> Option<&ExactOutcome> {
        if let FittedKind::Exact(outcome) = self { Some(outcome) } else { None }
    }

    /// The results of a fit to the stiffness at rest.
    pub fn stiffness(&self) -> Option<&StiffnessOutcome> {
        if let FittedKind::Stiffness(outcome) = self { Some(outcome) } else { None }
    }

    /// The results of a sampled fit.
    pub fn sampled(&self) -> Option<&SampledOutcome> {
        if let FittedKind::Sampled(outcome) = self { Some(outcome) } else { None }
    }

    /// The results of a whole-object fit.
    pub fn whole(&self) -> Option<&WholeOutcome> {
        if let FittedKind::Whole(outcome) = self { Some(outcome) } else { None }
    }

    /// The results of a published formula.
    pub fn published(&self) -> Option<&PublishedOutcome> {
        if let FittedKind::Published(outcome) = self { Some(outcome) } else { None }
    }
}
