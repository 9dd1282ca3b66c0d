//! The size of a body.

use crate::mesh::Mesh;
use crate::text::rounded;

/// `from 0 to 0.1 m along x, …`: where the body is.
pub fn extends(mesh: &Mesh) -> String {
    let along = |([least, most], axis): ([f64; 2], &str)| {
        format!("from {} to {} m along {axis}", rounded(least, 4), rounded(most, 4))
    };
    mesh.ranges().into_iter().zip(["x", "y", "z"]).map(along).collect::<Vec<_>>().join(", ")
}

/// A longer body of a file is rarely meant, m.
const LONGEST: f64 = 10.0;
/// A shorter body of a file is rarely meant, m.
const SHORTEST: f64 = 1e-4;

/// Says that a body of a file is so long or so short that its unit may not be the metre, which it is where no unit is stated. `key` is where one
/// is stated: `scale = "mm"`, or the option `--scale mm`.
pub fn unit_note(mesh: &Mesh, key: &str) -> Option<String> {
    let longest = mesh.longest_side();
    let taken = format!("the coordinates of the mesh are taken in metres: the body is {} m long", rounded(longest, 2));
    if longest > LONGEST {
        return Some(format!("{taken}; {key} if they are in millimetres, and \"m\" in its place if this is right"));
    }
    (longest < SHORTEST).then(|| {
        format!("{taken}; {key} or another unit if they are not in metres, and \"m\" in its place if this is right")
    })
}
