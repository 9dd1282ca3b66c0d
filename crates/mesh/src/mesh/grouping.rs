//! Cells grouped by a key, in the order in which each key first occurs.

use std::collections::HashMap;
use std::hash::Hash;

/// The connectivity of the cells of each key.
pub(super) struct Gather<K> {
    lists: Vec<(K, Vec<usize>)>,
    places: HashMap<K, usize>,
    /// The list used last: neighbours in a file usually have the same key.
    last: usize,
}

impl<K: Clone + Eq + Hash> Gather<K> {
    pub fn new() -> Self {
        Gather { lists: Vec::new(), places: HashMap::new(), last: 0 }
    }

    /// The connectivity of the cells with `key`, to which nodes can be appended.
    pub fn list(&mut self, key: &K) -> &mut Vec<usize> {
        if self.lists.get(self.last).is_none_or(|(last, _)| last != key) {
            self.last = self.places.get(key).copied().unwrap_or(self.lists.len());
            if self.last == self.lists.len() {
                self.places.insert(key.clone(), self.last);
                self.lists.push((key.clone(), Vec::new()));
            }
        }
        &mut self.lists[self.last].1
    }

    /// Appends a whole list, without a copy if it is the first of its key.
    pub fn append(&mut self, key: &K, mut nodes: Vec<usize>) {
        let list = self.list(key);
        if list.is_empty() {
            *list = nodes;
        } else {
            list.append(&mut nodes);
        }
    }

    /// The keys that have cells, with their connectivity.
    pub fn into_lists(self) -> impl Iterator<Item = (K, Vec<usize>)> {
        self.lists.into_iter().filter(|(_, nodes)| !nodes.is_empty())
    }
}
