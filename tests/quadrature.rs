//! Quadrature rules integrate what they promise.

use springfit_element::element::{Cell, Quadrature};

fn factorial(n: usize) -> f64 {
    (1..=n).map(|i| i as f64).product()
}

/// `∫ x^a y^b z^c`: `a! b! c!/(a+b+c+d)!` over the simplex, a product of `2/(e+1)` (0 for odd e) over the cube, their
/// product over the wedge; over the pyramid `∫ (1−z)^(a+b+2) z^c dz`, a beta function, times the square's; over the
/// pentagon by Green's theorem `Σ_edges ∫ x^(a+1)/(a+1) y^b dy`, here with a rule of the line that is tested too.
fn integral(cell: Cell, e: &[usize]) -> f64 {
    let line = |e: usize| if e.is_multiple_of(2) { 2.0 / (e + 1) as f64 } else { 0.0 };
    let simplex =
        |e: &[usize]| e.iter().map(|e| factorial(*e)).product::<f64>() / factorial(e.iter().sum::<usize>() + e.len());
    match cell {
        Cell::Triangle | Cell::Tetrahedron => simplex(e),
        Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron => e.iter().map(|e| line(*e)).product(),
        Cell::Wedge => simplex(&e[..2]) * line(e[2]),
        Cell::Pyramid => {
            let n = e[0] + e[1] + 2;
            line(e[0]) * line(e[1]) * factorial(n) * factorial(e[2]) / factorial(n + e[2] + 1)
        }
        Cell::Pentagon => {
            let rule = Quadrature::gauss_legendre(1, (e[0] + e[1]) / 2 + 2);
            let corners = cell.corners();
            let edge = |i: usize| -> f64 {
                let (a, b) = (corners[i], corners[(i + 1) % 5]);
                let at = |s: f64, k: usize| a[k] + (1.0 + s) / 2.0 * (b[k] - a[k]);
                let value = |s: f64| at(s, 0).powi(e[0] as i32 + 1) / (e[0] + 1) as f64 * at(s, 1).powi(e[1] as i32);
                rule.points.iter().zip(&rule.weights).map(|(s, w)| w * value(*s) * (b[1] - a[1]) / 2.0).sum()
            };
            (0..5).map(edge).sum()
        }
    }
}

/// Sums of a few thousand terms of size one round to 1e-13.
#[test]
fn rules_integrate_every_monomial_of_their_degree() {
    for cell in Cell::ALL {
        let d = cell.dimension();
        assert!((integral(cell, &vec![0; d]) - cell.content()).abs() < 1e-15, "{cell:?}");
        for degree in 0..=20 {
            let rule = Quadrature::of_degree(cell, degree);
            assert!(rule.weights.iter().all(|w| *w > 0.0));
            for code in 0..(degree + 1).pow(d as u32) {
                let e: Vec<usize> = (0..d).map(|k| code / (degree + 1).pow(k as u32) % (degree + 1)).collect();
                if e.iter().sum::<usize>() > degree {
                    continue;
                }
                let exact = integral(cell, &e);
                let monomial = |x: &[f64]| x.iter().zip(&e).map(|(x, e)| x.powi(*e as i32)).product::<f64>();
                let sum: f64 = rule.points.chunks_exact(d).zip(&rule.weights).map(|(x, w)| w * monomial(x)).sum();
                assert!((sum - exact).abs() < 1e-13, "{cell:?} degree {degree} exponents {e:?}: {sum} {exact}");
            }
        }
    }
}
