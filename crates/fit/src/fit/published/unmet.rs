//! How far cells and material are from the assumptions of a method.

use super::cell_shape::Elasticity;
use super::corners::Corners;
use super::method::{Method, Ratio};
use crate::element::Element;
use crate::error::Result;
use crate::fit::visit::each_cell;
use crate::material::{BlockValues, Material};
use crate::springs::distance;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The assumptions of a method that cells and material do not meet; none if it equals `Unmet::default()`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct Unmet {
    /// The formula has this Poisson's ratio, in the plane that of the plane; it is null if the material has it too.
    #[serde(rename = "poisson_assumed")]
    pub poisson: Option<f64>,
    /// This number of elements has another shape than the formula assumes.
    #[serde(rename = "elements_of_other_shape")]
    pub cells: usize,
    /// Two lengths that are equal in the assumed shape have at most this relative difference.
    #[serde(rename = "largest_deviation")]
    pub deviation: f64,
}

impl Unmet {
    /// The sum of what two sets of cells do not meet.
    pub fn and(self, other: Unmet) -> Unmet {
        Unmet {
            poisson: self.poisson.or(other.poisson),
            cells: self.cells + other.cells,
            deviation: self.deviation.max(other.deviation),
        }
    }
}

/// Deviations below this are rounding in the digits of a mesh file.
const ROUNDING: f64 = 1e-6;

/// Compares cells, `[cells × nodes]` into `points`, and material with the assumptions of the method.
///
/// # Errors
/// The method has no formula for the element, or a cell is reversed, tangled or flat.
pub fn unmet<'a>(
    method: Method,
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    material: impl Into<BlockValues<'a, Material>>,
) -> Result<Unmet> {
    unmet_in(method, element, points, connectivity, material.into())
}

/// [`unmet`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn unmet_in<'a>(
    method: Method,
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    material: BlockValues<'a, Material>,
) -> Result<Unmet> {
    let cover = method.cover(element)?;
    let corners = Corners::of(element)?;
    let mut unmet = Unmet::default();
    for material in material.values() {
        let ratio = Elasticity::of(element, *material)?.poisson;
        if let Ratio::Only(assumed) = cover.poisson
            && (assumed - ratio).abs() > ROUNDING
        {
            unmet.poisson = Some(assumed);
        }
    }
    let Some(shape) = cover.shape else { return Ok(unmet) };
    let d = element.dimension();
    each_cell(element, points, connectivity, 0, |_, x, _| {
        let length = |[a, b]: [usize; 2]| distance(&x[a * d..(a + 1) * d], &x[b * d..(b + 1) * d]);
        let deviation = shape.deviation(&corners, length);
        unmet.cells += usize::from(deviation > ROUNDING);
        unmet.deviation = unmet.deviation.max(deviation);
    })?;
    if unmet.cells == 0 {
        unmet.deviation = 0.0;
    }
    Ok(unmet)
}
