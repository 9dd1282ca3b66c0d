//! A finer mesh of the body of a scene, whose finite elements the networks are compared with.

use super::answer::{check_residual, largest_residual};
use super::case::{Case, FinerSolution};
use super::cases::{applied_cases, held};
use super::fine_laws::FineLaws;
use super::finer::{answers, equations};
use crate::analysis::metrics::resultant;
use crate::error::{Error, Result};
use crate::material::{CellMap, Hooke, MaterialMap, Moduli};
use crate::mesh::{CellBlock, CellIndex, Embedding, Field, Mesh};
use crate::model::{Lumping, Moments, Support, lumped_masses};
use crate::solve::{Equations, KnownEquations, StaticSolver};
use crate::springs::norm;
use crate::study::fits::{Answers, Finer, RegionFactors};
use crate::study::outcome::Standard;
use crate::study::progress::{Event, Progress};
use crate::study::scene::Scene;
use crate::whole::{BodyRegions, MakeLoads, NodalLoad, StretchedLoads};
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, OnceLock};

/// A finer mesh of the same body.
pub struct FineBody {
    /// The finer mesh.
    mesh: Mesh,
    /// Its points in the cells of the mesh of the scene, for forces.
    embedding: Embedding,
    /// The points of the mesh of the scene in its cells, for displacements.
    sampling: Embedding,
    /// The support of the `[[fix]]` entries.
    support: Support,
    material: MaterialMap,
    /// Its laws, at large deformation.
    large: Option<FineLaws>,
    standard: Standard,
    solver: StaticSolver,
    /// The loads of the scene on it.
    cases: OnceLock<Vec<Case>>,
    /// The answers so far, by what was asked.
    known: Mutex<HashMap<String, Answers>>,
    /// The loads that were made at large deformation so far, by what was asked.
    stretched: Mutex<HashMap<String, Arc<StretchedLoads>>>,
    /// The squares of the frequencies so far, for each support.
    squares: Mutex<Vec<(Support, Vec<f64>)>>,
    /// The equations under the supports of the last questions.
    equations: KnownEquations,
}

/// The ratio of the contents of two meshes from which on they are of different bodies. Coarse meshes of curved bodies lack a sixth.
// A prism in a cylinder has 0.83 of its content with six sides, 0.76 with five and 0.64 with four: quotients of 1.21,
// 1.32 and 1.57.
const OTHER: f64 = 1.4;
/// The relative difference of the contents from which on it is reported. Errors of displacements change by about that
/// share.
const ALIKE: f64 = 0.02;
/// Total forces that differ by less than this share of the forces are one force. Tractions on the sides of two meshes
/// of one curved body differ by more than rounding.
const SAME_FORCE: f64 = 1e-3;
/// Solutions for each frequency, about.
const VIBRATING: usize = 8;
/// Loads that whole-object fits ask for under a support, about: those that they fit, those that choose ρ and those that none has seen.
const ASKED: usize = 75;
/// The relative residual above which an answer is refined: far below the errors of coarse networks.
const REFINED: f64 = 1e-9;

impl FineBody {
    /// The finer body of the scene, if it has one.
    ///
    /// # Errors
    /// The mesh is wrong, is of another body, or lacks the parts that are held.
    pub fn of(scene: &Scene, mesh: &Mesh, progress: &mut Progress) -> Result<Option<FineBody>> {
        let Some(entry) = scene.reference().filter(|entry| !entry.is_of_cells()) else { return Ok(None) };
        let at = |e: Error| e.placed(|e| scene.at("reference", e));
        let mut fine = entry.build(scene.path(), mesh).map_err(at)?;
        if fine.dimension != mesh.dimension {
            let expected = format!("a mesh of dimension {}", mesh.dimension);
            return Err(at(Error::expected("mesh", expected, fine.dimension)));
        }
        if let Some(note) = difference(mesh, &fine).map_err(at)? {
            progress(Event::Note(&note));
        }
        let another =
            |e: Error| at(Error::at("mesh", format!("is not one of the same body: {}", e.problem())).of_kind(e.kind()));
        let embedding = Embedding::of(&fine.points, mesh).map_err(another)?;
        let sampling = Embedding::of(&mesh.points, &fine).map_err(another)?;
        // Bodies whose surfaces are not the same have points that no cell of the other has; conditions are then asked on the finer mesh.
        if entry.mesh.is_some() && embedding.outside == 0 && sampling.outside == 0 {
            fine.choose_as_on(mesh, &embedding).map_err(another)?;
        }
        let support = held(scene, &fine)?;
        let material = scene.material_of(&fine)?;
        let laws = scene.laws(&fine, &material)?;
        let large = laws.map(|laws| FineLaws::of(&fine, laws, scene.newton()).map_err(at)).transpose()?;
        Ok(Some(FineBody {
            mesh: fine,
            embedding,
            sampling,
            support,
            material,
            large,
            standard: entry.standard(),
            solver: scene.solver(),
            cases: OnceLock::new(),
            known: Mutex::default(),
            stretched: Mutex::default(),
            squares: Mutex::default(),
            equations: KnownEquations::default(),
        }))
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

    /// The equations under a support, for about `loads` loads.
    fn equations(&self, support: &Support, loads: usize) -> Result<Equations> {
        let moduli = self.material.moduli();
        self.equations.under(support, || equations(&self.mesh, &moduli, support, (self.solver, loads)))
    }
}

/// That the total force of a load on the finer mesh is another one than on the mesh of the scene.
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

/// What differs between a mesh and a finer one of the same body.
///
/// # Errors
/// It is too much: they are meshes of different bodies.
fn difference(mesh: &Mesh, fine: &Mesh) -> Result<Option<String>> {
    let content = |mesh: &Mesh| Moments::of_body(mesh, CellMap::Uniform(1.0), CellMap::Uniform(1.0)).mass;
    let [own, other] = [content(mesh), content(fine)];
    let unit = ["m", "m²", "m³"][mesh.cell_dimension() - 1];
    // A body without content has a quotient that is infinite or NaN, and is refused as well.
    if !((own / other).max(other / own) <= OTHER) {
        let expected = format!("a mesh of the same body, of {own:.4e} {unit}");
        return Err(Error::expected("mesh", expected, format!("one of {other:.4e} {unit}")));
    }
    let share = 100.0 * (other / own - 1.0);
    if share.abs() > 100.0 * ALIKE {
        return Ok(Some(format!(
            "the finer mesh has {own:.4e} {unit} {share:+.1} %: errors of the networks have this difference"
        )));
    }
    let [own, other] = [mesh, fine].map(Mesh::point_count);
    Ok((other < own).then(|| format!("the finer mesh has fewer points than the mesh: {other} for {own}")))
}

impl Finer for FineBody {
    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn answers(
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
        let case = |load: NodalLoad| Case {
            name: load.name,
            support: support.clone(),
            forces: load.forces,
            pressed: None,
            cavity: None,
            is_prescribed: false,
            measured: None,
            is_measured: false,
            finer: None,
            noise: None,
        };
        let cases: Vec<Case> = loads().into_iter().map(case).collect();
        progress(Event::stage("finer body", 0, cases.len()));
        let forces: Vec<Vec<f64>> = cases.iter().map(|case| case.forces.clone()).collect();
        let solved = self.equations(support, ASKED)?.solve_each(&forces, REFINED)?;
        let largest = largest_residual(&self.solver);
        let checked = |(case, (u, residual))| check_residual(residual, largest, case).map(|()| u);
        let found: Vec<Vec<f64>> = cases.iter().zip(solved).map(checked).collect::<Result<_>>()?;
        let answer = |(case, u): (Case, Vec<f64>)| {
            (
                NodalLoad { name: case.name, forces: self.embedding.restrict(&case.forces) },
                self.sampling.interpolate(&u),
            )
        };
        let answers: Answers = Arc::new(cases.into_iter().zip(found).map(answer).collect());
        // The lock is not held while loads are solved, which takes long.
        known().insert(name, answers.clone());
        Ok(answers)
    }

    fn stretched(
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

    fn vibrations(&self, support: &Support, count: usize) -> Result<Vec<f64>> {
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

    fn moved(&self, loads: &[usize], factors: &RegionFactors, progress: &mut Progress) -> Result<Vec<Vec<f64>>> {
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
            check_residual(residual, largest_residual(&self.solver), case)?;
            found.push(self.sampling.interpolate(&u));
        }
        Ok(found)
    }

    fn seconds_per_step(&self, support: &Support) -> Result<f64> {
        self.equations(support, 1)?.seconds_per_step()
    }

    fn coarseness(&self, mesh: &Mesh) -> f64 {
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

    fn moments(&self) -> Moments {
        let density = self.material.densities();
        Moments::of_body(&self.mesh, density, self.material.thicknesses())
    }
}
