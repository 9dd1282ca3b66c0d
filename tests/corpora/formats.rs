//! A mesh of any format: the first byte says which of the endings that are read the rest has. The files of TetGen are parted by zeros.

use super::meshes;
use springfit_mesh::mesh::{MESH_FORMATS, MeshSource};

pub fn check(bytes: &[u8]) {
    let Some((first, content)) = bytes.split_first() else { return };
    let endings: Vec<&str> = MESH_FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    match endings[usize::from(*first) % endings.len()] {
        "node" | "ele" => {
            let mut files = content.splitn(3, |byte| *byte == 0);
            let (node, ele) = (files.next().unwrap_or_default(), files.next().unwrap_or_default());
            meshes::check_result(MeshSource::parse_tetgen(node, ele, files.next()));
        }
        ending => meshes::check(content, ending),
    }
}
