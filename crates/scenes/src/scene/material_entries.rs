//! What the entries of the material of a scene are together.

use super::bending::{Bending, RestShape};
use super::material::{MaterialEntries, MaterialEntry};
use super::part::Part;
use crate::error::{Error, Result};
use crate::material::Plane;

impl MaterialEntry {
    /// That a rest shape other than the mesh belongs to a sheet at large deformation: it moves before any load.
    fn check_rest(&self) -> Result<()> {
        if self.rest == RestShape::Mesh {
            return Ok(());
        }
        let expected = match (self.bending, &self.law) {
            (Bending::Plate, Some(_)) => return Ok(()),
            (Bending::Plate, None) => {
                "a law beside it, such as \"stable-neo-hookean\": a curved sheet that is flat at rest moves before any load, and linear theory has no place for that"
            }
            (Bending::None | Bending::Rod, _) => {
                "bending = \"plate\" beside it: sheets alone have another shape at rest than the mesh"
            }
        };
        Err(Error::expected("rest", expected, "\"flat\" without it"))
    }
}

impl MaterialEntries {
    /// The key of an entry.
    pub fn key(&self, entry: usize) -> String {
        if self.is_list { format!("material[{entry}]") } else { "material".into() }
    }

    /// The first entry; there is one after [`MaterialEntries::check`].
    pub fn first(&self) -> &MaterialEntry {
        &self.all[0]
    }

    /// Whether all entries have a density.
    pub fn has_density(&self) -> bool {
        self.all.iter().all(|entry| entry.density.is_some())
    }

    /// Whether the material is the same in all cells.
    pub fn is_uniform(&self) -> bool {
        let first = self.first();
        self.all.len() == 1 && !first.varies() && first.young.is_some()
    }

    /// Gives every isotropic entry Young's modulus and Poisson's ratio, whatever constants it is stated by.
    ///
    /// # Errors
    /// The constants of an entry are not two, or there is no such material.
    pub fn complete(&mut self) -> Result<()> {
        for i in 0..self.all.len() {
            let key = self.key(i);
            self.all[i].complete().map_err(|e| e.under(key))?;
        }
        Ok(())
    }

    /// The checks that do not depend on the mesh.
    ///
    /// # Errors
    /// There is no entry, several have no part of the mesh, they do not go together, or a number is out of its range.
    pub fn check(&self) -> Result<()> {
        if self.all.is_empty() {
            return Err(Error::expected("material", "at least one [[material]]", "none"));
        }
        let mut rest = None;
        for (i, entry) in self.all.iter().enumerate() {
            entry.check().map_err(|e| e.under(self.key(i)))?;
            let first = self.first();
            if entry.part()? == Part::Everything
                && let Some(other) = rest.replace(i)
            {
                let expected = format!("\"group\" or \"where\": {} has what is left of the body", self.key(other));
                return Err(Error::expected(self.key(i), expected, "neither"));
            }
            entry.check_rest().map_err(|e| e.under(self.key(i)))?;
            let alike = [
                ("plane", entry.plane.unwrap_or(Plane::Stress) == first.plane.unwrap_or(Plane::Stress)),
                ("bending", entry.bending == first.bending),
                ("flexural", entry.flexural == first.flexural),
                ("torsional", entry.torsional == first.torsional),
                ("rest", entry.rest == first.rest),
            ];
            if let Some((key, _)) = alike.into_iter().find(|(_, is_same)| !is_same) {
                let expected = format!("that of {}", self.key(0));
                return Err(Error::expected(format!("{}.{key}", self.key(i)), expected, "another"));
            }
            let has = |entry: &MaterialEntry| [("law", entry.law.is_some()), ("density", entry.density.is_some())];
            if let Some(((key, _), _)) = has(entry).into_iter().zip(has(first)).find(|(own, other)| own != other) {
                let expected = format!("a {key} in every [[material]] or in none");
                return Err(Error::expected(format!("{}.{key}", self.key(i)), expected, "one in some"));
            }
        }
        Ok(())
    }
}
