//! The constant-strain motions of an element.

/// An orthonormal basis of the motions `u_a = ε x_a`, ε symmetric and constant, made orthogonal to rigid motions:
/// rows of `[3 × nodes·dimension]` in the plane, `[6 × nodes·dimension]` in space, for nodes at `x`.
pub fn constant_strain(x: &[f64], dimension: usize) -> Vec<Vec<f64>> {
    let d = dimension;
    let nodes = x.len() / d;
    let centre: Vec<f64> = (0..d).map(|k| x.iter().skip(k).step_by(d).sum::<f64>() / nodes as f64).collect();
    // u = e_k r_l ± e_l r_k about the centre, which leaves nothing along translations.
    let motion = |k: usize, l: usize, sign: f64| {
        let mut u = vec![0.0; x.len()];
        for (u, x) in u.chunks_exact_mut(d).zip(x.chunks_exact(d)) {
            u[k] += x[l] - centre[l];
            if k != l {
                u[l] += sign * (x[k] - centre[k]);
            }
        }
        u
    };
    let pairs: Vec<(usize, usize)> = (0..d).flat_map(|k| (0..k).map(move |l| (k, l))).collect();
    let mut basis: Vec<Vec<f64>> = pairs.iter().map(|&(k, l)| motion(k, l, -1.0)).collect();
    basis.extend((0..d).map(|k| motion(k, k, 1.0)));
    basis.extend(pairs.iter().map(|&(k, l)| motion(k, l, 1.0)));
    for i in 0..basis.len() {
        let (before, rest) = basis.split_at_mut(i);
        // Twice is enough: Gram–Schmidt repeated once is orthogonal to rounding.
        for _ in 0..2 {
            for b in before.iter() {
                let along: f64 = b.iter().zip(&rest[0]).map(|(b, u)| b * u).sum();
                rest[0].iter_mut().zip(b).for_each(|(u, b)| *u -= along * b);
            }
            let norm = rest[0].iter().map(|u| u * u).sum::<f64>().sqrt();
            rest[0].iter_mut().for_each(|u| *u /= norm);
        }
    }
    basis.split_off(pairs.len())
}
