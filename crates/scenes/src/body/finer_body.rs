//! The finer body of a scene: the answers of the finite elements of its finer mesh, which networks are compared with.

use super::case::Case;
use super::finer_large::FinerLaws;
use super::finer_linear::equations;
use super::linear_answers::{check_residual, largest_residual};
use crate::error::{Error, Result};
use crate::material::{CellMap, Hooke, MaterialMap, Moduli};
use crate::mesh::{CellBlock, CellIndex, Embedding, Mesh};
use crate::model::{Lumping, Moments, Support, lumped_masses};
use crate::outcome::Standard;
use crate::progress::{Event, Progress};
use crate::solve::{Equations, KnownEquations, StaticSolver};
use crate::whole::{BodyRegions, MakeLoads, NodalLoad, StretchedLoads};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex, OnceLock};

/// Loads on the points of the mesh of the scene, and the displacements there.
pub type Answers = Arc<Vec<(NodalLoad, Vec<f64>)>>;

/// The factors on μ and λ of the cells that belong to the same groups.
pub type RegionFactors = BTreeMap<Vec<String>, [f64; 2]>;

/// A finer mesh of the same body.
pub struct FinerBody {
    /// The finer mesh.
    pub(super) mesh: Mesh,
    /// Its points in the cells of the mesh of the scene, for forces.
    pub(super) embedding: Embedding,
    /// The points of the mesh of the scene in its cells, for displacements.
    pub(super) sampling: Embedding,
    /// The support of the `[[fix]]` entries.
    pub(super) support: Support,
    pub(super) material: MaterialMap,
    /// Its laws, at large deformation.
    pub(super) large: Option<FinerLaws>,
    pub(super) standard: Standard,
    pub(super) solver: StaticSolver,
    /// The loads of the scene on it.
    pub(super) cases: OnceLock<Vec<Case>>,
    /// The answers so far, by what was asked.
    pub(super) known: Mutex<HashMap<String, Answers>>,
    /// The loads that were made at large deformation so far, by what was asked.
    pub(super) stretched: Mutex<HashMap<String, Arc<StretchedLoads>>>,
    /// The squares of the frequencies so far, for each support.
    pub(super) squares: Mutex<Vec<(Support, Vec<f64>)>>,
    /// The equations under the supports of the last questions.
    pub(super) equations: KnownEquations,
}

/// About so many solutions are needed for each frequency.
const VIBRATING: usize = 8;
/// The relative residual above which an answer is refined: far below the errors of coarse networks.
const REFINED: f64 = 1e-9;

impl FinerBody {
    /// Loads that whole-object fits ask for under a support, about: those that they fit, those that choose ρ and those that none has seen. By them
    /// the way to solve equations is chosen.
    pub const ASKED: usize = 75;

    /// The equations under a support, for about `loads` loads.
    fn equations(&self, support: &Support, loads: usize) -> Result<Equations> {
        let moduli = self.material.moduli();
        self.equations.under(support, || equations(&self.mesh, &moduli, support, (self.solver, loads)))
    }

    /// The finer mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The support of the `[[fix]]` entries on it.
    pub fn support(&self) -> &Support {
        &self.support
    }

    /// The loads on the points of the mesh of the scene that do the same work as `loads` on the finer mesh, which holds
    /// `support`; and the displacements of the finer body at those points. `name` says which loads and which support they are, so that
    /// no load is solved twice.
    ///
    /// # Errors
    /// The finer body has no solution.
    pub fn answers(
        &self,
        name: String,
        support: &Support,
        loads: &dyn Fn() -> Vec<NodalLoad>,
        progress: &mut Progress,
    ) -> Result<Answers> {
        let known = || self.known.lock().expect("nothing panics while it holds the answers");
        if let Some(answers) = known().get(&name) {
            return Ok(answers.clone());
        }
        let loads = loads();
        progress(Event::stage("finer body", 0, loads.len()));
        let forces: Vec<Vec<f64>> = loads.iter().map(|load| load.forces.clone()).collect();
        let solved = self.equations(support, FinerBody::ASKED)?.solve_each(&forces, REFINED)?;
        let largest = largest_residual(&self.solver);
        let checked =
            |(load, (u, residual)): (&NodalLoad, (_, _))| check_residual(residual, largest, &load.name).map(|()| u);
        let found: Vec<Vec<f64>> = loads.iter().zip(solved).map(checked).collect::<Result<_>>()?;
        let answer = |(load, u): (NodalLoad, Vec<f64>)| {
            let forces = self.embedding.restrict(&load.forces);
            (NodalLoad { forces, ..load }, self.sampling.interpolate(&u))
        };
        let answers: Answers = Arc::new(loads.into_iter().zip(found).map(answer).collect());
        // The lock is not held while loads are solved, which takes long.
        known().insert(name, answers.clone());
        Ok(answers)
    }

    /// The loads that stretch the finer body so far at large deformation, on the points of the mesh of the scene, and its displacements there.
    /// `name` says which loads and which support they are, so that no load is followed twice.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn stretched(
        &self,
        name: String,
        support: &Support,
        make: &MakeLoads,
        stretch: f64,
        progress: &mut Progress,
    ) -> Result<Arc<StretchedLoads>> {
        let Some(large) = &self.large else { return Ok(Arc::default()) };
        let known = || self.stretched.lock().expect("nothing panics while it holds the loads");
        // Loads that are made depend on the stretch, so that the key has both.
        let name = format!("{name} {stretch}");
        if let Some(loads) = known().get(&name) {
            return Ok(loads.clone());
        }
        progress(Event::stage("finer body", 0, 1));
        let mut found = large.stretched(&self.mesh, support, make, stretch)?;
        for (load, u) in &mut found.loads {
            (load.forces, *u) = (self.embedding.restrict(&load.forces), self.sampling.interpolate(u));
        }
        let found = Arc::new(found);
        known().insert(name, found.clone());
        Ok(found)
    }

    /// The squares ω² of the `count` lowest frequencies under a support of the finer mesh, rad²/s².
    ///
    /// # Errors
    /// They are not found, or the material has no density.
    pub fn vibrations(&self, support: &Support, count: usize) -> Result<Vec<f64>> {
        let known = || self.squares.lock().expect("nothing panics while it holds the frequencies");
        // The same count alone: the last of fewer modes are less accurate, and results would depend on what was asked
        // before.
        if let Some((_, squares)) = known().iter().find(|(own, squares)| own == support && squares.len() == count) {
            return Ok(squares.clone());
        }
        let density = self.material.densities();
        let masses = lumped_masses(&self.mesh, density, self.material.thicknesses(), Lumping::Hrz);
        let equations = self.equations(support, VIBRATING * count)?;
        let squares = equations.lowest_modes(&masses, self.mesh.dimension, count)?.squares;
        known().push((support.clone(), squares.clone()));
        Ok(squares)
    }

    /// The displacements of the finer body with other moduli, at the points of the mesh of the scene, under loads of the scene.
    ///
    /// # Errors
    /// It has a region without factors, or no solution.
    pub fn moved(&self, loads: &[usize], factors: &RegionFactors, progress: &mut Progress) -> Result<Vec<Vec<f64>>> {
        let regions = BodyRegions::of(&self.mesh, &self.material);
        let moduli = self.material.moduli();
        let of_cell = |block: usize, cell: usize| -> Result<Hooke> {
            let own = regions.names(CellIndex { block, cell });
            let [shear, volume] = factors.get(own).ok_or_else(|| {
                let found = if own.is_empty() { "cells in no group".into() } else { own.join(", ") };
                let known = factors.keys().map(|groups| groups.join(", ")).collect::<Vec<_>>().join("; ");
                Error::expected("mesh", format!("the regions of the mesh ({known})"), found)
            })?;
            let isotropic = moduli.at(block, cell).moduli();
            let Moduli { lambda, mu } =
                isotropic.ok_or_else(|| Error::expected("mesh", "an isotropic material", "another"))?;
            Ok(Hooke::Isotropic(Moduli { lambda: volume * lambda, mu: shear * mu }))
        };
        let block =
            |(index, block): (usize, &CellBlock)| (0..block.cells().len()).map(|cell| of_cell(index, cell)).collect();
        let blocks = self.mesh.blocks.iter().enumerate().map(block).collect::<Result<Vec<Vec<Hooke>>>>()?;
        let moduli = CellMap::of_blocks(blocks);
        let cases = self.cases.get().map_or(&[][..], |cases| cases);
        let known = KnownEquations::default();
        let mut found = Vec::new();
        for (done, &load) in loads.iter().enumerate() {
            progress(Event::stage("finer body", done, loads.len()));
            let case = &cases[load];
            let equations = known
                .under(&case.support, || equations(&self.mesh, &moduli, &case.support, (self.solver, loads.len())))?;
            let (u, residual) = equations.solve(&case.forces)?;
            check_residual(residual, largest_residual(&self.solver), &case.name)?;
            found.push(self.sampling.interpolate(&u));
        }
        Ok(found)
    }

    /// Seconds of a linear implicit step of the finer body: one solution with the equations under a support that are there.
    ///
    /// # Errors
    /// There is no solution.
    pub fn seconds_per_step(&self, support: &Support) -> Result<f64> {
        self.equations(support, 1)?.seconds_per_step()
    }

    /// How many times as large as its own the cells of another mesh are.
    pub fn coarseness(&self, mesh: &Mesh) -> f64 {
        let kinds = |mesh: &Mesh| mesh.blocks.iter().map(|block| block.element.name.clone()).collect::<BTreeSet<_>>();
        let cells = |mesh: &Mesh| mesh.blocks.iter().map(|block| block.cells().len()).sum::<usize>();
        // Cells of different kinds have no sizes to compare; their points have distances.
        let [fine, coarse] = match kinds(&self.mesh) == kinds(mesh) {
            true => [&self.mesh, mesh].map(cells),
            false => [&self.mesh, mesh].map(Mesh::point_count),
        };
        // The ratio of sizes is the root of that of numbers.
        (fine as f64 / coarse as f64).powf(1.0 / mesh.cell_dimension() as f64)
    }

    /// The mass, centre and second moments of the finer body.
    pub fn moments(&self) -> Moments {
        let density = self.material.densities();
        Moments::of_body(&self.mesh, density, self.material.thicknesses())
    }
}
