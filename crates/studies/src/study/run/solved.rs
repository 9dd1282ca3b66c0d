//! The finite elements of a run as far as its fits need them, and the fits.

use super::posed::Posed;
use crate::error::Result;
use crate::model::{Body, Elastic, LinearElastic, check_body, finite_elements};
use springfit_scenes::{
    Controls, Costed, Event, FinerBody, FitLimit, FitOutcome, LargeBody, LinearBody, ModelTimes, NamedFit, PointMasses,
    Progress, Reference, Statics, Task, WholeBody, fit_mesh, fit_without_errors, model_times, on_one_thread,
    point_masses, seconds_of_body, seconds_of_network, time_fits,
};

/// The density that steps are timed with where the scene gives none, kg/m³.
const WATER: f64 = 1000.0;

/// The finite elements that are solved before the fits.
pub(super) struct Solved {
    /// The finer body that gives the displacements, if there is one.
    fine: Option<FinerBody>,
    /// The body at large deformation.
    pub large: Option<LargeBody>,
    /// The body at small deformation; `None` where no fit needs its displacements, which are then found after the fits.
    pub linear: Option<LinearBody>,
    pub masses: Option<PointMasses>,
}

impl Solved {
    /// Solves what the fits of the scene need. The finer body's displacements become those that loads are compared with.
    ///
    /// # Errors
    /// Some motion has no stiffness, equations do not fit into memory, or a file of displacements is wrong.
    pub fn of(posed: &mut Posed, progress: &mut Progress) -> Result<Solved> {
        let scene = posed.scene;
        let fine = FinerBody::of(scene, &posed.mesh, progress)?;
        if let Some(fine) = &fine {
            fine.measure(scene, &mut posed.cases, progress)?;
        }
        let large = posed.energy.take().map(|energy| {
            LargeBody::solve(&posed.mesh, energy, scene.newton(), &posed.cases, progress).map_err(|e| posed.in_scene(e))
        });
        let large = large.transpose()?;
        let masses = posed.material.density().map(|density| point_masses(&posed.mesh, density, &posed.material));
        let masses = masses.transpose().map_err(|e| scene.at("material", e))?;
        // Only fits to the whole object need the displacements of the body.
        let fits_whole = scene.fits().iter().any(|fit| fit.recipe.whole().is_some() || fit.engine.is_some());
        let linear = match large.is_none() && fits_whole {
            true => Some(solve_linear(posed, progress)?),
            false => None,
        };
        Ok(Solved { fine, large, linear, masses })
    }

    /// Each fit of the scene, in its order.
    ///
    /// # Errors
    /// A fit does not go with the mesh, the material or the loads; the error names it.
    pub fn fits(&self, posed: &Posed, controls: &Controls, progress: &mut Progress) -> Result<Vec<FitOutcome>> {
        let Posed { scene, mesh, material, .. } = posed;
        let whole = self.whole(posed, controls);
        let held = posed.held_points();
        let reference = Reference { large: self.large.as_ref(), whole: Some(&whole), held: &held };
        let mut fits = Vec::new();
        for fit in scene.fits() {
            let fitted = match scene.output().has_errors() {
                true => fit_mesh(mesh, material, &reference, fit, progress),
                false => fit_without_errors(mesh, material, &reference, fit, progress).map(|(fitted, _)| fitted),
            };
            fits.push(fitted.map_err(|e| e.placed(|e| scene.at(&fit.place(), e)))?);
        }
        Ok(fits)
    }

    /// How stiff a body the engine of each fit that has one can hold.
    ///
    /// # Errors
    /// The engine does not hold the springs; the error names the fit.
    pub fn engine_limits(&self, posed: &Posed, controls: &Controls, progress: &mut Progress) -> Result<Vec<FitLimit>> {
        let Posed { scene, mesh, material, .. } = posed;
        let whole = self.whole(posed, controls);
        let held = posed.held_points();
        let reference = &Reference { large: self.large.as_ref(), whole: Some(&whole), held: &held };
        let mut limits = Vec::new();
        for (fit, setting) in scene.fits().iter().filter_map(|fit| Some((fit, fit.engine?))) {
            let task = Task { name: &fit.name, springs: fit.springs.as_deref(), mesh, material, reference };
            let network = fit.recipe.kind().start(&task, progress);
            let limit = network.and_then(|network| whole.engine_limit(setting, &network, progress));
            let limit = limit.map_err(|e| e.placed(|e| scene.at(&fit.place(), e)))?;
            limits.push(FitLimit { fit: fit.name.clone(), limit });
        }
        Ok(limits)
    }

    /// Measures what the fits, their networks and the finite elements cost, if the scene asks for it: on one thread, in turns. Returns
    /// the costs of the finite elements.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn measure_times(
        &self,
        posed: &Posed,
        fits: &mut [FitOutcome],
        progress: &mut Progress,
    ) -> Result<Option<ModelTimes>> {
        if !posed.scene.output().time {
            return Ok(None);
        }
        progress(Event::stage("times", 0, 2));
        let made: Vec<NamedFit> = fits.iter().map(|fit| fit.fit.clone()).collect();
        let times = on_one_thread(|| {
            let controls = Controls::default();
            let whole = self.whole(posed, &controls);
            let held = posed.held_points();
            let reference = Reference { large: self.large.as_ref(), whole: Some(&whole), held: &held };
            time_fits(&posed.mesh, &posed.material, &reference, &made)
        })?;
        progress(Event::stage("times", 1, 2));
        let mut models = on_one_thread(|| self.model_times(posed, fits))?.into_iter();
        let of_body = models.next();
        for ((fit, times), model) in fits.iter_mut().zip(times).zip(models) {
            (fit.times, fit.model_times) = (Some(times), Some(model));
        }
        Ok(of_body)
    }

    /// The costs of the finite elements, and those of each network.
    fn model_times(&self, posed: &Posed, fits: &[FitOutcome]) -> Result<Vec<ModelTimes>> {
        let Posed { scene, mesh, material, support, cases, .. } = posed;
        let solver = scene.solver();
        let moduli = material.moduli();
        // Steps cost the same with any density.
        let masses = match &self.masses {
            Some(masses) => masses.values.clone(),
            None => point_masses(mesh, WATER, material)?.values,
        };
        let case = cases.first();
        let (body, linear);
        let (model, is_linear): (&dyn Elastic, bool) = match &self.large {
            Some(large) => {
                body = Body::new(mesh, &large.laws);
                (&body, false)
            }
            None => {
                check_body(mesh)?;
                linear = LinearElastic { points: &mesh.points, stiffness: finite_elements(mesh, moduli.clone()) };
                (&linear, true)
            }
        };
        let of_body = case.map(|case| -> Statics {
            match &self.large {
                Some(large) => Box::new(move || large.seconds(model, mesh, case)),
                None => Box::new(|| seconds_of_body(mesh, &moduli, case, solver)),
            }
        });
        let prepared: Vec<_> = fits.iter().map(|fit| fit.network.prepared()).collect();
        let points = &mesh.points;
        let costed =
            |model, linear, masses, statics, engine| Costed { model, linear, points, support, masses, statics, engine };
        let mut models = vec![costed(model, is_linear, &masses[..], of_body, None)];
        for (fit, prepared) in fits.iter().zip(&prepared) {
            let network = &fit.network;
            let of_network = case.map(|case| -> Statics {
                match &self.large {
                    Some(large) => Box::new(move || large.seconds(network, mesh, case)),
                    None => Box::new(move || seconds_of_network(mesh, network, case, solver)),
                }
            });
            let engine = fit.fit.engine.map(|setting| (network, setting));
            models.push(costed(prepared, false, fit.masses().unwrap_or(&masses), of_network, engine));
        }
        model_times(&models, self.masses.is_some())
    }

    /// The body to which whole-object fits are fitted.
    fn whole<'a>(&'a self, posed: &'a Posed, controls: &'a Controls) -> WholeBody<'a> {
        let mut whole = WholeBody::new(&posed.mesh, &posed.material, &posed.support, controls);
        whole.cases = &posed.cases;
        whole.displacements = match (&self.large, &self.linear) {
            (Some(large), _) => large.complete().collect(),
            (None, Some(linear)) => linear.displacements().map(Some).collect(),
            (None, None) => Vec::new(),
        };
        whole.newton = self.large.as_ref().map(|_| posed.scene.newton());
        whole.laws = self.large.as_ref().map(|large| &large.laws);
        whole.fine = self.fine.as_ref();
        whole.masses = self.masses.as_ref().map(|masses| &masses.values[..]);
        whole.solver = posed.scene.solver();
        whole.know(self.linear.iter().flat_map(|linear| linear.held(&posed.cases)));
        whole
    }
}

/// The finite elements at small deformation under each load.
///
/// # Errors
/// Some motion has no stiffness, the equations do not fit into memory, or iterations that were asked for stall.
pub(super) fn solve_linear(posed: &Posed, progress: &mut Progress) -> Result<LinearBody> {
    let moduli = posed.material.moduli();
    LinearBody::solve(&posed.mesh, &moduli, &posed.cases, posed.scene.solver(), progress).map_err(|e| posed.in_scene(e))
}
