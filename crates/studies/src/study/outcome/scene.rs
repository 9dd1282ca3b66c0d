//! The results of a whole scene.

use super::fit::FitOutcome;
use super::frequencies::FrequencyOutcome;
use super::load::BodyLoad;
use super::motion::MotionOutcome;
use crate::material::Material;
use crate::mesh::Mesh;

/// The results of a scene.
#[derive(Debug)]
pub struct Outcome {
    pub scene: String,
    /// What was given in place of values of the scene's file, as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// What was assumed because no input says it, as a sentence.
    pub assumed: Option<String>,
    pub mesh: Mesh,
    pub material: Material,
    /// `[points]`, kg; `None` if the scene gives no density.
    pub masses: Option<Vec<f64>>,
    /// The title of the material's law; `None` at small deformation.
    pub law: Option<String>,
    /// The loads of the scene with the answers of the finite elements.
    pub loads: Vec<BodyLoad>,
    pub fits: Vec<FitOutcome>,
    /// `None` if the scene has no motion.
    pub motion: Option<MotionOutcome>,
    /// Of the finite elements and of each network, if the scene asks for them.
    pub frequencies: Vec<FrequencyOutcome>,
    /// The stages that the scene did not ask for.
    pub left_out: Vec<String>,
}

impl Outcome {
    /// The outcome of one fit without loads.
    pub fn of_fit(name: String, mesh: Mesh, material: Material, masses: Option<Vec<f64>>, fit: FitOutcome) -> Outcome {
        let (settings, law, loads, motion, frequencies, left_out) = Default::default();
        let assumed = None;
        Outcome {
            scene: name,
            settings,
            assumed,
            mesh,
            material,
            masses,
            law,
            loads,
            fits: vec![fit],
            motion,
            frequencies,
            left_out,
        }
    }

    /// The place of the load of this name.
    pub fn load(&self, name: &str) -> Option<usize> {
        self.loads.iter().position(|load| load.name == name)
    }
}
