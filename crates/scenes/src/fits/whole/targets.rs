//! The loads of a whole-object fit, and the displacements of the body under them.

use super::body::WholeBody;
use super::held::{Held, held_by};
use super::made_loads::MadeLoads;
use super::outcome::SupportPart;
use super::recipe::{LoadSelection, ValidationRecipe, WholeRecipe};
use crate::body::Answers;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::model::Support;
use crate::progress::Progress;
use crate::whole::{
    NodalLoad, PRESSURE, Pressure, Target, Validation, Wanted, Weighing, WholeSettings, made_loads, random_loads,
    varied_loads,
};
use std::sync::Arc;

/// The number of random loads that choose the regularization.
const RANDOM: usize = 4;
/// The number of varied loads for each support, where the fit has several or the displacements are those of a finer mesh: half as
/// many leave the worst loads worse, twice as many gain little.
const VARIED: usize = 16;

/// The least range of constants that a fit for an engine may use.
// A sweep adds the compliance of a spring to what its points have between them. Single precision drops what is below 6e-8 of that: a
// constant 1e8 times as large as another is rigid beside it, and a larger one is no other spring.
const BOUNDED: f64 = 1e8;

/// Makes loads from a mesh and its support. Those that are drawn at random are others with each seed.
pub(super) type Loads<'a> = dyn Fn(&Mesh, &Support, u64) -> Vec<NodalLoad> + 'a;

impl WholeBody<'_> {
    /// The targets of a fit.
    pub(super) fn wanted(
        &self,
        recipe: &WholeRecipe,
        followed: &mut Option<MadeLoads>,
        progress: &mut Progress,
    ) -> Result<Wanted> {
        recipe.check(self.newton.is_some(), self.masses.is_some())?;
        let thickness = &self.material.thicknesses();
        let is_varied = self.is_varied(recipe);
        let supports = self.supports("supports", &recipe.supports)?;
        let make = |mesh: &Mesh, support: &Support, seed: u64| {
            let mut loads = made_loads(mesh, support, thickness);
            if is_varied {
                loads.extend(varied_loads(mesh, support, thickness, Pressure::Uniform, (VARIED, seed)));
            }
            loads
        };
        let made = (&make as &Loads, recipe.seed);
        let mut trained = self.targets("loads", &recipe.loads, &supports, made, followed, progress)?;
        let validation = match &recipe.validation {
            ValidationRecipe::None => Validation::None,
            ValidationRecipe::LeaveOneOut => Validation::LeaveOneOut,
            ValidationRecipe::Discrepancy => Validation::Discrepancy,
            ValidationRecipe::Loads(named) => {
                let others = match &recipe.validation_supports[..] {
                    [] => supports,
                    others => self.supports("validate_supports", others)?,
                };
                let make = |mesh: &Mesh, support: &Support, seed: u64| match is_varied {
                    true => {
                        let drawn = (VARIED, seed.wrapping_add(1));
                        varied_loads(mesh, support, thickness, Pressure::Varying, drawn)
                    }
                    false => random_loads(mesh, support, thickness, RANDOM, seed),
                };
                let made = (&make as &Loads, recipe.seed);
                Validation::Loads(self.targets("validate", named, &others, made, followed, progress)?)
            }
        };
        let noise = self.weigh(recipe, &mut trained)?;
        if recipe.engine.is_some() && noise.is_none() {
            weigh_by_compliance(&mut trained);
        }
        let frequencies = self.frequencies(recipe.frequencies)?;
        Ok(Wanted { trained, validation, frequencies, noise })
    }

    /// Weighs the loads by the noise of their displacements, if it is known for each; returns the deviation of the residuals.
    ///
    /// # Errors
    /// It is known for some of them only, or it is needed and not known.
    fn weigh(&self, recipe: &WholeRecipe, trained: &mut [Target]) -> Result<Option<f64>> {
        let known =
            |target: &Target| self.cases.iter().find(|case| case.name == target.name).and_then(|case| case.noise);
        let sigmas: Vec<Option<f64>> = trained.iter().map(known).collect();
        let needed = recipe.validation == ValidationRecipe::Discrepancy;
        if let Some(without) = sigmas.iter().position(Option::is_none) {
            // Loads are weighed by their noise all together or not at all, because weights of two kinds cannot be
            // compared.
            if needed || sigmas.iter().any(Option::is_some) {
                let expected = "a sigma in the measured displacements of every load that is fitted, or of none";
                let key = if needed { "validate" } else { "loads" };
                return Err(Error::expected(key, expected, format!("none for \"{}\"", trained[without].name)));
            }
            return Ok(None);
        }
        // ‖ū_l‖/σ_l.
        let size = |(target, sigma): (&Target, f64)| {
            let square: f64 = target.displacement.iter().zip(&target.weights).map(|(u, weight)| weight * u * u).sum();
            square.sqrt() / sigma
        };
        let sizes: Vec<f64> = trained.iter().zip(sigmas.into_iter().flatten()).map(size).collect();
        // Only ratios of weights matter to the minimum. Relative to the largest, errors are of the size that they have
        // without noise, so that ρ means the same.
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        trained.iter_mut().zip(&sizes).for_each(|(target, size)| target.weight = (size / largest).powi(2));
        Ok(Some(1.0 / largest))
    }

    /// The settings of the optimisation. Among varied loads are some that a network of the mesh cannot follow, such as tractions in
    /// balance near the parts that are held; they would decide a fit in which all count alike. For an engine loads are weighed by their
    /// compliance.
    pub(super) fn settings(&self, recipe: &WholeRecipe) -> WholeSettings {
        let weighing = match recipe.loads.made && self.is_varied(recipe) && recipe.engine.is_none() {
            true => Weighing::ByError,
            false => Weighing::Equal,
        };
        let settings = recipe.settings.clone();
        // A spring without compliance is as good as one with little: what sweeps reach is bounded.
        let range = if recipe.engine.is_some() { settings.range.max(BOUNDED) } else { settings.range };
        WholeSettings { weighing, range, ..settings }
    }

    /// Whether made loads are more than one of each kind.
    fn is_varied(&self, recipe: &WholeRecipe) -> bool {
        self.fine.is_some()
            || recipe.engine.is_some()
            || !recipe.supports.is_empty()
            || !recipe.validation_supports.is_empty()
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

    /// The supports of the fit, after them those of its validation alone, and last those that neither has.
    pub(super) fn all_supports(&self, recipe: &WholeRecipe) -> Result<Vec<(Held, SupportPart)>> {
        let mut all: Vec<(Held, SupportPart)> = Vec::new();
        for (key, groups, part) in [
            ("supports", &recipe.supports, SupportPart::Fitted),
            ("validate_supports", &recipe.validation_supports, SupportPart::Consulted),
            ("other_supports", &recipe.other_supports, SupportPart::Unseen),
        ] {
            if groups.is_empty() && part != SupportPart::Fitted {
                continue;
            }
            for held in self.supports(key, groups)? {
                if all.iter().all(|(known, _)| known.support != held.support) {
                    all.push((held, part));
                }
            }
        }
        Ok(all)
    }

    fn targets(
        &self,
        key: &str,
        named: &LoadSelection,
        supports: &[Held],
        made: (&Loads, u64),
        followed: &mut Option<MadeLoads>,
        progress: &mut Progress,
    ) -> Result<Vec<Target>> {
        let mut targets = Vec::new();
        for name in &named.names {
            let mut cases = self.cases.iter().zip(&self.displacements);
            let Some((case, displacement)) = cases.find(|(case, _)| case.name == *name) else { continue };
            if (case.pressed.is_some() || case.cavity.is_some()) && self.newton.is_some() {
                let expected = "loads whose forces keep their directions, of a material with a law";
                return Err(Error::expected(
                    key,
                    expected,
                    format!("the pressure of \"{}\", which follows the body", case.name),
                )
                .of_kind(ErrorKind::Unsupported));
            }
            let target = |u| Target::new(case.name.clone(), case.support.clone(), case.forces.clone(), u);
            targets.push(match (&case.measured, displacement) {
                (Some(field), _) => {
                    // What is held has no displacement to explain, and no noise: the support says where it is.
                    let held = case.support.prescribed.iter().map(Option::is_some);
                    let known = field.displacements.iter().zip(held).map(|(u, held)| match u {
                        Some(u) => (*u, f64::from(u8::from(!held))),
                        None => (0.0, 0.0),
                    });
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
                targets.extend(self.made((key, key), held, made, followed, progress)?);
            }
        }
        Ok(targets)
    }

    /// The loads that are made with a seed from the mesh, or from the finer one, with the displacements of its finite elements. Errors have the key,
    /// and `set` says in words what the loads are for.
    pub(super) fn made(
        &self,
        (key, set): (&str, &str),
        held: &Held,
        (make, seed): (&Loads, u64),
        followed: &mut Option<MadeLoads>,
        progress: &mut Progress,
    ) -> Result<Vec<Target>> {
        let name = format!("{set} {seed} {:?}", held.groups);
        let place = if held.groups.is_empty() { String::new() } else { format!(", held at {}", held.words()) };
        let answers: Answers = match (followed, self.fine, &held.fine) {
            (Some(followed), ..) => {
                let all = self.stretched(key, held, (make, seed), followed.stretch, name, progress)?;
                followed.add((set, &place), &all);
                Arc::new(all.loads.clone())
            }
            (None, Some(fine), Some(support)) => {
                fine.answers(name, support, &|| make(fine.mesh(), support, seed), progress)?
            }
            (None, ..) => {
                let equations = self.equations(key, &held.support)?;
                let answer = |load: NodalLoad| {
                    let u = equations.solve(&load.forces)?.0;
                    Ok((load, u))
                };
                Arc::new(make(self.mesh, &held.support, seed).into_iter().map(answer).collect::<Result<_>>()?)
            }
        };
        let target = |(load, u): &(NodalLoad, Vec<f64>)| {
            let name = format!("{}{place}", load.name);
            // Without it the fit loses the resistance to a change of volume, which the other loads hardly see.
            let is_firm = load.name == PRESSURE;
            Target { is_firm, is_made: true, ..Target::new(name, held.support.clone(), load.forces.clone(), u.clone()) }
        };
        Ok(answers.iter().map(target).collect())
    }
}

/// Weighs loads by their compliance `‖ū‖/‖f‖` over its median. Tractions in balance near what is held hardly move the body, and what an
/// engine leaves of them does not matter where loads of the same strength bend or twist it.
fn weigh_by_compliance(trained: &mut [Target]) {
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let compliance = |target: &Target| norm(&target.displacement) / norm(&target.forces);
    // A load without forces has an infinite compliance, or none.
    let mut sorted: Vec<f64> = trained.iter().map(compliance).filter(|c| c.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2).copied().filter(|median| *median > 0.0) else { return };
    for target in trained {
        let weight = compliance(target) / median;
        if weight > 0.0 && weight.is_finite() {
            target.weight = weight;
        }
    }
}
