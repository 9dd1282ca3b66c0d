//! Disjoint sets that are joined one pair at a time.

/// The sets of `0..n`, each represented by one member.
pub(super) struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    /// `count` sets of one member each.
    pub fn new(count: usize) -> Self {
        DisjointSets { parent: (0..count).collect() }
    }

    /// The member that represents the set of `member`. Paths to it are halved on the way.
    pub fn root(&mut self, mut member: usize) -> usize {
        while self.parent[member] != member {
            // Without it chains would grow with the number of joins, and a search with them.
            self.parent[member] = self.parent[self.parent[member]];
            member = self.parent[member];
        }
        member
    }

    /// Joins the sets of two members.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a] = b;
    }

    /// The members of each set, ascending; the sets are in the order of their first members.
    pub fn sets(mut self) -> Vec<Vec<usize>> {
        let mut set_of_root = vec![usize::MAX; self.parent.len()];
        let mut sets: Vec<Vec<usize>> = Vec::new();
        for member in 0..self.parent.len() {
            let set = &mut set_of_root[self.root(member)];
            if *set == usize::MAX {
                *set = sets.len();
                sets.push(Vec::new());
            }
            sets[*set].push(member);
        }
        sets
    }
}
