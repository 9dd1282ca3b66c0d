//! The convex hull of points: its content, and which points are on it.

use crate::springs::{cross, dot, norm};

/// A point this far from a side, relative to the extent of all points, is on it.
// Products of differences of coordinates are rounded by some 1e-16 of the square of the extent. With a wider bound a smoothly rounded
// body would lose corners of its hull.
const ON: f64 = 1e-9;

/// The convex hull of points of two or three coordinates.
pub struct Hull {
    /// Its area in m², or its volume in m³.
    pub content: f64,
    /// Whether each point is on a side.
    pub is_outer: Vec<bool>,
}

impl Hull {
    /// The hull of points, `[points × dimension]`, m; `None` if they are on a line or in a plane.
    pub fn of(points: &[f64], d: usize) -> Option<Hull> {
        let spatial: Vec<[f64; 3]> =
            points.chunks_exact(d).map(|x| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0))).collect();
        match d {
            2 => plane(&spatial),
            3 => solid(&spatial),
            _ => None,
        }
    }
}

fn extent(points: &[[f64; 3]]) -> f64 {
    let along = |k: usize| {
        let x = points.iter().map(|x| x[k]);
        x.clone().fold(f64::NEG_INFINITY, f64::max) - x.fold(f64::INFINITY, f64::min)
    };
    (0..3).map(along).fold(0.0, f64::max)
}

fn minus(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Andrew's chain: points in the order of x, of which those that turn right are left out below and above.
fn plane(points: &[[f64; 3]]) -> Option<Hull> {
    let size = extent(points);
    let mut order: Vec<usize> = (0..points.len()).collect();
    // Points with the same x follow each other in the order of y, so that a side along y is passed in one direction.
    order.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]).then(points[a][1].total_cmp(&points[b][1])));
    let half = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for p in order {
            while let [.., a, b] = chain[..] {
                let turn = cross(minus(&points[b], &points[a]), minus(&points[p], &points[a]))[2];
                // A point that turns less lies on a side, and is no corner.
                if turn > ON * size * size {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        // The last point is the first one of the other half.
        chain.pop();
        chain
    };
    let below = half(&mut order.iter().copied());
    let above = half(&mut order.iter().rev().copied());
    let ring: Vec<usize> = below.into_iter().chain(above).collect();
    let sides: Vec<[usize; 2]> = (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect();
    // About a point of the ring: about a far origin the areas would cancel.
    let from_first = |p: usize| minus(&points[p], &points[ring[0]]);
    let content: f64 = sides.iter().map(|[a, b]| cross(from_first(*a), from_first(*b))[2]).sum::<f64>() / 2.0;
    if ring.len() < 3 || !(content > ON * size * size) {
        return None;
    }
    let distance = |p: &[f64; 3], [a, b]: &[usize; 2]| {
        let side = minus(&points[*b], &points[*a]);
        cross(side, minus(p, &points[*a]))[2] / norm(&side)
    };
    let is_outer = points.iter().map(|p| sides.iter().any(|side| distance(p, side) <= ON * size)).collect();
    Some(Hull { content, is_outer })
}

/// A side of a hull that is being made.
struct Side {
    corners: [usize; 3],
    normal: [f64; 3],
    offset: f64,
}

impl Side {
    fn new(points: &[[f64; 3]], corners: [usize; 3]) -> Option<Side> {
        let [a, b, c] = corners.map(|p| &points[p]);
        let normal = cross(minus(b, a), minus(c, a));
        let length = norm(&normal);
        (length > 0.0).then(|| {
            let normal = normal.map(|n| n / length);
            Side { corners, normal, offset: dot(&normal, a) }
        })
    }

    fn distance(&self, x: &[f64; 3]) -> f64 {
        dot(&self.normal, x) - self.offset
    }
}

/// Point after point: the sides that a point sees give way to those between it and their rim.
fn solid(points: &[[f64; 3]]) -> Option<Hull> {
    let size = extent(points);
    let near = ON * size;
    let mut sides = first_sides(points, near)?;
    for (p, x) in points.iter().enumerate() {
        // A point that lies on a side up to rounding does not see it: the side that it would make with the rim would
        // have a random normal.
        let (seen, kept): (Vec<Side>, Vec<Side>) = sides.into_iter().partition(|side| side.distance(x) > near);
        sides = kept;
        let edges = |side: &Side| {
            let [a, b, c] = side.corners;
            [[a, b], [b, c], [c, a]]
        };
        // The set is only asked. Sides are made in the order of the list, whatever the order of the hashes.
        let all: std::collections::HashSet<[usize; 2]> = seen.iter().flat_map(edges).collect();
        // An edge between two sides that are seen is passed in both directions, an edge of the rim in one.
        for [a, b] in seen.iter().flat_map(edges).filter(|[a, b]| !all.contains(&[*b, *a])) {
            // A point in line with an edge of the rim spans no side with that edge.
            sides.extend(Side::new(points, [a, b, p]));
        }
    }
    let centre = points[0];
    let corner = |side: &Side| {
        let [a, b, c] = side.corners.map(|p| minus(&points[p], &centre));
        dot(&a, &cross(b, c)) / 6.0
    };
    let content: f64 = sides.iter().map(corner).sum();
    // What lies outside shows that rounding has spoilt a side.
    let outside = points.iter().flat_map(|x| sides.iter().map(|side| side.distance(x))).fold(0.0, f64::max);
    if !(content > 0.0 && outside <= 1e3 * near) {
        return None;
    }
    let is_outer = points.iter().map(|x| sides.iter().any(|side| side.distance(x) >= -10.0 * near)).collect();
    Some(Hull { content, is_outer })
}

/// The sides of a tetrahedron of points far from each other.
fn first_sides(points: &[[f64; 3]], near: f64) -> Option<Vec<Side>> {
    let farthest = |measure: &dyn Fn(&[f64; 3]) -> f64| {
        (0..points.len()).max_by(|&a, &b| measure(&points[a]).total_cmp(&measure(&points[b])))
    };
    // Far corners make the first tetrahedron large, so that the normals of its sides have all their digits.
    let a = farthest(&|x| x[0])?;
    let b = farthest(&|x| norm(&minus(x, &points[a])))?;
    let along = minus(&points[b], &points[a]);
    let c = farthest(&|x| norm(&cross(along, minus(x, &points[a]))))?;
    let base = Side::new(points, [a, b, c])?;
    let e = farthest(&|x| base.distance(x).abs())?;
    if !(base.distance(&points[e]).abs() > near) {
        return None;
    }
    // Normals are to point outwards, away from the fourth corner.
    let turned = base.distance(&points[e]) > 0.0;
    let corners = if turned { [a, c, b] } else { [a, b, c] };
    let [a, b, c] = corners;
    [[a, b, c], [b, a, e], [c, b, e], [a, c, e]].into_iter().map(|corners| Side::new(points, corners)).collect()
}
