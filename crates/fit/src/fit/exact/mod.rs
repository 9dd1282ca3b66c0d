//! Networks that are equal to the finite element: springs of rest length zero between all pairs of nodes, and springs
//! on the content.
//!
//! With `L_ab = Σ_q w_q ∇N_a·∇N_b` and `Σ_a ∇N_a = 0`, for any element and any quadrature,
//!
//! ```text
//! Σ_q w_q |F_q|² = −Σ_{a<b} L_ab |x_a − x_b|²
//! ```
//!
//! The energy `μ/2 (|F|² − d) + U(J)` is therefore that of springs `½ k_ab |x_a − x_b|²`, `k_ab = −μ L_ab`, and of one
//! spring on `J_q` at each quadrature point. If `U'(1) = −μ`, the forces on the nodes vanish at rest, and the tangent
//! there is R with `λ = U''(1) − μ`.
//!
//! Theory: page *Exact networks and patches* of the book.

mod domain;
mod energy;
mod kernel;
mod precision;
mod shear;
mod small;
mod volume;

pub use domain::{DomainSprings, ExactDomains};
pub use energy::ExactEnergy;
pub use precision::{exact_constants_of_kind, exact_double_double_constants};
pub use shear::ShearSprings;
pub use volume::VolumeSprings;

use super::cells::{CHUNK, CellFits, ROUND};
use super::input::check_cells;
use super::visit::cell_fault;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{BlockValues, Material};
use crate::springs::{Force, Springs};
use crate::stiffness::Placement;
use energy::{Coefficients, Form};
use kernel::ExactBatch;
pub(super) use kernel::ExactKernel;
use rayon::prelude::*;

/// The choices of an exact network.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactFit {
    /// The energy that the network has.
    pub energy: ExactEnergy,
    /// The domains over which the springs for μ average the deformation.
    pub shear: ShearSprings,
    /// The contents that the springs for λ measure.
    pub volume: VolumeSprings,
    /// Whether planes and rods without stress have the energy at any deformation, with the stretch across them. If only
    /// small deformations matter, their springs on content are simpler.
    pub large: bool,
}

impl ExactFit {
    /// The springs of each cell of an element, if none are on areas: all pairs of nodes, the contents of quadrature points, and that of the
    /// cell.
    pub fn springs(&self, element: &Element) -> Springs {
        Springs::exact(element, false, self.of_cells(element))
    }

    /// Whether each cell has a spring on its content. The only content of a line is its length.
    fn of_cells(&self, element: &Element) -> bool {
        element.dimension() > 1 && self.volume == VolumeSprings::Cells
    }
}

/// The springs of every cell. `connectivity` is `[cells × nodes]` into `points`, `[points × space]`, m. The material is that of all
/// cells, or one for each, in the same kind of state. The result has
/// [`Force::Exact`]. Constants that are only rounding errors, as at right angles, are set to zero.
///
/// `progress` is called from time to time with the number of finished cells.
///
/// # Errors
/// An array has a wrong length; a number is not finite; a cell is reversed, tangled, flat or curved in space; the
/// energy has no form with springs in this state, or the springs belong to domains of several cells (kind
/// `Unsupported`).
pub fn fit_exact<'a>(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    material: impl Into<BlockValues<'a, Material>>,
    fit: &ExactFit,
    progress: &mut dyn FnMut(usize),
) -> Result<CellFits> {
    fit_block(element, points, connectivity, material.into(), fit, progress)
}

/// [`fit_exact`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn fit_block<'a>(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    material: BlockValues<'a, Material>,
    fit: &ExactFit,
    progress: &mut dyn FnMut(usize),
) -> Result<CellFits> {
    match fit.shear {
        ShearSprings::Cells => {}
        ShearSprings::Edges => {
            let expected = "\"cells\" for the springs of single cells: a mesh has those of the domains of edges";
            let found = format!("\"{}\"", fit.shear.name());
            return Err(Error::expected("shear", expected, found).of_kind(ErrorKind::Unsupported));
        }
    }
    element.check_plain("exact networks")?;
    check_cells(element, points, connectivity)?;
    let cells = connectivity.len() / element.nodes();
    material.check("material", cells)?;
    let mut coefficients = Vec::with_capacity(material.values().len());
    for material in material.values() {
        material.state().check(element.dimension()).map_err(|e| e.at_key("state"))?;
        coefficients.push(Coefficients::of(fit.energy, *material, fit.large)?);
    }
    // A body without cells has no material to ask for a form.
    let (Some(first), Some(some)) = (material.values().first(), coefficients.first()) else {
        return Ok(CellFits::new(Springs::exact(element, false, false)));
    };
    let form = Form::of(fit.energy, first.state(), fit.large)?;
    let coefficients = BlockValues::listed(&coefficients, matches!(material, BlockValues::Uniform(_)));
    if form.is_condensed && fit.volume != VolumeSprings::Points {
        let expected = "\"points\" at large deformation without stress across a plane or rod";
        return Err(
            Error::expected("volume", expected, format!("\"{}\"", fit.volume.name())).of_kind(ErrorKind::Unsupported)
        );
    }
    // The content of a line is its length: a spring on that of the cell would be a second one between the same nodes.
    let volume = if element.dimension() == 1 { VolumeSprings::Points } else { fit.volume };
    let springs = Springs::exact(element, some.areas > 0.0, fit.of_cells(element));
    let shares = volume.shares(springs.points().is_empty());
    check_flat(element, points, connectivity)?;
    let force = Force::Exact { content: form.law.clone() };
    let (n, m) = (element.nodes(), springs.len());
    let p = force.places(&springs)[m];
    let (mut constants, mut parameters) = (vec![0.0; cells * m], vec![0.0; cells * p]);
    let rounds =
        connectivity.chunks(ROUND * n).zip(constants.chunks_mut(ROUND * m)).zip(parameters.chunks_mut(ROUND * p));
    for (round, ((nodes, constants), parameters)) in rounds.enumerate() {
        let chunks = nodes.par_chunks(CHUNK * n).zip(constants.par_chunks_mut(CHUNK * m));
        let chunks = chunks.zip(parameters.par_chunks_mut(CHUNK * p)).enumerate();
        // All are waited for: the cell of an error is the first one, whichever thread was faster.
        let found: Vec<Result<()>> = chunks
            .map(|(i, ((connectivity, constants), parameters))| {
                let first = round * ROUND + i * CHUNK;
                let coefficients = coefficients.part(first, connectivity.len() / n);
                let kernel = ExactKernel { springs: &springs, has_law: form.law.is_some(), shares };
                let batch = ExactBatch { element, kernel, points, connectivity, coefficients, constants, parameters };
                batch.run().map_err(|(cell, fault)| cell_fault(element, first + cell, fault))
            })
            .collect();
        found.into_iter().collect::<Result<()>>()?;
        progress(((round + 1) * ROUND).min(cells));
    }
    Ok(CellFits { constants, parameters, force, ..CellFits::new(springs) })
}

/// The square of the height above the mean plane, as a share of the square of the size of a cell, that may be rounding:
/// heights of 3e-5, as coordinates of single precision far from the origin have. Both squares are sums, whose
/// difference is not known below 1e-16.
const FLAT: f64 = 1e-9;

/// Checks that cells of surfaces and curves are flat, as exact networks need them: the springs measure lengths in space, the finite elements in the
/// mean plane. `points` are `[points × space]`, `connectivity` is `[cells × nodes]`.
///
/// # Errors
/// A cell is bent, or has no area.
pub fn check_flat(element: &Element, points: &[f64], connectivity: &[usize]) -> Result<()> {
    let (d, space, n) = (element.dimension(), element.space(), element.nodes());
    // A simplex is flat by itself, and where the dimensions agree there is no direction out of the cell.
    if d == space || n <= d + 1 {
        return Ok(());
    }
    let mut placement = Placement::new(&element.tabulation);
    let mut x = vec![0.0; n * d];
    for (cell, nodes) in connectivity.chunks_exact(n).enumerate() {
        placement
            .place(&element.tabulation, points, nodes, &mut x)
            .map_err(|fault| cell_fault(element, cell, fault))?;
        let at = |a: usize, k: usize| points[nodes[a] * space + k] - points[nodes[0] * space + k];
        let square = |a: usize| (0..space).map(|k| at(a, k) * at(a, k)).sum::<f64>();
        let in_plane = |a: usize| x[a * d..(a + 1) * d].iter().map(|x| x * x).sum::<f64>();
        let size = (0..n).map(square).fold(0.0, f64::max);
        let height = (0..n).map(|a| square(a) - in_plane(a)).fold(0.0, f64::max);
        if height > FLAT * size {
            let expected = "flat cells for exact networks in space; triangles of three nodes always are";
            let found = format!("one that is bent by {:.1e} of its size", (height / size).sqrt());
            return Err(Error::expected(format!("{} cell {}", element.name, cell + 1), expected, found)
                .of_kind(ErrorKind::Unsupported)
                .followed_by("; objective = \"frobenius\" fits bent cells as well"));
        }
    }
    Ok(())
}
