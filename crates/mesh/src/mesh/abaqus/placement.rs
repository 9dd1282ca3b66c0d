//! Where an instance puts its part.

use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, dot, norm};

/// Moves the points by the data lines of an instance: a translation, then two points of an axis and an angle in degrees,
/// by which the translated part is turned (Rodrigues).
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
    let &[ax, ay, az, bx, by, bz, angle] = &turn[..] else { return Err(wrong()) };
    let axis = [bx - ax, by - ay, bz - az];
    let length = norm(&axis);
    if !(length > 0.0) {
        return Err(wrong());
    }
    let u = axis.map(|x| x / length);
    let (sine, cosine) = angle.to_radians().sin_cos();
    for p in points {
        let v = [p[0] - ax, p[1] - ay, p[2] - az];
        let (along, turned) = (dot(&u, &v), cross(u, v));
        let origin = [ax, ay, az];
        *p = std::array::from_fn(|k| origin[k] + v[k] * cosine + turned[k] * sine + u[k] * along * (1.0 - cosine));
    }
    Ok(())
}
