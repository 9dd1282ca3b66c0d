//! The places at which a body deforms: quadrature points of cells, or domains of edges, with the gradients of their shape functions.
//!
//! Theory: page *Springs that forget* of the book.

use super::domains::edge_domains;
use super::simplices::linear_simplices;
use super::system::each_cell;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::ShearSprings;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// The material points of a body of isotropic solid cells, or in plane strain.
#[derive(Debug, Clone)]
pub struct MaterialPoints {
    /// The number of coordinates, 2 or 3.
    pub dimension: usize,
    /// Where the nodes of each point begin, and where the last end, `[points + 1]`.
    starts: Vec<usize>,
    nodes: Vec<usize>,
    /// `∂N_a/∂X_k`, 1/m; the third component is zero in the plane.
    gradients: Vec<Vector3<f64>>,
    /// The shear modulus times the volume at rest, J.
    weights: Vec<f64>,
    /// The shear modulus, Pa.
    moduli: Vec<f64>,
    /// The region of the body, as the material numbers them.
    regions: Vec<usize>,
    /// The points of cells whose shape functions are those of one element, in their order: the element, and the number of its cells.
    elements: Vec<(Arc<Element>, usize)>,
}

/// A material point.
#[derive(Debug, Clone, Copy)]
pub struct MaterialPoint<'a> {
    /// Its nodes, as points of the mesh.
    pub nodes: &'a [usize],
    /// `∂N_a/∂X`, 1/m.
    pub gradients: &'a [Vector3<f64>],
    /// `μ V₀`, J.
    pub weight: f64,
    /// μ, Pa.
    pub modulus: f64,
    /// The number of its region.
    pub region: usize,
}

impl MaterialPoints {
    /// Those at which the shear springs of a network measure, or, with springs of cells, those of the finite elements.
    ///
    /// # Errors
    /// Some cell is anisotropic, or the mesh is a surface or curve in space, or has no domains of edges.
    pub fn of(mesh: &Mesh, material: &MaterialMap, shear: ShearSprings) -> Result<MaterialPoints> {
        let d = mesh.dimension;
        let materials = material.materials()?;
        if mesh.cell_dimension() != d {
            let found = format!("cells of {} dimensions in a space of {d}", mesh.cell_dimension());
            return Err(Error::expected("mesh", "cells that fill their space", found).of_kind(ErrorKind::Unsupported));
        }
        let mut all = MaterialPoints {
            dimension: d,
            starts: vec![0],
            nodes: Vec::new(),
            gradients: Vec::new(),
            weights: Vec::new(),
            moduli: Vec::new(),
            regions: Vec::new(),
            elements: Vec::new(),
        };
        match shear {
            ShearSprings::Cells => {
                each_cell(mesh, |index, nodes, geometry| {
                    let mu = materials.at(index.block, index.cell).moduli().mu;
                    let region = *material.region().at(index.block, index.cell);
                    let points = geometry.gradients.chunks_exact(nodes.len() * d).zip(&geometry.volumes);
                    points.for_each(|(gradients, volume)| all.add(nodes, gradients, mu, *volume, region));
                });
                all.elements = mesh.blocks.iter().map(|block| (block.element.clone(), block.cells().len())).collect();
            }
            ShearSprings::Edges => {
                let block = linear_simplices(mesh, "shear", "\"cells\": edges", shear.name())?;
                for domain in edge_domains(mesh, block, material) {
                    let mu: f64 =
                        domain.cells.iter().map(|(cell, share)| share * materials.at(0, *cell).moduli().mu).sum();
                    // A domain lies in one region: its first cell has that of all.
                    let region = domain.cells.first().map_or(0, |(cell, _)| *material.region().at(0, *cell));
                    all.add(&domain.nodes, &domain.table.gradients, mu, domain.table.weights[0], region);
                }
            }
        }
        // The energy of a branch is positive point by point, which a negative weight turns round.
        if all.weights.iter().any(|volume| !(*volume > 0.0)) {
            let expected = "an element whose quadrature has positive weights where stress relaxes: with others energy would be made";
            return Err(Error::expected("mesh", expected, "a weight below zero").of_kind(ErrorKind::Unsupported));
        }
        Ok(all)
    }

    fn add(&mut self, nodes: &[usize], gradients: &[f64], modulus: f64, volume: f64, region: usize) {
        let d = self.dimension;
        self.nodes.extend_from_slice(nodes);
        self.gradients
            .extend(gradients.chunks_exact(d).map(|g| Vector3::from_fn(|k, _| if k < d { g[k] } else { 0.0 })));
        self.starts.push(self.nodes.len());
        self.weights.push(modulus * volume);
        self.moduli.push(modulus);
        self.regions.push(region);
    }

    /// The elements whose shape functions the points of cells have, in their order, each with the number of its cells; none for domains of edges.
    pub(crate) fn elements(&self) -> &[(Arc<Element>, usize)] {
        &self.elements
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// The points, in their order.
    pub fn each(&self) -> impl Iterator<Item = MaterialPoint<'_>> {
        let numbers = self.weights.iter().zip(&self.moduli).zip(&self.regions);
        self.starts.windows(2).zip(numbers).map(|(at, ((weight, modulus), region))| MaterialPoint {
            nodes: &self.nodes[at[0]..at[1]],
            gradients: &self.gradients[at[0]..at[1]],
            weight: *weight,
            modulus: *modulus,
            region: *region,
        })
    }
}

impl MaterialPoint<'_> {
    /// `F = Σ_a x_a ⊗ ∂N_a/∂X` with the points at x, `[points × dimension]`, m; in the plane nothing is strained across.
    pub fn deformation(&self, x: &[f64], d: usize) -> Matrix3<f64> {
        let mut f = Matrix3::zeros();
        for (node, gradient) in self.nodes.iter().zip(self.gradients) {
            let at = &x[node * d..(node + 1) * d];
            f += Vector3::new(at[0], at[1], at.get(2).copied().unwrap_or(0.0)) * gradient.transpose();
        }
        if d < 3 {
            // In plane strain nothing stretches across the plane.
            f[(2, 2)] = 1.0;
        }
        f
    }
}
