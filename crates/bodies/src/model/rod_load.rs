//! Distributed loads on rods as forces and moments on their joints.
//!
//! Theory: page *Rods that bend* of the book.

use crate::element::Integrand;
use crate::mesh::Mesh;
use crate::springs::{cross, dot, norm};

/// The forces and moments by which the joints of rods do the work of a distributed load, `f_a = ∫ N_a q dx` and `m_a = ∫ M_a t × q dx`, on the bending lines of
/// a beam.
///
/// Across a rod along t, N and M are the cubic lines by which a beam moves when one end is moved or turned; along it, N is linear. Joints then move as those of a
/// beam under the load itself, with one rod for each member. Shares of the load by linear functions alone, which have no moments, let a cantilever under its
/// weight sink a third too far.
pub(super) struct RodLoad<'a> {
    mesh: &'a Mesh,
    /// `[points × 3]`, N.
    forces: Vec<f64>,
    /// `[joints]`, N·m.
    moments: Vec<[f64; 3]>,
}

impl<'a> RodLoad<'a> {
    /// Whether the lines of a mesh are rods that bend.
    pub fn is_of(mesh: &Mesh) -> bool {
        mesh.directors.is_some() && mesh.cell_dimension() == 1
    }

    /// No load, on a mesh whose lines are rods that bend; `None` on any other.
    pub fn of(mesh: &'a Mesh) -> Option<RodLoad<'a>> {
        RodLoad::is_of(mesh).then(|| RodLoad {
            mesh,
            forces: vec![0.0; mesh.points.len()],
            moments: vec![[0.0; 3]; mesh.node_count()],
        })
    }

    /// The integrand of a load of this degree in the position, beside cubic lines.
    pub fn integrand(degree: usize) -> Integrand {
        // Rules of a load are exact for its degree times linear functions; cubic lines have two degrees more.
        Integrand::Load(degree + 2)
    }

    /// Adds a force, N, at the share s of the length of a rod from its first end to its second.
    pub fn add(&mut self, ends: [usize; 2], s: f64, force: [f64; 3]) {
        let [a, b] = ends.map(|end| self.mesh.point(end));
        let rod: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
        let length = norm(&rod);
        let tangent = rod.map(|x| x / length);
        let pull = dot(&force, &tangent);
        let turn = cross(tangent, force);
        let lines = [
            // Hermite's cubic lines; the moment of the second end has the other sign, as a load between both turns the
            // ends against each other.
            (1.0 - s, 1.0 - s * s * (3.0 - 2.0 * s), length * s * (1.0 - s).powi(2)),
            (s, s * s * (3.0 - 2.0 * s), -length * s * s * (1.0 - s)),
        ];
        for (end, (along, across, moment)) in ends.into_iter().zip(lines) {
            for k in 0..3 {
                let axial = pull * tangent[k];
                self.forces[3 * end + k] += along * axial + across * (force[k] - axial);
                self.moments[end][k] += moment * turn[k];
            }
        }
    }

    /// The forces on all points, `[points × 3]`, N, with those on directors that are the moments.
    pub fn forces(mut self) -> Vec<f64> {
        let turned = self.moments.iter().enumerate().filter(|(_, moment)| **moment != [0.0; 3]);
        turned.for_each(|(joint, moment)| self.mesh.add_moment(joint, *moment, &mut self.forces));
        self.forces
    }
}
