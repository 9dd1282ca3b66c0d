//! Runs a scene: fit each objective, solve each load with both models, compare.

use super::metrics::{DisplacementError, displacement_error};
use super::moduli::{EffectiveModuli, moduli_of_body};
use super::scene::{NamedFit, Scene};
use crate::error::{Error, Result};
use crate::fit::{CellFits, ElementErrors, Objective, Spread, Weight, element_errors, fit_cells};
use crate::material::{Material, Moduli};
use crate::mesh::{Mesh, Selection};
use crate::model::{Action, Network, Support, finite_elements, masses, nodal_forces, unheld_bodies};
use crate::solve::{Factor, Stability, Standing, System, compare_energies};
use crate::springs::Springs;
use std::time::Instant;

/// Told the stage, the steps done and the steps in all.
pub type Progress<'a> = dyn FnMut(&str, usize, usize) + 'a;

/// What came out of a scene.
#[derive(Debug)]
pub struct Outcome {
    pub scene: String,
    pub mesh: Mesh,
    pub material: Material,
    /// `[points]`, kg, where the scene gives a density.
    pub masses: Option<Vec<f64>>,
    /// Displacements of the finite elements, one per load, `[points · dimension]`, m.
    pub fem: Vec<Vec<f64>>,
    pub fits: Vec<FitOutcome>,
    /// What the scene did not ask for and was not done.
    pub left_out: Vec<String>,
}

#[derive(Debug)]
pub struct FitOutcome {
    pub fit: NamedFit,
    pub network: Network,
    /// For the constants of all cells, without assembly.
    pub seconds: f64,
    pub seconds_assembly: f64,
    /// Cells whose springs the objective does not determine.
    pub deficient: usize,
    /// Cells whose iteration did not reach its end.
    pub unreached: usize,
    /// Cells that took over the constants of one of the same shape.
    pub reused: usize,
    /// Cells whose spectral optimum is not unique.
    pub ambiguous: usize,
    /// The largest relative duality gap, where the objective has certificates.
    pub gap: Option<f64>,
    /// Where `(1 − ε) R ⪯ K ⪯ (1 + ε) R` holds in every cell with ε < 1: the relative error of the model's energy.
    pub energy_error: Option<f64>,
    pub frobenius: Spread,
    pub spectral: Spread,
    /// What the network is as a material, where the scene asks for it: under linear displacements of its boundary.
    pub moduli: Option<EffectiveModuli>,
    /// With the support of the first load; `None` without loads.
    pub stability: Option<Stability>,
    /// Points that move in the softest motion, at least half as far as the one that moves most.
    pub loose_points: Vec<usize>,
    pub loads: Vec<LoadOutcome>,
}

#[derive(Debug)]
pub struct LoadOutcome {
    pub name: String,
    /// Displacements of the network, `[points · dimension]`, m; `None` where it does not stand.
    pub displacement: Option<Vec<f64>>,
    /// `None` where the network does not stand or nothing moves.
    pub error: Option<DisplacementError>,
    /// To assemble, factorise and solve, each as if this were the only load.
    pub seconds_fem: f64,
    pub seconds_lem: f64,
}

impl Outcome {
    /// The outcome of one fit without loads.
    pub fn of_fit(name: String, mesh: Mesh, material: Material, masses: Option<Vec<f64>>, fit: FitOutcome) -> Outcome {
        Outcome { scene: name, mesh, material, masses, fem: Vec::new(), fits: vec![fit], left_out: Vec::new() }
    }
}

/// The stages of a scene in order: what will run, or why it is left out.
pub fn stages(scene: &Scene) -> Vec<(String, Option<String>)> {
    let run = |what: String| (what, None);
    let skip = |what: &str, why: &str| (what.to_string(), Some(why.to_string()));
    let mut stages = vec![run(match (&scene.mesh.file, &scene.mesh.generated) {
        (Some(file), _) => format!("read {}", file.display()),
        (_, Some(entry)) => format!("generate {:?} cells of {}", entry.cells, entry.element),
        _ => "mesh".into(),
    })];
    for fit in &scene.fits {
        stages.push(run(format!("fit {}, assemble its network, measure its matrix errors", fit.name)));
    }
    if scene.loads.is_empty() {
        stages.push(skip("finite element solution", "the scene has no [[load]]"));
        stages.push(skip("network solutions, displacement errors, stability", "the scene has no [[load]]"));
    }
    for load in &scene.loads {
        stages.push(run(format!("solve {} with finite elements and with {} networks", load.name, scene.fits.len())));
    }
    if !scene.loads.is_empty() {
        stages.push(run("compare the energies of each network with the body's".into()));
    }
    match scene.density() {
        Some(_) => stages.push(run("masses".into())),
        None => stages.push(skip("masses", "the material has no density")),
    }
    for (wanted, what) in [
        (scene.output.moduli, "moduli of each network as a material"),
        (scene.output.vtu, "VTU files"),
        (scene.output.csv, "CSV files"),
    ] {
        stages.push(if wanted { run(what.into()) } else { skip(what, "not asked for in [output]") });
    }
    stages
}

/// Runs the scene. Work is done only for what the scene names.
///
/// # Errors
/// An input is wrong: a group, a support, a load, the mesh. A network that does not stand is no error.
pub fn run(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    let mesh = scene.build_mesh()?;
    let material = scene.material(mesh.cell_dimension())?;
    drawable(scene, &mesh)?;
    let cases = load_cases(scene, &mesh, material)?;
    let mut outcome = Outcome {
        scene: scene.title.clone(),
        material,
        masses: scene.density().map(|density| masses(&mesh, density, material.thickness())),
        fem: Vec::new(),
        fits: Vec::new(),
        left_out: stages(scene).into_iter().filter_map(|(what, why)| Some(format!("{what}: {}", why?))).collect(),
        mesh,
    };
    for (i, fit) in scene.fits.iter().enumerate() {
        let fitted = fit_mesh(&outcome.mesh, material, fit, progress).map_err(|e| scene.at(&format!("fit[{i}]"), e))?;
        outcome.fits.push(fitted);
    }
    if scene.output.moduli {
        for (done, fit) in outcome.fits.iter_mut().enumerate() {
            progress("moduli", done, scene.fits.len());
            fit.moduli = moduli_of_body(&outcome.mesh, &fit.network.stiffness(&outcome.mesh.points))?;
        }
    }
    let body = Body::solve(&outcome.mesh, material.moduli(), &cases, progress).map_err(|e| e.in_file(&scene.path))?;
    for fit in &mut outcome.fits {
        progress("networks", outcome.fem.len(), cases.len());
        body.compare(&outcome.mesh, &cases, fit)?;
    }
    outcome.fem = body.displacements;
    Ok(outcome)
}

/// Asked for before the work, not after it.
fn drawable(scene: &Scene, mesh: &Mesh) -> Result<()> {
    match mesh.blocks.iter().find(|b| scene.output.vtu && b.element.formats.vtk.is_none()) {
        Some(block) => {
            let expected = "elements that name their VTK type in [formats]";
            Err(Error::expected("output.vtu", expected, &block.element.name).in_file(&scene.path))
        }
        None => Ok(()),
    }
}

/// Fits one objective on every cell and assembles the network.
///
/// # Errors
/// A spring group is no group of the elements.
pub fn fit_mesh(mesh: &Mesh, material: Material, named: &NamedFit, progress: &mut Progress) -> Result<FitOutcome> {
    let moduli = material.moduli();
    let total = mesh.cell_count();
    let mut done = 0;
    // Threads start before the clock does.
    rayon::broadcast(|_| ());
    let start = Instant::now();
    let mut fits: Vec<CellFits> = Vec::new();
    for block in &mesh.blocks {
        let springs = Springs::select(&block.element, named.springs.as_deref())?;
        fits.push(fit_cells(
            &block.element,
            &springs,
            &mesh.points,
            &block.connectivity,
            moduli,
            &named.fit,
            &mut |n| {
                progress(&named.name, done + n, total);
            },
        )?);
        done += block.cells().len();
    }
    let seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let network = Network::assemble(mesh, &fits);
    let seconds_assembly = start.elapsed().as_secs_f64();
    let mut errors = ElementErrors::default();
    for (block, fit) in mesh.blocks.iter().zip(&fits) {
        errors.extend(element_errors(&block.element, &mesh.points, &block.connectivity, moduli, fit)?);
    }
    let certificates = || fits.iter().flat_map(|f| &f.certificates);
    let largest = certificates().map(|c| c.value).reduce(f64::max);
    let relative = named.fit.objective == Objective::Spectral(Weight::Relative);
    Ok(FitOutcome {
        fit: named.clone(),
        network,
        seconds,
        seconds_assembly,
        deficient: fits.iter().map(|f| f.deficient).sum(),
        unreached: fits.iter().map(|f| f.unreached).sum(),
        reused: fits.iter().map(|f| f.reused).sum(),
        ambiguous: certificates().filter(|c| c.ambiguous).count(),
        gap: certificates().map(|c| c.gap()).reduce(f64::max),
        energy_error: largest.filter(|epsilon| relative && *epsilon < 1.0),
        frobenius: Spread::of(&errors.frobenius),
        spectral: Spread::of(&errors.spectral),
        moduli: None,
        stability: None,
        loose_points: Vec::new(),
        loads: Vec::new(),
    })
}

/// A load on this mesh: what is held, and the nodal forces.
struct Case {
    name: String,
    support: Support,
    forces: Vec<f64>,
}

fn load_cases(scene: &Scene, mesh: &Mesh, material: Material) -> Result<Vec<Case>> {
    let d = mesh.dimension;
    let mut fixed = Support::free(mesh);
    for (i, (part, axes)) in scene.supports.iter().enumerate() {
        let at = |e| scene.at(&format!("fix[{i}]"), e);
        let points = part.selection(d).and_then(|s| s.points(mesh)).map_err(at)?;
        if points.is_empty() {
            return Err(at(Error::new("holds nothing: the selected part has no points")));
        }
        let all: Vec<usize> = (0..d).collect();
        let directions = axes.as_ref().unwrap_or(&all);
        if directions.iter().any(|&k| k >= d) {
            return Err(at(Error::expected("axes", "\"x\" and \"y\" in a plane mesh", "\"z\"")));
        }
        fixed.fix(&points, directions, d);
    }
    let mut cases = Vec::new();
    for (i, load) in scene.loads.iter().enumerate() {
        let at = |e| scene.at(&format!("load[{i}]"), e);
        let (key, entries) = match &load.action {
            Action::Traction(v) => ("traction", v.len()),
            Action::Force(v) => ("force", v.len()),
            Action::Body(v) => ("body", v.len()),
            Action::Displacement(v) => ("displacement", v.len()),
        };
        if entries != d {
            return Err(at(Error::expected(key, format!("{d} entries for a mesh of dimension {d}"), entries)));
        }
        let selection: Selection = load.part.selection(d).map_err(at)?;
        let forces = nodal_forces(mesh, &selection, &load.action, material.thickness()).map_err(|e| match e.key() {
            Some("load") => at(Error::new(e.problem())),
            _ => at(e),
        })?;
        let mut support = fixed.clone();
        if let Action::Displacement(given) = &load.action {
            for p in selection.points(mesh).map_err(at)? {
                for (k, u) in given.iter().enumerate().filter(|(_, u)| u.is_some()) {
                    support.prescribed[p * d + k] = *u;
                }
            }
        }
        if let Some(body) = unheld_bodies(mesh, &support).first() {
            let expected = "supports that hold every body";
            let place = mesh.point(body.first_point);
            let motions = if body.motions == 1 { "motion" } else { "motions" };
            let found = format!(
                "{} rigid {motions} left to the body of {} points at {place:?} m under load \"{}\"",
                body.motions, body.points, load.name
            );
            return Err(Error::expected("fix", expected, found).in_file(&scene.path));
        }
        cases.push(Case { name: load.name.clone(), support, forces });
    }
    Ok(cases)
}

/// The finite element solutions, and what the comparison with a network reuses.
struct Body {
    displacements: Vec<Vec<f64>>,
    seconds: Vec<f64>,
    /// The equations and factor of each load, as an index into these: loads of equal support share them.
    systems: Vec<(System, Factor)>,
    system_of: Vec<usize>,
}

/// Loads with the same support have the same equations: for each load, the first load it agrees with.
fn shared(cases: &[Case]) -> Vec<usize> {
    let first = |case: &Case| cases.iter().position(|c| c.support == case.support).unwrap_or(0);
    cases.iter().map(first).collect()
}

impl Body {
    fn solve(mesh: &Mesh, moduli: Moduli, cases: &[Case], progress: &mut Progress) -> Result<Body> {
        let mut body = Body { displacements: vec![], seconds: vec![], systems: vec![], system_of: vec![] };
        if cases.is_empty() {
            return Ok(body);
        }
        let start = Instant::now();
        let entries = finite_elements(mesh, moduli);
        let assembly = start.elapsed().as_secs_f64();
        let mut setup = Vec::new();
        for (i, (case, first)) in cases.iter().zip(shared(cases)).enumerate() {
            progress("finite elements", i, cases.len());
            if first == i {
                let start = Instant::now();
                let system = System::new(&entries, &case.support)?;
                let factor = system.factorize().filter(Factor::is_positive_definite).ok_or_else(|| {
                    let why = "the finite element stiffness is not positive definite: some motion has no stiffness";
                    let bending = "; surfaces and curves resist no bending, so hold their points across them";
                    let embedded = mesh.cell_dimension() < mesh.dimension;
                    Error::at("mesh", format!("{why}{}", if embedded { bending } else { "" }))
                })?;
                body.systems.push((system, factor));
                body.system_of.push(body.systems.len() - 1);
                setup.push(start.elapsed().as_secs_f64());
            } else {
                body.system_of.push(body.system_of[first]);
            }
            let (system, factor) = &body.systems[body.system_of[i]];
            let start = Instant::now();
            let (u, _) = system.solve(factor, &case.forces);
            body.seconds.push(assembly + setup[body.system_of[i]] + start.elapsed().as_secs_f64());
            body.displacements.push(u);
        }
        progress("finite elements", cases.len(), cases.len());
        Ok(body)
    }

    /// Solves every load with the network of `fit` and writes the errors into it.
    fn compare(&self, mesh: &Mesh, cases: &[Case], fit: &mut FitOutcome) -> Result<()> {
        if cases.is_empty() {
            return Ok(());
        }
        let start = Instant::now();
        let entries = fit.network.stiffness(&mesh.points);
        let assembly = start.elapsed().as_secs_f64();
        let mut systems: Vec<(System, Option<Factor>, Stability, f64)> = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let index = self.system_of[i];
            if index == systems.len() {
                let start = Instant::now();
                let system = System::new(&entries, &case.support)?;
                let factor = system.factorize();
                let seconds = start.elapsed().as_secs_f64();
                let (body, body_factor) = &self.systems[index];
                let stability = compare_energies(&system, factor.as_ref(), body, body_factor);
                systems.push((system, factor, stability, seconds));
            }
            let (system, factor, stability, setup) = &systems[index];
            let start = Instant::now();
            let stands = stability.standing != Standing::Singular;
            let solution = factor.as_ref().filter(|_| stands).map(|factor| system.solve(factor, &case.forces));
            let seconds_lem = assembly + setup + start.elapsed().as_secs_f64();
            // A factor of a nearly singular matrix gives numbers that solve nothing.
            let displacement = solution.filter(|(u, residual)| *residual < 1e-6 && u.iter().all(|u| u.is_finite()));
            let displacement = displacement.map(|(u, _)| u);
            fit.loads.push(LoadOutcome {
                name: case.name.clone(),
                error: displacement
                    .as_ref()
                    .and_then(|u| displacement_error(&self.displacements[i], u, mesh.dimension)),
                displacement,
                seconds_fem: self.seconds[i],
                seconds_lem,
            });
        }
        if let Some((system, _, stability, _)) = systems.into_iter().next() {
            fit.loose_points = moving_points(&system, &stability, mesh.dimension);
            fit.stability = Some(stability);
        }
        Ok(())
    }
}

fn moving_points(system: &System, stability: &Stability, dimension: usize) -> Vec<usize> {
    if stability.standing == Standing::Sound {
        return Vec::new();
    }
    let mut squares = std::collections::BTreeMap::new();
    for (dof, u) in system.free().iter().zip(&stability.softest) {
        *squares.entry(dof / dimension).or_insert(0.0) += u * u;
    }
    let largest = squares.values().copied().fold(0.0, f64::max);
    squares.into_iter().filter(|(_, s)| *s >= 0.25 * largest).map(|(p, _)| p).collect()
}
