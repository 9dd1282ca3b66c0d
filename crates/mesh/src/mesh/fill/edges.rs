//! The edges of triangles, and how often each is passed.

/// That a triangle has an edge.
#[derive(Clone, Copy)]
pub(super) struct Pass {
    /// The ends, the lower first.
    pub edge: [usize; 2],
    pub triangle: u32,
    /// Whether the triangle passes the edge from its lower to its higher end.
    pub is_up: bool,
}

/// The passes of all edges, those of one edge after each other; edges ascend.
pub(super) fn passes(triangles: &[[usize; 3]]) -> Vec<Pass> {
    let mut passes: Vec<Pass> = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            passes.push(Pass { edge: [a.min(b), a.max(b)], triangle: triangle as u32, is_up: a < b });
        }
    }
    // The key has no equal ones but for triangles that pass an edge twice: the order is the same in each run.
    passes.sort_unstable_by_key(|pass| (pass.edge, pass.triangle));
    passes
}

/// The passes of each edge.
pub(super) fn by_edge(passes: &[Pass]) -> impl Iterator<Item = &[Pass]> {
    passes.chunk_by(|a, b| a.edge == b.edge)
}

/// How often an edge is passed from its lower to its higher end, and back.
pub(super) fn counts(of_edge: &[Pass]) -> [usize; 2] {
    let up = of_edge.iter().filter(|pass| pass.is_up).count();
    [up, of_edge.len() - up]
}

/// The edges that have one triangle alone.
pub(super) fn open(triangles: &[[usize; 3]]) -> Vec<[usize; 2]> {
    by_edge(&passes(triangles)).filter(|of_edge| of_edge.len() == 1).map(|of_edge| of_edge[0].edge).collect()
}
