//! Numbers next to each other in an array that are computed together, for kinds of numbers of which one register holds several.
//!
//! Theory: page *Precision* of the book.

/// Numbers of the kind `T` that are computed together. Each of them is what the operations of a single number make it, to the last bit.
pub trait Group<T>: Copy {
    /// How many numbers there are.
    const COUNT: usize;

    /// One number in all places.
    fn filled(self, number: &T) -> Self;

    /// These numbers, at most [`COUNT`](Group::COUNT), in the first places; the others stay.
    fn load(self, from: &[T]) -> Self;

    /// Puts a number into one place.
    fn set(&mut self, i: usize, number: &T);

    /// The number in one place.
    fn get(&self, i: usize) -> T;

    /// `self + a b`.
    fn plus_product(self, a: Self, b: Self) -> Self;

    /// `self − a b`.
    fn minus_product(self, a: Self, b: Self) -> Self;
}

/// A computation with groups of numbers of the kind `T`.
pub trait GroupWork<T> {
    /// What the computation returns.
    type Output;

    /// Runs the computation; `zero` is a group of zeros.
    fn run<G: Group<T>>(self, zero: G) -> Self::Output;
}
