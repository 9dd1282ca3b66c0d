//! Jacobi's eigenvectors of symmetric matrices.

use springfit_fit::fit::solvers::eigenvectors;

#[test]
fn vectors_are_orthonormal_and_rebuild_the_matrix() {
    for n in 1..20 {
        for repeated in [false, true] {
            // Repeated eigenvalues: a multiple of I plus one direction.
            let entry = |i: usize, j: usize| match repeated {
                true => f64::from(u8::from(i == j)) + 0.5 / ((1 + i) * (1 + j)) as f64,
                false => ((3 * i * j + i + j) as f64).sin() + 1.0 / (1 + i + j) as f64,
            };
            let given: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let (mut a, mut v) = (given.clone(), vec![0.0; n * n]);
            eigenvectors(&mut a, n, &mut v);
            for i in 0..n {
                for j in 0..n {
                    let product: f64 = (0..n).map(|k| v[i * n + k] * v[j * n + k]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14, "{n}: {product}");
                    let rebuilt: f64 = (0..n).map(|k| v[k * n + i] * a[k * n + k] * v[k * n + j]).sum();
                    assert!((rebuilt - given[i * n + j]).abs() < 1e-13, "{n}: {rebuilt}");
                }
            }
        }
    }
}
