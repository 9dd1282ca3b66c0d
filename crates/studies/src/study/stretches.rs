//! Springs at large deformation: their error as a function of the stretch, and that of a sampled fit as a function of
//! the number of shapes and the run time.

use super::body::LargeBody;
use super::fits::{ExactRecipe, ForceRecipe, NamedFit, Recipe, Reference, SampledRecipe};
use super::fitting::fit_without_errors;
use super::progress::{Event, Progress};
use crate::analysis::metrics::displacement_error;
use crate::element::{Element, SpringGroup};
use crate::error::{Error, Result};
use crate::fit::{Balance, DeformationFamily, Fit, Higher, Objective, Sampling, Source, Weight, fit_sampled};
use crate::material::{Energy, Material};
use crate::mesh::{BoxMesh, Mesh, Selection};
use crate::model::{Body, Elastic, Response, Support, displaced};
use crate::solve::{Ending, Newton};
use crate::springs::{Law, Springs};
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// The stretches of the box, from the range of the linear theory to twice its length.
pub const STRETCHES: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0];
/// The numbers of shapes of the sampled fits.
pub const SHAPES: [usize; 5] = [10, 100, 1000, 10_000, 100_000];
/// The largest number of multiplications of one fit, about a minute.
const LONGEST: f64 = 1e11;
/// The largest stretch of one load step.
const STEP: f64 = 0.1;
/// A cubic law with a tension at rest. If no parameter is negative, its slope is not negative at strains up to a half.
const CUBIC: &str = "k1*(0.125 - (0.5 - s)^3) + k2*(0.75*s - s^3) + k3*((0.5 + s)^3 - 0.125) + p*(s + 1/2) + q*(s - 1)";

/// One way to find the springs, and its errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StretchedFit {
    /// The name of the fit.
    pub name: String,
    /// The time per element, on all threads, s.
    pub seconds: f64,
    /// The error e_rms in percent at each of [`STRETCHES`]; `None` if one of the models has no equilibrium.
    pub errors: Vec<Option<f64>>,
    /// By how many percent the force that holds the network at each stretch exceeds that of the body.
    pub excess: Vec<Option<f64>>,
}

/// A sampled fit with a number of shapes, of one element on one thread.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampledRun {
    /// The name of the fit.
    pub name: String,
    /// The number of shapes.
    pub shapes: usize,
    /// The time, s.
    pub seconds: f64,
    /// The relative error `‖f − K‖/‖f‖` on the shapes of the fit.
    pub trained: f64,
    /// The relative error on other shapes.
    pub held_out: f64,
}

/// Both studies of one element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretches {
    /// The name of the element.
    pub element: String,
    /// The title of the law.
    pub law: String,
    /// The fits, with their errors as functions of the stretch.
    pub fits: Vec<StretchedFit>,
    /// The sampled fits, with their errors as functions of the number of shapes.
    pub runs: Vec<SampledRun>,
}

/// Pulls a unit box of the element, held at both ends, and fits its springs in every way. Sampled shapes reach from a
/// tenth of compression to the stretch `sampled`.
///
/// # Errors
/// The law is unknown or its file is wrong, the element does not fill a box, or `sampled` is out of range.
pub fn compare_stretches(
    element: &Arc<Element>,
    material: Material,
    law: &str,
    sampled: f64,
    progress: &mut Progress,
) -> Result<Stretches> {
    if !(sampled > 0.0 && sampled <= 2.0) {
        return Err(Error::expected("stretch", "a stretch above 0 and at most 2", sampled));
    }
    let energy = Energy::load(law, material).map_err(|e| e.placed(|e| Error::at("law", e.problem())))?;
    let d = element.dimension();
    let cells = vec![if d == 3 { 3 } else { 6 }; d];
    let mesh = BoxMesh { element: element.clone(), size: vec![1.0; d], cells, origin: vec![0.0; d] }.build()?;
    let pulled = Pulled { mesh, material, large: LargeBody::at_rest((energy, material.state())) };
    let exact = Some(ExactRecipe::default());
    let exact = exact.filter(|exact| exact.serves(Some(&pulled.large.laws), &pulled.mesh, &material.into()));
    let exact = exact.map(|exact| NamedFit::of(Recipe::Exact(exact), None));
    let recipes: Vec<NamedFit> = exact.into_iter().chain(recipes(element, sampled)).collect();
    let total = recipes.len() + 1;
    progress(Event::stage("finite elements", 0, total));
    let body = pulled.follow(&Body { mesh: &pulled.mesh, laws: &pulled.large.laws })?;
    let mut fits = Vec::new();
    for (done, named) in recipes.iter().enumerate() {
        progress(Event::stage(&named.name, done + 1, total));
        let reference = Reference { large: Some(&pulled.large), ..Reference::default() };
        let (fitted, _) = fit_without_errors(&pulled.mesh, &material.into(), &reference, named, &mut |_| {})?;
        let seconds = fitted.seconds / pulled.mesh.cell_count() as f64;
        let found = pulled.follow(&fitted.network)?;
        let both = || body.iter().zip(&found).map(|(fem, lem)| Some((fem.as_ref()?, lem.as_ref()?)));
        let error = |pair: Option<(&Held, &Held)>| {
            pair.and_then(|(fem, lem)| displacement_error(&fem.displacement, &lem.displacement, d)).map(|e| e.rms)
        };
        let excess = |pair: Option<(&Held, &Held)>| pair.map(|(fem, lem)| 100.0 * (lem.force / fem.force - 1.0));
        let (errors, excess) = (both().map(error).collect(), both().map(excess).collect());
        fits.push(StretchedFit { name: named.name.clone(), seconds, errors, excess });
    }
    let mut runs = Vec::new();
    for named in &recipes {
        let Some(recipe) = named.recipe.sampled() else { continue };
        for shapes in SHAPES {
            let unknowns = recipe.force.unknowns(element);
            if (shapes * element.positions.len() * unknowns * unknowns) as f64 > LONGEST {
                continue;
            }
            progress(Event::stage(&format!("{} at {shapes} shapes", named.name), total - 1, total));
            runs.push(pulled.sample(&named.name, recipe, named.springs.as_deref(), shapes)?);
        }
    }
    Ok(Stretches { element: element.name.clone(), law: pulled.large.laws.first().title().to_string(), fits, runs })
}

/// An equilibrium of the box.
struct Held {
    /// The displacements, `[points · dimension]`, m.
    displacement: Vec<f64>,
    /// The force on the pulled end along the box, N.
    force: f64,
}

/// The ways that are compared, all with every spring group of the element.
fn recipes(element: &Element, sampled: f64) -> Vec<NamedFit> {
    let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    let modal = Weight::Modal(Higher::DEFAULT);
    let mut objectives: Vec<Objective> = [Weight::None, Weight::OffDiagonal].map(Objective::Frobenius).into();
    objectives.extend(element.has_higher_modes().then_some(Objective::Frobenius(modal)));
    objectives.push(Objective::Divergence(Balance::DEFAULT));
    let at_rest = |objective: Objective| {
        let fit = Fit { nonnegative: true, ..Fit::new(objective) };
        let name = format!("{} k>=0", objective.title());
        NamedFit::named(name, Recipe::Stiffness(fit), Some(every.clone()))
    };
    objectives.into_iter().map(at_rest).chain(sampled_fits(element, Some(&every), sampled)).collect()
}

/// Sampled fits with the usual force laws, with the named groups or all that are not optional.
pub fn sampled_fits(element: &Element, groups: Option<&[String]>, stretch: f64) -> Vec<NamedFit> {
    let used = element.select_groups(groups).expect("the groups are those of the element");
    let law = |text: &str| Law::parse(text).expect("a law of this study");
    // If there is a content spring: exact for a neo-Hookean simplex.
    let by_group = |group: &&SpringGroup| {
        let text = if group.is_content() { "a/(1 + s) + b*ln(1 + s)/(1 + s)" } else { "k*c" };
        (group.name.clone(), law(text))
    };
    let mut forces = vec![
        ("sampled linear k>=0", ForceRecipe::Linear, true),
        ("sampled free rest", ForceRecipe::FreeRest, true),
        ("sampled cubic", ForceRecipe::Law(law(CUBIC)), true),
    ];
    if used.iter().any(|group| group.is_content()) {
        forces.push(("sampled k c, volume", ForceRecipe::Groups(used.iter().map(by_group).collect()), false));
    }
    let recipe = |(name, force, nonnegative): (&str, ForceRecipe, bool)| {
        let mut recipe = SampledRecipe { force, ..SampledRecipe::default() };
        let source = Source::Families(vec![DeformationFamily::Uniaxial, DeformationFamily::SimpleShear]);
        recipe.fit.sampling = Sampling { source, stretch: [-0.1, stretch], ..recipe.fit.sampling };
        recipe.fit.nonnegative = nonnegative;
        if element.has_higher_modes() {
            recipe.fit.higher = Higher::DEFAULT.value();
        }
        NamedFit::named(name, Recipe::Sampled(Box::new(recipe)), groups.map(<[String]>::to_vec))
    };
    forces.into_iter().map(recipe).collect()
}

/// The box and its material.
struct Pulled {
    mesh: Mesh,
    material: Material,
    large: LargeBody,
}

impl Pulled {
    /// The equilibrium at each of [`STRETCHES`]; `None` if there is none.
    fn follow(&self, model: &dyn Elastic) -> Result<Vec<Option<Held>>> {
        let d = self.mesh.dimension;
        let name = ["x", "y", "z"][d - 1];
        let end = |end: &str| Selection::Group(format!("{name}{end}")).points(&self.mesh);
        let (held, pulled) = (end("min")?, end("max")?);
        let all: Vec<usize> = (0..d).collect();
        let one = |stretch: &f64| {
            let mut support = Support::free(&self.mesh);
            support.fix(&held, &all, d);
            support.fix(&pulled, &all, d);
            pulled.iter().for_each(|p| support.prescribed[p * d + d - 1] = Some(*stretch));
            let newton = Newton { steps: (stretch / STEP).ceil() as usize, ..Newton::default() };
            let found = newton.solve(model, &self.mesh.points, &support, &vec![0.0; self.mesh.points.len()])?;
            if found.ending == Ending::Stalled {
                return Ok(None);
            }
            let place = displaced(&self.mesh.points, &found.displacement);
            let total = |r: Response| pulled.iter().map(|p| r.force[p * d + d - 1]).sum();
            Ok(model.respond(&place).map(|r| Held { displacement: found.displacement, force: total(r) }))
        };
        STRETCHES.iter().map(one).collect()
    }

    /// The sampled fits of the first cell alone.
    fn sample(
        &self,
        name: &str,
        recipe: &SampledRecipe,
        groups: Option<&[String]>,
        shapes: usize,
    ) -> Result<SampledRun> {
        let block = &self.mesh.blocks[0];
        let springs = Springs::select(&block.element, groups)?;
        let mut fit = recipe.resolve(&block.element, &springs, &Arc::default())?;
        (fit.sampling.shapes, fit.sampling.held_out) = (shapes, 0);
        let nodes = &block.connectivity[..block.element.nodes()];
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let one = one.map_err(|e| Error::new(format!("no thread can be started: {e}")))?;
        let run = |fit: &_| {
            let state = self.material.state();
            one.install(|| {
                fit_sampled(
                    &block.element,
                    &springs,
                    &self.mesh.points,
                    nodes,
                    self.large.laws.first(),
                    state,
                    fit,
                    &mut |_| {},
                )
            })
        };
        let start = Instant::now();
        run(&fit)?;
        let seconds = start.elapsed().as_secs_f64();
        fit.sampling.held_out = 1000;
        let found = run(&fit)?;
        let (trained, held_out) = (found.trained[0], found.held_out[0]);
        Ok(SampledRun { name: name.into(), shapes, seconds, trained, held_out })
    }
}
