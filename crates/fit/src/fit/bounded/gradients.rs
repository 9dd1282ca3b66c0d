//! Equations solved by conjugate gradients, from products with M alone.

use super::{Equations, State};
use crate::scalar::Packed;

/// The largest number of iterations between two exchanges. Well-conditioned equations take ten to thirty. Where they do
/// not end, the caller solves one lane after the other by factors.
const ITERATIONS: usize = 200;

/// Products with M in the scaling of [`Equations`].
pub trait Product<T> {
    fn scale(&self) -> &[T];

    /// Writes M times the vector into the image.
    fn multiply(&mut self, vector: &[T], image: &mut [T]);
}

/// Each lane takes its own steps, and waits when it has ended.
pub struct Gradients<T, P> {
    product: P,
    direction: Vec<T>,
    image: Vec<T>,
}

impl<T: Packed, P: Product<T>> Gradients<T, P> {
    pub fn new(product: P) -> Gradients<T, P> {
        let room = || vec![product.scale()[0].zero(); product.scale().len()];
        Gradients { direction: room(), image: room(), product }
    }
}

impl<T: Packed, P: Product<T>> Equations<T> for Gradients<T, P> {
    const EXACT: bool = false;

    fn scale(&self) -> &[T] {
        self.product.scale()
    }

    #[inline(always)]
    fn solve(&mut self, state: &mut State<T>, limits: &T) -> bool {
        let Gradients { product, direction, image } = self;
        let State { rhs, free, constants, rest } = state;
        let (m, zero) = (rhs.len(), limits.zero());
        product.multiply(constants, image);
        let mut square = zero.clone();
        for s in 0..m {
            rest[s] = rhs[s].clone() - &image[s];
            // Constants at their bound are zeroed in each direction: the iteration stays in the space of the free ones.
            direction[s] = rest[s].clone() * &free[s];
            square = square.plus_product(&direction[s], &direction[s]);
        }
        for _ in 0..ITERATIONS {
            if limits.exceeds(&square) {
                return true;
            }
            // Lanes below their limit stay where they are.
            let above = square.clone() - limits;
            product.multiply(direction, image);
            let mut work = zero.clone();
            for s in 0..m {
                work = work.plus_product(&direction[s], &image[s]);
            }
            // A lane that is done may divide zero by zero. The choice passes over the NaN.
            let step = above.choose(&(square.clone() / &work), &zero);
            let mut next = zero.clone();
            for s in 0..m {
                constants[s] = constants[s].clone().plus_product(&step, &direction[s]);
                rest[s] = rest[s].clone().minus_product(&step, &image[s]);
                let rest = rest[s].clone() * &free[s];
                next = next.plus_product(&rest, &rest);
            }
            let share = above.choose(&(next.clone() / &square), &zero);
            for s in 0..m {
                direction[s] = (rest[s].clone() * &free[s]).plus_product(&share, &direction[s]);
            }
            square = next;
        }
        false
    }
}
