//! The number of levels of refinement that fit into memory and time.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use springfit_scenes::Scene;

/// The largest number of unknowns of the finest level if cells fill space. Factors then grow with the power 4/3, and
/// 200 000 unknowns take some gigabytes.
const MOST_UNKNOWNS_SOLID: usize = 200_000;
/// The largest number of unknowns for surfaces and curves, whose factors are much smaller.
const MOST_UNKNOWNS: usize = 1_000_000;

/// The largest level has at most this fraction (one fourth) of the unknowns if no number of levels is requested:
/// minutes of work instead of an hour.
const UNASKED: usize = 4;

/// The largest number of unknowns of a level with cells of this dimension.
pub fn most_unknowns(cell_dimension: usize) -> usize {
    if cell_dimension == 3 { MOST_UNKNOWNS_SOLID } else { MOST_UNKNOWNS }
}

/// The number of levels: the requested one, or up to `usual`, as many as have less than a quarter of [`most_unknowns`].
///
/// # Errors
/// The mesh cannot be built or divided, or a level would have more unknowns than [`most_unknowns`].
pub fn plan(scene: &Scene, asked: Option<usize>, usual: usize) -> Result<usize> {
    let coarse = scene.build_mesh()?;
    let most = most_unknowns(coarse.cell_dimension());
    let unknowns = |mesh: &Mesh| mesh.points.len();
    let growth = 1 << coarse.cell_dimension();
    // The second level is counted, because the first refinement of a file has another growth than that of a box; later
    // levels grow about alike.
    let first = unknowns(&coarse);
    // A first level that is too large is not divided: that alone could fill memory.
    let second = if first > most { first } else { unknowns(&scene.clone().halved(1).build_mesh()?) };
    // The product may exceed an integer of 32 bits.
    let at_level = |level: usize| (2..level).fold(second, |n, _| n.saturating_mul(growth));
    let room = (2..=asked.unwrap_or(usual)).take_while(|&level| at_level(level) <= most).last();
    let enough = match asked {
        Some(asked) => room.filter(|room| *room == asked),
        // Two levels are the least of which a difference is known, even if the second takes long.
        None => room.map(|room| (3..=room).take_while(|&level| at_level(level) <= most / UNASKED).last().unwrap_or(2)),
    };
    enough.ok_or_else(|| {
        let limit = format!("{most} unknowns on the finest level");
        let error = match (room, asked) {
            (Some(room), Some(asked)) => Error::expected(
                "levels",
                match room {
                    2 => format!("2 for this mesh, because there may be {limit}"),
                    _ => format!("2 to {room} for this mesh, because there may be {limit}"),
                },
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
