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
}
