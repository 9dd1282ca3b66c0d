//! Springs at large deformation: their error as a function of the stretch, and that of a sampled fit as a function of
//! the number of shapes and the run time.

use crate::analysis::metrics::displacement_error;
use crate::clock::Clock;
use crate::element::{Element, SpringGroup};
use crate::error::{Error, Result};
use crate::fit::{Balance, DeformationFamily, Fit, Higher, Objective, Sampling, Source, Weight, fit_sampled};
use crate::material::{Energy, Material};
use crate::mesh::{BoxMesh, Mesh, Selection};
use crate::model::{Body, Elastic, Response, Support, displaced};
use crate::solve::{Ending, Newton};
use crate::springs::{Law, Springs};
use serde::Serialize;
use springfit_scenes::{
    BODY, Event, ExactRecipe, FitOutcome, ForceRecipe, LargeBody, NamedFit, Progress, Recipe, Reference,
    SampledOutcome, SampledRecipe, Times, fit_without_errors, on_one_thread, time_fits,
};
use std::sync::Arc;

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
    /// The processor time for each element that is fitted, s, in passes that take turns; absent where it was not measured.
    pub times: Option<Times>,
    /// The errors of a fit to sampled forces on its shapes and on others.
    #[serde(skip)]
    pub sampled: Option<SampledOutcome>,
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
    let pulled = Pulled::new(element, material, law)?;
    let recipes = pulled.usual_fits(sampled)?;
    let fits = pulled.compare(&recipes, true, progress)?.into_iter().collect::<Result<_>>()?;
    let sampled = recipes.iter().filter_map(|named| Some((named, named.recipe.sampled()?)));
    let planned = sampled.flat_map(|(named, recipe)| SHAPES.map(|shapes| (named, recipe, shapes)));
    let is_short = |(_, recipe, shapes): &(&NamedFit, &SampledRecipe, usize)| {
        let unknowns = recipe.force.unknowns(element);
        (shapes * element.positions.len() * unknowns * unknowns) as f64 <= LONGEST
    };
    let planned: Vec<_> = planned.filter(is_short).collect();
    let mut runs = Vec::new();
    for (named, recipe, shapes) in &planned {
        progress(Event::stage("numbers of shapes", runs.len(), planned.len()));
        runs.push(pulled.sample(&named.name, recipe, named.springs.as_deref(), *shapes)?);
    }
    Ok(Stretches { element: element.name.clone(), law: pulled.title(), fits, runs })
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

/// A box of an element at large deformation, held at both ends, and its material.
pub struct Pulled {
    mesh: Mesh,
    material: Material,
    large: LargeBody,
}

impl Pulled {
    /// A unit box of the element with this law.
    ///
    /// # Errors
    /// The law is unknown or its file is wrong, or the element does not fill a box.
    pub fn new(element: &Arc<Element>, material: Material, law: &str) -> Result<Pulled> {
        let energy = Energy::load(law, material).map_err(|e| e.placed(|e| Error::at("law", e.problem())))?;
        let d = element.dimension();
        let cells = vec![if d == 3 { 3 } else { 6 }; d];
        let mesh = BoxMesh { element: element.clone(), size: vec![1.0; d], cells, origin: vec![0.0; d] }.build()?;
        Ok(Pulled { mesh, material, large: LargeBody::at_rest((energy, material.state())) })
    }

    /// The title of the law.
    pub fn title(&self) -> String {
        self.large.laws.first().title().to_string()
    }

    /// The ways that are compared where none is listed; sampled shapes reach to the stretch `sampled`.
    ///
    /// # Errors
    /// `sampled` is out of range.
    pub fn usual_fits(&self, sampled: f64) -> Result<Vec<NamedFit>> {
        if !(sampled > 0.0 && sampled <= 2.0) {
            return Err(Error::expected("stretch", "a stretch above 0 and at most 2", sampled));
        }
        let exact = Some(ExactRecipe::default());
        let exact = exact.filter(|exact| exact.serves(Some(&self.large.laws), &self.mesh, &self.material.into()));
        let exact = exact.map(|exact| NamedFit::of(Recipe::Exact(exact), None));
        Ok(exact.into_iter().chain(recipes(&self.mesh.blocks[0].element, sampled)).collect())
    }

    /// Fits the springs in each way, and stretches the box with each network. A fit that does not serve the box has an error of its own.
    ///
    /// # Errors
    /// The equations of the finite elements cannot be solved, or no thread can be started.
    pub fn compare(
        &self,
        fits: &[NamedFit],
        is_timed: bool,
        progress: &mut Progress,
    ) -> Result<Vec<Result<StretchedFit>>> {
        let (total, d) = (fits.len() + 1, self.mesh.dimension);
        progress(Event::stage(BODY, 0, total));
        let body = self.follow(&Body::new(&self.mesh, &self.large.laws))?;
        let mut found = Vec::new();
        for (done, named) in fits.iter().enumerate() {
            progress(Event::stage(&named.name, done + 1, total));
            let reference = Reference { large: Some(&self.large), ..Reference::default() };
            let fitted = fit_without_errors(&self.mesh, &self.material.into(), &reference, named, &mut |_| {});
            let compared = |(fitted, _): (FitOutcome, _)| {
                let network = self.follow(&fitted.network)?;
                let both = || body.iter().zip(&network).map(|(fem, lem)| Some((fem.as_ref()?, lem.as_ref()?)));
                let error = |pair: Option<(&Held, &Held)>| {
                    pair.and_then(|(fem, lem)| displacement_error(&fem.displacement, &lem.displacement, d))
                        .map(|e| e.rms)
                };
                let excess =
                    |pair: Option<(&Held, &Held)>| pair.map(|(fem, lem)| 100.0 * (lem.force / fem.force - 1.0));
                let (errors, excess) = (both().map(error).collect(), both().map(excess).collect());
                let sampled = fitted.kind.sampled().cloned();
                Ok(StretchedFit { name: named.name.clone(), times: None, sampled, errors, excess })
            };
            found.push(fitted.and_then(compared));
        }
        if is_timed {
            self.time(fits, &mut found)?;
        }
        Ok(found)
    }

    fn time(&self, fits: &[NamedFit], found: &mut [Result<StretchedFit>]) -> Result<()> {
        let served: Vec<usize> = (0..fits.len()).filter(|fit| found[*fit].is_ok()).collect();
        let own: Vec<NamedFit> = served.iter().map(|fit| fits[*fit].clone()).collect();
        let times = on_one_thread(|| {
            let reference = Reference { large: Some(&self.large), ..Reference::default() };
            time_fits(&self.mesh, &self.material.into(), &reference, &own)
        })?;
        for (fit, times) in served.into_iter().zip(times) {
            if let Ok(fit) = &mut found[fit] {
                fit.times = Some(times.element);
            }
        }
        Ok(())
    }

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
            // From rest for each stretch: an equilibrium that is lost does not end the list.
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
        let state = self.material.state();
        let law = self.large.laws.first();
        let run =
            |fit: &_| fit_sampled(&block.element, &springs, &self.mesh.points, nodes, law, state, fit, &mut |_| {});
        let (seconds, found) = on_one_thread(|| {
            let clock = Clock::start();
            run(&fit)?;
            let seconds = clock.seconds();
            // After the clock was read; the errors on other shapes are no part of the time of a fit.
            fit.sampling.held_out = 1000;
            Ok((seconds, run(&fit)?))
        })?;
        let (trained, held_out) = (found.trained[0], found.held_out[0]);
        Ok(SampledRun { name: name.into(), shapes, seconds, trained, held_out })
    }
}
