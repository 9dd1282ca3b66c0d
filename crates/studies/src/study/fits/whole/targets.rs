//! The loads of a whole-object fit, and the displacements of the body under them.

use super::body::WholeBody;
use super::finer::Answers;
use super::recipe::{LoadSelection, ValidationRecipe, WholeRecipe};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{Support, check_body, unheld_bodies};
use crate::named::unknown;
use crate::solve::{Factor, System};
use crate::study::progress::Progress;
use crate::whole::{NodalLoad, Residual, Target, Validation, Wanted, made_loads, random_loads, varied_loads};
use std::sync::Arc;

/// The number of random loads that choose the regularization.
const RANDOM: usize = 4;
/// The number of varied loads for each support, where the fit has several or the displacements are those of a finer mesh: half as
/// many leave the worst loads worse, twice as many gain little.
const VARIED: usize = 16;

/// Makes loads from a mesh and its support.
pub(super) type Loads<'a> = dyn Fn(&Mesh, &Support) -> Vec<NodalLoad> + 'a;

/// A support under which loads are made from the mesh.
pub(super) struct Held {
    /// The groups that are held; empty for the `[[fix]]` of the scene.
    pub groups: Vec<String>,
    support: Support,
    /// The same on the finer mesh.
    fine: Option<Support>,
}

impl Held {
    /// The support in words.
    pub fn words(&self) -> String {
        if self.groups.is_empty() { "[[fix]]".into() } else { self.groups.join(", ") }
    }
}

impl WholeBody<'_> {
    /// The targets of a fit.
    pub(super) fn wanted(&self, recipe: &WholeRecipe, progress: &mut Progress) -> Result<Wanted> {
        recipe.check(self.newton.is_some(), self.masses.is_some())?;
        if self.fine.is_some() && recipe.frequencies > 0 {
            return Err(Error::at("frequencies", "does not go with [reference], whose body has others"));
        }
        let thickness = &self.material.thicknesses();
        let is_varied = self.is_varied(recipe);
        let supports = self.supports("supports", &recipe.supports)?;
        let make = |mesh: &Mesh, support: &Support| {
            let mut loads = made_loads(mesh, support, thickness);
            if is_varied {
                loads.extend(varied_loads(mesh, support, thickness, VARIED, recipe.seed));
            }
            loads
        };
        let trained = self.targets("loads", &recipe.loads, &supports, (&make, recipe.seed), progress)?;
        let validation = match &recipe.validation {
            ValidationRecipe::None => Validation::None,
            ValidationRecipe::LeaveOneOut => Validation::LeaveOneOut,
            ValidationRecipe::Loads(named) => {
                let others = match &recipe.validation_supports[..] {
                    [] => supports,
                    others => self.supports("validate_supports", others)?,
                };
                let make = |mesh: &Mesh, support: &Support| match is_varied {
                    true => varied_loads(mesh, support, thickness, VARIED, recipe.seed.wrapping_add(1)),
                    false => random_loads(mesh, support, thickness, RANDOM, recipe.seed),
                };
                Validation::Loads(self.targets("validate", named, &others, (&make, recipe.seed), progress)?)
            }
        };
        let frequencies = self.frequencies(recipe.frequencies)?;
        let balances = recipe.settings.residual != Residual::Displacements;
        Ok(Wanted { trained, validation, frequencies, body: balances.then(|| self.entries().clone()) })
    }

    /// Whether made loads are more than one of each kind.
    fn is_varied(&self, recipe: &WholeRecipe) -> bool {
        self.fine.is_some() || !recipe.supports.is_empty() || !recipe.validation_supports.is_empty()
    }

    /// The supports with these groups, or that of the scene.
    ///
    /// # Errors
    /// A mesh has no such group, or a body is not held; the error has the key `key`.
    pub(super) fn supports(&self, key: &str, groups: &[Vec<String>]) -> Result<Vec<Held>> {
        if groups.is_empty() {
            let fine = self.fine.map(|fine| fine.support().clone());
            return Ok(vec![Held { groups: Vec::new(), support: self.support.clone(), fine }]);
        }
        let held = |(i, names): (usize, &Vec<String>)| {
            let at = |mesh| held_by(mesh, names).map_err(|e| e.under(format!("{key}[{i}]")));
            let fine = self.fine.map(|fine| at(fine.mesh())).transpose()?;
            Ok(Held { groups: names.clone(), support: at(self.mesh)?, fine })
        };
        groups.iter().enumerate().map(held).collect()
    }

    fn targets(
        &self,
        key: &str,
        named: &LoadSelection,
        supports: &[Held],
        made: (&Loads, u64),
        progress: &mut Progress,
    ) -> Result<Vec<Target>> {
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
        if named.made {
            for held in supports {
                targets.extend(self.made(key, held, made, progress)?);
            }
        }
        Ok(targets)
    }

    /// The loads that are made with a seed from the mesh, or from the finer one, with the displacements of its finite elements.
    pub(super) fn made(
        &self,
        key: &str,
        held: &Held,
        (make, seed): (&Loads, u64),
        progress: &mut Progress,
    ) -> Result<Vec<Target>> {
        let answers: Answers = match (self.fine, &held.fine) {
            (Some(fine), Some(support)) => {
                let name = format!("{key} {seed} {:?}", held.groups);
                fine.answers(name, support, &|| make(fine.mesh(), support), progress)?
            }
            _ if held.groups.is_empty() => Arc::new(solved(self.held(key)?, make(self.mesh, &held.support))),
            _ => {
                check_body(self.mesh)?;
                let system = System::new(self.entries(), &held.support)?;
                let singular = || Error::expected(key, "supports without loose parts", "motions without stiffness");
                let factor = system.cholesky()?.ok_or_else(singular)?;
                Arc::new(solved(&(system, factor), make(self.mesh, &held.support)))
            }
        };
        let place = if held.groups.is_empty() { String::new() } else { format!(", held at {}", held.words()) };
        let target = |(load, u): &(NodalLoad, Vec<f64>)| {
            Target::new(format!("{}{place}", load.name), held.support.clone(), load.forces.clone(), u.clone())
        };
        Ok(answers.iter().map(target).collect())
    }
}

/// The loads with the displacements under them.
fn solved((system, factor): &(System, Factor), loads: Vec<NodalLoad>) -> Vec<(NodalLoad, Vec<f64>)> {
    let answer = |load: NodalLoad| {
        let u = system.solve(factor, &load.forces).0;
        (load, u)
    };
    loads.into_iter().map(answer).collect()
}

/// The support that holds these groups of points.
///
/// # Errors
/// There is no such group, or a body is not held.
fn held_by(mesh: &Mesh, groups: &[String]) -> Result<Support> {
    let mut support = Support::free(mesh);
    let directions: Vec<usize> = (0..mesh.dimension).collect();
    for name in groups {
        let known = mesh.groups.keys().map(String::as_str);
        let group = mesh.groups.get(name).ok_or_else(|| {
            let expected = format!("groups of the mesh ({})", known.clone().collect::<Vec<_>>().join(", "));
            unknown(expected, known.clone(), name)
        })?;
        support.fix(&group.points, &directions, mesh.dimension);
    }
    if let Some(body) = unheld_bodies(mesh, &support).first() {
        let found = format!("{} rigid motions left to one of {} points", body.motions, body.points);
        return Err(Error::new(format!("expected groups that hold every body, found {found}")));
    }
    Ok(support)
}
