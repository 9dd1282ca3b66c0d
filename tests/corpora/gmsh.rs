//! A Gmsh mesh.

use super::meshes;

pub fn check(bytes: &[u8]) {
    meshes::check(bytes, "msh");
}
