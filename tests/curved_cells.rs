//! Curved cells that fold between their quadrature points: against dense sampling, on all shipped elements.

use crate::shapes::elements;
use nalgebra::DMatrix;
use springfit_element::element::{Cell, Element, JacobianBounds, Quadrature, Tabulation};
use springfit_mesh::mesh::{Below, Gate, MeshArrays};
use springfit_numerics::dense::product;
use springfit_report::report;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The elements whose nodes are not their corners alone, in the plane and in space.
fn curved() -> Vec<Arc<Element>> {
    let all = elements().into_iter();
    all.filter(|element| element.dimension() > 1 && !element.has_corners_alone()).map(Arc::new).collect()
}

/// Numbers between −1 and 1, the same on every machine.
fn random() -> impl FnMut() -> f64 {
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Points of a grid of a cell: of the box around it those that are in it. That of a pyramid narrows with it, up to almost the apex, at which its
/// functions are no numbers.
fn grid(element: &Element, along: usize) -> Tabulation {
    let d = element.dimension();
    let low = if matches!(element.cell, Cell::Triangle | Cell::Tetrahedron) { 0.0 } else { -1.0 };
    let place = |i: usize| low + (1.0 - low) * i as f64 / along as f64;
    let all = (0..(along + 1).pow(d as u32)).map(|point| {
        let at = (0..d).map(|k| place(point / (along + 1).pow(k as u32) % (along + 1))).collect::<Vec<f64>>();
        match element.cell {
            Cell::Pyramid => {
                let height = 0.4995 * (1.0 + at[2]);
                vec![at[0] * (1.0 - height), at[1] * (1.0 - height), height]
            }
            _ => at,
        }
    });
    let points = all.filter(|at| element.cell.contains(at)).flatten().collect::<Vec<f64>>();
    let weights = vec![1.0; points.len() / d];
    Tabulation::new(&element.functions, &Quadrature { dimension: d, points, weights }, None)
}

/// The gradients of the functions at all points of a table, `[nodes × points · dimension]`: one product with the nodes gives J at each point.
fn gradients(table: &Tabulation) -> DMatrix<f64> {
    let d = table.dimension;
    let points = table.gradients.len() / (table.nodes * d);
    DMatrix::from_fn(table.nodes, points * d, |a, column| {
        table.gradients[(column / d * table.nodes + a) * d + column % d]
    })
}

/// The least and the largest det J at the points of some gradients.
fn determinants(gradients: &DMatrix<f64>, d: usize, x: &[f64]) -> [f64; 2] {
    let all = every_determinant(gradients, d, x);
    all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, largest], &det| [least.min(det), largest.max(det)])
}

/// det J at each point of some gradients.
fn every_determinant(gradients: &DMatrix<f64>, d: usize, x: &[f64]) -> Vec<f64> {
    let j = product(&DMatrix::from_column_slice(d, gradients.nrows(), x), gradients);
    let at = |j: &[f64]| match *j {
        [a, b, c, e] => a * e - b * c,
        [a, b, c, e, f, g, h, k, l] => a * (f * l - g * k) - b * (e * l - g * h) + c * (e * k - f * h),
        _ => panic!("J is 2 × 2 or 3 × 3"),
    };
    j.as_slice().chunks_exact(d * d).map(at).collect()
}

/// How far a node is moved at most: twice the reference cell.
const FARTHEST: f64 = 4.0;

/// A node is moved until the least determinant on a fine grid is zero. A little before that the cell does not fold (the grid sees a
/// fold a little late), and a hundredth beyond it does, also where no quadrature point sees it.
#[test]
fn a_node_that_is_moved_past_its_limit_folds_the_cell() {
    let mut next = random();
    for element in curved() {
        let d = element.dimension();
        let bounds = JacobianBounds::of(&element).unwrap_or_else(|| panic!("{} has no bounds", element.name));
        let fine = gradients(&grid(&element, if d == 2 { 60 } else { 10 }));
        let own = gradients(&element.tabulation);
        let (mut unseen, mut found) = (0, 0);
        for node in 0..element.nodes() {
            for _ in 0..if d == 2 { 4 } else { 1 } {
                let direction: Vec<f64> = (0..d).map(|_| next()).collect();
                let moved = |length: f64| {
                    let mut x = element.positions.clone();
                    (0..d).for_each(|k| x[node * d + k] += length * direction[k]);
                    x
                };
                // J of one node that moves along a line changes by a matrix of rank one, so det J is linear in the length of the way.
                let [at_rest, farthest] = [0.0, FARTHEST].map(|length| every_determinant(&fine, d, &moved(length)));
                let crossings = at_rest.iter().zip(&farthest).filter(|(_, far)| **far <= 0.0);
                let limit = crossings.map(|(rest, far)| FARTHEST * rest / (rest - far)).fold(f64::INFINITY, f64::min);
                if limit == f64::INFINITY {
                    continue;
                }
                let (before, beyond) = (moved(0.93 * limit), moved(1.01 * limit));
                assert!(!bounds.folds(&before), "{}, node {node} along {direction:?}: {limit}", element.name);
                assert!(bounds.folds(&beyond), "{}, node {node} along {direction:?}: {limit}", element.name);
                // Moved, turned and far away it is the same cell.
                let turned: Vec<f64> = beyond
                    .chunks_exact(d)
                    .flat_map(|x| (0..d).map(|k| if d == 2 { [-x[1], x[0]][k] } else { x[(k + 1) % 3] } + 1e5))
                    .collect();
                assert!(bounds.folds(&turned), "{}", element.name);
                found += 1;
                unseen += usize::from(determinants(&own, d, &beyond)[0] > 0.0);
            }
        }
        assert!(2 * found > element.nodes(), "{}: {found}", element.name);
        assert!(unseen > 0, "{}: all of {found} folds are seen by quadrature points", element.name);
    }
}

/// Of cells with random nodes, those fold whose determinant is negative on a fine grid, and no other: none whose determinant is safely positive
/// there.
#[test]
fn random_cells_fold_where_dense_sampling_finds_it() {
    let mut next = random();
    for element in curved() {
        let d = element.dimension();
        let bounds = JacobianBounds::of(&element).unwrap();
        let fine = gradients(&grid(&element, if d == 2 { 40 } else { 10 }));
        let (mut sound, mut folded) = (0, 0);
        for case in 0..100 {
            let noise = 0.6 * (case % 10 + 1) as f64 / 10.0 / if element.cell.is_box() { 1.0 } else { 2.0 };
            let x: Vec<f64> = element.positions.iter().map(|x| x + noise * next()).collect();
            let [least, largest] = determinants(&fine, d, &x);
            let found = bounds.folds(&x);
            if least < 0.0 {
                assert!(found, "{}: {least:e} of {largest:e}", element.name);
                folded += 1;
            } else if least > 0.03 * largest {
                assert!(!found, "{}: {least:e} of {largest:e}", element.name);
                sound += 1;
            }
        }
        assert!(sound > 10 && folded > 10, "{}: {sound} sound, {folded} folded", element.name);
    }
}

/// Straight cells, also distorted ones, are not curved; those with nodes at a quarter, whose determinant is zero at a corner, do not fold.
#[test]
fn straight_cells_and_quarter_points_do_not_fold() {
    for element in curved() {
        let bounds = JacobianBounds::of(&element).unwrap();
        assert!(!bounds.folds(&element.positions), "{}", element.name);
    }
    let corners_alone = elements().into_iter().filter(Element::has_corners_alone);
    corners_alone.for_each(|element| assert!(JacobianBounds::of(&element).is_none(), "{}", element.name));
    let plane = curved().into_iter().find(|element| element.cell == Cell::Triangle && element.nodes() == 6).unwrap();
    let bounds = JacobianBounds::of(&plane).unwrap();
    for (share, folds) in [(0.25, false), (0.26, false), (0.24, true), (0.2, true)] {
        let at = |position: &[f64]| {
            position.iter().map(|x| if *x == 0.5 && position.contains(&0.0) { share } else { *x }).collect::<Vec<f64>>()
        };
        let x: Vec<f64> = plane.positions.chunks_exact(2).flat_map(at).collect();
        assert_eq!(bounds.folds(&x), folds, "{share}");
    }
}

/// A mesh says which cell folds, refuses it or leaves it out, as its gate says.
#[test]
fn a_mesh_tells_of_a_cell_that_folds() {
    let element = curved().into_iter().find(|element| element.cell == Cell::Triangle && element.nodes() == 6).unwrap();
    let mut points = element.positions.clone();
    // The middle of an edge is moved to a fifth of it: no quadrature point sees it.
    let middle = element.positions.chunks_exact(2).position(|x| x == [0.5, 0.0]).unwrap();
    points[2 * middle] = 0.2;
    points.extend(element.positions.iter().map(|x| x + 3.0));
    let build = |below: Below| {
        let blocks = vec![(element.clone(), (0..12).collect())];
        let arrays = MeshArrays {
            dimension: 2,
            points: points.clone(),
            blocks,
            groups: BTreeMap::new(),
            cell_groups: BTreeMap::new(),
        };
        arrays.build(Gate { below, ..Gate::default() })
    };
    let mesh = build(Below::Warn).unwrap();
    assert_eq!(mesh.quality.folding.as_ref().map(|(count, _)| *count), Some(1));
    let notes = report::mesh_notes(&mesh).join("\n");
    assert!(notes.contains("1 curved cell folds between quadrature points") && notes.contains("cell 1 at"), "{notes}");
    let error = build(Below::Refuse).unwrap_err().to_string();
    assert!(
        error.contains("quality: expected cells whose Jacobian is positive everywhere, found 1 cell that fold"),
        "{error}"
    );
    let kept = build(Below::Skip).unwrap();
    assert_eq!((kept.cell_count(), kept.quality.skipped, kept.quality.folding.clone()), (1, 1, None));
}
