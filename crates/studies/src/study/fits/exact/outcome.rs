//! What an exact network is equal to.

use super::positive::positive_note;
use crate::fit::{ExactEnergy, VolumeSprings};
use crate::material::Moduli;
use crate::positive::PositiveOutcome;

/// λ/μ of Poisson's ratio 1/3.
const UNLOCKED: f64 = 2.0;

/// The body that the network is equal to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactOutcome {
    pub energy: ExactEnergy,
    pub volume: VolumeSprings,
    /// Whether the material has another law.
    pub is_other: bool,
    /// Patches that share cells with points that nothing holds.
    pub patches: usize,
    /// How far the nearest network without negative springs is from it.
    pub positive: Option<PositiveOutcome>,
}

impl ExactOutcome {
    /// The moduli of finite elements that do not lock: networks with volume springs on cells or patches are softer near the
    /// incompressible than those of the material, as they are to be.
    pub fn compared(&self, moduli: Moduli) -> Moduli {
        match self.volume {
            VolumeSprings::Points => moduli,
            VolumeSprings::Cells | VolumeSprings::Patches => {
                Moduli { lambda: moduli.lambda.min(UNLOCKED * moduli.mu), ..moduli }
            }
        }
    }

    /// What a reader must know of it.
    pub fn notes(&self) -> Vec<String> {
        let other = self.is_other.then(|| {
            format!(
                "the network has the energy {}, which is not the material's law: they agree at rest only",
                self.energy.name()
            )
        });
        let volume = match self.volume {
            VolumeSprings::Points => None,
            VolumeSprings::Cells => Some(
                "one volume spring in each cell: differs from the finite elements, which lock near nu = 0.5".into(),
            ),
            VolumeSprings::Patches => Some(format!(
                "volume springs on {} patches of cells: differs from the finite elements, which lock near nu = 0.5; \
                 they depend on which points are held",
                self.patches
            )),
        };
        other.into_iter().chain(volume).chain(self.positive.as_ref().map(positive_note)).collect()
    }
}
