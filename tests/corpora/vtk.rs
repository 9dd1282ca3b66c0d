//! A grid of VTK: legacy if it begins as such, else XML.

use super::meshes;

pub fn check(bytes: &[u8]) {
    meshes::check(bytes, if bytes.starts_with(b"#") { "vtk" } else { "vtu" });
}
