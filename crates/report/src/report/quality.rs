//! What is wrong with a mesh, in words.

use crate::mesh::{Filled, Mesh, Quality};

/// A number of things, `1 cell` or `2 cells`.
pub(super) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Returns a number of things, `1 cell` or `2 cells`, with the verbs that follow it.
fn with_verbs(count: usize, thing: &str) -> (String, &'static str, &'static str) {
    let (are, were) = if count == 1 { ("is", "was") } else { ("are", "were") };
    (counted(count, thing), are, were)
}

/// What a reader must know of the mesh: what was changed in it, and what is wrong with its cells and points; one line each.
pub fn mesh_notes(mesh: &Mesh) -> Vec<String> {
    changes(mesh).into_iter().chain(quality_lines(&mesh.quality)).collect()
}

/// Which cells were turned, and how many points were left out.
pub(super) fn changes(mesh: &Mesh) -> Vec<String> {
    let turned = "elements had their nodes in inverted order and were reversed";
    let turned = (mesh.reversed > 0).then(|| match &mesh.quality.turned {
        None => format!("{} {turned}", mesh.reversed),
        Some(which) => format!("{} of {} {turned}: {which}", mesh.reversed, mesh.cell_count()),
    });
    let unused = (mesh.unused_points > 0)
        .then(|| format!("{} points of the file belong to no cell of the body and were left out", mesh.unused_points));
    turned.into_iter().chain(unused).chain(mesh.annotations.notes()).collect()
}

/// What is wrong with the cells and points of a mesh, one line each.
pub(super) fn quality_lines(quality: &Quality) -> Vec<String> {
    let mut lines = quality.filled.as_ref().map_or(Vec::new(), Filled::lines);
    if quality.skipped > 0 {
        let (cells, are, were) = with_verbs(quality.skipped, "cell");
        lines.push(format!("{cells} that {are} flat, tangled or of poor quality {were} left out"));
    }
    if quality.duplicates > 0 {
        let (cells, _, were) = with_verbs(quality.duplicates, "cell");
        lines.push(format!("{cells} with the nodes of another {were} left out"));
    }
    if quality.folded > 0 {
        let (cells, are, were) = with_verbs(quality.folded, "cell");
        lines.push(format!("{cells} that {are} folded over their neighbours {were} left out"));
    }
    if let Some((count, which)) = &quality.folding {
        let folds = if *count == 1 { "folds" } else { "fold" };
        lines.push(format!(
            "{} {folds} between quadrature points, where the Jacobian is negative, so that the map of the cell is not one to one: {which}",
            counted(*count, "curved cell")
        ));
    }
    if let (Some(worst), Some(cell), Some(poor @ 1..)) = (quality.worst, &quality.worst_cell, quality.poor) {
        lines.push(format!(
            "{} with a quality below {:e}, the worst {worst:.1e} ({cell}): such spring constants lose accuracy in proportion",
            counted(poor, "cell"),
            quality.least,
        ));
    }
    if let Some(count) = quality.coincident.filter(|count| *count > 0) {
        lines.push(format!("{count} points coincide with another point: the body is not connected there"));
    }
    if let Some(count) = quality.hanging.filter(|count| *count > 0) {
        lines.push(format!(
            "{count} points lie on edges or faces whose cells do not have them as nodes (hanging nodes)"
        ));
    }
    if quality.overlapping > 0 {
        let (cells, _, _) = with_verbs(quality.overlapping, "cell");
        let lie = if quality.overlapping == 1 { "lies" } else { "lie" };
        lines.push(format!(
            "{cells} {lie} over others on the same side of an edge or face that they share: the body is there twice"
        ));
    }
    if quality.crossing > 0 {
        let have = if quality.crossing == 1 { "has" } else { "have" };
        let cells = counted(quality.crossing, "cell");
        lines.push(format!("{cells} {have} parts of another piece of the mesh inside: the body is there twice"));
    }
    if quality.unwelded {
        lines.push(
            "the surface is not welded: most of its cells share no corner with another and move apart; filling it with repair = true (--fill with --repair) \
             welds it and makes a solid of what it encloses"
                .into(),
        );
    }
    if let Some(count) = quality.pieces.filter(|count| *count > 1) {
        lines.push(format!("the mesh has {count} pieces that share no node"));
    }
    lines
}
