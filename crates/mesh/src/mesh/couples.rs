//! Moments as forces on the directors of sheets and rods.

use super::mesh::{Directors, Mesh};
use crate::springs::{cross, distance, dot, norm};
use nalgebra::{Matrix3, Vector3};

impl Mesh {
    /// The forces `[points × 3]`, N, of a moment in N·m on the joints of rods or the edges of a sheet whose ends are among these points; `None` if there are none.
    /// Joints have equal shares, and edges shares by their lengths. The forces of each add to zero, so that they are a couple.
    pub fn couples(&self, points: &[usize], moment: [f64; 3]) -> Option<Vec<f64>> {
        let Directors { edges, .. } = self.directors.as_ref()?;
        let first = self.node_count();
        let own = self.with_directors_of(points).split_off(points.len());
        let mut forces = vec![0.0; self.points.len()];
        if self.cell_dimension() == 1 {
            // The two directors of a joint follow each other.
            let joints: Vec<usize> = own.iter().map(|director| edges[director - first][0]).step_by(2).collect();
            let share = moment.map(|m| m / joints.len() as f64);
            joints.iter().for_each(|&joint| self.add_moment(joint, share, &mut forces));
            return (!joints.is_empty()).then_some(forces);
        }
        let length = |director: usize| {
            let [a, b] = edges[director - first];
            distance(self.point(a), self.point(b))
        };
        let all: f64 = own.iter().map(|&director| length(director)).sum();
        for &director in &own {
            let share = moment.map(|m| m * length(director) / all);
            self.turn_edge(edges[director - first], director, share, &mut forces);
        }
        (!own.is_empty()).then_some(forces)
    }

    /// Adds the forces `ω × a_i`, N, on the directors of a joint of rods with the arms a_i, whose moment is that given, N·m: `Σ (|a|² I − a aᵀ) ω` is. The joint has
    /// the opposite ones.
    pub fn add_moment(&self, joint: usize, moment: [f64; 3], forces: &mut [f64]) {
        let directors = [0, 1].map(|k| self.node_count() + 2 * joint + k);
        let arms = directors
            .map(|p| Vector3::from_column_slice(self.point(p)) - Vector3::from_column_slice(self.point(joint)));
        let inertia: Matrix3<f64> =
            arms.iter().map(|a| Matrix3::identity() * a.norm_squared() - a * a.transpose()).sum();
        let turn = inertia.try_inverse().expect("the directors of a joint are not on one line") * Vector3::from(moment);
        // Forces across the arms do all of the moment: along them they would only stretch the directors.
        for (director, arm) in directors.into_iter().zip(arms) {
            add(forces, director, turn.cross(&arm).into(), 1.0);
            add(forces, joint, turn.cross(&arm).into(), -1.0);
        }
    }

    /// Adds the forces of a moment on an edge: along it that of its director, and across it a pair on its ends.
    fn turn_edge(&self, [a, b]: [usize; 2], director: usize, moment: [f64; 3], forces: &mut [f64]) {
        let middle = self.mean_place(&[a, b]);
        let from = |x: &[f64], p: usize| -> [f64; 3] { std::array::from_fn(|k| self.point(p)[k] - x[k]) };
        let (edge, arm) = (from(self.point(a), b), from(&middle, director));
        let length = norm(&edge);
        let along = edge.map(|x| x / length);
        let about = dot(&moment, &along);
        let force = cross(along, arm).map(|f| f * about / dot(&arm, &arm));
        add(forces, director, force, 1.0);
        // The part along the edge is the director's; a pair on the ends has the rest, and its lever is the edge.
        let pair = cross(std::array::from_fn(|k| moment[k] - about * along[k]), along).map(|f| f / length);
        for (end, sign) in [(a, -1.0), (b, 1.0)] {
            add(forces, end, force, -0.5);
            add(forces, end, pair, sign);
        }
    }
}

fn add(forces: &mut [f64], point: usize, force: [f64; 3], factor: f64) {
    forces[3 * point..3 * point + 3].iter_mut().zip(force).for_each(|(all, f)| *all += factor * f);
}
