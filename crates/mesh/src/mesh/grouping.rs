//! Cells grouped by a key, in the order in which each key first occurs.

use std::collections::HashMap;
use std::hash::Hash;

/// Cells of a key that follow each other in their source, without cells of other keys between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// The place of the first node in the connectivity of the key.
    pub start: usize,
    /// The number of runs, of all keys, that come before in the source.
    pub turn: usize,
}

/// The connectivity of the cells of a key.
pub(super) struct Gathered<K> {
    pub key: K,
    pub nodes: Vec<usize>,
    pub runs: Vec<Run>,
}

/// The connectivity of the cells of each key.
pub(super) struct Gather<K> {
    lists: Vec<Gathered<K>>,
    places: HashMap<K, usize>,
    /// The list used last: neighbours in a file usually have the same key.
    last: usize,
    turns: usize,
}

impl<K: Clone + Eq + Hash> Gather<K> {
    pub fn new() -> Self {
        Gather { lists: Vec::new(), places: HashMap::new(), last: 0, turns: 0 }
    }

    /// The connectivity of the cells with `key`, to which nodes can be appended.
    pub fn list(&mut self, key: &K) -> &mut Vec<usize> {
        if self.lists.get(self.last).is_none_or(|last| last.key != *key) {
            self.last = self.places.get(key).copied().unwrap_or(self.lists.len());
            if self.last == self.lists.len() {
                self.places.insert(key.clone(), self.last);
                self.lists.push(Gathered { key: key.clone(), nodes: Vec::new(), runs: Vec::new() });
            }
            let list = &mut self.lists[self.last];
            list.runs.push(Run { start: list.nodes.len(), turn: self.turns });
            self.turns += 1;
        }
        &mut self.lists[self.last].nodes
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
    pub fn into_lists(mut self) -> impl Iterator<Item = Gathered<K>> {
        // A key that was asked for may have got no nodes. Without such runs turns depend on the cells alone.
        for list in &mut self.lists {
            let ends: Vec<usize> = list.runs.iter().skip(1).map(|run| run.start).chain([list.nodes.len()]).collect();
            let mut ends = ends.into_iter();
            list.runs.retain(|run| ends.next() != Some(run.start));
        }
        let mut turns: Vec<&mut Run> = self.lists.iter_mut().flat_map(|list| &mut list.runs).collect();
        turns.sort_unstable_by_key(|run| run.turn);
        turns.into_iter().enumerate().for_each(|(turn, run)| run.turn = turn);
        self.lists.into_iter().filter(|list| !list.nodes.is_empty())
    }
}
