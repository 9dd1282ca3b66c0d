//! The symmetry of an element: the affine maps of its cell onto itself, as permutations of the nodes.

use super::cell::{Cell, SAME};
use nalgebra::{DMatrix, DVector};

/// For each affine map of the cell onto itself that maps nodes to nodes: the image of each node. The identity is one of
/// them.
pub fn permutations(cell: Cell, positions: &[f64]) -> Vec<Vec<usize>> {
    let d = cell.dimension();
    let corners: Vec<DVector<f64>> = cell.corners().iter().map(|c| DVector::from_column_slice(c)).collect();
    let nodes: Vec<DVector<f64>> = positions.chunks_exact(d).map(DVector::from_column_slice).collect();
    let frame = frame(&corners, d);
    let Some(inverse) = edges(&corners, &frame).try_inverse() else { return vec![(0..nodes.len()).collect()] };
    let mut found = Vec::new();
    for image in arrangements(corners.len(), d + 1) {
        let linear = edges(&corners, &image) * &inverse;
        let map = |x: &DVector<f64>| &corners[image[0]] + &linear * (x - &corners[frame[0]]);
        let permute = |points: &[DVector<f64>]| -> Option<Vec<usize>> {
            let place = |x: &DVector<f64>| {
                let y = map(x);
                points.iter().position(|other| (other - &y).amax() < SAME)
            };
            points.iter().map(place).collect()
        };
        if permute(&corners).is_some_and(|p| is_permutation(&p)) {
            found.extend(permute(&nodes));
        }
    }
    found
}

/// The first corners that span the cell.
fn frame(corners: &[DVector<f64>], d: usize) -> Vec<usize> {
    let mut frame = vec![0];
    for next in 1..corners.len() {
        let tried: Vec<usize> = frame.iter().copied().chain([next]).collect();
        let edges = edges(corners, &tried);
        if frame.len() <= d && (edges.tr_mul(&edges)).determinant() > SAME {
            frame = tried;
        }
    }
    frame
}

/// The vectors from the first of the `chosen` corners to the others, as columns.
fn edges(corners: &[DVector<f64>], chosen: &[usize]) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = chosen[1..].iter().map(|&i| &corners[i] - &corners[chosen[0]]).collect();
    DMatrix::from_columns(&columns)
}

/// Every choice of `length` different numbers below `count`, in order.
fn arrangements(count: usize, length: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..length {
        let extend = |part: &Vec<usize>| {
            let part = part.clone();
            (0..count).filter(|i| !part.contains(i)).map(|i| [&part[..], &[i]].concat()).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(extend).collect();
    }
    all
}

fn is_permutation(p: &[usize]) -> bool {
    let mut sorted = p.to_vec();
    sorted.sort_unstable();
    sorted.into_iter().eq(0..p.len())
}
