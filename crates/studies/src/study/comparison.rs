//! Error against run time: objectives and solvers side by side, on random shapes of an element or on a scene.

use super::cases::load_cases;
use super::checkpoint::Controls;
use super::moduli::{EffectiveModuli, Lattice};
use super::outcome::Outcome;
use super::random::Random;
use super::run::{Progress, run};
use super::scene::{NamedFit, Recipe, Scene};
use super::stretches::sampled_fits;
use super::whole::WholeBody;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::published::{self, Method};
use crate::fit::{CellFits, Fit, Objective, Search, Solver, Spread, Weight, element_errors, fit_cells};
use crate::material::Material;
use crate::mesh::CellBlock;
use crate::springs::Springs;
use crate::stiffness::Geometry;
use std::sync::Arc;
use std::time::Instant;

/// How often a fit is timed, unless once takes longer than `PATIENCE` seconds.
const RUNS: usize = 5;
const PATIENCE: f64 = 0.5;
/// How far the nodes of a random shape are moved, in units of the reference cell.
const JITTER: f64 = 0.15;
const SEED: u64 = 2010;
/// The largest stretch of the shapes that are sampled for a scene.
const SAMPLED: f64 = 0.35;

/// One method on the random shapes of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodOutcome {
    pub name: String,
    pub solver: &'static str,
    /// Seconds per element over the runs: least, median, largest.
    pub seconds: [f64; 3],
    pub frobenius: Spread,
    pub spectral: Spread,
    /// The largest relative duality gap, where there is one.
    pub gap: Option<f64>,
    /// Constants below zero, as a share of all.
    pub negative: f64,
    /// Of the springs on a periodic box of unit size; not of general solvers, nor of cells that fill no box.
    pub moduli: Option<EffectiveModuli>,
}

/// Fits `shapes` random shapes of the element with every objective, the spectral one with every solver, and by the published
/// formulas that it has; on one thread.
///
/// # Errors
/// `shapes` is 0 or so large that the shapes do not fit, or no valid shape is found.
pub fn compare_element(
    element: &Element,
    material: Material,
    shapes: usize,
    iterations: u64,
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    let mut recipes: Vec<Recipe> =
        Objective::all(element.has_higher_modes()).into_iter().map(|o| Recipe::Stiffness(Fit::new(o))).collect();
    for method in [Search::NelderMead, Search::ParticleSwarm, Search::SimulatedAnnealing] {
        let solver = Solver::General { method, iterations, topology: None };
        recipes.push(Recipe::Stiffness(Fit { solver, ..Fit::new(Objective::Spectral(Weight::None)) }));
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

/// The constants of each cell by a recipe that looks at one cell at a time; `None` for any other.
pub fn fit_each_cell(
    recipe: &Recipe,
    element: &Element,
    springs: &Springs,
    points: &[f64],
    cells: &[usize],
    material: Material,
) -> Option<Result<CellFits>> {
    match recipe {
        Recipe::Published(method) => Some(published::fit(*method, element, springs, points, cells, material)),
        Recipe::Stiffness(fit) => Some(fit_cells(element, springs, points, cells, material.moduli(), fit, &mut |_| {})),
        _ => None,
    }
}

/// Fits `shapes` random shapes of the element by each recipe, on one thread.
///
/// # Errors
/// Those of [`compare_element`]; a recipe is no fit of single elements, or a published method has no formula for this one.
pub fn measure_recipes(
    element: &Element,
    material: Material,
    shapes: usize,
    recipes: &[Recipe],
    progress: &mut Progress,
) -> Result<Vec<MethodOutcome>> {
    if !(1..=1_000_000).contains(&shapes) {
        return Err(Error::expected("shapes", "a number from 1 to 1000000", shapes));
    }
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
        let (name, solver) = match recipe {
            Recipe::Stiffness(fit) => (fit.objective.title(), fit.solver.name()),
            Recipe::Published(method) => (method.name().into(), "formula"),
            _ => return Err(Error::expected("recipe", "a fit of single elements", recipe.name(None))),
        };
        progress(&format!("{name} by {solver}"), done, recipes.len());
        let fit = |points: &[f64], cells: &[usize]| {
            let of_cells = fit_each_cell(recipe, element, &springs, points, cells, material);
            of_cells.expect("it is a fit of single elements")
        };
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
        let general = matches!(recipe, Recipe::Stiffness(fit) if fit.solver != Solver::Native);
        let lattice = || Lattice::of(&shared, &size, fit).ok()?.of_springs();
        outcomes.push(MethodOutcome {
            name,
            solver,
            seconds: [seconds[0], seconds[seconds.len() / 2], seconds[seconds.len() - 1]],
            frobenius: Spread::of(&errors.frobenius),
            spectral: Spread::of(&errors.spectral),
            gap: fitted.certificates.iter().map(|c| c.gap()).reduce(f64::max),
            negative: negative as f64 / fitted.constants.len().max(1) as f64,
            moduli: if general { None } else { lattice() },
        });
    }
    progress("", recipes.len(), recipes.len());
    Ok(outcomes)
}

/// Runs the scene with every objective in place of its own fits; with the content spring where the elements have one.
///
/// # Errors
/// Those of [`run`], and a scene without loads.
pub fn compare_scene(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    if scene.loads.is_empty() {
        let problem = "expected at least one [[load]] to compare under, found none";
        return Err(Error::at("load", problem).in_file(&scene.path));
    }
    let mesh = scene.build_mesh()?;
    let higher_modes = mesh.blocks.iter().any(|block| block.element.has_higher_modes());
    let every: Vec<String> = mesh.blocks[0].element.springs.iter().map(|group| group.name.clone()).collect();
    let optional = mesh.blocks.len() == 1 && mesh.blocks[0].element.springs.iter().any(|group| group.optional);
    // Loads made from the mesh are linear, and need supports that hold the body without those of the scene.
    let material = scene.material(mesh.cell_dimension())?;
    let support = load_cases(scene, &mesh, material)?.0;
    let controls = Controls::default();
    let body = WholeBody::new(&mesh, material, &support, &controls);
    let whole = scene.law().is_none() && body.held("loads").is_ok();
    let mut scene = scene.clone();
    scene.fits = Vec::new();
    (scene.motion, scene.output.frequencies) = (None, 0);
    let all = optional.then_some(Some(every));
    let serves_all = |method: &Method| {
        let block = |b: &CellBlock| serves(*method, &b.element, &mesh.points, &b.connectivity, material);
        mesh.blocks.iter().all(block)
    };
    for groups in std::iter::once(None).chain(all) {
        let at_rest =
            Objective::all(higher_modes).into_iter().map(|objective| NamedFit::new(Fit::new(objective), None));
        let of_whole = whole.then(|| NamedFit::of(Recipe::Whole(Box::default()), None));
        let mut fits: Vec<NamedFit> = at_rest.chain(of_whole).collect();
        if groups.is_none() {
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
            scene.fits.push(named);
        }
    }
    scene.entry_of = (0..scene.fits.len()).collect();
    run(&scene, progress)
}

/// Node positions of `count` elements, `[count × nodes × dimension]`: the reference cell under random affine maps, each node
/// moved by up to 7 % of its size; those that tangle are drawn again. A seed gives the same shapes always.
///
/// # Errors
/// Nearly every shape tangles.
pub fn random_shapes(element: &Element, count: usize, seed: u64) -> Result<Vec<f64>> {
    let d = element.dimension();
    let mut random = Random::new(seed);
    let mut points = Vec::with_capacity(count * element.positions.len());
    let mut geometry = Geometry::new(&element.tabulation);
    for _ in 0..100 * count {
        let map: Vec<f64> =
            (0..d * d).map(|i| f64::from(u8::from(i % (d + 1) == 0)) + 0.4 * random.symmetric()).collect();
        let mut shape = Vec::new();
        for at in element.positions.chunks_exact(d) {
            for k in 0..d {
                shape.push((0..d).map(|l| map[k * d + l] * at[l]).sum::<f64>() + JITTER * random.symmetric());
            }
        }
        if geometry.set(&element.tabulation, &shape).is_ok() {
            points.extend(shape);
        }
        if points.len() == count * element.positions.len() {
            return Ok(points);
        }
    }
    Err(Error::new(format!("{}: nearly every random shape tangles", element.name)))
}
