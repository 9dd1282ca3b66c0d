//! A mesh of the body: what its finite elements answer, and how that changes with the unknowns.
//!
//! At small deformation `K(θ) u = f` gives `∂u/∂θ_p = −K⁻¹ (∂K/∂θ_p) u`; at large deformation K is the tangent at the equilibrium and
//! `(∂K/∂θ_p) u` the derivative of the forces. What holds a part is the sum of `K u` over its degrees of freedom.
//!
//! Theory: page *Calibration* of the book.

use super::sight::{Observation, Quantity};
use super::unknowns::Unknowns;
use crate::error::{Error, Result};
use crate::material::{EnergyMap, MaterialMap};
use crate::mesh::{CellIndex, Embedding, Mesh};
use crate::model::{Body, Elastic, Support, displaced, each_cell_forces};
use crate::solve::{Equations, KnownPatterns, Newton, StaticSolver};
use std::collections::HashMap;
use std::sync::Mutex;

/// A load on a mesh.
#[derive(Debug, Clone)]
pub struct LoadCase {
    /// The name in errors.
    pub name: String,
    /// What is held.
    pub support: Support,
    /// The forces, `[points · dimension]`, N.
    pub forces: Vec<f64>,
}

/// The energies of the laws of a body with these materials.
pub type Laws<'a> = dyn Fn(&Mesh, &MaterialMap) -> Result<EnergyMap> + Sync + 'a;

/// A mesh of the body with its loads.
pub struct Level<'a> {
    /// The mesh.
    pub mesh: Mesh,
    /// The first guess of the materials, with the regions.
    pub materials: MaterialMap,
    /// The cell of the first mesh that has each cell, by block; empty where no unknowns are those of cells.
    pub owners: Vec<Vec<usize>>,
    /// The loads.
    pub loads: Vec<LoadCase>,
    /// The places of displacements in its cells.
    pub places: Embedding,
    /// The points of the parts that are held by measured forces.
    pub parts: Vec<Vec<usize>>,
    /// How linear equations are solved.
    pub solver: StaticSolver,
    /// The laws at large deformation, and how loads are followed.
    pub large: Option<(&'a Laws<'a>, Newton)>,
    /// The patterns of the equations under each support, which no moduli change.
    patterns: KnownPatterns,
    /// The last displacements, from which the next equilibria are searched.
    guesses: Mutex<Vec<Option<Vec<f64>>>>,
}

/// What a mesh answers to all loads at θ.
pub(super) struct Answer {
    /// The values of the observations.
    pub values: Vec<f64>,
    /// Their derivatives, `[unknowns][observations]`, if they were asked for.
    pub columns: Vec<Vec<f64>>,
}

/// Loads under one support are solved with one factor; the way to solve is chosen for so many.
// Up to 60 loads leave the bound of the levels in space at 15 000 unknowns (`method.rs`); in the plane 50 raise it from
// 50 000 to 62 500.
const SOLUTIONS: usize = 50;
/// More unknowns are differentiated by one solution for each observed quantity. Both ways give the same derivatives:
/// one takes a solution for each unknown, the other one for each quantity.
// A search for 200 unknowns from 178 quantities under six loads takes half as long again by solutions for each unknown.
const FORWARD: usize = 40;
/// The relative error of derivatives where equations are solved by iterations.
// The moduli of two halves of a bar have eleven digits then. With 1e-3 they change by 2e-7, and a search takes a tenth
// less time.
const PRODUCT: f64 = 1e-7;
/// The change of θ over which forces of laws are differentiated. Central differences err by its square, and the
/// rounding of forces over it is 1e-12.
const STEP: f64 = 1e-4;

impl<'a> Level<'a> {
    /// A mesh whose equilibria have not been searched yet.
    #[expect(clippy::too_many_arguments, reason = "each is one fact of the mesh")]
    pub fn new(
        mesh: Mesh,
        materials: MaterialMap,
        owners: Vec<Vec<usize>>,
        loads: Vec<LoadCase>,
        places: Embedding,
        parts: Vec<Vec<usize>>,
        solver: StaticSolver,
        large: Option<(&'a Laws<'a>, Newton)>,
    ) -> Level<'a> {
        let guesses = Mutex::new(vec![None; loads.len()]);
        let patterns = KnownPatterns::default();
        Level { mesh, materials, owners, loads, places, parts, solver, large, patterns, guesses }
    }

    /// What the finite elements answer at θ; `None` if a load has no stable equilibrium there.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub(super) fn answer(
        &self,
        unknowns: &Unknowns,
        observations: &[Observation],
        theta: &[f64],
        derived: bool,
    ) -> Result<Option<Answer>> {
        // Materials beyond their range are no point of the search.
        let Ok(materials) = unknowns.materials(&self.mesh, &self.materials, &self.owners, theta) else {
            return Ok(None);
        };
        let mut values = vec![0.0; observations.len()];
        let mut columns =
            vec![vec![0.0; if derived { observations.len() } else { 0 }]; if derived { theta.len() } else { 0 }];
        let groups = match self.large {
            None => self.small(&materials)?,
            Some((laws, newton)) => self.followed(&laws(&self.mesh, &materials)?, newton)?,
        };
        let Some(groups) = groups else { return Ok(None) };
        for Solved { loads, equations, displacements, internal } in &groups {
            let own: Vec<usize> = (0..observations.len()).filter(|&i| loads.contains(&observations[i].load)).collect();
            let moved: Vec<Vec<f64>> = displacements.iter().map(|u| self.places.interpolate(u)).collect();
            let place = |i: usize| loads.iter().position(|&l| l == observations[i].load).unwrap_or(0);
            for &i in &own {
                values[i] = self.seen(observations[i].quantity, &moved[place(i)], &internal[place(i)]);
            }
            if !derived || own.is_empty() {
                continue;
            }
            let at = Point { unknowns, materials: &materials, theta, equations };
            // The forces of cells by which the other way goes are those of small deformation.
            if theta.len() <= FORWARD || self.large.is_some() {
                self.forward(&at, displacements, (observations, &own, &place), &mut columns)?;
            } else {
                self.adjoint(&at, displacements, (observations, &own, &place), &mut columns)?;
            }
        }
        Ok(Some(Answer { values, columns }))
    }

    /// The value of a quantity with these displacements of places and forces of the body.
    fn seen(&self, quantity: Quantity, moved: &[f64], internal: &[f64]) -> f64 {
        let d = self.mesh.dimension;
        match quantity {
            Quantity::Displacement { place, axis } => moved[place * d + axis],
            Quantity::Force { part, axis } => self.parts[part].iter().map(|p| internal[p * d + axis]).sum(),
        }
    }

    fn small(&self, materials: &MaterialMap) -> Result<Option<Vec<Solved>>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, load) in self.loads.iter().enumerate() {
            // All loads under a support have one factor.
            match groups.iter_mut().find(|group| self.loads[group[0]].support == load.support) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        let moduli = materials.moduli();
        let mut all = Vec::new();
        for loads in groups {
            let support = &self.loads[loads[0]].support;
            let found = Equations::of_body(&self.mesh, &moduli, support, (self.solver, SOLUTIONS), &self.patterns)?;
            let Some(equations) = found else { return Ok(None) };
            let forces: Vec<Vec<f64>> = loads.iter().map(|&l| self.loads[l].forces.clone()).collect();
            let displacements = equations.solve_all(&forces)?;
            let internal = self.internal(materials, &displacements);
            all.push(Solved { loads, equations, displacements, internal });
        }
        Ok(Some(all))
    }

    /// `K u` of each of several displacements, N; empty where no forces were measured.
    fn internal(&self, materials: &MaterialMap, displacements: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut all: Vec<Vec<f64>> = displacements.iter().map(|u| vec![0.0; u.len()]).collect();
        if self.parts.is_empty() {
            return all;
        }
        let moduli = materials.moduli();
        let u: Vec<&[f64]> = displacements.iter().map(|u| &u[..]).collect();
        let own = |cell: CellIndex| vec![moduli.at(cell.block, cell.cell).clone()];
        each_cell_forces(&self.mesh, &u, &own, &mut |_, nodes, forces| {
            for (sum, own) in all.iter_mut().zip(&forces[0]) {
                self.add(sum, nodes, own, 1.0);
            }
        });
        all
    }

    fn add(&self, sum: &mut [f64], nodes: &[usize], own: &[f64], factor: f64) {
        let d = self.mesh.dimension;
        for (a, own) in nodes.iter().zip(own.chunks_exact(d)) {
            sum[a * d..(a + 1) * d].iter_mut().zip(own).for_each(|(sum, f)| *sum += factor * f);
        }
    }

    fn followed(&self, laws: &EnergyMap, newton: Newton) -> Result<Option<Vec<Solved>>> {
        let model = Body::new(&self.mesh, laws);
        let Some(rest) = model.respond(&self.mesh.points) else { return Ok(None) };
        // Copied, so that the lock is free while loads are followed.
        let guesses = self.guesses.lock().expect("nothing panics while it holds the guesses").clone();
        let mut all = Vec::new();
        for (index, load) in self.loads.iter().enumerate() {
            let (points, guess) = (&self.mesh.points, guesses[index].as_deref());
            let pattern = self.patterns.of_steps(&rest.tangent, &load.support, points, self.mesh.dimension)?;
            let found = newton.reach_stable(&model, points, &load.support, &load.forces, guess, &pattern)?;
            let Some((u, equations)) = found else { return Ok(None) };
            let mut force = vec![0.0; u.len()];
            if !model.forces(&displaced(points, &u), &mut force) {
                return Ok(None);
            }
            // Each load has a tangent of its own.
            all.push(Solved { loads: vec![index], equations, displacements: vec![u], internal: vec![force] });
        }
        let mut guesses = self.guesses.lock().expect("nothing panics while it holds the guesses");
        // Written once all loads have an equilibrium: a θ that is refused leaves the guesses of the one before.
        guesses.iter_mut().zip(&all).for_each(|(guess, solved)| *guess = Some(solved.displacements[0].clone()));
        Ok(Some(all))
    }

    /// `(∂K/∂θ_p) u` of every unknown and each of several displacements, `[unknowns][displacements]`.
    fn changes(&self, at: &Point, displacements: &[Vec<f64>]) -> Result<Vec<Vec<Vec<f64>>>> {
        let empty = || displacements.iter().map(|u| vec![0.0; u.len()]).collect();
        let mut all: Vec<Vec<Vec<f64>>> = at.theta.iter().map(|_| empty()).collect();
        if let Some((laws, _)) = self.large {
            for (p, own) in all.iter_mut().enumerate() {
                let mut beside = [vec![0.0; displacements[0].len()], vec![0.0; displacements[0].len()]];
                for (force, step) in beside.iter_mut().zip([STEP, -STEP]) {
                    let mut theta = at.theta.to_vec();
                    theta[p] += step;
                    let materials = at.unknowns.materials(&self.mesh, &self.materials, &self.owners, &theta)?;
                    let laws = laws(&self.mesh, &materials)?;
                    if !Body::new(&self.mesh, &laws).forces(&displaced(&self.mesh.points, &displacements[0]), force) {
                        return Err(Error::expected("load", "an equilibrium", "none"));
                    }
                }
                let [more, less] = beside;
                own[0] = more.iter().zip(&less).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
            }
            return Ok(all);
        }
        let u: Vec<&[f64]> = displacements.iter().map(|u| &u[..]).collect();
        let moduli = |cell: CellIndex| self.cell_changes(at, cell).into_iter().map(|(_, hooke)| hooke).collect();
        each_cell_forces(&self.mesh, &u, &moduli, &mut |cell, nodes, forces| {
            for ((p, _), forces) in self.cell_changes(at, cell).iter().zip(forces) {
                for (sum, own) in all[*p].iter_mut().zip(forces) {
                    self.add(sum, nodes, own, 1.0);
                }
            }
        });
        Ok(all)
    }

    fn cell_changes(&self, at: &Point, CellIndex { block, cell }: CellIndex) -> Vec<(usize, crate::material::Hooke)> {
        let Some(material) = at.materials.isotropic(block, cell) else { return Vec::new() };
        let owner = self.owners.get(block).map_or(0, |own| own[cell]);
        at.unknowns.changes(&material, *self.materials.region().at(block, cell), owner)
    }

    /// One solution for each unknown and load.
    fn forward(&self, at: &Point, displacements: &[Vec<f64>], seen: Seen, columns: &mut [Vec<f64>]) -> Result<()> {
        let (observations, own, place) = seen;
        let changes = self.changes(at, displacements)?;
        // From `K u = f` with a load that stays follows `K du = −dK u`.
        let pushes: Vec<Vec<f64>> = changes.concat().into_iter().map(|f| f.into_iter().map(|f| -f).collect()).collect();
        let moves = at.equations.respond_all(&pushes, PRODUCT)?;
        let count = displacements.len();
        for (p, moves) in moves.chunks_exact(count).enumerate() {
            let moved: Vec<Vec<f64>> = moves.iter().map(|u| self.places.interpolate(u)).collect();
            // The forces of the body take a pass over all cells, which displacements alone do not need.
            let held = match own.iter().any(|&i| observations[i].quantity.is_force()) {
                true => self.tangent_forces(at, displacements, moves, &changes[p])?,
                false => vec![Vec::new(); count],
            };
            for &i in own {
                columns[p][i] = self.seen(observations[i].quantity, &moved[place(i)], &held[place(i)]);
            }
        }
        Ok(())
    }

    /// `K du + (∂K/∂θ) u`, the change of the forces of the body.
    fn tangent_forces(
        &self,
        at: &Point,
        displacements: &[Vec<f64>],
        moves: &[Vec<f64>],
        changes: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>> {
        let mut all = match self.large {
            None => self.internal(at.materials, moves),
            Some((laws, _)) => {
                let laws = laws(&self.mesh, at.materials)?;
                let Some(response) =
                    Body::new(&self.mesh, &laws).respond(&displaced(&self.mesh.points, &displacements[0]))
                else {
                    return Err(Error::expected("load", "an equilibrium", "none"));
                };
                let mut force = vec![0.0; moves[0].len()];
                for entry in &response.tangent {
                    force[entry.row] += entry.val * moves[0][entry.col];
                    if entry.row != entry.col {
                        force[entry.col] += entry.val * moves[0][entry.row];
                    }
                }
                vec![force]
            }
        };
        for (sum, own) in all.iter_mut().zip(changes) {
            sum.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
        }
        Ok(all)
    }

    /// One solution for each observed quantity, which all loads under a support share: `∂y/∂θ_p = (e − K⁻¹ b)ᵀ (∂K/∂θ_p) u`, with `b = P` and
    /// `e = 0` of a displacement, and `b = K e` of a force.
    fn adjoint(&self, at: &Point, displacements: &[Vec<f64>], seen: Seen, columns: &mut [Vec<f64>]) -> Result<()> {
        let (observations, own, place) = seen;
        let mut known: HashMap<Quantity, usize> = HashMap::new();
        let (mut directs, mut pulls) = (Vec::new(), Vec::new());
        let (d, size) = (self.mesh.dimension, self.mesh.points.len());
        for &i in own {
            // A place that several loads have in common has one solution.
            let next = known.len();
            if let std::collections::hash_map::Entry::Vacant(entry) = known.entry(observations[i].quantity) {
                entry.insert(next);
                let mut direct = vec![0.0; size];
                let pull = match observations[i].quantity {
                    Quantity::Displacement { place, axis } => {
                        let mut unit = vec![0.0; self.places.cells.len() * d];
                        unit[place * d + axis] = 1.0;
                        self.places.restrict(&unit)
                    }
                    Quantity::Force { part, axis } => {
                        self.parts[part].iter().for_each(|p| direct[p * d + axis] = 1.0);
                        self.internal(at.materials, std::slice::from_ref(&direct)).swap_remove(0)
                    }
                };
                directs.push(direct);
                pulls.push(pull);
            }
        }
        let mut adjoints = at.equations.respond_all(&pulls, PRODUCT)?;
        for (adjoint, direct) in adjoints.iter_mut().zip(&directs) {
            adjoint.iter_mut().zip(direct).for_each(|(a, e)| *a = e - *a);
        }
        let rows: Vec<(usize, usize, usize)> =
            own.iter().map(|&i| (i, known[&observations[i].quantity], place(i))).collect();
        let u: Vec<&[f64]> = displacements.iter().map(|u| &u[..]).collect();
        let moduli = |cell: CellIndex| self.cell_changes(at, cell).into_iter().map(|(_, hooke)| hooke).collect();
        each_cell_forces(&self.mesh, &u, &moduli, &mut |cell, nodes, forces| {
            for ((p, _), forces) in self.cell_changes(at, cell).iter().zip(forces) {
                for &(i, adjoint, load) in &rows {
                    let own = nodes.iter().zip(forces[load].chunks_exact(d));
                    let along = own.map(|(a, f)| {
                        adjoints[adjoint][a * d..(a + 1) * d].iter().zip(f).map(|(a, f)| a * f).sum::<f64>()
                    });
                    columns[*p][i] += along.sum::<f64>();
                }
            }
        });
        Ok(())
    }
}

/// Where the derivatives are taken.
struct Point<'a> {
    unknowns: &'a Unknowns,
    materials: &'a MaterialMap,
    theta: &'a [f64],
    equations: &'a Equations,
}

/// All observations, those under the loads of a support, and the place of the load of each among these.
type Seen<'a> = (&'a [Observation], &'a [usize], &'a dyn Fn(usize) -> usize);

/// The loads under one support.
struct Solved {
    loads: Vec<usize>,
    equations: Equations,
    /// The displacements under each load, `[points · dimension]`, m.
    displacements: Vec<Vec<f64>>,
    /// The forces of the body under each load, `[points · dimension]`, N; zero where none were measured.
    internal: Vec<Vec<f64>>,
}
