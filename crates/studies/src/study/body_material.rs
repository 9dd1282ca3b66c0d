//! The material of a body, and what is assumed of it where an input does not say.

use crate::error::{Error, Result};
use crate::material::{Material, Plane};
use crate::mesh::Mesh;

/// The constants of a material as an input gives them.
#[derive(Debug, Clone, Copy)]
pub struct BodyConstants {
    /// Pa.
    pub young: f64,
    pub poisson: f64,
    pub plane: Option<Plane>,
    /// m.
    pub thickness: Option<f64>,
    /// The cross-section of rods, m².
    pub area: Option<f64>,
}

impl BodyConstants {
    /// The material of the body that is meshed. A plane body may be given for one metre of its thickness, as is usual; a surface
    /// in space is a membrane, which has a thickness.
    ///
    /// # Errors
    /// A constant is out of range, the plane state does not go with the mesh, or a surface in space has no thickness.
    pub fn material(&self, mesh: &Mesh) -> Result<Material> {
        let material = self.of_dimension(mesh.cell_dimension())?;
        if is_surface(mesh) && self.thickness.is_none() {
            let expected = "the thickness of the membrane that the surface in space is, such as \"0.5 mm\"";
            return Err(Error::expected("thickness", expected, "none"));
        }
        Ok(material)
    }

    /// The material of a body of that dimension, one metre thick where nothing else is given.
    ///
    /// # Errors
    /// A constant is out of range, or the plane state does not go with the dimension.
    pub fn of_dimension(&self, dimension: usize) -> Result<Material> {
        let material = Material::for_body(dimension, self.young, self.poisson, self.plane, self.thickness)?;
        self.area.map_or(Ok(material), |area| material.with_area(area))
    }
}

/// What is assumed of the body because no input says it, as a sentence.
pub fn assumed(mesh: &Mesh, thickness: Option<f64>, area: Option<f64>) -> Option<String> {
    match mesh.cell_dimension() {
        2 if thickness.is_none() => {
            Some("the thickness of the plane body is assumed to be 1 m; \"thickness\" in the material sets it".into())
        }
        1 if area.is_none() => {
            Some("the cross-section of the rods is assumed to be 1 m²; \"area\" in the material sets it".into())
        }
        _ => None,
    }
}

fn is_surface(mesh: &Mesh) -> bool {
    mesh.cell_dimension() == 2 && mesh.dimension == 3
}
