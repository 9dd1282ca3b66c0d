//! Whether the linear cells of a body resist it too much: they cannot keep a volume that the material keeps, or bend one cell across.

use crate::element::Element;
use crate::material::{Hooke, MaterialMap, State, strains};
use crate::mesh::{CellBlock, Mesh};
use crate::model::{Deformation, lacking_energy};

/// Finite elements of linear cells are markedly too stiff from this Poisson's ratio on.
// At this ratio λ is 4 μ, and grows without bound beyond: the spurious changes of volume of a linear cell in bending
// cost a multiple of its shear.
pub const LOCKS: f64 = 0.4;

/// Quadratic cells are markedly too stiff on coarse meshes from this ratio on: pressed blocks of four by two cells by 10 to 15 % at 0.49, and by 15 to 30 %
/// at 0.4999.
const STIFFENS: f64 = 0.49;

/// Cells that lock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Locking {
    /// The largest Poisson's ratio of these cells; of anisotropic ones that of the nearest isotropic law, to three digits.
    pub poisson: f64,
    /// Whether the cells with this ratio are triangles or tetrahedra.
    pub of_simplices: bool,
}

impl Locking {
    /// Finds the linear cells of a body that lock.
    pub fn of_body(mesh: &Mesh, material: &MaterialMap) -> Option<Locking> {
        Locking::of(mesh, material, &|_| true)
    }

    /// Finds the cells of these elements that lock: those from Poisson's ratio 0.4 on whose nodes are their corners and that integrate changes
    /// of volume like all others. Plane stress does not lock.
    pub fn of(mesh: &Mesh, material: &MaterialMap, is_asked: &dyn Fn(&Element) -> bool) -> Option<Locking> {
        let found = Locking::worst(mesh, material, &|element| element.has_corners_alone() && is_asked(element));
        found.filter(|locking| locking.poisson >= LOCKS)
    }

    /// Finds the cells of higher order that are stiffer than the body on coarse meshes: those from Poisson's ratio 0.49 on.
    pub fn of_higher_order(mesh: &Mesh, material: &MaterialMap) -> Option<Locking> {
        let found = Locking::worst(mesh, material, &|element| !element.has_corners_alone());
        found.filter(|locking| locking.poisson >= STIFFENS)
    }

    /// Finds the largest Poisson's ratio of the cells of these elements that integrate changes of volume like all others.
    fn worst(mesh: &Mesh, material: &MaterialMap, is_asked: &dyn Fn(&Element) -> bool) -> Option<Locking> {
        // Plane stress and rods change their thickness freely, so that a cell can keep its volume.
        if !matches!(material.state(), State::Solid | State::PlaneStrain { .. }) {
            return None;
        }
        let (poisson, moduli) = (material.poisson(), material.moduli());
        let of_block = |(index, block): (usize, &CellBlock)| {
            let element = &block.element;
            if !(is_asked(element) && element.tabulation.volumetric.is_empty()) {
                return None;
            }
            let [_, of_isotropic] = poisson.range_of(index);
            let moduli = moduli.block(index);
            let of_others = moduli.values().iter().filter(|hooke| hooke.is_anisotropic());
            let poisson = of_others.map(|hooke| nearest_poisson(hooke, mesh.dimension)).fold(of_isotropic, f64::max);
            (!poisson.is_nan()).then_some(Locking { poisson, of_simplices: element.cell.is_simplex() })
        };
        // The worst cells decide what a report says.
        mesh.body_blocks().filter_map(of_block).max_by(|a, b| a.poisson.total_cmp(&b.poisson))
    }
}

/// Poisson's ratio of the isotropic law that is nearest to an anisotropic one, to three digits: cells lock where a change of volume is much stiffer than
/// a change of shape, whatever the directions of the latter.
fn nearest_poisson(hooke: &Hooke, dimension: usize) -> f64 {
    let (entries, lambda) = hooke.entries(dimension);
    let (s, d) = (strains(dimension), dimension as f64);
    // The isotropic projection has `C_iijj = d² λ + 2 d μ`.
    let normal: f64 = (0..dimension).map(|i| entries[i * s..i * s + dimension].iter().sum::<f64>()).sum();
    let mu = (normal - d * d * lambda) / (2.0 * d);
    (1e3 * lambda / (2.0 * (lambda + mu))).round() / 1e3
}

/// Why the linear cells of a body resist it too much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TooStiff {
    /// They lock.
    Locks(Locking),
    /// The body bends under some load, or where it vibrates, and is about one cell across.
    Bends,
    /// The body is more cells across, and these are so large for how it bends under some load that they lack a marked share of its energy.
    Coarse,
}

/// The share of a body's energy that its cells lack, from which on they are too stiff: displacements under forces are about so much too small.
// A bent bar of n simplices across lacks about `2/n²`, 22 % with three and 12 % with four: the share lies between what
// counts as few below and what does not.
pub const LACKING: f64 = 0.15;

impl TooStiff {
    /// Finds why the cells of a body resist too much, from what they lack under the loads that bend it.
    pub fn of(mesh: &Mesh, material: &MaterialMap, lacking: &[Option<f64>]) -> Option<TooStiff> {
        let has_bent = lacking.iter().any(Option::is_some);
        Locking::of_body(mesh, material).map(TooStiff::Locks).or_else(|| match has_bent && is_one_cell_across(mesh) {
            true => Some(TooStiff::Bends),
            false => lacking.iter().flatten().any(|share| *share >= LACKING).then_some(TooStiff::Coarse),
        })
    }

    /// Finds why the cells of a body resist too much in its lowest vibrations, which bend most bodies.
    pub fn of_vibrations(mesh: &Mesh, material: &MaterialMap) -> Option<TooStiff> {
        // The boundary of a large mesh is not looked for where nothing asks for it.
        Locking::of_body(mesh, material).map(TooStiff::Locks).or_else(|| match is_linear(mesh) {
            true if is_one_cell_across(mesh) => Some(TooStiff::Bends),
            true => is_slender(mesh).then_some(TooStiff::Coarse),
            false => None,
        })
    }

    /// The largest Poisson's ratio of the cells that lock.
    pub fn locks_at(&self) -> Option<f64> {
        match self {
            TooStiff::Locks(locking) => Some(locking.poisson),
            TooStiff::Bends | TooStiff::Coarse => None,
        }
    }
}

/// The share of its energy that a body of linear cells lacks under a load that bends it; `None` where the jumps of strains do not tell, because cells
/// lock, have functions of their own, or are too many. Strains are Green's if `is_large`.
pub fn lacking(mesh: &Mesh, material: &MaterialMap, u: &[f64], is_large: bool) -> Option<f64> {
    let is_told = is_linear(mesh) && Locking::of_body(mesh, material).is_none();
    is_told.then(|| lacking_energy(mesh, material, u, is_large))
}

/// The largest mesh whose boundary is looked at: the search takes a tenth of a second.
const MOST_CELLS: usize = 100_000;

/// Whether all cells of a body are linear and few enough to be looked at. `false` of surfaces and curves in space, which do not bend, of cells with
/// functions that bend beside those of the nodes, and of meshes of more than 100 000 cells.
fn is_linear(mesh: &Mesh) -> bool {
    mesh.cell_dimension() == mesh.dimension
        && count(mesh) <= MOST_CELLS
        && mesh.body_blocks().all(|(_, block)| block.element.has_corners_alone() && block.element.modes() == 0)
}

fn count(mesh: &Mesh) -> usize {
    mesh.body_blocks().map(|(_, block)| block.cells().len()).sum()
}

/// Whether about one cell is across the body: at least half of the cells have no point inside it.
fn is_one_cell_across(mesh: &Mesh) -> bool {
    let is_outer = mesh.outer_points();
    let of_body = mesh.cell_indices().filter(|cell| mesh.is_of_body(*cell));
    let outer = of_body.filter(|cell| mesh.cell_nodes(*cell).iter().all(|&p| is_outer[p])).count();
    2 * outer >= count(mesh)
}

/// Cells of this length beside the thickness of the body are too long. Of n cells across, each a times as long as it is thick, the shear that a
/// linear cell has where it should bend makes the body stiffer by about the share `(1 − ν)/2 (a/n)²`, whatever n is: by a fifth here.
const LONG: f64 = 0.75;
/// So many triangles or tetrahedra across are too few, however short they are: strains of bending that are constant in a cell have `2/n²` more energy.
const FEW: usize = 3;
/// More cells across are not counted.
// Each two layers take a pass over all cells. Beside 32 cells across a cell is long only if it is 24 times as long as thick.
const MOST_ACROSS: usize = 32;

/// Whether at least half of the cells are long beside the thickness of the body, or all are simplices and few across.
fn is_slender(mesh: &Mesh) -> bool {
    let are_simplices = mesh.body_blocks().all(|(_, block)| block.element.cell.is_simplex());
    mesh.cells_across(MOST_ACROSS).is_some_and(|across| {
        are_simplices && across <= FEW || 2 * mesh.long_cells(LONG * across as f64) >= count(mesh)
    })
}

/// Rotations that exceed the largest strain by more than this factor are of bending or twisting: in shear both are alike.
// A bar of length L and thickness t that is held at one end and bent to an arc turns at the other by `2 L/t` times its strain: the
// factor is exceeded from `L = 0.75 t` on.
const BENDS: f64 = 1.5;

/// Whether a body that is deformed so much bends or is twisted. At large deformation as well: strains of linear theory that a rotation alone has exceed two thirds of
/// its sine from 67° on.
pub fn bends(deformation: Deformation) -> bool {
    deformation.rotation > BENDS * deformation.strain
}
