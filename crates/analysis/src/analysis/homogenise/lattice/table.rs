//! The lattices that are known by name: a new one is a row here.

use super::definition::{NamedLattice, Root};
use crate::error::Result;
use crate::named::unknown;

const CUBE: [[i64; 3]; 3] = [[12, 0, 0], [0, 12, 0], [0, 0, 12]];
const FACES: [[i64; 3]; 3] = [[0, 6, 6], [6, 0, 6], [6, 6, 0]];

/// The lattices that are known by name.
const LATTICES: [NamedLattice; 8] = [
    NamedLattice {
        name: "triangular",
        title: "triangles of equal sides",
        shells: &["edges"],
        root: Root::OfThree,
        cell: &[[12, 0, 0], [6, 6, 0]],
        points: &[[0, 0, 0]],
        squares: &[144],
    },
    NamedLattice {
        name: "square",
        title: "squares with both diagonals",
        shells: &["edges", "diagonals"],
        root: Root::One,
        cell: &[[12, 0, 0], [0, 12, 0]],
        points: &[[0, 0, 0]],
        squares: &[144, 288],
    },
    NamedLattice {
        name: "honeycomb",
        title: "hexagons whose sides are a/√3 long, with second neighbours at the distance a",
        shells: &["sides", "second neighbours"],
        root: Root::OfThree,
        cell: &[[12, 0, 0], [6, 6, 0]],
        points: &[[0, 0, 0], [6, 2, 0]],
        // With the unit √3/12 along y a side has the square `6² + 3 · 2² = 48`, of the length a/√3.
        squares: &[48, 144],
    },
    NamedLattice {
        name: "kagome",
        title: "triangles that share corners, with sides a/2, and second neighbours",
        shells: &["sides", "second neighbours"],
        root: Root::OfThree,
        cell: &[[12, 0, 0], [6, 6, 0]],
        points: &[[0, 0, 0], [6, 0, 0], [3, 3, 0]],
        // A side has `3² + 3 · 3² = 36`, of the length a/2; second neighbours are `√108/12 = √3/2` apart.
        squares: &[36, 108],
    },
    NamedLattice {
        name: "cubic",
        title: "Born's cubic lattice: edges, and the diagonals of faces and of cubes",
        shells: &["edges", "face diagonals", "space diagonals"],
        root: Root::One,
        cell: &CUBE,
        points: &[[0, 0, 0]],
        squares: &[144, 288, 432],
    },
    NamedLattice {
        name: "bcc",
        title: "body-centred cubes: half space diagonals, and edges",
        shells: &["nearest neighbours", "edges"],
        root: Root::One,
        cell: &[[-6, 6, 6], [6, -6, 6], [6, 6, -6]],
        points: &[[0, 0, 0]],
        // Half a space diagonal has the square `3 · 6² = 108`.
        squares: &[108, 144],
    },
    NamedLattice {
        name: "fcc",
        title: "face-centred cubes: half face diagonals, and edges",
        shells: &["nearest neighbours", "edges"],
        root: Root::One,
        cell: &FACES,
        points: &[[0, 0, 0]],
        // Half the diagonal of a face has the square `2 · 6² = 72`.
        squares: &[72, 144],
    },
    NamedLattice {
        name: "diamond",
        title: "diamond: four nearest neighbours, and second neighbours",
        shells: &["nearest neighbours", "second neighbours"],
        root: Root::One,
        cell: &FACES,
        points: &[[0, 0, 0], [3, 3, 3]],
        // A quarter of the space diagonal has the square `3 · 3² = 27`; second neighbours are the nearest ones of one
        // sublattice.
        squares: &[27, 72],
    },
];

impl NamedLattice {
    /// All of them.
    pub fn all() -> &'static [NamedLattice] {
        &LATTICES
    }

    /// The lattice of this name.
    ///
    /// # Errors
    /// None has it.
    pub fn named(name: &str) -> Result<&'static NamedLattice> {
        LATTICES.iter().find(|lattice| lattice.name == name).ok_or_else(|| {
            let names: Vec<&str> = LATTICES.iter().map(|lattice| lattice.name).collect();
            unknown(format!("one of {}", names.join(", ")), names.iter().copied(), name)
        })
    }
}
