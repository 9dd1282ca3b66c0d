//! Computes fits to the forces at sampled shapes.

use super::outcome::SampledOutcome;
use super::recipe::SampledRecipe;
use super::record::SampledRecord;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{SampledFits, fit_sampled};
use crate::material::{Energy, Material, MaterialMap};
use crate::study::body::LargeBody;
use crate::study::fits::facts::SceneFacts;
use crate::study::fits::fitted::{Fitted, FittedKind};
use crate::study::fits::kind::{FitKind, Task};
use crate::study::fits::record::KindRecord;
use crate::study::progress::Progress;
use std::sync::Arc;
use std::time::Instant;

impl FitKind for SampledRecipe {
    fn title(&self, groups: &str) -> String {
        let mut title = format!("sampled{}{groups}", self.force.name());
        if self.fit.tied {
            title += " tied";
        }
        if self.fit.nonnegative {
            title += " k>=0";
        }
        title
    }

    fn check(&self, scene: &SceneFacts) -> Result<()> {
        SampledRecipe::check(self, scene)
    }

    fn fit(&self, task: &Task, progress: &mut Progress) -> Result<Fitted> {
        let start = Instant::now();
        let found = fit_shapes(self, task, progress)?;
        let kind = FittedKind::Sampled(SampledOutcome::of(self, &found));
        let cells = found.into_iter().map(|found| found.fits).collect();
        Ok(Fitted::assembled(task.mesh, cells, start.elapsed().as_secs_f64(), kind))
    }

    fn sampled(&self) -> Option<&SampledRecipe> {
        Some(self)
    }

    fn record(&self) -> KindRecord {
        KindRecord::Sampled(Box::new(SampledRecord::of(self)))
    }
}

/// The fits of each block of cells.
///
/// # Errors
/// There is no energy or no shape, a force law has no group, or the elements have no such spring group.
pub fn fit_shapes(recipe: &SampledRecipe, task: &Task, progress: &mut Progress) -> Result<Vec<SampledFits>> {
    let Task { mesh, material, .. } = *task;
    let state = material.state();
    let own = recipe.law.as_ref().map(|law| Energy::load(law, one_material(material)?)).transpose();
    let own = own.map_err(|e| e.placed(|e| Error::at("law", e.problem())))?;
    let own = own.map(|energy| LargeBody::at_rest((energy, state)));
    let expected = "the energy whose forces are sampled";
    let large = own.as_ref().or(task.reference.large).ok_or_else(|| Error::expected("law", expected, "none"))?;
    let (energy, state) = large.laws.uniform().ok_or_else(several_laws)?;
    let states = Arc::new(large.states(mesh, &recipe.loads)?);
    let mut known = Vec::new();
    for block in &mesh.blocks {
        known.extend(block.element.select_groups(task.springs)?.iter().map(|group| group.name.as_str()));
    }
    recipe.force.check_groups(&known)?;
    task.each_block(progress, |_, block, springs, progress| {
        let fit = recipe.resolve(&block.element, springs, &states)?;
        let (points, cells) = (&mesh.points, &block.connectivity);
        fit_sampled(&block.element, springs, points, cells, energy, state, &fit, progress)
    })
}

/// The material of a body that has one.
///
/// # Errors
/// The body has several; the kind is `Unsupported`.
fn one_material(material: &MaterialMap) -> Result<Material> {
    material.uniform().ok_or_else(several_laws)
}

fn several_laws() -> Error {
    let expected = "one material in all cells for the law of a sampled fit";
    Error::expected("law", expected, "several").of_kind(ErrorKind::Unsupported)
}
