//! The nearest network without negative springs.

use super::balance::RestForces;
use super::contents::{Contents, tightened};
use super::edges::Edges;
use super::outcome::{PositiveOutcome, Route};
use super::programme::{Changes, Programme};
use super::quadratic::SearchProgress;
use super::vibrations::Vibrations;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::model::{Entries, LengthSpring, Network};

/// Constants below this share of the typical constant of their edge are zero.
// The search leaves constants near their bound, and a spring costs a file and a step as much as any. Without it the stiffness
// changes by a millionth, and forces at rest are balanced anew.
const ZERO: f64 = 1e-6;
/// Negative constants above minus this share are rounding errors.
// Constants are sums over the cells at an edge, whose terms cancel at right angles to some 1e-16 of their size.
const ROUNDING: f64 = 1e-12;

/// How the nearest network is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PositiveFit {
    /// Whether springs across the sides of simplices may be added if the others do not suffice.
    pub across: bool,
    /// The number of lowest modes whose energies should be kept.
    pub modes: usize,
}

impl Default for PositiveFit {
    fn default() -> PositiveFit {
        PositiveFit { across: false, modes: 10 }
    }
}

/// The network without negative springs that is nearest to the exact `network` of the mesh; the network itself if it
/// has none. `watch` is called with the progress of the search.
///
/// # Errors
/// The network has springs with a rest length, or springs on content with negative constants (kind `Unsupported`); only
/// the network without springs is in equilibrium at rest, the nearest network is not stable, or the solver fails (kind
/// `Infeasible`).
pub fn nearest_positive(
    mesh: &Mesh,
    network: &Network,
    fit: &PositiveFit,
    watch: &mut SearchProgress,
) -> Result<(Network, PositiveOutcome)> {
    check(mesh, network)?;
    if mesh.is_mixed() {
        let expected =
            "a body of cells of one dimension, of which the nearest network without negative springs is known";
        let found = "one with membranes or rods";
        return Err(Error::expected("nonnegative", expected, found).of_kind(ErrorKind::Unsupported));
    }
    let mut outcome = PositiveOutcome { tensions: [1.0; 2], ..PositiveOutcome::default() };
    outcome.negative = network.lengths.iter().filter(|s| s.constant < 0.0).count();
    if outcome.negative == 0 {
        return Ok((network.clone(), outcome));
    }
    let plain = Edges::new(mesh, &network.lengths, false)?;
    // In an exact network Σ k ℓ² is d μ V.
    let squares = || network.lengths.iter().map(|s| s.constant * length(mesh, s).powi(2));
    let modulus = squares().sum::<f64>() / (mesh.dimension as f64 * plain.volumes.iter().sum::<f64>());
    if !(modulus > 0.0 && modulus.is_finite()) {
        let expected = "a network whose springs pull more than they push";
        return Err(Error::expected("nonnegative", expected, format!("a mean modulus of {modulus:e} Pa")));
    }
    let none = Contents::default();
    network.check_size()?;
    let exact = network.stiffness(&mesh.points);
    let search = Search { mesh, network, modulus, exact: &exact };
    let programme = |edges| Programme { mesh, network, edges, contents: &none, modulus, modes: Vec::new() };
    let scales = programme(&plain);
    if (0..plain.len()).all(|edge| plain.constants[edge] >= -ROUNDING * scales.scale(edge)) {
        // Negative by rounding alone, as at right angles: no search is needed, but what is left out leaves a force of
        // that size.
        let mut constants: Vec<f64> = plain.constants.iter().map(|k| k.max(0.0)).collect();
        outcome.rest_force = RestForces::new(mesh, network, &plain, &none).correct(&mut constants, &mut [])?;
        let rounded = search.network(&plain, &constants, &none, &[])?;
        outcome.dropped = outcome.negative;
        return Ok((rounded, outcome));
    }
    let vibrations = Vibrations::new(mesh, &exact, modulus, fit.modes)?;
    let edges = if fit.across { Edges::new(mesh, &network.lengths, true)? } else { plain.clone() };
    // A law that is not known is an error only if tensions have to change, on the last route.
    let contents = Contents::new(mesh, network);
    // In the order of what they change: the first route with a solution is taken.
    let mut routes = vec![(Route::Springs, &plain, Ok(&none))];
    if fit.across {
        routes.push((Route::Across, &edges, Ok(&none)));
    }
    if !contents.as_ref().is_ok_and(|contents| contents.places.is_empty()) {
        routes.push((Route::Tensions, &edges, contents.as_ref()));
    }
    for (route, edges, contents) in routes {
        let contents = contents.map_err(Error::clone)?;
        if let Some(changes) = search.changes(edges, contents, &vibrations, watch)? {
            outcome.route = route;
            let network = search.finish(edges, contents, &vibrations, changes, &mut outcome)?;
            return Ok((network, outcome));
        }
    }
    let advice = match fit.across {
        true => "mesh the body with other cells, whose angles are less obtuse",
        false => "add springs across the sides of the cells, with across = true, or mesh the body with other cells",
    };
    let problem = format!("only the zero network is at rest without negative springs on this mesh: {advice}");
    Err(Error::at("nonnegative", problem).of_kind(ErrorKind::Infeasible))
}

/// The data that all searches share.
struct Search<'a> {
    mesh: &'a Mesh,
    network: &'a Network,
    /// A typical modulus, Pa.
    modulus: f64,
    /// The stiffness of the exact network.
    exact: &'a Entries,
}

impl Search<'_> {
    fn programme<'a>(&'a self, edges: &'a Edges, contents: &'a Contents, modes: Vec<Vec<f64>>) -> Programme<'a> {
        let Search { mesh, network, modulus, .. } = *self;
        Programme { mesh, network, edges, contents, modulus, modes }
    }

    /// `None` if there is no network without negative springs.
    fn changes(
        &self,
        edges: &Edges,
        contents: &Contents,
        vibrations: &Vibrations,
        watch: &mut SearchProgress,
    ) -> Result<Option<Changes>> {
        let d = self.mesh.dimension;
        let mode = |u: &Vec<f64>| {
            let stretch = |[i, j]: &[usize; 2]| (0..d).map(|k| (u[j * d + k] - u[i * d + k]).powi(2)).sum::<f64>();
            let energy = twice_energy(self.exact, u);
            let springs = edges.pairs.iter().map(stretch);
            springs.chain(contents.energies(self.mesh, self.network, u)).map(|share| share / energy).collect()
        };
        self.programme(edges, contents, vibrations.shapes.iter().map(mode).collect()).solve(watch)
    }

    /// The network with these changes, corrected to equilibrium, and its errors.
    fn finish(
        &self,
        edges: &Edges,
        contents: &Contents,
        vibrations: &Vibrations,
        changes: Changes,
        outcome: &mut PositiveOutcome,
    ) -> Result<Network> {
        let Search { mesh, network, .. } = *self;
        let programme = self.programme(edges, contents, Vec::new());
        let constant = |edge: usize| {
            let k = edges.constants[edge] + changes.constants[edge];
            if k > ZERO * programme.scale(edge) { k } else { 0.0 }
        };
        let mut constants: Vec<f64> = (0..edges.len()).map(constant).collect();
        let tension = |content: usize| {
            let spring = &network.others[contents.places[content]];
            spring.tension(contents.rests[content])
        };
        let before: Vec<f64> = (0..contents.places.len()).map(tension).collect();
        let mut tensions: Vec<f64> = before.iter().zip(&changes.tensions).map(|(t, change)| t + change).collect();
        outcome.rest_force = RestForces::new(mesh, network, edges, contents).correct(&mut constants, &mut tensions)?;
        outcome.iterations = changes.iterations;
        let more: Vec<f64> = tensions.iter().zip(&before).map(|(now, before)| now - before).collect();
        let nearest = self.network(edges, &constants, contents, &more)?;
        let shares = tensions.iter().zip(&before).map(|(now, before)| now / before);
        outcome.tensions = shares.fold(outcome.tensions, |[low, high], t| [low.min(t), high.max(t)]);
        let each = || constants.iter().zip(&edges.constants).zip(&edges.across);
        outcome.dropped = each().filter(|((k, before), _)| **k == 0.0 && **before != 0.0).count();
        outcome.across = each().filter(|((k, _), across)| **k > 0.0 && **across).count();
        let stiffness = nearest.stiffness(&mesh.points);
        let error = |u: &Vec<f64>| twice_energy(&stiffness, u) / twice_energy(self.exact, u) - 1.0;
        outcome.modes = vibrations.shapes.len();
        let modes = vibrations.shapes.iter().map(error);
        outcome.mode_errors = modes.fold(outcome.mode_errors, |[low, high], e| [low.min(e), high.max(e)]);
        // A flat surface has no energy in strains across it: 0/0.
        outcome.affine = affine(mesh).iter().map(error).filter(|e| e.is_finite()).fold(0.0, |a, e| a.max(e.abs()));
        if !vibrations.are_stable(mesh, &stiffness)? {
            let problem = "the nearest network without negative springs is not stable: mesh the body with other cells";
            return Err(Error::at("nonnegative", problem).of_kind(ErrorKind::Infeasible));
        }
        Ok(nearest)
    }

    /// The network with these constants and additional tensions.
    ///
    /// # Errors
    /// A spring on content loses its stiffness.
    fn network(&self, edges: &Edges, constants: &[f64], contents: &Contents, more: &[f64]) -> Result<Network> {
        let springs = edges.pairs.iter().zip(constants).filter(|(_, k)| **k > 0.0);
        let lengths = springs.map(|(points, k)| LengthSpring { points: *points, constant: *k, rest: 0.0 }).collect();
        let mut others = self.network.others.clone();
        for (content, more) in more.iter().enumerate() {
            let (place, rest) = (contents.places[content], contents.rests[content]);
            others[place] = tightened(&others[place], rest, *more).ok_or_else(|| {
                let problem = "a spring on content would have no stiffness: mesh the body with other cells";
                Error::at("nonnegative", problem).of_kind(ErrorKind::Infeasible)
            })?;
        }
        Ok(Network { dimension: self.network.dimension, lengths, others })
    }
}

/// Checks that the network has springs of rest length zero on the points of the mesh.
fn check(mesh: &Mesh, network: &Network) -> Result<()> {
    if network.dimension != mesh.dimension {
        return Err(Error::expected("network", format!("{} dimensions", mesh.dimension), network.dimension));
    }
    let count = mesh.point_count();
    let points = network.lengths.iter().map(|s| &s.points[..]).chain(network.others.iter().map(|s| &s.points[..]));
    if let Some(point) = points.flatten().find(|p| **p >= count) {
        return Err(Error::expected("network", format!("points below {count}"), point));
    }
    if let Some(spring) = network.lengths.iter().find(|s| s.rest != 0.0 || !s.constant.is_finite()) {
        let expected = "springs of rest length zero with finite constants, as objective = \"exact\" makes them";
        let found = format!("the constant {:e} N/m and the rest length {:e} m", spring.constant, spring.rest);
        return Err(Error::expected("network", expected, found));
    }
    if let Some(spring) = network.others.iter().find(|s| !(s.constant >= 0.0)) {
        let expected = "no spring below zero but those between two points, which alone can be changed";
        let found = format!("{:.4e} of a spring of the kind {}", spring.constant, spring.kind.name());
        return Err(Error::expected("nonnegative", expected, found).of_kind(ErrorKind::Unsupported));
    }
    Ok(())
}

fn length(mesh: &Mesh, spring: &LengthSpring) -> f64 {
    crate::springs::distance(mesh.point(spring.points[0]), mesh.point(spring.points[1]))
}

/// `uᵀ K u`.
fn twice_energy(stiffness: &Entries, u: &[f64]) -> f64 {
    // Entries are those of the lower triangle, so that those outside the diagonal count for both.
    let both = |row: usize, column: usize| if row == column { 1.0 } else { 2.0 };
    stiffness.iter().map(|e| both(e.row, e.col) * e.val * u[e.row] * u[e.col]).sum()
}

/// The displacements of homogeneous strains, `[fields][points × dimension]`.
fn affine(mesh: &Mesh) -> Vec<Vec<f64>> {
    let d = mesh.dimension;
    let field = |i: usize, j: usize| {
        let mut u = vec![0.0; mesh.points.len()];
        for (u, x) in u.chunks_exact_mut(d).zip(mesh.points.chunks_exact(d)) {
            // Symmetric gradients alone, because a rotation has no energy to compare.
            u[i] += x[j];
            u[j] += x[i];
        }
        u
    };
    (0..d).flat_map(|i| (i..d).map(move |j| (i, j))).map(|(i, j)| field(i, j)).collect()
}
