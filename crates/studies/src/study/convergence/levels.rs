//! How many levels of refinement a scene has room for.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::study::scene::Scene;

/// Unknowns of the finest level at most: where cells fill space, factors grow as their power 4/3, and 200 000 take some gigabytes.
const MOST_UNKNOWNS_SOLID: usize = 200_000;
const MOST_UNKNOWNS: usize = 1_000_000;

/// Of these, the share that is used where no number of levels is asked for: some minutes of work, not an hour.
const UNASKED: usize = 4;

/// The most unknowns that a level may have if its cells are of this dimension.
pub fn most_unknowns(cell_dimension: usize) -> usize {
    if cell_dimension == 3 { MOST_UNKNOWNS_SOLID } else { MOST_UNKNOWNS }
}

/// The number of levels: as many as asked for, or else up to `usual`, as many as stay below a quarter of [`most_unknowns`].
///
/// # Errors
/// The mesh cannot be built or divided, or a level would have more unknowns than [`most_unknowns`].
pub fn plan(scene: &Scene, asked: Option<usize>, usual: usize) -> Result<usize> {
    let coarse = scene.build_mesh()?;
    let most = most_unknowns(coarse.cell_dimension());
    let unknowns = |mesh: &Mesh| mesh.points.len();
    let growth = 1 << coarse.cell_dimension();
    // The second level is counted, for a mesh file grows otherwise than a box at first; the others have about the same growth.
    let first = unknowns(&coarse);
    let second = if first > most { first } else { unknowns(&scene.clone().halved(1).build_mesh()?) };
    let at_level = |level: usize| (2..level).fold(second, |n, _| n.saturating_mul(growth));
    let room = (2..=asked.unwrap_or(usual)).take_while(|&level| at_level(level) <= most).last();
    let enough = match asked {
        Some(asked) => room.filter(|room| *room == asked),
        None => room.map(|room| (3..=room).take_while(|&level| at_level(level) <= most / UNASKED).last().unwrap_or(2)),
    };
    enough.ok_or_else(|| {
        let limit = format!("{most} unknowns on the finest level");
        let error = match (room, asked) {
            (Some(room), Some(asked)) => Error::expected(
                "levels",
                format!("2 to {room} for this mesh, for there may be {limit}"),
                format!("{asked}, about {} unknowns", at_level(asked)),
            ),
            _ => {
                let level = if first > most { "first" } else { "second" };
                let found = format!("{second} unknowns on the {level} level");
                scene.placed(Error::expected("mesh", format!("at most {limit}"), found))
            }
        };
        error.of_kind(ErrorKind::Limit)
    })
}
