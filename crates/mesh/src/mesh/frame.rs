//! Coordinate systems of decks, and where a point of them is.

use super::space::minus;
use crate::springs::{cross, dot, norm};

/// What the three numbers of a point are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum System {
    /// x, y, z.
    Rectangular,
    /// The distance from the axis z, the angle from x in degrees, and z.
    Cylindrical,
    /// The distance from the origin, the angle from z in degrees, and that of the projection from x in degrees.
    Spherical,
}

/// A coordinate system in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub system: System,
    pub origin: [f64; 3],
    /// The unit vectors along x, y and z.
    pub axes: [[f64; 3]; 3],
}

/// The system in which coordinates are meant that name no other.
pub(super) const BASIC: Frame =
    Frame { system: System::Rectangular, origin: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

impl Frame {
    /// The system with this origin, a point on its axis z, and one in its half-plane of positive x; `None` if they are on one line.
    pub fn of_axis(system: System, origin: [f64; 3], on_z: [f64; 3], in_xz: [f64; 3]) -> Option<Frame> {
        let z = unit(minus(&on_z, &origin))?;
        // The third point need not be on the axis x itself: only the half-plane that it is in counts.
        let y = unit(cross(z, minus(&in_xz, &origin)))?;
        Some(Frame { system, origin, axes: [cross(y, z), y, z] })
    }

    /// The rectangular system with this origin, a point on its axis x, and one in its half-plane of positive y; `None` if they are on one line.
    pub fn of_plane(origin: [f64; 3], on_x: [f64; 3], in_xy: [f64; 3]) -> Option<Frame> {
        let x = unit(minus(&on_x, &origin))?;
        let z = unit(cross(x, minus(&in_xy, &origin)))?;
        Some(Frame { system: System::Rectangular, origin, axes: [x, cross(z, x), z] })
    }

    /// The place in the system around this one of the point with these coordinates.
    pub fn place(&self, at: [f64; 3]) -> [f64; 3] {
        let [first, second, third] = at;
        let local = match self.system {
            System::Rectangular => at,
            System::Cylindrical => {
                let (sine, cosine) = second.to_radians().sin_cos();
                [first * cosine, first * sine, third]
            }
            System::Spherical => {
                let (from_z, around) = (second.to_radians().sin_cos(), third.to_radians().sin_cos());
                [first * from_z.0 * around.1, first * from_z.0 * around.0, first * from_z.1]
            }
        };
        std::array::from_fn(|k| self.origin[k] + (0..3).map(|axis| local[axis] * self.axes[axis][k]).sum::<f64>())
    }
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(&v);
    let scaled = v.map(|x| x / length);
    // Points on one line leave a vector of zero, and huge ones a length that is infinite: neither has a direction.
    (length > 0.0 && dot(&scaled, &scaled).is_finite()).then_some(scaled)
}
