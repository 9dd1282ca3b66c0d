//! Loads as nodal forces that are consistent with the shape functions; they are the same for both models.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::component::Component;
use super::integration::each_cell_points;
use super::pressed::PressedFaces;
use super::rod_load::RodLoad;
use crate::element::{Integrand, SideTable, Tabulation};
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{Carrier, CellIndex, Mesh, Selection, SideIndex};
use crate::number::first_not_finite;
use crate::range;
use crate::springs::{dot, norm, unit};
use crate::stiffness::gathered;
use std::cell::RefCell;

/// What acts on a selected part of the mesh, with one entry per direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A force per area on sides, Pa.
    Traction(Vec<Component>),
    /// A pressure on sides, or on the cells of a surface in space, against their normals, Pa; see [`PressedFaces`].
    Pressure(Component),
    /// A volume, m³, that the sides enclose, which close a cavity; it has no forces of its own.
    Volume(f64),
    /// A total force, N: shared over the sides or the cells by their shape functions, or over points alone in equal shares; see
    /// [`Selection::carrier`].
    Force(Vec<f64>),
    /// A force per volume on cells, N/m³.
    Body(Vec<Component>),
    /// A total moment, N·m, on the joints of rods in equal shares, or on the edges of a sheet by their lengths; see [`Mesh::couples`].
    Moment(Vec<f64>),
    /// A prescribed displacement of points, m; `None` leaves a direction free.
    Displacement(Vec<Option<Component>>),
}

/// The load integrand of the largest degree of the components.
fn load_of(components: &[Component]) -> Integrand {
    Integrand::Load(degree_of(components))
}

fn degree_of(components: &[Component]) -> usize {
    components.iter().map(Component::degree).max().unwrap_or(0)
}

/// The components of a load, and the values that they had.
struct Values<'a> {
    components: &'a [Component],
    met: RefCell<Vec<f64>>,
}

impl Values<'_> {
    fn of(components: &[Component]) -> Values<'_> {
        Values { components, met: RefCell::default() }
    }

    fn at(&self, x: &[f64]) -> Vec<f64> {
        let values: Vec<f64> = self.components.iter().map(|component| component.at(x)).collect();
        self.met.borrow_mut().extend(&values);
        values
    }

    /// Checks the values that the load had.
    ///
    /// # Errors
    /// A value is not finite or is outside the range of quantities.
    fn check(self, unit: &str) -> Result<()> {
        range::largest("load", self.met.into_inner(), unit)
    }
}

impl Action {
    /// Acts with this traction everywhere, Pa.
    pub fn traction(traction: &[f64]) -> Action {
        Action::Traction(traction.iter().copied().map(Component::Constant).collect())
    }

    /// Acts with this force per volume everywhere, N/m³.
    pub fn body(body: &[f64]) -> Action {
        Action::Body(body.iter().copied().map(Component::Constant).collect())
    }
}

/// The nodal forces `f_a = ∫ N_a t dA` and `f_a = ∫ N_a b dV`, `[points · dimension]`, N. A prescribed displacement or volume has
/// none.
///
/// The quadrature rules are chosen by the degree of the load as a polynomial of the position, whatever the rule of the
/// stiffness is: [`crate::element::Element::integration_table`]. A load that is not a polynomial is integrated as one
/// of degree 8.
///
/// `thickness` is in m, that of all cells or of each; it is 1 for a solid.
///
/// # Errors
/// The part has no sides, points or cells on which the load can act, or the load is not finite somewhere.
pub fn nodal_forces(
    mesh: &Mesh,
    part: &Selection,
    action: &Action,
    thickness: impl Into<CellMap<f64>>,
) -> Result<Vec<f64>> {
    forces_of(mesh, part, action, &thickness.into())
}

/// [`nodal_forces`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn forces_of(mesh: &Mesh, part: &Selection, action: &Action, thickness: &CellMap<f64>) -> Result<Vec<f64>> {
    let nothing = |what: &str| Err(Error::at("load", format!("acts on nothing: the selected part has no {what}")));
    let forces = match action {
        Action::Traction(traction) => {
            let sides = part.sides(mesh)?;
            if sides.is_empty() {
                return nothing("sides");
            }
            finite_at(mesh, traction, sides.iter().flat_map(|side| side_points(mesh, side).0))?;
            let values = Values::of(traction);
            let forces = side_forces(mesh, &sides, load_of(traction), &|x, _| values.at(x), thickness);
            values.check("Pa")?;
            forces
        }
        Action::Pressure(pressure) => {
            let pressed = PressedFaces::new(mesh, part, pressure, thickness)?;
            finite_at(mesh, std::slice::from_ref(pressure), pressed.points())?;
            let values = Values::of(std::slice::from_ref(pressure));
            pressed.points().for_each(|p| _ = values.at(mesh.point(p)));
            values.check("Pa")?;
            pressed.forces(&mesh.points)
        }
        Action::Volume(_) => vec![0.0; mesh.points.len()],
        Action::Moment(moment) => {
            let moment = std::array::from_fn(|k| moment.get(k).copied().unwrap_or(0.0));
            let Some(forces) = mesh.couples(&part.points(mesh)?, moment) else {
                return nothing("joints of rods or edges of a sheet");
            };
            forces
        }
        Action::Force(force) => {
            let weights = match part.carrier(mesh)? {
                Carrier::Sides(sides) => side_weights(mesh, &sides, thickness),
                Carrier::Cells(cells) if RodLoad::is_of(mesh) => {
                    // Rods bend under what lies along them: the force goes through the shape functions of a beam, as a
                    // weight does.
                    let total: f64 = contents_of(mesh, &cells, thickness).iter().sum();
                    let even: Vec<Component> = force.iter().map(|f| Component::Constant(f / total)).collect();
                    return Ok(body_forces(mesh, &cells, &Values::of(&even), thickness));
                }
                Carrier::Cells(cells) => cell_weights(mesh, &cells, thickness),
                Carrier::Points(points) => points.into_iter().map(|p| (p, 1.0)).collect(),
            };
            let total: f64 = weights.iter().map(|(_, w)| w).sum();
            if weights.is_empty() {
                return nothing("points");
            }
            spread(mesh, &weights, &force.iter().map(|f| f / total).collect::<Vec<_>>())
        }
        Action::Body(body) => {
            let cells = part.cells(mesh)?;
            if cells.is_empty() {
                return nothing("cells");
            }
            let nodes = |c: &CellIndex| mesh.blocks[c.block].cells().nth(c.cell).unwrap_or_default();
            finite_at(mesh, body, cells.iter().flat_map(|c| nodes(c).iter().copied()))?;
            let body = Values::of(body);
            let forces = body_forces(mesh, &cells, &body, thickness);
            body.check("N/m³")?;
            forces
        }
        Action::Displacement(given) => {
            let points = part.points(mesh)?;
            if points.is_empty() {
                return nothing("points");
            }
            let free = Component::Constant(0.0);
            let components: Vec<Component> = given.iter().map(|u| u.as_ref().unwrap_or(&free).clone()).collect();
            finite_at(mesh, &components, points.iter().copied())?;
            let values = Values::of(&components);
            points.iter().for_each(|&p| _ = values.at(mesh.point(p)));
            values.check("m")?;
            vec![0.0; mesh.points.len()]
        }
    };
    match first_not_finite(&forces) {
        None => Ok(forces),
        Some(dof) => Err(not_finite(mesh, dof / mesh.dimension, "near", &format!("a nodal force of {}", forces[dof]))),
    }
}

/// Checks that a load is finite at the nodes on which it acts; a quadrature point may miss a singularity there.
fn finite_at(mesh: &Mesh, components: &[Component], mut points: impl Iterator<Item = usize>) -> Result<()> {
    let varies = |component: &Component| matches!(component, Component::Varying(_));
    // Constants were checked where they came in.
    if !components.iter().any(varies) {
        return Ok(());
    }
    let mut seen = vec![false; mesh.point_count()];
    let fault = points.find_map(|p| {
        // A point belongs to many sides or cells, and an expression is slow.
        let is_new = !std::mem::replace(&mut seen[p], true);
        let values = is_new.then(|| components.iter().map(|component| component.at(mesh.point(p))));
        values?.zip(["x", "y", "z"]).find(|(value, _)| !value.is_finite()).map(|(value, axis)| (p, value, axis))
    });
    let found = |value: f64, axis: &str| match components {
        [_] => value.to_string(),
        _ => format!("{value} along {axis}"),
    };
    fault.map_or(Ok(()), |(p, value, axis)| Err(not_finite(mesh, p, "at", &found(value, axis))))
}

fn not_finite(mesh: &Mesh, point: usize, place: &str, found: &str) -> Error {
    let at = mesh.point(point);
    Error::at("load", format!("is not finite everywhere on the selected part: found {found} {place} {at:?} m"))
}

fn body_forces(mesh: &Mesh, cells: &[CellIndex], body: &Values, thickness: &CellMap<f64>) -> Vec<f64> {
    let d = mesh.dimension;
    let mut forces = vec![0.0; mesh.points.len()];
    let mut rods = RodLoad::of(mesh);
    let integrand = match rods {
        Some(_) => RodLoad::integrand(degree_of(body.components)),
        None => load_of(body.components),
    };
    each_cell_points(mesh, integrand, is_among(mesh, cells), |cell| {
        let thickness = thickness.at(cell.index.block, cell.index.cell);
        for (values, volume) in cell.each() {
            let at = |k: usize| cell.nodes.iter().zip(values).map(|(&p, n)| n * mesh.point(p)[k]).sum();
            let x: Vec<f64> = (0..d).map(at).collect();
            let b: Vec<f64> = body.at(&x).into_iter().map(|b| thickness * b).collect();
            if let Some(rods) = &mut rods {
                rods.add([cell.nodes[0], cell.nodes[1]], values[1], std::array::from_fn(|k| volume * b[k]));
                continue;
            }
            for (&node, n) in cell.nodes.iter().zip(values) {
                (0..d).for_each(|k| forces[node * d + k] += n * volume * b[k]);
            }
        }
    });
    rods.map_or(forces, RodLoad::forces)
}

/// Whether a cell is one of these.
fn is_among(mesh: &Mesh, cells: &[CellIndex]) -> impl Fn(CellIndex) -> bool {
    let mut chosen: Vec<Vec<bool>> = mesh.blocks.iter().map(|b| vec![false; b.cells().len()]).collect();
    cells.iter().for_each(|c| chosen[c.block][c.cell] = true);
    move |cell| chosen[cell.block][cell.cell]
}

fn spread(mesh: &Mesh, weights: &[(usize, f64)], per_unit: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; mesh.points.len()];
    for (point, weight) in weights {
        for (k, t) in per_unit.iter().enumerate() {
            forces[point * mesh.dimension + k] += weight * t;
        }
    }
    forces
}

/// `∫ N_a dA` of every node of every side, m²; in two dimensions relative to the thickness of the first, m.
fn side_weights(mesh: &Mesh, sides: &[SideIndex], thickness: &CellMap<f64>) -> Vec<(usize, f64)> {
    let of = |side: &SideIndex| thickness.at(side.cell.block, side.cell.cell);
    // Shares alone matter. Relative to the first they are the areas themselves where the thickness is one.
    let first = sides.first().map_or(1.0, |side| *of(side));
    let mut weights = Vec::new();
    for index in sides {
        let (nodes, x, _) = side_points(mesh, index);
        let table = &side_of(mesh, index).tabulation;
        for (values, area) in table.values.chunks_exact(nodes.len()).zip(areas(table, &x, mesh.dimension)) {
            let area = area * (of(index) / first);
            weights.extend(nodes.iter().zip(values).map(|(&node, n)| (node, n * area)));
        }
    }
    weights
}

/// `∫ N_a dV` of every node of the cells, m³.
fn cell_weights(mesh: &Mesh, cells: &[CellIndex], thickness: &CellMap<f64>) -> Vec<(usize, f64)> {
    let contents = contents_of(mesh, cells, thickness);
    contents.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0).collect()
}

/// `∫ N_a dV` of every point over all cells, `[points]`, m³: what a body force of 1 N/m³ adds there.
pub fn point_contents(mesh: &Mesh, thickness: &CellMap<f64>) -> Vec<f64> {
    let cells = Selection::Everything.cells(mesh).expect("everything is no group that may be missing");
    contents_of(mesh, &cells, thickness)
}

fn contents_of(mesh: &Mesh, cells: &[CellIndex], thickness: &CellMap<f64>) -> Vec<f64> {
    let mut contents = vec![0.0; mesh.point_count()];
    each_cell_points(mesh, Integrand::Load(0), is_among(mesh, cells), |cell| {
        let thickness = thickness.at(cell.index.block, cell.index.cell);
        for (values, volume) in cell.each() {
            cell.nodes.iter().zip(values).for_each(|(&node, n)| contents[node] += n * volume * thickness);
        }
    });
    contents
}

/// A force per area, Pa, as a function of the position and of the normal, which points outwards and, on a surface in
/// space, lies in it.
pub type Traction<'a> = dyn Fn(&[f64], &[f64]) -> Vec<f64> + 'a;

/// The nodal forces `f_a = ∫ N_a t(x, n) dA` over the sides on the boundary, `[points · dimension]`, N; on flat sides
/// exact for tractions of degree 2 in the position.
pub fn boundary_forces(mesh: &Mesh, traction: &Traction, thickness: &CellMap<f64>) -> Vec<f64> {
    let sides = Selection::Everything.sides(mesh).expect("everything is no group that may be missing");
    side_forces(mesh, &sides, Integrand::Load(2), traction, thickness)
}

fn side_forces(
    mesh: &Mesh,
    sides: &[SideIndex],
    integrand: Integrand,
    traction: &Traction,
    thickness: &CellMap<f64>,
) -> Vec<f64> {
    let d = mesh.dimension;
    let mut forces = vec![0.0; mesh.points.len()];
    let tables: Vec<Vec<Tabulation>> =
        mesh.blocks.iter().map(|block| block.element.side_integration_tables(integrand)).collect();
    for index in sides {
        let (nodes, x, centre) = side_points(mesh, index);
        let table = &tables[index.cell.block][index.side];
        let thickness = thickness.at(index.cell.block, index.cell.cell);
        let (count, tangents) = (nodes.len(), table.dimension);
        let values = table.values.chunks_exact(count);
        let gradients = table.gradients.chunks_exact(count * tangents);
        for ((values, gradients), area) in values.zip(gradients).zip(areas(table, &x, d)) {
            let at: Vec<f64> = (0..d).map(|k| (0..count).map(|a| values[a] * x[a * d + k]).sum()).collect();
            let mut basis: Vec<Vec<f64>> = Vec::new();
            for l in 0..tangents {
                let along = |k: usize| (0..count).map(|a| x[a * d + k] * gradients[a * tangents + l]).sum();
                basis.push(unit(&across((0..d).map(along).collect(), &basis)));
            }
            // The component, orthogonal to all tangents, of the vector from the middle of the cell.
            let way: Vec<f64> = at.iter().zip(&centre).map(|(x, c)| x - c).collect();
            let t = traction(&at, &unit(&across(way, &basis)));
            for (&node, n) in nodes.iter().zip(values) {
                (0..d).for_each(|k| forces[node * d + k] += n * area * thickness * t[k]);
            }
        }
    }
    forces
}

/// The nodes of a side and their positions, and the middle of its cell.
fn side_points(mesh: &Mesh, index: &SideIndex) -> (Vec<usize>, Vec<f64>, Vec<f64>) {
    let d = mesh.dimension;
    let block = &mesh.blocks[index.cell.block];
    let n = block.element.nodes();
    let cell = &block.connectivity[index.cell.cell * n..(index.cell.cell + 1) * n];
    let nodes: Vec<usize> = side_of(mesh, index).nodes.iter().map(|&a| cell[a]).collect();
    let x = gathered(&mesh.points, d, &nodes);
    let centre = (0..d).map(|k| cell.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / n as f64).collect();
    (nodes, x, centre)
}

fn side_of<'a>(mesh: &'a Mesh, index: &SideIndex) -> &'a SideTable {
    &mesh.blocks[index.cell.block].element.sides()[index.side]
}

/// The component of a vector that is orthogonal to unit vectors.
fn across(mut v: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    for e in basis {
        let along = dot(&v, e);
        v.iter_mut().zip(e).for_each(|(v, e)| *v -= along * e);
    }
    v
}

/// `w_q ‖∂x/∂s₁ × ∂x/∂s₂‖` (`w_q ‖∂x/∂s‖` on a curve) at each quadrature point of a side.
fn areas(table: &Tabulation, x: &[f64], d: usize) -> Vec<f64> {
    let tangents = table.dimension;
    let at_point = |(gradients, w): (&[f64], &f64)| {
        let tangent = |l: usize| -> Vec<f64> {
            (0..d).map(|k| (0..table.nodes).map(|a| x[a * d + k] * gradients[a * tangents + l]).sum()).collect()
        };
        let s = tangent(0);
        if tangents == 1 {
            return w * norm(&s);
        }
        let t = tangent(1);
        let cross = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
        w * norm(&cross)
    };
    table.gradients.chunks_exact(table.nodes * tangents).zip(&table.weights).map(at_point).collect()
}
