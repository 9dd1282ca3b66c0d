//! The finer body of a scene: the answers of the finite elements of its finer mesh, which networks are compared with.

use super::case::{Case, FinerSolution};
use super::cases::applied_cases;
use super::finer_large::FinerLaws;
use super::finer_linear::{answers, equations};
use super::linear_answers::{check_residual, largest_residual};
use crate::analysis::metrics::resultant;
use crate::error::{Error, Result};
use crate::material::{CellMap, Hooke, MaterialMap, Moduli};
use crate::mesh::{CellBlock, CellIndex, Embedding, Field, Mesh};
use crate::model::{Lumping, Moments, Support, lumped_masses};
use crate::outcome::Standard;
use crate::progress::{Event, Progress};
use crate::scene::Scene;
use crate::solve::{Equations, KnownEquations, StaticSolver};
use crate::springs::norm;
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
/// Loads that whole-object fits ask for under a support, about: those that they fit, those that choose ρ and those that none has seen.
const ASKED: usize = 75;
/// The relative residual above which an answer is refined: far below the errors of coarse networks.
const REFINED: f64 = 1e-9;

/// Total forces that differ by less than this share of the forces are one force. Tractions on the sides of two meshes
/// of one curved body differ by more than rounding.
const SAME_FORCE: f64 = 1e-3;

impl FinerBody {
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

    /// Replaces the forces of the cases by those that do the same work as on the finer mesh, and gives each the displacements
    /// of the finer body at the points of the mesh of the scene, unless it has measured ones of its own.
    ///
    /// # Errors
    /// The finer body has no solution under a load.
    pub fn measure(&self, scene: &Scene, cases: &mut [Case], progress: &mut Progress) -> Result<()> {
        let (_, own) = applied_cases(scene, &self.mesh, &self.material)?;
        let body = (&self.mesh, &self.material, self.solver);
        let found = match &self.large {
            Some(large) => large.answers(&self.mesh, &own, progress),
            None => answers(body, &own, &self.equations, "finer body", progress),
        };
        let found = found.map_err(|e| e.placed(|e| scene.at("reference", e)))?;
        let dimension = self.mesh.dimension;
        for ((case, own), fine) in cases.iter_mut().zip(&own).zip(found) {
            if let Some(note) = other_force(case, own, dimension) {
                progress(Event::Note(&note));
            }
            // Pressures that follow are those of the sides of the mesh.
            let follows = self.large.is_some() && case.pressed.is_some();
            if !case.is_prescribed && !follows {
                case.forces = self.embedding.restrict(&own.forces);
            }
            if !case.is_measured {
                let displacements = self.sampling.interpolate(&fine.displacement).into_iter().map(Some).collect();
                case.measured = Some(Field { displacements });
                case.finer = Some(FinerSolution { standard: self.standard, work: fine.work, uncertainty: None });
            }
        }
        self.cases.get_or_init(|| own);
        Ok(())
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
        let solved = self.equations(support, ASKED)?.solve_each(&forces, REFINED)?;
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

/// The note that the total force of a load on the finer mesh is another one than on the mesh of the scene.
fn other_force(case: &Case, fine: &Case, dimension: usize) -> Option<String> {
    let [own, other] = [case, fine].map(|case| resultant(&case.forces, dimension));
    let apart: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
    let acting = case.forces.iter().map(|f| f.abs()).sum::<f64>();
    (norm(&apart) > SAME_FORCE * acting).then(|| {
        format!(
            "the total force of {} is {:.4e} N on the finer mesh and {:.4e} N on the mesh; networks get that of the finer mesh",
            case.name,
            norm(&other),
            norm(&own)
        )
    })
}
