//! The springs of an exact network, as code: `k_ab = −μ Σ_q w_q ∇N_a·∇N_b` between all pairs of nodes, with rest length
//! zero, and springs on the content.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::tolerance::PRODUCT;
use super::{Cell, Index, Room, Status, Value, dot};
use crate::fit::VolumeSprings;
use crate::scalar::Scalar;

/// Writes the constants and the rest measures, `[springs]` each.
pub fn exact(cell: &Cell, volume: VolumeSprings, lambda: &Value, mu: &Value) -> [Room; 2] {
    let (body, plan, d, n) = (&cell.body, cell.plan, cell.dimension(), cell.nodes());
    let (lengths, m) = (cell.springs.pairs().len(), cell.springs.len());
    let (is_array, points) = (!plan.springs, cell.springs.points());
    let mut constants = Room::new(body, "constants_of_cell", m, is_array || !plan.points);
    let mut rests = Room::new(body, "rests_of_cell", m, is_array || !plan.points);
    // Each node with itself, against which rounding errors are measured.
    let mut own = Room::new(body, "own", n, is_array || !plan.points);
    let mut gradients = Room::unset(body, "gradients", n * d, is_array);
    let whole = cell.springs.content().is_some();
    let mut contents = Room::new(body, "contents", 2, !plan.points && whole);
    cell.each_point(|q, geometry| {
        let [volume_q, volumetric] = cell.volumes(geometry);
        let factor = (mu * &volume_q).negated();
        geometry.gradients.iter().enumerate().for_each(|(i, g)| gradients.set(body, i, g));
        let gradient = |a: &Index| -> Vec<Value> { (0..d).map(|k| gradients.get(body, &(a * d) + k)).collect() };
        body.each(plan.springs, 0, n, |a| {
            let g = gradient(a);
            own.add(body, a, &(&factor * &dot(&g, &g)));
        });
        cell.each_length(|s, i, j| constants.add(body, s, &(&factor * &dot(&gradient(i), &gradient(j)))));
        if whole {
            contents.add(body, 0, &volume_q);
            contents.add(body, 1, &volumetric);
        }
        let place = match q.number() {
            Some(q) => points.iter().position(|p| *p == q).map(Index::from),
            None => (!points.is_empty()).then(|| q.clone()),
        };
        if let Some(place) = place {
            let own = match q.number() {
                Some(q) if cell.element.tabulation.weights[q] == 0.0 => &volumetric,
                _ => &volume_q,
            };
            let shares = if volume == VolumeSprings::Cells { [1.0, 0.0] } else { [1.0, 1.0] };
            let found = content(shares, own, [&volume_q, &volumetric], lambda, mu);
            constants.set(body, &place + lengths, &found[0]);
            rests.set(body, &place + lengths, &found[1]);
        }
    });
    if whole {
        let shares = if volume == VolumeSprings::Cells && !points.is_empty() { [0.0, 1.0] } else { [1.0, 1.0] };
        let [volume, volumetric] = [0, 1].map(|i| contents.get(body, i));
        let found = content(shares, &volume, [&volume, &volumetric], lambda, mu);
        constants.set(body, m - 1, &found[0]);
        rests.set(body, m - 1, &found[1]);
    }
    let (rounding, zero) = (body.number(PRODUCT), body.number(0.0));
    // Nodes of a simplex with a volume are apart. Those of other cells may coincide where no point of the quadrature tells.
    let may_coincide = n > d + 1;
    body.fail_with(Status::Shape);
    cell.each_length(|s, i, j| {
        if may_coincide {
            let edge = cell.edge(i, j);
            body.guard(&dot(&edge, &edge), &zero);
        }
        let constant = constants.get(body, s);
        let least = &(&own.get(body, i) * &own.get(body, j)) * &rounding;
        // Squares are compared, which needs no root, as the kernel of the library does.
        let kept = constant.clone().squared().select(&least, &constant, &zero);
        constants.set(body, s, &kept);
    });
    [constants, rests]
}

/// The constant and the rest measure of a spring on this content, with the shares of μ and λ that it has and the volumes
/// of the two terms: `T = k (c − c₀)` with the slope `U''` and the pull `−U'(1) = μ` at rest.
fn content(shares: [f64; 2], content: &Value, volumes: [&Value; 2], lambda: &Value, mu: &Value) -> [Value; 2] {
    let pull = &(mu * volumes[0]) * &content.like(shares[0]);
    let slope = &pull + &(&(lambda * volumes[1]) * &content.like(shares[1]));
    // Where nothing pulls at rest the division would be by zero if λ is zero.
    let longer = if pull.as_number() == Some(0.0) { pull } else { &(&pull * content) / &slope };
    [&slope / &content.clone().squared(), content + &longer]
}
