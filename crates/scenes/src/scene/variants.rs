//! Scenes that differ from a scene that was read.

use super::distribution::Distribution;
use super::document::Scene;
use super::lists::check_fits;
use super::output::Output;
use super::reference::ReferenceEntry;
use crate::error::{Error, Result};
use crate::fits::NamedFit;
use crate::solve::Newton;

impl Scene {
    /// Replaces the fits of the scene.
    pub fn with_fits(self, fits: Vec<NamedFit>) -> Scene {
        Scene { fits, ..self }
    }

    /// Checks that the material and the loads are those that other fits than its own require.
    ///
    /// # Errors
    /// They are not; the error names the fit.
    pub fn check_fits(&self, fits: &[NamedFit]) -> Result<()> {
        check_fits(fits, &self.material, &self.loads)
    }

    /// The scene with its loads alone, for comparisons: without motion and frequencies.
    ///
    /// # Errors
    /// It has no loads.
    pub fn of_loads(self) -> Result<Scene> {
        if self.loads.is_empty() {
            let problem = "expected at least one [[load]] to compare under, found none";
            return Err(self.placed(Error::at("load", problem)));
        }
        let output = Output { frequencies: 0, dynamic_moduli: None, time: true, ..self.output.clone() };
        Ok(self.with_output(output).without_motion())
    }

    /// Replaces the outputs of the scene.
    pub fn with_output(self, output: Output) -> Scene {
        Scene { output, ..self }
    }

    /// Replaces the settings of Newton's method.
    pub fn with_newton(self, newton: Newton) -> Scene {
        Scene { newton, ..self }
    }

    /// Removes the loads of the scene, and the gauge that measures under them.
    pub fn without_loads(self) -> Scene {
        Scene { loads: Vec::new(), gauge: None, ..self }
    }

    /// Removes the gauge of the scene.
    pub fn without_gauge(self) -> Scene {
        Scene { gauge: None, ..self }
    }

    /// Removes the motion of the scene.
    pub fn without_motion(self) -> Scene {
        Scene { motion: None, ..self }
    }

    /// Makes errors relative to the finite elements of the mesh, also where they lock.
    pub fn judged_by_cells(self) -> Scene {
        Scene { reference: Some(ReferenceEntry::of_cells()), ..self }
    }

    /// Halves the edges of all cells this many more times.
    pub fn halved(mut self, times: u32) -> Scene {
        self.mesh.halvings += times;
        self
    }

    /// Multiplies all lengths of the mesh by `factor`.
    pub fn with_lengths_times(mut self, factor: f64) -> Scene {
        self.mesh.scale *= factor;
        if let Some(mesh) = self.reference.as_mut().and_then(|reference| reference.mesh.as_mut()) {
            mesh.scale *= factor;
        }
        self
    }

    /// Copies the scene with Young's modulus multiplied by `factor`, and with another Poisson's ratio if one is given.
    pub fn of_material(&self, factor: f64, poisson: Option<f64>) -> Scene {
        let mut scene = self.clone();
        for material in &mut scene.material.all {
            if let Some(young) = &mut material.young {
                young.factor *= factor;
            }
            if let (Some(poisson), Some(own)) = (poisson, &mut material.poisson) {
                *own = Distribution::of_number(poisson);
            }
        }
        scene
    }
}
