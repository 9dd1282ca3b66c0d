//! The effective elastic moduli of a network of springs, measured on a periodic box.

use crate::analysis::homogenise::period_tensor;
use crate::analysis::metrics::SOLVED;
use crate::element::Element;
use crate::error::Result;
use crate::fit::{CellFits, Fit, fit_cells};
use crate::material::{Material, State};
use crate::mesh::{BoxMesh, Mesh};
use crate::model::{Entries, Network, Support, content, finite_elements};
use crate::solve::System;
use crate::springs::Springs;
use faer::sparse::Triplet;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The moduli of a homogenised material; if it is anisotropic, means over the axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectiveModuli {
    /// C, `σ = C ε` with the strains xx, yy, (zz,) xy, (xz, yz), shears as `2 ε_kl`; Pa, in the plane N/m.
    #[serde(skip)]
    pub stiffness: DMatrix<f64>,
    /// Young's modulus, the mean over the axes, in the unit of the stiffness.
    pub young: f64,
    /// Poisson's ratio, the mean over all pairs of axes.
    pub poisson: f64,
    /// Zener's ratio `2 C_shear/(C₁₁ − C₁₂)`, from means over the axes: 1 for an isotropic material (Zener 1948).
    pub zener: f64,
}

impl EffectiveModuli {
    /// With E and ν of the solid in plane strain, which are the plane moduli `E/(1 − ν²)` and `ν/(1 − ν)` otherwise. The stiffness
    /// stays that of the plane.
    pub fn of_solid(self, state: State) -> EffectiveModuli {
        match state {
            State::PlaneStrain { .. } => {
                let poisson = self.poisson / (1.0 + self.poisson);
                EffectiveModuli { young: self.young * (1.0 - poisson * poisson), poisson, ..self }
            }
            State::Rod { .. } | State::Solid | State::PlaneStress { .. } => self,
        }
    }
}

/// The cells that fill a box of this size, m, one in each direction.
fn box_of(element: &Arc<Element>, size: &[f64]) -> Result<Mesh> {
    let d = element.dimension();
    let spec = BoxMesh { element: element.clone(), size: size.to_vec(), cells: vec![1; d], origin: vec![0.0; d] };
    spec.build()
}

/// The cells and springs of a periodic box.
#[derive(Debug)]
pub struct Lattice {
    mesh: Mesh,
    fits: CellFits,
}

impl Lattice {
    /// Fits the springs of `element` in a box of one cell per direction (for a simplex, of the d! cells that fill it),
    /// each of length `size`, m.
    ///
    /// # Errors
    /// The cells of the element do not fill a box.
    pub fn fit(
        element: &Arc<Element>,
        springs: &Springs,
        size: &[f64],
        material: Material,
        fit: &Fit,
    ) -> Result<Lattice> {
        Lattice::of(element, size, |points, cells| {
            fit_cells(element, springs, points, cells, material.moduli(), fit, &mut |_| {})
        })
    }

    /// Builds a box of cells as [`Lattice::fit`] does, with the springs that `fit` finds for the cells, `[cells × nodes]` into the points.
    ///
    /// # Errors
    /// The cells of the element do not fill a box; or those of `fit`.
    pub fn of(
        element: &Arc<Element>,
        size: &[f64],
        fit: impl FnOnce(&[f64], &[usize]) -> Result<CellFits>,
    ) -> Result<Lattice> {
        let mesh = box_of(element, size)?;
        let fits = fit(&mesh.points, &mesh.blocks[0].connectivity)?;
        Ok(Lattice { mesh, fits })
    }

    /// Replaces the constants of the springs by these, `[cells × springs]`.
    pub fn with_constants(mut self, constants: Vec<f64>) -> Lattice {
        self.fits.constants = constants;
        self
    }

    /// The moduli of the springs; `None` if some strain meets no resistance.
    pub fn of_springs(&self) -> Option<EffectiveModuli> {
        let network = Network::assemble(&self.mesh, std::slice::from_ref(&self.fits));
        homogenise(&self.mesh, &network.stiffness(&self.mesh.points))
    }

    /// The moduli of the finite elements, which are those of the material.
    pub fn of_elements(&self, material: Material) -> Option<EffectiveModuli> {
        homogenise(&self.mesh, &finite_elements(&self.mesh, material.moduli()))
    }
}

/// The moduli of a whole body under `u = ε x` on its boundary, with its inner points in equilibrium. They approach
/// those of its material as the number of inner points grows. `None` if some strain meets no resistance, there is no
/// inner point, or membranes or rods are attached to the body.
pub fn moduli_of_body(mesh: &Mesh, entries: &Entries) -> Result<Option<EffectiveModuli>> {
    let d = mesh.dimension;
    let outer = mesh.outer_points();
    let boundary: BTreeSet<usize> = (0..mesh.point_count()).filter(|&p| outer[p]).collect();
    // Without inner points all follow the strain, and the moduli are bounds from above and no approximation.
    if d != mesh.cell_dimension() || mesh.is_mixed() || boundary.len() == mesh.point_count() {
        return Ok(None);
    }
    let strains = strains(d);
    let mut solutions = Vec::new();
    for strain in &strains {
        let mut support = Support::free(mesh);
        for &p in &boundary {
            let u = strain * DVector::from_column_slice(mesh.point(p));
            (0..d).for_each(|k| support.prescribed[p * d + k] = Some(u[k]));
        }
        let system = System::new(entries, &support)?.placed(&mesh.points, d);
        let Some(factor) = system.factorize()? else { return Ok(None) };
        let (u, left) = system.solve(&factor, &vec![0.0; mesh.points.len()]);
        // A factor of a nearly singular matrix leaves residuals, or NaN, which the negated comparison finds too.
        if !(left <= SOLVED) {
            return Ok(None);
        }
        solutions.push(u);
    }
    let energy = |u: &[f64], v: &[f64]| -> f64 {
        let entry = |e: &Triplet<usize, usize, f64>| {
            // The lower triangle alone is stored: an entry beside the diagonal stands for two.
            let other = if e.row == e.col { 0.0 } else { u[e.col] * v[e.row] };
            e.val * (u[e.row] * v[e.col] + other)
        };
        entries.iter().map(entry).sum()
    };
    let volume = content(mesh);
    let count = strains.len();
    let stiffness = DMatrix::from_fn(count, count, |i, j| energy(&solutions[i], &solutions[j]) / volume);
    Ok(moduli(stiffness, d))
}

/// Displacements `u = ε x + ũ` with ũ periodic: `C_ij = (u_iᵀ K u_j)/V`, where each ũ has the least energy.
fn homogenise(mesh: &Mesh, entries: &Entries) -> Option<EffectiveModuli> {
    let d = mesh.dimension;
    let (image, count) = images(mesh);
    // Own points come first.
    let mut order = Vec::with_capacity(image.len());
    let mut place = vec![usize::MAX; image.len()];
    for class in 0..count {
        order.extend((0..image.len()).find(|&p| image[p] == class));
    }
    let first: BTreeSet<usize> = order.iter().copied().collect();
    // Images come after all own points: the numbers of own points are then those of the folded matrix.
    order.extend((0..image.len()).filter(|p| !first.contains(p)));
    order.iter().enumerate().for_each(|(at, &p)| place[p] = at);
    let dof = |dof: usize| place[dof / d] * d + dof % d;
    let moved = entries.iter().map(|e| Triplet::new(dof(e.row).max(dof(e.col)), dof(e.row).min(dof(e.col)), e.val));
    let points: Vec<f64> = order.iter().flat_map(|&p| mesh.point(p)).copied().collect();
    let moved: Entries = moved.collect();
    let (kelvin, _) = period_tensor(&moved, (&points, d), |at| image[order[at]], count, volume(mesh)).ok()?;
    // The shears of Kelvin's notation are √2 ε, those here 2 ε.
    let scale = |i: usize| if i < d { 1.0 } else { f64::sqrt(0.5) };
    moduli(DMatrix::from_fn(kelvin.nrows(), kelvin.ncols(), |i, j| scale(i) * scale(j) * kelvin[(i, j)]), d)
}

/// Points at opposite positions of the box are images of each other.
fn images(mesh: &Mesh) -> (Vec<usize>, usize) {
    let d = mesh.dimension;
    let extent: Vec<f64> =
        (0..d).map(|k| mesh.points.iter().skip(k).step_by(d).fold(0.0, |a: f64, x| a.max(*x))).collect();
    let mut classes: Vec<Vec<f64>> = Vec::new();
    let place = |p: usize| -> Vec<f64> {
        // Points on opposite sides are images of each other: those at the end are counted with those at the start.
        let wrap = |(x, size): (&f64, &f64)| if (x / size - 1.0).abs() < 1e-9 { 0.0 } else { x / size };
        mesh.point(p).iter().zip(&extent).map(wrap).collect()
    };
    let mut class = |p: usize| {
        let at = place(p);
        // Places are in units of the box: what differs by rounding is one point, and nodes of an element are far apart beside that.
        let same = |other: &Vec<f64>| other.iter().zip(&at).all(|(a, b)| (a - b).abs() < 1e-9);
        classes.iter().position(same).unwrap_or_else(|| {
            classes.push(at.clone());
            classes.len() - 1
        })
    };
    let image = (0..mesh.point_count()).map(&mut class).collect();
    (image, classes.len())
}

fn volume(mesh: &Mesh) -> f64 {
    let d = mesh.dimension;
    (0..d).map(|k| mesh.points.iter().skip(k).step_by(d).fold(0.0, |a: f64, x| a.max(*x))).product()
}

/// The unit strains, first along the axes, then the shears.
fn strains(d: usize) -> Vec<DMatrix<f64>> {
    let unit = |k: usize, l: usize| {
        let mut strain = DMatrix::zeros(d, d);
        strain[(k, l)] += 0.5;
        strain[(l, k)] += 0.5;
        strain
    };
    let shears = (0..d).flat_map(|k| (k + 1..d).map(move |l| (k, l)));
    (0..d).map(|k| (k, k)).chain(shears).map(|(k, l)| unit(k, l)).collect()
}

fn moduli(stiffness: DMatrix<f64>, d: usize) -> Option<EffectiveModuli> {
    let compliance = stiffness.clone().try_inverse()?;
    // A strain meets no resistance, and the compliance would be that of rounding.
    if stiffness.clone().symmetric_eigenvalues().min() < 1e-9 * stiffness.amax() {
        return None;
    }
    let mean = |values: DVector<f64>| values.mean();
    let pairs: Vec<(usize, usize)> = (0..d).flat_map(|k| (0..d).map(move |l| (k, l))).filter(|(k, l)| k != l).collect();
    let over_pairs =
        |f: &dyn Fn(usize, usize) -> f64| pairs.iter().map(|&(k, l)| f(k, l)).sum::<f64>() / pairs.len() as f64;
    let along = mean(DVector::from_fn(d, |k, _| stiffness[(k, k)]));
    let across = over_pairs(&|k, l| stiffness[(k, l)]);
    let shears = stiffness.nrows() - d;
    let shear = mean(DVector::from_fn(shears, |s, _| stiffness[(d + s, d + s)]));
    Some(EffectiveModuli {
        young: mean(DVector::from_fn(d, |k, _| 1.0 / compliance[(k, k)])),
        poisson: over_pairs(&|k, l| -compliance[(k, l)] / compliance[(k, k)]),
        // The shears of this notation are `2 ε_kl`, whose entry is C₄₄ itself.
        zener: 2.0 * shear / (along - across),
        stiffness,
    })
}
