//! Which pieces of a surface are the body.

use super::pieces::Piece;
use crate::error::Result;
use crate::mesh::disjoint::DisjointSets;
use crate::mesh::fill::columns::Columns;
use crate::mesh::fill::crossings::each_crossing;
use crate::mesh::fill::surface::Surface;
use crate::mesh::fill::triangles::{NOT_OF_FILE, Triangles};

/// What a piece is to the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// It is the largest piece, or passes through it or through one that does.
    Body,
    /// It is inside the body, with its normals inwards if those of the body are outwards.
    Cavity,
    /// It is inside the body, and no cavity.
    Inner,
    /// It is outside the body.
    Fragment,
}

/// The share of the surface that may close holes. A hole in a ball that has the share s of its area has `s² (3 − 2 s)` of its volume, 0.7 % of it for 5 %: its
/// cap is flat.
pub(super) const MOST_OPEN: f64 = 0.05;

/// The largest piece by volume, or by area if none has a volume.
pub(super) fn largest(pieces: &[Piece]) -> usize {
    let size = |piece: &Piece| (piece.volume.abs(), piece.area);
    let larger = |a: &usize, b: &usize| {
        let ((volume, area), (other, of_other)) = (size(&pieces[*a]), size(&pieces[*b]));
        // Of equal pieces the first one wins: `max_by` alone would take the last.
        volume.total_cmp(&other).then(area.total_cmp(&of_other)).then(b.cmp(a))
    };
    (0..pieces.len()).max_by(larger).unwrap_or(0)
}

/// What each piece is.
///
/// # Errors
/// The body encloses no volume.
pub(super) fn parts(triangles: &Triangles, pieces: &[Piece]) -> Result<Vec<Part>> {
    let largest = largest(pieces);
    let mut parts = vec![Part::Fragment; pieces.len()];
    parts[largest] = Part::Body;
    // An open sheet is no part of a body, wherever it is.
    let solid: Vec<usize> =
        (0..pieces.len()).filter(|&p| p == largest || pieces[p].open_share() <= MOST_OPEN).collect();
    // A single piece is the body, and no crossings need to be looked for.
    if pieces.len() == 1 {
        return Ok(parts);
    }
    let mut sets = DisjointSets::new(pieces.len());
    let (all, piece_of) = closed(triangles, pieces, &solid);
    let all = Surface::closed(all)?;
    each_crossing(&all, &Columns::of(&all), |[a, b], _, _| sets.join(piece_of[a as usize], piece_of[b as usize]));
    let body = sets.root(largest);
    let of_body: Vec<usize> = solid.iter().copied().filter(|&p| sets.root(p) == body).collect();
    of_body.iter().for_each(|&p| parts[p] = Part::Body);
    let (surface, _) = closed(triangles, pieces, &of_body);
    let surface = Surface::closed(surface)?;
    let columns = Columns::of(&surface);
    for p in (0..pieces.len()).filter(|p| !of_body.contains(p)) {
        // One corner decides for the piece: pieces that pass through the body have been joined to it before.
        let [corner, ..] = triangles.corners[pieces[p].triangles[0]];
        let is_inside = columns.winding(triangles.points[corner]) > 0;
        // The volumes have signs: those of opposite signs have their normals opposite.
        let is_against = pieces[p].volume * pieces[largest].volume < 0.0;
        parts[p] = match (is_inside, is_against && solid.contains(&p)) {
            (false, _) => Part::Fragment,
            (true, true) => Part::Cavity,
            (true, false) => Part::Inner,
        };
    }
    Ok(parts)
}

/// Some pieces with their holes closed and their normals outwards, and the piece of each triangle.
fn closed(triangles: &Triangles, pieces: &[Piece], which: &[usize]) -> (Triangles, Vec<usize>) {
    let mut piece_of = Vec::new();
    let mut all = Triangles { points: triangles.points.clone(), corners: Vec::new(), faces: Vec::new(), flat: 0 };
    for &p in which {
        all.corners.extend(pieces[p].closed(triangles, pieces[p].volume < 0.0));
        piece_of.resize(all.corners.len(), p);
    }
    all.faces = vec![NOT_OF_FILE; all.corners.len()];
    (all, piece_of)
}
