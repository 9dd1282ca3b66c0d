//! The body to which the whole-object fits of a scene are fitted.

use super::outcome::WholeOutcome;
use super::recipe::{LoadSelection, Sharing, Start, ValidationRecipe, WholeRecipe};
use crate::error::{Error, Result};
use crate::fit::CellFits;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{Entries, Network, Support, check_body, finite_elements, unheld_bodies};
use crate::solve::{Factor, Newton, System, lowest_modes};
use crate::study::body::Case;
use crate::study::checkpoint::{Controls, Fingerprint, Saved};
use crate::study::progress::{Event, Progress};
use crate::whole::{
    Displacements, Frequencies, NodalLoad, Object, Residual, Snapshot, Target, Unknowns, Validation, Wanted, fit_whole,
    made_loads, random_loads,
};
use std::sync::OnceLock;

/// The number of random loads that choose the regularization.
const RANDOM: usize = 4;

/// The body to which the whole-object fits of a scene are fitted.
pub struct WholeBody<'a> {
    mesh: &'a Mesh,
    material: MaterialMap,
    /// The support of the `[[fix]]` entries.
    support: &'a Support,
    pub(in crate::study) cases: &'a [Case],
    /// The displacements of the finite elements, one list per case; `None` if the load was not reached.
    pub(in crate::study) displacements: Vec<Option<&'a Vec<f64>>>,
    /// How loads are applied at large deformation; `None` at small deformation.
    pub(in crate::study) newton: Option<Newton>,
    /// The masses, `[points]`, kg.
    pub masses: Option<&'a [f64]>,
    /// The equations of the finite elements with the `[[fix]]` support, if loads were solved with it.
    pub(in crate::study) solved: Option<&'a (System, Factor)>,
    controls: &'a Controls,
    entries: OnceLock<Entries>,
    held: OnceLock<(System, Factor)>,
}

impl<'a> WholeBody<'a> {
    /// A body at small deformation, without loads of a scene.
    pub fn new(
        mesh: &'a Mesh,
        material: impl Into<MaterialMap>,
        support: &'a Support,
        controls: &'a Controls,
    ) -> WholeBody<'a> {
        let material = material.into();
        let (cases, displacements, newton, masses, solved, entries, held) = Default::default();
        WholeBody { mesh, material, support, cases, displacements, newton, masses, solved, controls, entries, held }
    }

    /// The stiffness of the finite elements at rest.
    fn entries(&self) -> &Entries {
        self.entries.get_or_init(|| finite_elements(self.mesh, self.material.moduli()))
    }

    fn targets(&self, key: &str, named: &LoadSelection, make: impl Fn() -> Vec<NodalLoad>) -> Result<Vec<Target>> {
        let mut targets = Vec::new();
        for name in &named.names {
            let mut cases = self.cases.iter().zip(&self.displacements);
            let Some((case, displacement)) = cases.find(|(case, _)| case.name == *name) else { continue };
            let target = |u| Target::new(case.name.clone(), case.support.clone(), case.forces.clone(), u);
            targets.push(match (&case.measured, displacement) {
                (Some(field), _) => {
                    let known = field.displacements.iter().map(|u| u.map_or((0.0, 0.0), |u| (u, 1.0)));
                    let (displacement, weights) = known.unzip();
                    Target { weights, ..target(displacement) }
                }
                (None, Some(u)) => target(u.to_vec()),
                (None, None) => {
                    let expected = "loads that the finite elements reach";
                    return Err(Error::expected(key, expected, format!("\"{}\"", case.name)));
                }
            });
        }
        if !named.made {
            return Ok(targets);
        }
        let (system, factor) = self.held(key)?;
        for load in make() {
            let displacement = system.solve(factor, &load.forces).0;
            targets.push(Target::new(load.name, self.support.clone(), load.forces, displacement));
        }
        Ok(targets)
    }

    /// The equations of the finite elements with the `[[fix]]` support; the key of errors is what requires them.
    ///
    /// # Errors
    /// A body can move as a rigid body, or some motion has no stiffness.
    pub(in crate::study) fn held(&self, key: &str) -> Result<&(System, Factor)> {
        if let Some(known) = self.solved.or(self.held.get()) {
            return Ok(known);
        }
        let expected = "supports in [[fix]] that hold every body, whatever the loads hold";
        if let Some(body) = unheld_bodies(self.mesh, self.support).first() {
            let found = format!("{} rigid motions left to one of {} points", body.motions, body.points);
            return Err(Error::expected(key, expected, found));
        }
        check_body(self.mesh)?;
        let system = System::new(self.entries(), self.support)?;
        let factor = system.cholesky()?.ok_or_else(|| Error::expected(key, expected, "motions without stiffness"))?;
        Ok(self.held.get_or_init(|| (system, factor)))
    }

    fn frequencies(&self, count: usize) -> Result<Option<Frequencies>> {
        let Some(masses) = self.masses.filter(|_| count > 0) else { return Ok(None) };
        let (system, factor) = self.held("frequencies")?;
        let modes = lowest_modes(system, factor, masses, self.mesh.dimension, count)
            .map_err(|e| Error::at("frequencies", e.problem()))?;
        // All frequencies together have the weight of one load.
        let weight = 1.0 / count as f64;
        let (support, masses) = (self.support.clone(), masses.to_vec());
        Ok(Some(Frequencies { support, masses, squares: modes.squares, weight }))
    }

    fn wanted(&self, recipe: &WholeRecipe) -> Result<Wanted> {
        recipe.check(self.newton.is_some(), self.masses.is_some())?;
        let thickness = &self.material.thicknesses();
        let trained = self.targets("loads", &recipe.loads, || made_loads(self.mesh, self.support, thickness))?;
        let validation = match &recipe.validation {
            ValidationRecipe::None => Validation::None,
            ValidationRecipe::LeaveOneOut => Validation::LeaveOneOut,
            ValidationRecipe::Loads(named) => Validation::Loads(self.targets("validate", named, || {
                random_loads(self.mesh, self.support, thickness, RANDOM, recipe.seed)
            })?),
        };
        let frequencies = self.frequencies(recipe.frequencies)?;
        let balances = recipe.settings.residual != Residual::Displacements;
        Ok(Wanted { trained, validation, frequencies, body: balances.then(|| self.entries().clone()) })
    }

    /// Fits the constants of `network`, which was assembled from `fits`.
    pub(in crate::study) fn fit(
        &self,
        (name, springs): (&str, Option<&[String]>),
        recipe: &WholeRecipe,
        fits: &[CellFits],
        network: &Network,
        progress: &mut Progress,
    ) -> Result<(Network, WholeOutcome)> {
        let wanted = self.wanted(recipe)?;
        let settings = format!("{recipe:?} {springs:?} {:?}", self.newton);
        let fingerprint = Fingerprint::of(&settings, &self.mesh.points, network, &wanted);
        let (mut saved, snapshot) = Saved::open(self.controls, name, fingerprint)?;
        let unknowns = match recipe.unknowns {
            Sharing::Spring => Unknowns::per_spring(network),
            Sharing::Group => Unknowns::per_group(self.mesh, fits, network)?,
            Sharing::Region => Unknowns::per_region(self.mesh, self.material.region(), fits, network)?,
            Sharing::Element => Unknowns::per_element(self.mesh, fits, network)?,
        };
        let mut object = Object::new(network, &self.mesh.points, unknowns, self.newton)?;
        if recipe.start == Start::Equal {
            object = object.alike();
            if self.newton.is_none() {
                let theta = vec![0.0; object.unknowns().count()];
                let problem = Displacements::new(&object, wanted.trained.iter().collect(), None)?;
                let factor = problem.best_factor(&theta)?.unwrap_or(1.0);
                object = object.scaled(factor);
            }
        }
        if let Some(snapshot) = &snapshot {
            let (unknowns, stages) = (object.unknowns().count(), recipe.settings.regularizations.len());
            snapshot.check(unknowns, stages).map_err(|e| saved.blame(e))?;
        }
        let mut kept = Ok(());
        let stages = recipe.settings.regularizations.len();
        let mut watch = |snapshot: Option<&Snapshot>| {
            progress(Event::stage(name, snapshot.map_or(0, |snapshot| snapshot.stage), stages));
            let ends = self.controls.cancelled();
            if let (Some(snapshot), Ok(())) = (snapshot, &kept) {
                kept = saved.keep(snapshot, ends || snapshot.stage == stages);
            }
            !ends
        };
        let found = fit_whole(&object, &wanted, &recipe.settings, snapshot, &mut watch)?;
        if let Err(e) = kept {
            // An error about the checkpoint must not discard the result.
            progress(Event::Note(&format!("{name}: the checkpoint is not the last state: {e}")));
        }
        let outcome = WholeOutcome::of(recipe, &wanted, &found);
        Ok((found.network, outcome))
    }
}
