//! Where an instance puts its part, and turns about an axis.

use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, dot, norm};

/// A turn about an axis (Rodrigues).
pub(super) struct Turn {
    origin: [f64; 3],
    axis: [f64; 3],
    sine: f64,
    cosine: f64,
}

impl Turn {
    /// The turn of two points of an axis and an angle in degrees; `None` if there are other than seven numbers, or the points are the same.
    pub fn of(numbers: &[f64]) -> Option<Turn> {
        let &[ax, ay, az, bx, by, bz, angle] = numbers else { return None };
        let axis = [bx - ax, by - ay, bz - az];
        let length = norm(&axis);
        let (sine, cosine) = angle.to_radians().sin_cos();
        (length > 0.0).then(|| Turn { origin: [ax, ay, az], axis: axis.map(|x| x / length), sine, cosine })
    }

    /// Where the turn takes a point.
    pub fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        let (u, origin) = (self.axis, self.origin);
        let v = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
        let (along, turned) = (dot(&u, &v), cross(u, v));
        std::array::from_fn(|k| {
            origin[k] + v[k] * self.cosine + turned[k] * self.sine + u[k] * along * (1.0 - self.cosine)
        })
    }
}

/// Moves the points by the data lines of an instance: a translation, then two points of an axis and an angle in degrees,
/// by which the translated part is turned.
///
/// # Errors
/// The lines have another form.
pub(super) fn place(points: &mut [[f64; 3]], lines: &[Vec<f64>]) -> Result<()> {
    let wrong = || {
        Error::at("*INSTANCE", "expected a translation, and two points of an axis with an angle")
            .of_kind(ErrorKind::Syntax)
    };
    let (shift, turn) = match lines {
        [] => return Ok(()),
        [shift] => (shift, None),
        [shift, turn] => (shift, Some(turn)),
        _ => return Err(wrong()),
    };
    let &[dx, dy, dz] = &shift[..] else { return Err(wrong()) };
    points.iter_mut().for_each(|p| *p = [p[0] + dx, p[1] + dy, p[2] + dz]);
    let Some(turn) = turn else { return Ok(()) };
    let turn = Turn::of(turn).ok_or_else(wrong)?;
    points.iter_mut().for_each(|p| *p = turn.apply(*p));
    Ok(())
}
