//! How far triangles have turned about their edges.
//!
//! Theory: page *Sheets that bend* of the book.

use super::weighted::Weighted;
use crate::scalar::{Dual, Real};
use crate::symbolic::Jet;

/// A vector in space.
type Vector<T> = [T; 3];

/// The points by which a triangle measures how it bends: its corners, and the director of the edge opposite to each of them.
pub const BEND_POINTS: usize = 6;
/// The points of a hinge: the corner of a triangle opposite to an edge, the ends of this edge as the triangle runs through it, and a point beyond the edge.
pub const HINGE_POINTS: usize = 4;

/// The corners and the director of the turn at the edge opposite to a corner, as places in the points of a bend: the corner itself, the edge as
/// the triangle runs through it, and the director.
pub fn turn_points(corner: usize) -> [usize; 4] {
    [corner, (corner + 1) % 3, (corner + 2) % 3, corner + 3]
}

/// `c = Σ_i w_i a_i`: a weighted sum of turns of triangles about their edges, in m or rad. The turn a_i is the angle from the conormal of the triangle, which
/// points out of it at the edge, to the direction from this edge to a point. It is positive towards the normal.
///
/// The places of a turn are the corner of the triangle opposite to the edge, the ends of this edge as the triangle runs through it, and the point.
pub type Turns = Weighted<4>;

impl Turns {
    /// The turns of a triangle from the directors of its edges, with these weights, in the order of [`turn_points`].
    pub fn of_triangle(weights: [f64; 3]) -> Turns {
        Weighted::of(weights.into_iter().enumerate().map(|(corner, weight)| (turn_points(corner), weight)))
    }

    /// The one turn of [`HINGE_POINTS`] points: from the plane of the triangle to the last point, rad.
    pub fn of_hinge() -> Turns {
        Weighted::of([([0, 1, 2, 3], 1.0)])
    }

    pub(super) fn value(&self, x: &[f64]) -> f64 {
        self.iter().map(|(places, weight)| weight * turn(&points(x, places))).sum()
    }

    pub(super) fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        for (places, weight) in self.iter() {
            let slopes = slopes(&points(x, places));
            for (k, dof) in dofs(places).into_iter().enumerate() {
                gradient[dof] += weight * slopes[k / 3][k % 3];
            }
        }
        gradient
    }

    pub(super) fn jet(&self, x: &[f64]) -> Jet {
        let n = x.len();
        let mut jet = Jet { value: self.value(x), gradient: vec![0.0; n], hessian: vec![0.0; n * n] };
        for (places, weight) in self.iter() {
            // Second derivatives are those of the closed form of the gradient, by dual numbers.
            let mut variables = points(x, places).map(|point| point.map(Dual::<12>::steady));
            variables.as_flattened_mut().iter_mut().enumerate().for_each(|(k, dual)| dual.slopes[k] = 1.0);
            let slopes = slopes(&variables);
            let dofs = dofs(places);
            for (k, slope) in slopes.as_flattened().iter().enumerate() {
                jet.gradient[dofs[k]] += weight * slope.value;
                for (l, bend) in slope.slopes.iter().enumerate() {
                    jet.hessian[dofs[k] * n + dofs[l]] += weight * bend;
                }
            }
        }
        jet
    }
}

/// The positions of the points of a turn.
fn points(x: &[f64], places: [usize; 4]) -> [Vector<f64>; 4] {
    places.map(|place| std::array::from_fn(|k| x[3 * place + k]))
}

/// Their coordinates, as places in those of all points of the spring.
fn dofs(places: [usize; 4]) -> [usize; 12] {
    std::array::from_fn(|k| 3 * places[k / 3] + k % 3)
}

/// The turn of the triangle with this apex and edge a → b from the director.
fn turn(points: &[Vector<f64>; 4]) -> f64 {
    let arms = Arms::of(points);
    // The quadrant is kept: a sheet may turn by more than a right angle.
    arms.across.atan2(arms.along)
}

/// The gradient of the turn at apex, a, b and director: `N/h` at the apex, `(x N − y n)/(x² + y²)` at the director, and what keeps motions of the whole
/// free of turns at the ends of the edge.
fn slopes<T: Real>(points: &[Vector<T>; 4]) -> [Vector<T>; 4] {
    let arms = Arms::of(points);
    let reach = arms.along.clone().squared() + &arms.across.clone().squared();
    let of_apex: Vector<T> = std::array::from_fn(|k| arms.normal[k].clone() / &arms.height);
    let of_director: Vector<T> = std::array::from_fn(|k| {
        (arms.along.clone() * &arms.normal[k] - &(arms.across.clone() * &arms.conormal[k])) / &reach
    });
    let ends: [Vector<T>; 2] = [true, false].map(|is_first| {
        // Motions of the whole turn nothing: the ends of the edge balance the slopes at apex and director by their levers.
        let share = |foot: &T| if is_first { foot.clone() - &foot.one() } else { foot.negated() };
        let [apex, director] = [share(&arms.apex_foot), share(&arms.director_foot)];
        std::array::from_fn(|k| apex.clone() * &of_apex[k] + &(director.clone() * &of_director[k]))
    });
    let [of_a, of_b] = ends;
    [of_apex, of_a, of_b, of_director]
}

/// A triangle and a director as they are seen from an edge.
struct Arms<T> {
    /// The unit normal of the triangle, and the unit conormal, which points out of it at the edge.
    normal: Vector<T>,
    conormal: Vector<T>,
    /// The height of the apex above the edge, m.
    height: T,
    /// The director from the edge, along the conormal and along the normal, m.
    along: T,
    across: T,
    /// The feet of the apex and of the director on the edge, from 0 at a to 1 at b.
    apex_foot: T,
    director_foot: T,
}

impl<T: Real> Arms<T> {
    fn of([apex, a, b, director]: &[Vector<T>; 4]) -> Arms<T> {
        let (edge, to_apex, to_director) = (minus(b, a), minus(apex, a), minus(director, a));
        let length = dot(&edge, &edge).sqrt();
        let tangent: Vector<T> = std::array::from_fn(|k| edge[k].clone() / &length);
        let area = cross(&edge, &to_apex);
        let twice = dot(&area, &area).sqrt();
        let normal: Vector<T> = std::array::from_fn(|k| area[k].clone() / &twice);
        let conormal = cross(&tangent, &normal);
        Arms {
            height: twice / &length,
            along: dot(&to_director, &conormal),
            across: dot(&to_director, &normal),
            apex_foot: dot(&to_apex, &tangent) / &length,
            director_foot: dot(&to_director, &tangent) / &length,
            normal,
            conormal,
        }
    }
}

fn minus<T: Real>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    std::array::from_fn(|k| a[k].clone() - &b[k])
}

fn dot<T: Real>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[0].clone() * &b[0] + &(a[1].clone() * &b[1]) + &(a[2].clone() * &b[2])
}

fn cross<T: Real>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].clone() * &b[j] - &(a[j].clone() * &b[i])
    })
}
