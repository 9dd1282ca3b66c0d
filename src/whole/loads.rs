//! Loads that show how an object moves: tension, shears, torsion and bending of a face, gravity to the side.

use crate::error::{Error, Result};
use crate::mesh::{Mesh, Selection};
use crate::model::{Action, nodal_forces};

/// A named set of nodal forces, `[points · dimension]`, N.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalLoad {
    pub name: &'static str,
    pub forces: Vec<f64>,
}

/// On a face opposite to where the object is held, about the axis from there to its middle, each of unit size: tension, a shear
/// (two of solids), torsion of solids, bending, gravity to the side. The traction of torsion and bending grows from the middle
/// of the face; its nodal forces are lumped.
///
/// # Errors
/// The face or the held part has no points.
pub fn standard_loads(mesh: &Mesh, held: &Selection, face: &Selection, thickness: f64) -> Result<Vec<NodalLoad>> {
    let d = mesh.dimension;
    let along = |k: usize| (0..d).map(|l| f64::from(u8::from(k == l))).collect::<Vec<f64>>();
    let areas: Vec<f64> = {
        let forces = nodal_forces(mesh, face, &Action::Traction(along(0)), thickness)?;
        forces.into_iter().step_by(d).collect()
    };
    let total: f64 = areas.iter().sum();
    let held = held.points(mesh)?;
    if held.is_empty() || total <= 0.0 {
        return Err(Error::new("expected a held part and a face with points"));
    }
    let middle: Vec<f64> =
        (0..d).map(|k| (0..areas.len()).map(|p| areas[p] * mesh.point(p)[k]).sum::<f64>() / total).collect();
    let foot: Vec<f64> =
        (0..d).map(|k| held.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / held.len() as f64).collect();
    let axis = unit(&middle.iter().zip(&foot).map(|(a, b)| a - b).collect::<Vec<f64>>());
    // The coordinate direction that is farthest from the axis, made orthogonal to it.
    let farthest = (0..d).min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let across =
        unit(&(0..d).map(|k| f64::from(u8::from(k == farthest)) - axis[farthest] * axis[k]).collect::<Vec<f64>>());
    let on_face = |traction: &dyn Fn(&[f64]) -> Vec<f64>| -> Vec<f64> {
        let force = |(p, &area): (usize, &f64)| {
            let from: Vec<f64> = mesh.point(p).iter().zip(&middle).map(|(x, c)| x - c).collect();
            let t = if area == 0.0 { vec![0.0; d] } else { traction(&from) };
            t.into_iter().map(move |t| t * area)
        };
        areas.iter().enumerate().flat_map(force).collect()
    };
    let mut loads = vec![
        NodalLoad { name: "tension", forces: on_face(&|_| axis.clone()) },
        NodalLoad { name: "shear", forces: on_face(&|_| across.clone()) },
    ];
    if d == 3 {
        let third = cross(&axis, &across);
        loads.push(NodalLoad { name: "shear across", forces: on_face(&|_| third.clone()) });
        loads.push(NodalLoad { name: "torsion", forces: on_face(&|x| cross(&axis, x)) });
    }
    let lever = |x: &[f64]| -> f64 { x.iter().zip(&across).map(|(x, e)| x * e).sum() };
    loads.push(NodalLoad { name: "bending", forces: on_face(&|x| axis.iter().map(|a| a * lever(x)).collect()) });
    let gravity = nodal_forces(mesh, &Selection::Everything, &Action::Body(across.clone()), thickness)?;
    loads.push(NodalLoad { name: "side gravity", forces: gravity });
    Ok(loads)
}

fn unit(v: &[f64]) -> Vec<f64> {
    let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    v.iter().map(|v| v / size).collect()
}

fn cross(a: &[f64], b: &[f64]) -> Vec<f64> {
    (0..3).map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]).collect()
}
