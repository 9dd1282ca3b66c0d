//! The material of a body, and the defaults where an input gives no value.

use crate::error::{Error, Result};
use crate::material::{Material, Plane};
use crate::mesh::{Mesh, Section};

/// The constants of a material, as an input gives them.
#[derive(Debug, Clone, Copy)]
pub struct BodyConstants {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// The plane state; plane stress if absent.
    pub plane: Option<Plane>,
    /// The thickness, m.
    pub thickness: Option<f64>,
    /// The cross-section of rods, m².
    pub area: Option<f64>,
}

impl BodyConstants {
    /// The material of the cells of a block: of those of the body as [`BodyConstants::material`] says; those that are attached to it, which
    /// have fewer dimensions, are membranes in plane stress or rods.
    ///
    /// # Errors
    /// Those of [`BodyConstants::material`]; or a membrane has no thickness, or a rod no cross-section.
    pub fn of_block(&self, mesh: &Mesh, block: usize) -> Result<Material> {
        let dimension = mesh.blocks[block].element.dimension();
        if dimension == mesh.cell_dimension() {
            return self.material(mesh);
        }
        let missing = |key: &str, expected: &str| Err(Error::expected(key, expected, "none"));
        match (dimension, self.thickness, self.area) {
            (2, None, _) => {
                missing("thickness", "that of the membrane, such as \"0.5 mm\", for cells of a surface on a solid")
            }
            (1, _, None) => missing("area", "the cross-section of the rods, such as \"2 mm^2\", for lines in a body"),
            // The plane state is that of the body; what is attached to it is in plane stress by itself.
            _ => BodyConstants { plane: None, ..*self }.of_dimension(dimension),
        }
    }

    /// The material of the meshed body. A plane body without a thickness is one metre thick, as is usual; a surface in
    /// space is a membrane, and must have a thickness.
    ///
    /// # Errors
    /// A constant is out of range, the mesh has no plane state, or a surface in space has no thickness.
    pub fn material(&self, mesh: &Mesh) -> Result<Material> {
        let material = self.of_dimension(mesh.cell_dimension())?;
        if is_surface(mesh) && self.thickness.is_none() {
            let expected = "the thickness of the membrane, such as \"0.5 mm\", because the mesh is a surface in space; fill makes a solid of a closed one";
            return Err(Error::expected("thickness", expected, "none"));
        }
        Ok(material)
    }

    /// The material of a body of this dimension, one metre thick if no thickness is given.
    ///
    /// # Errors
    /// A constant is out of range, or bodies of this dimension have no plane state.
    pub fn of_dimension(&self, dimension: usize) -> Result<Material> {
        let material = Material::for_body(dimension, self.young, self.poisson, self.plane, self.thickness)?;
        self.area.map_or(Ok(material), |area| material.with_area(area))
    }
}

/// The cells of a body for which an input gives a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stated {
    /// The input gives it for no cell.
    Nowhere,
    /// The input gives it for some of the cells.
    Partly,
    /// The input gives it for all cells.
    Everywhere,
}

impl Stated {
    /// Tells whether the input gives the one number that all cells share.
    pub fn once(number: Option<f64>) -> Stated {
        if number.is_some() { Stated::Everywhere } else { Stated::Nowhere }
    }
}

/// A sentence about what is assumed of the body because no input gives it, if anything is; it has what a deck states.
pub fn assumed(mesh: &Mesh, thickness: Stated, area: Stated) -> Option<String> {
    let (words, key, of): (_, _, fn(&Section) -> Option<f64>) = match (mesh.cell_dimension(), thickness, area) {
        (2, Stated::Nowhere, _) => {
            ("the thickness of the plane body is assumed to be 1 m", "thickness", |s| s.thickness)
        }
        (2, Stated::Partly, _) => {
            let words =
                "the thickness of the cells whose material gives none is assumed to be 1 m, not that of the others";
            (words, "thickness", |s| s.thickness)
        }
        (1, _, Stated::Nowhere) => ("the cross-section of the rods is assumed to be 1 m²", "area", |s| s.area),
        (1, _, Stated::Partly) => {
            let words =
                "the cross-section of the rods whose material gives none is assumed to be 1 m², not that of the others";
            (words, "area", |s| s.area)
        }
        _ => return None,
    };
    let stated: Vec<f64> = mesh.annotations.sections.iter().filter_map(of).collect();
    let ends = stated.iter().copied().reduce(f64::min).zip(stated.iter().copied().reduce(f64::max));
    let stated = match ends {
        None => String::new(),
        Some((least, most)) if least == most => format!(", and the file states {least} in its unit"),
        Some((least, most)) => format!(", and the file states {least} to {most} in its unit"),
    };
    Some(format!("{words}; \"{key}\" in the material sets it{stated}"))
}

fn is_surface(mesh: &Mesh) -> bool {
    mesh.cell_dimension() == 2 && mesh.dimension == 3
}
