//! Error against run time: objectives and solvers side by side, on random shapes of an element or on a scene.

use super::body::applied_cases;
use super::checkpoint::Controls;
use super::fits::{ExactRecipe, NamedFit, Recipe, WholeBody};
use super::outcome::Outcome;
use super::progress::{Event, Progress};
use super::run::run_with;
use super::scene::{Output, Scene};
use super::stretches::sampled_fits;
use crate::analysis::moduli::{EffectiveModuli, Lattice};
use crate::analysis::shapes::random_shapes;
use crate::bound::{self, check_count};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::published::{self, Method};
use crate::fit::{Fit, MotionWeight, Objective, Search, ShearSprings, Solver, Spread, VolumeSprings, element_errors};
use crate::material::{EnergyMap, Material, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::springs::Springs;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// The number of times a fit is timed, unless one run takes longer than `PATIENCE`.
const RUNS: usize = 5;
/// The time in s after which a fit is not repeated.
const PATIENCE: f64 = 0.5;
/// The seed of the shapes, so that every run compares the same ones.
const SEED: u64 = 2010;
/// The largest stretch of the shapes that are sampled for a scene.
const SAMPLED: f64 = 0.35;

/// The result of one method on the random shapes of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodOutcome {
    /// The name of the fit.
    pub name: String,
    /// The name of the solver, or `formula`.
    pub solver: &'static str,
    /// The least, median and largest time per element over the runs, in s.
    pub seconds: [f64; 3],
    /// The number of runs.
    pub runs: usize,
    /// The relative errors of R in the Frobenius norm.
    pub frobenius: Spread,
    /// The relative errors of R in the induced 2-norm.
    pub spectral: Spread,
    /// The largest relative duality gap, if the method has certificates.
    pub gap: Option<f64>,
    /// The share of negative constants.
    pub negative: f64,
    /// The moduli of the springs on a periodic box of unit size; not for general solvers, nor for cells that do not
    /// fill a box.
    pub moduli: Option<EffectiveModuli>,
}

/// Fits exactly `shapes` random shapes of the element with every objective, the spectral one with every solver, and by
/// the published formulas that it has; on one thread.
///
/// # Errors
/// `shapes` is 0 or exceeds its bound, or no valid shape is found.
pub fn compare_element(
    element: &Element,
    material: Material,
    shapes: usize,
    iterations: u64,
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    let mut recipes = vec![Recipe::Exact(ExactRecipe::default())];
    recipes.extend(Objective::all(element.has_higher_modes()).into_iter().map(|o| Recipe::Stiffness(Fit::new(o))));
    for method in [Search::NelderMead, Search::ParticleSwarm, Search::SimulatedAnnealing] {
        let solver = Solver::General { method, iterations, topology: None };
        recipes.push(Recipe::Stiffness(Fit { solver, ..Fit::new(Objective::Spectral(MotionWeight::None)) }));
    }
    let cell: Vec<usize> = (0..element.nodes()).collect();
    let published = Method::ALL.into_iter().filter(|m| serves(*m, element, &element.positions, &cell, material));
    recipes.extend(published.map(Recipe::Published));
    measure_recipes(element, material, shapes, &recipes, progress)
}

/// Whether a published method has a formula for the first of `cells` and the material.
fn serves(method: Method, element: &Element, points: &[f64], cells: &[usize], material: Material) -> bool {
    let first = &cells[..element.nodes()];
    let fit = |springs| published::fit(method, element, &springs, points, first, material);
    Springs::select(element, None).and_then(fit).is_ok()
}

/// Fits `shapes` random shapes of the element by each recipe, on one thread.
///
/// # Errors
/// Those of [`compare_element`]; or a recipe does not fit single elements, or a published method has no formula for
/// this one.
pub fn measure_recipes(
    element: &Element,
    material: Material,
    shapes: usize,
    recipes: &[Recipe],
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    check_count("shapes", shapes as u64, 1, bound::RANDOM_SHAPES)?;
    let springs = Springs::select(element, None)?;
    let points = random_shapes(element, shapes, SEED)?;
    let cells: Vec<usize> = (0..shapes * element.nodes()).collect();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.map_err(|e| Error::new(format!("no thread can be started: {e}")))?;
    let shared = Arc::new(element.clone());
    let size = vec![1.0; element.dimension()];
    let moduli = material.moduli();
    let mut outcomes = Vec::new();
    for (done, recipe) in recipes.iter().enumerate() {
        let other = || Error::expected("recipe", "a fit of single elements", recipe.name(None));
        let method = recipe.kind().cell_method().ok_or_else(other)?;
        let (name, solver) = (method.name(), method.solver());
        progress(Event::stage(&format!("{name} by {solver}"), done, recipes.len()));
        let fit = |points: &[f64], cells: &[usize]| method.fit_cells(element, &springs, points, cells, material);
        let mut seconds = Vec::new();
        let fitted = loop {
            let start = Instant::now();
            let fitted = one.install(|| fit(&points, &cells))?;
            seconds.push(start.elapsed().as_secs_f64() / shapes as f64);
            if seconds.len() == RUNS || seconds[0] * shapes as f64 > PATIENCE {
                break fitted;
            }
        };
        seconds.sort_by(f64::total_cmp);
        let errors = element_errors(element, &points, &cells, moduli, &fitted)?;
        let negative = fitted.constants.iter().filter(|k| **k < 0.0).count();
        let general = recipe.stiffness().is_some_and(|fit| fit.solver != Solver::Native);
        let lattice = || Some(Lattice::of(&shared, &size, fit).ok()?.of_springs()?.of_solid(material.state()));
        outcomes.push(MethodOutcome {
            name,
            solver,
            runs: seconds.len(),
            seconds: [seconds[0], seconds[seconds.len() / 2], seconds[seconds.len() - 1]],
            frobenius: Spread::of(&errors.frobenius),
            spectral: Spread::of(&errors.spectral),
            gap: fitted.certificates.iter().map(|c| c.gap()).reduce(f64::max),
            negative: negative as f64 / fitted.constants.len().max(1) as f64,
            moduli: if general { None } else { lattice() },
        });
    }
    Ok(outcomes)
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
/// Those of [`run`](super::run()); or the scene has no loads.
pub fn compare_scene(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    let controls = Controls { announce: true, ..Controls::default() };
    run_with(&compared(scene)?, &controls, progress)
}

/// The scene with every objective in place of its own fits.
///
/// # Errors
/// Those of the mesh, the supports and the loads, and a scene without loads.
pub fn compared(scene: &Scene) -> Result<Scene> {
    if scene.loads().is_empty() {
        let problem = "expected at least one [[load]] to compare under, found none";
        return Err(scene.placed(Error::at("load", problem)));
    }
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
    let whole = scene.law().is_none() && held;
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
            let published = Method::ALL.into_iter().filter(serves_all);
            fits.extend(published.map(|method| NamedFit::of(Recipe::Published(method), None)));
        }
        if scene.law().is_some() {
            fits.extend(sampled_fits(&mesh.blocks[0].element, groups.as_deref(), SAMPLED));
        }
        for mut named in fits {
            if let Some(groups) = &groups {
                named.name += " + all";
                named.springs = Some(groups.clone());
            }
            all_fits.push(named);
        }
    }
    let output = Output { frequencies: 0, ..scene.output().clone() };
    Ok(scene.clone().with_fits(all_fits).with_output(output).without_motion())
}
