//! Young's modulus and Poisson's ratio as a tension test measures them: from the strain of the straight part of a
//! specimen.

use super::case::Case;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::Action;
use crate::outcome::{Followed, GaugeResult, LoadOutcome, Reading};
use crate::scene::{Gauge, LoadCase, Part, Scene};
use crate::solve::Ending;
use nalgebra::{DMatrix, DVector};

/// The points of the gauge of a scene, and the force in it under each load.
pub struct Gauged {
    points: Vec<usize>,
    axis: usize,
    area: f64,
    /// The force, N; `None` under a load that does not cause the same force in the whole gauge.
    forces: Vec<Option<f64>>,
}

impl Gauged {
    /// The gauge of a scene on its mesh.
    ///
    /// # Errors
    /// The part is unknown or has no extent, or the mesh does not have the axis.
    pub fn new(scene: &Scene, gauge: &Gauge, mesh: &Mesh, cases: &[Case]) -> Result<Gauged> {
        let at = |e: Error| scene.at("gauge", e);
        let d = mesh.dimension;
        if gauge.axis >= d {
            return Err(at(Error::expected("axis", "\"x\" or \"y\" in a plane mesh", "\"z\"")));
        }
        let points = gauge.part.selection(d).and_then(|s| s.points(mesh)).map_err(at)?;
        if points.is_empty() {
            return Err(at(gauge.part.without_members("measures nothing: the selected part has no points", mesh)));
        }
        let gauged = Gauged { points, axis: gauge.axis, area: gauge.area, forces: Vec::new() };
        if gauged.strain(mesh, &vec![0.0; mesh.points.len()]).is_none() {
            let found = format!("{} points without extent in some direction", gauged.points.len());
            let key = if matches!(gauge.part, Part::Group(_)) { "group" } else { "where" };
            return Err(at(Error::expected(key, "a part that is a body of its own", found)));
        }
        let along = |p: usize| mesh.point(p)[gauge.axis];
        let (low, high) = gauged
            .points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| (low.min(along(p)), high.max(along(p))));
        // The force is the same in all sections if all loads are at one end of the gauge.
        let aside = |case: &Case| {
            let acts = |p: &usize| case.forces[p * d..(p + 1) * d].iter().any(|f| *f != 0.0);
            let loaded = || (0..mesh.point_count()).filter(acts);
            loaded().all(|p| along(p) >= high) || loaded().all(|p| along(p) <= low)
        };
        let force = |(case, load): (&Case, &LoadCase)| {
            let along = |k: usize| case.forces.iter().skip(k).step_by(d).sum::<f64>();
            let largest = (0..d).map(|k| along(k).abs()).fold(0.0, f64::max);
            let pulls =
                matches!(load.single(), Some((_, Action::Traction(_) | Action::Pressure(_) | Action::Force(_))));
            // A force along the axis that is so small beside the others is the rounding of components that cancel.
            Some(along(gauge.axis)).filter(|f| pulls && aside(case) && largest > 0.0 && f.abs() > 1e-6 * largest)
        };
        Ok(Gauged { forces: cases.iter().zip(scene.loads()).map(force).collect(), ..gauged })
    }

    /// The reading of the finite elements with displacements `u` under the load with this index.
    pub fn body(&self, mesh: &Mesh, load: usize, u: &[f64], followed: Option<&Followed>) -> GaugeResult {
        let reached = followed.is_none_or(|followed| followed.ending == Ending::Converged);
        let reading = self.read(mesh, load, u).filter(|_| reached);
        reading.map_or(GaugeResult::NoReading, GaugeResult::Reading)
    }

    /// Writes the readings of a network into its results under the loads.
    pub fn measure(&self, mesh: &Mesh, loads: &mut [LoadOutcome]) {
        for (i, load) in loads.iter_mut().enumerate() {
            load.gauge = load.displacement.as_ref().and_then(|u| self.read(mesh, i, u));
        }
    }

    /// The reading for displacements `u` under the load with this index; `None` if the load does not pull along the
    /// axis.
    fn read(&self, mesh: &Mesh, load: usize, u: &[f64]) -> Option<Reading> {
        let force = self.forces[load]?;
        let strain = self.strain(mesh, u)?;
        let along = strain[self.axis];
        let across: f64 = (0..mesh.dimension).filter(|&k| k != self.axis).map(|k| strain[k]).sum();
        let reading =
            Reading { young: force / (self.area * along), poisson: -across / (mesh.dimension - 1) as f64 / along };
        Some(reading).filter(|r| r.young.is_finite() && r.poisson.is_finite())
    }

    /// The diagonal of the gradient of the affine displacement `u ≈ a + G x` that fits those of the points best.
    fn strain(&self, mesh: &Mesh, u: &[f64]) -> Option<Vec<f64>> {
        let d = mesh.dimension;
        let n = self.points.len() as f64;
        let mean = |values: &[f64], k: usize| self.points.iter().map(|p| values[p * d + k]).sum::<f64>() / n;
        let centre: Vec<f64> = (0..d).map(|k| mean(&mesh.points, k)).collect();
        let mut moments = DMatrix::zeros(d, d);
        let mut mixed = DMatrix::zeros(d, d);
        for &p in &self.points {
            let x = DVector::from_fn(d, |k, _| mesh.point(p)[k] - centre[k]);
            moments += &x * x.transpose();
            mixed += &x * DVector::from_fn(d, |k, _| u[p * d + k]).transpose();
        }
        let size = moments.trace();
        // Points in one plane do not tell how the body stretches across it.
        // Eigenvalues are squares: points that are nearer to a plane than 3e-5 of their extent count as in it.
        let thin = moments.clone().symmetric_eigenvalues().min() <= 1e-9 * size;
        let gradient = moments.cholesky().filter(|_| !thin)?.solve(&mixed);
        Some((0..d).map(|k| gradient[(k, k)]).collect())
    }
}
