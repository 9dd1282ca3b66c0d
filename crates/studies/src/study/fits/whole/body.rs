//! The body to which the whole-object fits of a scene are fitted.

use super::finer::Finer;
use super::found_moduli::found_moduli;
use super::outcome::WholeOutcome;
use super::recipe::{Start, WholeRecipe};
use crate::error::{Error, Result};
use crate::fit::CellFits;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{Entries, Network, Support, check_body, finite_elements, unheld_bodies};
use crate::solve::{Factor, Newton, System, lowest_modes};
use crate::study::body::Case;
use crate::study::checkpoint::{Controls, Fingerprint, Saved};
use crate::study::progress::{Event, Progress};
use crate::whole::{Frequencies, Snapshot, fit_whole};
use std::sync::OnceLock;

/// The body to which the whole-object fits of a scene are fitted.
pub struct WholeBody<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) material: MaterialMap,
    /// The support of the `[[fix]]` entries.
    pub(super) support: &'a Support,
    pub(in crate::study) cases: &'a [Case],
    /// The displacements of the finite elements, one list per case; `None` if the load was not reached.
    pub(in crate::study) displacements: Vec<Option<&'a Vec<f64>>>,
    /// How loads are applied at large deformation; `None` at small deformation.
    pub(in crate::study) newton: Option<Newton>,
    /// The masses, `[points]`, kg.
    pub masses: Option<&'a [f64]>,
    /// The equations of the finite elements with the `[[fix]]` support, if loads were solved with it.
    pub(in crate::study) solved: Option<&'a (System, Factor)>,
    /// The finer mesh of the body that gives the displacements, if there is one.
    pub(in crate::study) fine: Option<&'a dyn Finer>,
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
        let (cases, displacements, newton, masses, solved, fine, entries, held) = Default::default();
        WholeBody {
            mesh,
            material,
            support,
            cases,
            displacements,
            newton,
            masses,
            solved,
            fine,
            controls,
            entries,
            held,
        }
    }

    /// The stiffness of the finite elements at rest.
    pub(super) fn entries(&self) -> &Entries {
        self.entries.get_or_init(|| finite_elements(self.mesh, self.material.moduli()))
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

    pub(super) fn frequencies(&self, count: usize) -> Result<Option<Frequencies>> {
        let Some(masses) = self.masses.filter(|_| count > 0) else { return Ok(None) };
        let (system, factor) = self.held("frequencies")?;
        let modes = lowest_modes(system, factor, masses, self.mesh.dimension, count)
            .map_err(|e| Error::at("frequencies", e.problem()))?;
        // All frequencies together have the weight of one load.
        let weight = 1.0 / count as f64;
        let (support, masses) = (self.support.clone(), masses.to_vec());
        Ok(Some(Frequencies { support, masses, squares: modes.squares, weight }))
    }

    /// Fits the constants of the network of `start`, which was assembled from its fits of the cells. Without `start`, fits the moduli
    /// of the exact network of the body.
    pub(in crate::study) fn fit(
        &self,
        (name, springs, held): (&str, Option<&[String]>, &[bool]),
        recipe: &WholeRecipe,
        start: Option<(&[CellFits], &Network)>,
        progress: &mut Progress,
    ) -> Result<(Network, WholeOutcome)> {
        let wanted = self.wanted(recipe, progress)?;
        let mut object = match start {
            Some((fits, network)) => self.springs(recipe, fits, network)?,
            None => self.moduli(recipe, held, &wanted)?,
        };
        let settings = format!("{recipe:?} {:?} {:?}", springs, self.newton);
        let none = vec![0.0; object.unknowns().count()];
        let fingerprint = Fingerprint::of(&settings, &self.mesh.points, &object.network(&none), &wanted);
        let (mut saved, snapshot) = Saved::open(self.controls, name, fingerprint)?;
        if recipe.start == Start::Equal {
            object = self.equal(object, &wanted)?;
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
        let moduli = found_moduli(recipe, &object, &wanted, &found)?;
        let held_out = if self.fine.is_some() || !recipe.supports.is_empty() {
            self.held_out(recipe, &object.network(&none), &found.network, progress)?
        } else {
            Vec::new()
        };
        let outcome = WholeOutcome { moduli, held_out, ..WholeOutcome::of(recipe, &wanted, &found) };
        Ok((found.network, outcome))
    }
}
