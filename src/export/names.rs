//! Points by their names, and without their order.

use springfit_report::report::NetworkRecord;

/// Points in words: by their numbers in the mesh file, or by their places in the network, which count from 0.
pub(super) fn named(network: &NetworkRecord, points: &[usize]) -> String {
    let many = if points.len() == 1 { "" } else { "s" };
    let (word, numbers): (_, Vec<u64>) = match &network.nodes {
        Some(nodes) => ("node", points.iter().filter_map(|&p| nodes.get(p)).copied().collect()),
        None => ("point", points.iter().map(|&p| p as u64).collect()),
    };
    let numbers: Vec<String> = numbers.iter().map(u64::to_string).collect();
    format!("{word}{many} {}", numbers.join(" "))
}

/// Two points, ascending.
pub(super) fn ordered(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// Points, ascending.
pub(super) fn sorted(points: &[usize]) -> Vec<usize> {
    let mut points = points.to_vec();
    points.sort_unstable();
    points
}
