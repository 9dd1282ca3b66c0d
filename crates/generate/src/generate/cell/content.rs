//! The content of a cell at given positions: `Σ_q w_q |J_q|`, and its gradient.

use super::{Cell, Constant, Index, Room, Value};
use crate::element::Tabulation;
use crate::scalar::{Scalar, adjugate, of_dimension};

/// The determinant of the Jacobian `J_kl = Σ_a x_ak ∂N_a/∂ξ_l` of one point, and its gradient
/// `∂|J|/∂x_ak = Σ_l ∂N_a/∂ξ_l adj(J)_lk`, `[nodes × dimension]`.
pub fn determinant(x: &[Value], table: &Tabulation<Constant>) -> (Value, Vec<Value>) {
    of_dimension!(table.dimension, |D| determinant_in::<D>(x, table))
}

fn determinant_in<const D: usize>(x: &[Value], table: &Tabulation<Constant>) -> (Value, Vec<Value>) {
    let zero = x[0].zero();
    let gradients: Vec<Value> = table.gradients.iter().map(|g| zero.constant(g)).collect();
    let mut jacobian: [[Value; D]; D] = zero.repeated_rows();
    for (x, dn) in x.chunks_exact(D).zip(gradients.chunks_exact(D)) {
        for k in 0..D {
            for l in 0..D {
                jacobian[k][l] = jacobian[k][l].clone().plus_product(&x[k], &dn[l]);
            }
        }
    }
    let (adjugate, determinant) = adjugate(&jacobian);
    let along = |dn: &[Value], k: usize| (0..D).fold(zero.clone(), |sum, l| sum.plus_product(&dn[l], &adjugate[l][k]));
    let gradient = gradients.chunks_exact(D).flat_map(|dn| (0..D).map(move |k| (dn, k))).map(|(dn, k)| along(dn, k));
    (determinant, gradient.collect())
}

impl Cell<'_> {
    /// Calls `work(q, content, gradient)` for the content `w |J|` of every quadrature point; a point that serves the
    /// term of λ alone has its weight in that term.
    pub fn each_content(&self, mut work: impl FnMut(&Index, &Value, &[Value])) {
        self.each_table(|q, table| {
            let weight = match q.number() {
                Some(q) => self.x[0].like(self.element.tabulation.point_weight(q)),
                None => self.x[0].constant(&table.weights[0]),
            };
            let (determinant, gradient) = determinant(&self.x, table);
            let gradient: Vec<Value> = gradient.iter().map(|g| g * &weight).collect();
            work(q, &(determinant * &weight), &gradient);
        });
    }

    /// The content of the cell by the rule of the term of μ, and its gradient with `is_bent`.
    pub fn content(&self, is_bent: bool) -> (Value, Vec<Value>) {
        let (body, size) = (&self.body, self.x.len());
        let is_array = !self.plan.points;
        let mut sum = Room::new(body, "content", 1, is_array);
        let mut slopes = Room::new(body, "slopes", if is_bent { size } else { 0 }, is_array && is_bent);
        self.each_table(|_, table| {
            let weight = self.x[0].constant(&table.weights[0]);
            let (determinant, gradient) = determinant(&self.x, table);
            sum.add(body, 0, &(determinant * &weight));
            if is_bent {
                (0..size).for_each(|i| slopes.add(body, i, &(&gradient[i] * &weight)));
            }
        });
        let slopes = if is_bent { (0..size).map(|i| slopes.get(body, i)).collect() } else { Vec::new() };
        (sum.get(body, 0), slopes)
    }
}
