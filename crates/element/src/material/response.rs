//! The stress and the tangent of an energy at a deformation gradient.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::energy::Energy;
use crate::symbolic::Jet;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The second derivative of the energy, `∂P_ij/∂F_kl` at `[3i + j][3k + l]`, in Pa.
pub type Tangent = SMatrix<f64, 9, 9>;

/// Principal stretches that differ by less than this share count as equal: the divided difference has a rounding error
/// of 1e-10 there, and the limit has an error of the square of this share.
const SAME: f64 = 1e-6;

/// The invariants of one deformation gradient.
struct Invariants {
    /// The right Cauchy–Green tensor `C = FᵀF`.
    c: Matrix3<f64>,
    /// The deformed fibre direction `F a`.
    fibre: Option<Vector3<f64>>,
    /// I1, I2, J, I4.
    values: [f64; 4],
}

impl Energy {
    /// The energy `W`, the first Piola–Kirchhoff stress `P = ∂W/∂F` in Pa, and `∂P/∂F`, at the deformation gradient F.
    /// They are not finite where the energy is not: at `J ≤ 0` for energies with `ln(J)`.
    pub fn respond(&self, f: &Matrix3<f64>) -> (f64, Matrix3<f64>, Tangent) {
        if self.formula.by_stretches { self.by_stretches(f) } else { self.by_invariants(f) }
    }

    /// The stress `P = ∂W/∂F` alone, at a fraction of the cost.
    pub fn stress(&self, f: &Matrix3<f64>) -> Matrix3<f64> {
        let Invariants { c, fibre, values: [i1, i2, j, i4] } = self.invariants(f);
        let mut at = vec![i1, i2, j, i4, 1.0, 1.0, 1.0];
        at.extend(&self.constants);
        if self.formula.by_stretches {
            let Some((n, stretch, big_n)) = principal(f) else { return Matrix3::repeat(f64::NAN) };
            at[4..7].copy_from_slice(stretch.as_slice());
            let slopes = SVector::<f64, 7>::from_fn(|v, _| self.formula.slopes[v].evaluate(&at));
            let pull = of_stretches(&stretch).transpose() * slopes;
            return (0..3).map(|i| pull[i] * n.column(i) * big_n.column(i).transpose()).sum();
        }
        let mut stress = Matrix3::zeros();
        let mut add = |v: usize, direction: &dyn Fn() -> Matrix3<f64>| {
            // Most energies lack an invariant, whose direction need not be worked out.
            if !self.formula.slopes[v].is_zero() {
                stress += self.formula.slopes[v].evaluate(&at) * direction();
            }
        };
        add(0, &|| 2.0 * f);
        add(1, &|| 2.0 * (i1 * f - f * c));
        add(2, &|| cofactor(f));
        if let (Some(b), Some(a)) = (fibre, self.fibre) {
            add(3, &|| 2.0 * b * a.transpose());
        }
        stress
    }

    /// `I1 = tr C`, `I2 = (I1² − tr C²)/2`, `J = det F`, `I4 = |F a|²`; the last is one without fibres.
    fn invariants(&self, f: &Matrix3<f64>) -> Invariants {
        let c = f.transpose() * f;
        let i1 = c.trace();
        let fibre = self.fibre.map(|a| f * a);
        let i4 = fibre.map_or(1.0, |a| a.norm_squared());
        Invariants { c, fibre, values: [i1, (i1 * i1 - (c * c).trace()) / 2.0, f.determinant(), i4] }
    }

    /// The energy with its derivatives in the first of these variables: I1, I2, J, I4 and the stretches.
    fn jet(&self, at: [f64; 7], variables: usize) -> Jet {
        let at: Vec<f64> = at.into_iter().chain(self.constants.iter().copied()).collect();
        self.formula.expression.program().jet(&at, variables)
    }

    /// The chain rule on the invariants.
    fn by_invariants(&self, f: &Matrix3<f64>) -> (f64, Matrix3<f64>, Tangent) {
        let Invariants { c, fibre, values: [i1, i2, j, i4] } = self.invariants(f);
        // The stretches are not needed here.
        let w = self.jet([i1, i2, j, i4, 1.0, 1.0, 1.0], 4);
        // cof F = J F^(−T), also at J = 0.
        let cofactor = cofactor(f);
        let firsts = [
            2.0 * f,
            2.0 * (i1 * f - f * c),
            cofactor,
            fibre.zip(self.fibre).map_or(Matrix3::zeros(), |(b, a)| 2.0 * b * a.transpose()),
        ];
        let mut stress = Matrix3::zeros();
        firsts.iter().zip(&w.gradient).for_each(|(d, g)| stress += *g * d);
        // Most energies have few second derivatives in the invariants.
        let bends: Vec<(f64, &Matrix3<f64>, &Matrix3<f64>)> = (w.hessian.iter().enumerate())
            .filter(|(_, bend)| **bend != 0.0)
            .map(|(pair, bend)| (*bend, &firsts[pair / 4], &firsts[pair % 4]))
            .collect();
        let b = f * f.transpose();
        let mut tangent = Tangent::zeros();
        for (row, i, k) in (0..9).map(|r| (r, r / 3, r % 3)) {
            for (column, l, m) in (0..9).map(|s| (s, s / 3, s % 3)) {
                let same = |a: usize, b: usize| f64::from(u8::from(a == b));
                // ∂²I1 = 2 δ δ; ∂²I2 = 2(2 F F + I1 δ δ − F_il... ); ∂²J from the permutation symbols; ∂²I4 = 2 δ a a
                let second1 = 2.0 * same(i, l) * same(k, m);
                let second2 = 2.0
                    * (2.0 * f[(i, k)] * f[(l, m)] + i1 * same(i, l) * same(k, m)
                        - same(i, l) * c[(m, k)]
                        - f[(i, m)] * f[(l, k)]
                        - b[(i, l)] * same(k, m));
                let second3 = second_of_determinant(f, (i, k), (l, m));
                let second4 = self.fibre.map_or(0.0, |a| 2.0 * same(i, l) * a[k] * a[m]);
                let mut entry = w.gradient[0] * second1
                    + w.gradient[1] * second2
                    + w.gradient[2] * second3
                    + w.gradient[3] * second4;
                for (bend, dp, dq) in &bends {
                    entry += bend * dp[(i, k)] * dq[(l, m)];
                }
                tangent[(row, column)] = entry;
            }
        }
        (w.value, stress, tangent)
    }

    /// In the frame of the singular vectors, `F = Σ λ_i n_i N_iᵀ`; Ogden (1984), 6.1.4.
    fn by_stretches(&self, f: &Matrix3<f64>) -> (f64, Matrix3<f64>, Tangent) {
        let Some((n, stretch, big_n)) = principal(f) else {
            return (f64::NAN, Matrix3::repeat(f64::NAN), Tangent::repeat(f64::NAN));
        };
        let (value, g, h) = self.in_stretches(&stretch);
        let direction = |i: usize, j: usize| n.column(i) * big_n.column(j).transpose();
        let mut stress = Matrix3::zeros();
        (0..3).for_each(|i| stress += g[i] * direction(i, i));
        let mut tangent = Tangent::zeros();
        // nalgebra stores columns, whereas the tangent counts its entries row by row.
        let flat = |a: Matrix3<f64>| SMatrix::<f64, 9, 1>::from_row_slice(a.transpose().as_slice());
        for i in 0..3 {
            for j in 0..3 {
                tangent += h[(i, j)] * flat(direction(i, i)) * flat(direction(j, j)).transpose();
                // An axis does not turn against itself: what follows is the part of rotations of two axes.
                if i == j {
                    continue;
                }
                let (a, b) = (stretch[i], stretch[j]);
                let (direct, crossed) = if (a - b).abs() > SAME * (a.abs() + b.abs()) {
                    let below = a * a - b * b;
                    ((a * g[i] - b * g[j]) / below, (b * g[i] - a * g[j]) / below)
                } else {
                    // Means of the values at both stretches: the error is the square of their difference.
                    let bend = ((h[(i, i)] + h[(j, j)]) / 2.0 - h[(i, j)]) / 2.0;
                    let pull = (g[i] + g[j]) / (2.0 * (a + b));
                    (bend + pull, bend - pull)
                };
                tangent += direct * flat(direction(i, j)) * flat(direction(i, j)).transpose();
                tangent += crossed * flat(direction(i, j)) * flat(direction(j, i)).transpose();
            }
        }
        (value, stress, tangent)
    }

    /// The energy with its derivatives in the stretches, by the chain rule: an energy may have invariants and stretches.
    fn in_stretches(&self, l: &Vector3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let squares = l.component_mul(l);
        let i1 = squares.sum();
        let i2 = squares[0] * squares[1] + squares[1] * squares[2] + squares[2] * squares[0];
        let w = self.jet([i1, i2, l[0] * l[1] * l[2], 1.0, l[0], l[1], l[2]], 7);
        let first = of_stretches(l);
        let [g1, g2, g3] = [w.gradient[0], w.gradient[1], w.gradient[2]];
        let bend = Matrix3::from_fn(|i, j| match i == j {
            true => 2.0 * g1 + 2.0 * (squares[(i + 1) % 3] + squares[(i + 2) % 3]) * g2,
            false => 4.0 * l[i] * l[j] * g2 + l[3 - i - j] * g3,
        });
        let second = first.transpose() * SMatrix::<f64, 7, 7>::from_row_slice(&w.hessian) * first + bend;
        (w.value, first.transpose() * SVector::<f64, 7>::from_column_slice(&w.gradient), second)
    }
}

/// The derivatives of I1, I2, J, I4 and the stretches λ in the stretches: `∂I1/∂λ_i = 2 λ_i`, `∂I2/∂λ_i = 2 λ_i (λ_j² + λ_k²)`.
fn of_stretches(l: &Vector3<f64>) -> SMatrix<f64, 7, 3> {
    SMatrix::from_fn(|v, i| match v {
        0 => 2.0 * l[i],
        1 => 2.0 * l[i] * (l[(i + 1) % 3].powi(2) + l[(i + 2) % 3].powi(2)),
        2 => l[(i + 1) % 3] * l[(i + 2) % 3],
        3 => 0.0,
        _ => f64::from(u8::from(v - 4 == i)),
    })
}

/// The decomposition `F = Σ λ_i n_i N_iᵀ`: the n as columns, the λ, and the N as columns. A reflection appears as the
/// sign of the least stretch.
fn principal(f: &Matrix3<f64>) -> Option<(Matrix3<f64>, Vector3<f64>, Matrix3<f64>)> {
    // A decomposition by iterations need not end with numbers that are not finite.
    if !f.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    #[expect(
        clippy::disallowed_methods,
        reason = "nalgebra decomposes matrices of three rows and columns in a way of its own, which is right"
    )]
    let svd = f.svd(true, true);
    let (mut n, big_n, mut stretch) = (svd.u?, svd.v_t?.transpose(), svd.singular_values);
    // Singular values have no sign: the least of them takes that of det F, so that J of the stretches is that of F.
    if f.determinant() < 0.0 {
        stretch[2] = -stretch[2];
        n.column_mut(2).neg_mut();
    }
    Some((n, stretch, big_n))
}

/// `∂det F/∂F`.
fn cofactor(f: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, k| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3);
        f[(a, c)] * f[(b, d)] - f[(a, d)] * f[(b, c)]
    })
}

/// `∂² det F/∂F_ik ∂F_lm = ε_ilp ε_kmq F_pq`.
fn second_of_determinant(f: &Matrix3<f64>, (i, k): (usize, usize), (l, m): (usize, usize)) -> f64 {
    // det F is linear in each row and in each column.
    if i == l || k == m {
        return 0.0;
    }
    let sign = |a: usize, b: usize| if (b + 3 - a) % 3 == 1 { 1.0 } else { -1.0 };
    sign(i, l) * sign(k, m) * f[(3 - i - l, 3 - k - m)]
}
