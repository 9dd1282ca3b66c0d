//! Springs on the stretch of fibres: `I4 = |F a|²` is a quadratic form of the nodes, so that a law of fibres is a law
//! of springs.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::MeasureSpring;
use super::system::each_cell;
use crate::element::{SpringKind, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Energy, EnergyMap, MaterialMap, State};
use crate::mesh::{CellIndex, Mesh};
use crate::springs::{Law, Measure};
use std::sync::Arc;

/// The springs of the fibres of every region, each with its law; see [`fibre_springs`].
///
/// # Errors
/// Those of [`fibre_springs`].
pub fn fibre_springs_of_regions(mesh: &Mesh, material: &MaterialMap, laws: &EnergyMap) -> Result<Vec<MeasureSpring>> {
    let mut springs = Vec::new();
    for (i, law) in laws.laws().enumerate() {
        springs.extend(of_cells(mesh, material, law, |cell| *laws.index().at(cell.block, cell.cell) == i)?);
    }
    Ok(springs)
}

/// A spring at each quadrature point that measures `c = |Σ_a x_a (∇N_a·a)|`, with a the direction of the fibres, and
/// has the force `v ∂W/∂c` of the law, with v the volume of the point. None if the law has no fibres.
///
/// # Errors
/// The stress of the fibres depends on more than their stretch, or they point out of a plane (kind `Unsupported`).
pub fn fibre_springs(mesh: &Mesh, material: impl Into<MaterialMap>, law: &Energy) -> Result<Vec<MeasureSpring>> {
    of_cells(mesh, &material.into(), law, |_| true)
}

/// The springs of the fibres in the chosen cells.
fn of_cells(
    mesh: &Mesh,
    material: &MaterialMap,
    law: &Energy,
    chosen: impl Fn(CellIndex) -> bool,
) -> Result<Vec<MeasureSpring>> {
    let Some((direction, text)) = law.fibre_law()? else { return Ok(Vec::new()) };
    let d = mesh.dimension;
    let is_in_space = matches!(material.state(), State::Solid | State::PlaneStrain { .. });
    if !is_in_space || mesh.cell_dimension() != d || direction.iter().skip(d).any(|a| *a != 0.0) {
        let expected = "fibres in a solid, or in the plane of one without strain across it";
        return Err(Error::expected("objective", expected, format!("those of the law \"{}\"", law.name))
            .of_kind(ErrorKind::Unsupported));
    }
    let law = Arc::new(Law::parse(&text)?);
    let (thicknesses, mut springs) = (material.thicknesses(), Vec::new());
    each_cell(mesh, |cell, nodes, geometry| {
        if !chosen(cell) {
            return;
        }
        let thickness = thicknesses.at(cell.block, cell.cell);
        let size = nodes.len() * d;
        for (gradients, volume) in geometry.gradients.chunks_exact(size).zip(&geometry.volumes) {
            let along = gradients.chunks_exact(d).map(|g| g.iter().zip(&direction).map(|(g, a)| g * a).sum());
            let table = Tabulation {
                nodes: nodes.len(),
                dimension: 1,
                space: d,
                weights: vec![1.0],
                volumetric: Vec::new(),
                values: Vec::new(),
                gradients: along.collect(),
            };
            let parameters = vec![volume * thickness];
            springs.push(MeasureSpring {
                kind: SpringKind::Fibre,
                points: nodes.to_vec(),
                constant: law.slope(1.0, 1.0, &parameters),
                rest: 1.0,
                measure: Measure::Span(Arc::new(table)),
                law: Some(law.clone()),
                parameters,
            });
        }
    });
    Ok(springs)
}
