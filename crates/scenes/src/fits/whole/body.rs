//! The body to which the whole-object fits of a scene are fitted.

use super::evidence::Evidence;
use super::found_moduli::found_moduli;
use super::moduli::FoundModuli;
use super::outcome::WholeOutcome;
use super::recipe::{Start, WholeRecipe};
use crate::body::Case;
use crate::body::FinerBody;
use crate::checkpoint::{Controls, Identity, Saved};
use crate::error::{Error, Result};
use crate::fit::CellFits;
use crate::material::{EnergyMap, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Network, Support, unheld_bodies};
use crate::progress::{Event, Progress};
use crate::solve::{Equations, KnownEquations, KnownPatterns, Newton, StaticSolver};
use crate::whole::{Snapshot, fit_whole};

/// The body to which the whole-object fits of a scene are fitted.
pub struct WholeBody<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) material: MaterialMap,
    /// The support of the `[[fix]]` entries.
    pub(super) support: &'a Support,
    /// The loads of the scene.
    pub cases: &'a [Case],
    /// The displacements of the finite elements, one list per case; `None` if the load was not reached.
    pub displacements: Vec<Option<&'a Vec<f64>>>,
    /// How loads are applied at large deformation; `None` at small deformation.
    pub newton: Option<Newton>,
    /// The energies of the laws, at large deformation.
    pub laws: Option<&'a EnergyMap>,
    /// The masses, `[points]`, kg.
    pub masses: Option<&'a [f64]>,
    /// How linear equations are solved.
    pub solver: StaticSolver,
    /// The finer mesh of the body that gives the displacements, if there is one.
    pub fine: Option<&'a FinerBody>,
    pub(super) controls: &'a Controls,
    /// The equations of the finite elements under the supports that were needed so far.
    known: KnownEquations,
}

impl<'a> WholeBody<'a> {
    /// The solutions of a fit under a support are as dear as this many loads, by which the way to solve equations is chosen. Each step has
    /// some tens of solutions for each load, which a factor serves without refinement.
    pub const ASKED: usize = 200;

    /// A body at small deformation, without loads of a scene.
    pub fn new(
        mesh: &'a Mesh,
        material: impl Into<MaterialMap>,
        support: &'a Support,
        controls: &'a Controls,
    ) -> WholeBody<'a> {
        let material = material.into();
        let (cases, displacements, newton, laws, masses, solver, fine, known) = Default::default();
        WholeBody { mesh, material, support, cases, displacements, newton, laws, masses, solver, fine, controls, known }
    }

    /// Tells it equations of the finite elements that are solved already.
    pub fn know(&self, solved: impl Iterator<Item = (Support, Equations)>) {
        self.known.keep(solved);
    }

    /// The equations of the finite elements under a support; the key of errors is what requires them.
    ///
    /// # Errors
    /// A body can move as a rigid body, some motion has no stiffness, or the equations do not fit into memory.
    pub fn equations(&self, key: &str, support: &Support) -> Result<Equations> {
        self.known.under(support, || {
            self.check_held(key, support)?;
            let found = Equations::of_body(
                self.mesh,
                &self.material.moduli(),
                support,
                (self.solver, WholeBody::ASKED),
                &KnownPatterns::default(),
            )?;
            found.ok_or_else(|| Error::expected(key, self.holding(support), "motions without stiffness"))
        })
    }

    /// Checks that a support holds every body; the key of errors is what requires it.
    ///
    /// # Errors
    /// A body can move as a rigid body.
    pub(super) fn check_held(&self, key: &str, support: &Support) -> Result<()> {
        let unheld = unheld_bodies(self.mesh, support);
        let Some(body) = unheld.first() else { return Ok(()) };
        let found = format!("{} rigid motions left to one of {} points", body.motions, body.points);
        Err(Error::expected(key, self.holding(support), found))
    }

    /// What a support must be.
    fn holding(&self, support: &Support) -> &'static str {
        match support == self.support {
            true => "supports in [[fix]] that hold every body, whatever the loads hold",
            false => "supports that hold every body",
        }
    }

    /// How equations of networks are solved: by iterations, or with factors.
    pub(super) fn iterations(&self) -> Option<StaticSolver> {
        self.solver.iterates(self.mesh, WholeBody::ASKED).then_some(self.solver)
    }

    /// The equations of a network under a support; `None` if it is not stable.
    ///
    /// # Errors
    /// They do not fit into memory.
    pub(super) fn equations_of(&self, network: &Network, support: &Support) -> Result<Option<Equations>> {
        let points = &self.mesh.points;
        if let Some(solver) = self.iterations() {
            let stiffness = BlockStiffness::of_network(network, points, None);
            return Equations::iterated(stiffness, points, support, solver);
        }
        network.check_size()?;
        Equations::factored(&network.stiffness(points), support, points, self.mesh.dimension)
    }

    /// Fits the constants of the network of `start`, which was assembled from its fits of the cells. Without `start`, fits the moduli
    /// of the exact network of the body.
    pub(crate) fn fit(
        &self,
        (name, springs, held): (&str, Option<&[String]>, &[bool]),
        recipe: &WholeRecipe,
        start: Option<(&[CellFits], &Network)>,
        progress: &mut Progress,
    ) -> Result<(Network, WholeOutcome)> {
        let mut followed = self.made_loads(recipe);
        let mut wanted = self.wanted(recipe, &mut followed, progress)?;
        // The finite elements have the moduli of the scene: they are no reference for a body that was measured.
        let is_measured = self.is_measured(recipe, &wanted)?;
        for (key, count) in [("masses", recipe.masses), ("frequencies", recipe.frequencies)] {
            if count > 0 && is_measured {
                let expected = "none where displacements are measured: frequencies are those of finite elements with the moduli of the scene";
                return Err(Error::expected(key, expected, count));
            }
        }
        let mut object = match start {
            Some((fits, network)) => {
                let mut object = self.springs(recipe, fits, network)?;
                if let Some(setting) = recipe.engine {
                    self.check_engine(recipe, &setting, network, &wanted)?;
                    object = object.in_engine(Some((setting, self.engine_masses()?)));
                }
                self.keep_reached(&object, &mut wanted, &mut followed)?;
                object
            }
            None if recipe.engine.is_some() => {
                let expected = "a start with springs above zero that do not pull at rest, which engines hold";
                return Err(Error::expected("start", expected, "\"exact\" in an engine"));
            }
            None => self.moduli(recipe, held, &mut wanted, &mut followed)?,
        };
        let settings = super::identity::identity(recipe, springs, self.newton.as_ref());
        let none = vec![0.0; object.unknowns().count()];
        // The checkpoint belongs to the network at θ = 0: with another start the same θ is another network.
        let identity = Identity::of(settings, &self.mesh.points, &object.network(&none), &wanted);
        let (mut saved, snapshot) = Saved::open(self.controls, name, identity)?;
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
        let found = fit_whole(&object, &wanted, &self.settings(recipe), snapshot, &mut watch)?;
        if let Err(e) = kept {
            // An error about the checkpoint must not discard the result.
            progress(Event::Note(&format!("{name}: the checkpoint is not the last state: {e}")));
        }
        let is_of_few_moduli = recipe.is_of_few_moduli() && found.stands;
        let (found, wanted, moduli) = match self.fine.filter(|_| is_of_few_moduli && is_measured) {
            Some(fine) => {
                let own = self.corrected(recipe, fine, (&object, &wanted), found, progress)?;
                let moduli = found_moduli(recipe, &object, &own.found, own.evidence, &own.deviations);
                (own.found, own.wanted, moduli)
            }
            None if is_of_few_moduli => {
                let evidence = Evidence::of_network(&object, &wanted, &found)?;
                let moduli = found_moduli(recipe, &object, &found, evidence, &[]);
                (found, wanted, moduli)
            }
            None => (found, wanted, FoundModuli::default()),
        };
        let has_others = self.fine.is_some() || !recipe.supports.is_empty() || !recipe.other_supports.is_empty();
        let has_others = has_others || (self.newton.is_some() || recipe.engine.is_some()) && recipe.loads.made;
        let held_out = if has_others && !is_measured {
            let networks = (&object.network(&none), &found.network);
            self.held_out((recipe, held), networks, &mut followed, progress)?
        } else {
            Vec::new()
        };
        let masses = if recipe.masses > 0 && found.stands && !found.cancelled {
            Some(self.fit_masses(recipe, &found.network, progress)?)
        } else {
            None
        };
        let [guessed, unmeasured] = if is_measured { self.guessed(recipe, &wanted) } else { Default::default() };
        let own = WholeOutcome::of(recipe, &wanted, &found);
        let outcome =
            WholeOutcome { is_measured, guessed, unmeasured, moduli, held_out, masses, stretched: followed, ..own };
        Ok((found.network, outcome))
    }
}
