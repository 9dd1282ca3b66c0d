//! Springs on the stretch of fibres: `I4 = |F a|²` is a quadratic form of the nodes, so that a law of fibres is a law
//! of springs.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::network::{MeasureSpring, SpringLaw};
use super::system::each_cell;
use crate::element::{SpringKind, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Energy, EnergyMap, MaterialMap, State};
use crate::mesh::{CellIndex, Mesh};
use crate::springs::{Law, Measure};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The springs of the fibres of all cells, each with its law; see [`fibre_springs`].
///
/// # Errors
/// Those of [`fibre_springs`].
pub fn fibre_springs_of_regions(mesh: &Mesh, material: &MaterialMap, laws: &EnergyMap) -> Result<Vec<MeasureSpring>> {
    of_cells(mesh, material, |cell| laws.at(cell.block, cell.cell).0)
}

/// A spring at each quadrature point that measures `c = |Σ_a x_a (∇N_a·a)|`, with a the direction of the fibres, and
/// has the force `v ∂W/∂c` of the law, with v the volume of the point. None if the law has no fibres.
///
/// # Errors
/// The stress of the fibres depends on more than their stretch, or they point out of a plane (kind `Unsupported`).
pub fn fibre_springs(mesh: &Mesh, material: impl Into<MaterialMap>, law: &Energy) -> Result<Vec<MeasureSpring>> {
    springs_of_fibres(mesh, material.into(), law)
}

/// [`fibre_springs`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn springs_of_fibres(mesh: &Mesh, material: MaterialMap, law: &Energy) -> Result<Vec<MeasureSpring>> {
    of_cells(mesh, &material, |_| law)
}

/// The springs of the fibres with the law of each cell.
fn of_cells<'l>(
    mesh: &Mesh,
    material: &MaterialMap,
    law: impl Fn(CellIndex) -> &'l Energy,
) -> Result<Vec<MeasureSpring>> {
    let (thicknesses, mut springs) = (material.thicknesses(), Vec::new());
    let (mut known, mut all) = (BTreeMap::new(), Ok(()));
    each_cell(mesh, |cell, nodes, geometry| {
        // The loop over the cells cannot be ended early. The error is that of the first cell with a fault.
        if all.is_err() {
            return;
        }
        let energy = law(cell);
        let (direction, law) = match own_law(mesh, material, energy, &mut known) {
            Ok(Some(found)) => found,
            Ok(None) => return,
            Err(error) => {
                all = Err(error);
                return;
            }
        };
        let thickness = thicknesses.at(cell.block, cell.cell);
        let (d, size) = (mesh.dimension, nodes.len() * mesh.dimension);
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
                modes: None,
            };
            let law = SpringLaw::new(law.clone(), &[volume * thickness]);
            springs.push(MeasureSpring {
                kind: SpringKind::Fibre,
                points: nodes.into(),
                constant: law.slope(1.0, 1.0),
                rest: 1.0,
                measure: Measure::Span(Arc::new(table)),
                law: Some(Box::new(law)),
            });
        }
    });
    all.map(|()| springs)
}

/// The direction of the fibres of an energy and the law of their springs, which those of the same numbers share in `known`.
fn own_law(
    mesh: &Mesh,
    material: &MaterialMap,
    energy: &Energy,
    known: &mut BTreeMap<String, Arc<Law>>,
) -> Result<Option<(Vector3<f64>, Arc<Law>)>> {
    let Some((direction, text)) = energy.fibre_law()? else { return Ok(None) };
    let d = mesh.dimension;
    let is_in_space = matches!(material.state(), State::Solid | State::PlaneStrain { .. });
    if !is_in_space || mesh.cell_dimension() != d || direction.iter().skip(d).any(|a| *a != 0.0) {
        let expected = "fibres in a solid, or in the plane of one without strain across it";
        return Err(Error::expected("objective", expected, format!("those of the law \"{}\"", energy.name()))
            .of_kind(ErrorKind::Unsupported));
    }
    let law = match known.get(&text) {
        Some(law) => law.clone(),
        None => known.entry(text.clone()).or_insert(Arc::new(Law::parse(&text)?)).clone(),
    };
    Ok(Some((direction, law)))
}
