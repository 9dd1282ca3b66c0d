//! The reference of errors where the cells of a body lock: quadratic elements on these cells, never the elements that lock. The reference
//! that a scene states is read in `finer_mesh.rs`.

use super::case::{Case, FinerSolution};
use super::cases::applied_cases;
use super::finer_linear::{FinerAnswer, answers};
use crate::analysis::locking::{TooStiff, bends};
use crate::analysis::metrics::displacement_error;
use crate::cost::{COMPARISONS, REFINEMENTS, entries};
use crate::error::Result;
use crate::mesh::{Carrier, Field, Mesh};
use crate::model::{Action, Deformation};
use crate::outcome::Standard;
use crate::progress::Progress;
use crate::scene::{LoadCase, LoadKind, Scene};
use crate::solve::{KnownEquations, factor_cost};

/// The reference takes at most this many times what the finite elements and the networks of the scene take, or a time that nobody notices.
const DEAREST: f64 = 3.0;
/// Operations that nobody notices: about two seconds on one core.
pub const UNNOTICED: f64 = 1e10;
/// Each entry of a factor is read twice for a solution, and each of a cell's matrix is sorted: so many operations of a factorisation take as
/// long.
const PER_ENTRY: f64 = 10.0;
const PER_SORTED: f64 = 300.0;
/// More points are not even counted: their analysis alone would be noticed.
pub const MOST_POINTS: usize = 40_000;
/// Two levels that differ by more, in percent of the largest displacement, say nothing of the truth.
// Where halved cells change half of the motion, no order is reached by which what is left could be bounded: at the second order a third
// of the change would be left, and on cells that still lock it may be nearly all.
const MOST_APART: f64 = 50.0;
/// The key that asks for the finite elements of the mesh.
const CELLS: &str = "from = \"cells\" in [reference] compares with the finite elements of the mesh";

/// The answers to each load on one level.
pub(super) struct Level {
    standard: Standard,
    pub(super) answers: Vec<FinerAnswer>,
}

/// Gives each load the displacements of quadratic elements, where linear cells of the mesh lock or a body of one cell across bends under it: on
/// these cells halved, with the difference from those on the cells themselves as an estimate of their error, as far as that takes at most three
/// times what the finite elements and the networks take. They deform so, by load. Returns what must be known of it, one sentence each.
pub fn judge_by_quadratic_elements(
    scene: &Scene,
    mesh: &Mesh,
    cases: &mut [Case],
    (too_stiff, deformations): (TooStiff, &[Option<Deformation>]),
    progress: &mut Progress,
) -> Vec<String> {
    // Notes of the report say that errors are relative to cells that bend too little.
    let (locks, is_told) = match too_stiff {
        TooStiff::Locks(locking) => (format!("at nu = {} linear cells lock", locking.poisson), false),
        TooStiff::Bends | TooStiff::Coarse => {
            ("the body is about one cell across and bends, where linear cells are too stiff".to_string(), true)
        }
    };
    let is_stiff = deformations.iter().map(|deformation| !is_told || deformation.is_some_and(bends));
    let is_of_points = |load: &LoadCase| is_of_points(load, scene.loads(), mesh);
    let is_judged: Vec<bool> = scene
        .loads()
        .iter()
        .zip(is_stiff)
        .map(|(load, stiff)| stiff && load.measured.is_none() && !is_of_points(load))
        .collect();
    let mut notes = Vec::new();
    for load in scene.loads().iter().filter(|load| !is_told && is_of_points(load)) {
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
        let words = format!(
            "{locks}: errors are relative to the finite elements of the mesh, which are too stiff; quadratic elements would take more than \
             {DEAREST} times as long as the run: from = \"quadratic\" in [reference] asks for them"
        );
        (!is_told).then_some(words)
    };
    let allowance = Allowance::of(scene, mesh, cases.len());
    let mut level = |halvings: u32, finer: &dyn Fn() -> Result<Mesh>, standard: Standard| -> Result<Option<Level>> {
        let finer = allowance.afford(halvings, finer)?;
        finer.map(|finer| Level::solve(scene, &finer, standard, "quadratic elements", progress)).transpose()
    };
    let first = level(1, &|| mesh.elevated(), Standard::Quadratic);
    let second = match &first {
        // Without the first level the second one would be a reference of unknown error.
        Ok(Some(_)) => level(2, &|| mesh.refined().and_then(|mesh| mesh.elevated()), Standard::QuadraticHalved),
        _ => Ok(None),
    };
    let (best, coarser) = match (first, second) {
        (Ok(Some(first)), Ok(Some(second))) => (second, Some(first)),
        // A second level that is not solved leaves the first one, whose error is then not known.
        (Ok(Some(first)), Ok(None) | Err(_)) => (first, None),
        (Ok(None), _) => {
            notes.extend(too_long());
            return notes;
        }
        (Err(error), _) => {
            notes.push(format!(
                "{locks}, and no reference that does not is solved ({}): errors are not known; {CELLS}",
                error.problem()
            ));
            cases.iter_mut().zip(&is_judged).filter(|(_, judged)| **judged).for_each(|(case, _)| forget(case));
            return notes;
        }
    };
    for (load, case) in cases.iter_mut().enumerate().filter(|(load, _)| is_judged[*load]) {
        // The first points of a finer mesh are those of the mesh.
        let at_points = |level: &'_ Level| level.answers[load].displacement[..mesh.points.len()].to_vec();
        let displacements = at_points(&best);
        let uncertainty = coarser
            .as_ref()
            .and_then(|coarser| displacement_error(&displacements, &at_points(coarser), mesh.dimension));
        if let Some(apart) = uncertainty.filter(|apart| !(apart.rms <= MOST_APART)) {
            notes.push(format!(
                "{locks}, and so does the reference under {}: quadratic elements on the cells and on halved cells differ by {:.0} %: errors are not \
                 known; {CELLS}",
                case.name, apart.rms
            ));
            forget(case);
            continue;
        }
        case.measured = Some(Field { displacements: displacements.into_iter().map(Some).collect() });
        case.finer = Some(FinerSolution { standard: best.standard, work: best.answers[load].work, uncertainty });
    }
    notes
}

/// What the answers of a finer mesh of a body may take.
pub(super) struct Allowance {
    /// The points of the mesh that is to be compared, and the factor by which a halving of its cells multiplies them.
    points: usize,
    growth: usize,
    loads: usize,
    /// Operations; none are counted where even a mesh of halved cells has too many points.
    operations: f64,
}

impl Allowance {
    /// The allowance of this number of loads on a mesh, for comparing it.
    pub(super) fn of(scene: &Scene, mesh: &Mesh, loads: usize) -> Allowance {
        let (points, growth, networks) = (mesh.point_count(), 1 << mesh.cell_dimension(), scene.fits().len());
        let operations = match growth * points > MOST_POINTS {
            true => 0.0,
            false => UNNOTICED.max(DEAREST * work(mesh, 1 + networks, loads, networks)),
        };
        Allowance { points, growth, loads, operations }
    }

    /// A finer mesh, with about as many points as the mesh has after so many halvings, if its answers take no more.
    ///
    /// # Errors
    /// The finer mesh cannot be made.
    pub(super) fn afford(&self, halvings: u32, finer: impl FnOnce() -> Result<Mesh>) -> Result<Option<Mesh>> {
        // Before the mesh is made: what it would have is known from the halvings.
        if self.growth.pow(halvings) * self.points > MOST_POINTS {
            return Ok(None);
        }
        // Counted on the mesh itself, because the fill of its factor depends on its shape.
        Ok(Some(finer()?).filter(|finer| work(finer, 1, self.loads, 0) <= self.operations))
    }
}

/// Makes the errors of a load unknown.
fn forget(case: &mut Case) {
    // Known nowhere, rather than left to the finite elements that lock.
    case.measured = Some(Field { displacements: vec![None; case.forces.len()] });
    case.finer = Some(FinerSolution { standard: Standard::Quadratic, work: None, uncertainty: None });
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
    let solutions = COMPARISONS * networks as f64 + REFINEMENTS * (models * loads) as f64;
    models as f64 * (factor.operations + PER_SORTED * entries(mesh)) + PER_ENTRY * solutions * factor.entries
}

/// Quadratic elements on the cells of a mesh, and their answers to the loads of a scene.
///
/// # Errors
/// The cells have no quadratic element, or a load has no answer there.
pub fn quadratic_answers(scene: &Scene, mesh: &Mesh, progress: &mut Progress) -> Result<(Mesh, Vec<FinerAnswer>)> {
    let finer = mesh.elevated()?;
    let level = Level::solve(scene, &finer, Standard::Quadratic, "quadratic elements", progress)?;
    Ok((finer, level.answers))
}

impl Level {
    /// The answers of the finite elements of a finer mesh to the loads of a scene; `stage` names the work.
    ///
    /// # Errors
    /// A load does not act on the finer mesh, or has no answer there.
    pub(super) fn solve(
        scene: &Scene,
        finer: &Mesh,
        standard: Standard,
        stage: &str,
        progress: &mut Progress,
    ) -> Result<Level> {
        let material = scene.material_of(finer)?;
        let (_, cases) = applied_cases(scene, finer, &material)?;
        let body = (finer, &material, scene.solver());
        let answers = answers(body, &cases, &KnownEquations::default(), stage, progress)?;
        Ok(Level { standard, answers })
    }
}
