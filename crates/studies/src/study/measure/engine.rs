//! How stiff a network an engine can hold at its settings.

use crate::engine::{Ceiling, Setting, TruncatedModel, least_substeps};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Specimen, Support};
use crate::solve::System;
use springfit_scenes::EngineLimit;

/// Points within this share of the length of a network from its end are at the end. Ends of printed or simulated
/// networks are not flat to rounding.
const END: f64 = 1e-3;

/// The limit, and how the network is held and pulled, in words; `None` where the method of the engine has no limit.
///
/// A network that is held and loaded in its file is so here. Another one is held at one end of its longest axis, and pulled at the other along
/// each axis.
///
/// # Errors
/// The engine does not hold the network, there are no masses, or the loads find no equilibrium; the key is `engine`.
pub fn engine_limit(
    specimen: &Specimen,
    young: Option<f64>,
    setting: &Setting,
) -> Result<(Option<EngineLimit>, String)> {
    let d = specimen.network.dimension;
    if specimen.period.is_some() {
        let error = Error::expected("engine", "a body, which an engine holds", "a network that repeats itself");
        return Err(error.of_kind(ErrorKind::Unsupported));
    }
    let Some(masses) = &specimen.masses else {
        return Err(Error::expected("engine", "masses of the points, from the file or by a density", "none"));
    };
    let (support, loads, words) = match (&specimen.support, specimen.loads.is_empty()) {
        (Some(support), false) => {
            (support.clone(), specimen.loads.clone(), "held and loaded as its file says".to_string())
        }
        (own, _) => ends(specimen, own.as_ref()),
    };
    let system = System::new(&specimen.network.stiffness(&specimen.points), &support)?.placed(&specimen.points, d);
    let Some(factor) = system.cholesky()? else {
        let expected = "a network that resists every motion where it is held";
        return Err(Error::expected("engine", expected, "motions without resistance").of_kind(ErrorKind::Infeasible));
    };
    let answers: Vec<Vec<f64>> = loads.iter().map(|load| system.solve(&factor, load).0).collect();
    let model = TruncatedModel { network: &specimen.network, points: &specimen.points, masses };
    let cases: Vec<_> = loads.iter().zip(&answers).map(|(load, u)| (&support, &load[..], &u[..])).collect();
    let Some(ceiling) = Ceiling::of(model, &cases, setting)? else { return Ok((None, words)) };
    let least_substeps = least_substeps(model, &cases, setting)?;
    let modulus = young.map(|young| young * ceiling.factor);
    Ok((Some(EngineLimit { setting: *setting, ceiling: Some(ceiling.factor), modulus, least_substeps }), words))
}

/// The support at one end of the longest axis, unless there is one, and a force of 1 N along each axis, shared by the points of the other end.
fn ends(specimen: &Specimen, own: Option<&Support>) -> (Support, Vec<Vec<f64>>, String) {
    let d = specimen.network.dimension;
    let along = |k: usize| specimen.points.iter().skip(k).step_by(d).copied();
    let range = |k: usize| [along(k).fold(f64::INFINITY, f64::min), along(k).fold(f64::NEG_INFINITY, f64::max)];
    let length = |k: usize| range(k)[1] - range(k)[0];
    // Of equal lengths the first axis is taken: the maximum is the last of equal ones, so that the order of axes is
    // turned.
    let axis = (0..d).max_by(|&a, &b| length(a).total_cmp(&length(b)).then(b.cmp(&a))).unwrap_or(0);
    let ([low, high], near) = (range(axis), END * length(axis));
    let mut support = Support { prescribed: vec![None; specimen.points.len()] };
    let points: Vec<usize> = (0..specimen.points.len() / d).collect();
    let at = |p: &usize| specimen.points[p * d + axis];
    let held: Vec<usize> = points.iter().copied().filter(|p| at(p) <= low + near).collect();
    let mut pulled: Vec<usize> = points.iter().copied().filter(|p| at(p) >= high - near).collect();
    let name = ["x", "y", "z"][axis];
    let words = match own {
        Some(own) => {
            support = own.clone();
            pulled.retain(|p| (p * d..(p + 1) * d).any(|dof| !own.is_fixed(dof)));
            if pulled.is_empty() {
                pulled =
                    points.iter().copied().filter(|p| (p * d..(p + 1) * d).all(|dof| !own.is_fixed(dof))).collect();
            }
            format!("held as its file says, and pulled along each axis at its end along {name}")
        }
        None => {
            support.fix(&held, &(0..d).collect::<Vec<_>>(), d);
            format!("held at one end along {name}, and pulled along each axis at the other")
        }
    };
    let load = |k: usize| {
        let mut forces = vec![0.0; specimen.points.len()];
        // The sum of the forces is 1 N, whatever the number of points.
        pulled.iter().for_each(|p| forces[p * d + k] = 1.0 / pulled.len() as f64);
        forces
    };
    (support, (0..d).map(load).collect(), words)
}
