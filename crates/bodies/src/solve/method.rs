//! How linear equations are solved: by a factor, or by iterations with levels.

use crate::error::{Error, ErrorKind};
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;

/// A way to solve linear equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StaticMethod {
    /// One of the two below, by the size of the equations and the number of loads.
    #[default]
    Auto,
    /// A sparse factor by Cholesky's method.
    Cholesky,
    /// Conjugate gradients with smoothed-aggregation multigrid.
    Multigrid,
}

crate::named!(StaticMethod { "auto" => Auto, "cholesky" => Cholesky, "multigrid" => Multigrid });

/// How linear equations are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticSolver {
    /// A factor or iterations.
    pub method: StaticMethod,
    /// The iterations end at about this relative error in the norm of the energy.
    pub tolerance: f64,
    /// At most.
    pub iterations: usize,
}

impl Default for StaticSolver {
    fn default() -> StaticSolver {
        StaticSolver { method: StaticMethod::Auto, tolerance: 1e-10, iterations: 1000 }
    }
}

/// In the plane and in space: unknowns from which on the levels are faster for one load, and the unknowns whose factor is as dear as the
/// iterations of one load more, loads being solved side by side. A factor of a plane mesh fills less. `docs/src/theory/multigrid.md`
/// has the measurements, which end at 40 loads.
const FROM: [usize; 2] = [50_000, 15_000];
const PER_LOAD: [usize; 2] = [1_250, 250];
/// Shear moduli in this ratio leave iterations with much of the forces: they end by the energy, which the stiff cells have next to none of.
const CONTRAST: f64 = 1e5;
/// λ/μ (here of Poisson's ratio 0.497) from which on levels on quadratic cells take hundreds of iterations, or stall.
const INCOMPRESSIBLE: f64 = 200.0;
/// Unknowns whose factor takes about a minute.
const FACTORED: usize = 300_000;

impl StaticSolver {
    /// The solver of a body with these moduli: where it may choose, it factorises equations of cells that differ by orders of magnitude, and
    /// those of quadratic cells that hardly change their volume.
    pub fn suited(self, mesh: &Mesh, moduli: &CellMap<Hooke>) -> StaticSolver {
        // Beyond that size a factor takes minutes: iterations are tried whatever the moduli are.
        if self.method != StaticMethod::Auto || mesh.points.len() > FACTORED {
            return self;
        }
        let [least, largest] = moduli.map(Hooke::least_diagonal).range();
        let is_linear = mesh.blocks.iter().all(|block| block.element.has_corners_alone());
        let keeps_volume = |hooke: &Hooke| hooke.moduli().is_some_and(|of| of.lambda > INCOMPRESSIBLE * of.mu);
        match largest > CONTRAST * least || (!is_linear && moduli.values().any(keeps_volume)) {
            true => StaticSolver { method: StaticMethod::Cholesky, ..self },
            false => self,
        }
    }

    /// Whether equations that iterations could not solve for that reason are factorised instead.
    pub fn gives_way(&self, error: &Error) -> bool {
        self.method == StaticMethod::Auto && error.kind() == ErrorKind::Limit
    }

    /// Whether the equations of that mesh with so many loads are solved by iterations.
    pub fn iterates(&self, mesh: &Mesh, loads: usize) -> bool {
        let unknowns = mesh.points.len();
        match (self.method, mesh.dimension) {
            (StaticMethod::Cholesky, _) => false,
            (StaticMethod::Multigrid, 2 | 3) => true,
            // A surface or lines in space may have no stiffness across.
            (StaticMethod::Auto, 2 | 3) if mesh.cell_dimension() == mesh.dimension => {
                let kind = mesh.dimension - 2;
                unknowns >= FROM[kind] && loads <= unknowns / PER_LOAD[kind]
            }
            (StaticMethod::Multigrid | StaticMethod::Auto, _) => false,
        }
    }
}
