use crate::scalar::Sum;

/// What a solution may leave of the forces: a factor of a nearly singular matrix gives numbers that solve nothing.
pub const SOLVED: f64 = 1e-6;

/// Distances of the network's points from those of the finite elements, in percent of the largest displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementError {
    /// `100 √(mean_i |u_i^FEM − u_i^LEM|²) / max_i |u_i^FEM|`, over all points.
    pub rms: f64,
    /// `100 max_i |u_i^FEM − u_i^LEM| / max_i |u_i^FEM|`.
    pub max: f64,
}

/// Natsupakpong and Çavuşoğlu (2010), section 3. `fem` and `lem` are `[points × dimension]`, m; `None` if the finite
/// elements do not move.
pub fn displacement_error(fem: &[f64], lem: &[f64], dimension: usize) -> Option<DisplacementError> {
    let square = |a: &[f64]| a.iter().map(|x| x * x).collect::<Sum>().value();
    let largest = fem.chunks_exact(dimension).map(square).fold(0.0, f64::max).sqrt();
    if largest == 0.0 {
        return None;
    }
    let difference: Vec<f64> = fem.iter().zip(lem).map(|(a, b)| (a - b) / largest).collect();
    let points = (fem.len() / dimension) as f64;
    let worst = difference.chunks_exact(dimension).map(square).fold(0.0, f64::max).sqrt();
    Some(DisplacementError { rms: 100.0 * (square(&difference) / points).sqrt(), max: 100.0 * worst })
}
