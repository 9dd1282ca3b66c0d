//! The keys of a `[[fit]]` with the objective "exact".

use super::recipe::ExactRecipe;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ShearSprings, VolumeSprings};
use crate::positive::PositiveFit;
use schemars::JsonSchema;
use serde::Deserialize;

/// The keys.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ExactEntry {
    /// The network has this energy.
    #[schemars(extend("enum" = ExactEnergy::NAMES, "x-default" = "that of the material's law, or `\"stable-neo-hookean\"`; with `shear = \"edges\"` on a surface in space `\"st-venant-kirchhoff\"`"))]
    pub energy: Option<String>,
    /// Springs for the shear modulus measure the deformation in each cell (`cells`), or on the domain of each edge of linear triangles, in the plane or
    /// on surfaces in space, and tetrahedra (`edges`). `edges` is nearer to the truth than the finite elements of the same mesh, with three times the springs.
    #[schemars(extend("enum" = ShearSprings::NAMES, "default" = ShearSprings::default().name()))]
    pub shear: Option<String>,
    /// There is one volume spring for each quadrature point (`points`), cell (`cells`), or patch of cells around a node (`patches`).
    /// `cells` and `patches` avoid locking near ν = 0.5.
    #[schemars(extend("enum" = VolumeSprings::NAMES, "default" = VolumeSprings::default().name()))]
    pub volume: Option<String>,
    /// The second invariant has this share in the energy `stable-mooney-rivlin`.
    #[schemars(extend("default" = 0.25))]
    pub share: Option<f64>,
    /// No constant is below zero: the nearest such network is used.
    pub nonnegative: bool,
    /// Springs across the sides of cells are added where no others suffice, with `nonnegative`.
    pub across: bool,
}

impl ExactEntry {
    /// The fit with these spring groups.
    ///
    /// # Errors
    /// An energy or a kind of shear or volume springs is unknown, spring groups are named, `across` is given without
    /// `nonnegative`, or keys contradict each other.
    pub fn recipe(&self, springs: Option<&[String]>) -> Result<ExactRecipe> {
        if let Some(springs) = springs {
            return Err(without_groups(springs));
        }
        let energy = self.energy.as_deref().map(|name| ExactEnergy::named(name).map_err(|e| e.at_key("energy")));
        let volume = self.volume.as_deref().map(|name| VolumeSprings::named(name).map_err(|e| e.at_key("volume")));
        let shear = self.shear.as_deref().map(|name| ShearSprings::named(name).map_err(|e| e.at_key("shear")));
        let (shear, volume) = (shear.transpose()?.unwrap_or_default(), volume.transpose()?.unwrap_or_default());
        shear.check(volume)?;
        if shear == ShearSprings::Edges && self.nonnegative {
            let expected = "false with shear = \"edges\": the nearest network is sought for springs of single cells";
            return Err(Error::expected("nonnegative", expected, true).of_kind(ErrorKind::Unsupported));
        }
        let energy = match (energy.transpose()?, self.share) {
            (energy, None) => energy,
            (energy, Some(share)) => Some(energy.unwrap_or_default().with_share(share)?),
        };
        if self.across && !self.nonnegative {
            return Err(Error::at("across", "belongs to nonnegative = true"));
        }
        let positive = self.nonnegative.then(|| PositiveFit { across: self.across, ..PositiveFit::default() });
        Ok(ExactRecipe { energy, shear, volume, positive })
    }
}

/// The error of an exact network of some groups of springs.
pub fn without_groups(springs: &[String]) -> Error {
    let expected = "no groups: an exact network joins all nodes of each cell and has springs on its content";
    Error::expected("springs", expected, format!("{springs:?}"))
}
