//! Storage and loss moduli of the finite elements and the networks of a scene.
//!
//! Theory: page *Springs that forget* of the book.

use super::motion::Planned;
use super::relaxing::{Relaxing, RelaxingStiffness, Share};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, Hooke, Material, Moduli, State};
use crate::mesh::Mesh;
use crate::model::{Elastic, Entries, LinearElastic, Moments, Support, check_body, finite_elements};
use crate::outcome::{ComplexModulus, DynamicModuli, DynamicModuliOfModel, DynamicModuliOutcome, Outcome};
use crate::own_name::BODY;
use crate::progress::{Event, Progress};
use crate::scene::{DampingRecipe, MotionRecipe};
use crate::solve::Harmonic;
use crate::springs::{cross, norm};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The parts of a stiffness that resists harmonic strains, each with its coefficient at the frequency ω, rad/s.
type Parts = Vec<(Entries, Coefficient)>;
type Coefficient = Box<dyn Fn(f64) -> Complex<f64>>;

/// The moduli at these frequencies, Hz, of what relaxes and is damped so.
///
/// A body on whose whole surface a stress σ acts, without supports, has forces `f = ∫ Bᵀ σ dV` on its points; they do the work `f·u = V σ:ε` with the mean
/// strain ε. With `u` of `Σ_p c_p(ω) K_p u = f`, a tension has the modulus `V/(f·u)`, and so have a shear and an even pressure.
///
/// # Errors
/// The cells do not fill their space, a network does not relax so, or the equations do not fit into memory.
pub(super) fn dynamic_moduli(
    frequencies: &[f64],
    (relaxing, planned): (Option<&Relaxing>, Option<&Planned>),
    outcome: &Outcome,
    progress: &mut Progress,
) -> Result<DynamicModuliOutcome> {
    let (mesh, material) = (&outcome.mesh, &outcome.material);
    if mesh.cell_dimension() != mesh.dimension || mesh.dimension < 2 || mesh.is_mixed() {
        let found = match mesh.is_mixed() {
            true => "cells of several dimensions".into(),
            false => format!("cells of {} dimensions in a space of {}", mesh.cell_dimension(), mesh.dimension),
        };
        let expected = "cells that fill a plane or a space";
        return Err(Error::expected("dynamic_moduli", expected, found).of_kind(ErrorKind::Unsupported));
    }
    let recipe = planned.map(|planned| &planned.recipe);
    let uniform = |entries: Entries| vec![RelaxingStiffness { entries, share: Share::Elastic }];
    let stress = Stresses::of(mesh, outcome);
    let mut models = Vec::new();
    let count = outcome.fits.len() + 1;
    progress(Event::stage("dynamic moduli", 0, count));
    let is_of_springs = recipe.is_some_and(|recipe| matches!(recipe.damping, DampingRecipe::Ratio(_)));
    // Dampers of a ratio lie along springs, which the finite elements do not have.
    if !is_of_springs {
        check_body(mesh)?;
        let parts = match relaxing {
            Some(relaxing) => relaxing.harmonic_of_body(mesh)?,
            None => uniform(finite_elements(mesh, material.moduli())),
        };
        let parts = damped(parts, relaxing, recipe);
        models.push(of_model(BODY, parts.len(), parts, mesh, &stress, frequencies)?);
    }
    for (done, fit) in outcome.fits.iter().enumerate() {
        progress(Event::stage("dynamic moduli", done + 1, count));
        fit.network.check_size()?;
        let parts = match relaxing {
            Some(relaxing) => relaxing.harmonic_of_network(mesh, &fit.fit, &fit.network)?,
            None => uniform(fit.network.stiffness(&mesh.points)),
        };
        let stiff = parts.len();
        let mut parts = damped(parts, relaxing, recipe);
        if let Some(planned) = planned.filter(|_| is_of_springs) {
            let masses = fit.masses().unwrap_or(&planned.masses);
            let damping = planned.damping(Some((&fit.network, masses)), mesh)?;
            let matrix = damping.dampers.map(|dampers| dampers.matrix(&mesh.points));
            parts.extend(matrix.map(|matrix| {
                let rate: Coefficient = Box::new(|w| Complex::new(0.0, w));
                (matrix, rate)
            }));
        }
        models.push(of_model(&fit.fit.name, stiff, parts, mesh, &stress, frequencies)?);
    }
    let own = material.uniform().filter(|_| !is_of_springs && relaxing.is_none_or(Relaxing::is_uniform));
    let material = own.map(|own| of_material(own, relaxing, recipe, frequencies));
    Ok(DynamicModuliOutcome { frequency: frequencies.to_vec(), material, models })
}

/// Rayleigh's β, s.
fn beta(recipe: Option<&MotionRecipe>) -> f64 {
    match recipe.map(|recipe| recipe.damping) {
        Some(DampingRecipe::Rayleigh([_, stiffness])) => stiffness,
        Some(DampingRecipe::Ratio(_)) | None => 0.0,
    }
}

/// The coefficient of a part: what is left of it by relaxation, and what it loses by Rayleigh's β.
fn coefficient(share: Share, relaxing: Option<&Relaxing>, beta: f64, w: f64) -> Complex<f64> {
    relaxing.map_or(Complex::new(1.0, w * beta), |relaxing| relaxing.harmonic(share, beta, w))
}

fn damped(parts: Vec<RelaxingStiffness>, relaxing: Option<&Relaxing>, recipe: Option<&MotionRecipe>) -> Parts {
    let beta = beta(recipe);
    let part = |RelaxingStiffness { entries, share }: RelaxingStiffness| {
        let relaxing = relaxing.cloned();
        let of: Coefficient = Box::new(move |w| coefficient(share, relaxing.as_ref(), beta, w));
        (entries, of)
    };
    parts.into_iter().map(part).collect()
}

/// The forces of unit stresses on a body, and how it is held against rigid motions, which these forces do not drive.
struct Stresses {
    support: Support,
    /// The forces of a tension along each axis, then of a shear of each pair of axes, `[stresses][points · dimension]`, N/Pa.
    forces: Vec<Vec<f64>>,
    /// The volume of the body, m³.
    volume: f64,
}

impl Stresses {
    fn of(mesh: &Mesh, outcome: &Outcome) -> Stresses {
        let d = mesh.dimension;
        let thicknesses = outcome.material.thicknesses();
        // With λ = 0 and 2 μ = 1 the stress is the strain.
        let unit = thicknesses.map(|thickness| Hooke::Isotropic(Moduli { lambda: 0.0, mu: thickness / 2.0 }));
        let stiffness = finite_elements(mesh, unit);
        // Forces are those of positions, of which displacements are the difference from these.
        let still = vec![0.0; mesh.points.len()];
        let body = LinearElastic { points: &still, stiffness };
        let forces = |(k, l): (usize, usize)| {
            let strained = |(dof, _): (usize, &f64)| {
                let at = |axis: usize| mesh.points[dof - dof % d + axis] - mesh.points[axis];
                let of = |row: usize, column: usize| if dof % d == row { at(column) } else { 0.0 };
                if k == l { of(k, k) } else { of(k, l) + of(l, k) }
            };
            let u: Vec<f64> = mesh.points.iter().enumerate().map(strained).collect();
            let mut force = vec![0.0; u.len()];
            body.forces(&u, &mut force);
            force
        };
        let pairs = (0..d).flat_map(|k| (k + 1..d).map(move |l| (k, l)));
        let forces = (0..d).map(|k| (k, k)).chain(pairs).map(forces).collect();
        let volume = Moments::of_body(mesh, CellMap::Uniform(1.0), thicknesses).mass;
        Stresses { support: without_rigid_motions(mesh), forces, volume }
    }
}

/// Each piece held at three points against rigid motions alone.
fn without_rigid_motions(mesh: &Mesh) -> Support {
    let d = mesh.dimension;
    let mut support = Support { prescribed: vec![None; mesh.points.len()] };
    let at = |p: usize| -> [f64; 3] { std::array::from_fn(|k| if k < d { mesh.points[p * d + k] } else { 0.0 }) };
    for piece in mesh.pieces() {
        let Some(&first) = piece.first() else { continue };
        let from = |p: usize| -> [f64; 3] { std::array::from_fn(|k| at(p)[k] - at(first)[k]) };
        let farthest = |size: &dyn Fn(usize) -> f64| {
            piece.iter().copied().max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(first)
        };
        let largest = |x: [f64; 3]| (0..3).max_by(|&a, &b| x[a].abs().total_cmp(&x[b].abs())).unwrap_or(0);
        let second = farthest(&|p| norm(&from(p)));
        // The second point is free along the axis nearest to the line from the first alone, where no rigid motion takes it; the body could then turn about
        // this line, against which the third point is held.
        let along = largest(from(second));
        support.fix(&[first], &(0..d).collect::<Vec<_>>(), d);
        support.fix(&[second], &(0..d).filter(|k| *k != along).collect::<Vec<_>>(), d);
        if d == 3 {
            let arm = |p: usize| cross(from(second), from(p));
            let third = farthest(&|p| norm(&arm(p)));
            support.fix(&[third], &[largest(arm(third))], d);
        }
    }
    support
}

/// The moduli of a model of these parts, of which the first `stiff` resist at rest.
fn of_model(
    name: &str,
    stiff: usize,
    parts: Parts,
    mesh: &Mesh,
    stress: &Stresses,
    frequencies: &[f64],
) -> Result<DynamicModuliOfModel> {
    let without = |reason: String| DynamicModuliOfModel { name: name.into(), moduli: None, reason: Some(reason) };
    let (entries, coefficients): (Vec<Entries>, Vec<_>) = parts.into_iter().unzip();
    let harmonic = Harmonic::new(&entries, stiff, &stress.support, &mesh.points, mesh.dimension)?;
    let Some(harmonic) = harmonic else {
        return Ok(without("some strain meets no resistance, so that it has no moduli".into()));
    };
    let d = mesh.dimension;
    let mut moduli = DynamicModuli {
        young: ComplexModulus::default(),
        shear: ComplexModulus::default(),
        bulk: (d == 3).then(ComplexModulus::default),
    };
    for frequency in frequencies {
        let at: Vec<Complex<f64>> = coefficients.iter().map(|of| of(TAU * frequency)).collect();
        let solved: Result<Vec<Vec<Complex<f64>>>> = stress.forces.iter().map(|f| harmonic.solve(&at, f)).collect();
        let solved = match solved {
            Ok(solved) => solved,
            Err(error) if error.kind() == ErrorKind::Limit => {
                return Ok(without(format!("at {frequency} Hz {}", error.problem())));
            }
            Err(error) => return Err(error),
        };
        let work = |of: usize, by: usize| -> Complex<f64> {
            stress.forces[of].iter().zip(&solved[by]).map(|(f, u)| u * *f).sum()
        };
        let modulus = |of: usize| Complex::from(stress.volume) / work(of, of);
        let mean = |all: std::ops::Range<usize>| {
            let count = all.len() as f64;
            all.map(modulus).sum::<Complex<f64>>() / count
        };
        moduli.young.add(mean(0..d));
        moduli.shear.add(mean(d..stress.forces.len()));
        if let Some(bulk) = &mut moduli.bulk {
            // An even pressure is the sum of the tensions along all axes: the work is that of each tension on the
            // displacements of each other one, and no further equations are solved.
            let all: Complex<f64> = (0..d).flat_map(|k| (0..d).map(move |l| (k, l))).map(|(k, l)| work(k, l)).sum();
            bulk.add(Complex::from(stress.volume) / all);
        }
    }
    Ok(DynamicModuliOfModel { name: name.into(), moduli: Some(moduli), reason: None })
}

/// `E* = 9 K* μ*/(3 K* + μ*)`, in plane strain over `1 − ν*²`, with the complex moduli of the Prony series and of Rayleigh's β.
fn of_material(
    own: Material,
    relaxing: Option<&Relaxing>,
    recipe: Option<&MotionRecipe>,
    frequencies: &[f64],
) -> DynamicModuli {
    let (young, poisson) = (own.young(), own.poisson());
    let (mu, bulk) = (young / (2.0 * (1.0 + poisson)), young / (3.0 * (1.0 - 2.0 * poisson)));
    let beta = beta(recipe);
    let is_solid = matches!(own.state(), State::Solid);
    let mut moduli = DynamicModuli {
        young: ComplexModulus::default(),
        shear: ComplexModulus::default(),
        bulk: is_solid.then(ComplexModulus::default),
    };
    for w in frequencies.iter().map(|f| TAU * f) {
        let [shear, volume] = [(Share::Shear(0), mu), (Share::Bulk(0), bulk)]
            .map(|(share, modulus)| coefficient(share, relaxing, beta, w) * modulus);
        let tension = volume * shear * 9.0 / (volume * 3.0 + shear);
        let ratio = (volume * 3.0 - shear * 2.0) / ((volume * 3.0 + shear) * 2.0);
        let across = match own.state() {
            State::PlaneStrain { .. } => Complex::from(1.0) - ratio * ratio,
            State::Solid | State::PlaneStress { .. } | State::Rod { .. } => Complex::from(1.0),
        };
        moduli.young.add(tension / across);
        moduli.shear.add(shear);
        if let Some(bulk) = &mut moduli.bulk {
            bulk.add(volume);
        }
    }
    moduli
}
