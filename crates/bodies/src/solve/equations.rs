//! Equations that are solved for many forces: with a factor, or by iterations with levels.

use super::inertia::Masses;
use super::levels::Levels;
use super::linear::{Factor, System};
use super::method::StaticSolver;
use super::modes::{Modes, lowest_modes};
use super::patterns::KnownPatterns;
use crate::clock::Clock;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Entries, Support, check_body, finite_elements};
use std::sync::Arc;

/// The relative error at which the iterations of a timed step end. A motion needs no smaller one.
const STEP: f64 = 1e-6;

/// The equations of a model under a support, with what solves them. Copies share it.
#[derive(Debug, Clone)]
pub enum Equations {
    /// With the factor of the matrix.
    Factored(Arc<System>, Arc<Factor>),
    /// By conjugate gradients with multigrid.
    Iterated(Arc<Levels>, StaticSolver),
}

impl Equations {
    /// With a Cholesky factor; `None` if the matrix is not positive definite. `points` are `[points × dimension]`, m.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn factored(
        entries: &Entries,
        support: &Support,
        points: &[f64],
        dimension: usize,
    ) -> Result<Option<Equations>> {
        Equations::of_system(Arc::new(System::new(entries, support)?.placed(points, dimension)))
    }

    /// Factorises equations whose pattern may be known, by Cholesky's method; `None` if the matrix is not positive definite.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn of_system(system: Arc<System>) -> Result<Option<Equations>> {
        Ok(system.cholesky()?.map(|factor| Equations::Factored(system, Arc::new(factor))))
    }

    /// By iterations; `None` if the stiffness is shown not to be positive definite. `points` are `[points × dimension]`, m.
    ///
    /// # Errors
    /// The points do not group: kind `Limit`.
    pub fn iterated(
        stiffness: BlockStiffness,
        points: &[f64],
        support: &Support,
        solver: StaticSolver,
    ) -> Result<Option<Equations>> {
        let levels = Levels::new(stiffness, points, support)?;
        Ok(levels.ok().map(|levels| Equations::Iterated(Arc::new(levels), solver)))
    }

    /// Those of the finite elements, for about `loads` forces, on a pattern that is known; `None` if some motion has no stiffness.
    ///
    /// # Errors
    /// The equations do not fit into memory, or are not those of a body.
    pub fn of_body(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        support: &Support,
        (solver, loads): (StaticSolver, usize),
        known: &KnownPatterns,
    ) -> Result<Option<Equations>> {
        let solver = solver.suited(mesh, moduli);
        if solver.iterates(mesh, loads) {
            let found = BlockStiffness::of_body(mesh, moduli, 1, 1)
                .and_then(|stiffness| Equations::iterated(stiffness, &mesh.points, support, solver));
            match found {
                // Iterations that the program has chosen itself may fail on badly shaped cells: the factor answers
                // there.
                Err(error) if solver.gives_way(&error) => {}
                other => return other,
            }
        }
        // Below the iterations, which need a small part of the memory of a factor.
        check_body(mesh)?;
        let entries = finite_elements(mesh, moduli);
        Equations::of_system(known.renewed(&entries, support, &mesh.points, mesh.dimension)?)
    }

    /// The displacements under the nodal forces f, `[points · dimension]`, N, and the relative residual; refined where there is a
    /// factor, see [`System::solve`].
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn solve(&self, f: &[f64]) -> Result<(Vec<f64>, f64)> {
        match self {
            Equations::Factored(system, factor) => Ok(system.solve(factor, f)),
            Equations::Iterated(levels, solver) => {
                let (u, solved) = levels.solve(f, solver, &mut |_| ()).map_err(advise)?;
                Ok((u, solved.residual))
            }
        }
    }

    /// The displacements under each of several nodal forces, without refinement.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn solve_all(&self, forces: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
        match self {
            Equations::Factored(system, factor) => Ok(system.solve_all(factor, forces)),
            // Iterations end at the tolerance of their solver; the one that is passed on is for factors.
            Equations::Iterated(..) => Ok(self.solve_each(forces, 0.0)?.into_iter().map(|(u, _)| u).collect()),
        }
    }

    /// The displacements under each of several nodal forces, and the relative residual of each; refined with a factor where that is above
    /// `tolerance`.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn solve_each(&self, forces: &[Vec<f64>], tolerance: f64) -> Result<Vec<(Vec<f64>, f64)>> {
        match self {
            Equations::Factored(system, factor) => Ok(system.solve_each(factor, forces, tolerance)),
            Equations::Iterated(levels, solver) => {
                let forces: Vec<&[f64]> = forces.iter().map(|f| &f[..]).collect();
                let found = levels.solve_each(&forces, solver, &mut |_| ()).map_err(advise)?;
                Ok(found.into_iter().map(|(u, solved)| (u, solved.residual)).collect())
            }
        }
    }

    /// The changes of the displacements for changes of the nodal forces; iterations end at the relative error `tolerance`.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn respond_all(&self, forces: &[Vec<f64>], tolerance: f64) -> Result<Vec<Vec<f64>>> {
        match self {
            Equations::Factored(system, factor) => Ok(system.respond_all(factor, forces)),
            Equations::Iterated(levels, solver) => {
                // Who allows larger errors in the whole run allows them here.
                let solver = StaticSolver { tolerance: solver.tolerance.max(tolerance), ..*solver };
                levels.respond_all(forces, &solver).map_err(advise)
            }
        }
    }

    /// The number of degrees of freedom, those that are held included.
    pub fn degrees(&self) -> usize {
        match self {
            Equations::Factored(system, _) => system.degrees(),
            Equations::Iterated(levels, _) => levels.degrees(),
        }
    }

    /// Seconds of a linear implicit step: one change of the displacements for a change of the forces; the least of three.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn seconds_per_step(&self) -> Result<f64> {
        let forces = [(0..self.degrees()).map(|i| (1.0 + i as f64).sin()).collect::<Vec<f64>>()];
        let mut least = f64::INFINITY;
        for _ in 0..3 {
            let start = Clock::start();
            self.respond_all(&forces, STEP)?;
            // Whatever else the machine does makes a time longer, never shorter.
            least = least.min(start.seconds());
        }
        Ok(least)
    }

    /// The `count` lowest natural vibrations, see [`lowest_modes`].
    ///
    /// # Errors
    /// As there.
    pub fn lowest_modes<'a>(&self, masses: impl Into<Masses<'a>>, dimension: usize, count: usize) -> Result<Modes> {
        match self {
            Equations::Factored(system, factor) => lowest_modes(system, factor, masses, dimension, count),
            Equations::Iterated(levels, _) => levels.lowest_modes(masses, dimension, count),
        }
    }
}

/// What helps where iterations stall.
fn advise(error: Error) -> Error {
    match error.kind() {
        ErrorKind::Limit => {
            Error::new(format!("{}; method = \"cholesky\" in [solver] does without iterations", error.problem()))
                .of_kind(ErrorKind::Limit)
        }
        _ => error,
    }
}
