//! The mass matrix that belongs to the shape functions.
//!
//! Theory: page *Dynamics* of the book.

use super::integration::each_cell_points;
use super::lumping::{TurningMass, turning_masses};
use crate::element::Integrand;
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{CellBlock, CellIndex, Mesh};

/// The consistent mass matrix `M_ab = ∫ ρ N_a N_b dV` of a mesh as `GᵀG`, kg. Each quadrature point q is a row of G, with the numbers
/// `√(ρ w_q |J_q|) N_a(ξ_q)` of the points a of its cell. It is the same in every direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistentMasses {
    point_count: usize,
    /// Where the numbers of each row begin, and where the last ends, `[rows + 1]`.
    starts: Vec<usize>,
    points: Vec<usize>,
    values: Vec<f64>,
}

impl ConsistentMasses {
    /// That of a mesh. `thickness` is in m, 1 for a solid; `density` is in kg/m³; each is that of all cells, or one of each. The
    /// quadrature rules are exact for the shape functions ([`crate::element::Element::integration_table`]).
    ///
    /// # Errors
    /// A cell is turned inside out at a quadrature point, or a density or a thickness is negative.
    pub fn of_mesh(
        mesh: &Mesh,
        density: impl Into<CellMap<f64>>,
        thickness: impl Into<CellMap<f64>>,
    ) -> Result<ConsistentMasses> {
        Self::of_cells(mesh, density.into(), thickness.into())
    }

    /// [`Self::of_mesh`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn of_cells(mesh: &Mesh, density: CellMap<f64>, thickness: CellMap<f64>) -> Result<ConsistentMasses> {
        let mut all = ConsistentMasses {
            point_count: mesh.point_count(),
            starts: vec![0],
            points: Vec::new(),
            values: Vec::new(),
        };
        let mut negative = None;
        each_cell_points(
            mesh,
            Integrand::Mass,
            |_| true,
            |cell| {
                let of =
                    density.at(cell.index.block, cell.index.cell) * thickness.at(cell.index.block, cell.index.cell);
                for (values, content) in cell.each() {
                    let mass = of * content;
                    if !(mass >= 0.0) {
                        // Told after the pass; the root of a negative number would be NaN in all products.
                        negative.get_or_insert((cell.index, mass));
                    }
                    all.points.extend_from_slice(cell.nodes);
                    // M is stored by factors, `M = Σ v vᵀ` with `v = √m N`: no product with it can have a negative
                    // energy by rounding.
                    all.values.extend(values.iter().map(|n| mass.max(0.0).sqrt() * n));
                    all.starts.push(all.points.len());
                }
            },
        );
        let of = |cell: CellIndex| density.at(cell.block, cell.cell) * thickness.at(cell.block, cell.cell);
        for TurningMass { director, ends: [a, b], own, .. } in turning_masses(mesh, &of) {
            // The rotary inertia of the plate belongs to what the director moves beside the middle of its edge.
            let root = own.max(0.0).sqrt();
            all.points.extend([director, a, b]);
            all.values.extend([root, -root / 2.0, -root / 2.0]);
            all.starts.push(all.points.len());
        }
        match negative {
            None => Ok(all),
            Some((index, mass)) => {
                let found = format!("{mass:e} kg in cell {} of block {}", index.cell + 1, index.block + 1);
                Err(Error::expected("masses", "a mass of at least zero at each quadrature point", found))
            }
        }
    }

    /// The numbers that it takes for a mesh.
    pub fn numbers(mesh: &Mesh) -> usize {
        let of_block = |block: &CellBlock| {
            let table = block.element.integration_table(Integrand::Mass);
            block.cells().len() * table.points() * table.nodes
        };
        mesh.blocks.iter().map(of_block).sum()
    }

    /// The mass `1ᵀ M 1`, kg.
    pub fn total(&self) -> f64 {
        self.rows().map(|(_, values)| values.iter().sum::<f64>().powi(2)).sum()
    }

    /// The matrix times a factor of at least zero.
    ///
    /// # Errors
    /// The factor is negative or not a number.
    pub fn scaled(mut self, factor: f64) -> Result<ConsistentMasses> {
        if !(factor >= 0.0 && factor.is_finite()) {
            return Err(Error::expected("factor", "a number of at least zero", factor));
        }
        self.values.iter_mut().for_each(|value| *value *= factor.sqrt());
        Ok(self)
    }

    /// The matrix `(1 − s) M + s diag(m)` for the share s of masses at the points, `[points]`, kg.
    ///
    /// # Errors
    /// The share is not between 0 and 1, there is not one mass for each point, or a mass is negative.
    pub fn blended(&self, lumped: &[f64], share: f64) -> Result<ConsistentMasses> {
        if !(0.0..=1.0).contains(&share) {
            return Err(Error::expected("share", "a number from 0 to 1", share));
        }
        if lumped.len() != self.point_count {
            return Err(Error::expected("masses", format!("{}, one for each point", self.point_count), lumped.len()));
        }
        if let Some(p) = lumped.iter().position(|m| !(*m >= 0.0 && m.is_finite())) {
            return Err(Error::expected("masses", format!("a mass of at least zero at point {p}"), lumped[p]));
        }
        let mut all = self.clone();
        all.values.iter_mut().for_each(|value| *value *= (1.0 - share).sqrt());
        for (p, mass) in lumped.iter().enumerate() {
            all.points.push(p);
            // Roots are stored, so that the squares add up to the shares of both matrices.
            all.values.push((share * mass).sqrt());
            all.starts.push(all.points.len());
        }
        Ok(all)
    }

    /// The product with displacements or accelerations, `[points × dimension]`, in kg times their unit.
    ///
    /// # Errors
    /// There are not `dimension` numbers for each point.
    pub fn product(&self, u: &[f64], dimension: usize) -> Result<Vec<f64>> {
        if u.len() != self.point_count * dimension {
            return Err(Error::expected("vector", format!("{} numbers", self.point_count * dimension), u.len()));
        }
        Ok(self.product_of(u, dimension))
    }

    /// [`ConsistentMasses::product`] with as many numbers as there must be.
    pub(crate) fn product_of(&self, u: &[f64], dimension: usize) -> Vec<f64> {
        let mut product = vec![0.0; u.len()];
        for (points, values) in self.rows() {
            for k in 0..dimension {
                let own: f64 = points.iter().zip(values).map(|(&p, value)| value * u[p * dimension + k]).sum();
                points.iter().zip(values).for_each(|(&p, value)| product[p * dimension + k] += value * own);
            }
        }
        product
    }

    /// [`ConsistentMasses::entries`], those of a cell added: the rows of its points follow each other.
    pub(crate) fn pairs(&self) -> Vec<(usize, usize, f64)> {
        let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
        let mut last: &[usize] = &[];
        for (points, values) in self.rows() {
            // Quadrature points of one cell have the same points, and their products the same places.
            if points != last {
                pairs.extend(points.iter().flat_map(|&a| points.iter().map(move |&b| (a, b, 0.0))));
                last = points;
            }
            let begin = pairs.len() - points.len() * points.len();
            let products = values.iter().flat_map(|a| values.iter().map(move |b| a * b));
            pairs[begin..].iter_mut().zip(products).for_each(|(pair, product)| pair.2 += product);
        }
        pairs
    }

    /// The entries `M_ab` with their points a and b; those of one pair are to be added.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.rows().flat_map(|(points, values)| {
            let entry = move |(a, i): (usize, f64)| points.iter().zip(values).map(move |(&b, j)| (a, b, i * j));
            points.iter().copied().zip(values.iter().copied()).flat_map(entry)
        })
    }

    /// The number of points of the mesh.
    pub fn point_count(&self) -> usize {
        self.point_count
    }

    /// The points of each row of G and its numbers, kg^½.
    pub fn rows(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        self.starts.windows(2).map(|ends| (&self.points[ends[0]..ends[1]], &self.values[ends[0]..ends[1]]))
    }
}
