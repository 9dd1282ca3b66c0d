use crate::scalar::{Sum, scaled_norm};

/// Distances of the network's points from those of the finite elements, in percent of the largest displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementError {
    /// `100 √(mean_i |u_i^FEM − u_i^LEM|²) / max_i |u_i^FEM|`, over all points.
    pub rms: f64,
    /// `100 max_i |u_i^FEM − u_i^LEM| / max_i |u_i^FEM|`.
    pub max: f64,
}

/// Natsupakpong and Çavuşoğlu (2010), section 3. `fem` and `lem` are `[points × dimension]`, m; `None` if the finite
/// elements do not move, or a displacement or an error is not finite.
pub fn displacement_error(fem: &[f64], lem: &[f64], dimension: usize) -> Option<DisplacementError> {
    if !fem.iter().chain(lem).all(|u| u.is_finite()) {
        return None;
    }
    let square = |a: &[f64]| a.iter().map(|x| x * x).collect::<Sum>().value();
    let length = |a: &[f64]| scaled_norm(a, square);
    let largest = fem.chunks_exact(dimension).map(length).fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let difference: Vec<f64> = fem.iter().zip(lem).map(|(a, b)| (a - b) / largest).collect();
    let points = (fem.len() / dimension) as f64;
    let worst = difference.chunks_exact(dimension).map(length).fold(0.0, f64::max);
    let rms = scaled_norm(&difference, |a| square(a) / points);
    let error = DisplacementError { rms: 100.0 * rms, max: 100.0 * worst };
    Some(error).filter(|error| error.rms.is_finite() && error.max.is_finite())
}
