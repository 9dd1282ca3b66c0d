//! The solution of the normal equations: `M = L D Lᵀ`, right-looking, with the rows of the upper triangle, which a
//! compiler can vectorise.

use super::tolerance::RANK;
use super::{Body, Index, Room, Status, Value};

/// Replaces `b` by `M⁻¹ b`, for the upper triangle of M, `[m × m]`. The function ends with [`Status::Dependent`] if M is
/// singular.
pub fn solve(body: &Body, unrolled: bool, m: usize, matrix: &mut Room, b: &mut Room) {
    body.fail_with(Status::Dependent);
    let least = body.number(RANK);
    let mut diagonal = Room::unset(body, "diagonal", m, !unrolled);
    body.each(unrolled, 0, m, |j| {
        let entry = matrix.get(body, &(j * m) + j);
        diagonal.set(body, j, &entry);
    });
    let one = body.number(1.0);
    // Afterwards the diagonal holds 1/D.
    body.each(unrolled, 0, m, |j| {
        let pivot = matrix.get(body, &(j * m) + j);
        // The pivot is compared with the entry before the elimination, by the rule of the library.
        body.guard(&pivot, &(&diagonal.get(body, j) * &least));
        let inverse = &one / &pivot;
        diagonal.set(body, j, &inverse);
        let known = b.get(body, j);
        // The right-hand side goes along with the elimination: the factor L need not be kept.
        body.each(unrolled, j + 1, m, |i| {
            let factor: Value = &matrix.get(body, &(j * m) + i) * &inverse;
            let less = &b.get(body, i) - &(&factor * &known);
            b.set(body, i, &less);
            body.each(unrolled, i, m, |k| {
                let at = &(i * m) + k;
                let less = &matrix.get(body, &at) - &(&factor * &matrix.get(body, &(j * m) + k));
                matrix.set(body, at, &less);
            });
        });
    });
    body.each(unrolled, 0, m, |t| {
        let j = &Index::from(m - 1) - t;
        body.each(unrolled, &j + 1, m, |k| {
            let less = &b.get(body, &j) - &(&matrix.get(body, &(&j * m) + k) * &b.get(body, k));
            b.set(body, &j, &less);
        });
        let scaled = &b.get(body, &j) * &diagonal.get(body, &j);
        b.set(body, &j, &scaled);
    });
}
