//! The reference cell of an element: its nodes with their numbers, and the springs of each group.

use super::camera::{Camera, Seen, turning};
use super::palette::{COLORS, faded};
use super::sheet::{Columns, LETTERS, cut, outline, sheet};
use crate::element::{Element, SpringGroup, SpringKind};
use crate::text::printable;
use plotters::style::RGBColor;
use svg::node::element::{Definitions, Group, Path, Text, Use};

/// Panels beside each other. That of the nodes is two wide and two high.
const ACROSS: usize = 5;
/// Pixels: around a cell, around the one with numbers, and of the name of a panel.
const MARGIN: f64 = 12.0;
const WIDE: f64 = 26.0;
const CAPTION: f64 = 18.0;
/// Pixels from a node to the middle of its number, which is tried in so many directions.
// A number of two digits is 11 wide, and a dot 4: so far away they do not touch in any direction.
const AWAY: f64 = 10.0;
const DIRECTIONS: usize = 24;
/// Pixels from the middle of a number within which nothing else should be, and down to its foot.
// Half of a number is 6 wide and 4 high; the rest is the air that keeps it apart from an edge.
const CLEAR: f64 = 9.0;
const FOOT: f64 = 3.5;
/// The part of an edge that the arms of an angle take.
const ARM: f64 = 0.3;
const EDGES: RGBColor = RGBColor(150, 150, 150);
/// Degrees around the vertical and above the horizon that are tried.
const TURNS: [f64; 12] = [-40.0, -36.0, -32.0, -28.0, -24.0, -20.0, 20.0, 24.0, 28.0, 32.0, 36.0, 40.0];
const ELEVATIONS: [f64; 6] = [14.0, 18.0, 22.0, 26.0, 30.0, 34.0];

/// The nodes and edges of a cell on a panel.
struct Drawn {
    nodes: Vec<[f64; 2]>,
    seen: Vec<[[f64; 2]; 2]>,
    hidden: Vec<[[f64; 2]; 2]>,
}

/// Draws the nodes of the reference cell, and beside them the springs of each group between nodes, as the text of an SVG file.
pub(in crate::report) fn cell_picture(element: &Element) -> String {
    let width = f64::from(Columns::Two.pixels());
    let panel = width / ACROSS as f64;
    let d = element.dimension();
    let camera = clearest(element);
    let nodes = camera.see(&element.positions, d);
    let corners = camera.see(&element.cell.corners().concat(), d);
    let range = |k: usize| {
        let values = || corners.iter().map(|p| p.at[k]);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        (low, high - low)
    };
    let ((left, wide), (bottom, tall)) = (range(0), range(1));
    let room = panel - 2.0 * MARGIN;
    // A line is seen without a height.
    let size = (room / wide).min(room / tall.max(1e-300));
    let high = CAPTION + 2.0 * MARGIN + size * tall;
    let large = ((2.0 * panel - 2.0 * WIDE) / wide).min((2.0 * high - 2.0 * WIDE) / tall.max(1e-300));
    // A cell in the middle of a room of this width and height, below the caption.
    let place = |size: f64, room: [f64; 2]| {
        let corner = [(room[0] - size * wide) / 2.0, (room[1] - size * tall) / 2.0];
        let to = |p: &Seen| [corner[0] + size * (p.at[0] - left), corner[1] + size * (bottom + tall - p.at[1])];
        drawn(element, &nodes.iter().map(to).collect::<Vec<_>>(), &corners.iter().map(to).collect::<Vec<_>>(), &corners)
    };
    let groups: Vec<&SpringGroup> = element.springs.iter().filter(|group| !group.is_content()).collect();
    // The panel of the nodes takes the first two places of two rows.
    let beside = 2 * (ACROSS - 2);
    let below = groups.len().saturating_sub(beside).div_ceil(ACROSS);
    let title = format!("{}: nodes, and springs of each group", element.name);
    let small = place(size, [panel, high - CAPTION]);
    let definitions = Definitions::new().add(cell(&small, 2.8).set("id", "c"));
    let mut cells = Group::new().add(cell(&place(large, [2.0 * panel, 2.0 * high]), 4.4));
    let mut springs = Group::new().set("fill", "none").set("stroke", faded(COLORS[0], 0.0)).set("stroke-width", 1.2);
    let mut texts = numbers(&place(large, [2.0 * panel, 2.0 * high]));
    for (i, group) in groups.into_iter().enumerate() {
        let (row, column) = match i.checked_sub(beside) {
            None => (i / (ACROSS - 2), 2 + i % (ACROSS - 2)),
            Some(i) => (2 + i / ACROSS, i % ACROSS),
        };
        let [x, y] = [column as f64 * panel, row as f64 * high + CAPTION].map(coarse);
        cells = cells.add(Use::new().set("href", "#c").set("x", x).set("y", y));
        let path = Path::new().set("transform", format!("translate({x},{y})")).set("d", data(group, &small.nodes));
        springs = springs.add(match group.kind {
            SpringKind::Length => path,
            _ => path.set("stroke", faded(COLORS[4], 0.0)),
        });
        texts = texts.add(text(&cut(&group.name, panel + MARGIN), [x + panel / 2.0, y]));
    }
    sheet(Columns::Two, (2 + below) as f64 * high, &title)
        .add(definitions)
        .add(cells)
        .add(springs)
        .add(texts)
        .to_string()
}

/// The view of a solid in which its nodes are farthest from each other and from edges; straight at a plane.
fn clearest(element: &Element) -> Camera {
    let (d, cell) = (element.dimension(), element.cell);
    if d < 3 {
        return Camera::straight();
    }
    let clearance = |camera: &Camera| {
        let at = |positions: &[f64]| camera.see(positions, d).iter().map(|p| p.at).collect::<Vec<_>>();
        let (nodes, corners) = (at(&element.positions), at(&cell.corners().concat()));
        let pairs = nodes.iter().enumerate().flat_map(|(i, a)| nodes[..i].iter().map(|b| apart(*a, *b)));
        let edges = cell.edges().into_iter().flat_map(|edge| {
            let (edge, corners) = (edge.map(|corner| corners[corner]), &corners);
            let others = corners.iter().filter(move |at| !edge.contains(at));
            others.map(move |at| from_edge(*at, edge))
        });
        pairs.chain(edges).fold(f64::INFINITY, f64::min)
    };
    let views = TURNS.iter().flat_map(|turn| ELEVATIONS.iter().map(|elevation| Camera::turned(*turn, *elevation)));
    views.max_by(|a, b| clearance(a).total_cmp(&clearance(b))).unwrap_or_else(Camera::straight)
}

/// Edges of the cell that no side turned to the viewer has are hidden. `corners` are those of the cell on the panel, `seen` as they are seen.
fn drawn(element: &Element, nodes: &[[f64; 2]], corners: &[[f64; 2]], seen: &[Seen]) -> Drawn {
    let cell = element.cell;
    let fronts: Vec<&[usize]> =
        cell.sides().iter().map(|side| side.corners).filter(|side| turning(side, seen) > 0.0).collect();
    let is_seen =
        |[a, b]: &[usize; 2]| cell.dimension() < 3 || fronts.iter().any(|side| side.contains(a) && side.contains(b));
    let (front, back): (Vec<_>, Vec<_>) = cell.edges().into_iter().partition(is_seen);
    let on_panel = |edges: Vec<[usize; 2]>| edges.into_iter().map(|edge| edge.map(|corner| corners[corner])).collect();
    Drawn { nodes: nodes.to_vec(), seen: on_panel(front), hidden: on_panel(back) }
}

/// The edges of the cell, dashed where they are hidden, and its nodes as dots of this width.
fn cell(drawn: &Drawn, dots: f64) -> Group {
    let path = |edges: &[[[f64; 2]; 2]]| {
        let d: String = edges.iter().map(|edge| outline(&edge.map(|at| at.map(coarse)))).collect();
        Path::new().set("d", d).set("stroke", faded(EDGES, 0.0)).set("stroke-width", 0.7)
    };
    let mut group = Group::new().add(path(&drawn.seen));
    if !drawn.hidden.is_empty() {
        group = group.add(path(&drawn.hidden).set("stroke-dasharray", "3 2"));
    }
    // A line without length has a round end on each side.
    let nodes: String = drawn.nodes.iter().map(|at| outline(&[at.map(coarse)]) + "h0").collect();
    let nodes = Path::new().set("d", nodes).set("stroke", "black").set("stroke-width", dots);
    group.add(nodes.set("stroke-linecap", "round"))
}

/// The numbers of the nodes, each where most room is around it.
fn numbers(drawn: &Drawn) -> Group {
    let mut taken = drawn.nodes.clone();
    let mut group = Group::new().set("text-anchor", "middle").set("font-size", LETTERS);
    let middle = [0, 1].map(|k| drawn.nodes.iter().map(|at| at[k]).sum::<f64>() / drawn.nodes.len() as f64);
    for (number, node) in drawn.nodes.iter().enumerate() {
        // How much of what is near is too near.
        let crowded = |at: &[f64; 2]| {
            let near = |distance: f64| (1.0 - distance / CLEAR).max(0.0);
            let points: f64 = taken.iter().filter(|other| *other != node).map(|other| near(apart(*at, *other))).sum();
            let edges: f64 = drawn.seen.iter().chain(&drawn.hidden).map(|edge| near(from_edge(*at, *edge))).sum();
            // Where all is free, away from the middle.
            // A number over another one is worse than one over an edge. The last term is smaller than any of both: it
            // decides among free places alone.
            4.0 * points + edges - 1e-3 * apart(*at, middle) / AWAY
        };
        let tried = (0..DIRECTIONS).map(|i| {
            let turn = std::f64::consts::TAU * i as f64 / DIRECTIONS as f64;
            [node[0] + AWAY * turn.cos(), node[1] + AWAY * turn.sin()]
        });
        let Some(best) = tried.min_by(|a, b| crowded(a).total_cmp(&crowded(b))) else { continue };
        taken.push(best);
        group = group.add(text(&number.to_string(), [best[0], best[1] + FOOT]));
    }
    group
}

/// Words in a group that has their size.
fn text(words: &str, at: [f64; 2]) -> Text {
    let [x, y] = at.map(coarse);
    Text::new(printable(words)).set("x", x).set("y", y)
}

/// The springs of a group as the data of a path: lines between two nodes, arms of angles, or the outline of what several nodes bound.
fn data(group: &SpringGroup, nodes: &[[f64; 2]]) -> String {
    let at = |node: usize| nodes[node].map(coarse);
    let arm = |from: usize, to: usize| [0, 1].map(|k| coarse(nodes[from][k] + ARM * (nodes[to][k] - nodes[from][k])));
    match group.kind {
        SpringKind::Length => {
            let trails = trails(group.nodes.iter().map(|ends| [ends[0], ends[1]]).collect());
            trails.iter().map(|trail| outline(&trail.iter().map(|node| at(*node)).collect::<Vec<_>>())).collect()
        }
        SpringKind::Angle => {
            group.nodes.iter().map(|n| outline(&[arm(n[1], n[0]), at(n[1]), arm(n[1], n[2])])).collect()
        }
        SpringKind::Coupling => {
            group.nodes.iter().flat_map(|n| n.chunks(2).map(|pair| outline(&[at(pair[0]), at(pair[1])]))).collect()
        }
        _ => group.nodes.iter().map(|n| outline(&n.iter().map(|node| at(*node)).collect::<Vec<_>>()) + "z").collect(),
    }
}

/// Lines between two nodes, drawn in few strokes.
fn trails(mut lines: Vec<[usize; 2]>) -> Vec<Vec<usize>> {
    let mut trails: Vec<Vec<usize>> = Vec::new();
    while let Some([first, second]) = lines.pop() {
        let (mut trail, mut end) = (vec![first, second], second);
        while let Some(next) = lines.iter().position(|line| line.contains(&end)) {
            let [a, b] = lines.swap_remove(next);
            end = if a == end { b } else { a };
            trail.push(end);
        }
        trails.push(trail);
    }
    trails
}

/// A tenth of a pixel is not seen.
fn coarse(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// How far a place is from a line between two points.
fn from_edge(at: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    // An edge that is seen from its end has no length on the page, by which nothing may be divided.
    let share = ((at[0] - a[0]) * along[0] + (at[1] - a[1]) * along[1]) / square.max(1e-300);
    let share = share.clamp(0.0, 1.0);
    apart(at, [a[0] + share * along[0], a[1] + share * along[1]])
}
