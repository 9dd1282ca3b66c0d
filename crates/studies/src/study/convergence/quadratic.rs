//! The truth where linear cells lock: their own limit is far from it on all meshes that fit into memory, and that of quadratic elements on the same
//! cells is not.

use super::outcome::{LoadConvergence, ModelConvergence, Step};
use super::quantities::Quantities;
use crate::analysis::locking::Locking;
use crate::error::Result;
use crate::mesh::Mesh;
use springfit_scenes::{FinerAnswer, Outcome, Progress, QUADRATIC, Scene, quadratic_answers};

/// Quadratic elements on the levels of linear cells that lock.
pub(super) struct Quadratic {
    locking: Locking,
    /// The steps on the levels so far, by load; `None` from where they are not known.
    loads: Option<Vec<ModelConvergence>>,
}

impl Quadratic {
    /// Begins without a level, if the cells of the first one lock. The text says what the truth is.
    pub fn of(outcome: &Outcome) -> Option<(Quadratic, String)> {
        let locking = Locking::of_body(&outcome.mesh, &outcome.material)?;
        let locks = format!(
            "at nu = {} linear cells lock, and the finite elements do not converge to the truth",
            locking.poisson
        );
        let loads = match outcome.law {
            Some(_) => None,
            None => Some(vec![ModelConvergence { name: QUADRATIC.into(), steps: Vec::new() }; outcome.loads.len()]),
        };
        let truth = match loads {
            Some(_) => "it is that of quadratic elements on the same cells",
            None => "of a law at large deformation none is known without --truth",
        };
        Some((Quadratic { locking, loads }, format!("{locks}: {truth}")))
    }

    /// Adds a level; returns what must be said if there is no answer.
    pub fn add(&mut self, scene: &Scene, mesh: &Mesh, progress: &mut Progress) -> Option<String> {
        let loads = self.loads.as_mut()?;
        match steps(scene, mesh, progress) {
            Ok(steps) => {
                loads.iter_mut().zip(steps).for_each(|(model, step)| model.steps.push(step));
                None
            }
            Err(error) => {
                self.loads = None;
                Some(format!(
                    "at nu = {} linear cells lock, and quadratic elements are not solved ({}): no truth is known",
                    self.locking.poisson,
                    error.problem()
                ))
            }
        }
    }

    /// The name of what gives the truth; `None` where nothing does.
    pub fn name(&self) -> Option<String> {
        self.loads.as_ref().map(|_| QUADRATIC.into())
    }

    /// Gives each load the truth of quadratic elements in place of that of the finite elements.
    pub fn judge(&self, loads: &mut [LoadConvergence]) {
        for (place, load) in loads.iter_mut().enumerate() {
            let model = self.loads.as_ref().map(|loads| loads[place].clone());
            let known = model.map(|model| LoadConvergence::new(load.name.clone(), load.is_prescribed, vec![model]));
            (load.truth, load.mean_truth) = known.map_or((None, None), |known| (known.truth, known.mean_truth));
        }
    }
}

/// The results of quadratic elements on the cells of a level, by load.
fn steps(scene: &Scene, mesh: &Mesh, progress: &mut Progress) -> Result<Vec<Step>> {
    let (finer, answers) = quadratic_answers(scene, mesh, progress)?;
    let quantities = Quantities::of(scene, &finer, &scene.material_of(&finer)?)?;
    let of_load = |(answer, quantity): (FinerAnswer, &Quantities)| Step {
        compliance: answer.work,
        mean_displacement: quantity.mean_displacement(&answer.displacement),
        rms: None,
        status: "solved",
    };
    Ok(answers.into_iter().zip(&quantities).map(of_load).collect())
}
