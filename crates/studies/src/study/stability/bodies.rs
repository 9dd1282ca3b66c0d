//! Whole bodies: regions of different stiffness, and meshes whose parts do not fit.

use super::elements::PROMISED;
use super::outcome::{Family, StabilityRow, Verdict, worst};
use crate::dynamics::largest_square;
use crate::element::Element;
use crate::error::Result;
use crate::material::Moduli;
use crate::mesh::{Annotations, BoxMesh, Format, Gate, Mesh, MeshSource, NumberOrigin, Selection, SourceBlock};
use crate::model::{Action, Entries, LengthSpring, Network, Support, finite_elements, nodal_forces, unheld_bodies};
use crate::solve::{Factor, System};
use crate::springs::norm;
use std::sync::Arc;

/// The powers of ten of the ratio of the stiffness of the second region to that of the first.
const CONTRASTS: [i32; 9] = [-12, -9, -6, -3, 0, 3, 6, 9, 12];
/// The number of springs in the chain.
const ROW: usize = 64;
/// Power iterations with the inverse; the condition number is needed to one digit.
const POWERS: usize = 40;

/// A bar of each straight element that fills a box in space, a chain of springs, and meshes of squares.
///
/// # Errors
/// A system does not fit into memory.
pub fn sweep_bodies(elements: &[Element]) -> Result<Vec<StabilityRow>> {
    let is_straight = |element: &&Element| element.has_corners_alone();
    let solids = elements.iter().filter(|element| element.dimension() == 3).filter(is_straight);
    let solids: Vec<Arc<Element>> = solids.map(|element| Arc::new(element.clone())).collect();
    let mut rows = Vec::new();
    for decade in CONTRASTS {
        let ratio = 10f64.powi(decade);
        let case = format!("1 : 1e{decade}");
        for element in &solids {
            rows.push(bar(element, &case, ratio)?);
        }
        rows.push(springs_in_a_row(&case, ratio)?);
    }
    rows.extend(meshes().into_iter().map(|(case, source, hold)| mesh_row(case, &source, hold)));
    Ok(rows)
}

/// What helps where stiffnesses side by side differ too much.
const CONTRAST: &str = "hold the stiff part in place of a stiffness that no number beside the soft one can have";

/// A bar of two cubes, ν = 0, under tension, with the exact solution `u = σ (ℓ/E₁ + ℓ/E₂)` at its end.
fn bar(element: &Arc<Element>, case: &str, ratio: f64) -> Result<StabilityRow> {
    let spec =
        BoxMesh { element: element.clone(), size: vec![2.0, 1.0, 1.0], cells: vec![6, 3, 3], origin: vec![0.0; 3] };
    let whole = spec.build()?;
    let middle = |nodes: &[usize]| nodes.iter().map(|p| whole.point(*p)[0]).sum::<f64>() / nodes.len() as f64;
    let first: Vec<bool> = whole.blocks[0].cells().map(|nodes| middle(nodes) < 1.0).collect();
    let mut entries = Entries::new();
    for (side, young) in [(true, 1.0), (false, ratio)] {
        let mut part = whole.clone();
        let cells = whole.blocks[0].cells().zip(&first).filter(|(_, is_first)| **is_first == side);
        // Both halves keep all points, so that their entries belong to one matrix.
        part.blocks[0].connectivity = cells.flat_map(|(nodes, _)| nodes.to_vec()).collect();
        // With ν = 0 the moduli are λ = 0 and μ = E/2.
        entries.extend(finite_elements(&part, Moduli { lambda: 0.0, mu: young / 2.0 }));
    }
    let mut support = Support::free(&whole);
    support.fix(&Selection::Group("xmin".into()).points(&whole)?, &[0, 1, 2], 3);
    let pulled = Selection::Group("xmax".into());
    let f = nodal_forces(&whole, &pulled, &Action::traction(&[1.0, 0.0, 0.0]), 1.0)?;
    let ends: Vec<usize> = pulled.points(&whole)?.iter().map(|p| 3 * p).collect();
    // Two halves of length 1 m under 1 Pa. With ν = 0 nothing contracts, so that the held end does not disturb the
    // uniaxial stress.
    let exact = 1.0 + 1.0 / ratio;
    // The entries of an element are rounded, and those of a stiff one have errors as large as those of a soft one.
    solved((&format!("bar of {}", element.name), case, true), &entries, &support, &f, &ends, exact)
}

/// A chain of springs from a wall, with alternating constants 1 and `ratio`, and the exact solution `u = f Σ 1/k`.
fn springs_in_a_row(case: &str, ratio: f64) -> Result<StabilityRow> {
    let constant = |i: usize| if i.is_multiple_of(2) { 1.0 } else { ratio };
    let lengths = (0..ROW).map(|i| LengthSpring { points: [i, i + 1], constant: constant(i), rest: 1.0 }).collect();
    let network = Network { dimension: 2, lengths, others: Vec::new() };
    let points: Vec<f64> = (0..=ROW).flat_map(|i| [i as f64, 0.0]).collect();
    let mut support = Support { prescribed: vec![None; points.len()] };
    // Straight springs have no stiffness across the row, and points are held there.
    support.fix(&(0..=ROW).collect::<Vec<_>>(), &[1], 2);
    support.fix(&[0], &[0], 2);
    let mut f = vec![0.0; points.len()];
    f[2 * ROW] = 1.0;
    // Springs in a row add up their compliances, half of which are 1 and half 1/ratio.
    let exact = (ROW / 2) as f64 * (1.0 + 1.0 / ratio);
    solved(("springs in a row", case, false), &network.stiffness(&points), &support, &f, &[2 * ROW], exact)
}

/// Compares the displacements at `ends` under the forces f with the exact ones. If the entries of the matrix are
/// rounded, the error that this causes is its condition number, with each point scaled to a stiffness of one.
fn solved(
    (subject, case, is_rounded): (&str, &str, bool),
    entries: &Entries,
    support: &Support,
    f: &[f64],
    ends: &[usize],
    exact: f64,
) -> Result<StabilityRow> {
    let of = |verdict| StabilityRow::new(subject, Family::Contrast, case, "factor, refined", verdict);
    let system = System::new(entries, support)?;
    let Some(factor) = system.cholesky()? else {
        return Ok(
            of(Verdict::Refused("the stiffness is not positive definite in rounding".into())).with_way_out(CONTRAST)
        );
    };
    let (u, left) = system.solve(&factor, f);
    if !(left <= PROMISED) {
        let left = format!("{left:.1e} of the forces or displacements are left");
        return Ok(of(Verdict::Refused(left)).with_way_out(CONTRAST));
    }
    let error = worst(ends.iter().map(|&dof| (u[dof] - exact).abs() / exact));
    let mut diagonal = vec![0.0; f.len()];
    entries.iter().filter(|e| e.row == e.col).for_each(|e| diagonal[e.row] += e.val);
    let scaled: Entries = entries
        .iter()
        .map(|e| faer::sparse::Triplet::new(e.row, e.col, e.val / (diagonal[e.row] * diagonal[e.col]).sqrt()))
        .collect();
    let held: Vec<bool> = support.prescribed.iter().map(Option::is_some).collect();
    // Scaled to a unit diagonal, the condition number is that of the network, not that of its units of stiffness.
    let ones = vec![1.0; f.len()];
    let largest = largest_square(scaled.iter().map(|e| (e.row, e.col, e.val)), &ones, &held);
    let scaled = System::new(&scaled, support)?;
    let softest = scaled.cholesky()?.map(|factor| 1.0 / (largest * compliance(&factor, scaled.size())));
    // Entries that are rounded at the size of the largest stiffness change the softest motion by ε over its share of
    // that stiffness.
    let rounding = if is_rounded { f64::EPSILON / softest.unwrap_or(0.0) } else { 0.0 };
    let allowed = rounding.max(PROMISED);
    let verdict = match error {
        error if error <= PROMISED => Verdict::Accurate,
        error if error <= allowed => Verdict::InputLimited,
        _ => Verdict::Lost,
    };
    let mut row = of(verdict).with_error(error, allowed);
    row.condition = softest.map(|softest| 1.0 / softest);
    row.softest = softest;
    Ok(row)
}

/// The largest eigenvalue of the inverse, by power iteration.
fn compliance(factor: &Factor, size: usize) -> f64 {
    // A start without the symmetry of a body has a part along each motion.
    let mut x: Vec<f64> = (0..size).map(|i| 1.0 + (i as f64).sin()).collect();
    let mut largest = 0.0;
    for _ in 0..POWERS {
        let length = norm(&x);
        x.iter_mut().for_each(|x| *x /= length);
        factor.solve(&mut x);
        largest = norm(&x);
    }
    largest
}

/// Four squares, or a part of them: points, cells, and whether the left side is held.
fn meshes() -> Vec<(&'static str, MeshSource, bool)> {
    let grid = |points: &[[f64; 2]], cells: &[[usize; 4]]| MeshSource {
        format: Format::Gmsh,
        origin: NumberOrigin::GmshTag,
        points: points.iter().map(|p| [p[0], p[1], 0.0]).collect(),
        numbers: Vec::new(),
        blocks: vec![SourceBlock {
            dimension: 2,
            cell_type: 3,
            nodes_per_cell: 4,
            connectivity: cells.concat(),
            groups: Vec::new(),
            is_marker: true,
            runs: Vec::new(),
        }],
        space: None,
        annotations: Annotations::default(),
    };
    let two: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]];
    let sound = [[0, 1, 2, 3], [1, 4, 5, 2]];
    let more = |extra: &[[f64; 2]]| [two, extra].concat();
    let hanging = more(&[[1.0, 0.5], [2.0, 0.5]]);
    let twice = more(&[[1.0, 0.0], [1.0, 1.0]]);
    let apart = more(&[[5.0, 0.0], [6.0, 0.0], [6.0, 1.0], [5.0, 1.0]]);
    let flat = more(&[[3.0, 0.0], [3.0, 1e-12], [3.0, 0.0]]);
    vec![
        ("two cells that fit", grid(two, &sound), true),
        ("a node hangs on the side of a cell", grid(&hanging, &[[0, 1, 2, 3], [1, 4, 7, 6], [6, 7, 5, 2]]), true),
        ("nodes twice at the same place", grid(&twice, &[[0, 1, 2, 3], [6, 4, 5, 7]]), true),
        ("a node that no cell has", grid(&more(&[[9.0, 9.0]]), &sound), true),
        ("two bodies apart, one not held", grid(&apart, &[[0, 1, 2, 3], [6, 7, 8, 9]]), true),
        ("nothing held", grid(two, &sound), false),
        ("one cell reversed", grid(two, &[[0, 1, 2, 3], [1, 2, 5, 4]]), true),
        ("one cell tangled", grid(two, &[[0, 1, 2, 3], [1, 5, 4, 2]]), true),
        ("one cell flat", grid(&flat, &[[0, 1, 2, 3], [4, 6, 7, 8]]), true),
    ]
}

/// The result for a mesh whose left side is held, or that is not held anywhere.
fn mesh_row(case: &str, source: &MeshSource, hold: bool) -> StabilityRow {
    let of = |verdict| StabilityRow::new("mesh of squares", Family::Mesh, case, "read and held", verdict);
    let mesh = match Mesh::resolve_within(source, &[], 1.0, Some(Gate::default())) {
        Ok(mesh) => mesh,
        Err(e) => {
            return of(Verdict::Refused(e.to_string()))
                .with_way_out("mend the cells or the points that the error names");
        }
    };
    let mut said = Vec::new();
    let mut say = |count: usize, what: &str| said.extend((count > 0).then(|| format!("{count} {what}")));
    say(mesh.reversed, "cells turned");
    say(mesh.unused_points, "nodes left out");
    say(mesh.quality.coincident.unwrap_or(0), "nodes at the place of another");
    say(mesh.quality.hanging.unwrap_or(0), "nodes that hang");
    say(mesh.quality.poor.unwrap_or(0), "cells of poor quality");
    let mut support = Support::free(&mesh);
    if hold {
        let left: Vec<usize> = (0..mesh.point_count()).filter(|&p| mesh.point(p)[0] == 0.0).collect();
        support.fix(&left, &[0, 1], 2);
    }
    let unheld = unheld_bodies(&mesh, &support);
    for body in &unheld {
        said.push(format!("a body of {} nodes with {} rigid motions left", body.points, body.motions));
    }
    match said.is_empty() {
        true => of(Verdict::Accurate),
        false if unheld.is_empty() => of(Verdict::Told(said.join(", "))),
        false => of(Verdict::Told(said.join(", "))).with_way_out("hold a node of each body, or join the bodies"),
    }
}
