//! Computes fits to the forces at sampled shapes.

use super::outcome::SampledOutcome;
use super::recipe::SampledRecipe;
use super::record::SampledRecord;
use super::shapes_check::of_shapes;
use crate::body::LargeBody;
use crate::clock::Clock;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{SampledFits, fit_sampled};
use crate::fits::facts::SceneFacts;
use crate::fits::fitted::{Fitted, FittedKind};
use crate::fits::kind::{FitKind, Task};
use crate::fits::record::KindRecord;
use crate::material::{Energy, EnergyMap, Material, MaterialMap, State};
use crate::progress::Progress;
use crate::stiffness::EnergyFunction;
use std::collections::BTreeMap;

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
        let start = Clock::start();
        let found = fit_shapes(self, task, progress)?;
        let kind = FittedKind::Sampled(SampledOutcome::of(self, &found, task.mesh.cell_dimension()));
        let cells = found.into_iter().map(|found| found.fits).collect();
        Ok(Fitted::assembled(task.mesh, cells, start.seconds(), kind))
    }

    fn sampled(&self) -> Option<&SampledRecipe> {
        Some(self)
    }

    fn record(&self) -> KindRecord {
        KindRecord::Sampled(Box::new(SampledRecord::of(self)))
    }
}

/// The most materials of a body for which the law of a fit is worked out.
// Each has a law that is read and proved on its own. A body with more has moduli that vary from cell to cell.
const MATERIALS: usize = 64;

/// The fits of each block of cells.
///
/// # Errors
/// There is no energy or no shape, a force law has no group, or the elements have no such spring group.
pub fn fit_shapes(recipe: &SampledRecipe, task: &Task, progress: &mut Progress) -> Result<Vec<SampledFits>> {
    let Task { mesh, material, .. } = *task;
    if let Some(energy) = &recipe.energy {
        return fit_function(recipe, energy, task, progress);
    }
    let own = recipe.law.as_ref().map(|law| laws(law, material)).transpose();
    let own = own.map_err(|e| e.placed(|e| Error::at("law", e.problem())))?.map(LargeBody::at_rest);
    let expected = "the energy whose forces are sampled";
    let large = own.as_ref().or(task.reference.large).ok_or_else(|| Error::expected("law", expected, "none"))?;
    let states = recipe.states(mesh, Some(large))?;
    check_groups(recipe, task)?;
    task.each_block(progress, |index, block, springs, progress| {
        let fit = recipe.resolve(&block.element, springs, &states)?;
        let mut regions = Vec::new();
        let mut by_law: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for cell in 0..block.cells().len() {
            by_law.entry(*large.laws.index().at(index, cell)).or_default().push(cell);
        }
        if by_law.is_empty() {
            by_law.insert(0, Vec::new());
        }
        for cells in by_law.into_values() {
            let (energy, state) = match cells.first() {
                Some(&first) => large.laws.at(index, first),
                // A block without cells has an empty fit.
                None => (large.laws.first(), material.state()),
            };
            let connectivity: Vec<usize> = cells.iter().flat_map(|cell| block.cell(*cell)).copied().collect();
            let (element, points) = (&block.element, &mesh.points);
            let found = fit_sampled(element, springs, points, &connectivity, energy, state, &fit, progress);
            let mut found = found.map_err(of_shapes)?;
            found.errors.iter_mut().for_each(|error| error.cell = cells[error.cell]);
            found.starts.iter_mut().for_each(|start| start.cell = cells[start.cell]);
            regions.push((cells, found));
        }
        Ok(joined(regions))
    })
}

/// The fits of each block of cells of one material, whose energy is a function.
///
/// # Errors
/// The cells have several materials, shapes are those of loads, or those of [`fit_shapes`].
fn fit_function(
    recipe: &SampledRecipe,
    energy: &EnergyFunction,
    task: &Task,
    progress: &mut Progress,
) -> Result<Vec<SampledFits>> {
    let states = recipe.states(task.mesh, None)?;
    let Some(material) = task.material.uniform() else {
        let expected = "one material of all cells for an energy that is a function";
        return Err(Error::expected("law", expected, "several").of_kind(ErrorKind::Unsupported));
    };
    check_groups(recipe, task)?;
    task.each_block(progress, |_, block, springs, progress| {
        let fit = recipe.resolve(&block.element, springs, &states)?;
        let points = &task.mesh.points;
        fit_sampled(&block.element, springs, points, &block.connectivity, energy, material.state(), &fit, progress)
            .map_err(of_shapes)
    })
}

/// Checks that every law of force belongs to a group of the springs.
fn check_groups(recipe: &SampledRecipe, task: &Task) -> Result<()> {
    let mut known = Vec::new();
    for block in &task.mesh.blocks {
        known.extend(block.element.select_groups(task.springs)?.iter().map(|group| group.name.as_str()));
    }
    recipe.force.check_groups(&known)
}

/// The law of a fit with the materials of the body.
///
/// # Errors
/// There is no such law; a cell is anisotropic, or the materials are too many.
fn laws(law: &str, material: &MaterialMap) -> Result<EnergyMap> {
    let materials = material.materials()?;
    let mut known: Vec<Material> = Vec::new();
    for material in materials.values() {
        if !known.contains(material) {
            known.push(*material);
        }
        if known.len() > MATERIALS {
            let expected = format!("at most {MATERIALS} materials for the law of a sampled fit");
            return Err(Error::expected("law", expected, "more").of_kind(ErrorKind::Unsupported));
        }
    }
    let index = materials.map(|material| known.iter().position(|other| other == material).unwrap_or(0));
    let load = |material: &Material| Ok((Energy::load(law, *material)?, material.state()));
    let energies = known.iter().map(load).collect::<Result<Vec<(Energy, State)>>>()?;
    EnergyMap::new(energies, index).ok_or_else(|| Error::expected("law", "a body with cells", "none"))
}

/// The fits of all cells of a block from those of the cells of each law.
fn joined(mut regions: Vec<(Vec<usize>, SampledFits)>) -> SampledFits {
    let (cells, mut all) = regions.remove(0);
    if regions.is_empty() {
        return all;
    }
    let count = cells.len() + regions.iter().map(|(cells, _)| cells.len()).sum::<usize>();
    all.spread(&cells, count);
    regions.into_iter().for_each(|(cells, found)| all.join(&cells, found));
    all
}
