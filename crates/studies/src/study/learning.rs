//! The errors of a sampled fit over the number of its shapes.

use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::fit::{Sampling, Spread};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use serde::Serialize;
use springfit_scenes::{
    Event, FamilyOutcome, NamedFit, Progress, Recipe, Reference, SampledRecipe, fit_without_errors,
};

/// A fit to the first shapes of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LearningPoint {
    /// The seed of the sequence.
    pub seed: u64,
    /// The number of shapes that were asked for, of each set.
    pub shapes: usize,
    /// The time of the fit without the shapes that are held out, s.
    pub seconds: f64,
    /// The relative errors of the forces on the shapes of the fit, over the cells.
    pub trained: Spread,
    /// Those on the shapes that are held out, which are the same for all points.
    pub held_out: Spread,
    /// Those on the shapes of each family that are held out.
    pub families: Vec<FamilyOutcome>,
}

/// Fits a sampled fit to the first shapes of one sequence for each seed, as many as each of `counts`. A longer sequence begins with the shapes
/// of a shorter one, also of a Latin hypercube, which is laid over the longest; the shapes that are held out are those of the fit's own seed.
///
/// # Errors
/// The fit is no sampled one or holds no shapes out, there is no count or seed, a count is out of its bounds or above the number of a list; or
/// those of the fit.
pub fn learning_curve(
    mesh: &Mesh,
    material: &MaterialMap,
    reference: &Reference,
    named: &NamedFit,
    counts: &[usize],
    seeds: &[u64],
    progress: &mut Progress,
) -> Result<Vec<LearningPoint>> {
    let Recipe::Sampled(recipe) = &named.recipe else {
        return Err(Error::expected("objective", "a fit of the objective \"sampled\"", format!("\"{}\"", named.name)));
    };
    let Some(&longest) = counts.iter().max() else {
        return Err(Error::expected("counts", "at least one number of shapes", "none"));
    };
    counts.iter().try_for_each(|count| check_count("counts", *count as u64, 1, bound::SHAPES))?;
    if seeds.is_empty() {
        return Err(Error::expected("seeds", "at least one seed", "none"));
    }
    if recipe.fit.sets().all(|set| set.held_out == 0 && set.others.is_none()) {
        return Err(Error::expected("shapes.held_out", "shapes that are held out", "0"));
    }
    let mut points = Vec::new();
    let total = seeds.len() * counts.len();
    for &seed in seeds {
        for &count in counts {
            progress(Event::stage(&named.name, points.len(), total));
            let fitted = |held_out: bool| {
                let recipe = with_first(recipe, (seed, count, longest), held_out);
                let own = NamedFit::named(named.name.clone(), Recipe::Sampled(Box::new(recipe)), named.springs.clone());
                fit_without_errors(mesh, material, reference, &own, &mut |_| {})
            };
            // In a run of its own, without the errors on other shapes, which are no part of a fit.
            let seconds = fitted(false)?.0.seconds;
            let outcome = fitted(true)?.0;
            let missing = || Error::expected("shapes.held_out", "shapes apart from those of the fit", "none");
            let found = outcome.kind.sampled().ok_or_else(missing)?;
            let held_out = found.held_out.ok_or_else(missing)?;
            points.push(LearningPoint {
                seed,
                shapes: count,
                seconds,
                trained: found.trained,
                held_out,
                families: found.families.clone(),
            });
        }
    }
    progress(Event::stage(&named.name, total, total));
    Ok(points)
}

/// The recipe with the first `count` of the `longest` shapes of this seed, with or without shapes that are held out.
fn with_first(recipe: &SampledRecipe, (seed, count, longest): (u64, usize, usize), held_out: bool) -> SampledRecipe {
    let mut recipe = recipe.clone();
    recipe.fit.data = false;
    let of_set = |set: &mut Sampling| {
        // Before the seed changes: shapes that are held out stay those of the fit's own seed.
        set.seed_held_out.get_or_insert(set.seed);
        (set.seed, set.shapes, set.laid) = (seed, count, Some(longest));
        if !held_out {
            // A list keeps its rows that are held out, so that the others are the same.
            set.held_out = 0;
            set.others.iter_mut().for_each(|others| others.shapes = 1);
        }
    };
    std::iter::once(&mut recipe.fit.sampling).chain(&mut recipe.fit.beside).for_each(of_set);
    recipe.origins.iter_mut().for_each(|origin| origin.count = Some(count));
    recipe
}
