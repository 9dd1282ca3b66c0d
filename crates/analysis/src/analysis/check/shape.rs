//! The element at distorted shapes with straight edges: stiffness, patch test, moduli, and its form in mesh files.

use super::property::Property;
use crate::analysis::moduli::Lattice;
use crate::analysis::shapes::straight_shapes;
use crate::element::{Element, FormatEntry, permutations};
use crate::fit::{Fit, Objective, Weight};
use crate::material::{Material, Moduli};
use crate::mesh::{Mesh, MeshSource, gmsh, vtk};
use crate::springs::Springs;
use crate::stiffness::Geometry;
use nalgebra::DMatrix;
use std::fmt::Write;
use std::sync::Arc;

/// The number of shapes that are tested.
// A property that fails at all fails at almost every shape: the defect is an analytic function of the positions. More than one
// shape is for defects that are near rounding at one of them.
const SHAPES: usize = 5;
/// The seed of the shapes, so that every run tests the same ones.
const SEED: u64 = 7;
/// Young's modulus, Pa, and Poisson's ratio of the material that is tested.
// Relative defects do not depend on the modulus. No fault can hide at this ratio: λ is not zero, and networks of equal springs have the
// ratios 1/4 and 1/3.
pub const ASKED: (f64, f64) = (1.0, 0.3);

pub fn properties(element: &Arc<Element>) -> Vec<Property> {
    let mut properties = vec![stiffness(element), patch(element)];
    properties.extend(modes(element));
    properties.push(moduli(element));
    let formats = &element.formats;
    properties.extend(formats.gmsh.as_ref().map(|entry| round_trip(element, entry, true)));
    properties.extend(formats.vtk.as_ref().map(|entry| round_trip(element, entry, false)));
    properties
}

/// The shapes at which properties are tested.
pub fn shapes(element: &Element) -> Vec<Vec<f64>> {
    straight_shapes(element, SHAPES, SEED)
}

pub fn geometry(element: &Element, x: &[f64]) -> Geometry {
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, x).expect("the shapes were chosen so");
    geometry
}

/// The number of motions of the nodes that are not rigid.
pub fn deformations(element: &Element) -> usize {
    let (n, d) = (element.nodes(), element.dimension());
    n * d - d * (d + 1) / 2
}

/// The number of eigenvalues of R that are no rounding.
pub fn rank(r: &DMatrix<f64>) -> usize {
    let eigenvalues = r.symmetric_eigenvalues();
    // Rigid motions leave some 1e-15 of the largest.
    let floor = 1e-10 * eigenvalues.amax();
    eigenvalues.iter().filter(|e| **e > floor).count()
}

/// The number of motions of the nodes that deform a cell of this element and have no stiffness at the points of its rule, of the reference
/// shape; `None` if that is tangled.
pub fn spurious_modes(element: &Element) -> Option<usize> {
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, &element.positions).ok()?;
    Some(deformations(element).saturating_sub(rank_of(&geometry)))
}

/// The rank of R of a cell.
fn rank_of(geometry: &Geometry) -> usize {
    rank(&geometry.stiffness(Moduli { lambda: 1.0, mu: 1.0 }))
}

fn stiffness(element: &Element) -> Property {
    let expected = deformations(element);
    let mut least = expected;
    let shapes = shapes(element);
    if shapes.is_empty() {
        return Property::new(
            "rank of R",
            false,
            "no shape with a positive Jacobian was found near the reference cell",
        );
    }
    for x in shapes {
        least = least.min(rank_of(&geometry(element, &x)));
    }
    let spurious = expected - least;
    let finding = format!("{least} of {expected}, {spurious} spurious modes");
    Property::new("rank of R", spurious == 0, finding).with(spurious as f64)
}

/// A uniform stress must be carried by tractions on the sides alone: `∫ ∇N_a dV = ∮ N_a n dA` for every node.
fn patch(element: &Element) -> Property {
    let worst = shapes(element).iter().map(|x| patch_defect(element, x)).fold(0.0, f64::max);
    // A product of rational functions has no exact rule.
    let allowed = if element.is_polynomial() { 1e-11 } else { 1e-6 };
    let finding = format!("uniform stress against tractions of sides, defect {worst:.1e}");
    Property::new("patch test", worst < allowed, finding).with(worst)
}

fn patch_defect(element: &Element, x: &[f64]) -> f64 {
    let d = element.dimension();
    // By the divergence theorem the gradient of the content in a node is `∫ N_a n dA` over the boundary: a uniform
    // stress needs no other forces.
    let volume = geometry(element, x).content_gradient();
    let mut boundary = vec![0.0; x.len()];
    if d == 1 {
        for (a, at) in element.positions.iter().enumerate() {
            // The ends of the reference line are at −1 and 1, and files give them with ten digits or more.
            boundary[a] = if at.abs() > 1.0 - 1e-9 { at.signum() } else { 0.0 };
        }
    }
    for side in element.sides() {
        let table = &side.tabulation;
        let count = side.nodes.len();
        let points = table.values.chunks_exact(count).zip(table.gradients.chunks_exact(count * (d - 1)));
        for ((values, gradients), w) in points.zip(&table.weights) {
            let tangent = |l: usize, k: usize| -> f64 {
                side.nodes.iter().enumerate().map(|(i, a)| x[a * d + k] * gradients[i * (d - 1) + l]).sum()
            };
            let normal = if d == 2 {
                // Sides run counterclockwise, so that their tangent turned clockwise is outwards.
                vec![tangent(0, 1), -tangent(0, 0)]
            } else {
                let cross = |k: usize, l: usize| tangent(0, k) * tangent(1, l) - tangent(0, l) * tangent(1, k);
                vec![cross(1, 2), cross(2, 0), cross(0, 1)]
            };
            for (value, a) in values.iter().zip(&side.nodes) {
                (0..d).for_each(|k| boundary[a * d + k] += w * value * normal[k]);
            }
        }
    }
    let size = volume.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    volume.iter().zip(&boundary).map(|(v, b)| (v - b).abs()).fold(0.0, f64::max) / size
}

/// A uniform stress must not move the functions that are condensed, on any shape: `∫ ∂M_j/∂x dV = 0`, relative to `∫ |∂M_j/∂x| dV`. Then
/// the patch test that nodes pass is passed with them.
fn modes(element: &Element) -> Option<Property> {
    let (count, d) = (element.modes(), element.dimension());
    let bubbles = element.tabulation.modes.as_ref()?.bubbles.iter().filter(|is_bubble| **is_bubble).count();
    let defect = |x: &Vec<f64>| {
        let geometry = geometry(element, x);
        // Functions whose gradients have the mean zero do no work against a uniform stress: the patch test holds as
        // without them (Taylor, Beresford, Wilson, Int. J. Numer. Methods Eng. 10, 1976).
        let (mut sum, mut size) = (vec![0.0; count * d], 0.0f64);
        for (gradients, volume) in geometry.modes.chunks_exact(count * d).zip(&geometry.volumes) {
            sum.iter_mut().zip(gradients).for_each(|(sum, g)| *sum += volume * g);
            size += volume * gradients.iter().map(|g| g * g).sum::<f64>().sqrt();
        }
        sum.iter().fold(0.0f64, |most, sum| most.max(sum.abs())) / size
    };
    let worst = shapes(element).iter().map(defect).fold(0.0, f64::max);
    let finding = format!("{count} functions, {bubbles} of them bubbles, mean of their gradients {worst:.1e}");
    Some(Property::new("condensed functions", worst < 1e-11, finding).with(worst))
}

/// The moduli of the finite elements on a periodic box.
fn moduli(element: &Arc<Element>) -> Property {
    let name = "moduli of R";
    let (young, poisson) = ASKED;
    let d = element.dimension();
    let asked = Material::for_body(d, young, poisson, None, None).and_then(|material| {
        let none = Springs::select(element, Some(&[]))?;
        let fit = Fit::new(Objective::Frobenius(Weight::None));
        Ok((material, Lattice::fit(element, &none, &vec![1.0; d], material, &fit)?))
    });
    let Ok((material, lattice)) = asked else { return Property::noted(name, "its cells fill no box") };
    let Some(found) = lattice.of_elements(material) else {
        return Property::new(name, false, "some uniform strain meets no resistance");
    };
    let error = (found.young / young - 1.0).abs().max((found.poisson - poisson).abs());
    let finding = format!("E {:.6}, nu {:.6}, asked {young}, {poisson}", found.young, found.poisson);
    // A fault changes the first digits of a modulus. Rounding in the few equations of a box changes none of the six that are printed.
    Property::new(name, error < 1e-8, finding).with(error)
}

/// One cell, written in the order of the format and read again. Both formats require its corners first.
fn round_trip(element: &Arc<Element>, entry: &FormatEntry, in_gmsh: bool) -> Property {
    let name = if in_gmsh { "Gmsh order" } else { "VTK order" };
    let (n, d) = (element.nodes(), element.dimension());
    let mut places: Vec<usize> = (0..n).collect();
    for (a, &place) in entry.order.iter().flatten().enumerate() {
        places[place] = a;
    }
    let corners = element.cell.corners();
    let corner_at = |a: usize| {
        let at = &element.positions[a * d..(a + 1) * d];
        corners.iter().position(|c| c.iter().zip(at).all(|(c, x)| (c - x).abs() < 1e-9))
    };
    let first: Option<Vec<usize>> = places.iter().take(corners.len()).map(|&a| corner_at(a)).collect();
    match first {
        None => {
            let finding = format!("expected the {} corners first, found other nodes among them", corners.len());
            return Property::new(name, false, finding);
        }
        Some(order) if !permutations(element.cell, &corners.concat()).contains(&order) => {
            return Property::new(
                name,
                false,
                format!("corners come as {order:?}, which goes back and forth in the cell"),
            );
        }
        _ => {}
    }
    let Some(x) = shapes(element).into_iter().next() else { return Property::noted(name, "no shape to write") };
    let points: Vec<[f64; 3]> =
        x.chunks_exact(d).map(|x| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0))).collect();
    let source = if in_gmsh {
        gmsh::parse(gmsh_text(&points, entry.cell_type, &places).as_bytes())
    } else {
        vtk::parse_legacy(vtk_text(&points, entry.cell_type, &places).as_bytes())
    };
    let read = source.and_then(|source: MeshSource| Mesh::resolve(&source, std::slice::from_ref(element), 1.0));
    match read {
        Err(error) => Property::new(name, false, format!("type {}: {error}", entry.cell_type)),
        Ok(mesh) => {
            let same = mesh.blocks[0].connectivity.iter().copied().eq(0..n);
            let finding = format!(
                "type {}, one cell written and read: {}",
                entry.cell_type,
                if same { "the same" } else { "another" }
            );
            Property::new(name, same, finding)
        }
    }
}

fn gmsh_text(points: &[[f64; 3]], cell_type: u32, places: &[usize]) -> String {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", points.len());
    for (i, [x, y, z]) in points.iter().enumerate() {
        writeln!(text, "{} {x} {y} {z}", i + 1).expect("a String grows");
    }
    let nodes: Vec<String> = places.iter().map(|a| (a + 1).to_string()).collect();
    text + &format!("$EndNodes\n$Elements\n1\n1 {cell_type} 2 0 1 {}\n$EndElements\n", nodes.join(" "))
}

fn vtk_text(points: &[[f64; 3]], cell_type: u32, places: &[usize]) -> String {
    let mut text =
        format!("# vtk DataFile Version 3.0\ncell\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n", points.len());
    for [x, y, z] in points {
        writeln!(text, "{x} {y} {z}").expect("a String grows");
    }
    let nodes: Vec<String> = places.iter().map(usize::to_string).collect();
    let (n, list) = (places.len(), nodes.join(" "));
    text + &format!("CELLS 1 {}\n{n} {list}\nCELL_TYPES 1\n{cell_type}\n", n + 1)
}
