//! Finds cells and sides that have the same points.

/// Groups items by the set of their points; the items of a set keep their order.
///
/// `points(item)` writes the points of an item in any order.
pub(super) struct Alike<T> {
    /// A hash of the set, which does not depend on the order of its points, with the item.
    items: Vec<(u64, T)>,
}

impl<T: Copy> Alike<T> {
    pub fn of(items: impl Iterator<Item = T>, points: impl Fn(T, &mut Vec<usize>)) -> Alike<T> {
        let mut set = Vec::new();
        let mark = |item: T| {
            set.clear();
            points(item, &mut set);
            (set.iter().fold(0u64, |sum, &p| sum.wrapping_add(scattered(p as u64))), item)
        };
        let mut items: Vec<(u64, T)> = items.map(mark).collect();
        // A stable sort keeps the order of items with the same hash.
        items.sort_by_key(|(mark, _)| *mark);
        Alike { items }
    }

    /// Calls `visit` for each set with its items.
    pub fn each(&self, points: impl Fn(T, &mut Vec<usize>), mut visit: impl FnMut(&[T])) {
        let mut sets: Vec<(Vec<usize>, Vec<T>)> = Vec::new();
        for run in self.items.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, item)] = run {
                visit(&[*item]);
                continue;
            }
            // Different sets may have the same hash.
            sets.clear();
            for (_, item) in run {
                let mut own = Vec::new();
                points(*item, &mut own);
                own.sort_unstable();
                match sets.iter_mut().find(|(set, _)| *set == own) {
                    Some((_, items)) => items.push(*item),
                    None => sets.push((own, vec![*item])),
                }
            }
            sets.iter().for_each(|(_, items)| visit(items));
        }
    }
}

/// A hash without patterns among neighbouring numbers (the finalizer of SplitMix64; Steele, Lea and Flood 2014).
fn scattered(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
