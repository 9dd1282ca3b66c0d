//! Where a held network comes to rest under the gravity and the loads that are exported, before another program moves it.
//!
//! Page of the book: *Networks in other programs*.

use super::job::spatial;
use super::target::{Stands, Target};
use nalgebra::DMatrix;
use springfit_bodies::model::{Network, Support};
use springfit_bodies::solve::{Ending, Newton, System, factor_cost_of, is_definite};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_numerics::dense::singular;
use springfit_report::report::{NetworkRecord, NodalLoadRecord, Parts, of_locking};

/// A spring of [`Stands::SquaredLengths`] pushes with `k/(2 L²) (L² − l²) l`, at most 0.192 k L, at `l = L/√3`. A spring of the network
/// pushes as much at this share of its length; pressed further, cells of such a program give way until they are flat.
const PRESSED: f64 = 0.808;
/// Beyond this strain the two energies differ by more than a tenth: their ratio is `(1 + s/2)²`.
const UNLIKE: f64 = 0.1;

/// Equilibria that take more operations, together some seconds, are not solved.
const MOST_OPERATIONS: f64 = 6e10;
/// Factors of an equilibrium at large deformation.
const FACTORS: f64 = 12.0;
/// More points are not even counted: their analysis alone would be noticed.
const MOST_POINTS: usize = 40_000;
/// The share of the largest diagonal entry of the stiffness by which motions without resistance are told from those
/// that release energy. It is beyond the rounding of the factor, and below what any spring resists.
const SHIFT: f64 = 1e-9;
/// Displacements below this share of the body are those of the linear theory.
// The theory omits squares of strains and rotations, which are far below the two digits of a stretch that are told.
const SMALL: f64 = 1e-3;
/// How exactly forces balance. Stretches are told with four digits, and fewer iterations take less of the seconds that
/// an export may take.
const TOLERANCE: f64 = 1e-8;

/// The stretches at rest; or the share of the forces beyond which no equilibrium was found.
type Reached = std::result::Result<Stretches, f64>;

/// The stretches of a body at rest.
struct Stretches {
    /// The least and the largest principal stretch of simplices; of other bodies the length of springs over that in the mesh.
    least: f64,
    largest: f64,
    /// Cells that are inside out, and all that were looked at.
    inverted: usize,
    simplices: usize,
}

impl Target {
    /// What a reader must know of the body at rest under the exported gravity, and under each load beside it, in sentences: that the network is not
    /// stable, that no equilibrium was found, that it is deformed beyond what the program moves as the network would. Bodies that are
    /// not held are not solved, and neither are those that would take more than some seconds; of the latter a sentence says so. First is whether
    /// the program ends its sweeps too early for the constants, and whether the cells of the fit lock.
    ///
    /// # Errors
    /// Cells turn inside out under gravity alone; kind `Unsupported`.
    pub fn at_rest(&self, network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<String>> {
        let name = network.provenance.fit.as_ref().map_or("", |fit| &fit.name);
        let locks = of_locking(name, &network.notes).map(str::to_string);
        Ok(self.is_softer(network).into_iter().chain(locks).chain(self.solved(network, gravity)?).collect())
    }

    /// What the equilibria of the network tell.
    fn solved(&self, network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<String>> {
        let (Some(masses), Ok(parts)) = (&network.masses, Parts::of(network)) else { return Ok(Vec::new()) };
        if self.stands == Stands::Still {
            return Ok(Vec::new());
        }
        let d = network.dimension;
        let gravity = spatial(gravity, network);
        let weight: Vec<f64> = masses.iter().flat_map(|m| gravity[..d].iter().map(move |g| m * g)).collect();
        let loads = if self.has_loads { &network.loads[..] } else { &[] };
        let mut cases = cases(d, weight, loads);
        let points: Vec<f64> = network.points.concat();
        let affordable = affordable(&points, d, &parts);
        let left: Vec<&str> = cases.iter().skip(affordable).map(|case| &*case.words).collect();
        let unknown = (!left.is_empty() && !network.held.is_empty()).then(|| {
            format!(
                "whether the cells stand it is not known {}: to solve the body takes more than {MOST_OPERATIONS:.0e} operations",
                left.join(", ")
            )
        });
        cases.truncate(affordable);
        let body = Body { network: parts.network(d), record: network, points, support: support(network) };
        let resists = affordable > 0 && body.resists(0.0)?;
        if affordable > 0 && !resists && !body.resists(SHIFT)? {
            return Ok(vec![format!(
                "the network is not stable: a motion from rest releases energy and grows, in any program; {} of its {} springs are negative, and \
                 nonnegative = true has none of them",
                body.network.negative(),
                body.network.len()
            )]);
        }
        let mut found = Vec::new();
        if !network.held.is_empty() && resists {
            for case in &cases {
                found.push((&*case.words, body.at_rest(case)?));
            }
        }
        Ok(self.sentences(&found).into_iter().chain(unknown).collect())
    }

    /// What is to be said of the stretches under each case, or of the share of its load beyond which no equilibrium was found.
    fn sentences(&self, found: &[(&str, Reached)]) -> Vec<String> {
        let mut sentences = Vec::new();
        for (words, stretches) in found {
            match stretches {
                Err(share) => sentences.push(format!(
                    "no equilibrium of the network was found {words} beyond {:.0} % of the load: it may collapse",
                    100.0 * share
                )),
                Ok(Stretches { inverted, simplices, .. }) if *inverted > 0 => {
                    sentences.push(format!("{inverted} of {simplices} cells are inside out at rest {words}"));
                }
                Ok(_) => {}
            }
        }
        if self.stands == Stands::SquaredLengths {
            let known = found.iter().filter_map(|(words, stretches)| Some((words, stretches.as_ref().ok()?)));
            let known = known.filter(|(_, s)| s.inverted == 0);
            let told = known.filter(|(_, s)| s.least < 1.0 - UNLIKE || s.largest > 1.0 + UNLIKE);
            let (mut least, mut lines) = (f64::INFINITY, Vec::new());
            for (words, stretches) in told {
                least = least.min(stretches.least);
                lines.push(format!("by {:.2} to {:.2} {words}", stretches.least, stretches.largest));
            }
            let ending = if least < PRESSED {
                format!(
                    "below {PRESSED:.2} springs whose energy is quadratic in squared lengths give way, and cells turn flat or inside out"
                )
            } else {
                "an energy that is quadratic in squared lengths is another one there".into()
            };
            if !lines.is_empty() {
                let stretched = lines.join(", ");
                sentences.push(format!(
                    "at rest the network is stretched {stretched}: {ending}; --to newton has the network's own energy"
                ));
            }
        }
        sentences
    }
}

/// What acts on the body at rest.
pub(super) struct Case {
    pub words: String,
    /// `[points × dimension]`, N.
    pub forces: Vec<f64>,
    /// Gravity alone, which the program always has.
    is_weight: bool,
}

/// Gravity, unless it is zero, and each load of forces beside it.
pub(super) fn cases(d: usize, weight: Vec<f64>, loads: &[NodalLoadRecord]) -> Vec<Case> {
    let pulls = weight.iter().any(|f| *f != 0.0);
    let moves =
        |load: &&NodalLoadRecord| load.held.iter().any(|held| held.displacement.iter().flatten().any(|u| *u != 0.0));
    let of_load = |load: &NodalLoadRecord| {
        let mut forces = weight.clone();
        for force in &load.forces {
            forces[force.point * d..][..d].iter_mut().zip(&force.force).for_each(|(all, own)| *all += own);
        }
        let gravity = if pulls { "gravity and " } else { "" };
        Case { words: format!("under {gravity}the load \"{}\"", load.name), forces, is_weight: false }
    };
    let loads = loads.iter().filter(|load| !moves(load)).map(of_load);
    let own = pulls.then(|| Case { words: "under gravity".into(), forces: weight.clone(), is_weight: true });
    own.into_iter().chain(loads).collect()
}

/// The number of equilibria that are solved in some seconds.
pub(super) fn affordable(points: &[f64], dimension: usize, parts: &Parts) -> usize {
    if points.len() > MOST_POINTS * dimension {
        return 0;
    }
    let couples = parts.lengths.iter().map(|part| &part.points[..]);
    let coupled = couples.chain(parts.contents.iter().map(|part| &part.points[..]));
    let factor = factor_cost_of(points, dimension, coupled).map_or(f64::INFINITY, |cost| cost.operations);
    // An unknown cost is infinite, and the quotient zero.
    (MOST_OPERATIONS / (FACTORS * factor.max(1.0))) as usize
}

/// A network with its supports.
struct Body<'a> {
    network: Network,
    record: &'a NetworkRecord,
    points: Vec<f64>,
    support: Support,
}

impl Body<'_> {
    /// Whether the network resists all motions from rest, or, with a share beyond rounding, releases energy in none ([`is_definite`]).
    fn resists(&self, share: f64) -> Result<bool> {
        is_definite(&self.network.stiffness(&self.points), &self.support, share)
    }

    /// The stretches at rest under a case.
    ///
    /// # Errors
    /// Cells turn inside out under gravity alone.
    fn at_rest(&self, case: &Case) -> Result<Reached> {
        let newton = Newton { tolerance: TOLERANCE, ..Newton::default() };
        let found = newton.solve(&self.network, &self.points, &self.support, &case.forces)?;
        let displacement = match found.ending {
            Ending::Converged => found.displacement,
            // Rounding errors of stiff springs may hide the forces of a small motion, which linear equations know.
            Ending::Stalled => match self.small_motion(case)? {
                Some(displacement) => displacement,
                None => return Ok(Err(found.load)),
            },
        };
        let stretches = self.stretches(&displacement);
        if stretches.inverted > 0 && case.is_weight {
            let expected = "a body whose cells stand their weight";
            let found = format!("{} of {} cells inside out at rest", stretches.inverted, stretches.simplices);
            let advice =
                "; a stiffer material, a larger part that is held, or less gravity stand: --gravity \"0 0 0\" has none";
            return Err(Error::expected("--gravity", expected, found)
                .followed_by(advice)
                .of_kind(ErrorKind::Unsupported));
        }
        Ok(Ok(stretches))
    }

    /// The displacements by linear equations under a case, m, if they are small and the network resists.
    fn small_motion(&self, case: &Case) -> Result<Option<Vec<f64>>> {
        let system = System::new(&self.network.stiffness(&self.points), &self.support)?;
        let Some(factor) = system.cholesky()? else { return Ok(None) };
        let (displacement, _) = system.solve(&factor, &case.forces);
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        // The size of the body is that of its offsets from one of its points, wherever it lies.
        let first = &self.points[..self.network.dimension];
        let offsets: Vec<f64> =
            self.points.chunks_exact(first.len()).flat_map(|x| x.iter().zip(first).map(|(x, o)| x - o)).collect();
        Ok((largest(&displacement) <= SMALL * largest(&offsets)).then_some(displacement))
    }

    /// The stretches under the displacements u. In a simplex `F = (x_a − x_0) (X_a − X_0)⁻¹`, and its singular values are the stretches.
    fn stretches(&self, u: &[f64]) -> Stretches {
        let d = self.network.dimension;
        let moved: Vec<f64> = self.points.iter().zip(u).map(|(x, u)| x + u).collect();
        let mut found = Stretches { least: f64::INFINITY, largest: 0.0, inverted: 0, simplices: 0 };
        let edges =
            |x: &[f64], cell: &[usize]| DMatrix::from_fn(d, d, |k, a| x[cell[a + 1] * d + k] - x[cell[0] * d + k]);
        let cells = self.record.cells.iter().flat_map(|block| &block.points);
        for cell in cells.filter(|cell| cell.len() == d + 1) {
            // A cell that is flat in the mesh has no deformation gradient.
            let Some(inverse) = edges(&self.points, cell).try_inverse() else { continue };
            let gradient = edges(&moved, cell) * inverse;
            found.simplices += 1;
            // A cell whose determinant is NaN counts as inside out.
            found.inverted += usize::from(!(gradient.determinant() > 0.0));
            let Some(singular) = singular(gradient) else { continue };
            found.least = found.least.min(singular.values.min());
            found.largest = found.largest.max(singular.values.max());
        }
        if found.simplices == 0 {
            let length = |x: &[f64], [a, b]: [usize; 2]| {
                (0..d).map(|k| (x[a * d + k] - x[b * d + k]).powi(2)).sum::<f64>().sqrt()
            };
            for spring in &self.network.lengths {
                let stretch = length(&moved, spring.points) / length(&self.points, spring.points);
                found.least = found.least.min(stretch);
                found.largest = found.largest.max(stretch);
            }
        }
        found
    }
}

pub(super) fn support(network: &NetworkRecord) -> Support {
    let d = network.dimension;
    let mut prescribed = vec![None; network.points.len() * d];
    for held in &network.held {
        prescribed[held.point * d..][..d].iter_mut().zip(&held.displacement).for_each(|(all, own)| *all = *own);
    }
    Support { prescribed }
}
