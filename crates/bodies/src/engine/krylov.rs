//! Solutions by the generalised minimal residual method (Saad and Schultz 1986) for several right-hand sides side by side.

use super::lanes::{Block, LANES, Lanes, dots};

/// Iterations at most. The preconditioned stiffness has few eigenvalues far from one, those of the slowest motions.
// The loads of a fit for a bar of 5 832 unknowns take 2 to 47 iterations.
const MOST: usize = 300;

/// The solutions of `A x = b` with the preconditioner `P ≈ A⁻¹`, to the relative residual `tolerance` or as far as 300 iterations lead, and
/// the largest relative residual; `None` if the preconditioner fails.
///
/// `x = P w` with `A P w = b`: `w` is the combination of `v_1, …, v_j`, an orthonormal basis of the Krylov space, with the least residual.
pub(super) fn gmres(
    apply: impl Fn(&Block) -> Block,
    precondition: impl Fn(&Block) -> Option<Block>,
    b: &Block,
    tolerance: f64,
) -> Option<(Block, f64)> {
    let size = b.len();
    let first = dots(b, b).map(f64::sqrt);
    let mut basis = vec![scaled(b, &first.map(reciprocal))];
    // The upper triangle after rotations, column by column; the rotations; and the rotated right-hand side.
    let (mut columns, mut rotations): (Vec<Vec<Lanes>>, Vec<[Lanes; 2]>) = (Vec::new(), Vec::new());
    let mut right = vec![first];
    for j in 0..MOST {
        let is_done = |lane: usize| right[j][lane].abs() <= tolerance * first[lane];
        if (0..LANES).all(is_done) {
            break;
        }
        let mut next = apply(&precondition(&basis[j])?);
        let mut column = Vec::with_capacity(j + 2);
        // One pass of the modified Gram–Schmidt method is enough here: residuals are minimised as stably as with an
        // orthonormal basis (Paige, Rozložník, Strakoš, SIAM J. Matrix Anal. Appl. 28, 2006).
        for v in &basis {
            let along = dots(&next, v);
            next.iter_mut().zip(v).for_each(|(n, v)| (0..LANES).for_each(|lane| n[lane] -= along[lane] * v[lane]));
            column.push(along);
        }
        let length = dots(&next, &next).map(f64::sqrt);
        for (i, [cosine, sine]) in rotations.iter().enumerate() {
            for lane in 0..LANES {
                let (a, b) = (column[i][lane], column[i + 1][lane]);
                column[i][lane] = cosine[lane] * a + sine[lane] * b;
                column[i + 1][lane] = cosine[lane] * b - sine[lane] * a;
                // The last entry of a column is rotated by the rotation before.
            }
        }
        let (mut cosine, mut sine, mut rest) = ([1.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let whole = column[j][lane].hypot(length[lane]);
            if whole > 0.0 {
                (cosine[lane], sine[lane]) = (column[j][lane] / whole, length[lane] / whole);
            }
            column[j][lane] = whole;
            rest[lane] = -sine[lane] * right[j][lane];
            right[j][lane] *= cosine[lane];
        }
        columns.push(column);
        rotations.push([cosine, sine]);
        right.push(rest);
        // A lane whose space is exhausted goes on with zeros, which change nothing.
        basis.push(scaled(&next, &length.map(reciprocal)));
    }
    let count = columns.len();
    let mut weights = vec![[0.0; LANES]; count];
    for i in (0..count).rev() {
        let mut sum = right[i];
        for j in i + 1..count {
            (0..LANES).for_each(|lane| sum[lane] -= columns[j][i][lane] * weights[j][lane]);
        }
        (0..LANES).for_each(|lane| weights[i][lane] = sum[lane] * reciprocal(columns[i][i][lane]));
    }
    let mut w = vec![[0.0; LANES]; size];
    for (v, weight) in basis.iter().zip(&weights) {
        w.iter_mut().zip(v).for_each(|(w, v)| (0..LANES).for_each(|lane| w[lane] += weight[lane] * v[lane]));
    }
    let last = right.last().unwrap_or(&first);
    let left = (0..LANES).map(|lane| last[lane].abs() * reciprocal(first[lane])).fold(0.0, f64::max);
    Some((precondition(&w)?, left))
}

/// `1/x`, zero of zero.
fn reciprocal(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1.0 / x }
}

fn scaled(block: &Block, factors: &Lanes) -> Block {
    let mut all = block.clone();
    all.iter_mut().for_each(|own| own.iter_mut().zip(factors).for_each(|(x, factor)| *x *= factor));
    all
}
