//! Triangles of flat polygons.

use crate::springs::{cross, dot, norm};

/// How far the corners of a polygon may be from one plane, relative to its extent. Polygons of curved surfaces are bent a little, as
/// their quadrangles are.
// Its triangles are tilted by some 0.1 rad then, and have half a percent more area than the polygon has in the plane.
const FLAT: f64 = 0.05;

/// The most corners of a polygon that has notches: its triangles are found in a time that grows with their third power.
const MOST: usize = 256;

/// The triangles of a flat polygon whose sides do not cross, each by the places of its corners in the list and turned as the polygon is; `None` for
/// another polygon.
///
/// One without notches is divided in halves again and again, so that few of its triangles are slender. Of another one the ear with the best shape
/// is cut off until a triangle is left.
pub(super) fn triangles(corners: &[[f64; 3]]) -> Option<Vec<[usize; 3]>> {
    let flat = laid_flat(corners)?;
    let mut found = Vec::with_capacity(corners.len() - 2);
    if is_round(&flat) {
        let mut waiting = vec![(0, corners.len() - 1)];
        while let Some((first, last)) = waiting.pop() {
            if last - first > 1 {
                let middle = first.midpoint(last);
                found.push([first, middle, last]);
                waiting.extend([(first, middle), (middle, last)]);
            }
        }
        return Some(found);
    }
    if corners.len() > MOST || crosses(&flat) {
        return None;
    }
    let mut left: Vec<usize> = (0..corners.len()).collect();
    while left.len() > 3 {
        let n = left.len();
        let ear = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        // A corner inside an ear would be cut off with it.
        let is_free = |ear: &[usize; 3]| !left.iter().any(|&p| !ear.contains(&p) && is_inside(&flat, *ear, flat[p]));
        let best = (0..n)
            .filter(|&i| quality(&flat, ear(i)) > 0.0 && is_free(&ear(i)))
            .max_by(|&i, &j| quality(&flat, ear(i)).total_cmp(&quality(&flat, ear(j))))?;
        found.push(ear(best));
        left.remove(best);
    }
    let last = [left[0], left[1], left[2]];
    found.push(last);
    (quality(&flat, last) > 0.0).then_some(found)
}

/// The corners in the plane of the polygon, which is counterclockwise there; `None` if they are not in one plane, or enclose nothing.
fn laid_flat(corners: &[[f64; 3]]) -> Option<Vec<[f64; 2]>> {
    let n = corners.len();
    let origin = *corners.first().filter(|_| n >= 3)?;
    let from: Vec<[f64; 3]> = corners.iter().map(|p| std::array::from_fn(|k| p[k] - origin[k])).collect();
    let extent = from.iter().map(|v| norm(v)).fold(0.0, f64::max);
    // Newell: the sum of the triangles from the first corner.
    let mut normal = [0.0; 3];
    for pair in from.windows(2) {
        let part = cross(pair[0], pair[1]);
        (0..3).for_each(|k| normal[k] += part[k]);
    }
    let area = norm(&normal);
    // An area of less is the rounding of its sum, and its normal has no digits.
    if !(area > f64::EPSILON.sqrt() * extent * extent) {
        return None;
    }
    let normal = normal.map(|x| x / area);
    if from.iter().any(|v| dot(&normal, v).abs() > FLAT * extent) {
        return None;
    }
    // The corner that is farthest in the plane gives an axis with all digits.
    let along = from.iter().max_by(|a, b| norm(&across(normal, **a)).total_cmp(&norm(&across(normal, **b))))?;
    let first = across(normal, *along);
    let length = norm(&first);
    let first = first.map(|x| x / length);
    let second = cross(normal, first);
    Some(from.iter().map(|v| [dot(&first, v), dot(&second, v)]).collect())
}

/// The part of a vector that is in the plane across the unit vector.
fn across(unit: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let along = dot(&unit, &v);
    std::array::from_fn(|k| v[k] - along * unit[k])
}

/// Twice the area of a triangle, negative if it is clockwise.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Twice the area over the sum of the squared sides: 0 if it is flat, and largest if its sides are equal.
fn quality(flat: &[[f64; 2]], [a, b, c]: [usize; 3]) -> f64 {
    let (a, b, c) = (flat[a], flat[b], flat[c]);
    let square = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    let found = area(a, b, c) / (square(a, b) + square(b, c) + square(c, a));
    // A share of rounding alone is no area.
    if found > f64::EPSILON.sqrt() { found } else { 0.0 }
}

/// Whether each corner turns to the left, and all together once round.
fn is_round(flat: &[[f64; 2]]) -> bool {
    let n = flat.len();
    let mut turns = 0.0;
    for i in 0..n {
        let ear = [(i + n - 1) % n, i, (i + 1) % n];
        if quality(flat, ear) == 0.0 {
            return false;
        }
        let [a, b, c] = ear.map(|k| flat[k]);
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        turns += (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
    }
    // The sum of the turns is a whole number of revolutions but for rounding: a star turns twice round.
    (turns - std::f64::consts::TAU).abs() < 1e-6
}

/// Whether the point is in the triangle, on its border or beyond it by rounding; a point at one of its corners is not.
fn is_inside(flat: &[[f64; 2]], [a, b, c]: [usize; 3], p: [f64; 2]) -> bool {
    let (a, b, c) = (flat[a], flat[b], flat[c]);
    let square = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    // A corner that is on the border but for rounding must keep the ear from being cut.
    let least = -f64::EPSILON.sqrt() * (square(a, b) + square(b, c) + square(c, a));
    p != a && p != b && p != c && [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| area(from, to, p) >= least)
}

/// Whether two sides without a common corner meet.
fn crosses(flat: &[[f64; 2]]) -> bool {
    let n = flat.len();
    let side = |i: usize| (flat[i], flat[(i + 1) % n]);
    // Touching counts as meeting: ears beside a point of touch have no area.
    let parts = |(a, b): ([f64; 2], [f64; 2]), (c, d): ([f64; 2], [f64; 2])| area(a, b, c) * area(a, b, d) <= 0.0;
    let is_apart = |i: usize, j: usize| j > i + 1 && !(i == 0 && j == n - 1);
    let overlap = |p: ([f64; 2], [f64; 2]), q: ([f64; 2], [f64; 2])| {
        (0..2).all(|k| p.0[k].min(p.1[k]) <= q.0[k].max(q.1[k]) && q.0[k].min(q.1[k]) <= p.0[k].max(p.1[k]))
    };
    (0..n).any(|i| {
        (0..n)
            .any(|j| is_apart(i, j) && overlap(side(i), side(j)) && parts(side(i), side(j)) && parts(side(j), side(i)))
    })
}
