//! The supports and loads of a first scene.

use crate::mesh::{Group, ListedSides, Mesh};
use crate::text::{not_a_line, rounded, toml as quoted};

/// Names of groups that are probably meant to be held.
const HELD: [&str; 8] = ["fix", "clamp", "support", "base", "bottom", "rim", "left", "min"];
/// The share of the points that a group without such a name may hold.
// A group of more points is the body, or its whole surface in a coarse mesh: little would be left that moves.
const MOST_HELD: f64 = 0.4;
/// What the load strains the body by, about. A stress of a hundredth of the modulus shows on a picture, and small
/// displacements still hold.
const STRAIN: f64 = 0.01;
/// The largest number of pieces besides the first that are held one by one.
// A draft is read and changed by hand, and more conditions than fit on a screen are not.
const MOST_PIECES: usize = 20;
/// A body with fewer points than this share in the lowest layers is rounded: it is held over `DEPTH` of its length.
// The lowest layer of a box has more up to twenty layers. A finer box is held over a depth as well, which a draft shows.
const FEW: f64 = 0.05;
// A ball has `3 t² − 2 t³` of its volume in a layer of the share t of its diameter: 4 % at this depth, with 12 % of its
// surface.
const DEPTH: f64 = 0.12;

/// The supports and loads.
pub(super) fn conditions(mesh: &Mesh, longest: f64, young: f64) -> Vec<String> {
    let d = mesh.dimension;
    // Near the ends of the body along x.
    let ends = || {
        let along = || mesh.points.iter().step_by(d).copied();
        let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        [0.1, 0.9].map(|share| rounded(low + share * (high - low), 6))
    };
    let none = |why: &str, action: &str| {
        let (example, [low, high]) = (vec!["0"; d - 1].join(", "), ends());
        vec![
            format!("# {why}"),
            format!("# [[fix]]\n# where = \"x < {low}\"\n#\n# [[load]]\n# name = \"pull\""),
            format!("# where = \"x > {high}\"\n# {}", action.replace("EXAMPLE", &example)),
        ]
    };
    if mesh.cell_dimension() < d {
        return none(
            "A surface or curve in space bends freely: it is solved with a [motion]; loads need supports of all points that could bend.",
            "body = [100, EXAMPLE]   # N/m^3; or force (N), displacement (m); a traction (Pa) acts on the outline",
        );
    }
    let mut pieces = mesh.pieces();
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.len()));
    // A part that is held so that small pieces are is larger than one that holds the body.
    let others = others(mesh, &pieces);
    if !others.is_empty() {
        pieces.truncate(1);
    }
    let held_by = |group: &&String| holds(mesh, &pieces, &mesh.groups[*group].points);
    let is_likely = |group: &&String| HELD.iter().any(|word| group.to_lowercase().contains(word));
    // No scene can name another.
    let is_name = |group: &&String| not_a_line(group, false).is_none();
    let able: Vec<&String> = mesh.groups.keys().filter(is_name).filter(held_by).collect();
    // A group such as the whole surface leaves little to move.
    let is_small =
        |group: &&&String| (mesh.groups[**group].points.len() as f64) < MOST_HELD * mesh.point_count() as f64;
    let group = able.iter().find(|group| is_likely(group)).or(able.iter().find(is_small)).copied();
    let mut lines = Vec::new();
    let (held, fix) = match group {
        Some(group) => (mesh.groups[group].points.clone(), format!("group = {}", quoted(group))),
        None => match lowest(mesh, &pieces) {
            Some((points, condition)) => (points, format!("where = {}", quoted(&condition))),
            None => {
                return none(
                    "Too few points are left free to load the body when it is held.",
                    "traction = [100, EXAMPLE]   # Pa; or force (N), body (N/m^3), displacement (m)",
                );
            }
        },
    };
    lines.push(format!("[[fix]]\n{fix}\n# axes = [\"x\"]            # all if absent\n"));
    for condition in &others {
        lines.push(format!(
            "[[fix]]               # another piece of the body, held as a whole\nwhere = {}\n",
            quoted(condition)
        ));
    }
    let zeros = vec!["0"; d - 1].join(", ");
    let is_free = |group: &&Group| group.points.iter().all(|point| held.binary_search(point).is_err());
    let has_sides = |group: &&Group| {
        let ListedSides { sides, lost } = ListedSides::of(mesh, group);
        !sides.is_empty() && lost.is_empty()
    };
    let loaded =
        mesh.groups.iter().filter(|(name, _)| is_name(name)).find(|(_, group)| is_free(group) && has_sides(group));
    lines.push("[[load]]\nname     = \"pull\"".into());
    lines.push(match loaded {
        Some((name, _)) => {
            let traction = rounded(STRAIN * young, 1);
            format!(
                "group    = {}\ntraction = [{traction}, {zeros}]   # Pa; or force (N), body (N/m^3), displacement (m)",
                quoted(name)
            )
        }
        None => {
            // A force per volume adds up along the body, and has the stress of the traction at the far end.
            let body = rounded(STRAIN * young / longest, 1);
            format!("body     = [{body}, {zeros}]   # N/m^3; on a part: traction (Pa), force (N), displacement (m)")
        }
    });
    lines
}

/// Conditions that hold all pieces but the first, each the box of one; empty if there are none or many, or if a box has points of the first.
fn others(mesh: &Mesh, pieces: &[Vec<usize>]) -> Vec<String> {
    let Some((first, others)) = pieces.split_first() else { return Vec::new() };
    if others.len() > MOST_PIECES {
        return Vec::new();
    }
    let longest = mesh.longest_side();
    // The condition holds what is at the end of the piece, whose coordinates a file may have rounded.
    let margin = 1e-6 * longest;
    let condition = |piece: &Vec<usize>| {
        let ends: Vec<[f64; 2]> = (0..mesh.dimension)
            .map(|k| {
                let along = || piece.iter().map(|&p| mesh.point(p)[k]);
                [along().fold(f64::INFINITY, f64::min) - margin, along().fold(f64::NEG_INFINITY, f64::max) + margin]
            })
            .collect();
        let is_in = |p: &usize| mesh.point(*p).iter().zip(&ends).all(|(x, [low, high])| low < x && x < high);
        let texts = ends
            .iter()
            .zip(["x", "y", "z"])
            .map(|([low, high], axis)| format!("{axis} > {low:?} && {axis} < {high:?}"));
        (!first.iter().any(is_in)).then(|| texts.collect::<Vec<_>>().join(" && "))
    };
    others.iter().map(condition).collect::<Option<Vec<String>>>().unwrap_or_default()
}

/// Whether no piece of the body can move if these points are held, and some point is free.
fn holds(mesh: &Mesh, pieces: &[Vec<usize>], points: &[usize]) -> bool {
    let mut is_held = vec![false; mesh.point_count()];
    points.iter().for_each(|&point| is_held[point] = true);
    let held = |piece: &Vec<usize>| piece.iter().copied().filter(|&point| is_held[point]).collect::<Vec<_>>();
    points.len() < mesh.point_count() && pieces.iter().all(|piece| is_rigid(mesh, &held(piece)))
}

/// Whether the points span a line in the plane, and a plane in space: a body that is held there cannot turn.
fn is_rigid(mesh: &Mesh, points: &[usize]) -> bool {
    let at = |point: usize| mesh.point(point);
    let from = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| b - a).collect() };
    let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let Some((&first, others)) = points.split_first() else { return false };
    let arm = |point: &usize| from(at(first), at(*point));
    let longest = others.iter().map(arm).max_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default();
    let length = square(&longest);
    // Two different places hold a plane body, which has one rotation. The comparison is negated, so that NaN holds
    // nothing.
    if !(length > 0.0) || mesh.dimension == 2 {
        return length > 0.0;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // The square of the sine of the angle between the arms; in the middle of a flat set of points some are off the line.
    let off = |v: Vec<f64>| square(&v) / length - (dot(&v, &longest) / length).powi(2);
    // Points within a hundredth of a line would hold a rotation about it with too short a lever.
    others.iter().map(arm).any(|v| off(v) > 1e-4)
}

/// The points that lie lowest along the longest axis, as few layers as hold the body, and the condition that selects them.
fn lowest(mesh: &Mesh, pieces: &[Vec<usize>]) -> Option<(Vec<usize>, String)> {
    let sizes = mesh.extent();
    let axis = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))?;
    let mut along: Vec<f64> = (0..mesh.point_count()).map(|point| mesh.point(point)[axis]).collect();
    let places = along.clone();
    along.sort_by(f64::total_cmp);
    let gaps: Vec<f64> = along
        .windows(2)
        // Nearer places are one layer whose coordinates a file has rounded, or whose surface is rough.
        .filter(|pair| pair[1] - pair[0] > 1e-4 * sizes[axis])
        .map(|pair| (pair[0] + pair[1]) / 2.0)
        .collect();
    let below = |limit: f64| -> Vec<usize> { (0..places.len()).filter(|&point| places[point] < limit).collect() };
    // What holds the body holds it with more points as well.
    let mut place = gaps.partition_point(|limit| !holds(mesh, pieces, &below(*limit)));
    if (below(*gaps.get(place)?).len() as f64) < FEW * places.len() as f64 {
        let deep = along[0] + DEPTH * sizes[axis];
        place = place.max(gaps.partition_point(|limit| *limit < deep));
    }
    let limit = *gaps.get(place)?;
    let text = rounded(limit, 6);
    let written: f64 = text.parse().ok()?;
    // The rounded number is what the scene has: it is given where it selects the same points.
    (below(written) == below(limit)).then(|| (below(limit), format!("{} < {text}", ["x", "y", "z"][axis])))
}
