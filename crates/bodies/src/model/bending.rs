//! The springs by which sheets and rods resist bending, on their directors.
//!
//! Theory: pages *Sheets that bend* and *Rods that bend* of the book.

use super::network::Network;
use super::{plate, rod};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, EnergyMap, Hooke, Material};
use crate::mesh::Mesh;

/// Which springs resist the bending of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BendingSprings {
    /// Three springs of each triangle on its turns from all its directors: the plate, at any Poisson's ratio. Of each rod five springs: the beam.
    #[default]
    Directors,
    /// One spring of each triangle on its turn from each director. Between two triangles they are a spring on the angle between both, which other programs
    /// hold; Poisson's ratio is near −1/3 whatever that of the plate is. Of each rod six springs on single turns, which other programs hold as well.
    Hinges,
}

crate::named!(BendingSprings {
    "directors" => Directors,
    "hinges" => Hinges,
});

impl BendingSprings {
    /// The springs of the directors of a sheet or of rods, or none. `moduli` are those of the membrane, N/m, or of the rods, N.
    pub fn of(self, mesh: &Mesh, moduli: &CellMap<Hooke>) -> Network {
        match &mesh.directors {
            None => Network { dimension: mesh.dimension, ..Network::default() },
            Some(directors) => match (self, mesh.cell_dimension()) {
                (BendingSprings::Directors, 1) => rod::beams(mesh, directors, moduli),
                (BendingSprings::Hinges, 1) => rod::hinges(mesh, directors, moduli),
                (BendingSprings::Directors, _) => plate::plate(mesh, directors, moduli),
                (BendingSprings::Hinges, _) => plate::hinges(mesh, directors, moduli),
            },
        }
    }

    /// Proves that the body can have these springs.
    ///
    /// # Errors
    /// Rods with hinges meet in a joint that has no one direction: kind `Unsupported`.
    pub fn check(self, mesh: &Mesh) -> Result<()> {
        let Some(joints) =
            mesh.directors.as_ref().filter(|_| mesh.cell_dimension() == 1 && self == BendingSprings::Hinges)
        else {
            return Ok(());
        };
        let Some(joint) = rod::askew(mesh, joints) else { return Ok(()) };
        let expected = "\"directors\": hinges hold joints of rods that are in line to 30 degrees";
        let found = format!("\"hinges\" and another joint at {:?} m", mesh.point(joint));
        Err(Error::expected("bending", expected, found).of_kind(ErrorKind::Unsupported))
    }
}

/// The springs of the directors of a sheet as a plate, or of rods as beams, which are their finite elements too.
pub fn bending_springs(mesh: &Mesh, moduli: &CellMap<Hooke>) -> Network {
    BendingSprings::Directors.of(mesh, moduli)
}

/// The springs of [`bending_springs`] with laws of large deformation, of which plates and beams have the moduli at rest.
pub(super) fn bending_at_large_deformation(mesh: &Mesh, laws: &EnergyMap) -> Network {
    let hooke = |cell: usize| {
        let (energy, state) = laws.at(0, cell);
        let material = Material::new(energy.young(), energy.poisson(), state);
        Hooke::Isotropic(material.expect("a law is that of a material").moduli())
    };
    let cells = mesh.directors.as_ref().map_or(0, |directors| directors.gyration.len());
    bending_springs(mesh, &CellMap::of_blocks(vec![(0..cells).map(hooke).collect()]))
}
