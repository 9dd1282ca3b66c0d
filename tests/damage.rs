//! Files that are damaged, and what is still true of a mesh that is read.

use crate::shapes::Random;
use springfit_mesh::mesh::MeshSource;

/// The file with one to three faults in turn: bytes and bits that are others, cut, put in, left out or filled.
pub fn damaged(whole: &[u8], round: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..1 + round % 3 {
        let at = random.below(bytes.len());
        let end = (at + random.below(16)).min(bytes.len());
        match random.below(9) {
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] = b"0123456789 -.,$\"<>=*+#e\n\xff\0"[random.below(26)],
            2 => bytes[at] ^= 1 << random.below(8),
            3 => drop(bytes.remove(at)),
            4 => bytes.insert(at, b'9'),
            5 => drop(bytes.splice(at..at, *b"99")),
            6 => drop(bytes.drain(at..end)),
            7 => bytes.truncate(at),
            _ => bytes[at..end].fill(255),
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// What the rest of the program relies on.
pub fn assert_sound(mesh: &MeshSource) {
    for block in &mesh.blocks {
        assert!(block.dimension <= 3 && block.nodes_per_cell > 0 && !block.connectivity.is_empty());
        assert_eq!(block.connectivity.len() % block.nodes_per_cell, 0);
        assert!(block.connectivity.iter().all(|&node| node < mesh.points.len()));
    }
}
