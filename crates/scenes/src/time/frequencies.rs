//! Natural frequencies of the finite elements and the networks of a scene.

use super::raised::{RELEASE, Raised};
use crate::analysis::locking::Locking;
use crate::body::{MOST_POINTS, UNNOTICED, held};
use crate::error::{Error, Result};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{
    BlockStiffness, ConsistentMasses, Entries, Lumping, Support, check_body, finite_elements, lumped_masses,
    unheld_bodies,
};
use crate::outcome::{FrequencyOutcome, Outcome};
use crate::own_name::{BODY, QUADRATIC};
use crate::progress::{Event, Progress};
use crate::scene::Scene;
use crate::solve::{Levels, Masses, System, factor_cost, lowest_modes};

/// The share of the largest ω² by which all are shifted if some motion has no stiffness.
// Each ω² is a difference from the shift, and the sum of both is found to 1e-11 (`modes.rs`): 1e-15 of the largest is
// left of it as an error. A larger shift would leave more, and a smaller one would bring the factor nearer to a
// singular matrix.
const SHIFT: f64 = 1e-4;

/// The numbers of a mass matrix that are kept at most: 1.6 GB, those of 460 000 hexahedra or of 6 million tetrahedra.
const MOST_NUMBERS: usize = 100_000_000;

/// The frequencies of the finite elements, of each network, and of quadratic elements where the cells lock, with the `[[fix]]` support: with lumped masses, which are row sums or, if
/// these are not positive, those of the HRZ method, unless the motion of the scene says which or they were fitted; and with consistent
/// masses, the matrix of the cells.
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
    let consistent = consistent_masses(mesh, material);
    let of = |name: &str,
              masses: &[f64],
              blocks: &dyn Fn() -> Result<BlockStiffness>,
              entries: &dyn Fn() -> Result<Entries>| {
        let masses: Vec<Masses> =
            std::iter::once(masses.into()).chain(consistent.as_ref().ok().map(Masses::from)).collect();
        let vibrations = Vibrations { mesh, support, masses: &masses, rigid, count };
        let iterated = if iterates { vibrations.by_levels(blocks()?) } else { None };
        let found = match iterated {
            Some(found) => found,
            None => vibrations.of(&entries()?),
        };
        let mut reason = None;
        let mut known = |found: Result<Vec<f64>>| found.map_err(|e| reason.get_or_insert(e.problem().to_string())).ok();
        let mut found = found.into_iter();
        let frequencies = found.next().and_then(&mut known);
        let consistent = match &consistent {
            Ok(_) => found.next().and_then(&mut known),
            Err(why) => {
                reason.get_or_insert(why.clone());
                None
            }
        };
        Ok(FrequencyOutcome { name: name.into(), frequencies, consistent, rigid, reason })
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
    all.extend(of_quadratic(scene, mesh, material, count));
    Ok(all)
}

/// The frequencies of quadratic elements on the cells of a mesh that lock, with consistent masses. `None` of other meshes, where the scene asks for
/// the cells, and where this takes long or is not solved.
fn of_quadratic(scene: &Scene, mesh: &Mesh, material: &MaterialMap, count: usize) -> Option<FrequencyOutcome> {
    let is_asked = scene.reference().is_none_or(|entry| !entry.is_of_cells());
    Locking::of_body(mesh, material).filter(|_| is_asked)?;
    let finer = mesh.elevated().ok().filter(|finer| finer.point_count() <= MOST_POINTS)?;
    factor_cost(&finer).ok().filter(|cost| cost.operations <= UNNOTICED)?;
    let material = scene.material_of(&finer).ok()?;
    let support = held(scene, &finer).ok()?;
    let rigid = unheld_bodies(&finer, &support).iter().map(|body| body.motions).sum();
    let masses = consistent_masses(&finer, &material).ok()?;
    let vibrations = Vibrations { mesh: &finer, support: &support, masses: &[Masses::from(&masses)], rigid, count };
    let found = vibrations.of(&finite_elements(&finer, material.moduli())).pop()?.ok()?;
    Some(FrequencyOutcome { name: QUADRATIC.into(), frequencies: None, consistent: Some(found), rigid, reason: None })
}

/// The mass matrix of the cells, or why there is none.
fn consistent_masses(mesh: &Mesh, material: &MaterialMap) -> std::result::Result<ConsistentMasses, String> {
    let numbers = ConsistentMasses::numbers(mesh);
    if numbers > MOST_NUMBERS {
        return Err(format!("the mass matrix would take {numbers} numbers, at most {MOST_NUMBERS} are kept"));
    }
    ConsistentMasses::of_mesh(mesh, material.densities(), material.thicknesses()).map_err(|e| e.problem().to_string())
}

struct Vibrations<'a> {
    mesh: &'a Mesh,
    support: &'a Support,
    /// The kinds of masses with which the same stiffness vibrates.
    masses: &'a [Masses<'a>],
    rigid: usize,
    count: usize,
}

impl Vibrations<'_> {
    /// The frequencies with each kind of masses, Hz; `None` where the stiffness is not shown to be positive definite, or the iterations
    /// stall.
    fn by_levels(&self, stiffness: BlockStiffness) -> Option<Vec<Result<Vec<f64>>>> {
        let levels = Levels::new(stiffness, &self.mesh.points, self.support).ok()?.ok()?;
        if levels.prove().ok()?.is_some() {
            return None;
        }
        let of = |masses| Some(Ok(levels.lowest_modes(masses, self.mesh.dimension, self.count).ok()?.frequencies()));
        self.masses.iter().map(|masses| of(*masses)).collect()
    }

    /// The frequencies with each kind of masses, Hz.
    fn of(&self, stiffness: &Entries) -> Vec<Result<Vec<f64>>> {
        let d = self.mesh.dimension;
        let factored = || {
            let system = System::new(stiffness, self.support)?.placed(&self.mesh.points, d);
            let factor = system.cholesky()?.filter(|_| self.rigid == 0);
            Ok(factor.map(|factor| (system, factor)))
        };
        match factored() {
            Ok(Some((system, factor))) => {
                let of = |masses| Ok(lowest_modes(&system, &factor, masses, d, self.count)?.frequencies());
                self.masses.iter().map(|masses| of(*masses)).collect()
            }
            Ok(None) => self.masses.iter().map(|masses| self.raised(stiffness, *masses)).collect(),
            Err(e) => vec![Err(e)],
        }
    }

    /// Returns the frequencies of a body whose stiffness has no Cholesky factor, Hz, from `(K + σ M) φ = (ω² + σ) M φ`.
    fn raised(&self, stiffness: &Entries, masses: Masses) -> Result<Vec<f64>> {
        let d = self.mesh.dimension;
        let mut raised = Raised::new(stiffness.clone(), masses, self.support, (&self.mesh.points, d));
        let largest = raised.largest;
        let releases = || Error::new("some motion releases energy: it does not vibrate");
        // With the small shift a factor shows that no ω² is negative by more than rounding. The larger shift below
        // would hide motions that release energy.
        raised.by(RELEASE * largest)?.cholesky()?.ok_or_else(releases)?;
        let system = raised.by(SHIFT * largest)?;
        let factor = system.cholesky()?.ok_or_else(releases)?;
        let modes = lowest_modes(&system, &factor, masses, d, self.rigid + self.count)?;
        // Rigid motions have ω² = 0 and are the lowest: they are found with the others, and left out.
        let squares = modes.squares[self.rigid..].iter().map(|square| square - SHIFT * largest);
        // A mechanism has ω² = 0 up to rounding of either sign.
        Ok(squares.map(|square| square.max(0.0).sqrt() / std::f64::consts::TAU).collect())
    }
}
