//! The body to which an exact network is equal.

use super::positive::positive_note;
use crate::fit::{ExactEnergy, ExactFit, ShearSprings, VolumeSprings};
use crate::material::{CellMap, Hooke, Moduli};
use crate::positive::PositiveOutcome;

/// λ/μ at Poisson's ratio 1/3.
// It is half of the ratio from which finite elements are said to lock (`LOCKS` of `locking.rs`): networks are compared with cells
// that do not.
const UNLOCKED: f64 = 2.0;

/// The body to which the network is equal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExactOutcome {
    /// The energy of the network.
    pub energy: ExactEnergy,
    /// The domains over which its shear springs average the deformation.
    pub shear: ShearSprings,
    /// The contents that its volume springs measure: those of points also where a spring on each cell is the same.
    pub volume: VolumeSprings,
    /// Whether the material has another law.
    pub is_other: bool,
    /// The number of patches that share cells with points that are not held.
    pub patches: usize,
    /// The difference of the nearest network without negative springs, if that was requested.
    pub positive: Option<PositiveOutcome>,
    /// The largest Poisson's ratio of cells whose finite elements lock, and the network with them, and the keys that reduce it.
    pub locking: Option<(f64, &'static str)>,
}

impl ExactOutcome {
    /// The moduli of finite elements that do not lock. For nearly incompressible materials networks with volume springs
    /// on cells or patches are softer than finite elements with the moduli of the material, and should be.
    pub fn compared(&self, moduli: CellMap<Hooke>) -> CellMap<Hooke> {
        match self.volume {
            VolumeSprings::Points => moduli,
            VolumeSprings::Cells | VolumeSprings::Patches => moduli.map(|hooke| match hooke {
                Hooke::Isotropic(moduli) => {
                    let lambda = moduli.lambda.min(UNLOCKED * moduli.mu);
                    Hooke::Isotropic(Moduli { lambda, ..*moduli })
                }
                Hooke::Anisotropic(_) => hooke.clone(),
            }),
        }
    }

    /// Whether the network answers as the finite elements of the mesh do.
    pub fn is_finite_elements(&self) -> bool {
        (self.shear, self.volume) == (ShearSprings::Cells, VolumeSprings::Points) && self.positive.is_none()
    }

    /// The fit that has the same tangent at rest.
    pub fn at_rest(&self) -> ExactFit {
        ExactFit { energy: self.energy, shear: self.shear, volume: self.volume, large: false }
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let other = self.is_other.then(|| {
            format!(
                "the network has the energy {}, which is not the material's law: they agree at rest only",
                self.energy.name()
            )
        });
        let locking = self.locking.map(|(poisson, remedy)| {
            format!(
                "at nu = {poisson} linear cells lock: the finite elements are too stiff, and this network with them; {remedy} \
                 does not lock, but may be as far off on a coarse mesh: its errors under these loads say so, and `springfit converge` measures both"
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
        let shear = match self.shear {
            ShearSprings::Cells => None,
            ShearSprings::Edges => Some(
                "shear springs on the domains of edges: differs from the finite elements of this mesh, which are stiffer; \
                 `springfit converge` measures the errors of both"
                    .into(),
            ),
        };
        other
            .into_iter()
            .chain(shear)
            .chain(volume)
            .chain(locking)
            .chain(self.positive.as_ref().map(positive_note))
            .collect()
    }
}
