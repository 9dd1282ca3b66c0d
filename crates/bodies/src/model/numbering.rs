//! An order of points in which neighbours are near each other.

/// The row of each point that `is_row`; other points get rows far beyond. The order is that of Cuthill and McKee
/// (1969), reversed: incomplete factors are more accurate in it than in an order of little fill, and neighbours share
/// cache lines.
pub(crate) fn places(pairs: &[(usize, usize)], is_row: &[bool]) -> Vec<usize> {
    let n = is_row.len();
    let mut beside = vec![Vec::new(); n];
    for &(i, j) in pairs.iter().filter(|(i, j)| i != j && is_row[*i] && is_row[*j]) {
        beside[i].push(j);
        beside[j].push(i);
    }
    for beside in &mut beside {
        // Several entries name the same two points, and their order must not change the numbering.
        beside.sort_unstable();
        beside.dedup();
    }
    let mut is_met = vec![false; n];
    // From one point to all points of its connected part.
    let visit = |first: usize, is_met: &mut [bool]| {
        let mut order = vec![first];
        is_met[first] = true;
        let mut next = 0;
        while next < order.len() {
            let from = order.len();
            order.extend(beside[order[next]].iter().filter(|j| !std::mem::replace(&mut is_met[**j], true)));
            // Points with few neighbours first, as Cuthill and McKee have it; the sort keeps equal ones in the order of
            // their numbers.
            order[from..].sort_by_key(|j| beside[*j].len());
            next += 1;
        }
        order
    };
    let mut order = Vec::new();
    for point in 0..n {
        if is_row[point] && !is_met[point] {
            let all = visit(point, &mut is_met);
            // The point that is reached last is at an end of the part.
            all.iter().for_each(|i| is_met[*i] = false);
            order.extend(visit(all[all.len() - 1], &mut is_met));
        }
    }
    let mut place = vec![usize::MAX; n];
    order.iter().rev().enumerate().for_each(|(row, &point)| place[point] = row);
    place
}

/// The degrees of freedom of `nodes`, in order.
pub fn dofs(nodes: &[usize], dimension: usize) -> impl Iterator<Item = usize> + Clone {
    nodes.iter().flat_map(move |n| (0..dimension).map(move |k| n * dimension + k))
}
