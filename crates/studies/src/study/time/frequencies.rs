//! Natural frequencies of the finite elements and the networks of a scene.

use super::raised::{RELEASE, Raised};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{
    BlockStiffness, Entries, Lumping, Support, check_body, finite_elements, lumped_masses, unheld_bodies,
};
use crate::solve::{Levels, System, lowest_modes};
use crate::study::outcome::{FrequencyOutcome, Outcome};
use crate::study::own_name::BODY;
use crate::study::progress::{Event, Progress};
use crate::study::scene::Scene;

/// The share of the largest ω² by which all are shifted if some motion has no stiffness.
const SHIFT: f64 = 1e-4;

/// The frequencies of the finite elements and of each network, with the `[[fix]]` support. Masses are row sums or, if
/// these are not positive, those of the HRZ method, unless the motion of the scene says which or they were fitted.
///
/// # Errors
/// There are fewer frequencies than requested. A model without frequencies is not an error.
pub fn natural_frequencies(
    scene: &Scene,
    support: &Support,
    outcome: &Outcome,
    progress: &mut Progress,
) -> Result<Vec<FrequencyOutcome>> {
    let (mesh, material) = (&outcome.mesh, &outcome.material);
    let masses = match (scene.motion(), &outcome.masses) {
        (None, Some(masses)) => masses.clone(),
        (motion, _) => {
            let lumping = motion.map_or(Lumping::Hrz, |motion| motion.lumping);
            lumped_masses(mesh, material.densities(), material.thicknesses(), lumping)
        }
    };
    let count = scene.output().frequencies;
    let rigid: usize = unheld_bodies(mesh, support).iter().map(|body| body.motions).sum();
    let free = support.prescribed.iter().filter(|u| u.is_none()).count().saturating_sub(rigid);
    if count > free {
        return Err(Error::new(format!("expected at most {free}, the motions that deform, found {count}")));
    }
    let total = outcome.fits.len() + 1;
    progress(Event::stage("frequencies", 0, total));
    // Rigid motions make the stiffness singular: levels alone do not find those after them.
    let iterates = rigid == 0 && scene.solver().iterates(mesh, 1);
    let of = |name: &str,
              masses: &[f64],
              blocks: &dyn Fn() -> Result<BlockStiffness>,
              entries: &dyn Fn() -> Result<Entries>| {
        let vibrations = Vibrations { mesh, support, masses, rigid, count };
        let iterated = if iterates { vibrations.by_levels(blocks()?) } else { None };
        let found = match iterated {
            Some(found) => Ok(found),
            None => vibrations.of(&entries()?).map_err(|e| e.problem().to_string()),
        };
        let (frequencies, reason) = match found {
            Ok(found) => (Some(found), None),
            Err(why) => (None, Some(why)),
        };
        Ok(FrequencyOutcome { name: name.into(), frequencies, rigid, reason })
    };
    let entries = || {
        check_body(mesh)?;
        Ok(finite_elements(mesh, material.moduli()))
    };
    let body = || BlockStiffness::of_body(mesh, material.moduli(), 1, 1);
    let mut all = vec![of(BODY, &masses, &body, &entries)?];
    for (done, fit) in outcome.fits.iter().enumerate() {
        progress(Event::stage("frequencies", done + 1, total));
        let entries = || {
            fit.network.check_size()?;
            Ok(fit.network.stiffness(&mesh.points))
        };
        let blocks = || Ok(BlockStiffness::of_network(&fit.network, &mesh.points, None));
        all.push(of(&fit.fit.name, fit.masses().unwrap_or(&masses), &blocks, &entries)?);
    }
    Ok(all)
}

struct Vibrations<'a> {
    mesh: &'a Mesh,
    support: &'a Support,
    /// The masses, `[points]`, kg.
    masses: &'a [f64],
    rigid: usize,
    count: usize,
}

impl Vibrations<'_> {
    /// Hz; `None` where the stiffness is not shown to be positive definite, or the iterations stall.
    fn by_levels(&self, stiffness: BlockStiffness) -> Option<Vec<f64>> {
        let levels = Levels::new(stiffness, &self.mesh.points, self.support).ok()?.ok()?;
        if levels.prove().ok()?.is_some() {
            return None;
        }
        Some(levels.lowest_modes(self.masses, self.mesh.dimension, self.count).ok()?.frequencies())
    }

    /// The frequencies, Hz.
    fn of(&self, stiffness: &Entries) -> Result<Vec<f64>> {
        let d = self.mesh.dimension;
        let system = System::new(stiffness, self.support)?.placed(&self.mesh.points, d);
        if let Some(factor) = system.cholesky()?.filter(|_| self.rigid == 0) {
            return Ok(lowest_modes(&system, &factor, self.masses, d, self.count)?.frequencies());
        }
        // (K + σ M) φ = (ω² + σ) M φ.
        let mut raised = Raised::new(stiffness.clone(), self.masses, self.support, self.mesh);
        let largest = raised.largest;
        let releases = || Error::new("some motion releases energy: it does not vibrate");
        raised.by(RELEASE * largest)?.cholesky()?.ok_or_else(releases)?;
        let system = raised.by(SHIFT * largest)?;
        let factor = system.cholesky()?.ok_or_else(releases)?;
        let modes = lowest_modes(&system, &factor, self.masses, d, self.rigid + self.count)?;
        let squares = modes.squares[self.rigid..].iter().map(|square| square - SHIFT * largest);
        Ok(squares.map(|square| square.max(0.0).sqrt() / std::f64::consts::TAU).collect())
    }
}
