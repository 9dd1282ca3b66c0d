//! The lower bound that the barrier method proves: no constants reach a smaller value.
//!
//! Theory: page *The 2-norm* of the book.

use super::Spectral;
use crate::fit::dense::{add_outers, factorize, inner, mirror, row_products, solve, trace};
use crate::fit::reduction::Reduced;
use crate::scalar::Real;

impl<T: Real> Spectral<T> {
    /// The bound of the pair (X, Y) that the last Newton step gives. Every condition is checked here: X and Y are
    /// factorised, and the remainder of `⟨h_s h_sᵀ, X − Y⟩` is corrected by changing them.
    #[inline(always)]
    pub(super) fn bound(&mut self, reduced: &Reduced<T>, mu: &T) -> T {
        let (p, c) = (reduced.order, self.kappa.len());
        let m = reduced.unknowns.len();
        let h = reduced.rows();
        let zero = mu.zero();
        // ΔK
        for entry in &mut self.e {
            *entry = zero.clone();
        }
        add_outers(&mut self.e, h, p, &self.newton, &reduced.unknowns, 1.0);
        mirror(&mut self.e, p);
        for i in 0..p {
            self.e[i * p + i] = self.e[i * p + i].clone() + &self.newton[c];
        }
        self.a.dual(&self.e, mu, p, &mut self.room);
        for i in 0..p * p {
            self.e[i] = self.e[i].negated();
        }
        for i in 0..p {
            self.e[i * p + i] = self.e[i * p + i].clone() + &self.newton[c].clone().scaled(&2.0);
        }
        self.b.dual(&self.e, mu, p, &mut self.room);
        // Z = X − Y, both triangles.
        for i in 0..p {
            for j in 0..=i {
                self.e[i * p + j] = self.a.matrix[i * p + j].clone() - &self.b.matrix[i * p + j];
            }
        }
        mirror(&mut self.e, p);
        let mut size = trace(&self.a.matrix, p) + &trace(&self.b.matrix, p);
        let definite = factorize(&mut self.a.matrix, p, 0.0, &mut self.a.pivots);
        let definite = definite.least(&factorize(&mut self.b.matrix, p, 0.0, &mut self.b.pivots));
        // y = N⁻¹ r, r_I = Σ hᵀ Z h; only what exceeds zero where κ ≥ 0
        let y = &mut self.newton[..c];
        // The Newton step has been used up above, and its room serves as y.
        for entry in y.iter_mut() {
            *entry = zero.clone();
        }
        row_products(h, &self.e, p, false, &mut self.a.images);
        for (s, &unknown) in reduced.unknowns.iter().enumerate() {
            let row = s * p..(s + 1) * p;
            y[unknown] = y[unknown].clone() + &inner(&h[row.clone()], &self.a.images[row]);
        }
        if self.nonnegative {
            for entry in y.iter_mut() {
                // With κ ≥ 0 a product below zero only strengthens the inequality: the bound needs no correction for it.
                *entry = entry.greatest(&zero);
            }
        }
        solve(&self.gram, c, &self.gram_pivots, y);
        let mut value = inner(&reduced.stiffness[..p * p], &self.e);
        row_products(h, &reduced.stiffness[..p * p], p, false, &mut self.a.images);
        for s in 0..m {
            let y = &self.newton[reduced.unknowns[s]];
            let row = s * p..(s + 1) * p;
            let h = &h[row.clone()];
            value = value.minus_product(y, &inner(h, &self.a.images[row]));
            size = size.plus_product(&y.magnitude(), &inner(h, h));
        }
        // The bound zero always holds: a pair that is not positive proves nothing more.
        definite.choose(&(value / &size).greatest(&zero), &zero)
    }
}
