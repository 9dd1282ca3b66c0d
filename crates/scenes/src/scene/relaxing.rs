//! Whether the material of a scene relaxes.

use super::damping::MeasuredDamping;
use super::document::Scene;
use crate::material::Relaxation;

impl Scene {
    /// The key of the relaxation of a region.
    pub fn relaxation_key(&self, region: usize) -> String {
        format!("{}.relaxation", self.material.key(region))
    }

    /// How the moduli of each region relax, if they do in one, with the key of the first that says so.
    pub fn relaxation(&self) -> Option<(String, Vec<Option<Relaxation>>)> {
        // They have been checked.
        let all = &self.material.all;
        let series: Vec<Option<Relaxation>> =
            all.iter().map(|entry| entry.relaxation.as_ref().and_then(|entry| entry.check().ok())).collect();
        let first = series.iter().position(Option::is_some)?;
        Some((format!("{}.relaxation", self.material.key(first)), series))
    }

    /// The damping that was measured: of materials, then of the motion.
    pub fn measured_damping(&self) -> Vec<MeasuredDamping> {
        let of_material = self.material.all.iter().enumerate().filter_map(|(region, entry)| {
            let damping = entry.relaxation.as_ref()?.damping()?;
            Some(damping.at(format!("{}.measured", self.relaxation_key(region))))
        });
        let of_motion = self.motion.as_ref().and_then(|motion| motion.measured_damping.clone());
        of_material.chain(of_motion).collect()
    }

    /// What must be known of the relaxation, if there is one.
    pub fn relaxation_note(&self) -> Option<String> {
        let entry = self.material.all.iter().find_map(|entry| entry.relaxation.as_ref())?;
        let fitted = entry.fitted().map_or(String::new(), |series| {
            let count = series.terms.len();
            format!(
                "; the measured moduli have a Prony series of {count} terms with an error of {:.2} % (root mean square) and {:.4e} Pa against a sudden strain, of \
                 which shares alone are used",
                100.0 * series.error,
                series.modulus
            )
        });
        let also = if self.output().dynamic_moduli.is_some() { " and dynamic_moduli" } else { "" };
        Some(format!(
            "the material relaxes in [motion]{also} alone: loads, frequencies and networks that are written have the moduli against a sudden strain{fitted}"
        ))
    }
}
