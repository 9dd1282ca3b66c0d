//! Points at exactly the same coordinates as one point.

use std::collections::HashMap;

#[derive(Default)]
pub(super) struct Coincident {
    pub points: Vec<[f64; 3]>,
    known: HashMap<[u64; 3], usize>,
}

impl Coincident {
    /// The index of the point at these coordinates, which is added if there is none.
    pub fn index(&mut self, point: [f64; 3]) -> usize {
        // −0 and 0 are the same coordinate.
        let point = point.map(|x| x + 0.0);
        *self.known.entry(point.map(f64::to_bits)).or_insert_with(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }
}
