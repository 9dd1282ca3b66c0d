//! What minimises an objective.

use super::objective::Objective;
use crate::bound::{self, check_count};
use crate::error::{Error, Result};

/// What minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Solver {
    /// Normal equations, pivoting, the barrier or Newton's method, as the objective needs.
    #[default]
    Native,
    /// A general optimiser with at most so many iterations, from constants all alike; with a topology it may switch springs off.
    General { method: Search, iterations: u64, topology: Option<Topology> },
}

/// Which springs are on is searched together with how stiff they are, as by Bianchi et al. (2004): every unknown carries a switch,
/// one more coordinate from −1 to 1, and its springs are off, `k = 0`, where that is negative.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Topology {
    /// What each spring that is on adds to the objective, as a share of that at the start, where all are on. With none a spring goes
    /// only if the objective falls without it.
    pub sparsity: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    NelderMead,
    /// 40 particles.
    ParticleSwarm,
    SimulatedAnnealing,
}

/// The name of a solver in files and options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Name {
    Native,
    NelderMead,
    ParticleSwarm,
    SimulatedAnnealing,
}

crate::named!(Name {
    "native" => Native,
    "nelder-mead" => NelderMead,
    "particle-swarm" => ParticleSwarm,
    "simulated-annealing" => SimulatedAnnealing,
});

impl Solver {
    pub const NAMES: &'static [&'static str] = Name::NAMES;
    pub const DEFAULT_ITERATIONS: u64 = 2000;

    /// The solver called `name`; `iterations` and `topology` belong to the general ones.
    ///
    /// # Errors
    /// The name is unknown, no iterations are allowed, the native solver is given any, or the solver cannot do the topology.
    pub fn named(name: &str, iterations: Option<u64>, topology: Option<Topology>) -> Result<Solver> {
        let method = match Name::named(name).map_err(|e| e.at_key("solver"))? {
            Name::Native => {
                let given = [("iterations", iterations.is_some()), ("topology", topology.is_some())];
                return match given.iter().find(|(_, given)| *given) {
                    Some((key, _)) => Err(Error::at(*key, "belongs to a general solver, found with \"native\"")),
                    None => Ok(Solver::Native),
                };
            }
            Name::NelderMead => Search::NelderMead,
            Name::ParticleSwarm => Search::ParticleSwarm,
            Name::SimulatedAnnealing => Search::SimulatedAnnealing,
        };
        let iterations = iterations.unwrap_or(Solver::DEFAULT_ITERATIONS);
        let solver = Solver::General { method, iterations, topology };
        solver.check_numbers().map(|()| solver)
    }

    fn check_numbers(&self) -> Result<()> {
        match self {
            Solver::General { iterations, .. } if !(1..=bound::SEARCH_ITERATIONS).contains(iterations) => {
                check_count("iterations", *iterations, 1, bound::SEARCH_ITERATIONS)
            }
            Solver::General { method: Search::NelderMead, topology: Some(_), .. } => {
                Err(Error::at("topology", "does not go with \"nelder-mead\", which cannot switch springs off"))
            }
            Solver::General { topology: Some(Topology { sparsity }), .. } if !(0.0..=1.0).contains(sparsity) => {
                Err(Error::expected("sparsity", "a share from 0 to 1", sparsity))
            }
            Solver::Native | Solver::General { .. } => Ok(()),
        }
    }

    /// That it can search for this objective.
    pub(super) fn check(&self, objective: Objective) -> Result<()> {
        if *self != Solver::Native && objective.of_motions().is_err() {
            let expected = "\"native\": the blocks of different nodes leave no choice to search";
            return Err(Error::expected("solver", expected, format!("\"{}\"", self.name())));
        }
        self.check_numbers()
    }

    pub fn name(&self) -> &'static str {
        let name = match self {
            Solver::Native => Name::Native,
            Solver::General { method: Search::NelderMead, .. } => Name::NelderMead,
            Solver::General { method: Search::ParticleSwarm, .. } => Name::ParticleSwarm,
            Solver::General { method: Search::SimulatedAnnealing, .. } => Name::SimulatedAnnealing,
        };
        name.name()
    }

    pub fn topology(&self) -> Option<Topology> {
        match self {
            Solver::Native => None,
            Solver::General { topology, .. } => *topology,
        }
    }

    /// The name with what goes with it, such as `particle-swarm topology 0.01`.
    pub fn title(&self) -> String {
        match self.topology() {
            None => self.name().into(),
            Some(Topology { sparsity: 0.0 }) => format!("{} topology", self.name()),
            Some(Topology { sparsity }) => format!("{} topology {sparsity}", self.name()),
        }
    }
}
