//! The difference between the stiffness of the springs of an element and that of the finite element.

use super::cells::{CHUNK, CellFits};
use super::input::{check_fit, check_length};
use super::visit::each_cell;
use crate::element::Element;
use crate::error::Result;
use crate::material::Moduli;
use crate::springs::{Force, Measure};
use nalgebra::{DMatrix, DVectorView};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Mean and maximum of a number over the elements.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The maximum.
    pub max: f64,
}

/// The relative error `‖R − K‖/‖R‖` of each element.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ElementErrors {
    /// In the Frobenius norm, `[cells]`.
    pub frobenius: Vec<f64>,
    /// In the induced 2-norm, `[cells]`.
    pub spectral: Vec<f64>,
}

impl ElementErrors {
    /// Appends the errors of further cells.
    pub fn extend(&mut self, other: ElementErrors) {
        self.frobenius.extend(other.frobenius);
        self.spectral.extend(other.spectral);
    }
}

impl Spread {
    /// Mean and maximum of the values.
    pub fn of(values: &[f64]) -> Spread {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        Spread { mean, max: values.iter().copied().fold(0.0, f64::max) }
    }
}

/// The relative errors of every cell, from R and `K = Σ k_s g_s g_sᵀ`.
///
/// # Errors
/// An array has a wrong length; a coordinate or modulus is not finite or is out of its range; the springs belong to
/// another element; or a cell is reversed, tangled or flat.
pub fn element_errors(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    moduli: Moduli,
    fits: &CellFits,
) -> Result<ElementErrors> {
    check_fit(element, &fits.springs, points, connectivity, &moduli)?;
    let cells = connectivity.len() / element.nodes();
    check_length("constants", fits.constants.len(), cells * fits.springs.len())?;
    fits.force.check(fits.springs.names.len())?;
    let parameters = fits.force.places(&fits.springs).last().map_or(0, |count| cells * count);
    check_length("parameters", fits.parameters.len(), parameters)?;
    let (n, size) = (element.nodes(), element.nodes() * element.dimension());
    let m = fits.springs.len();
    let pulls = Pulls::of(element, fits);
    let chunk = |(i, nodes): (usize, &[usize])| {
        let first = i * CHUNK;
        let mut errors = ElementErrors::default();
        let mut g = Vec::new();
        each_cell(element, points, nodes, first, |cell, x, geometry| {
            let r = geometry.stiffness(moduli);
            let mut difference = r.clone();
            fits.springs.gradients(x, geometry, &mut g);
            for (g, k) in g.chunks_exact(size).zip(&fits.constants[(first + cell) * m..]) {
                let g = DVectorView::from_slice(g, size);
                difference.ger(-k, &g, &g, 1.0);
            }
            pulls.subtract(fits, first + cell, x, &mut difference);
            errors.frobenius.push(difference.norm() / r.norm());
            errors.spectral.push(spectral_norm(difference) / spectral_norm(r));
        })?;
        Ok(errors)
    };
    let chunks: Vec<Result<ElementErrors>> = connectivity.par_chunks(CHUNK * n).enumerate().map(chunk).collect();
    let mut all = ElementErrors::default();
    for errors in chunks {
        all.extend(errors?);
    }
    Ok(all)
}

/// The part of K that comes from springs that pull at rest: `Σ T_s ∇∇c_s`.
struct Pulls {
    measures: Vec<(Vec<usize>, Measure)>,
    places: Vec<usize>,
    dimension: usize,
}

impl Pulls {
    /// Linear springs, which do not pull at rest, have no such part.
    fn of(element: &Element, fits: &CellFits) -> Pulls {
        let measures = match fits.force {
            Force::Linear => Vec::new(),
            _ => fits.springs.measures(&Arc::new(element.clone())),
        };
        Pulls { measures, places: fits.force.places(&fits.springs), dimension: element.dimension() }
    }

    fn subtract(&self, fits: &CellFits, cell: usize, x: &[f64], difference: &mut DMatrix<f64>) {
        let (d, count) = (self.dimension, self.places.last().copied().unwrap_or(0));
        for (s, (nodes, measure)) in self.measures.iter().enumerate() {
            let dofs: Vec<usize> = nodes.iter().flat_map(|&a| a * d..(a + 1) * d).collect();
            let at: Vec<f64> = dofs.iter().map(|&i| x[i]).collect();
            let rest = measure.value(&at, d);
            let own = &fits.parameters[cell * count..][self.places[s]..self.places[s + 1]];
            let constant = fits.constants[cell * self.measures.len() + s];
            let pull = fits.force.tension(&fits.springs, s, constant, own, [rest, rest]);
            if pull == 0.0 {
                continue;
            }
            let hessian = measure.jet(&at, d).hessian;
            for (a, &row) in dofs.iter().enumerate() {
                for (b, &column) in dofs.iter().enumerate() {
                    difference[(row, column)] -= pull * hessian[a * dofs.len() + b];
                }
            }
        }
    }
}

fn spectral_norm(symmetric: DMatrix<f64>) -> f64 {
    symmetric.symmetric_eigenvalues().amax()
}
