//! Weighted sums of what a spring measures at some of its points.

use smallvec::SmallVec;

/// Terms of a sum, each of a weight and of N places in the points of the spring.
#[derive(Debug, Clone, PartialEq)]
pub struct Weighted<const N: usize>(SmallVec<[Term<N>; 5]>);

#[derive(Debug, Clone, Copy, PartialEq)]
struct Term<const N: usize> {
    /// A place is stored in a byte.
    places: [u8; N],
    weight: f64,
}

impl<const N: usize> Weighted<N> {
    /// Terms of these places and weights on `points` points; none if a place is not below their number, two places of a term are equal, a weight is no number, or
    /// there are no terms.
    pub fn new<'a>(terms: impl IntoIterator<Item = (&'a [usize], f64)>, points: usize) -> Option<Weighted<N>> {
        let term = |(places, weight): (&[usize], f64)| {
            let places = <[usize; N]>::try_from(places).ok()?;
            // Two equal points leave a distance, an edge or a height of length zero, by which a gradient may divide.
            let is_apart = (0..N).all(|i| !places[..i].contains(&places[i]));
            let is_in = places.iter().all(|&place| place < points.min(256));
            (is_in && is_apart && weight.is_finite()).then(|| Term { places: places.map(|place| place as u8), weight })
        };
        let terms: Option<SmallVec<[Term<N>; 5]>> = terms.into_iter().map(term).collect();
        terms.filter(|terms| !terms.is_empty()).map(Weighted)
    }

    /// Terms of places that differ and are below 256.
    pub(super) fn of(terms: impl IntoIterator<Item = ([usize; N], f64)>) -> Weighted<N> {
        let term = |(places, weight): ([usize; N], f64)| Term { places: places.map(|place| place as u8), weight };
        Weighted(terms.into_iter().map(term).collect())
    }

    /// The places and the weight of each term.
    pub fn iter(&self) -> impl Iterator<Item = ([usize; N], f64)> + '_ {
        self.0.iter().map(|term| (term.places.map(usize::from), term.weight))
    }
}
