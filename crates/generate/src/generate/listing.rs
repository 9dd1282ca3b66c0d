//! The comments of generated files: what the functions compute, and the springs in their order.

use super::Recipe;
use super::code::Status;
use crate::element::Element;
use crate::fit::published::{Cover, Method, Ratio};
use crate::springs::Springs;

/// The width of a line of comment.
const WIDTH: usize = 100;

/// What is said of springs that rest at the mesh.
const PLAIN: &str = "The energy of a spring is k/2 (c - rest)^2, with c what it measures.";

/// The heading of a file.
pub fn heading(element: &Element, springs: &Springs, recipe: Recipe) -> Vec<String> {
    let (n, d) = (element.nodes(), element.dimension());
    let mut lines = vec![
        format!("{}: {}; objective {}.", element.name, element.title, recipe.title()),
        format!("Written by springfit {}: springfit generate. This file needs no other.", env!("CARGO_PKG_VERSION")),
        String::new(),
        format!("x          positions of the nodes in m, [{n} nodes x {d}], node by node"),
        format!("lambda, mu moduli of sigma = lambda tr(eps) I + 2 mu eps in Pa; {}", moduli_unit(d)),
        format!(
            "constants  spring constants, [{}]: k in N/m; of a spring on {} in J per square of it",
            springs.len(),
            content(d)
        ),
        "rests      rest measures, in the same order: lengths in m, contents in m, m2 or m3".into(),
        String::new(),
    ];
    lines.extend(match recipe {
        Recipe::Exact(_) => vec![
            "The energy of a spring between nodes is k/2 |x_j - x_i|^2: its rest length is zero.".into(),
            format!("That of a spring on {} is k/2 (c - rest)^2, with c = w |J| at its quadrature point", content(d)),
            "(group points) or the sum over all points (group content). At rest the energy is not zero:".into(),
            "differences of energies have a meaning.".into(),
        ],
        Recipe::Published(method) => published(method, element),
        Recipe::Frobenius(_) => vec![PLAIN.to_string()],
    });
    lines.push("Constants may be negative.".into());
    lines.push(String::new());
    lines.push("status     0, or".into());
    lines.extend(Status::ALL.iter().map(|(status, what)| format!("  {} {what}", status.code())));
    lines.push("           Then nothing is written to the results.".into());
    lines.push(String::new());
    lines.push("The springs in their order, by group, as the nodes that they join:".into());
    lines.extend(groups(springs));
    lines
}

/// What is said of a published formula: its paper, and what it assumes.
fn published(method: Method, element: &Element) -> Vec<String> {
    let mut lines = wrapped(method.reference());
    if let Ok(Cover { poisson, shape, .. }) = method.cover(element) {
        match poisson {
            Ratio::Any => {}
            Ratio::Only(ratio) => {
                lines.push(format!("It is made for a Poisson's ratio of {ratio:.4}{}.", of_plane(element)))
            }
            Ratio::AtLeast(least) => {
                lines.push(format!("It requires a Poisson's ratio of at least {least:.4}{}.", of_plane(element)))
            }
        }
        if let Some(shape) = shape {
            lines.push(format!("It is made for cells of this shape: {}.", shape.name()));
        }
    }
    lines.push(PLAIN.into());
    lines
}

fn of_plane(element: &Element) -> &'static str {
    if element.dimension() == 2 { " of the plane, lambda/(lambda + 2 mu)" } else { "" }
}

/// A text on lines of the width of a page.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is a line");
        if line.is_empty() {
            *line = word.to_string();
        } else if line.chars().count() + word.chars().count() < WIDTH {
            *line = format!("{line} {word}");
        } else {
            lines.push(word.to_string());
        }
    }
    lines
}

fn content(dimension: usize) -> &'static str {
    ["lengths", "areas", "volumes"][dimension - 1]
}

fn moduli_unit(dimension: usize) -> &'static str {
    match dimension {
        1 => "of a rod times its cross-section, lambda + 2 mu = E A, in N",
        2 => "those of the plane, times the thickness, in N/m",
        _ => "those of a solid",
    }
}

/// One paragraph for each group.
fn groups(springs: &Springs) -> Vec<String> {
    let every = nodes_of(springs);
    let mut lines = Vec::new();
    let mut first = 0;
    while first < every.len() {
        let group = every[first].0;
        let last = (first..every.len()).find(|&s| every[s].0 != group).unwrap_or(every.len());
        let mut line = if last - first == 1 {
            format!("  {first} {group}:")
        } else {
            format!("  {first} to {} {group}:", last - 1)
        };
        for (_, nodes) in &every[first..last] {
            let word = nodes.iter().map(usize::to_string).collect::<Vec<_>>().join("-");
            if word.is_empty() {
                line += if last - first == 1 { " the cell" } else { " the quadrature points" };
                break;
            }
            if line.len() + word.len() >= WIDTH {
                lines.push(std::mem::replace(&mut line, "     ".into()));
            }
            line = format!("{line} {word}");
        }
        lines.push(line);
        first = last;
    }
    lines
}

/// What is said of the function of the moduli.
pub fn moduli(what: &str) -> Vec<String> {
    vec![format!("lambda and mu from Young's modulus (Pa) and Poisson's ratio: {what}.")]
}

/// What is said of the function of the constants.
pub fn constants() -> Vec<String> {
    vec!["The constants and rest measures of the springs of the cell whose nodes are at rest at x.".into()]
}

/// What is said of the function of the energy.
pub fn energy() -> Vec<String> {
    vec!["The energy of the network of the cell in J, with its nodes at x.".into()]
}

/// What is said of the function of the forces.
pub fn forces() -> Vec<String> {
    vec!["The forces of the network of the cell on its nodes at x in N, [nodes x dimension].".into()]
}

/// What is said of the function of a branch at rest.
pub fn branch() -> Vec<String> {
    vec![
        "A branch whose stress relaxes with one time tau: springs between the same nodes, with the shear modulus mu".into(),
        "of the branch. The network beside it has what is left of mu. For steps of the length h, with e = exp(-h/tau),".into(),
        "mean is (1 - e) tau/h. This writes the sizes of the quadrature points and the constants of the shape at rest x.".into(),
    ]
}

/// What is said of the function of a step of a branch.
pub fn relax() -> Vec<String> {
    vec![
        "A step of the branch that ends with the nodes at x: its forces on them in N, and its constants for the next"
            .into(),
        "step, which relax towards those of the present shape. left is e, and taken is mean (1 - e).".into(),
    ]
}

/// The nodes of every spring with the name of its group; none for a spring on the whole cell.
fn nodes_of(springs: &Springs) -> Vec<(&str, Vec<usize>)> {
    let pairs = springs.pairs().iter().map(|pair| pair.to_vec());
    let functions = springs.functions().iter().map(|f| f.nodes.clone());
    let nodes = pairs.chain(functions).chain(std::iter::repeat(Vec::new()));
    springs.groups().iter().map(|&group| springs.names()[group].as_str()).zip(nodes).collect()
}
