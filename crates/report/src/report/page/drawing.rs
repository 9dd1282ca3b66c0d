//! Which points and springs of a body are drawn.

use super::array::{Floats, Places};
use super::record::SpringMeshRecord;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::report::outline::cell_edges;

/// Springs of a network that a browser turns without delay.
pub const MOST_SPRINGS: usize = 100_000;
/// Springs of all networks, and their displacements under all loads, as numbers: they fill about 60 MB of a page.
const MOST_NUMBERS: usize = 12_000_000;
/// Triangles of a surface. A browser draws all of them anew at each turn.
const MOST_TRIANGLES: usize = 300_000;
/// Points of a body whose points are all kept. Each has a displacement for each load and network; of more, those that are drawn are enough.
const FEW_POINTS: usize = 50_000;

/// The part of a body that is drawn.
pub struct Drawing<'a> {
    mesh: &'a Mesh,
    /// Points of the mesh in the order in which they are drawn.
    points: Vec<usize>,
    /// The place of each point of the mesh among those; `u32::MAX` of others.
    places: Vec<u32>,
    /// `[triangles]`, points of the mesh.
    pub triangles: Vec<[usize; 3]>,
    /// `[edges]`, points of the mesh.
    pub edges: Vec<[usize; 2]>,
    /// For each network, its springs on lengths.
    pub springs: Vec<Vec<usize>>,
    /// What is not drawn, one sentence each.
    pub left_out: Vec<String>,
}

impl<'a> Drawing<'a> {
    /// Chooses what is drawn of networks on a mesh under this number of loads.
    pub fn of(mesh: &'a Mesh, networks: &[(&str, &Network)], loads: usize) -> Drawing<'a> {
        let mut left_out = Vec::new();
        let mut triangles = mesh.surface_triangles();
        let mut edges = cell_edges(mesh);
        if triangles.len() > MOST_TRIANGLES {
            left_out.push(format!("The surface has {} triangles and is not drawn.", triangles.len()));
            triangles.clear();
        }
        let on_surface = surface(mesh, &edges);
        if edges.len() > MOST_SPRINGS {
            let all = edges.len();
            edges = spread(edges, MOST_SPRINGS);
            left_out.push(format!("Drawn are {} of {all} edges of cells.", edges.len()));
        }
        // A spring has its ends, its place and two numbers, and two points with their displacements.
        let each = 4 + 6 * (loads + 1);
        let most = (MOST_NUMBERS / (each * networks.len().max(1))).clamp(100, MOST_SPRINGS);
        let springs: Vec<Vec<usize>> =
            networks.iter().map(|(_, network)| drawn(mesh, network, &on_surface, most)).collect();
        for ((name, network), springs) in networks.iter().zip(&springs) {
            let all = between_nodes(mesh, network).count();
            let levers = network.lengths.len() - all;
            if levers > 0 {
                left_out.push(format!("{name}: {levers} springs hold directors and are not drawn."));
            }
            if springs.len() < all {
                left_out
                    .push(format!("{name}: drawn are {} of {all} springs, those on the surface first.", springs.len()));
            }
        }
        for (name, network) in networks.iter().filter(|(_, network)| !network.others.is_empty()) {
            left_out
                .push(format!("{name}: {} springs do not join two points and are not drawn.", network.others.len()));
        }
        let mut is_drawn = vec![mesh.point_count() <= FEW_POINTS; mesh.node_count()];
        // Directors say how a sheet is inclined, and are no part of its shape.
        is_drawn.resize(mesh.point_count(), false);
        triangles.iter().flatten().chain(edges.iter().flatten()).for_each(|&p| is_drawn[p] = true);
        for ((_, network), springs) in networks.iter().zip(&springs) {
            springs.iter().flat_map(|&s| network.lengths[s].points).for_each(|p| is_drawn[p] = true);
        }
        let points: Vec<usize> = (0..mesh.point_count()).filter(|&p| is_drawn[p]).collect();
        let mut places = vec![u32::MAX; mesh.point_count()];
        points.iter().enumerate().for_each(|(place, &p)| places[p] = place as u32);
        Drawing { mesh, points, places, triangles, edges, springs, left_out }
    }

    /// The numbers of the points that are drawn.
    pub fn numbers(&self) -> Places {
        self.points.iter().map(|&p| usize::try_from(self.mesh.point_number(p)).unwrap_or(usize::MAX)).collect()
    }

    /// The points that are drawn.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// Vectors of the points that are drawn, in space.
    pub fn vectors(&self, values: &[f64]) -> Floats {
        let d = self.mesh.dimension;
        let component = |p: usize, k: usize| if k < d { values[p * d + k] } else { 0.0 };
        self.points.iter().flat_map(|&p| [0, 1, 2].map(|k| component(p, k))).collect()
    }

    /// Points of the mesh as places.
    pub fn places(&self, points: impl Iterator<Item = usize>) -> Places {
        Places(points.map(|p| self.places[p]).collect())
    }

    /// The springs of a network that are drawn.
    pub fn spring_mesh(&self, network: &Network, springs: &[usize]) -> SpringMeshRecord {
        SpringMeshRecord {
            ends: self.places(springs.iter().flat_map(|&s| network.lengths[s].points)),
            numbers: springs.iter().copied().collect(),
        }
    }
}

/// Whether each point is on the surface.
fn surface(mesh: &Mesh, edges: &[[usize; 2]]) -> Vec<bool> {
    let mut on = vec![false; mesh.point_count()];
    edges.iter().flatten().for_each(|&p| on[p] = true);
    on
}

/// The springs of a network on lengths that join nodes of the mesh, and not directors, which are after them.
fn between_nodes<'a>(mesh: &Mesh, network: &'a Network) -> impl Iterator<Item = usize> + 'a {
    let nodes = mesh.node_count();
    (0..network.lengths.len()).filter(move |&s| network.lengths[s].points[1] < nodes)
}

/// Chooses the springs that are drawn: of more springs than `most`, those on the surface, and of those some in even steps.
fn drawn(mesh: &Mesh, network: &Network, on_surface: &[bool], most: usize) -> Vec<usize> {
    let all = || between_nodes(mesh, network);
    if all().count() <= most {
        return all().collect();
    }
    // Springs are counted first: a list of those of the surface would be as long as the network.
    let is_seen = |s: &usize| network.lengths[*s].points.iter().all(|&p| on_surface[p]);
    let some = |springs: &mut dyn Iterator<Item = usize>, count: usize| {
        let mut kept = steps(count, most).peekable();
        springs.enumerate().filter(|(place, _)| kept.next_if_eq(place).is_some()).map(|(_, s)| s).collect()
    };
    match all().filter(is_seen).count() {
        0 => some(&mut all(), all().count()),
        count => some(&mut all().filter(is_seen), count),
    }
}

/// At most so many of the places 0 to `count`, in even steps.
fn steps(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let kept = count.min(most);
    (0..kept).map(move |i| i * count / kept)
}

/// At most so many of the entries, in even steps.
pub fn spread<T: Copy>(entries: Vec<T>, most: usize) -> Vec<T> {
    steps(entries.len(), most).map(|place| entries[place]).collect()
}
