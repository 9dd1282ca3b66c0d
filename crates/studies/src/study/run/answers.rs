//! The answers of the finite elements and of the networks to the loads.

use super::posed::Posed;
use super::solved::{Solved, solve_linear};
use crate::analysis::locking::{TooStiff, bends, lacking};
use crate::error::Result;
use crate::material::EnergyMap;
use crate::mesh::Mesh;
use crate::model::Deformation;
use crate::study::stages::stages;
use springfit_scenes::{
    BodyLoad, Case, Event, FitOutcome, Followed, LargeBody, LinearBody, Outcome, PointMasses, Progress, TimePlan,
    load_notes,
};

/// The displacements of the finite elements; those of the networks are with their fits.
pub(super) struct Answers {
    /// The finite elements have these displacements under each load, `[points · dimension]`, m.
    displacements: Vec<Vec<f64>>,
    /// How far each load was followed; `None` at small deformation.
    followed: Vec<Option<Followed>>,
    /// The works of the loads along the displacements, J; `None` at large deformation.
    works: Vec<Option<f64>>,
    bent: Bent,
    /// Why the cells of the mesh resist these deformations too much.
    too_stiff: Option<TooStiff>,
    /// The energies of the laws, at large deformation.
    laws: Option<EnergyMap>,
    masses: Option<PointMasses>,
}

impl Answers {
    /// Solves every load with every network, and with the finite elements where no fit has needed that.
    ///
    /// # Errors
    /// The equations do not fit into memory, or iterations that were asked for stall.
    pub fn of(posed: &mut Posed, solved: Solved, fits: &mut [FitOutcome], progress: &mut Progress) -> Result<Answers> {
        let Solved { large, linear, masses, .. } = solved;
        let count = posed.cases.len();
        let vibrates = count == 0 && posed.scene.output().frequencies > 0;
        let stiff_cells = |posed: &Posed, lacking: &[Option<f64>]| match vibrates {
            true => TooStiff::of_vibrations(&posed.mesh, &posed.material),
            false => TooStiff::of(&posed.mesh, &posed.material, lacking),
        };
        let (displacements, works, followed, laws, bent, too_stiff) = match large {
            Some(large) => {
                let deformed = |u: &Vec<f64>| bends(Deformation::largest(&posed.mesh, u));
                let has_bent: Vec<bool> = large.displacements.iter().map(deformed).collect();
                let bent = Bent::of(posed, large.displacements.iter(), vec![None; count], has_bent, true);
                let too_stiff = stiff_cells(posed, &bent.lacking);
                if let Some(TooStiff::Locks(locking)) = too_stiff {
                    posed.tell_of_locking(locking);
                }
                at_large(posed, &large, fits, progress)?;
                let followed = large.followed.into_iter().map(Some).collect();
                (large.displacements, vec![None; count], followed, Some(large.laws), bent, too_stiff)
            }
            None => {
                let body = linear.map_or_else(|| solve_linear(posed, progress), Ok)?;
                let deformed = |u: &Vec<f64>| Some(Deformation::largest(&posed.mesh, u));
                let deformations: Vec<_> = body.displacements().map(deformed).collect();
                let has_bent: Vec<bool> = deformations.iter().map(|found| found.is_some_and(bends)).collect();
                let bent = Bent::of(posed, body.displacements(), deformations, has_bent, false);
                let too_stiff = stiff_cells(posed, &bent.lacking);
                // After the fits, which are to the finite elements of the mesh.
                if let Some(too_stiff) = too_stiff.filter(|cells| *cells != TooStiff::Coarse) {
                    posed.judge_by_quadratic_elements(too_stiff, &bent.deformations, progress);
                }
                posed.judge_sheet(body.displacements(), progress);
                at_small(posed, (&body, masses.as_ref()), fits, progress)?;
                let (displacements, works) = body.into_answers();
                (displacements, works, vec![None; count], None, bent, too_stiff)
            }
        };
        if count > 0 {
            posed.tell_of_higher_order();
        }
        if let Some(gauged) = &posed.gauged {
            fits.iter_mut().for_each(|fit| gauged.measure(&posed.mesh, &mut fit.loads));
        }
        Ok(Answers { displacements, works, bent, too_stiff, followed, laws, masses })
    }

    /// All that was found, without what happens over time; with the plan of that, and the laws that it needs.
    pub fn outcome(self, posed: Posed, fits: Vec<FitOutcome>) -> (Outcome, TimePlan, Option<EnergyMap>) {
        let Answers { displacements, works, bent, too_stiff, followed, laws, masses } = self;
        let Posed { scene, mesh, material, support, cases, gauged, plan, of_reference, .. } = posed;
        let answers = cases.iter().zip(displacements.into_iter().zip(works)).zip(followed).enumerate();
        let loads = answers.map(|(i, ((case, (fem, work)), followed))| {
            let load = &scene.loads()[i];
            let gravity = load.gravity(scene.loads(), &mesh);
            BodyLoad {
                name: case.name.clone(),
                support: case.support.clone(),
                forces: forces(case, followed.as_ref(), &mesh),
                is_gravity: load.is_acceleration() && gravity.is_some(),
                gravity,
                gauge: gauged.as_ref().map(|gauged| gauged.body(&mesh, i, &fem, followed.as_ref())),
                measured: case.measured(&mesh, &fem, work),
                deformation: bent.deformations[i],
                bends: bent.has_bent[i],
                lacking: bent.lacking[i],
                followed,
                fem,
            }
        });
        let loads = loads.collect();
        let outcome = Outcome {
            scene: scene.title().into(),
            inputs: scene.inputs(),
            settings: scene.settings().iter().map(|setting| setting.to_string()).collect(),
            command: None,
            source: scene.mesh().title(),
            assumed: scene.assumption(&mesh),
            of_loads: load_notes(scene, &mesh, &cases).into_iter().chain(of_reference).collect(),
            left_out: stages(scene).into_iter().filter_map(|(what, why)| Some(format!("{what}: {}", why?))).collect(),
            mesh,
            material,
            support: Some(support),
            lumping: masses.as_ref().map(|masses| masses.lumping),
            masses: masses.map(|masses| masses.values),
            law: laws.as_ref().map(EnergyMap::title),
            fibres: laws.as_ref().and_then(EnergyMap::distance_at_rest),
            loads,
            too_stiff,
            fits,
            model_times: None,
            motion: None,
            frequencies: Vec::new(),
            dynamic_moduli: None,
            damping: scene.measured_damping(),
        };
        (outcome, plan, laws)
    }
}

/// How each load deforms the finite elements.
struct Bent {
    /// How far they deform; `None` at large deformation.
    deformations: Vec<Option<Deformation>>,
    /// Whether they bend or are twisted.
    has_bent: Vec<bool>,
    /// What cells lack where they bend, see [`lacking`].
    lacking: Vec<Option<f64>>,
}

impl Bent {
    fn of<'b>(
        posed: &Posed,
        displacements: impl Iterator<Item = &'b Vec<f64>>,
        deformations: Vec<Option<Deformation>>,
        has_bent: Vec<bool>,
        is_large: bool,
    ) -> Bent {
        let of_load = |(u, bends): (&Vec<f64>, &bool)| match bends {
            true => lacking(&posed.mesh, &posed.material, u, is_large),
            false => None,
        };
        let lacking = displacements.zip(&has_bent).map(of_load).collect();
        Bent { deformations, has_bent, lacking }
    }
}

/// The nodal forces of a load; those of a cavity that is filled are those of its pressure with the points at rest.
fn forces(case: &Case, followed: Option<&Followed>, mesh: &Mesh) -> Vec<f64> {
    let pressure = followed.and_then(|followed| followed.pressure);
    match case.cavity.as_ref().zip(pressure) {
        Some((cavity, pressure)) => cavity.sides.forces(&mesh.points).iter().map(|f| pressure * f).collect(),
        None => case.forces.clone(),
    }
}

/// The answers of the networks at large deformation.
fn at_large(posed: &Posed, body: &LargeBody, fits: &mut [FitOutcome], progress: &mut Progress) -> Result<()> {
    let count = fits.len();
    for (done, fit) in fits.iter_mut().enumerate() {
        progress(Event::stage("networks", done, count));
        fit.loads = body.compare(&posed.mesh, &posed.cases, &fit.network)?;
    }
    Ok(())
}

/// The answers of the networks at small deformation, and how they stand.
fn at_small(
    posed: &Posed,
    (body, masses): (&LinearBody, Option<&PointMasses>),
    fits: &mut [FitOutcome],
    progress: &mut Progress,
) -> Result<()> {
    let count = fits.len();
    for (done, fit) in fits.iter_mut().enumerate() {
        progress(Event::stage("networks", done, count));
        let compared = fit.kind.compared(posed.material.moduli());
        let engine = fit.fit.engine.zip(masses.map(|masses| &masses.values[..]));
        let answers = body.compare(&posed.mesh, &posed.cases, (&fit.network, engine), &compared, progress);
        let answers = answers.map_err(|e| posed.in_scene(e))?;
        (fit.loads, fit.stability, fit.loose_points) = (answers.loads, answers.stability, answers.loose_points);
    }
    Ok(())
}
