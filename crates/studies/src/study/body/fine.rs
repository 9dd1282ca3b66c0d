//! A finer mesh of the body of a scene, whose finite elements the networks are compared with.

use super::case::Case;
use super::cases::{held, load_cases};
use super::linear::LinearBody;
use crate::error::{Error, Result};
use crate::material::MaterialMap;
use crate::mesh::{Embedding, Field, Mesh};
use crate::model::Support;
use crate::solve::StaticSolver;
use crate::study::fits::{Answers, Finer};
use crate::study::progress::{Event, Progress};
use crate::study::scene::Scene;
use crate::whole::NodalLoad;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

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
    solver: StaticSolver,
    /// The answers so far, by what was asked.
    known: Mutex<HashMap<String, Answers>>,
}

impl FineBody {
    /// The finer body of the scene, if it has one.
    ///
    /// # Errors
    /// The mesh is wrong, is of another body, or lacks the parts that are held.
    pub fn of(scene: &Scene, mesh: &Mesh) -> Result<Option<FineBody>> {
        let Some(entry) = scene.reference() else { return Ok(None) };
        let at = |e: Error| e.placed(|e| scene.at("reference", e));
        let fine = entry.build(scene.path(), mesh).map_err(at)?;
        if fine.dimension != mesh.dimension {
            let expected = format!("a mesh of dimension {}", mesh.dimension);
            return Err(at(Error::expected("mesh", expected, fine.dimension)));
        }
        let another =
            |e: Error| at(Error::at("mesh", format!("is not one of the same body: {}", e.problem())).of_kind(e.kind()));
        let embedding = Embedding::of(&fine.points, mesh).map_err(another)?;
        let sampling = Embedding::of(&mesh.points, &fine).map_err(another)?;
        let support = held(scene, &fine)?;
        let material = scene.material_of(&fine)?;
        Ok(Some(FineBody {
            mesh: fine,
            embedding,
            sampling,
            support,
            material,
            solver: scene.solver(),
            known: Mutex::default(),
        }))
    }

    /// Replaces the forces of the cases by those that do the same work as on the finer mesh, and gives each the displacements
    /// of the finer body at the points of the mesh of the scene.
    ///
    /// # Errors
    /// A load has measured displacements of its own, or the finer body has no solution under it.
    pub fn measure(&self, scene: &Scene, cases: &mut [Case], progress: &mut Progress) -> Result<()> {
        let (_, own) = load_cases(scene, &self.mesh, &self.material)?;
        if let Some(i) = cases.iter().position(|case| case.measured.is_some()) {
            let problem = "does not go with [reference], whose finite elements give the displacements";
            return Err(scene.at(&format!("load[{i}]"), Error::at("measured", problem)));
        }
        let found = self.displacements(&own, progress).map_err(|e| e.placed(|e| scene.at("reference", e)))?;
        for ((case, own), fine) in cases.iter_mut().zip(&own).zip(found) {
            if !case.is_prescribed {
                case.forces = self.embedding.restrict(&own.forces);
            }
            let displacements = self.sampling.interpolate(&fine).into_iter().map(Some).collect();
            case.measured = Some(Field { displacements });
        }
        Ok(())
    }

    fn displacements(&self, cases: &[Case], progress: &mut Progress) -> Result<Vec<Vec<f64>>> {
        progress(Event::stage("finer body", 0, cases.len()));
        let body = LinearBody::solve(&self.mesh, &self.material.moduli(), cases, self.solver, progress)?;
        Ok(body.into_displacements())
    }
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
            is_prescribed: false,
            measured: None,
        };
        let cases: Vec<Case> = loads().into_iter().map(case).collect();
        let found = self.displacements(&cases, progress)?;
        let answer = |(case, u): (Case, Vec<f64>)| {
            (
                NodalLoad { name: case.name, forces: self.embedding.restrict(&case.forces) },
                self.sampling.interpolate(&u),
            )
        };
        let answers: Answers = Arc::new(cases.into_iter().zip(found).map(answer).collect());
        known().insert(name, answers.clone());
        Ok(answers)
    }
}
