//! Springs at large deformation: their error against the stretch, and that of a sampled fit against its shapes and run time.

use super::metrics::displacement_error;
use super::run::Progress;
use super::scene::{ForceRecipe, NamedFit, Recipe, SampledRecipe};
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::{Family, Fit, Objective, Sampling, Source, Weight, fit_cells, fit_sampled};
use crate::material::{Energy, Material};
use crate::mesh::{BoxMesh, Mesh, Selection};
use crate::model::{Body, Elastic, Network, Support};
use crate::solve::{Ending, Newton};
use crate::springs::{Law, Springs};
use std::sync::Arc;
use std::time::Instant;

/// Stretches of the box, from those of the linear theory to twice its length.
pub const STRETCHES: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0];
/// Shapes of the sampled fits.
pub const SHAPES: [usize; 7] = [10, 30, 100, 300, 1000, 3000, 10_000];
/// A load step stretches by at most so much.
const STEP: f64 = 0.1;
/// A cubic whose slope is not below zero at strains up to a half, and a pull at rest, where no parameter is below zero.
const CUBIC: &str = "k1*(0.125 - (0.5 - s)^3) + k2*(0.75*s - s^3) + k3*((0.5 + s)^3 - 0.125) + p*(s + 1/2) + q*(s - 1)";

/// One way to find the springs.
#[derive(Debug, Clone, PartialEq)]
pub struct StretchedFit {
    pub name: String,
    /// Per element, on all threads.
    pub seconds: f64,
    /// %e_rms at each of [`STRETCHES`]; `None` where one of the models has no equilibrium.
    pub errors: Vec<Option<f64>>,
}

/// A sampled fit with some number of shapes, of one element on one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRun {
    pub name: String,
    pub shapes: usize,
    pub seconds: f64,
    /// `‖f − K‖/‖f‖` on the shapes of the fit and on others.
    pub trained: f64,
    pub held_out: f64,
}

/// Both studies of one element.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretches {
    pub element: String,
    pub law: String,
    pub fits: Vec<StretchedFit>,
    pub runs: Vec<SampledRun>,
}

/// Pulls a unit box of the element, held at both ends, and fits its springs in every way; sampled shapes reach from a tenth of
/// compression to the stretch `sampled`.
///
/// # Errors
/// The law is unknown or its file wrong, the element fills no box, or `sampled` is out of range.
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
    let pulled = Pulled { mesh, material, energy };
    let recipes = recipes(element, sampled);
    let total = recipes.len() + 1;
    progress("finite elements", 0, total);
    let body = pulled.follow(&Body { mesh: &pulled.mesh, energy: &pulled.energy, state: material.state() })?;
    let mut fits = Vec::new();
    for (done, named) in recipes.iter().enumerate() {
        progress(&named.name, done + 1, total);
        let (network, seconds) = pulled.fit(named)?;
        let found = pulled.follow(&network)?;
        let error = |(fem, lem): (&Option<Vec<f64>>, &Option<Vec<f64>>)| {
            displacement_error(fem.as_ref()?, lem.as_ref()?, d).map(|error| error.rms)
        };
        fits.push(StretchedFit {
            name: named.name.clone(),
            seconds,
            errors: body.iter().zip(&found).map(error).collect(),
        });
    }
    let mut runs = Vec::new();
    for named in &recipes {
        let Recipe::Forces(recipe) = &named.recipe else { continue };
        for shapes in SHAPES {
            progress(&format!("{} at {shapes} shapes", named.name), total - 1, total);
            runs.push(pulled.sample(&named.name, recipe, named.springs.as_deref(), shapes)?);
        }
    }
    Ok(Stretches { element: element.name.clone(), law: pulled.energy.title.clone(), fits, runs })
}

/// The ways that are compared, all with every spring group of the element.
fn recipes(element: &Element, sampled: f64) -> Vec<NamedFit> {
    let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    let named = |name: &str, recipe: Recipe| NamedFit { name: name.into(), recipe, springs: Some(every.clone()) };
    let at_rest = |objective: Objective| {
        let fit = Fit { nonnegative: true, ..Fit::new(objective) };
        named(&format!("{} k>=0", objective.title()), Recipe::Stiffness(fit))
    };
    let mut all = vec![
        at_rest(Objective::Frobenius(Weight::None)),
        at_rest(Objective::Frobenius(Weight::OffDiagonal)),
        at_rest(Objective::Divergence { balance: Objective::DEFAULT_BALANCE }),
    ];
    if element.has_higher_modes() {
        all.push(at_rest(Objective::Frobenius(Weight::Modal { higher: Objective::DEFAULT_HIGHER })));
    }
    let content = element.springs.iter().find(|group| group.is_content()).map(|group| group.name.clone());
    let by_group = |group: &String| {
        let text = if Some(group) == content.as_ref() { "a/(1 + s) + b*ln(1 + s)/(1 + s)" } else { "k*c" };
        (group.clone(), Law::parse(text).expect("a law of this study"))
    };
    let forces = [
        ("sampled linear k>=0", ForceRecipe::Linear, true),
        ("sampled free rest", ForceRecipe::FreeRest, true),
        ("sampled cubic", ForceRecipe::Law(Law::parse(CUBIC).expect("a law of this study")), true),
        ("sampled k c, volume", ForceRecipe::Groups(every.iter().map(by_group).collect()), false),
    ];
    for (name, force, nonnegative) in forces {
        if content.is_none() && matches!(force, ForceRecipe::Groups(_)) {
            continue;
        }
        let mut recipe = SampledRecipe { force, ..SampledRecipe::default() };
        let source = Source::Families(vec![Family::Uniaxial, Family::SimpleShear]);
        recipe.fit.sampling = Sampling { source, stretch: [-0.1, sampled], ..recipe.fit.sampling };
        recipe.fit.nonnegative = nonnegative;
        if element.has_higher_modes() {
            recipe.fit.higher = Objective::DEFAULT_HIGHER;
        }
        all.push(named(name, Recipe::Forces(Box::new(recipe))));
    }
    all
}

/// The box and what it is made of.
struct Pulled {
    mesh: Mesh,
    material: Material,
    energy: Energy,
}

impl Pulled {
    /// The displacements at each of [`STRETCHES`], `None` where there is no equilibrium.
    fn follow(&self, model: &dyn Elastic) -> Result<Vec<Option<Vec<f64>>>> {
        let d = self.mesh.dimension;
        let name = ["x", "y", "z"][d - 1];
        let [held, pulled] =
            ["min", "max"].map(|end| Selection::Group(format!("{name}{end}")).points(&self.mesh)).map(|points| points);
        let (held, pulled) = (held?, pulled?);
        let all: Vec<usize> = (0..d).collect();
        let one = |stretch: &f64| {
            let mut support = Support::free(&self.mesh);
            support.fix(&held, &all, d);
            support.fix(&pulled, &all, d);
            pulled.iter().for_each(|p| support.prescribed[p * d + d - 1] = Some(*stretch));
            let newton = Newton { steps: (stretch / STEP).ceil() as usize, ..Newton::default() };
            let found = newton.solve(model, &self.mesh.points, &support, &vec![0.0; self.mesh.points.len()])?;
            Ok(Some(found.displacement).filter(|_| found.ending == Ending::Converged))
        };
        STRETCHES.iter().map(one).collect()
    }

    /// The network, and the seconds per element.
    fn fit(&self, named: &NamedFit) -> Result<(Network, f64)> {
        let block = &self.mesh.blocks[0];
        let springs = Springs::select(&block.element, named.springs.as_deref())?;
        let (points, cells) = (&self.mesh.points, &block.connectivity);
        let start = Instant::now();
        let fits = match &named.recipe {
            Recipe::Stiffness(fit) => {
                fit_cells(&block.element, &springs, points, cells, self.material.moduli(), fit, &mut |_| {})?
            }
            Recipe::Forces(recipe) => {
                let fit = recipe.resolve(&block.element, &springs, &Arc::default())?;
                let state = self.material.state();
                fit_sampled(&block.element, &springs, points, cells, &self.energy, state, &fit, &mut |_| {})?.fits
            }
        };
        let seconds = start.elapsed().as_secs_f64() / block.cells().len() as f64;
        Ok((Network::assemble(&self.mesh, &[fits]), seconds))
    }

    /// The first cell alone.
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
                fit_sampled(&block.element, &springs, &self.mesh.points, nodes, &self.energy, state, fit, &mut |_| {})
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
