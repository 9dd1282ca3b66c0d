//! The solvers that can minimise an objective.

use super::objective::Objective;
use crate::bound::{self, check_count};
use crate::error::{Error, Result};

/// The solver that minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Solver {
    /// The solver made for the objective: normal equations, pivoting, the barrier method or Newton's method.
    #[default]
    Native,
    /// A general optimiser, which starts from equal constants.
    General {
        /// The optimiser.
        method: Search,
        /// The largest number of iterations for each element.
        iterations: u64,
        /// Whether springs may be switched off, and at what cost.
        topology: Option<Topology>,
    },
}

/// A search for the set of springs together with their constants, as by Bianchi et al. (2004). Every unknown has a
/// switch, an additional coordinate from −1 to 1; its springs are off, `k = 0`, if the switch is negative.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Topology {
    /// The cost of each spring that is on, as a share of the objective at the start, where all are on. With 0 a spring
    /// is removed only if the objective decreases without it.
    pub sparsity: f64,
}

/// A general optimiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// The downhill simplex method of Nelder and Mead (1965).
    NelderMead,
    /// Particle swarm optimisation with 40 particles.
    ParticleSwarm,
    /// Simulated annealing.
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
    /// The names of the solvers, as files and options have them.
    pub const NAMES: &'static [&'static str] = Name::NAMES;
    /// The number of iterations of a general optimiser if none is given.
    // A swarm agrees after 200 (`AGREED` of `descent.rs`): so many are ten swarms.
    pub const DEFAULT_ITERATIONS: u64 = 2000;

    /// The solver called `name`; `iterations` and `topology` belong to the general solvers.
    ///
    /// # Errors
    /// The name is unknown; `iterations` is zero or too large; the native solver is given an option of the general
    /// ones; or the solver cannot search the topology.
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

    /// Checks that the solver can minimise this objective.
    pub(super) fn check(&self, objective: Objective) -> Result<()> {
        if *self != Solver::Native && objective.of_motions().is_err() {
            let expected = "\"native\": the blocks of different nodes leave no choice to search";
            return Err(Error::expected("solver", expected, format!("\"{}\"", self.name())));
        }
        self.check_numbers()
    }

    /// The name in files and options.
    pub fn name(&self) -> &'static str {
        let name = match self {
            Solver::Native => Name::Native,
            Solver::General { method: Search::NelderMead, .. } => Name::NelderMead,
            Solver::General { method: Search::ParticleSwarm, .. } => Name::ParticleSwarm,
            Solver::General { method: Search::SimulatedAnnealing, .. } => Name::SimulatedAnnealing,
        };
        name.name()
    }

    /// The search for the set of springs, if there is one.
    pub fn topology(&self) -> Option<Topology> {
        match self {
            Solver::Native => None,
            Solver::General { topology, .. } => *topology,
        }
    }

    /// The name with its options, such as `particle-swarm topology 0.01`.
    pub fn title(&self) -> String {
        match self.topology() {
            None => self.name().into(),
            Some(Topology { sparsity: 0.0 }) => format!("{} topology", self.name()),
            Some(Topology { sparsity }) => format!("{} topology {sparsity}", self.name()),
        }
    }
}
