//! The exact network of a body at small deformation.

use super::domains::edge_springs;
use super::network::Network;
use super::patches::patch_springs;
use crate::error::Result;
use crate::fit::{ExactFit, ShearSprings, VolumeSprings, fit_exact};
use crate::material::MaterialMap;
use crate::mesh::Mesh;

/// The springs of the cells or of the domains of edges, and of the patches. `held` says of each point whether it is held, or is empty.
///
/// # Errors
/// The mesh, the material or the energy has no such network; the kind is `Unsupported` where another choice of springs has one.
pub fn exact_network(mesh: &Mesh, material: &MaterialMap, fit: &ExactFit, held: &[bool]) -> Result<Network> {
    let mut network = match fit.shear {
        ShearSprings::Edges => edge_springs(mesh, material.clone(), fit)?,
        ShearSprings::Cells => {
            let materials = material.materials()?;
            let fits = mesh.blocks.iter().enumerate().map(|(index, block)| {
                let of_block = materials.block(index);
                fit_exact(&block.element, &mesh.points, &block.connectivity, of_block, fit, &mut |_| {})
            });
            Network::assemble(mesh, &fits.collect::<Result<Vec<_>>>()?)
        }
    };
    if fit.volume == VolumeSprings::Patches {
        network.others.extend(patch_springs(mesh, material.clone(), fit, held)?);
    }
    Ok(network)
}
