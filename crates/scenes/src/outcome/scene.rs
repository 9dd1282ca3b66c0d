//! The results of a whole scene.

use super::dynamic_moduli::DynamicModuliOutcome;
use super::fit::FitOutcome;
use super::frequencies::FrequencyOutcome;
use super::load::BodyLoad;
use super::motion::MotionOutcome;
use crate::analysis::locking::TooStiff;
use crate::masses::PointMasses;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{Lumping, Support};
use crate::scene::MeasuredDamping;
use crate::timing::ModelTimes;
use std::path::PathBuf;

/// The results of a scene.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The title of the scene.
    pub scene: String,
    /// The files that were read.
    pub inputs: Vec<PathBuf>,
    /// What was given in place of values of the scene's file, as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// The command that was given, if there was one.
    pub command: Option<String>,
    /// Where the mesh comes from, in words.
    pub source: String,
    /// A sentence about what was assumed because no input gives it.
    pub assumed: Option<String>,
    /// What must be known of the loads, one sentence each.
    pub of_loads: Vec<String>,
    /// The mesh.
    pub mesh: Mesh,
    /// The materials, with the density if it is given.
    pub material: MaterialMap,
    /// The support of `[[fix]]`; `None` if there is no scene.
    pub support: Option<Support>,
    /// The masses, `[points]`, kg; `None` if the scene gives no density.
    pub masses: Option<Vec<f64>>,
    /// How these were lumped.
    pub lumping: Option<Lumping>,
    /// The title of the material's law; `None` at small deformation.
    pub law: Option<String>,
    /// How far the elasticity tensor of the law at rest is from that of E and ν, `‖C − C₀‖/‖C₀‖`: what fibres add.
    pub fibres: Option<f64>,
    /// The loads of the scene, with the response of the finite elements.
    pub loads: Vec<BodyLoad>,
    /// Why the linear cells of the mesh resist the body too much; `None` where they do not.
    pub too_stiff: Option<TooStiff>,
    /// The fits, in the order of the scene.
    pub fits: Vec<FitOutcome>,
    /// The costs of the finite elements of the mesh, if the scene asks for them.
    pub model_times: Option<ModelTimes>,
    /// The motion, if the scene has one.
    pub motion: Option<MotionOutcome>,
    /// The natural frequencies of the finite elements and of each network, if the scene requests them.
    pub frequencies: Vec<FrequencyOutcome>,
    /// Storage and loss moduli over frequency, if the scene requests them.
    pub dynamic_moduli: Option<DynamicModuliOutcome>,
    /// Damping that was measured, of materials and of the motion.
    pub damping: Vec<MeasuredDamping>,
    /// The stages that the scene does not request.
    pub left_out: Vec<String>,
}

impl Outcome {
    /// The outcome of one fit without loads.
    pub fn of_fit(
        name: String,
        mesh: Mesh,
        material: impl Into<MaterialMap>,
        masses: Option<PointMasses>,
        fit: FitOutcome,
    ) -> Outcome {
        let (settings, command, law, loads, motion, frequencies, left_out) = Default::default();
        let (dynamic_moduli, damping) = Default::default();
        let (inputs, assumed, of_loads, support, fibres) = Default::default();
        let material = material.into();
        let too_stiff = TooStiff::of(&mesh, &material, &[]);
        Outcome {
            source: name.clone(),
            scene: name,
            inputs,
            settings,
            command,
            assumed,
            of_loads,
            mesh,
            material,
            support,
            lumping: masses.as_ref().map(|masses| masses.lumping),
            masses: masses.map(|masses| masses.values),
            law,
            fibres,
            loads,
            too_stiff,
            fits: vec![fit],
            model_times: None,
            motion,
            frequencies,
            dynamic_moduli,
            damping,
            left_out,
        }
    }

    /// The largest Poisson's ratio of the cells that lock.
    pub fn locks_at(&self) -> Option<f64> {
        self.too_stiff.and_then(|cells| cells.locks_at())
    }

    /// The index of the load with this name.
    pub fn load(&self, name: &str) -> Option<usize> {
        self.loads.iter().position(|load| load.name == name)
    }
}
