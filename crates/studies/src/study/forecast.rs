//! What a scene will take, before it is run: its sizes, and estimates of time and memory.

mod rates;
mod whole;

use self::rates::{ASSEMBLY, BYTES, COMPARED, ITERATED, SLOWEST_RATE, SOLUTIONS, SPARSE};
use crate::analysis::tensor::most_samples;
use crate::clock::Clock;
use crate::error::Result;
use crate::material::{EnergyMap, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::model::BlockStiffness;
use crate::solve::{FactorCost, dense_rate, factor_cost};
use crate::text::{memory_in_words, time_in_words};
use serde::Serialize;
use springfit_scenes::{
    COMPARISONS, Case, FinerBody, FitLimit, LargeBody, NamedFit, REFINEMENTS, Reference, Scene, WholeBody, entries,
    fit_mesh, load_cases,
};
use std::collections::BTreeMap;

/// Work that takes longer is announced, s.
pub(super) const LONG: f64 = 10.0;
/// The seconds that one fit is tried for, about, unless it is done in `SHORT` by the trials before.
const TRIAL: f64 = 0.02;
const SHORT: f64 = 0.2;
/// Cells that one thread fits at a time.
const CHUNK: usize = 512;
/// Newton's iterations of a step of the load, as most take.
const ITERATIONS: f64 = 6.0;
/// Bytes of a spring of a network, and of what its fit holds at the same time.
const SPRING: f64 = 100.0;

/// Entries of a network's stiffness while it is assembled, for each of its lower triangle: less than both triangles, as the list of its springs is made in
/// place. Measured on exact and classical networks of all elements (`benches/memory.py`).
const NETWORK_ENTRIES: f64 = 1.8;

/// Bytes that a run has whatever its size, most of them of the program itself.
const OWN: f64 = 3e7;

/// A stage with what it will take.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpectedStage {
    /// The stage, in words.
    pub name: String,
    /// s; `None` if it is not known before the work begins.
    pub seconds: Option<f64>,
    /// What the stage has in memory at a time; `None` as well.
    pub bytes: Option<f64>,
}

/// What a scene will take.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Forecast {
    /// The number of points of the mesh.
    pub points: usize,
    /// How many cells each element has.
    pub cells: BTreeMap<String, usize>,
    /// Displacements that are not held under the first load.
    pub unknowns: usize,
    /// The stages in the order in which they run.
    pub stages: Vec<ExpectedStage>,
    /// How stiff a body the engine of each fit that has one can hold, where this was asked for.
    pub engines: Vec<FitLimit>,
    /// The entries of the stiffness of the largest network, of its lower triangle.
    #[serde(skip)]
    network_entries: f64,
}

impl Forecast {
    /// The stages of a scene. The mesh is read or generated; each fit is tried on a few cells for 20 ms; the factor's size is found
    /// from the mesh, and the time of a factorisation from that of a small dense one on this machine.
    ///
    /// # Errors
    /// Those of a run before it begins: of the mesh, the material, the supports and the loads.
    pub fn of(scene: &Scene) -> Result<Forecast> {
        let forecast = || {
            let mesh = scene.build_mesh()?;
            let material = &scene.material_of(&mesh)?;
            let (_, cases) = load_cases(scene, &mesh, material)?;
            Forecast::of_body(scene, &mesh, material, &cases, scene.laws(&mesh, material)?.as_ref())
        };
        forecast().map_err(|e| scene.with_line(e))
    }

    /// The stages of a scene whose mesh is there.
    pub(in crate::study) fn of_body(
        scene: &Scene,
        mesh: &Mesh,
        material: &MaterialMap,
        cases: &[Case],
        energy: Option<&EnergyMap>,
    ) -> Result<Forecast> {
        let held = cases.first().map_or(0, |case| case.support.prescribed.iter().flatten().count());
        let mut forecast = Forecast::of_fits(mesh, material, scene.fits(), energy);
        forecast.unknowns -= held;
        let networks: f64 = forecast.stages.iter().filter_map(|stage| stage.bytes).sum();
        let finer = scene.reference().filter(|entry| !entry.is_of_cells());
        let iterates = energy.is_none() && scene.solver().iterates(mesh, cases.len());
        let is_linear = energy.is_none();
        if is_linear && !scene.solver().iterates(mesh, WholeBody::ASKED) {
            forecast.add_whole(mesh, scene.fits(), finer.is_some())?;
        }
        let later = [
            (scene.motion().is_some(), "motion"),
            (scene.output().frequencies > 0, "natural frequencies"),
            (scene.output().moduli, "moduli of the networks"),
            (scene.output().dynamic_moduli.is_some(), "storage and loss moduli"),
        ];
        if let Some(entry) = finer {
            // What is wrong with the finer mesh is reported where it is solved.
            let fine = entry.build(scene.path(), mesh).ok().filter(|_| is_linear);
            let of = |fine: &Mesh| {
                let solver = scene.solver().suited(fine, &scene.material_of(fine)?.moduli());
                let recipes = scene.fits().iter().filter_map(|fit| fit.recipe.whole());
                whole::of_finer((fine, solver.iterates(fine, FinerBody::ASKED)), cases.len(), recipes)
            };
            let found = fine.as_ref().map(of).transpose()?;
            let (seconds, bytes) = found.map(|[seconds, bytes]| (seconds, bytes)).unzip();
            forecast.stages.push(ExpectedStage { name: "finite elements of the finer body".into(), seconds, bytes });
        }
        if cases.is_empty() && !later.iter().any(|(asked, _)| *asked) {
            return Ok(forecast);
        }
        let (seconds, bytes) = if iterates {
            let models = 1.0 + scene.fits().len() as f64;
            let each = COMPARED + ITERATED * cases.len() as f64;
            // The stiffnesses of the body and of one network are there at the same time, and the springs of all networks.
            let bytes = BlockStiffness::expected_bytes(mesh, 2, 2) as f64 + networks;
            (models * each * mesh.points.len() as f64, bytes)
        } else {
            let factor = factor_cost(mesh)?;
            // The finite elements and one network are assembled one after the other, and their factors are there at the same time.
            let largest = entries(mesh).max(NETWORK_ENTRIES * forecast.network_entries);
            let bytes = BYTES * largest + 2.0 * 8.0 * factor.entries;
            (of_loads(scene, mesh, factor, cases.len()), bytes)
        };
        let bytes = Some(bytes);
        let mut stage = |name: &str, seconds: Option<f64>| {
            forecast.stages.push(ExpectedStage { name: name.into(), seconds, bytes });
        };
        if !cases.is_empty() {
            let large = if energy.is_some() { " at large deformation" } else { "" };
            let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
            let (loads, networks) = (counted(cases.len(), "load"), counted(scene.fits().len(), "network"));
            let name = format!("{loads}{large} by finite elements and {networks}");
            stage(&name, Some(seconds));
        }
        later.iter().filter(|(asked, _)| *asked).for_each(|(_, name)| stage(name, None));
        Ok(forecast)
    }

    /// The fits alone.
    pub fn of_fits(
        mesh: &Mesh,
        material: impl Into<MaterialMap>,
        fits: &[NamedFit],
        energy: Option<&EnergyMap>,
    ) -> Forecast {
        let material = &material.into();
        let large = energy.map(|laws| LargeBody::at_rest(laws.clone()));
        // Threads start before the clock does.
        rayon::broadcast(|_| ());
        let mut network_entries: f64 = 0.0;
        let stage = |fit: &NamedFit| {
            let found = of_fit(mesh, material, large.as_ref(), fit);
            network_entries = network_entries.max(found.map_or(0.0, |[.., entries]| entries));
            let (seconds, bytes) = found.map(|[seconds, bytes, _]| (seconds, bytes)).unzip();
            ExpectedStage { name: format!("fit {}", fit.name), seconds, bytes }
        };
        let stages = fits.iter().map(stage).collect();
        Forecast {
            points: mesh.point_count(),
            cells: mesh.blocks.iter().map(|block| (block.element.name.clone(), block.cells().len())).collect(),
            unknowns: mesh.points.len(),
            stages,
            engines: Vec::new(),
            network_entries,
        }
    }

    /// Gives fits to the whole object their times, at small deformation, with factors and without an engine: those of others are not known.
    ///
    /// # Errors
    /// An analysis does not fit into memory.
    fn add_whole(&mut self, mesh: &Mesh, fits: &[NamedFit], is_finer: bool) -> Result<()> {
        for (stage, fit) in self.stages.iter_mut().zip(fits) {
            let Some(recipe) =
                fit.recipe.whole().filter(|recipe| recipe.engine.is_none() && !recipe.is_of_few_moduli())
            else {
                continue;
            };
            let found = whole::of_fit(recipe, mesh, is_finer)?;
            (stage.seconds, stage.bytes) = (Some(found.seconds), Some(found.bytes));
            self.network_entries = self.network_entries.max(found.entries);
        }
        Ok(())
    }

    /// The time of all stages whose time is known, s.
    pub fn seconds(&self) -> f64 {
        self.stages.iter().filter_map(|stage| stage.seconds).sum()
    }

    /// The largest memory of a stage, with what a run has besides, bytes.
    pub fn bytes(&self) -> f64 {
        OWN + self.stages.iter().filter_map(|stage| stage.bytes).fold(0.0, f64::max)
    }

    /// The stages whose time is not known.
    pub fn unknown(&self) -> impl Iterator<Item = &str> {
        self.stages.iter().filter(|stage| stage.seconds.is_none()).map(|stage| stage.name.as_str())
    }

    /// A sentence for work that is expected to take more than ten seconds.
    pub fn announcement(&self) -> Option<String> {
        let seconds = self.seconds();
        let longest =
            self.stages.iter().max_by(|a, b| a.seconds.unwrap_or(0.0).total_cmp(&b.seconds.unwrap_or(0.0)))?;
        let unknown: Vec<&str> = self.unknown().collect();
        let more = if unknown.is_empty() { String::new() } else { format!(", without {}", unknown.join(", ")) };
        (seconds > LONG).then(|| {
            let (time, part) = (time_in_words(seconds), time_in_words(longest.seconds.unwrap_or(0.0)));
            let memory = memory_in_words(self.bytes());
            format!("about {time} and {memory} are expected{more}, {part} of it for {} (an estimate)", longest.name)
        })
    }
}

/// The seconds of a fit, the bytes of its network and the entries of its stiffness: it is made on more and more cells until that takes `TRIAL`, and all cells have the
/// pace of the last trial. `None` of fits to the whole object and to states of loads, which are no sum over cells.
fn of_fit(mesh: &Mesh, material: &MaterialMap, large: Option<&LargeBody>, fit: &NamedFit) -> Option<[f64; 3]> {
    let kind = fit.recipe.kind();
    let of_loads = fit.recipe.sampled().is_some_and(|recipe| recipe.has_states());
    // Springs on edges and patches are of as many cells as lie around them.
    let is_sum = kind.cell_method().is_some() || fit.recipe.is_exact_without_bound();
    if of_loads || (!is_sum && (fit.recipe.whole().is_some() || fit.recipe.sampled().is_none())) {
        return None;
    }
    // Factors for an engine are found from the whole body.
    let fit = &fit.clone().in_engine(None);
    let total = mesh.cell_count();
    let reference = Reference { large, ..Reference::default() };
    // From a few cells on, because nothing is known yet of the time of one.
    let mut count = 8;
    loop {
        let some = mesh.of_first_cells(count);
        let first = |block: &CellBlock| (0..block.cells().len()).collect();
        let own = material.of_some(&some.blocks.iter().map(first).collect::<Vec<_>>());
        // What is wrong is reported where the fit is made.
        let trial = || {
            let start = Clock::start();
            let fit = fit_mesh(&some, &own, &reference, fit, &mut |_| {}).ok()?;
            let (whole, sampling) = (start.seconds(), fit.as_material.seconds);
            let (springs, entries) = (fit.network.len() as f64, fit.network.entries() as f64);
            // The tensor of a network is sampled at no more than a number of places, so that its time does not grow
            // with the body.
            Some(((whole - sampling).max(0.0), sampling / fit.as_material.samples as f64, [springs, entries]))
        };
        // The first trial touches memory for the first time.
        let ((first, ..), (second, sample, [springs, entries])) = (trial()?, trial()?);
        let seconds = first.min(second);
        let made = some.cell_count();
        let share = total as f64 / made as f64;
        // A chunk of cells is the work of one thread, a sample as well.
        let (threads, chunks) = (rayon::current_num_threads(), total.div_ceil(CHUNK));
        let sampling = sample * most_samples(mesh) as f64 / threads as f64;
        // No more threads have work than there are chunks.
        let expected = seconds * share / threads.min(chunks) as f64 + sampling;
        if seconds > TRIAL || made >= total || expected < SHORT {
            return Some([expected, SPRING * springs * share, entries * share]);
        }
        // The trials before the last one take a third of its time together.
        count *= 4;
    }
}

/// The seconds of the loads with the finite elements and with each network.
fn of_loads(scene: &Scene, mesh: &Mesh, factor: FactorCost, loads: usize) -> f64 {
    let networks = scene.fits().len() as f64;
    let models = 1.0 + networks;
    let loads = loads as f64;
    let assembly = ASSEMBLY * entries(mesh);
    // A solution reads the factor forward and backward.
    let solution = 2.0 * factor.entries / SOLUTIONS;
    let iterations = ITERATIONS * scene.newton().steps as f64 * loads;
    let factors = if scene.law().is_some() { models * iterations } else { models };
    let operations = factors * factor.operations;
    let factorisation = if operations < SLOWEST_RATE { 0.0 } else { operations / (SPARSE * dense_rate()) };
    match scene.law() {
        // Loads of one support share a factor; most do.
        None => {
            let solutions = networks * COMPARISONS + models * loads * REFINEMENTS;
            factorisation + models * assembly + solutions * solution
        }
        Some(_) => factorisation + models * iterations * 2.0 * (assembly + solution),
    }
}
