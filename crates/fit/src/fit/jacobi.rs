//! Eigenvalues and eigenvectors of small symmetric matrices, one per lane, by Jacobi rotations.

use crate::scalar::{Real, vectorized};

/// The largest number of sweeps over all pairs; six to eight are usually enough.
const SWEEPS: usize = 16;

/// The decomposition `A = Vᵀ Λ V` of order n: Λ on the diagonal of `a`, of which both triangles are read, and the
/// eigenvectors in the rows of `v`. A lane that has converged is not changed any more, so that its digits do not depend
/// on the others.
pub fn eigenvectors<T: Real>(a: &mut [T], n: usize, v: &mut [T]) {
    let (zero, one) = (a[0].zero(), a[0].one());
    for i in 0..n {
        for j in 0..n {
            v[i * n + j] = if i == j { one.clone() } else { zero.clone() };
        }
    }
    vectorized!(one, {
        for _ in 0..SWEEPS {
            let (mut rest, mut size) = (zero.clone(), zero.clone());
            for i in 0..n {
                size = size.plus_product(&a[i * n + i], &a[i * n + i]);
                for j in 0..i {
                    rest = rest.plus_product(&a[i * n + j], &a[i * n + j]);
                }
            }
            // Entries beside the diagonal that are a rounding error of it together move no eigenvalue by more than that.
            let floor = size.scaled(&T::epsilon().powi(2));
            let moves = rest.clone() - &floor;
            // The sweeps end with the slowest lane; one that has converged has zero angles from there on.
            if floor.exceeds(&rest) {
                break;
            }
            for i in 1..n {
                for j in 0..i {
                    rotate(a, n, v, (i, j), &moves);
                }
            }
        }
    });
}

/// Eliminates `A_ij` if `moves` is above zero.
#[inline(always)]
fn rotate<T: Real>(a: &mut [T], n: usize, v: &mut [T], (i, j): (usize, usize), moves: &T) {
    let zero = moves.zero();
    let entry = a[i * n + j].clone();
    let difference = a[j * n + j].clone() - &a[i * n + i];
    let twice = entry.clone().scaled(&2.0);
    // The tangent of the angle, the smaller of the two solutions: 2 A_ij/(d ± √(d² + 4 A_ij²)).
    let root = twice.clone().squared().plus_product(&difference, &difference).sqrt();
    let denominator = difference.magnitude() + &root;
    // Two equal diagonal entries with nothing beside them have 0/0 here, and need no rotation.
    let tangent = denominator.choose(&(twice / &denominator.choose(&denominator, &zero.one())), &zero);
    let tangent = difference.negated().choose(&tangent.negated(), &tangent);
    let tangent = moves.choose(&tangent, &zero);
    let cosine = zero.one() / &zero.one().plus_product(&tangent, &tangent).sqrt();
    let sine = tangent.clone() * &cosine;
    let turn = |rows: &mut [T]| {
        for k in 0..n {
            let (x, y) = (rows[i * n + k].clone(), rows[j * n + k].clone());
            rows[i * n + k] = (x.clone() * &cosine).minus_product(&sine, &y);
            rows[j * n + k] = (y * &cosine).plus_product(&sine, &x);
        }
    };
    let (first, last) = (a[i * n + i].clone(), a[j * n + j].clone());
    turn(a);
    turn(v);
    for k in 0..n {
        a[k * n + i] = a[i * n + k].clone();
        a[k * n + j] = a[j * n + k].clone();
    }
    // The diagonal is updated by the tangent alone (Rutishauser 1966): the rotation of its rows would add rounding to what hardly changes.
    a[i * n + i] = first.minus_product(&tangent, &entry);
    a[j * n + j] = last.plus_product(&tangent, &entry);
    let left = moves.choose(&zero, &entry);
    a[i * n + j] = left.clone();
    a[j * n + i] = left;
}
