//! What is compared where no fit is listed: all objectives, by all solvers, and the published formulas that there are.

use super::plan::STRETCH;
use crate::element::Element;
use crate::error::{ErrorKind, Result};
use crate::fit::published::{self, Method};
use crate::fit::{Fit, MotionWeight, Objective, Search, ShearSprings, Solver, VolumeSprings};
use crate::material::{EnergyMap, Material, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::Springs;
use crate::study::run::run_with;
use crate::study::stretches::sampled_fits;
use springfit_scenes::{Controls, ExactRecipe, NamedFit, Outcome, Progress, Recipe, Scene, WholeBody, applied_cases};

/// Every objective on single elements, the spectral one by every solver, and the published formulas that the element has.
pub fn usual_fits(element: &Element, material: Material, iterations: u64) -> Vec<NamedFit> {
    let mut recipes = vec![Recipe::Exact(ExactRecipe::default())];
    recipes.extend(Objective::all(element.has_higher_modes()).into_iter().map(|o| Recipe::Stiffness(Fit::new(o))));
    for method in [Search::NelderMead, Search::ParticleSwarm, Search::SimulatedAnnealing] {
        let solver = Solver::General { method, iterations, topology: None };
        recipes.push(Recipe::Stiffness(Fit { solver, ..Fit::new(Objective::Spectral(MotionWeight::None)) }));
    }
    let cell: Vec<usize> = (0..element.nodes()).collect();
    let published = Method::all().filter(|m| serves(*m, element, &element.positions, &cell, material));
    recipes.extend(published.map(Recipe::Published));
    recipes.into_iter().map(|recipe| NamedFit::of(recipe, None)).collect()
}

/// Whether a published method has a formula for the first of `cells` and the material.
fn serves(method: Method, element: &Element, points: &[f64], cells: &[usize], material: Material) -> bool {
    let first = &cells[..element.nodes()];
    let fit = |springs| published::fit(method, element, &springs, points, first, material);
    Springs::select(element, None).and_then(fit).is_ok()
}

/// The exact networks that the body can have: with volume springs at points, on cells, and on patches if these exist,
/// and the same with shear springs on the domains of edges.
fn exact_fits(law: Option<&EnergyMap>, mesh: &Mesh, material: &MaterialMap) -> Vec<NamedFit> {
    let recipe = |shear| move |volume| ExactRecipe { shear, volume, ..ExactRecipe::default() };
    let recipes = ShearSprings::all().flat_map(|shear| VolumeSprings::all().map(recipe(shear)));
    let recipes = recipes.filter(|recipe| recipe.serves(law, mesh, material));
    recipes.map(|recipe| NamedFit::of(Recipe::Exact(recipe), None)).collect()
}

/// Runs the scene with every objective in place of its own fits, and with the content spring if the elements have one.
///
/// # Errors
/// Those of [`run`](crate::study::run()); or the scene has no loads.
pub fn compare_scene(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    let controls = Controls { announce: true, ..Controls::default() };
    run_with(&compared(scene)?, &controls, progress)
}

/// The scene with every objective in place of its own fits.
///
/// # Errors
/// Those of the mesh, the supports and the loads, and a scene without loads.
pub fn compared(scene: &Scene) -> Result<Scene> {
    let of_loads = scene.clone().of_loads()?;
    let mesh = scene.build_mesh()?;
    let higher_modes = mesh.blocks.iter().any(|block| block.element.has_higher_modes());
    let every: Vec<String> = mesh.blocks[0].element.springs.iter().map(|group| group.name.clone()).collect();
    let optional = mesh.blocks.len() == 1 && mesh.blocks[0].element.springs.iter().any(|group| group.optional);
    // Made loads require supports that hold the body without those of the scene. At large deformation each step of a fit to them finds an
    // equilibrium for each load, which takes minutes where the other fits of a comparison take seconds.
    let material = &scene.material_of(&mesh)?;
    let support = applied_cases(scene, &mesh, material).map_err(|e| scene.with_line(e))?.0;
    let controls = Controls::default();
    let body = WholeBody::new(&mesh, material, &support, &controls);
    let held = match body.equations("loads", &support) {
        Err(error) if error.kind() == ErrorKind::Limit => return Err(error.in_file(scene.path())),
        held => held.is_ok(),
    };
    // A fit to the whole object does not know the directors of a sheet.
    let is_sheet = mesh.directors.is_some();
    let whole = scene.law().is_none() && held && !is_sheet;
    let law = scene.laws(&mesh, material)?;
    let mut all_fits = Vec::new();
    let all = optional.then_some(Some(every));
    let serves_all = |method: &Method| {
        let block = |(index, b): (usize, &CellBlock)| {
            let Ok(materials) = material.materials() else { return false };
            let own = materials.block(index);
            let serves = |m: &Material| serves(*method, &b.element, &mesh.points, &b.connectivity, *m);
            // One constant for the whole body is that of one material.
            let one = material.uniform().is_some() || *method != Method::MacielUniform;
            one && own.values().first().is_some_and(serves)
        };
        mesh.blocks.iter().enumerate().all(block)
    };
    for groups in std::iter::once(None).chain(all) {
        let at_rest =
            Objective::all(higher_modes).into_iter().map(|objective| NamedFit::new(Fit::new(objective), None));
        let of_whole = whole.then(|| NamedFit::of(Recipe::Whole(Box::default()), None));
        let mut fits: Vec<NamedFit> = at_rest.chain(of_whole).collect();
        if groups.is_none() {
            fits.splice(0..0, exact_fits(law.as_ref(), &mesh, material));
            let published = Method::all().filter(serves_all);
            fits.extend(published.map(|method| NamedFit::of(Recipe::Published(method), None)));
        }
        if scene.law().is_some() {
            fits.extend(sampled_fits(&mesh.blocks[0].element, groups.as_deref(), STRETCH));
        }
        for mut named in fits {
            if let Some(groups) = &groups {
                named.name += " + all";
                named.springs = Some(groups.clone());
            }
            all_fits.push(named);
        }
    }
    Ok(of_loads.with_fits(all_fits))
}
