//! Whether the cells of a body lock: whether linear functions cannot keep a volume that the material keeps.

use crate::element::Element;
use crate::material::{MaterialMap, State};
use crate::mesh::{CellBlock, Mesh};
use crate::model::Deformation;

/// Finite elements of linear cells are markedly too stiff from this Poisson's ratio on.
pub(super) const LOCKS: f64 = 0.4;

/// Cells that lock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Locking {
    /// The largest Poisson's ratio of these cells.
    pub poisson: f64,
    /// Whether the cells with this ratio are triangles or tetrahedra.
    pub of_simplices: bool,
}

impl Locking {
    /// Finds the cells of these elements that lock: those from Poisson's ratio 0.4 on whose nodes are their corners and that integrate changes
    /// of volume like all others. Plane stress does not lock.
    pub fn of(mesh: &Mesh, material: &MaterialMap, is_asked: &dyn Fn(&Element) -> bool) -> Option<Locking> {
        if !matches!(material.state(), State::Solid | State::PlaneStrain { .. }) {
            return None;
        }
        let of_block = |(index, block): (usize, &CellBlock)| {
            let element = &block.element;
            let is_linear =
                is_asked(element) && element.has_corners_alone() && element.tabulation.volumetric.is_empty();
            if !is_linear {
                return None;
            }
            let ratios = (0..block.cells().len()).filter_map(|cell| Some(material.isotropic(index, cell)?.poisson()));
            let poisson = ratios.fold(0.0, f64::max);
            (poisson >= LOCKS).then_some(Locking { poisson, of_simplices: element.cell.is_simplex() })
        };
        mesh.body_blocks().filter_map(of_block).max_by(|a, b| a.poisson.total_cmp(&b.poisson))
    }
}

/// The largest Poisson's ratio of the cells of a body that lock: linear cells from Poisson's ratio 0.4 on; `None` where none do.
pub fn locks_at(mesh: &Mesh, material: &MaterialMap) -> Option<f64> {
    Locking::of(mesh, material, &|_| true).map(|locking| locking.poisson)
}

/// The largest mesh whose boundary is looked at: the search takes a tenth of a second.
const MOST_CELLS: usize = 100_000;

/// Whether linear cells of a body would be too stiff in bending: at least half of them have no point inside the body, so that there is about one
/// across. `false` of surfaces and curves in space, which do not bend, and of meshes of more than 100 000 cells, where it is not looked at.
pub fn is_one_cell_across(mesh: &Mesh) -> bool {
    let is_linear = |block: &CellBlock| block.element.has_corners_alone();
    let count: usize = mesh.body_blocks().map(|(_, block)| block.cells().len()).sum();
    if mesh.cell_dimension() != mesh.dimension
        || count > MOST_CELLS
        || !mesh.body_blocks().all(|(_, block)| is_linear(block))
    {
        return false;
    }
    let is_outer = mesh.outer_points();
    let of_body = mesh.cell_indices().filter(|cell| mesh.is_of_body(*cell));
    let outer = of_body.filter(|cell| mesh.cell_nodes(*cell).iter().all(|&p| is_outer[p])).count();
    2 * outer >= count
}

/// Rotations that exceed the largest strain by more than this factor are of bending or twisting: in shear both are alike.
const BENDS: f64 = 1.5;

/// Whether a body that is deformed so much bends or is twisted.
pub fn bends(deformation: Deformation) -> bool {
    deformation.rotation > BENDS * deformation.strain
}
