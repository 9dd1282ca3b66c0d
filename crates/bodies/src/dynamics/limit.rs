//! The highest frequency of a model, and the longest step of an explicit method.
//!
//! Theory: page *Dynamics* of the book.

use crate::model::BlockStiffness;
use crate::solve::generator;
use crate::springs::{dot, norm};
use nalgebra::DMatrix;

/// The number of steps of the Lanczos method. Where they do not find the largest eigenvalue, Gershgorin's bound takes
/// over, and explicit steps are shorter than they could be.
const STEPS: usize = 120;
/// Degrees of freedom from which on not all vectors of the Lanczos method are kept. Below it all of them fit into 100
/// MB.
const LARGE: usize = 100_000;
/// The largest eigenvalue is accepted if its residual is below this share of it. The bound is then too large by a
/// thousandth, and the step too short by half of that.
const FOUND: f64 = 1e-3;

/// An upper bound of the largest ω² of `K φ = ω² M φ` on the free degrees of freedom, rad²/s²; zero if nothing resists.
///
/// `entries` are those of the lower triangle of K; `masses` and `held` are given for all degrees of freedom. The
/// Lanczos method on `M^(−½) K M^(−½)` gives θ and a residual r; an eigenvalue is within r of θ. The bound is `θ + r`
/// once r ≤ θ/1000, but never more than Gershgorin's bound `max_i Σ_j |K_ij|/√(m_i m_j)`, which always holds. The
/// result is reproducible to the last bit.
pub fn largest_square(entries: impl Iterator<Item = (usize, usize, f64)>, masses: &[f64], held: &[bool]) -> f64 {
    largest_of(entries.collect(), masses, held)
}

/// [`largest_square`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn largest_of(entries: Vec<(usize, usize, f64)>, masses: &[f64], held: &[bool]) -> f64 {
    let free: Vec<usize> = (0..held.len()).filter(|dof| !held[*dof]).collect();
    let mut place = vec![usize::MAX; held.len()];
    free.iter().enumerate().for_each(|(i, &dof)| place[dof] = i);
    let scaled = entries
        .into_iter()
        .filter(|(row, column, _)| !held[*row] && !held[*column])
        .map(|(row, column, value)| (place[row], place[column], value / (masses[row] * masses[column]).sqrt()));
    // Entries at one position are added before their absolute value is used.
    let mut sums: Vec<(usize, usize, f64)> = scaled.collect();
    sums.sort_unstable_by_key(|(row, column, _)| (*row, *column));
    sums.dedup_by(|next, kept| {
        let same = (next.0, next.1) == (kept.0, kept.1);
        kept.2 += if same { next.2 } else { 0.0 };
        same
    });
    let n = free.len();
    let mut discs = vec![0.0; n];
    for &(row, column, value) in &sums {
        // The diagonal is the middle of a disc and keeps its sign; the others are its radius.
        discs[row] += if row == column { value } else { value.abs() };
        discs[column] += if row == column { 0.0 } else { value.abs() };
    }
    let gershgorin = discs.into_iter().fold(0.0, f64::max);
    let apply = |x: &[f64]| {
        let mut y = vec![0.0; n];
        for &(row, column, value) in &sums {
            y[row] += value * x[column];
            if row != column {
                y[column] += value * x[row];
            }
        }
        y
    };
    lanczos(n, apply).map_or(gershgorin, |bound| bound.min(gershgorin))
}

/// Returns the bound of [`largest_square`], rad²/s², for a stiffness in blocks.
pub fn largest_square_of_blocks(stiffness: &BlockStiffness, masses: &[f64], held: &[bool]) -> f64 {
    let free: Vec<usize> = (0..held.len()).filter(|dof| !held[*dof]).collect();
    // A weight of zero takes held rows and columns out of the matrix.
    let weights: Vec<f64> = masses.iter().zip(held).map(|(m, held)| if *held { 0.0 } else { 1.0 / m.sqrt() }).collect();
    let discs = stiffness.absolute_sums(&weights);
    let gershgorin = discs.iter().zip(&weights).map(|(sum, weight)| sum * weight).fold(0.0, f64::max);
    let apply = |x: &[f64]| {
        let mut whole = vec![0.0; held.len()];
        free.iter().zip(x).for_each(|(&dof, x)| whole[dof] = x * weights[dof]);
        let image = stiffness.apply(&whole);
        free.iter().map(|&dof| image[dof] * weights[dof]).collect()
    };
    lanczos(free.len(), apply).map_or(gershgorin, |bound| bound.min(gershgorin))
}

/// `θ + r`, or `None` if r stays large. Of large models only the last two vectors are kept: the largest eigenvalue does not depend on the
/// orthogonality of the others (Paige 1980).
fn lanczos(n: usize, apply: impl Fn(&[f64]) -> Vec<f64>) -> Option<f64> {
    // A random start has a part of the highest motion, which smooth ones may lack; a fixed seed gives the same limit in
    // each run.
    let mut random = generator();
    let mut next: Vec<f64> = (0..n).map(|_| random()).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let (mut diagonal, mut beside): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut size = norm(&next);
    for step in 1..=STEPS.min(n) {
        next.iter_mut().for_each(|x| *x /= size);
        let mut image = apply(&next);
        diagonal.push(dot(&image, &next));
        // In exact arithmetic the image is orthogonal to all vectors but the last two.
        if n > LARGE && basis.len() == 2 {
            basis.remove(0);
        }
        basis.push(next);
        for _ in 0..2 {
            for q in &basis {
                let along = dot(q, &image);
                image.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
            }
        }
        size = norm(&image);
        next = image;
        // Eigenvalues of the projection cost as much as some products; they are looked at now and then.
        if step % 10 == 0 || step == STEPS.min(n) || !(size > 0.0) {
            let entry = |i: usize, j: usize| match i.abs_diff(j) {
                0 => diagonal[i],
                1 => beside[i.min(j)],
                _ => 0.0,
            };
            let projected = DMatrix::from_fn(step, step, entry);
            if projected.iter().any(|x| !x.is_finite()) {
                return None;
            }
            let eigen = springfit_numerics::dense::eigen(projected);
            let top = eigen.eigenvalues.imax();
            let (theta, residual) = (eigen.eigenvalues[top], size * eigen.eigenvectors[(step - 1, top)].abs());
            if residual <= FOUND * theta {
                return Some(theta + residual);
            }
        }
        beside.push(size);
    }
    None
}

/// The longest step of symplectic Euler, s: `4/(γ + √(γ² + 4ω²))`, with `ω²` the largest eigenvalue of `M⁻¹K` and γ
/// that of `M⁻¹C`, 1/s.
///
/// If `4M − 2hC − h²K` is positive definite, every root of `M(z − 1)² + hC(z − 1) + h²K z` is inside the unit circle
/// (Jury). Without damping the limit is `2/ω`, with a damping ratio ζ of all modes `2(√(1 + ζ²) − ζ)/ω`.
pub(super) fn longest_step(square: f64, damping: f64) -> f64 {
    // The root in its other form, (√(γ² + 4 ω²) − γ)/ω², would cancel at large damping, and be 0/0 without stiffness.
    4.0 / (damping + (damping * damping + 4.0 * square).sqrt())
}
