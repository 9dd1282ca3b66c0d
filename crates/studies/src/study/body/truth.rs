//! What errors are relative to where the cells of a body lock: quadratic elements on these cells, never the elements that lock.

use super::answer::{check_residual, largest_residual, not_definite};
use super::case::{Case, FinerSolution};
use super::cases::applied_cases;
use crate::analysis::metrics::{displacement_error, square};
use crate::error::Result;
use crate::material::MaterialMap;
use crate::mesh::{Carrier, CellBlock, Field, Mesh};
use crate::model::{Action, finite_elements};
use crate::solve::{Equations, KnownEquations, factor_cost};
use crate::study::locking::Locking;
use crate::study::outcome::Standard;
use crate::study::progress::{Event, Progress};
use crate::study::scene::{LoadCase, LoadKind, Scene};

/// The truth takes at most this many times what the finite elements and the networks of the scene take, or a time that nobody notices.
const DEAREST: f64 = 3.0;
/// Operations that nobody notices: about two seconds on one core.
const UNNOTICED: f64 = 1e10;
/// Each entry of a factor is read twice for a solution, and each of a cell's matrix is sorted: so many operations of a factorisation take as
/// long.
const PER_ENTRY: f64 = 10.0;
const PER_SORTED: f64 = 300.0;
/// Solutions while a network is compared, and for each load of a body.
const COMPARED: f64 = 45.0;
const REFINED: f64 = 3.0;
/// More points are not even counted: their analysis alone would be noticed.
const MOST_POINTS: usize = 40_000;
/// Two levels that differ by more, in percent of the largest displacement, say nothing of the truth.
const MOST_APART: f64 = 50.0;
/// The key that asks for the finite elements of the mesh.
const CELLS: &str = "from = \"cells\" in [reference] compares with the finite elements of the mesh";

/// The answers on one level.
struct Level {
    standard: Standard,
    /// At the points of the mesh of the scene, by load, m.
    displacements: Vec<Vec<f64>>,
    /// J; see [`Case::work`].
    works: Vec<Option<f64>>,
}

/// Gives each load the displacements of quadratic elements, where linear cells of the mesh lock: on these cells halved, with the difference
/// from those on the cells themselves as an estimate of their error, as far as that takes at most three times what the finite elements and
/// the networks take. Returns what must be known of it, one sentence each.
pub fn judge_by_truth(
    scene: &Scene,
    mesh: &Mesh,
    material: &MaterialMap,
    cases: &mut [Case],
    progress: &mut Progress,
) -> Vec<String> {
    let Some(Locking { poisson, .. }) = Locking::of(mesh, material, &|_| true) else { return Vec::new() };
    let locks = format!("at nu = {poisson} linear cells lock");
    let is_of_points = |load: &LoadCase| is_of_points(load, scene.loads(), mesh);
    let is_judged: Vec<bool> =
        scene.loads().iter().map(|load| load.measured.is_none() && !is_of_points(load)).collect();
    let mut notes = Vec::new();
    for load in scene.loads().iter().filter(|load| is_of_points(load)) {
        notes.push(format!(
            "{locks}, and the load {} acts on points alone, which move without bound as cells become smaller: its errors are relative to the \
             finite elements of the mesh, which are too stiff",
            load.name
        ));
    }
    if !is_judged.contains(&true) {
        return notes;
    }
    let too_long = || {
        format!(
            "{locks}: errors are relative to the finite elements of the mesh, which are too stiff; quadratic elements would take more than \
             {DEAREST} times as long as the run: from = \"quadratic\" in [reference] asks for them"
        )
    };
    let growth = 1 << mesh.cell_dimension();
    let is_small = |growth: usize| growth * mesh.point_count() <= MOST_POINTS;
    if !is_small(growth) {
        notes.push(too_long());
        return notes;
    }
    let mut chosen = mesh.clone();
    scene.choose(&mut chosen);
    let allowed = UNNOTICED.max(DEAREST * work(mesh, 1 + scene.fits().len(), cases.len(), scene.fits().len()));
    let mut level = |finer: Result<Mesh>, standard: Standard| -> Result<Option<Level>> {
        let finer = finer?;
        if work(&finer, 1, cases.len(), 0) > allowed {
            return Ok(None);
        }
        progress(Event::stage("quadratic elements", 0, 1));
        Level::solve(scene, mesh, &finer, standard).map(Some)
    };
    let first = level(chosen.elevated(), Standard::Quadratic);
    let second = match (&first, is_small(growth * growth)) {
        (Ok(Some(_)), true) => level(chosen.refined().and_then(|mesh| mesh.elevated()), Standard::QuadraticHalved),
        _ => Ok(None),
    };
    let (best, coarser) = match (first, second) {
        (Ok(Some(first)), Ok(Some(second))) => (second, Some(first)),
        // A second level that is not solved leaves the first one, whose error is then not known.
        (Ok(Some(first)), Ok(None) | Err(_)) => (first, None),
        (Ok(None), _) => {
            notes.push(too_long());
            return notes;
        }
        (Err(error), _) => {
            notes.push(format!(
                "{locks}, and no reference that does not is solved ({}): errors are not known; {CELLS}",
                error.problem()
            ));
            forget(cases, &is_judged);
            return notes;
        }
    };
    for (load, case) in cases.iter_mut().enumerate().filter(|(load, _)| is_judged[*load]) {
        let displacements = &best.displacements[load];
        let uncertainty = coarser
            .as_ref()
            .and_then(|coarser| displacement_error(displacements, &coarser.displacements[load], mesh.dimension));
        if let Some(apart) = uncertainty.filter(|apart| !(apart.rms <= MOST_APART)) {
            notes.push(format!(
                "{locks}, and so does the reference under {}: quadratic elements on the cells and on halved cells differ by {:.0} %: errors are not \
                 known; {CELLS}",
                case.name, apart.rms
            ));
            forget(std::slice::from_mut(case), &[true]);
            continue;
        }
        case.measured = Some(Field { displacements: displacements.iter().copied().map(Some).collect() });
        case.finer = Some(FinerSolution { standard: best.standard, work: best.works[load], uncertainty });
    }
    notes
}

/// Makes the errors of these cases unknown.
fn forget(cases: &mut [Case], is_judged: &[bool]) {
    for (case, _) in cases.iter_mut().zip(is_judged).filter(|(_, judged)| **judged) {
        case.measured = Some(Field { displacements: vec![None; case.forces.len()] });
        case.finer = Some(FinerSolution { standard: Standard::Quadratic, work: None, uncertainty: None });
    }
}

/// Whether the load is a force on points, which is no load of a continuous body, or has one among those that it consists of.
fn is_of_points(load: &LoadCase, all: &[LoadCase], mesh: &Mesh) -> bool {
    match &load.kind {
        LoadKind::Sum(parts) => parts.iter().any(|&part| is_of_points(&all[part], all, mesh)),
        LoadKind::Single { part, action: Action::Force(_), .. } => {
            let carrier = part.selection(mesh.dimension).and_then(|selection| selection.carrier(mesh));
            matches!(carrier, Ok(Carrier::Points(_)))
        }
        LoadKind::Single { .. } => false,
    }
}

/// What it takes to assemble and to factorise `models` of a mesh, to solve each for all loads, and to compare the networks among them, in
/// operations of a factorisation; infinite where that is not known.
fn work(mesh: &Mesh, models: usize, loads: usize, networks: usize) -> f64 {
    let Ok(factor) = factor_cost(mesh) else { return f64::INFINITY };
    let of_block =
        |block: &CellBlock| block.cells().len() as f64 * ((block.element.nodes() * mesh.dimension) as f64).powi(2);
    let sorted: f64 = mesh.blocks.iter().map(of_block).sum();
    let solutions = COMPARED * networks as f64 + REFINED * (models * loads) as f64;
    models as f64 * (factor.operations + PER_SORTED * sorted) + PER_ENTRY * solutions * factor.entries
}

impl Level {
    /// The finite elements of a mesh whose first points are those of the mesh of the scene.
    fn solve(scene: &Scene, mesh: &Mesh, finer: &Mesh, standard: Standard) -> Result<Level> {
        let material = scene.material_of(finer)?;
        let (_, cases) = applied_cases(scene, finer, &material)?;
        let (known, moduli, solver) = (KnownEquations::default(), material.moduli(), scene.solver());
        let entries = cases.iter().any(|case| case.is_prescribed).then(|| finite_elements(finer, &moduli));
        let mut level = Level { standard, displacements: Vec::new(), works: Vec::new() };
        for case in &cases {
            let solve = || {
                let found = Equations::of_body(finer, &moduli, &case.support, (solver, cases.len()))?;
                found.ok_or_else(|| not_definite(finer))
            };
            let (mut u, residual) = known.under(&case.support, solve)?.solve(&case.forces)?;
            check_residual(residual, largest_residual(&solver), case)?;
            level.works.push(case.work(&u, || entries.as_ref().map(|entries| square(entries, &u))));
            u.truncate(mesh.points.len());
            level.displacements.push(u);
        }
        Ok(level)
    }
}
