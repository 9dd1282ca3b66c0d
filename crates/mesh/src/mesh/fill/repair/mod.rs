//! Mends a scanned surface: welds corners, leaves out what is double, flat or apart, turns triangles alike and outwards, closes small holes.

mod body;
mod holes;
mod patches;
mod pieces;
mod record;
mod sheets;
mod weld;

pub use record::{Fragments, Repair};
pub(super) use weld::weld;

use super::edges::passes;
use super::place::{length, place};
use super::surface::Surface;
use super::triangles::{NOT_OF_FILE, Triangles};
use crate::error::{Error, Result};
use body::{MOST_OPEN, Part, largest, parts};
use holes::Hole;
use patches::Patches;
use pieces::Piece;

/// The closed surface of the body among these triangles, and what was changed; `scale` is the unit of the file, by which an error names
/// places.
///
/// # Errors
/// Holes have more than [`MOST_OPEN`] of the surface, triangles cannot be turned alike, or nothing encloses a volume.
pub(super) fn repaired(mut triangles: Triangles, scale: f64) -> Result<(Surface, Repair)> {
    // The volume of a surface with holes depends on the place from which it is measured.
    let [low, high] = triangles.ends();
    let from = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
    let whole: f64 = triangles.corners.iter().map(|&t| triangles.area(t)).sum();
    let given_volume = triangles.corners.iter().map(|&t| triangles.volume(t, from)).sum();
    let mut repair = Repair { given_volume, given: triangles.corners.len(), ..Repair::default() };
    // Welding comes first, because all that follows asks which triangles share an edge.
    let welded = weld(&mut triangles);
    (repair.welded, repair.doubles) = ((welded.corners, welded.distance), welded.doubles);
    let sheets = sheets::leave_out(&mut triangles);
    (repair.flat, repair.sheets) = (triangles.flat + sheets.flat, sheets.triangles);
    let (turned, twisted) = turn_alike(&mut triangles, scale)?;
    repair.twisted = twisted;
    if triangles.corners.is_empty() {
        let found = format!("{} without", repair.given);
        return Err(Error::expected("surface", "triangles with an area", found));
    }
    let pieces = Piece::all(&triangles);
    let body = largest(&pieces);
    check_holes(&triangles, &pieces[body], scale)?;
    let parts = parts(&triangles, &pieces)?;
    let mut all = Triangles { points: Vec::new(), corners: Vec::new(), faces: Vec::new(), flat: repair.flat };
    let mut holes: Vec<&Hole> = Vec::new();
    for (piece, part) in pieces.iter().zip(&parts) {
        let is_body = *part == Part::Body;
        let left_out = match part {
            Part::Body | Part::Cavity => {
                // A cavity has its normals inwards.
                let is_turned = (piece.volume < 0.0) == is_body;
                all.corners.extend(piece.closed(&triangles, is_turned));
                all.faces.extend(piece.triangles.iter().map(|&t| triangles.faces[t]));
                all.faces.resize(all.corners.len(), NOT_OF_FILE);
                repair.turned += piece.triangles.iter().filter(|&&t| turned[t] != is_turned).count();
                holes.extend(&piece.holes);
                *(if is_body { &mut repair.layers } else { &mut repair.cavities }) += 1;
                continue;
            }
            Part::Inner => &mut repair.inner,
            Part::Fragment => &mut repair.fragments,
        };
        left_out.count += 1;
        left_out.triangles += piece.triangles.len();
        left_out.share += piece.area / whole;
        left_out.at = triangles.points[triangles.corners[piece.triangles[0]][0]];
    }
    repair.holes = holes.len();
    let longest = holes.iter().map(|hole| (hole, hole.length(&triangles))).max_by(|a, b| a.1.total_cmp(&b.1));
    repair.largest_hole = longest.map(|(hole, around)| (hole.points.len(), around, triangles.points[hole.points[0]]));
    let closed: f64 = holes.iter().map(|hole| hole.area).sum();
    all.points = triangles.points;
    let surface = Surface::closed(all)?;
    repair.closed = closed / surface.area;
    repair.volume = surface.volume;
    Ok((surface, repair))
}

/// The share of the area at which a surface may turn over, as triangles that were put together wrongly do: these are left out, and leave holes. A
/// strip or a bottle with one side alone has more, or is an open sheet where it is cut.
const MOST_TWISTED: f64 = 0.01;

/// Turns the triangles of each patch alike; returns which were turned, and how many were left out because they cannot be.
///
/// # Errors
/// A patch has one side alone.
fn turn_alike(triangles: &mut Triangles, scale: f64) -> Result<(Vec<bool>, usize)> {
    let given = triangles.corners.len();
    let area = |triangles: &Triangles| triangles.corners.iter().map(|&t| triangles.area(t)).sum::<f64>();
    let whole = area(triangles);
    // Leaving triangles out opens new edges, at which others may turn over; the area that is left bounds the rounds.
    loop {
        let patches = Patches::of(triangles, &passes(&triangles.corners));
        let Some(&one) = patches.twisted.first() else {
            let turned = triangles.corners.iter_mut().zip(&patches.turned).filter(|(_, is_turned)| **is_turned);
            turned.for_each(|(corners, _)| corners.swap(1, 2));
            return Ok((patches.turned, given - triangles.corners.len()));
        };
        let ends = |[a, b, c]: [usize; 3]| [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [a.min(c), a.max(c)]];
        let is_twisted = |&t: &[usize; 3]| ends(t).iter().any(|edge| patches.twisted.binary_search(edge).is_ok());
        let middle = triangles.middle(one);
        let twisted: Vec<bool> = triangles.corners.iter().map(is_twisted).collect();
        triangles.retain(|t| !twisted[t]);
        // Also refuses what is not a number.
        if !(area(triangles) >= (1.0 - MOST_TWISTED) * whole) {
            let count = patches.twisted.len();
            let found =
                format!("one with one side alone, which turns over at {count} edges, one at {}", place(middle, scale));
            return Err(Error::expected("surface", "a surface with an inside and an outside", found));
        }
    }
}

/// That the holes of the largest piece are small.
///
/// # Errors
/// They are not.
fn check_holes(triangles: &Triangles, piece: &Piece, scale: f64) -> Result<()> {
    let share = piece.open_share();
    // Also refuses what is not a number.
    if share <= MOST_OPEN {
        return Ok(());
    }
    let largest = piece.holes.iter().max_by(|a, b| a.area.total_cmp(&b.area));
    let largest = largest.map_or(String::new(), |hole| {
        let at = place(triangles.points[hole.points[0]], scale);
        format!(
            ", the largest with {} edges and {} around, at {at}",
            hole.points.len(),
            length(hole.length(triangles), scale)
        )
    });
    let expected = format!("holes of at most {:.0} % of the surface, which a repair closes", 100.0 * MOST_OPEN);
    let holes = piece.holes.len();
    let found = format!(
        "{holes} of {:.0} %{largest}; scan the sides that are missing, or close them in a modelling program",
        100.0 * share
    );
    Err(Error::expected("surface", expected, found))
}
