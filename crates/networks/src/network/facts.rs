//! What is known of a network beside its points and springs, whoever made it.

use super::provenance::{MaterialDataRecord, PlaneRecord};
use super::record::{DriveRecord, HeldRecord, NetworkDampingRecord, NetworkRecord, NodalLoadRecord};
use crate::engine::Setting;
use serde::{Deserialize, Serialize};

/// What is known of a network beside its points and springs, whoever made it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkFacts {
    /// The material for which it was made.
    pub material: Option<MaterialDataRecord>,
    /// The state of a plane body or a surface.
    pub plane: Option<PlaneRecord>,
    /// The settings of the engine to which its constants belong.
    pub engine: Option<Setting>,
    /// The points that are held.
    #[serde(default)]
    pub held: Vec<HeldRecord>,
    /// The loads.
    #[serde(default)]
    pub loads: Vec<NodalLoadRecord>,
    /// The acceleration in m/s².
    #[serde(default)]
    pub gravity: Option<Vec<f64>>,
    /// Rayleigh's numbers and the damping ratio.
    #[serde(default)]
    pub damping: NetworkDampingRecord,
    /// How it moves, and how it relaxes.
    #[serde(default)]
    pub motion: Option<DriveRecord>,
    /// The coefficients of the dampers in kg/s, `[springs]`.
    #[serde(default)]
    pub dampers: Option<Vec<f64>>,
}

impl NetworkRecord {
    /// What is known beside points and springs.
    pub fn facts(&self) -> NetworkFacts {
        let dampers: Vec<f64> = self.springs.iter().map(|spring| spring.damper).collect();
        NetworkFacts {
            material: self.provenance.material.clone(),
            plane: self.plane,
            engine: self.engine,
            held: self.held.clone(),
            loads: self.loads.clone(),
            gravity: self.gravity.clone(),
            damping: self.damping,
            motion: self.motion.clone(),
            dampers: dampers.iter().any(|damper| *damper != 0.0).then_some(dampers),
        }
    }
}
