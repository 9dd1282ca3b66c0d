//! What is left of a tetrahedron of the body-centred cubic lattice inside a surface, as tetrahedra.
//!
//! The stencils of Labelle and Shewchuk (2007). A side with two corners inside and one outside is left as a trapezoid, which both of its
//! tetrahedra have to divide alike. Its diagonal ends at the cut of the long edge. Where no long edge is cut, it begins at the end of the
//! long edge whose place along that edge is even.

use super::snapping::{Side, Site, is_long};

/// A point of a tetrahedron that is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Knot {
    Site(Site),
    /// The cut of the edge from a site inside to one outside.
    Cut([Site; 2]),
}

/// The tetrahedra that are left of one with these corners.
pub(super) fn left(corners: [Site; 4], side: impl Fn(Site) -> Side) -> Vec<[Knot; 4]> {
    let of = |wanted: Side| corners.into_iter().filter(|site| side(*site) == wanted).collect::<Vec<Site>>();
    let (inside, on, outside) = (of(Side::Inside), of(Side::On), of(Side::Outside));
    let site = Knot::Site;
    let cut = |a: Site, b: Site| Knot::Cut([a, b]);
    match (&inside[..], &on[..], &outside[..]) {
        ([], _, _) => Vec::new(),
        (_, _, []) => vec![corners.map(site)],
        // A corner, whose other three are on the surface or cut off.
        ([p], _, _) => {
            let other = |&q: &Site| if outside.contains(&q) { cut(*p, q) } else { site(q) };
            let rest: Vec<Knot> = corners.iter().filter(|q| *q != p).map(other).collect();
            vec![[site(*p), rest[0], rest[1], rest[2]]]
        }
        // A pyramid over a trapezoid.
        ([p, q], [o, ..], [r, ..]) => {
            let [p, q] = divided(*p, *q, *r);
            vec![[site(*o), site(p), site(q), cut(q, *r)], [site(*o), site(p), cut(q, *r), cut(p, *r)]]
        }
        // A wedge between the edges inside and outside. Its third quadrangle is on the surface, and divided at will.
        ([p, q], _, [r, s, ..]) => {
            let ([p, q], [first, _]) = (divided(*p, *q, *r), divided(*p, *q, *s));
            if first == p {
                // Both diagonals begin at p.
                vec![
                    [site(p), site(q), cut(q, *r), cut(q, *s)],
                    [site(p), cut(q, *r), cut(q, *s), cut(p, *r)],
                    [site(p), cut(q, *s), cut(p, *r), cut(p, *s)],
                ]
            } else {
                // One diagonal is from p to the cut of q r, the other from q to that of p s: they meet in the third.
                vec![
                    [site(p), site(q), cut(q, *r), cut(p, *s)],
                    [site(p), cut(p, *r), cut(p, *s), cut(q, *r)],
                    [site(q), cut(q, *r), cut(q, *s), cut(p, *s)],
                ]
            }
        }
        // A corner is cut off. One of its edges is long: the diagonals of two trapezoids end at the cut of that edge.
        ([a, b, c, ..], _, [r, ..]) => {
            let p = [*a, *b, *c].into_iter().find(|p| is_long([*p, *r])).unwrap_or(*a);
            let [q, s]: [Site; 2] = match [*a, *b, *c] {
                [a, b, c] if a == p => [b, c],
                [a, b, c] if b == p => [a, c],
                [a, b, _] => [a, b],
            };
            let [q, s] = divided(q, s, *r);
            vec![
                [site(p), site(q), site(s), cut(p, *r)],
                [cut(p, *r), site(q), site(s), cut(s, *r)],
                [cut(p, *r), site(q), cut(s, *r), cut(q, *r)],
            ]
        }
        // Four corners are not more than four.
        ([_, _], _, [_]) => Vec::new(),
    }
}

/// The ends inside of a trapezoid with the third corner r outside, so that its diagonal goes from the first to the cut of the second and
/// r.
fn divided(p: Site, q: Site, r: Site) -> [Site; 2] {
    let first = match (is_long([p, r]), is_long([q, r])) {
        (true, _) => q,
        (_, true) => p,
        (false, false) => {
            // p q is long, along one axis, and its ends are one cube apart.
            let number = |site: Site| site.iter().map(|s| s.div_euclid(2)).sum::<i32>();
            if number(p).rem_euclid(2) == 0 { p } else { q }
        }
    };
    if first == p { [p, q] } else { [q, p] }
}
